//! Runs a controller.

use crate::compiled_program::CompiledProgram;
use crate::guard::{Guard, StateLimit, StatePlausibility, assess_states, kept_states, limit_states};
use crate::program::OnRestart;
use crate::{Controller, Number, Programs, Readings, SampledController, SensorUse, Status};

/// A controller that runs, in the numbers N: `f64` is the reference, `f32` what a small target computes.
#[derive(Debug, Clone)]
pub struct Runner<N = f64> {
    programs: Programs,
    step: CompiledProgram<N>,
    set: CompiledProgram<N>,
    memory: Vec<N>,
    guard: Guard<N>,
    kept: Vec<StateLimit<N>>,
}

impl Controller {
    /// Returns the controller at its start, in double: the reference.
    pub fn runner(&self) -> Runner {
        Runner::new(self)
    }

    /// Returns the controller at its start, in the numbers N.
    pub fn runner_in<N: Number>(&self) -> Runner<N> {
        Runner::new(self)
    }
}

impl<N: Number> Runner<N> {
    /// Returns the controller at its start.
    pub fn new(controller: &Controller) -> Self {
        let programs = controller.programs().clone();
        let states = programs.state_count();
        let step = CompiledProgram::new(&programs.step, states);
        let set = CompiledProgram::new(&programs.set_out_of_balance, states);
        let mut memory = vec![N::from_f64(0.0); step.memory().max(set.memory())];
        for (place, value) in memory.iter_mut().zip(programs.initial()) {
            *place = N::from_f64(value);
        }
        let kept = kept_states(&programs.states);
        Self { programs, step, set, memory, guard: Guard::new(controller.parts()), kept }
    }

    /// Takes the readings in the order of [`crate::READING_NAMES`] and returns the limited control in volts.
    ///
    /// A reading that is not a number or beyond its limit is replaced by the last good one; see [`Runner::status`].
    pub fn step_array(&mut self, readings: &[f64; crate::READINGS]) -> f64 {
        self.step_numbers(&readings.map(N::from_f64)).to_f64()
    }

    /// Takes the readings as [`Runner::step_array`] does, and returns the control, in the runner's own numbers.
    pub fn step_numbers(&mut self, readings: &[N; crate::READINGS]) -> N {
        let inputs = self.guard.take(readings);
        let control = self.step.run(&mut self.memory, &inputs).unwrap_or(N::from_f64(0.0));
        let states = self.programs.state_count();
        let found = limit_states(&mut self.memory[..states], &self.kept);
        if found == StatePlausibility::No {
            self.restart();
        }
        self.guard.select_control(control, found)
    }

    /// Sets the out-of-balance, kg m, kept inside the controller's range: gains and bias follow, and the step this
    /// makes in the control fades in with the controller's transfer time. What is not a finite number is refused and
    /// flagged, and changes nothing.
    pub fn set_out_of_balance(&mut self, out_of_balance_kg_m: f64) {
        let value = N::from_f64(out_of_balance_kg_m);
        if self.guard.admits(&value) {
            self.set.run(&mut self.memory, &[value]);
        }
    }

    /// Hands the control over to feedback alone, or back to all sensors. Readings other than the demand and the hub gyroscope
    /// fade out, or in, over a tenth of a second.
    pub fn use_sensors(&mut self, sensors: SensorUse) {
        self.guard.use_sensors(sensors);
    }

    /// Returns the flags of the last sample, and how many readings were replaced since the last reset.
    pub fn status(&self) -> Status {
        self.guard.status()
    }

    /// Puts the states back to their start. The out-of-balance stays as set, unless what belongs to it is not plausible.
    fn restart(&mut self) {
        self.put_to_start(OnRestart::Restart);
        let kept = self.programs.states.iter().filter(|group| group.on_restart == OnRestart::Keep);
        let places = kept.flat_map(|group| group.first..group.first + group.initial.len());
        let total = places.fold(N::from_f64(0.0), |sum, place| sum.plus(&self.memory[place].magnitude()));
        if assess_states(&total) == StatePlausibility::No {
            self.put_to_start(OnRestart::Keep);
        }
    }

    fn put_to_start(&mut self, which: OnRestart) {
        for group in self.programs.states.iter().filter(|group| group.on_restart == which) {
            for (place, value) in self.memory[group.first..].iter_mut().zip(&group.initial) {
                *place = N::from_f64(*value);
            }
        }
    }

    /// Returns everything the last step knew: states, readings, then its locals, in the order of the step's program.
    pub fn values(&self) -> Vec<f64> {
        self.memory.iter().map(Number::to_f64).collect()
    }

    /// Returns one state, by its place in [`Programs::states`].
    pub fn state(&self, place: usize) -> Option<f64> {
        self.memory[..self.programs.state_count()].get(place).map(Number::to_f64)
    }

    /// Returns the controller with given states, in the order of [`Programs::states`]; states beyond those given stay as they are.
    pub fn with_states(mut self, states: &[f64]) -> Self {
        let count = self.programs.state_count();
        for (place, value) in self.memory[..count].iter_mut().zip(states) {
            *place = N::from_f64(*value);
        }
        self
    }

    /// Returns the states, in the order of [`Programs::states`].
    pub fn states(&self) -> Vec<f64> {
        self.memory[..self.programs.state_count()].iter().map(Number::to_f64).collect()
    }
}

impl<N: Number> SampledController for Runner<N> {
    /// Puts every state back to its start, with the out-of-balance of the design, and forgets all faults. Which sensors are used stays
    /// as it was: that is a command, not a fault.
    fn reset(&mut self) {
        self.put_to_start(OnRestart::Restart);
        self.put_to_start(OnRestart::Keep);
        self.guard.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        self.step_array(&readings.to_array())
    }
}
