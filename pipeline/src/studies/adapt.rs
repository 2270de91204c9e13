//! The adaptation put to the test: runs of the nonlinear closed loop in which the out-of-balance steps while the platform
//! moves, without and with adaptation, with the plant's amplifier and with a nonlinear one.

use std::f64::consts::TAU;

use counterpoise_controller::{Controller, SampledController};
use counterpoise_models::plant::Plant;
use counterpoise_models::{ControlledQuantity, MapPoint};
use counterpoise_recordings::{ColumnName, Signals};
use counterpoise_simulate::signal::Sine;
use counterpoise_simulate::{
    Detail, Imperfections, Initial, PlantState, PlatformMotion, Scenario, Signal, Simulator, TimeHistory,
};
use counterpoise_synth::adaptation::{Curve, Scale};
use counterpoise_synth::{
    AdaptiveController, Estimation, RecursiveLeastSquares, RecursiveSettings, WindowedMean,
};
use counterpoise_verify::Procedure;
use counterpoise_verify::signals::rms;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::budget::{Run, require_memory};
use crate::synth::controller_blocks::{dead_band_m_s2, drive_curve, inertia_v_s2_rad};
use crate::synth::schedule::scale_imbalance;
use crate::synth::torque_per_volt;
use crate::tolerance::{ADAPTED_FROM_SHARE, RETURNED, SMALL_KG_M};
use crate::{PipelineError, PlantModel, SynthesisedDesign};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{
    AdaptationMethod, AdaptationOptions, AdaptationUse, Compensation, ObserverOptions,
};

/// What happens in a run, in the order of the source thesis' figure 7-18.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunKind {
    /// The out-of-balance of the design, without adaptation.
    Default,
    /// One change of the out-of-balance, without adaptation.
    OneChange,
    /// One change, with adaptation from 0.7 of the run.
    OneChangeAdaptedLate,
    /// One change, with adaptation from 0.03 of the run.
    OneChangeAdapted,
    /// Several changes, without adaptation.
    SeveralChanges,
    /// Several changes, with adaptation.
    SeveralChangesAdapted,
    /// One change, with adaptation and a nonlinear amplifier.
    OneChangeNonlinear,
    /// Several changes, with adaptation and a nonlinear amplifier.
    SeveralChangesNonlinear,
}

impl RunKind {
    /// Returns the letter of the run, as in the source thesis' figure 7-18.
    pub fn letter(self) -> char {
        char::from(b'a' + self as u8)
    }
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct AdaptRun {
    /// What happens in it.
    pub kind: RunKind,
    /// `true` if the controller follows the estimate.
    pub adapts: bool,
    /// The parts of the run between changes.
    pub intervals: Vec<AdaptationInterval>,
    /// The run over time, every so many samples.
    pub trace: Signals<TraceColumn>,
}

/// A column of a run over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TraceColumn {
    /// Time, s.
    Time,
    /// True out-of-balance, kg m.
    OutOfBalance,
    /// Out-of-balance that the controller uses, kg m.
    UsedOutOfBalance,
    /// Control, V.
    Control,
    /// True hub rate, rad/s.
    HubRate,
}

impl TraceColumn {
    /// Number of columns.
    const COUNT: usize = 5;
}

impl ColumnName for TraceColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// A part of a run between changes. On an axis that slides its keys have that axis' units: `slide_rms_m_s` and `used_kg`.
#[derive(Debug, Clone, PartialEq)]
pub struct AdaptationInterval {
    /// The rate of the axis.
    pub rate: ControlledQuantity,
    /// Start and end, s.
    pub from_to_s: [f64; 2],
    /// Factor on the out-of-balance.
    pub factor: f64,
    /// True out-of-balance, kg m.
    pub out_of_balance_kg_m: f64,
    /// Out-of-balance that the controller uses at the end, kg m.
    pub used_kg_m: f64,
    /// RMS of the hub rate once the estimate has had time, rad/s.
    pub hub_rms_rad_s: f64,
    /// The same over that of run (a) in the same time.
    pub over_default: f64,
    /// The hub rate of which that RMS is, rad/s; empty if it was left out.
    pub settled_rates_rad_s: Vec<f64>,
    /// That of run (a) in the same time.
    pub default_rates_rad_s: Vec<f64>,
    /// `true` if the adaptation was in force throughout.
    pub adapted: bool,
}

