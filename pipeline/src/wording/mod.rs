//! Sentences about specifications and requirements that results, reports and exported code share.
//!
//! The crates below state numbers and enums; what is said about them is put into words here.
//!
//! Modules in reading order: [`weights`], [`acceptance`].

pub mod acceptance;
pub mod weights;
