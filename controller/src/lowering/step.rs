//! The program of one sample.

use counterpoise_lti::StateSpace;

use crate::lowering::estimate;
use crate::lowering::learnt_level::LearntLevel;
use crate::lowering::regressors::EstimatorInputs;
use crate::lowering::schedule::Layout;
use crate::lowering::{
    Limits, PREFILTER_STATES, PREVIOUS_CONTROL, States, Update, Writer, curve, friction_observers, project,
    reading_names,
};
use crate::program::{OnRestart, Program, ProgramTerm, Slot};
use crate::signal::PLATFORM_ACCELERATION;
use crate::{DemandLimit, FrictionObserver, Parts, Path, PathSignal, READINGS};

/// The place of each signal of this step.
struct Signals {
    readings: [Slot; READINGS],
    rate_error: Option<Slot>,
    relative_rate: Option<Slot>,
    previous_control: Option<Slot>,
}

impl Signals {
    fn slot(&self, signal: PathSignal) -> Slot {
        let derived = match signal {
            PathSignal::RateError => self.rate_error,
            PathSignal::RelativeRate => self.relative_rate,
            PathSignal::PreviousControl => self.previous_control,
            _ => None,
        };
        derived.unwrap_or(self.readings[signal.reading().unwrap_or(0)])
    }
}

/// The states and inputs of a path.
struct PathSlots<'a> {
    x: &'a [Slot],
    u: &'a [Slot],
}

/// The part that the limiter cut off, and the gain of each state on it.
struct AntiWindup<'a> {
    excess: Slot,
    gains: &'a [f64],
}

/// The control before and after the limiter.
struct Control {
    unlimited: Slot,
    limited: Slot,
}

/// Writes the program of a sample and hands out the states it needs.
pub(crate) fn program(parts: &Parts, layout: &Layout, states: &mut States) -> Program {
    let mut writer = Writer::new(&reading_names(parts));
    let mut pending = Vec::new();
    let mut signals = write_corrections(parts, &mut writer);
    if let Some(projection) = parts.projection {
        let given =
            project::ProjectionInput { readings: &signals.readings, sample_period_s: parts.sample_period_s };
        let across = project::project_across_beam(projection, &given, states, &mut writer, &mut pending);
        signals.readings[PLATFORM_ACCELERATION] = across;
    }
    demand_rate(parts, &mut signals, states, &mut writer, &mut pending);
    prefilter(parts, &mut signals, states, &mut writer, &mut pending);
    derive(parts, &mut signals, states, &mut writer);
    let observe = |o: &FrictionObserver| {
        friction_observers::observe(o, signals.slot(o.rate), parts.sample_period_s, states, &mut writer)
    };
    let observed: Vec<Slot> = parts.observers.iter().map(observe).collect();
    let learning = parts.level_learning.as_ref().filter(|_| !observed.is_empty());
    let learnt = learning.map(|learning| LearntLevel::write_volts(*learning, &observed, states, &mut writer));
    let dry = learnt.as_ref().map_or(observed, |learnt| vec![learnt.cancelled]);
    let path_states: Vec<Vec<Slot>> =
        parts.paths.iter().map(|path| states.array(&path.name, path.system.order())).collect();
    let outputs = outputs(parts, layout, &signals, &path_states, &mut writer);
    let control = control(parts, layout, &outputs, &dry, &mut writer);
    let limited = control.limited;
    let driven = drive(parts, limited, &mut writer);
    let excess = excess(parts, &control, &mut writer);
    for (path, x) in parts.paths.iter().zip(&path_states) {
        let u: Vec<Slot> = path.inputs.iter().map(|signal| signals.slot(*signal)).collect();
        advance(path, &PathSlots { x, u: &u }, excess, &mut writer, &mut pending);
    }
    writer.section("new states");
    pending.extend(signals.previous_control.map(|state| Update { state, value: limited }));
    for Update { state, value } in pending {
        writer.copy(state, value);
    }
    if let (Some(learnt), Some(first)) = (&learnt, parts.observers.first()) {
        let fed_back = parts.paths.iter().zip(&outputs).filter(|(path, _)| path.is_feedback());
        let feedback: Vec<Slot> = fed_back.map(|(_, output)| *output).collect();
        learnt.write_learning(&feedback, signals.slot(first.rate), parts.sample_period_s, &mut writer);
    }
    fade(parts, layout, &mut writer);
    let signal = |signal| signals.slot(signal);
    estimate::estimate(
        &EstimatorInputs { parts, layout, signal: &signal, control: limited },
        states,
        &mut writer,
    );
    writer.finish(Some(driven))
}

