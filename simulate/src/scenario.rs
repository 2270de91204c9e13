//! The inputs of the mechanism in a run.

use crate::engine::state::PlantState;
use crate::firing::Firing;
use crate::motion::PlatformMotion;
use crate::sensing::Imperfections;
use crate::signal::Signal;

/// A run of the sampled closed loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Duration, s; the run has a sample at every whole period before it.
    pub duration_s: f64,
    /// Demanded hub rate, rad/s, as the controller reads it.
    pub demand_rad_s: Signal,
    /// Volts added to the control before the output converter.
    pub injection_v: Signal,
    /// Motion of the platform.
    pub platform: PlatformMotion,
    /// Imperfections of sensors and converters that are simulated.
    pub imperfections: Imperfections,
    /// Initial state of the mechanism.
    pub initial: Initial,
    /// Signals that are kept.
    pub detail: Detail,
    /// The shots of the machine.
    pub firing: Firing,
}

/// Initial state of the mechanism.
#[derive(Debug, Clone, PartialEq)]
pub enum Initial {
    /// At rest at a hub angle (rad, inertial), the motor holding weight and spring, friction without load, the hub at
    /// the platform's rate.
    Rest {
        /// Hub angle, rad.
        hub_angle_rad: f64,
    },
    /// In a given state.
    State(Box<PlantState>),
}

/// Signals that a run records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// The readings, the demand and the control: what a recording of the machine has.
    Recording,
    /// Readings and control, and the true motions and torques.
    Everything,
}

impl Scenario {
    /// Returns a run at rest with everything kept, without noise, quantisation or shots: the start for others.
    pub fn at_rest(duration_s: f64) -> Self {
        Self {
            duration_s,
            demand_rad_s: Signal::ZERO,
            injection_v: Signal::ZERO,
            platform: PlatformMotion::STILL,
            imperfections: Imperfections::None,
            initial: Initial::Rest { hub_angle_rad: 0.0 },
            detail: Detail::Everything,
            firing: Firing::Silent,
        }
    }
}
