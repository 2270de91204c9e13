//! The statements that hold for every shipped example: its design, its requirements, its code, its FMI units, how it bears faults, and that it replays
//! its own recordings. The suites stand in one program, so that the design of an example is computed once for all of them. The longest ones
//! try a few examples of different structure by default, and every one if `EVERY_EXAMPLE` is set, as in `.ci/evidence`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, non_snake_case)]

#[path = "../../../export/tests/support/mod.rs"]
pub(crate) mod support;

#[path = "../../../export/tests/support/target.rs"]
mod target;

mod error_budgets;
mod exported_code;
mod fault_injection;
mod fmi_units;
mod handover;
mod own_recordings;
mod requirements;
