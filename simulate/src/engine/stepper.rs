//! The steps within a sample: their choice, and the events of mesh, amplifier and sticking joints.

use super::attempt::{Attempt, Given};
use super::filter::Filter;
use super::joints::Instant;
use super::linear::{Linear, Mode, Seen, TIP, VOLTAGE, outputs};
use super::ports::{AngleNearby, Bonds, FrictionState, PlatformPoint, Point, Ports};
use super::tables::{DEEPEST, LEVELS, OUTPUTS, PORTS};
use crate::Error;
use crate::motion::MotionSample;
use counterpoise_models::{Mesh, Plant};

/// How far below the tolerance the defect must be for the next step to be twice as long.
const LENGTHEN_BELOW: f64 = 1.0 / 64.0;
/// Shortest steps in a sample period.
const TICKS: u32 = 1 << DEEPEST;
/// Leading bits of the way to an event that are gone before it is predicted anew.
const BITS: u32 = 5;
/// Changes of joints in a sample from which on their instants are found to the shortest ordinary step only.
const MANY_CHANGES: usize = 40;
/// Halvings with which the instants at which teeth or voltage change are found, at a tolerance of [`CONTACT_TOLERANCE`]; one
/// more for half of it.
const CONTACT_LEVELS: f64 = 11.0;
/// Fewest of them.
const FEWEST_CONTACT_LEVELS: usize = 6;
/// See [`CONTACT_LEVELS`].
const CONTACT_TOLERANCE: f64 = 2e-5;
/// Halvings that roughness may ask for where bonds snap: each makes a jump, which no step resolves.
const BRISTLE_LEVELS: usize = 3;

/// What moves: the states of the plant between samples.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantState {
    /// States of the linear core, as [`counterpoise_models::plant::core::state`] has them.
    pub core: Vec<f64>,
    /// States of dry friction.
    pub friction: FrictionState,
    /// The bonds of bristle friction.
    pub bonds: Bonds,
    /// Hub gyroscope before its gain and bias: rate, rad/s, and its derivative.
    pub hub_gyro: [f64; 2],
}

/// How much work a run was, and whether any of it was done below the accuracy asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Effort {
    /// Steps taken.
    pub steps: usize,
    /// Steps tried and shortened.
    pub rejected: usize,
    /// Shortest steps that were taken although their error was above the tolerance: at jumps.
    pub forced: usize,
    /// Evaluations of the nonlinear parts along a step.
    pub iterations: usize,
    /// Changes of joints that truly stick: to rest, to sliding, or from one direction to the other.
    pub changes: usize,
}

/// Steps a plant from sample to sample.
#[derive(Debug, Clone)]
pub(crate) struct Stepper {
    pub(super) plant: Plant,
    pub(super) ports: Ports,
    /// Turns of each joint per turn of the hub.
    pub(super) turns: [f64; 2],
    filter: Filter,
    period_s: f64,
    /// The cores that were needed so far, the one at hand first of them all at the start.
    cores: Vec<Linear>,
    index: [Option<usize>; Mode::COUNT],
    /// Whether any joint truly sticks.
    joints: bool,
    now: Now,
    /// What is seen at the end of the step that was tried.
    ahead: Seen,
    pub(super) attempt: Attempt,
    level: usize,
    finest: usize,
    contact: usize,
    tolerance: f64,
    pub effort: Effort,
}

/// Where the plant is.
#[derive(Debug, Clone)]
struct Now {
    core: usize,
    z: Vec<f64>,
    seen: Seen,
    friction: FrictionState,
    bonds: Bonds,
    /// Angles of motor and pivot to which friction has travelled, rad; those of the core at the start.
    travelled: Option<[f64; 2]>,
    hub_gyro: [f64; 2],
}

/// What came of a step that was tried.
enum Tried {
    Good { defect: f64 },
    Event { fraction: f64, depth: usize },
    Rough,
}