fn write_corrections(parts: &Parts, writer: &mut Writer) -> Signals {
    let mut readings = std::array::from_fn(Slot::Input);
    writer.section("corrected readings");
    for each in &parts.corrections {
        let reading = &mut readings[each.reading];
        let into = writer.local(format!("corrected_{}", crate::READING_NAMES[each.reading]));
        writer.sum_into(into, Some(each.offset), &[each.gain * *reading]);
        *reading = into;
    }
    Signals { readings, rate_error: None, relative_rate: None, previous_control: None }
}

/// Writes the demand that moves by a limited way a sample: from the first reading on, so that a machine that stands away from 0 does
/// not move before it is asked to. Within the limit it is the demand itself, to the last bit.
fn demand_rate(
    parts: &Parts,
    signals: &mut Signals,
    states: &mut States,
    writer: &mut Writer,
    pending: &mut Vec<Update>,
) {
    let Some(DemandLimit::Rate(most)) = parts.demand_limit else { return };
    writer.section("demand within its largest rate");
    let before = states.scalar("demand_before", 0.0, OnRestart::Restart);
    let followed = states.scalar("demand_followed", 0.0, OnRestart::Restart);
    let [demand, measured, ..] = signals.readings;
    let kept = writer.product("demand_kept", followed, before);
    let at_start = writer.local("demand_is_new");
    writer.sum_into(at_start, Some(1.0), &[-1.0 * followed]);
    let from = writer.product("demand_at_start", at_start, measured);
    let way = writer.sum("demand_way", &[1.0 * demand, -1.0 * kept, -1.0 * from]);
    let step = writer.clamp("demand_step", way, Limits::symmetric(most * parts.sample_period_s));
    let cut = writer.sum("demand_cut", &[1.0 * way, -1.0 * step]);
    let limited = writer.sum("limited_demand", &[1.0 * demand, -1.0 * cut]);
    let following = writer.local("demand_following");
    writer.sum_into(following, Some(1.0), &[]);
    pending.extend([Update { state: before, value: limited }, Update { state: followed, value: following }]);
    signals.readings[0] = limited;
}

fn prefilter(
    parts: &Parts,
    signals: &mut Signals,
    states: &mut States,
    writer: &mut Writer,
    pending: &mut Vec<Update>,
) {
    let Some(system) = &parts.prefilter else { return };
    writer.section("reference prefilter");
    let x = states.array(PREFILTER_STATES, system.order());
    let demand = signals.readings[0];
    let filtered = writer.sum("filtered_demand_rad_s", &row(&system.C, &system.D, 0, &x, &[demand]));
    new_states(PREFILTER_STATES, system, &PathSlots { x: &x, u: &[demand] }, None, writer, pending);
    signals.readings[0] = filtered;
}

fn derive(parts: &Parts, signals: &mut Signals, states: &mut States, writer: &mut Writer) {
    let used = |signal: PathSignal| {
        parts.paths.iter().any(|path| path.inputs.contains(&signal))
            || parts.observers.iter().any(|observer| observer.rate == signal)
            || parts.estimator.as_ref().is_some_and(|estimator| estimator.rate == signal)
    };
    writer.section("derived signals");
    let [demand, hub, platform, ..] = signals.readings;
    signals.rate_error = used(PathSignal::RateError)
        .then(|| writer.sum(PathSignal::RateError.name(), &[1.0 * demand, -1.0 * hub]));
    if let (Some(DemandLimit::Error(most)), Some(error)) = (parts.demand_limit, signals.rate_error) {
        signals.rate_error = Some(writer.clamp("limited_error", error, Limits::symmetric(most)));
    }
    signals.relative_rate = used(PathSignal::RelativeRate)
        .then(|| writer.sum(PathSignal::RelativeRate.name(), &[1.0 * hub, -1.0 * platform]));
    signals.previous_control =
        used(PathSignal::PreviousControl).then(|| states.scalar(PREVIOUS_CONTROL, 0.0, OnRestart::Restart));
}