impl Serialize for AdaptationInterval {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let of_balance = |stem: &str| format!("{stem}_{}", self.rate.axis.unit("kg m").replace(' ', "_"));
        map.serialize_entry("from_to_s", &self.from_to_s)?;
        map.serialize_entry("factor", &self.factor)?;
        map.serialize_entry(&of_balance("out_of_balance"), &self.out_of_balance_kg_m)?;
        map.serialize_entry(&of_balance("used"), &self.used_kg_m)?;
        map.serialize_entry(&self.rate.named_figure("hub_rms_rad_s"), &self.hub_rms_rad_s)?;
        map.serialize_entry("over_default", &self.over_default)?;
        map.serialize_entry("adapted", &self.adapted)?;
        if !self.settled_rates_rad_s.is_empty() {
            map.serialize_entry(&format!("settled_{}", self.rate.signal()), &self.settled_rates_rad_s)?;
            map.serialize_entry(&format!("default_{}", self.rate.signal()), &self.default_rates_rad_s)?;
        }
        map.end()
    }
}

impl AdaptationInterval {
    /// Returns whether the hub rate came back, where the adaptation was to bring it back.
    pub fn has_returned(&self) -> bool {
        !self.adapted || self.over_default <= RETURNED
    }
}

/// Summary of the adapted intervals of all runs.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AdaptedIntervals {
    /// Number of intervals with the adaptation in force throughout.
    pub intervals: usize,
    /// Number of those in which the hub rate came back.
    pub returned: usize,
    /// Largest hub rate over that of run (a).
    pub largest_over_default: f64,
    /// Largest error of the estimate at the end of an interval, kg m.
    pub largest_estimate_error_kg_m: f64,
}

impl AdaptedIntervals {
    /// Returns what the adapted intervals of runs came to.
    pub fn of(runs: &[AdaptRun]) -> Self {
        let adapted = runs.iter().flat_map(|run| &run.intervals).filter(|interval| interval.adapted);
        adapted.fold(Self::default(), |all, one| Self {
            intervals: all.intervals + 1,
            returned: all.returned + usize::from(one.has_returned()),
            largest_over_default: all.largest_over_default.max(one.over_default),
            largest_estimate_error_kg_m: all
                .largest_estimate_error_kg_m
                .max((one.used_kg_m - one.out_of_balance_kg_m).abs()),
        })
    }
}

/// Share of an interval that is left to the estimate before the RMS is taken.
const SETTLE: f64 = 0.4;
/// The instants of the single change, of the start of a late adaptation and of an early one; as shares of the run.
const CHANGE: f64 = 0.3;
const LATE: f64 = 0.7;
const EARLY: f64 = 0.03;
/// A trace has every so manieth sample.
const EVERY: usize = 10;

/// The plan of a run.
struct Plan {
    kind: RunKind,
    /// Start of each part as a share of the run, and the factor in it.
    parts: Vec<(f64, f64)>,
    /// Instant at which adaptation starts, as a share of the run.
    from: Option<f64>,
    amplifier: Amplifier,
}

/// The amplifier of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Amplifier {
    /// The project's own.
    Modelled,
    /// The one whose curve the trial states.
    Curved,
}

/// The mechanism and its controller, as every run needs them.
struct Stage<'a> {
    adaptation: &'a AdaptationOptions,
    observer: Option<&'a ObserverOptions>,
    controller: &'a Controller,
    modelled: &'a PlantModel,
    procedure: &'a Procedure,
    undo: Compensation,
}