/// The control and the platform over a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample<'a> {
    pub drive_v: f64,
    pub start_s: f64,
    pub motion: &'a MotionSample,
}

/// The way to an event that was seen: ticks to go, and the level to try after them.
#[derive(Debug, Clone, Copy, Default)]
struct Approach {
    ticks: u32,
    then: usize,
}

impl Stepper {
    /// A stepper whose steps leave a defect of at most `tolerance`, relative to the ports' scales.
    pub fn new(plant: &Plant, period_s: f64, tolerance: f64) -> Result<Self, Error> {
        let ports = Ports::new(plant)?;
        let mode = Mode { mesh: Mesh::Touching, offset: 0.0, held: 0.0, stuck: [false; 2] };
        let mut index = [None; Mode::COUNT];
        index[mode.index()] = Some(0);
        let n = plant.core_order();
        let now = Now {
            core: 0,
            z: vec![0.0; n],
            seen: Seen::default(),
            friction: FrictionState::default(),
            bonds: Bonds::default(),
            travelled: None,
            hub_gyro: [0.0; 2],
        };
        Ok(Self {
            finest: if ports.bristled() { BRISTLE_LEVELS } else { LEVELS },
            plant: plant.clone(),
            joints: ports.sticks(0) || ports.sticks(1),
            ports,
            turns: [plant.parameters().gearbox.ratio, 1.0],
            filter: Filter::new(&plant.parameters().sensors.hub_gyro, period_s),
            period_s,
            cores: vec![Linear::new(plant, &mode, period_s)],
            index,
            now,
            ahead: Seen::default(),
            attempt: Attempt::new(n),
            level: 0,
            contact: contact_levels(tolerance),
            tolerance,
            effort: Effort::default(),
        })
    }

    /// Begins a run in a state.
    pub fn restart(&mut self, start: &PlantState) {
        self.level = 0;
        self.attempt = Attempt::new(self.plant.core_order());
        self.effort = Effort::default();
        self.now = Now {
            core: self.now.core,
            z: self.linear().coordinates(&start.core),
            seen: Seen::default(),
            friction: start.friction,
            bonds: start.bonds.clone(),
            travelled: None,
            hub_gyro: start.hub_gyro,
        };
        self.now.seen = self.linear().see(&self.now.z);
    }

    /// The state of the plant.
    pub fn state(&self) -> PlantState {
        PlantState {
            core: self.linear().physical(&self.now.z),
            friction: self.now.friction,
            bonds: self.now.bonds.clone(),
            hub_gyro: self.now.hub_gyro,
        }
    }

    /// Motor state, wind-up, hub angle, hub rate, current.
    pub fn outputs(&self) -> &[f64; OUTPUTS] {
        outputs(&self.now.seen)
    }

    /// Voltage of the amplifier and rate of the tip.
    pub fn voltage_and_tip(&self) -> [f64; 2] {
        [self.now.seen[VOLTAGE], self.now.seen[TIP]]
    }

    /// The hub gyroscope: rate, and its derivative.
    pub fn hub_gyro(&self) -> &[f64; 2] {
        &self.now.hub_gyro
    }

    /// Whether the motion is still finite.
    pub fn is_finite(&self) -> bool {
        self.now.z.iter().all(|x| x.is_finite())
    }

    pub(super) fn linear(&self) -> &Linear {
        &self.cores[self.now.core]
    }

    pub(super) fn core(&self) -> &[f64] {
        &self.now.z
    }

    pub(super) fn friction(&self) -> &FrictionState {
        &self.now.friction
    }

    pub(super) fn set_friction(&mut self, joint: usize, value: f64) {
        self.effort.changes += usize::from(self.now.friction.get(joint) != value);
        self.now.friction.set(joint, value);
    }

    /// Brings a joint to rest: takes its rate relative to the platform by an impulse.
    pub(super) fn arrest(&mut self, joint: usize, rate: f64) {
        let Self { cores, now, .. } = self;
        let linear = &cores[now.core];
        now.z.iter_mut().zip(&linear.pushes[joint]).for_each(|(z, push)| *z -= rate * push);
        now.seen = linear.see(&now.z);
    }