/// Writes C x + D u of each path, times its gain if it follows the out-of-balance.
fn outputs(
    parts: &Parts,
    layout: &Layout,
    signals: &Signals,
    path_states: &[Vec<Slot>],
    writer: &mut Writer,
) -> Vec<Slot> {
    let mut outputs = Vec::new();
    for ((path, x), followed) in parts.paths.iter().zip(path_states).zip(&layout.paths) {
        writer.section(format!("output of path {}", path.name));
        let u: Vec<Slot> = path.inputs.iter().map(|signal| signals.slot(*signal)).collect();
        let own = writer.sum(format!("{}_v", path.name), &row(&path.system.C, &path.system.D, 0, x, &u));
        outputs.push(match followed {
            None => own,
            Some(followed) => {
                writer.copy(followed.last, own);
                writer.product(format!("{}_scaled_v", path.name), followed.gain, own)
            }
        });
    }
    outputs
}

fn control(
    parts: &Parts,
    layout: &Layout,
    outputs: &[Slot],
    friction: &[Slot],
    writer: &mut Writer,
) -> Control {
    writer.section("control: paths, friction, bias and transfer, in this order, then the limiter");
    let all = outputs.iter().chain(friction).copied().chain(layout.bias).chain(layout.transfer);
    let terms: Vec<ProgramTerm> = all.map(|slot| 1.0 * slot).collect();
    let control = writer.sum("control_v", &terms);
    let limit = parts.equivalent_limit_v();
    let limited = writer.clamp("limited_v", control, Limits::symmetric(limit));
    Control { unlimited: control, limited }
}

/// Writes the control that has the effect of the limited volts of a linear drive.
fn drive(parts: &Parts, limited: Slot, writer: &mut Writer) -> Slot {
    if parts.drive_curve.is_empty() {
        return limited;
    }
    writer.section("inverse of the drive's measured curve");
    let mut points: Vec<[f64; 2]> =
        parts.drive_curve.iter().copied().take_while(|point| point[1] < parts.limit_v).collect();
    points.push([parts.equivalent_limit_v(), parts.limit_v]);
    let driven = curve::write_odd_curve(writer, "driven_v", limited, &points);
    writer.clamp("driven_limited_v", driven, Limits::symmetric(parts.limit_v))
}

/// Writes limited - unlimited control, if a path uses it.
fn excess(parts: &Parts, control: &Control, writer: &mut Writer) -> Option<Slot> {
    let used = parts.paths.iter().any(|path| path.anti_windup.iter().any(|gain| *gain != 0.0));
    used.then(|| writer.sum("excess_v", &[1.0 * control.limited, -1.0 * control.unlimited]))
}

fn advance(
    path: &Path,
    slots: &PathSlots,
    excess: Option<Slot>,
    writer: &mut Writer,
    pending: &mut Vec<Update>,
) {
    writer.section(format!("states of path {}", path.name));
    let windup = excess.map(|excess| AntiWindup { excess, gains: &path.anti_windup });
    new_states(&path.name, &path.system, slots, windup, writer, pending);
}

fn new_states(
    name: &str,
    system: &StateSpace,
    slots: &PathSlots,
    windup: Option<AntiWindup>,
    writer: &mut Writer,
    pending: &mut Vec<Update>,
) {
    for (i, &state) in slots.x.iter().enumerate() {
        let mut terms = row(&system.A, &system.B, i, slots.x, slots.u);
        terms.extend(windup.as_ref().map(|windup| windup.gains[i] * windup.excess));
        pending.push(Update { state, value: writer.sum(format!("{name}_next_{i}"), &terms) });
    }
}

/// Returns row i of [X U] applied to (x, u).
fn row(
    X: &counterpoise_linalg::Mat,
    U: &counterpoise_linalg::Mat,
    i: usize,
    x: &[Slot],
    u: &[Slot],
) -> Vec<ProgramTerm> {
    let states = x.iter().enumerate().map(|(j, &slot)| X[(i, j)] * slot);
    let inputs = u.iter().enumerate().map(|(j, &slot)| U[(i, j)] * slot);
    states.chain(inputs).collect()
}

/// The transfer fades by the implicit step of its first-order lag.
fn fade(parts: &Parts, layout: &Layout, writer: &mut Writer) {
    let Some(transfer) = layout.transfer else { return };
    let keep = parts.transfer_time_s / (parts.transfer_time_s + parts.sample_period_s);
    let next = writer.sum("faded_v", &[keep * transfer]);
    writer.copy(transfer, next);
}
