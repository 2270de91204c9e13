//! Runs a fixed-point controller, integer by integer as the target does.

use counterpoise_controller::program::Slot;
use counterpoise_controller::{GuardSettings, READINGS, Readings, SampledController, SensorUse, Status};

use crate::AdjustableController;
use crate::fixed_point::format::{to_integer, unit};
use crate::fixed_point::guard::FixedGuard;
use crate::fixed_point::{FixedOperation, FixedPointController, FixedProgram, round_and_limit};

/// A fixed-point controller that runs.
#[derive(Debug, Clone)]
pub struct FixedRunner {
    fixed: FixedPointController,
    states: Vec<i64>,
    locals: Vec<i64>,
    guard: FixedGuard,
    /// Largest magnitude of each reading, in its unit.
    reading_limits: [f64; READINGS],
}

/// The value that a reading takes that is no number, or beyond its limit: an integer beyond every format.
const BEYOND: i64 = -(1 << 31);

impl FixedRunner {
    /// Returns the controller at its start.
    pub fn new(fixed: &FixedPointController) -> Self {
        let count = fixed.step.locals.len().max(fixed.set_out_of_balance.locals.len());
        Self {
            fixed: fixed.clone(),
            states: fixed.initial.clone(),
            locals: vec![0; count],
            guard: FixedGuard::new(fixed),
            reading_limits: GuardSettings::of(fixed.controller.parts()).limits,
        }
    }

    /// Returns one sample in integers: the readings in the formats of [`FixedProgram::inputs`], the control in
    /// its own.
    pub fn step_integers(&mut self, readings: &[i64; READINGS]) -> i64 {
        let taken = self.guard.take(readings);
        self.run(EntryPoint::Step, &taken);
        let output = self.fixed.controller.programs().step.output;
        output.map_or(0, |slot| self.read(slot, &taken))
    }

    /// Returns one sample: readings are rounded to their formats first. One that is no number, or beyond its limit, is
    /// replaced by the last good one; one beyond its format alone saturates.
    pub fn step_array(&mut self, readings: &[f64; READINGS]) -> f64 {
        let mut integers = self.fixed.step.integers(readings);
        for ((integer, reading), limit) in integers.iter_mut().zip(readings).zip(self.reading_limits) {
            if !(-limit..=limit).contains(reading) {
                *integer = BEYOND;
            }
        }
        self.step_integers(&integers) as f64 * unit(self.fixed.control_bits())
    }

    /// Sets the out-of-balance, kg m. What is no finite number is refused and changes nothing.
    pub fn set_out_of_balance(&mut self, out_of_balance_kg_m: f64) {
        if out_of_balance_kg_m.is_finite() {
            self.set_integer(to_integer(out_of_balance_kg_m, self.fixed.set_out_of_balance.inputs[0]));
        }
    }

    /// Hands the control over to feedback alone, or back to all sensors.
    pub fn use_sensors(&mut self, sensors: SensorUse) {
        self.guard.use_sensors(sensors);
    }

    /// Returns the flags of the last sample, and how many readings were replaced since the last reset.
    pub fn status(&self) -> Status {
        self.guard.status()
    }

    /// Sets the out-of-balance in its integer format.
    pub fn set_integer(&mut self, out_of_balance: i64) {
        self.run(EntryPoint::Set, &[out_of_balance]);
    }

    /// Returns the states as real numbers, in the order of the controller's.
    pub fn states(&self) -> Vec<f64> {
        self.states.iter().zip(&self.fixed.states).map(|(value, bits)| *value as f64 * unit(*bits)).collect()
    }

    fn run(&mut self, which: EntryPoint, inputs: &[i64]) {
        let count = self.program(which).operations.len();
        for number in 0..count {
            let (into, value) = self.evaluate(&self.program(which).operations[number], inputs);
            match into {
                Slot::State(i) => self.states[i] = value,
                Slot::Local(i) => self.locals[i] = value,
                Slot::Input(_) => {}
            }
        }
    }

    fn program(&self, which: EntryPoint) -> &FixedProgram {
        match which {
            EntryPoint::Step => &self.fixed.step,
            EntryPoint::Set => &self.fixed.set_out_of_balance,
        }
    }

    fn read(&self, slot: Slot, inputs: &[i64]) -> i64 {
        match slot {
            Slot::State(i) => self.states[i],
            Slot::Local(i) => self.locals[i],
            Slot::Input(i) => inputs[i],
        }
    }

    fn evaluate(&self, operation: &FixedOperation, inputs: &[i64]) -> (Slot, i64) {
        let read = |slot: &Slot| self.read(*slot, inputs);
        match operation {
            FixedOperation::Sum { into, constant, terms, shift } => {
                let sum = terms.iter().fold(*constant, |sum, term| sum + term.factor * read(&term.of));
                (*into, round_and_limit(sum, *shift))
            }
            FixedOperation::Product { into, a, b, shift } => {
                (*into, round_and_limit(read(a) * read(b), *shift))
            }
            FixedOperation::Quotient { into, above, below, left, shift } => {
                (*into, round_and_limit((read(above) * (1_i64 << left)) / read(below), *shift))
            }
            FixedOperation::Magnitude { into, of } => (*into, read(of).abs()),
            FixedOperation::Clamp { into, of, low, high } => (*into, read(of).clamp(*low, *high)),
        }
    }
}

#[derive(Debug, Clone, Copy)]
enum EntryPoint {
    Step,
    Set,
}

impl FixedPointController {
    /// Returns the fraction bits of the control.
    pub fn control_bits(&self) -> i32 {
        match self.controller.programs().step.output {
            Some(Slot::Local(i)) => self.step.locals[i],
            Some(Slot::State(i)) => self.states[i],
            Some(Slot::Input(i)) => self.step.inputs[i],
            None => 0,
        }
    }
}

impl SampledController for FixedRunner {
    fn reset(&mut self) {
        self.states.clone_from(&self.fixed.initial);
        self.guard.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        self.step_array(&readings.to_array())
    }
}

impl AdjustableController for FixedRunner {
    fn adjust(&mut self, out_of_balance_kg_m: f64) {
        self.set_out_of_balance(out_of_balance_kg_m);
    }

    fn clone_boxed(&self) -> Box<dyn AdjustableController> {
        Box::new(self.clone())
    }
}
