//! Linear time-invariant systems with an explicit timebase.
//!
//! In come A, B, C, D and a timebase; out go connected systems, responses, norms and margins.
//!
//! *Invariant*: nothing here knows a machine, a weight, a file, a thread or a clock.
//!
//! Modules in reading order: [`system`].
#![allow(non_snake_case)]

pub mod error;
pub mod system;

pub use counterpoise_linalg as linalg;
pub use counterpoise_linalg::{C64, CMat, Mat};
pub use error::Error;
pub use system::{StateSpace, Timebase};
