//! The state of a plant between samples, and the work that a run was.

use super::ports::{Bonds, FrictionState};

/// State of the plant between samples.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantState {
    /// States of the linear core, as [`counterpoise_models::plant::core::state`] has them.
    pub core: Vec<f64>,
    /// States of dry friction.
    pub friction: FrictionState,
    /// The bonds of bristle friction.
    pub bonds: Bonds,
    /// The loop's sensor before its gain and bias: what it shows, and its derivative.
    pub hub_gyro: [f64; 2],
}

/// Computing work of a run, and whether any of it was done below the requested accuracy.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Effort {
    /// Steps taken.
    pub steps: usize,
    /// Steps tried and shortened.
    pub rejected: usize,
    /// Shortest steps that were taken although their error was above the tolerance: at jumps.
    pub forced: usize,
    /// Evaluations of the nonlinear parts along a step.
    pub iterations: usize,
    /// Changes of joints that truly stick: to rest, to sliding, or from one direction to the other.
    pub changes: usize,
}

impl Effort {
    /// Returns the number of steps that were tried: those taken, and those shortened.
    pub fn count_tried(&self) -> usize {
        self.steps + self.rejected
    }
}
