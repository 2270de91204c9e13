//! Linear time-invariant systems with an explicit timebase.
//!
//! In come A, B, C, D and a timebase; out go connected systems, responses, norms and margins.
//!
//! *Invariant*: nothing here knows a machine, a weight, a file, a thread or a clock.
//!
//! Modules in reading order: [`system`].
#![allow(non_snake_case)]

pub mod components;
pub mod connect;
pub mod delay;
pub mod discretise;
pub mod error;
pub mod gramians;
mod hessenberg_sweep;
pub mod norms;
pub mod response;
pub mod roots;
pub mod scaling;
pub mod system;
pub mod time;
pub mod zpk;

pub use connect::{append, feedback, inverse, lft, parallel, series};
pub use counterpoise_linalg as linalg;
pub use counterpoise_linalg::{C64, CMat, Mat};
pub use delay::{delay_samples, pade};
pub use discretise::{Cost, Discretisation, SampledCost, c2d, d2c_tustin, sampled_cost};
pub use error::Error;
pub use gramians::{ctrb_factor, ctrb_gramian, hankel_values, hankelnorm, obsv_factor, obsv_gramian};
pub use norms::{Peak, h2norm, hinfnorm, linfnorm};
pub use response::{Response, dcgain, frequency_response, response_at, sigma};
pub use roots::{is_stable, is_stable_pole, poles, zeros};
pub use system::{StateSpace, Timebase};
pub use time::{TimeResponse, impulse, lsim, step};
pub use zpk::Zpk;
