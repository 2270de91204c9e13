//! What the command line and the studio have in common: figures and reports.
//!
//! *Invariant*: no mathematics of control; what is drawn was computed elsewhere.
//!
//! Modules in reading order: [`plot`], [`report`].

pub mod plot;
pub mod report;
