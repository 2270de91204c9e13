//! The discrete controller as it runs on the target: what it reads, and every operation in order.
//!
//! In come discrete transfer paths, friction observers and a schedule over the out-of-balance ([`Parts`]); out goes a
//! [`Controller`] whose arithmetic is fixed to the last bit: straight lines of operations ([`Programs`]) that the
//! [`Runner`], generated code and error analyses all carry out.
//!
//! *Invariant*: nothing here knows how a controller was designed, or what plant it drives; no file, thread or clock.
//!
//! Modules in reading order: [`sampled_controller`], [`signal`], [`parts`], [`friction`], [`estimator`], [`controller`], [`program`], [`compiled_program`],
//! [`number`], [`guard`], [`runner`], `linear_part`, [`realisation`], [`sensitivity`], [`tolerance`] (the numbers that decide), [`words`], [`error`].
//!
//! ```
//! use counterpoise_controller::{Controller, Parts, Path, PathSignal, Readings, SampledController, Scaling};
//! use counterpoise_linalg::Mat;
//! use counterpoise_lti::{StateSpace, Timebase};
//!
//! // u = 2 e + integral of e, sampled at 1 kHz, limited to +/- 10 V
//! let one = |x: f64| Mat::from_rows(&[&[x]]);
//! let timebase = Timebase::Discrete { period_s: 1e-3 };
//! let system = StateSpace::new(one(1.0), one(1e-3), one(1.0), one(2.0), timebase).unwrap();
//! let path = Path {
//!     name: "feedback".into(),
//!     inputs: vec![PathSignal::RateError],
//!     system,
//!     anti_windup: vec![0.1],
//!     scaling: Scaling::Fixed,
//! };
//! let mut parts = Parts::new(1e-3, 10.0);
//! parts.paths.push(path);
//! let mut runner = Controller::new(parts).unwrap().runner();
//! let readings = Readings { demand_rad_s: 1.0, ..Readings::default() };
//! assert_eq!(runner.step(&readings), 2.0);
//! assert_eq!(runner.step(&readings), 2.001);
//! ```
#![allow(non_snake_case)]

pub mod compiled_program;
pub mod controller;
pub mod error;
pub mod estimator;
pub mod friction;
pub mod guard;
pub mod number;
pub mod parts;
pub mod program;
pub mod realisation;
pub mod runner;
pub mod sampled_controller;
pub mod sensitivity;
pub mod signal;
pub mod tolerance;
pub mod words;

mod check;
mod linear_part;
mod lowering;
mod range_checks;

pub use controller::Controller;
pub use error::Error;
pub use estimator::{Estimator, Learning};
pub use friction::{FrictionObserver, LevelLearning, ObserverLaw};
pub use guard::{GuardSettings, SensorUse, Status};
pub use number::Number;
pub use parts::{Correction, DemandLimit, Parts, Path, Projection, Scaling};
pub use program::Programs;
pub use runner::Runner;
pub use sampled_controller::{
    AntiWindup, IntegralMotion, PositionController, PositionSource, ProportionalIntegral, RateSource,
    Readings, SampledController,
};
pub use signal::{COMMON_READINGS, PathSignal, READING_NAMES, READINGS};
