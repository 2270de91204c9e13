//! How large every number of a step becomes, from runs of the controller.

use counterpoise_controller::program::{Program, Slot};
use counterpoise_controller::{Controller, Number, READINGS};

/// Largest magnitude and RMS of every state, reading and local of a step, and what rounded coefficients do.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranges {
    states: usize,
    largest: Vec<f64>,
    /// Sum of squares of the liveliest run, a sample.
    mean_square: Vec<f64>,
    coefficients_v: f64,
    coefficients_mean_square: f64,
}

impl Ranges {
    /// The ranges that occur when the controller gets these readings, times `margin`, each history run three times: with
    /// the design's out-of-balance throughout, and with the lowest and the highest one set half way.
    ///
    /// The readings are those of closed-loop runs: open loop, an integrator would wander out of any range.
    pub fn from_readings(controller: &Controller, histories: &[Vec<[f64; READINGS]>], margin: f64) -> Self {
        let (low, high) = controller.parts().out_of_balance_range_kg_m;
        let program = &controller.programs().step;
        let states = controller.programs().state_count();
        let count = states + READINGS + program.locals.len();
        let mut ranges = Self {
            states,
            largest: vec![0.0; count],
            mean_square: vec![0.0; count],
            coefficients_v: 0.0,
            coefficients_mean_square: 0.0,
        };
        for history in histories {
            for setting in [None, Some(low), Some(high)] {
                ranges.watch(controller, history, setting);
            }
        }
        ranges.largest.iter_mut().for_each(|largest| *largest *= margin);
        ranges.coefficients_v *= margin;
        ranges
    }

    fn watch(&mut self, controller: &Controller, history: &[[f64; READINGS]], setting: Option<f64>) {
        let (mut runner, mut stored) = (controller.runner(), controller.runner_in::<Stored>());
        let mut squares = vec![0.0; self.largest.len()];
        let mut off_squares = 0.0;
        for (k, readings) in history.iter().enumerate() {
            if let (Some(out_of_balance), true) = (setting, k == history.len() / 2) {
                runner.set_out_of_balance(out_of_balance);
                stored.set_out_of_balance(out_of_balance);
                self.grow(&runner.states());
            }
            let off = stored.step_array(readings) - runner.step_array(readings);
            self.coefficients_v = self.coefficients_v.max(off.abs());
            off_squares += off * off;
            let values = runner.values();
            self.grow(&values);
            squares.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value * value);
        }
        let samples = history.len().max(1) as f64;
        self.coefficients_mean_square = self.coefficients_mean_square.max(off_squares / samples);
        for (most, sum) in self.mean_square.iter_mut().zip(squares) {
            *most = most.max(sum / samples);
        }
    }

    fn grow(&mut self, values: &[f64]) {
        for (largest, value) in self.largest.iter_mut().zip(values) {
            *largest = largest.max(value.abs());
        }
    }

    /// Largest magnitude of a slot of the step.
    pub fn of(&self, slot: Slot) -> f64 {
        self.largest.get(self.place(slot)).copied().unwrap_or(0.0)
    }

    /// RMS of a slot in the liveliest run, without the margin.
    pub fn rms(&self, slot: Slot) -> f64 {
        self.mean_square.get(self.place(slot)).copied().unwrap_or(0.0).sqrt()
    }

    /// Largest deviation of the control, V, with coefficients and readings rounded to single precision and everything
    /// else in double, times the margin.
    pub fn of_coefficients_v(&self) -> f64 {
        self.coefficients_v
    }

    /// The RMS of that deviation in the run where it is largest, V, without the margin.
    pub fn of_coefficients_rms_v(&self) -> f64 {
        self.coefficients_mean_square.sqrt()
    }

    fn place(&self, slot: Slot) -> usize {
        match slot {
            Slot::State(i) => i,
            Slot::Input(i) => self.states + i,
            Slot::Local(i) => self.states + READINGS + i,
        }
    }

    /// The same ranges with the largest readings given: a converter's full scale.
    #[must_use]
    pub fn with_readings(mut self, largest: [f64; READINGS]) -> Self {
        for (place, value) in self.largest.iter_mut().skip(self.states).zip(largest) {
            *place = place.max(value);
        }
        self
    }

    /// Name of a slot, for a reader.
    pub(crate) fn name(controller: &Controller, program: &Program, slot: Slot) -> String {
        let named = |names: &[String], i: usize| names.get(i).cloned().unwrap_or_default();
        match slot {
            Slot::Input(i) => named(&program.inputs, i),
            Slot::Local(i) => named(&program.locals, i),
            Slot::State(i) => match controller.programs().locate(i) {
                Some((group, k)) if group.length.is_some() => format!("{}[{k}]", group.name),
                Some((group, _)) => group.name.clone(),
                None => String::new(),
            },
        }
    }
}

/// A number in double that was stored in single precision: what [`Number::from_f64`] takes is rounded, arithmetic is not.
#[derive(Debug, Clone, Copy)]
struct Stored(f64);

impl Number for Stored {
    fn from_f64(value: f64) -> Self {
        Self(f64::from(value as f32))
    }
    fn to_f64(&self) -> f64 {
        self.0
    }
    fn plus(&self, other: &Self) -> Self {
        Self(self.0 + other.0)
    }
    fn times(&self, other: &Self) -> Self {
        Self(self.0 * other.0)
    }
    fn over(&self, other: &Self) -> Self {
        Self(self.0 / other.0)
    }
    fn magnitude(&self) -> Self {
        Self(self.0.abs())
    }
    fn clamped(&self, low: &Self, high: &Self) -> Self {
        Self(self.0.max(low.0).min(high.0))
    }
}
