//! The program of one sample.

use counterpoise_lti::StateSpace;

use crate::lower::schedule::{self, Layout};
use crate::lower::{PREFILTER_STATES, PREVIOUS_CONTROL, States, Writer, reading_names};
use crate::program::{OnReset, Program, Slot};
use crate::{Estimator, FrictionObserver, Parts, Path, READINGS, Signal};

/// Where each signal of this step is found.
struct Signals {
    readings: [Slot; READINGS],
    rate_error: Option<Slot>,
    relative_rate: Option<Slot>,
    previous_control: Option<Slot>,
}

impl Signals {
    fn slot(&self, signal: Signal) -> Slot {
        let derived = match signal {
            Signal::RateError => self.rate_error,
            Signal::RelativeRate => self.relative_rate,
            Signal::PreviousControl => self.previous_control,
            _ => None,
        };
        derived.unwrap_or(self.readings[signal.reading().unwrap_or(0)])
    }
}

/// A state update: the new value waits in a local until all have been computed.
type Pending = Vec<(Slot, Slot)>;

/// Writes the program of a sample and hands out the states it needs.
pub(crate) fn program(parts: &Parts, layout: &Layout, states: &mut States) -> Program {
    let mut writer = Writer::new(&reading_names());
    let mut pending = Pending::new();
    let mut signals = corrected(parts, &mut writer);
    prefilter(parts, &mut signals, states, &mut writer, &mut pending);
    derive(parts, &mut signals, states, &mut writer);
    let dry: Vec<Slot> =
        parts.observers.iter().map(|o| observe(o, parts, &signals, states, &mut writer)).collect();
    let path_states: Vec<Vec<Slot>> =
        parts.paths.iter().map(|path| states.array(&path.name, path.system.order())).collect();
    let outputs = outputs(parts, layout, &signals, &path_states, &mut writer);
    let (control, limited) = control(parts, layout, (&outputs, &dry), &mut writer);
    let excess = excess(parts, (control, limited), &mut writer);
    for (path, x) in parts.paths.iter().zip(&path_states) {
        let u: Vec<Slot> = path.inputs.iter().map(|signal| signals.slot(*signal)).collect();
        advance(path, (x, &u, excess), &mut writer, &mut pending);
    }
    writer.section("new states");
    pending.extend(signals.previous_control.map(|slot| (slot, limited)));
    for (state, new) in pending {
        writer.copy(state, new);
    }
    fade(parts, layout, &mut writer);
    estimate(parts, layout, &signals, limited, &mut writer);
    writer.finish(Some(limited))
}

fn corrected(parts: &Parts, writer: &mut Writer) -> Signals {
    let mut readings = std::array::from_fn(Slot::Input);
    writer.section("corrected readings");
    for each in &parts.corrections {
        let reading = &mut readings[each.reading];
        let into = writer.local(format!("corrected_{}", crate::READING_NAMES[each.reading]));
        writer.sum_into(into, Some(each.offset), &[(each.gain, *reading)]);
        *reading = into;
    }
    Signals { readings, rate_error: None, relative_rate: None, previous_control: None }
}

fn prefilter(
    parts: &Parts,
    signals: &mut Signals,
    states: &mut States,
    writer: &mut Writer,
    pending: &mut Pending,
) {
    let Some(system) = &parts.prefilter else { return };
    writer.section("reference prefilter");
    let x = states.array(PREFILTER_STATES, system.order());
    let demand = signals.readings[0];
    let filtered = writer.sum("filtered_demand_rad_s", &row(&system.C, &system.D, 0, &x, &[demand]));
    new_states(PREFILTER_STATES, system, (&x, &[demand]), None, writer, pending);
    signals.readings[0] = filtered;
}

