//! The linear loop: the plant with its sensors, sampled exactly, and the discrete controller as exported.
//!
//! Friction observers are taken as sliding and the out-of-balance estimator as standing still (see
//! [`counterpoise_controller::Controller::linear`]).
//!
//! Modules in reading order: [`plant`], [`closed_loop`], [`plant_response`], [`loop_responses`], [`frequency`], [`noise`], [`root_locus`](mod@root_locus), [`loop_shape`](mod@loop_shape), [`time`], [`surge`].

pub mod closed_loop;
pub mod frequency;
pub mod loop_responses;
pub mod loop_shape;
pub mod noise;
pub mod plant;
pub mod plant_response;
pub mod root_locus;
pub mod surge;
pub mod time;

pub use closed_loop::{ArrangedLoop, ClosedLoop, arrange_controller};
pub use frequency::{Curves, ResponseCurve, rejection_db};
pub use loop_responses::{LoopCause, LoopEffect, LoopResponse};
pub use loop_shape::{
    Disk, LoopPath, LoopShape, MarginKind, MarginOnPath, largest_sensitivity, loop_shape, margins_on_path,
};
pub use plant::SampledPlant;
pub use plant_response::PlantResponse;
pub use root_locus::{ContinuousLocus, LOCUS_CROSSOVERS, RootLocus, root_locus};
pub use time::{simulate_disturbance, simulate_step, simulate_triangle};