/// Runs the study and returns all runs, (a) first. Runs with a nonlinear amplifier are included if the project gives its curve.
///
/// # Errors
/// A project without adaptation, and those of the plant and the simulator.
pub fn adapt(
    project: &Project,
    modelled: &PlantModel,
    made: &SynthesisedDesign,
) -> Result<Vec<AdaptRun>, PipelineError> {
    let missing = |section| PipelineError::Missing { section, needed_by: "`adapt`" };
    let asked = project.synth.as_ref().ok_or(missing("synth"))?;
    let adaptation = asked.options.adaptation.as_ref().ok_or(missing("synth.adaptation"))?;
    let verification = project.verify.as_ref().ok_or(missing("verify"))?;
    let controller = &made.sampled.controller;
    let (procedure, undo) = (&verification.procedure, asked.options.amplifier_curve);
    let (duration_s, period_s) = (adaptation.trial.duration_s, controller.sample_period_s());
    require_memory(Run { key: "synth.adaptation.trial.duration", duration_s, period_s })?;
    let observer = asked.options.observer.as_ref();
    let stage = Stage { adaptation, observer, controller, modelled, procedure, undo };
    let mut runs: Vec<AdaptRun> = Vec::new();
    for plan in plans(adaptation) {
        let (mut run, default) = (stage.run(&plan)?, stage.default_for(&plan)?);
        for (interval, usual) in run.intervals.iter_mut().zip(default) {
            interval.over_default = interval.hub_rms_rad_s / usual.hub_rms_rad_s;
            interval.default_rates_rad_s = usual.settled_rates_rad_s;
        }
        runs.push(run);
    }
    Ok(runs)
}

fn plans(adaptation: &AdaptationOptions) -> Vec<Plan> {
    let changes = &adaptation.trial.changes;
    let first = changes.iter().copied().find(|factor| *factor != 1.0).unwrap_or(1.0);
    let share = |k: usize| k as f64 / changes.len() as f64;
    let many: Vec<(f64, f64)> = changes.iter().enumerate().map(|(k, factor)| (share(k), *factor)).collect();
    let one = vec![(0.0, 1.0), (CHANGE, first)];
    let late = vec![(0.0, 1.0), (CHANGE, first), (LATE, first)];
    let plan =
        |kind, parts: &[(f64, f64)], from, amplifier| Plan { kind, parts: parts.to_vec(), from, amplifier };
    let mut plans = vec![
        plan(RunKind::Default, &[(0.0, 1.0)], None, Amplifier::Modelled),
        plan(RunKind::OneChange, &one, None, Amplifier::Modelled),
        plan(RunKind::OneChangeAdaptedLate, &late, Some(LATE), Amplifier::Modelled),
        plan(RunKind::OneChangeAdapted, &one, Some(EARLY), Amplifier::Modelled),
        plan(RunKind::SeveralChanges, &many, None, Amplifier::Modelled),
        plan(RunKind::SeveralChangesAdapted, &many, Some(EARLY), Amplifier::Modelled),
        plan(RunKind::OneChangeNonlinear, &one, Some(EARLY), Amplifier::Curved),
        plan(RunKind::SeveralChangesNonlinear, &many, Some(EARLY), Amplifier::Curved),
    ];
    plans
        .retain(|plan| plan.amplifier == Amplifier::Modelled || !adaptation.trial.amplifier_curve.is_empty());
    plans
}

/// The controller that acts: the controller alone, or with an estimator beside it.
enum ActiveController {
    Alone(Box<counterpoise_controller::Runner>),
    Beside(Box<AdaptiveController>),
}

/// The place of the out-of-balance that a controller uses.
#[derive(Clone, Copy)]
struct OutOfBalanceSource {
    /// Place among the controller's states.
    state: Option<usize>,
    /// Value if there is no such state.
    design_kg_m: f64,
}

