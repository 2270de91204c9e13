//! Runs a controller.

use crate::program::{Compiled, OnReset};
use crate::{Controller, Number, Programs, Readings, SampledController};

/// A controller that runs, in the numbers N: `f64` is the reference, `f32` what a small target computes.
#[derive(Debug, Clone)]
pub struct Runner<N = f64> {
    programs: Programs,
    step: Compiled<N>,
    set: Compiled<N>,
    memory: Vec<N>,
}

impl<N: Number> Runner<N> {
    /// Returns the controller at its start.
    pub fn new(controller: &Controller) -> Self {
        let programs = controller.programs().clone();
        let states = programs.state_count();
        let step = Compiled::new(&programs.step, states);
        let set = Compiled::new(&programs.set_out_of_balance, states);
        let mut memory = vec![N::from_f64(0.0); step.memory().max(set.memory())];
        for (place, value) in memory.iter_mut().zip(programs.initial()) {
            *place = N::from_f64(value);
        }
        Self { programs, step, set, memory }
    }

    /// Takes the readings in the order of [`crate::READING_NAMES`] and returns the limited control in volts.
    pub fn step_array(&mut self, readings: &[f64; crate::READINGS]) -> f64 {
        let inputs = readings.map(N::from_f64);
        self.step.run(&mut self.memory, &inputs).map_or(0.0, |control| control.to_f64())
    }

    /// Sets the out-of-balance, kg m, kept inside the controller's range: gains and bias follow, and the step this
    /// makes in the control fades in with the controller's transfer time.
    pub fn set_out_of_balance(&mut self, out_of_balance_kg_m: f64) {
        self.set.run(&mut self.memory, &[N::from_f64(out_of_balance_kg_m)]);
    }

    /// Returns everything the last step knew: states, readings, then its locals, in the order of the step's program.
    pub fn values(&self) -> Vec<f64> {
        self.memory.iter().map(Number::to_f64).collect()
    }

    /// Returns one state, by its place in [`Programs::states`].
    pub fn state(&self, place: usize) -> Option<f64> {
        self.memory[..self.programs.state_count()].get(place).map(Number::to_f64)
    }

    /// Returns the states, in the order of [`Programs::states`].
    pub fn states(&self) -> Vec<f64> {
        self.memory[..self.programs.state_count()].iter().map(Number::to_f64).collect()
    }
}

impl<N: Number> SampledController for Runner<N> {
    /// Puts the states back to their start; the out-of-balance stays as set.
    fn reset(&mut self) {
        for group in self.programs.states.iter().filter(|group| group.on_reset == OnReset::Restart) {
            for (place, value) in self.memory[group.first..].iter_mut().zip(&group.initial) {
                *place = N::from_f64(*value);
            }
        }
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        self.step_array(&readings.to_array())
    }
}
