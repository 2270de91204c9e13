//! Results as a result file has them: the numbers of the pipeline, with sentences where it states what was found.
//!
//! Modules in reading order: [`synthesis`], [`verification`], [`comparison`], [`design`], [`first_design`], [`designs`], [`front`], [`search`], [`structure`], [`adaptation`].

pub mod adaptation;
pub mod comparison;
pub mod design;
pub mod designs;
pub mod first_design;
pub mod front;
pub mod search;
pub mod structure;
pub mod synthesis;
pub mod verification;

pub use adaptation::AdaptText;
pub use comparison::ComparisonText;
pub use design::DesignText;
pub use designs::DesignTableText;
pub use first_design::FirstDesignText;
pub use front::FrontText;
pub use structure::StructureText;
pub use synthesis::{SynthText, describe_check, describe_reduction};
pub use verification::VerifyText;