fn derive(parts: &Parts, signals: &mut Signals, states: &mut States, writer: &mut Writer) {
    let used = |signal: Signal| {
        parts.paths.iter().any(|path| path.inputs.contains(&signal))
            || parts.observers.iter().any(|observer| observer.rate == signal)
            || parts.estimator.as_ref().is_some_and(|estimator| estimator.rate == signal)
    };
    writer.section("derived signals");
    let [demand, hub, platform, ..] = signals.readings;
    signals.rate_error =
        used(Signal::RateError).then(|| writer.sum(Signal::RateError.name(), &[(1.0, demand), (-1.0, hub)]));
    signals.relative_rate = used(Signal::RelativeRate)
        .then(|| writer.sum(Signal::RelativeRate.name(), &[(1.0, hub), (-1.0, platform)]));
    signals.previous_control =
        used(Signal::PreviousControl).then(|| states.scalar(PREVIOUS_CONTROL, 0.0, OnReset::Restart));
}

/// The implicit Dahl step; gives the observer's volts.
fn observe(
    observer: &FrictionObserver,
    parts: &Parts,
    signals: &Signals,
    states: &mut States,
    writer: &mut Writer,
) -> Slot {
    let name = &observer.name;
    writer.section(format!("friction observer {name}: Dahl, implicit step"));
    let force = states.scalar(&format!("{name}_nm"), 0.0, OnReset::Restart);
    let rate = signals.slot(observer.rate);
    let grip = observer.rest_stiffness_nm_rad * parts.sample_period_s;
    let speed = writer.magnitude(format!("{name}_speed_rad_s"), rate);
    let above = writer.sum(format!("{name}_above_nm"), &[(1.0, force), (grip, rate)]);
    let below = writer.local(format!("{name}_below"));
    writer.sum_into(below, Some(1.0), &[(grip / observer.coulomb_nm, speed)]);
    let next = writer.quotient(format!("{name}_next_nm"), above, below);
    writer.copy(force, next);
    writer.sum(format!("{name}_v"), &[(observer.volts_per_nm, force), (observer.viscous_v_s_rad, rate)])
}

/// C x + D u of each path, with its gain where it follows the out-of-balance.
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
    (outputs, dry): (&[Slot], &[Slot]),
    writer: &mut Writer,
) -> (Slot, Slot) {
    writer.section("control: paths, friction, bias and transfer, in this order, then the limiter");
    let all = outputs.iter().chain(dry).copied().chain(layout.bias).chain(layout.transfer);
    let terms: Vec<(f64, Slot)> = all.map(|slot| (1.0, slot)).collect();
    let control = writer.sum("control_v", &terms);
    let limited = writer.clamp("limited_v", control, (-parts.limit_v, parts.limit_v));
    (control, limited)
}

/// limited - unlimited control, where a path uses it.
fn excess(parts: &Parts, (control, limited): (Slot, Slot), writer: &mut Writer) -> Option<Slot> {
    let used = parts.paths.iter().any(|path| path.anti_windup.iter().any(|gain| *gain != 0.0));
    used.then(|| writer.sum("excess_v", &[(1.0, limited), (-1.0, control)]))
}

fn advance(
    path: &Path,
    (x, u, excess): (&[Slot], &[Slot], Option<Slot>),
    w: &mut Writer,
    pending: &mut Pending,
) {
    w.section(format!("states of path {}", path.name));
    let windup = excess.map(|slot| (slot, path.anti_windup.as_slice()));
    new_states(&path.name, &path.system, (x, u), windup, w, pending);
}

fn new_states(
    name: &str,
    system: &StateSpace,
    (x, u): (&[Slot], &[Slot]),
    windup: Option<(Slot, &[f64])>,
    writer: &mut Writer,
    pending: &mut Pending,
) {
    for (i, &state) in x.iter().enumerate() {
        let mut terms = row(&system.A, &system.B, i, x, u);
        terms.extend(windup.map(|(excess, gains)| (gains[i], excess)));
        pending.push((state, writer.sum(format!("{name}_next_{i}"), &terms)));
    }
}