    /// Dry friction torques at the motor and at the pivot at the beginning of a sample, N m.
    pub fn dry_torques(&mut self, sample: &Sample) -> [f64; 2] {
        self.settle(sample);
        let mode = self.mode(sample.drive_v);
        self.enter(&mode);
        let at = self.instant(sample, 0.0, &mode);
        let point = self.point(&at);
        let mut torques = self.ports.dry_torques(&self.plant, &point.of(self.outputs()), &self.now.friction);
        for joint in [0, 1] {
            if self.ports.sticks(joint) && self.now.friction.get(joint) == 0.0 {
                torques[joint] = self.load(joint, &self.now.z, &self.ports_at(&at), &at).1;
            }
        }
        torques
    }

    /// Values of the ports where the plant is.
    pub(super) fn ports_at(&self, at: &Instant) -> [f64; PORTS] {
        self.ports.at(&self.plant, &self.point(at).of(self.outputs()), &self.now.friction)
    }

    fn point<'a>(&self, at: &'a Instant) -> Place<'a> {
        Place { time_s: at.time_s, platform: &at.platform, about: AngleNearby::new(self.now.seen[2]) }
    }

    fn instant(&self, sample: &Sample, part: f64, mode: &Mode) -> Instant {
        Instant {
            platform: sample.motion.at(part),
            acceleration: sample.motion.pitch_acceleration_at(part),
            time_s: sample.start_s + part * self.period_s,
            drive_v: sample.drive_v,
            offset: mode.offset,
        }
    }

    /// Moves the state over one sample period.
    pub fn advance(&mut self, sample: &Sample) {
        self.settle(sample);
        let before = self.effort.changes;
        let (mut tick, mut approach) = (0, Approach::default());
        while tick < TICKS {
            if approach.ticks > 0 {
                self.level = level_within(approach.ticks);
            }
            while (TICKS >> self.level) > TICKS - tick {
                self.level += 1;
            }
            let mode = self.mode(sample.drive_v);
            self.enter(&mode);
            let deepest = if self.effort.changes - before > MANY_CHANGES { LEVELS } else { DEEPEST };
            match self.try_step(sample, tick, &mode, deepest) {
                Tried::Good { defect } => {
                    self.commit(&mode);
                    tick += TICKS >> self.level;
                    let mut changed = self.plant.mesh(self.now.seen[1]).0 != mode.mesh;
                    if self.joints {
                        changed |= self.transitions(&self.instant(sample, fraction(tick), &mode));
                    }
                    self.next_level(&mut approach, defect, changed);
                }
                Tried::Event { fraction, depth } => approach = self.approach(fraction, depth),
                Tried::Rough => {
                    approach = Approach::default();
                    self.level += 1;
                    self.effort.rejected += 1;
                }
            }
        }
    }

    fn next_level(&mut self, approach: &mut Approach, defect: f64, changed: bool) {
        if changed {
            *approach = Approach::default();
            self.level = 0;
        } else if approach.ticks > 0 {
            approach.ticks = approach.ticks.saturating_sub(TICKS >> self.level);
            if approach.ticks == 0 {
                self.level = approach.then;
            }
        } else if defect < LENGTHEN_BELOW * self.tolerance && self.level > 0 {
            self.level -= 1;
        }
    }

    /// The mode at the state: the voltage is held where it is at the bus limit and pushed against it.
    fn mode(&self, drive_v: f64) -> Mode {
        let (mesh, offset) = self.plant.mesh(self.now.seen[1]);
        let voltage = self.now.seen[VOLTAGE];
        let at_limit = voltage.abs() >= self.plant.parameters().amplifier.bus_voltage_v;
        let pushed = at_limit && self.voltage_push(voltage, self.now.seen[4], drive_v) * voltage > 0.0;
        let stuck = [0, 1].map(|j| self.ports.sticks(j) && self.now.friction.get(j) == 0.0);
        Mode { mesh, offset, held: if pushed { voltage.signum() } else { 0.0 }, stuck }
    }

    /// tau_a V', were the voltage free.
    fn voltage_push(&self, voltage: f64, current: f64, drive_v: f64) -> f64 {
        let amplifier = &self.plant.parameters().amplifier;
        amplifier.gain * (drive_v - amplifier.current_feedback_v_a * current) - voltage
    }

    /// Makes the mode's core the one at hand, with the table of the level.
    fn enter(&mut self, mode: &Mode) {
        let core = match self.index[mode.index()] {
            Some(core) => core,
            None => {
                self.cores.push(Linear::new(&self.plant, mode, self.period_s));
                self.index[mode.index()] = Some(self.cores.len() - 1);
                self.cores.len() - 1
            }
        };
        if core != self.now.core {
            let physical = self.linear().physical(&self.now.z);
            self.now.core = core;
            self.now.z = self.linear().coordinates(&physical);
        }
        self.cores[core].prepare(self.level);
    }

    fn try_step(&mut self, sample: &Sample, tick: u32, mode: &Mode, deepest: usize) -> Tried {
        let linear = &self.cores[self.now.core];
        let Some(table) = linear.table(self.level) else { return Tried::Rough };
        let (start, share) = (fraction(tick), fraction(TICKS >> self.level));
        let platform = sample.motion.span(start, share);
        let given = Given {
            plant: &self.plant,
            ports: &self.ports,
            table,
            core: &self.now.z,
            friction: &self.now.friction,
            bonds: &self.now.bonds,
            travelled: self.now.travelled,
            outputs: *self.outputs(),
            held: [sample.drive_v, mode.offset],
            platform: &platform,
            time_s: sample.start_s + start * self.period_s,
            tolerance: self.tolerance,
        };
        let converged = self.attempt.solve(&given);
        self.effort.iterations += self.attempt.iterations;
        self.ahead = linear.see(self.attempt.end());
        let defect = if self.attempt.predicted { 0.0 } else { self.attempt.defect(&given) * share };
        let finest = self.level >= self.finest;
        let fine = converged && defect <= self.tolerance;
        if !(finest || converged) {
            return Tried::Rough;
        }
        if let Some(event) = self.event(sample, (start, share), mode, deepest) {
            return event;
        }
        self.effort.forced += usize::from(finest && !fine);
        if finest || fine { Tried::Good { defect } } else { Tried::Rough }
    }

    /// The first event of the step that was tried, if its instant is still to be found more closely.
    fn event(&self, sample: &Sample, part: (f64, f64), mode: &Mode, deepest: usize) -> Option<Tried> {
        if self.joints && self.level < deepest {
            let fraction = self.joint_event(sample, part, mode);
            if fraction <= 1.0 {
                return Some(Tried::Event { fraction, depth: deepest });
            }
        }
        if self.level < self.contact {
            let fraction = self.mesh_event(mode).min(self.bus_event(mode, sample.drive_v));
            if fraction <= 1.0 {
                return Some(Tried::Event { fraction, depth: self.contact });
            }
        }
        None
    }

    /// Takes the step that was tried last.
    fn commit(&mut self, mode: &Mode) {
        self.now.z.copy_from_slice(self.attempt.end());
        self.now.friction = self.attempt.friction();
        self.now.bonds.copy(self.attempt.bonds());
        let hub_rate = self.attempt.outputs().map(|outputs| outputs[3]);
        self.filter.advance(self.level, &mut self.now.hub_gyro, &hub_rate);
        let Self { cores, now, plant, .. } = self;
        let linear = &cores[now.core];
        let bus = plant.parameters().amplifier.bus_voltage_v;
        now.seen = self.ahead;
        now.travelled = Some(self.attempt.travelled());
        let voltage = now.seen[VOLTAGE];
        let wanted = if mode.held != 0.0 { mode.held * bus } else { voltage.clamp(-bus, bus) };
        if wanted != voltage {
            now.z.iter_mut().zip(&linear.lift).for_each(|(z, lift)| *z += lift * (wanted - voltage));
            now.seen = linear.see(&now.z);
        }
        self.attempt.accept(self.period_s * fraction(TICKS >> self.level));
        self.effort.steps += 1;
    }

    /// How to come near an event at a fraction of the step that was tried.
    fn approach(&mut self, fraction: f64, depth: usize) -> Approach {
        self.effort.rejected += 1;
        let grain = TICKS >> depth;
        let ticks = (f64::from(TICKS >> self.level) * fraction) as u32 / grain * grain;
        if ticks == 0 {
            self.level = depth.max(self.level + 1).min(DEEPEST);
            return Approach::default();
        }
        let spare = (32 - ticks.leading_zeros()).saturating_sub(BITS);
        let then = level_within((ticks >> BITS).max(grain)).saturating_sub(1).max(self.level + 1);
        Approach { ticks: ticks >> spare << spare, then: then.min(depth) }
    }

    /// Fraction of the step at which the teeth part or meet; infinite if they do not.
    fn mesh_event(&self, mode: &Mode) -> f64 {
        let half = 0.5 * self.plant.parameters().gearbox.backlash_rad;
        if half == 0.0 {
            return f64::INFINITY;
        }
        // positive while the mode holds
        let holds = |wind_up: f64| match mode.mesh {
            Mesh::Free => half - wind_up.abs(),
            Mesh::Touching => -mode.offset.signum() * wind_up - half,
        };
        first_crossing(self.attempt.wind_up().map(|(part, wind_up)| (part, holds(wind_up))))
    }

    /// Fraction of the step at which the voltage reaches or leaves the bus limit; infinite if it does not.
    fn bus_event(&self, mode: &Mode, drive_v: f64) -> f64 {
        let bus = self.plant.parameters().amplifier.bus_voltage_v;
        let holds = |seen: &Seen| {
            if mode.held == 0.0 {
                bus - seen[VOLTAGE].abs()
            } else {
                mode.held * self.voltage_push(seen[VOLTAGE], seen[4], drive_v)
            }
        };
        let after = holds(&self.ahead);
        if after >= 0.0 {
            return f64::INFINITY;
        }
        crossing((0.0, holds(&self.now.seen)), (1.0, after))
    }

    /// Fraction of the step at which a joint comes to rest, breaks away or leaves its band; infinite if none does.
    fn joint_event(&self, sample: &Sample, (start, share): (f64, f64), mode: &Mode) -> f64 {
        let mut event = f64::INFINITY;
        for joint in [0, 1] {
            if !self.ports.sticks(joint) {
                continue;
            }
            event = event.min(if mode.stuck[joint] {
                self.break_event(joint, sample, (start, share), mode)
            } else {
                let nodes = sample.motion.span(start, share).nodes;
                let rates: [f64; 4] = std::array::from_fn(|k| {
                    self.ports.rates(&self.attempt.outputs()[k], nodes[k].rate)[joint]
                });
                let margins = self.joint_margins(joint, &rates);
                let at = super::moments::NODES;
                let along: [(f64, f64); 4] = std::array::from_fn(|k| (at[k], margins[k]));
                first_crossing(along).min(first_dip(&along))
            });
        }
        event
    }

    /// Fraction of the step at which a joint at rest breaks away.
    fn break_event(&self, joint: usize, sample: &Sample, (start, share): (f64, f64), mode: &Mode) -> f64 {
        let Some(hold) = self.linear().table(self.level).and_then(|table| table.hold.as_ref()) else {
            return f64::INFINITY;
        };
        let margins = self.rest_margins(joint, hold, |part| self.instant(sample, start + part * share, mode));
        first_crossing(margins).min(first_dip(&margins))
    }
}

