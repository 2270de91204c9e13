//! From recordings of a machine and its model to what the model left out.
//!
//! The input is a mechanism's parameters, recordings, and a simulator that replays them. The result is an
//! [`Answer`](findings::answer::Answer): a verdict, the effects that were found with their fitted parameters and intervals, how the fit
//! improved on held-out data, and what these recordings cannot tell.
//!
//! The story, in the order of the modules:
//!
//! 1. [`recording`]: recordings are repaired, checked, and freed from the faults of their instruments before any physics.
//! 2. [`localisation`]: which component is in error, and in which regime.
//! 3. [`library`]: the effects of physics that a machine may have and its model may lack.
//! 4. [`simulator_access`]: what is asked of the simulator.
//! 5. [`fitting`]: effects are fitted in the simulator, and judged on held-out data.
//! 6. [`selection`]: which effects, together, explain the recordings.
//! 7. [`learning`]: free functions model what has no name; `explanation` chooses between them and the library's effects.
//! 8. [`identification`]: the triangle-wave method, apart from the others.
//! 9. [`findings`]: verdict and findings.
//! 10. [`diagnosis`]: all of it in one function; `shortening` says how much of the recordings it replays.
//! 11. [`experiment`](mod@experiment): the next experiment, which separates the machines that are left.
//!
//! Beside them stand [`error`] and [`tolerance`] (the numbers that decide, each with its reason).
//!
//! ```
//! use counterpoise_diagnose::library::{Component, list_effects};
//! use counterpoise_pool::Serial;
//! use counterpoise_diagnose::{Error, diagnose};
//! use counterpoise_models::reference;
//! use counterpoise_simulate::replay::ReplayLoop;
//!
//! assert!(list_effects().iter().any(|effect| effect.component == Component::Gearbox));
//! let refused = diagnose(&reference::rig(), ReplayLoop::Open, &[], &Serial);
//! assert_eq!(refused.err(), Some(Error::NoRecording));
//! ```
//!
//! *Invariant*: nothing here knows a weight, a file, a thread or a clock; processors are handed in as a
//! [`Pool`](counterpoise_pool::Pool).

pub mod recording;

pub mod localisation;

pub mod library;

pub mod simulator_access;

pub mod fitting;

pub mod selection;

pub mod learning;

pub mod identification;
mod machine;
pub use machine::{RedundantSensors, can_have};

pub mod experiment;

pub mod findings;

mod explanation;
mod shortening;

pub mod diagnosis;

pub mod error;
pub mod tolerance;

pub use diagnosis::{Diagnosis, diagnose};
pub use error::Error;
pub use fitting::refit::{Structure, refit};
