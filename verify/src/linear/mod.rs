//! The linear loop: the plant with its sensors, sampled exactly, and the discrete controller as exported.
//!
//! Friction observers are taken as sliding and the out-of-balance estimator as standing still (see
//! [`counterpoise_controller::Controller::linear`]).
//!
//! Modules in reading order: [`plant`], [`closed`], [`frequency`], [`time`], [`surge`].

pub mod closed;
pub mod frequency;
pub mod plant;
pub mod surge;
pub mod time;

pub use closed::{Closed, arranged};
pub use frequency::{Curve, Curves, PlantResponse, rejection_db};
pub use plant::SampledPlant;
pub use time::{disturbance, step, triangle};