/// A point but for what is seen there.
struct Place<'a> {
    time_s: f64,
    platform: &'a PlatformPoint,
    about: AngleNearby,
}

impl Place<'_> {
    fn of<'b>(&'b self, outputs: &'b [f64; OUTPUTS]) -> Point<'b> {
        Point { time_s: self.time_s, outputs, platform: self.platform, about: &self.about }
    }
}

/// Halvings with which the instants of contact are found.
fn contact_levels(tolerance: f64) -> usize {
    let wanted = CONTACT_LEVELS + (CONTACT_TOLERANCE / tolerance).log2();
    (wanted.round() as usize).clamp(FEWEST_CONTACT_LEVELS, DEEPEST)
}

/// The level of the longest step of at most so many ticks.
fn level_within(ticks: u32) -> usize {
    DEEPEST.saturating_sub(31 - ticks.max(1).leading_zeros() as usize)
}

/// Ticks as a fraction of a sample.
fn fraction(ticks: u32) -> f64 {
    f64::from(ticks) / f64::from(TICKS)
}

/// Where margins along a step first fall below zero; infinite if none does.
fn first_crossing<const N: usize>(margins: [(f64, f64); N]) -> f64 {
    let below = margins.windows(2).find(|pair| pair[1].1 < 0.0);
    below.map_or(f64::INFINITY, |pair| crossing(pair[0], pair[1]))
}