/// Row i of [X U] applied to (x, u).
fn row(
    X: &counterpoise_lti::Mat,
    U: &counterpoise_lti::Mat,
    i: usize,
    x: &[Slot],
    u: &[Slot],
) -> Vec<(f64, Slot)> {
    let states = x.iter().enumerate().map(|(j, &slot)| (X[(i, j)], slot));
    let inputs = u.iter().enumerate().map(|(j, &slot)| (U[(i, j)], slot));
    states.chain(inputs).collect()
}

/// The transfer fades by the implicit step of its first-order lag.
fn fade(parts: &Parts, layout: &Layout, writer: &mut Writer) {
    let Some(transfer) = layout.transfer else { return };
    let keep = parts.transfer_time_s / (parts.transfer_time_s + parts.sample_period_s);
    let next = writer.sum("faded_v", &[(keep, transfer)]);
    writer.copy(transfer, next);
}

/// The normalised gradient step of the estimator, and the gains that follow.
fn estimate(parts: &Parts, layout: &Layout, signals: &Signals, limited: Slot, writer: &mut Writer) {
    let (Some(estimator), [p0, p1, p2]) = (&parts.estimator, layout.estimate.as_slice()) else { return };
    writer.section("estimate of the out-of-balance from the control");
    let phi = regressors(estimator, signals, writer);
    let p = [*p0, *p1, *p2];
    let explained: [Slot; 3] =
        std::array::from_fn(|i| writer.product(format!("explained_{i}_v"), p[i], phi[i]));
    let [e0, e1, e2] = explained;
    let left = writer.sum("unexplained_v", &[(1.0, limited), (-1.0, e0), (-1.0, e1), (-1.0, e2)]);
    let squares: [Slot; 3] = std::array::from_fn(|i| writer.product(format!("square_{i}"), phi[i], phi[i]));
    let size = writer.local("excitation");
    let weights: Vec<(f64, Slot)> = (0..3).map(|i| (estimator.scale[i].powi(2), squares[i])).collect();
    writer.sum_into(size, Some(1.0), &weights);
    let push = writer.quotient("push", left, size);
    for i in 0..3 {
        let along = writer.product(format!("along_{i}"), push, phi[i]);
        let gain = estimator.step * estimator.scale[i].powi(2);
        let next = writer.sum(format!("estimate_next_{i}"), &[(1.0, p[i]), (gain, along)]);
        writer.copy(p[i], next);
    }
    follow_estimate(estimator, (parts, layout), *p0, writer);
}

fn regressors(estimator: &Estimator, signals: &Signals, writer: &mut Writer) -> [Slot; 3] {
    let lift = writer.local("lift_m_s2");
    let heave = signals.slot(Signal::PlatformAcceleration);
    writer.sum_into(lift, Some(estimator.gravity_m_s2), &[(1.0, heave)]);
    let rate = signals.slot(estimator.rate);
    let speed = writer.magnitude("estimator_speed_rad_s", rate);
    let softened = writer.local("softened_speed_rad_s");
    writer.sum_into(softened, Some(estimator.half_rate_rad_s), &[(1.0, speed)]);
    [lift, writer.quotient("direction", rate, softened), rate]
}

/// The out-of-balance moves to the estimate at its limited rate.
fn follow_estimate(estimator: &Estimator, (parts, layout): (&Parts, &Layout), p0: Slot, writer: &mut Writer) {
    let most = estimator.rate_limit_kg_m_s * parts.sample_period_s;
    let aim = writer.sum("aim_kg_m", &[(1.0 / estimator.volts_per_kg_m_s2, p0)]);
    let way = writer.sum("way_kg_m", &[(1.0, aim), (-1.0, layout.out_of_balance)]);
    let moved = writer.clamp("moved_kg_m", way, (-most, most));
    let sum = writer.sum("unbounded_kg_m", &[(1.0, layout.out_of_balance), (1.0, moved)]);
    let bounded = writer.clamp("bounded_kg_m", sum, parts.out_of_balance_range_kg_m);
    writer.copy(layout.out_of_balance, bounded);
    schedule::follow(writer, parts, layout);
}
