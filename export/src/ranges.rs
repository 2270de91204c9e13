//! The range of every number of a step, from runs of the controller and from what can be set.

mod settings;

use std::cell::RefCell;

use counterpoise_controller::program::{Program, Slot};
use counterpoise_controller::{Controller, Number, READINGS, Readings, Runner, SampledController};

pub(crate) use settings::settings;

/// Samples of a run in which the out-of-balance is set half way.
const SETTING_SAMPLES: usize = 4000;

/// A sampled controller whose out-of-balance can be set.
pub trait AdjustableController: SampledController {
    /// Sets the out-of-balance, kg m.
    fn adjust(&mut self, out_of_balance_kg_m: f64);
    /// Returns a copy with the states of this moment.
    fn clone_boxed(&self) -> Box<dyn AdjustableController>;
}

impl<N: Number + 'static> AdjustableController for Runner<N> {
    fn adjust(&mut self, out_of_balance_kg_m: f64) {
        self.set_out_of_balance(out_of_balance_kg_m);
    }

    fn clone_boxed(&self) -> Box<dyn AdjustableController> {
        Box::new(self.clone())
    }
}

/// Measured deviation of a controller from the reference.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeasuredDeviation {
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
    /// Out-of-balance that is set half way, kg m; `None` leaves the design's.
    pub set_kg_m: Option<f64>,
    /// The reference's control at every sample, V.
    pub reference_v: Vec<f64>,
}

impl Run {
    /// Returns the sample before which the out-of-balance is set.
    pub fn set_at(&self) -> Option<(usize, f64)> {
        self.set_kg_m.map(|value| (self.readings.len() / 2, value))
    }
}

impl Clone for Box<dyn AdjustableController> {
    fn clone(&self) -> Self {
        (**self).clone_boxed()
    }
}

/// The visitor of a run.
pub(crate) trait RunVisitor<S> {
    /// The state before the first sample.
    fn start(&self) -> S;
    /// The out-of-balance is set.
    fn set(&self, state: &mut S, out_of_balance_kg_m: f64);
    /// A sample of the run.
    fn sample(&self, state: &mut S, run: &Run, k: usize);
}

/// A controller along a run, and a voltage of every sample so far: its control, or how far that is from the reference's.
#[derive(Clone)]
pub(crate) struct RunState<A> {
    pub acting: A,
    pub voltages_v: Vec<f64>,
}

impl<A> RunState<A> {
    /// Returns a controller before its first sample.
    pub fn of(acting: A) -> Self {
        Self { acting, voltages_v: Vec::new() }
    }
}

/// Plays runs; returns the state after each. Runs in which the out-of-balance is set follow the run without, whose beginning they
/// share: up to the setting they are played once.
pub(crate) fn play_runs<S: Clone>(runs: &[Run], visitor: &impl RunVisitor<S>) -> Vec<S> {
    let mut ends = Vec::with_capacity(runs.len());
    let mut at_setting: Option<S> = None;
    for (i, run) in runs.iter().enumerate() {
        let mut first = 0;
        let mut state = visitor.start();
        match run.set_at() {
            None => at_setting = None,
            Some((at, value)) if at < run.readings.len() => {
                if let Some(shared) = &at_setting {
                    (state, first) = (shared.clone(), at);
                }
                (first..at).for_each(|k| visitor.sample(&mut state, run, k));
                visitor.set(&mut state, value);
                first = at;
            }
            Some(_) => {}
        }
        let branch = runs.get(i + 1).and_then(Run::set_at).filter(|_| run.set_kg_m.is_none());
        for k in first..run.readings.len() {
            if branch.is_some_and(|(at, _)| at == k) {
                at_setting = Some(state.clone());
            }
            visitor.sample(&mut state, run, k);
        }
        ends.push(state);
    }
    ends
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
        let largest_values =
            LargestValues { controller, largest: RefCell::new(std::mem::take(&mut ranges.largest)) };
        let controls = play_runs(&ranges.runs, &largest_values);
        ranges.largest = largest_values.largest.into_inner();
        for (run, state) in ranges.runs.iter_mut().zip(controls) {
            run.reference_v = state.voltages_v;
        }
        ranges.largest.iter_mut().for_each(|largest| *largest *= margin);
        for (state, bound) in settings::setting_bounds(controller, &ranges.largest[..states]) {
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
    pub fn measure(&self, start: &dyn Fn() -> Box<dyn AdjustableController>) -> MeasuredDeviation {
        play_runs(&self.runs, &Comparison { start }).into_iter().fold(
            MeasuredDeviation::default(),
            |most, state| {
                let mut found = MeasuredDeviation::default();
                for off in &state.voltages_v {
                    found.largest_v = if off.abs() <= found.largest_v { found.largest_v } else { off.abs() };
                    found.rms_v += off * off / state.voltages_v.len() as f64;
                }
                MeasuredDeviation {
                    largest_v: larger_bound(most.largest_v, found.largest_v),
                    rms_v: larger_bound(most.rms_v, found.rms_v.sqrt()),
                }
            },
        )
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

/// The reference, which grows the largest magnitudes; its control of every sample, V, is kept.
struct LargestValues<'a> {
    controller: &'a Controller,
    largest: RefCell<Vec<f64>>,
}

impl RunVisitor<RunState<Runner>> for LargestValues<'_> {
    fn start(&self) -> RunState<Runner> {
        RunState::of(self.controller.runner())
    }

    fn set(&self, state: &mut RunState<Runner>, out_of_balance_kg_m: f64) {
        state.acting.set_out_of_balance(out_of_balance_kg_m);
    }

    fn sample(&self, state: &mut RunState<Runner>, run: &Run, k: usize) {
        state.voltages_v.push(state.acting.step_array(&run.readings[k]));
        for (most, value) in self.largest.borrow_mut().iter_mut().zip(state.acting.values()) {
            *most = most.max(value.abs());
        }
    }
}

/// A controller beside the reference.
struct Comparison<'a> {
    start: &'a dyn Fn() -> Box<dyn AdjustableController>,
}

impl RunVisitor<RunState<Box<dyn AdjustableController>>> for Comparison<'_> {
    fn start(&self) -> RunState<Box<dyn AdjustableController>> {
        RunState::of((self.start)())
    }

    fn set(&self, state: &mut RunState<Box<dyn AdjustableController>>, out_of_balance_kg_m: f64) {
        state.acting.adjust(out_of_balance_kg_m);
    }

    fn sample(&self, state: &mut RunState<Box<dyn AdjustableController>>, run: &Run, k: usize) {
        let control_v = state.acting.step(&Readings::from_array(run.readings[k]));
        state.voltages_v.push(run.reference_v[k] - control_v);
    }
}

/// Returns the larger of two; infinite if one is no number, as what grew out of all range is.
pub(crate) fn larger_bound(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}