/// The controller with a note of the out-of-balance that it uses.
struct OutOfBalanceRecorder {
    acting: ActiveController,
    source: OutOfBalanceSource,
    used_kg_m: Vec<f64>,
}

impl SampledController for OutOfBalanceRecorder {
    fn reset(&mut self) {
        self.acting.reset();
    }

    fn step(&mut self, readings: &counterpoise_controller::Readings) -> f64 {
        let control = self.acting.step(readings);
        self.used_kg_m.push(self.acting.used_kg_m(self.source));
        control
    }
}

/// Adds a part of a run to its trace.
fn extend_trace(
    trace: &mut Signals<TraceColumn>,
    from_s: f64,
    out_of_balance_kg_m: f64,
    history: &TimeHistory,
    used_kg_m: &[f64],
) {
    let (rate, control) = (history.truth.hub_rate_rad_s(), history.readings.control_request_v());
    let count = rate.len().min(used_kg_m.len()).min(control.len());
    for k in (0..count).step_by(EVERY) {
        let time_s = from_s + k as f64 * history.sample_period_s;
        // in the order of `TraceColumn`
        trace.push([time_s, out_of_balance_kg_m, used_kg_m[k], control[k], rate[k]]);
    }
}

impl SampledController for ActiveController {
    fn reset(&mut self) {
        match self {
            ActiveController::Alone(runner) => runner.reset(),
            ActiveController::Beside(adaptive) => adaptive.reset(),
        }
    }

    fn step(&mut self, readings: &counterpoise_controller::Readings) -> f64 {
        match self {
            ActiveController::Alone(runner) => runner.step(readings),
            ActiveController::Beside(adaptive) => adaptive.step(readings),
        }
    }
}

impl ActiveController {
    /// Returns the out-of-balance in force.
    fn used_kg_m(&self, source: OutOfBalanceSource) -> f64 {
        let OutOfBalanceSource { state: place, design_kg_m: design } = source;
        match self {
            ActiveController::Alone(runner) => place.and_then(|k| runner.state(k)).unwrap_or(design),
            ActiveController::Beside(adaptive) => adaptive.history_kg_m().last().copied().unwrap_or(design),
        }
    }
}

