//! Compilers and emulators that are run on generated code.
//!
//! Modules in reading order: [`proofs`] (compiled on this machine and compared with its model), [`processor`] (what a step costs
//! on a Cortex-M), [`unit_library`] (the library of an FMI unit), [`controller_program`]
//! (exported C in the loop of a simulated machine).

pub mod controller_program;
pub mod processor;
pub mod proofs;
pub mod unit_library;