/// Where margins along a step first dip below zero between two points at which they do not: by the parabola through a least
/// one and its neighbours; infinite if none does.
fn first_dip(margins: &[(f64, f64)]) -> f64 {
    let dips = margins.windows(3).filter_map(|three| {
        let [(a, fa), (b, fb), (c, fc)] = [three[0], three[1], three[2]];
        let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
        let bend = (right - left) / (c - a);
        let slope = left + bend * (b - a);
        let at = b - slope / (2.0 * bend);
        let least = fb - slope * slope / (4.0 * bend);
        let dips = fb >= 0.0 && left <= 0.0 && right >= 0.0 && bend > 0.0 && least < 0.0;
        dips.then(|| if at > a { crossing((a, fa), (at, least)) } else { a })
    });
    dips.fold(f64::INFINITY, f64::min)
}

/// Where the straight line between a value that holds and one below zero is zero.
fn crossing(before: (f64, f64), after: (f64, f64)) -> f64 {
    let from = before.1.max(0.0);
    before.0 + (after.0 - before.0) * from / (from - after.1)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{PlatformMotion, Signal, Simulator};
    use counterpoise_models::reference;

    /// The state after a few samples with every step of one level.
    fn moved(finest: usize, volts: f64) -> Vec<f64> {
        let plant = Plant::lumped(&reference::rig()).unwrap();
        let start = Simulator::new(&plant).unwrap().rest(0.01, 0.0, 0.0);
        let mut stepper = Stepper::new(&plant, 1e-3, if finest == 0 { 1e9 } else { 1e-30 }).unwrap();
        stepper.finest = finest;
        stepper.restart(&start);
        let platform = PlatformMotion { pitch_rate_rad_s: Signal::sine(0.1, 8.0), ..PlatformMotion::STILL };
        let mut angle = 0.0;
        for k in 0..4 {
            let motion = platform.sample(f64::from(k) * 1e-3, 1e-3, angle);
            angle = motion.at(1.0).angle;
            stepper.advance(&Sample { drive_v: volts, start_s: f64::from(k) * 1e-3, motion: &motion });
        }
        stepper.state().core
    }

    #[test]
    fn the_deepest_steps_go_where_whole_samples_go() {
        let whole = moved(0, 5.0);
        for level in [4, 8, 9, 12, 14] {
            let found = moved(level, 5.0);
            for (a, b) in found.iter().zip(&whole) {
                assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{level}: {found:?} {whole:?}");
            }
        }
    }
}
