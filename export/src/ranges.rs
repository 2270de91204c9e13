//! How large every number of a step becomes, from runs of the controller and from what can be set.

mod settings;

use counterpoise_controller::program::{Program, Slot};
use counterpoise_controller::{Controller, Number, READINGS, Readings, Runner, SampledController};

pub(crate) use settings::settings;

/// Samples of a run in which the out-of-balance is set half way.
const SETTING_SAMPLES: usize = 4000;

/// A sampled controller whose out-of-balance can be set.
pub trait Adjustable: SampledController {
    /// Sets the out-of-balance, kg m.
    fn adjust(&mut self, out_of_balance_kg_m: f64);
}

impl<N: Number> Adjustable for Runner<N> {
    fn adjust(&mut self, out_of_balance_kg_m: f64) {
        self.set_out_of_balance(out_of_balance_kg_m);
    }
}

/// How far a controller was from the reference.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// Largest difference of a control, V.
    pub largest_v: f64,
    /// RMS difference in the run where it is largest, V.
    pub rms_v: f64,
}

/// Largest magnitude of every state, reading and local of a step, with the runs that it was taken from.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranges {
    states: usize,
    inputs: usize,
    largest: Vec<f64>,
    runs: Vec<Run>,
}

/// Readings of a run, and the out-of-balance that is set half way.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    /// Readings, one row a sample.
    pub readings: Vec<[f64; READINGS]>,
    /// What is set half way, kg m; nothing leaves the design's.
    pub set_kg_m: Option<f64>,
    /// The reference's control at every sample, V.
    pub reference_v: Vec<f64>,
}

impl Run {
    /// Returns the sample before which the out-of-balance is set.
    pub fn set_at(&self) -> Option<(usize, f64)> {
        self.set_kg_m.map(|value| (self.readings.len() / 2, value))
    }

    /// Calls `each` with every sample, and `set` before the sample at which the out-of-balance is set.
    pub fn play<S>(
        &self,
        state: &mut S,
        mut set: impl FnMut(&mut S, f64),
        mut each: impl FnMut(&mut S, usize, &[f64; READINGS]),
    ) {
        for (k, readings) in self.readings.iter().enumerate() {
            if let Some((_, value)) = self.set_at().filter(|(at, _)| *at == k) {
                set(state, value);
            }
            each(state, k, readings);
        }
    }
}

impl Ranges {
    /// Returns the ranges that occur when the controller gets these readings, times `margin`: each history with the
    /// design's out-of-balance, and its beginning with every other one at which gains have a corner (the lowest, the
    /// highest, the points of a schedule) set half way. Gains and bias get the whole range that can be set, by interval
    /// arithmetic.
    ///
    /// The readings are those of closed-loop runs: open loop, an integrator would wander out of any range.
    pub fn from_readings(controller: &Controller, histories: &[Vec<[f64; READINGS]>], margin: f64) -> Self {
        let states = controller.programs().state_count();
        let inputs = controller.programs().step.inputs.len();
        let count = states + inputs + controller.programs().step.locals.len();
        let mut ranges =
            Self { states, inputs, largest: vec![0.0; count], runs: runs(controller, histories) };
        for run in &mut ranges.runs {
            run.reference_v = watch(&mut ranges.largest, controller, run);
        }
        ranges.largest.iter_mut().for_each(|largest| *largest *= margin);
        for (state, bound) in settings::settable(controller, &ranges.largest[..states]) {
            ranges.largest[state] = ranges.largest[state].max(bound);
        }
        ranges
    }

    /// Returns the largest magnitude of a slot of the step.
    pub fn of(&self, slot: Slot) -> f64 {
        self.largest.get(self.place(slot)).copied().unwrap_or(0.0)
    }

    /// Returns how far a controller is from the reference from which the ranges come, given the readings and settings of its runs;
    /// `start` creates the controller for each run.
    pub fn measure(&self, start: &dyn Fn() -> Box<dyn Adjustable>) -> Measured {
        self.runs.iter().fold(Measured::default(), |most, run| {
            let mut found = Measured::default();
            run.play(
                &mut start(),
                |other, value| other.adjust(value),
                |other, k, readings| {
                    let off = run.reference_v[k] - other.step(&Readings::from_array(*readings));
                    found.largest_v = if off.abs() <= found.largest_v { found.largest_v } else { off.abs() };
                    found.rms_v += off * off / run.readings.len() as f64;
                },
            );
            Measured {
                largest_v: larger(most.largest_v, found.largest_v),
                rms_v: larger(most.rms_v, found.rms_v.sqrt()),
            }
        })
    }

    /// Returns the runs from which the ranges are taken.
    pub(crate) fn runs(&self) -> &[Run] {
        &self.runs
    }

    fn place(&self, slot: Slot) -> usize {
        match slot {
            Slot::State(i) => i,
            Slot::Input(i) => self.states + i,
            Slot::Local(i) => self.states + self.inputs + i,
        }
    }

    /// Returns the name of a slot, for a reader.
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

/// Returns every history as it is, and its beginning with each setting.
fn runs(controller: &Controller, histories: &[Vec<[f64; READINGS]>]) -> Vec<Run> {
    let mut all = Vec::new();
    for history in histories {
        all.push(Run { readings: history.clone(), set_kg_m: None, reference_v: Vec::new() });
        let beginning = &history[..history.len().min(SETTING_SAMPLES)];
        let with =
            |value| Run { readings: beginning.to_vec(), set_kg_m: Some(value), reference_v: Vec::new() };
        all.extend(settings(controller).into_iter().map(with));
    }
    all
}

/// Grows the largest magnitudes by those of a run; returns the control of every sample, V.
fn watch(largest: &mut [f64], controller: &Controller, run: &Run) -> Vec<f64> {
    let mut grow = |values: &[f64]| {
        for (most, value) in largest.iter_mut().zip(values) {
            *most = most.max(value.abs());
        }
    };
    let mut control_v = Vec::with_capacity(run.readings.len());
    run.play(
        &mut controller.runner(),
        |runner: &mut Runner, value| runner.set_out_of_balance(value),
        |runner, _, readings| {
            control_v.push(runner.step_array(readings));
            grow(&runner.values());
        },
    );
    control_v
}

/// Returns the larger of two; infinite if one is no number, as what grew out of all range is.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}
