//! The nonlinear plant in time, with its sampled controller.
#![allow(non_snake_case)]

mod engine;
pub mod error;
pub mod history;
pub mod motion;
pub mod recording;
pub mod replay;
pub mod run;
pub mod scenario;
pub mod sensing;
pub mod signal;

pub use engine::ports::FrictionState;
pub use engine::stepper::{Effort, PlantState};
pub use error::Error;
pub use history::{ReadingColumns, TimeHistory, TrueColumns};
pub use motion::PlatformMotion;
pub use recording::{Channel, Recording};
pub use replay::{ChannelFit, Loop, Playback, Replay, Replayer, replay};
pub use run::{Simulator, run};
pub use scenario::{Detail, Initial, Scenario};
pub use sensing::Imperfections;
pub use signal::{Signal, Sine};
