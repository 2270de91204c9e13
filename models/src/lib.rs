//! The out-of-balance servo mechanism: structure, drive train, friction, sensors, converters.
//!
//! In come [`Parameters`] in SI units; out go the nonlinear plant and its linearisation.
//!
//! *Invariant*: nothing here knows how a controller is designed, or marches in time.
//!
//! Modules in reading order: [`parameters`].
#![allow(non_snake_case)]

pub mod error;
pub mod parameters;

pub use error::Error;
pub use parameters::*;
