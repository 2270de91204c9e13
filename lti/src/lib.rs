//! Linear time-invariant systems with an explicit timebase.
//!
//! In come A, B, C, D and a timebase; out go connected systems, responses, norms and margins.
//!
//! *Invariant*: nothing here knows a machine, a weight, a file, a thread or a clock.
//!
//! Modules in reading order: [`system`].
#![allow(non_snake_case)]

pub mod connect;
pub mod error;
mod hessenberg_sweep;
pub mod response;
pub mod scaling;
pub mod system;

pub use counterpoise_linalg as linalg;
pub use counterpoise_linalg::{C64, CMat, Mat};
pub use connect::{append, feedback, inverse, lft, parallel, series};
pub use error::Error;
pub use response::{Response, dcgain, frequency_response, response_at, sigma};
pub use system::{StateSpace, Timebase};
