//! The nonlinear plant in time, with its sampled controller; its experiments, and its replay of recordings.
//!
//! From a plant, a controller and a scenario it makes a time history; from a recording, the residuals of the model; from a
//! frequency, the response that an analyser would show.
//!
//! The integrator is exponential collocation. The plant is a linear core with a few nonlinear inputs. The core moves by
//! its matrix exponential, exactly, mode by mode if it has many modes. The nonlinear inputs are cubics through the four nodes of
//! Lobatto's rule, found by fixed-point iteration; most often one pass suffices, because the inputs continue from the step
//! before. Dry friction moves from node to node by its own closed form in the displacement, which is stable for any presliding
//! stiffness. A joint that truly sticks is a core without that degree of freedom. A step is a sample period, halved until the
//! inputs are smooth enough, and halved further to find the instants where teeth part or meet and joints stick or break away.
//! The method is fast because a smooth sample is one step, with one product of a stored matrix, where a Runge-Kutta method
//! needs about twenty for stability alone.
//!
//! *Invariant*: nothing here knows a requirement, a design, a file, a thread or a clock; noise comes from a seed.
//!
//! Modules in reading order: [`signal`], [`motion`], [`firing`], [`scenario`], [`mod@run`], [`two_axes`], [`ensemble`], [`sensing`], `noise`, `sampling_errors`, `drive_limits`, [`history`],
//! [`sensitivity`], [`mod@replay`], [`fra`], [`convergence`], [`tolerance`] (the numbers that decide), [`error`].
//!
//! ```
//! use counterpoise_controller::ProportionalIntegral;
//! use counterpoise_models::{Plant, reference};
//! use counterpoise_simulate::{Scenario, Signal, run};
//!
//! let plant = Plant::from_lumped(&reference::rig())?;
//! let mut controller = ProportionalIntegral {
//!     kp_v_s_rad: 18.0, ki_v_rad: 80.0, bias_v: 2.88, sample_period_s: 1e-3,
//!     ..ProportionalIntegral::default()
//! };
//! let scenario = Scenario { demand_rad_s: Signal::step(0.1, 0.05), ..Scenario::at_rest(2.0) };
//! let history = run(&plant, &mut controller, &scenario)?;
//! assert!((history.truth.hub_rate_rad_s()[1999] - 0.05).abs() < 1e-3);
//! # Ok::<(), counterpoise_simulate::Error>(())
//! ```
#![allow(non_snake_case)]

pub mod convergence;
mod drive_limits;
mod engine;
pub mod ensemble;
pub mod error;
pub mod firing;
pub mod fra;
pub mod history;
mod lanes;
pub mod motion;
mod noise;
pub mod replay;
pub mod run;
mod sampling_errors;
pub mod scenario;
pub mod sensing;
pub mod sensitivity;
pub mod signal;
pub mod tolerance;
pub mod two_axes;

pub use engine::ports::{Bonds, FrictionState};
pub use engine::state::{Effort, PlantState};
pub use ensemble::{EnsembleRun, Registers, RunObserver, run_ensemble, run_ensemble_in};
pub use error::Error;
pub use firing::Firing;
pub use history::{ReadingColumn, ReadingColumns, TimeHistory, TrueColumn, TrueColumns};
pub use motion::{FurtherMotion, PlatformMotion};
pub use replay::{ChannelFit, Playback, Replay, ReplayLoop, Replayer, replay};
pub use run::{Simulator, run, state_at_rest};
pub use scenario::{Detail, Initial, Scenario};
pub use sensing::Imperfections;
pub use signal::{Signal, Sine};
pub use two_axes::{
    AxisScenario, BaseMotion, Controllers, SightColumn, TwoAxisHistory, TwoAxisScenario, TwoAxisSimulator,
};
