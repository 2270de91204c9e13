//! The out-of-balance servo mechanism: structure, drive train, friction, sensors, converters.
//!
//! In come [`Parameters`] in SI units; out go the nonlinear plant and its linearisation.
//!
//! *Invariant*: nothing here knows how a controller is designed, or marches in time.
//!
//! Modules in reading order: [`parameters`], [`friction`], [`linkage`], [`loads`], [`plant`], [`structure`], [`base_motion`], [`two_axes`], [`mod@reference`] (the machine that examples start
//! from), [`tolerance`] (the numbers that decide), [`error`].
#![allow(non_snake_case)]

pub mod base_motion;
pub mod error;
pub mod friction;
pub mod linkage;
pub mod loads;
pub mod parameters;
pub mod plant;
mod range;
pub mod reference;
pub mod structure;
pub mod tolerance;
pub mod two_axes;

pub use error::Error;
pub use linkage::Linkage;
pub use loads::{EndStops, Equilibrator, LoadPoint, Loads, Recoil};
pub use parameters::*;
pub use plant::{
    Angles, Equilibrium, Excitation, FrictionLinearisation, LinearPlant, Mesh, OperatingPoint, Plant,
};
pub use range::Range;
