//! Faults of sensors and recorder, found before any physics.
//!
//! Modules in reading order: `column`, the columns of a recording; `fault`, what can be wrong with one; `single_column`, what a column shows
//! by itself; `regression` and `identities`, what all columns must satisfy together; `factors`, wrong factors and exchanged columns;
//! `accelerometer_unit`; `clocks`; `examination`, all of it.

mod accelerometer_unit;
mod clocks;
mod column;
mod examination;
mod factors;
mod fault;
mod identities;
mod regression;
mod single_column;

pub use column::RecorderColumn;
pub use examination::{ExaminedRecordings, find_instrument_faults};
pub use fault::{FaultKind, InstrumentFault, Treatment, UnitMistake};
