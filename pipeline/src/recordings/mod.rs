//! From recordings of a machine to a better model.
//!
//! Modules in reading order: [`redesign`] (what an improved model means for the design), [`measured_modes`] (what a structure's
//! model lacks, from its measured natural frequencies).

pub mod measured_modes;
pub mod redesign;