impl Stage<'_> {
    fn run(&self, plan: &Plan) -> Result<AdaptRun, PipelineError> {
        let plant = self.plant(plan.amplifier)?;
        let (mut state, mut angle) = (None, self.procedure.operating_point.platform_angle_rad);
        let moment = self.modelled.plant.body().out_of_balance_kg_m;
        let states = &self.controller.programs().states;
        let place = states.iter().find(|group| group.name == "out_of_balance_kg_m").map(|group| group.first);
        let source = OutOfBalanceSource { state: place, design_kg_m: moment };
        let mut noted =
            OutOfBalanceRecorder { acting: self.acting_controller(plan)?, source, used_kg_m: Vec::new() };
        let (mut intervals, mut trace) = (Vec::new(), Signals::zeros(0, TraceColumn::COUNT));
        for (k, &(start, factor)) in plan.parts.iter().enumerate() {
            let end = plan.parts.get(k + 1).map_or(1.0, |part| part.0);
            let history =
                self.part(&scale_imbalance(&plant, factor)?, &mut noted, [start, end], state, angle)?;
            let from_s = start * self.adaptation.trial.duration_s;
            let used_kg_m = std::mem::take(&mut noted.used_kg_m);
            extend_trace(&mut trace, from_s, factor * moment, &history, &used_kg_m);
            let is_exported = self.adaptation.use_in_code == AdaptationUse::Exported;
            let late = is_exported && plan.from.is_some_and(|from| from <= start + ADAPTED_FROM_SHARE);
            intervals.push(AdaptationInterval {
                rate: self.modelled.parameters.controlled_quantity().rate(),
                from_to_s: [start, end].map(|share| share * self.adaptation.trial.duration_s),
                factor,
                out_of_balance_kg_m: factor * moment,
                used_kg_m: noted.acting.used_kg_m(source),
                hub_rms_rad_s: rms(settled_rates(&history)),
                over_default: 1.0,
                settled_rates_rad_s: settled_rates(&history).to_vec(),
                default_rates_rad_s: Vec::new(),
                adapted: late,
            });
            angle = history.truth.platform_angle_rad().last().copied().unwrap_or(angle);
            state = Some(history.final_state);
        }
        let adapts = plan.from.is_some();
        Ok(AdaptRun { kind: plan.kind, adapts, intervals, trace })
    }

    /// Returns the default case in the parts of a plan.
    fn default_for(&self, plan: &Plan) -> Result<Vec<AdaptationInterval>, PipelineError> {
        let parts = plan.parts.iter().map(|(start, _)| (*start, 1.0)).collect();
        let default = Plan { kind: RunKind::Default, parts, from: None, amplifier: Amplifier::Modelled };
        Ok(self.run(&default)?.intervals)
    }

    fn plant(&self, amplifier: Amplifier) -> Result<Plant, PipelineError> {
        if amplifier == Amplifier::Modelled {
            return Ok(self.modelled.plant.clone());
        }
        let mut parameters = self.modelled.plant.parameters().clone();
        let curve = &self.adaptation.trial.amplifier_curve;
        parameters.amplifier.map =
            curve.iter().map(|&[input_v, current_a]| MapPoint { input_v, current_a }).collect();
        Ok(Plant::with_whole_body(&parameters, self.modelled.plant.body().clone())?)
    }

    /// Runs a part of a plan, given by the shares of the run at which it starts and ends, from a state and the platform's angle in radians.
    fn part(
        &self,
        plant: &Plant,
        acting: &mut OutOfBalanceRecorder,
        [start, end]: [f64; 2],
        state: Option<PlantState>,
        angle: f64,
    ) -> Result<TimeHistory, PipelineError> {
        let whole = self.adaptation.trial.duration_s;
        let from_s = start * whole;
        let rest = Initial::Rest { hub_angle_rad: self.procedure.operating_point.hub_angle_rad };
        let sine = |sine: &counterpoise_verify::Sine| {
            let frequency_rad_s = TAU * sine.frequency_hz;
            Signal::Sines(vec![Sine {
                amplitude: sine.amplitude,
                frequency_rad_s,
                phase_rad: frequency_rad_s * from_s,
            }])
        };
        let platform = PlatformMotion {
            heave_m_s2: sine(&self.procedure.heave),
            pitch_rate_rad_s: sine(&self.procedure.pitch),
            initial_angle_rad: angle,
            further: None,
        };
        let scenario = Scenario {
            platform,
            imperfections: Imperfections::NoiseAndQuantisation { seed: self.procedure.seed + from_s as u64 },
            initial: state.map_or(rest, |state| Initial::State(Box::new(state))),
            detail: Detail::Everything,
            ..Scenario::at_rest((end - start) * whole)
        };
        Ok(Simulator::new(plant)?.run(acting, &scenario)?)
    }

    /// Returns the exported controller with its own estimator, held until its time. Where the amplifier's curve is left in
    /// the loop, an estimator beside the controller knows it.
    fn acting_controller(&self, plan: &Plan) -> Result<ActiveController, PipelineError> {
        let held = plan.from.map(|from| (from * self.adaptation.trial.duration_s / self.period_s()) as u32);
        let beside =
            plan.amplifier == Amplifier::Curved && self.undo == Compensation::Absent && held.is_some();
        let curve = match (plan.amplifier, self.undo) {
            (Amplifier::Curved, Compensation::Applied) => self.drive_curve(),
            _ => Vec::new(),
        };
        let controller = self.controller.with(|parts| {
            parts.drive_curve = curve;
            parts.estimator = parts.estimator.take().filter(|_| held.is_some() && !beside);
            if let (Some(estimator), Some(samples)) = (&mut parts.estimator, held) {
                estimator.hold_samples = samples;
            }
        });
        let runner = controller.map_err(counterpoise_synth::Error::from)?.runner();
        match self.estimation(plan.amplifier)?.filter(|_| beside) {
            None => Ok(ActiveController::Alone(Box::new(runner))),
            Some(estimation) => {
                let held = held.unwrap_or(0) as usize;
                Ok(ActiveController::Beside(Box::new(
                    AdaptiveController::new(runner, estimation).hold_estimates(held),
                )))
            }
        }
    }

    /// Returns an estimator beside the controller; none for the gradient.
    fn estimation(&self, amplifier: Amplifier) -> Result<Option<Estimation>, PipelineError> {
        let period_s = self.period_s();
        Ok(match self.adaptation.method {
            AdaptationMethod::Gradient => None,
            AdaptationMethod::WindowedMean => {
                let window = (self.adaptation.window_s / period_s).round() as usize;
                Some(Estimation::Mean(WindowedMean::new(self.scale(amplifier), window)?))
            }
            AdaptationMethod::Recursive => Some(Estimation::Squares(Box::new(RecursiveLeastSquares::new(
                self.settings(amplifier, period_s),
            )?))),
        })
    }

    fn period_s(&self) -> f64 {
        self.modelled.parameters.interface.sample_period_s
    }

    fn drive_curve(&self) -> Vec<[f64; 2]> {
        let p = &self.modelled.parameters;
        let point = |&[input_v, current_a]: &[f64; 2]| MapPoint { input_v, current_a };
        let map: Vec<MapPoint> = self.adaptation.trial.amplifier_curve.iter().map(point).collect();
        drive_curve(&map, p.amplifier.stall_gain_a_v(&p.motor))
    }

    fn settings(&self, amplifier: Amplifier, sample_period_s: f64) -> RecursiveSettings {
        let start_kg_m = self.modelled.plant.body().out_of_balance_kg_m;
        RecursiveSettings {
            scale: self.scale(amplifier),
            memory_s: self.adaptation.memory_s,
            sample_period_s,
            dead_band_m_s2: dead_band_m_s2(self.adaptation, self.modelled, self.observer),
            half_rate_rad_s: self.adaptation.half_rate_rad_s,
            rate_limit_kg_m_s: self.adaptation.rate_limit_kg_m_s,
            start_kg_m,
            start_deviation_kg_m: start_kg_m.abs().max(SMALL_KG_M),
            filter_s: self.adaptation.filter_s,
            inertia_v_s2_rad: inertia_v_s2_rad(self.modelled),
        }
    }

    /// Returns volts and gravity, and the amplifier's curve as it was identified, made odd.
    fn scale(&self, amplifier: Amplifier) -> Scale {
        let p = &self.modelled.parameters;
        let gain = p.amplifier.stall_gain_a_v(&p.motor);
        let mut points: Vec<(f64, f64)> = Vec::new();
        if amplifier == Amplifier::Curved {
            let curve = &self.adaptation.trial.amplifier_curve;
            let beyond_0 = || curve.iter().filter(|point| point[0] > 0.0);
            points.extend(beyond_0().rev().map(|[v, i]| (-v, -i / gain)));
            points.push((0.0, 0.0));
            points.extend(beyond_0().map(|[v, i]| (*v, i / gain)));
        }
        Scale {
            volts_per_kg_m_s2: 1.0 / torque_per_volt(p),
            gravity_m_s2: p.gravity_m_s2,
            curve: Curve { points },
        }
    }
}

/// Returns the true hub rate in the later part of a run.
fn settled_rates(history: &TimeHistory) -> &[f64] {
    let all = history.truth.hub_rate_rad_s();
    &all[(SETTLE * all.len() as f64) as usize..]
}
