//! How large every number of a step becomes, from runs of the controller.

use counterpoise_controller::program::{Program, Slot};
use counterpoise_controller::{Controller, READINGS, SampledController};

/// Largest magnitude of every state, reading and local of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranges {
    states: usize,
    largest: Vec<f64>,
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
        let mut ranges = Self { states, largest: vec![0.0; states + READINGS + program.locals.len()] };
        for history in histories {
            for setting in [None, Some(low), Some(high)] {
                ranges.watch(controller, history, setting);
            }
        }
        ranges.largest.iter_mut().for_each(|largest| *largest *= margin);
        ranges
    }

    fn watch(&mut self, controller: &Controller, history: &[[f64; READINGS]], setting: Option<f64>) {
        let mut runner = controller.runner();
        runner.reset();
        for (k, readings) in history.iter().enumerate() {
            if let (Some(out_of_balance), true) = (setting, k == history.len() / 2) {
                runner.set_out_of_balance(out_of_balance);
                self.grow(&runner.states());
            }
            runner.step_array(readings);
            self.grow(&runner.values());
        }
    }

    fn grow(&mut self, values: &[f64]) {
        for (largest, value) in self.largest.iter_mut().zip(values) {
            *largest = largest.max(value.abs());
        }
    }

    /// Largest magnitude of a slot of the step.
    pub fn of(&self, slot: Slot) -> f64 {
        let place = match slot {
            Slot::State(i) => i,
            Slot::Input(i) => self.states + i,
            Slot::Local(i) => self.states + READINGS + i,
        };
        self.largest.get(place).copied().unwrap_or(0.0)
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
