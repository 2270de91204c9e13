//! Sentences that stand in result files and in generated code.
//!
//! The crates below state numbers and enums. What a JSON result or the header of exported code says about them is put into words here; what
//! people read on the terminal, in a report or in the studio is worded in the crate `report`.
//!
//! Modules in reading order: [`weights`], `schedule`, [`demanded_rate`], [`design_findings`], `designs`, [`figures`], [`certificates`], [`check`], [`reduction`], [`acceptance`], `provenance`,
//! `feedback_alone`, `structure`, `traverse`, `serialisation`.

pub mod acceptance;
pub mod certificates;
pub mod check;
pub mod demanded_rate;
pub mod design_findings;
pub(crate) mod designs;
pub(crate) mod feedback_alone;
pub mod figures;
pub(crate) mod provenance;
pub mod reduction;
pub(crate) mod schedule;
pub(crate) mod serialisation;
pub(crate) mod structure;
pub(crate) mod traverse;
pub mod weights;
