//! Sentences that stand in result files and in generated code.
//!
//! The crates below state numbers and enums. What a JSON result or the header of exported code says about them is put into words here; what
//! people read on the terminal, in a report or in the studio is worded in the crate `report`.
//!
//! Modules in reading order: [`weights`], `schedule`, [`demanded_rate`], [`design_findings`], [`figures`], [`reduction`], [`acceptance`], `feedback_alone`, `structure`.

pub mod acceptance;
pub mod demanded_rate;
pub mod design_findings;
pub(crate) mod feedback_alone;
pub mod figures;
pub mod reduction;
pub(crate) mod schedule;
pub(crate) mod structure;
pub mod weights;
