//! True stick in the mechanism: which joints rest, when they break away, when sliding joints come to rest.
//!
//! A joint at rest has no freedom: the linear core is one of its own, without it, and the joint's friction is the
//! torque of that constraint. It breaks away where that torque reaches the breakaway level. A joint that slides has
//! its sliding torque in one direction until its rate is zero; then it rests, or slides on the other way where the
//! constraint would need more than friction can hold. Both instants are found on the exact flow of the core. D.
//! Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic systems", ASME JDSMC 107, 1985, has the
//! constraint's torque for one mass; the band of rates of that paper is where the breakaway level still acts here, so
//! that nothing jumps.

use super::linear::Hold;
use super::moments::NODES;
use super::ports::{AngleNearby, FrictionState, PlatformPoint, Point};
use super::stepper::{Sample, Stepper};
use super::strips::Strips;
use super::tables::{OUTPUTS, PORTS};
use counterpoise_models::friction::Stick;
use counterpoise_models::plant::core::input;

/// Rate below zero that is still zero but for rounding, rad/s at the hub.
const ROUNDING: f64 = 1e-12;
/// Rate relative to the platform, rad/s at the hub, below which a joint that rests is still taken to rest at the
/// beginning of a sample: what the pieces of the platform's motion leave open between them.
const AT_REST: f64 = 1e-7;

/// The instant at which a joint is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub platform: PlatformPoint,
    /// Pitch acceleration of the platform, rad/s^2.
    pub acceleration: f64,
    pub time_s: f64,
    pub drive_v: f64,
    /// Torque of half the gap, N m.
    pub offset: f64,
}

impl FrictionState {
    pub(crate) fn get(&self, joint: usize) -> f64 {
        [self.motor, self.pivot][joint]
    }

    pub(crate) fn set(&mut self, joint: usize, value: f64) {
        *[&mut self.motor, &mut self.pivot][joint] = value;
    }
}

/// The torque that holds a joint, for a state, its ports without this joint's friction, and an instant.
pub(crate) fn holding(hold: &Hold, core: &[f64], ports: &[f64; PORTS], at: &Instant) -> f64 {
    super::linear::dot(&hold.row, core) + beside(hold, ports, at)
}

/// The part of it that is not the state's.
fn beside(hold: &Hold, ports: &[f64; PORTS], at: &Instant) -> f64 {
    let mut inputs = [0.0; input::COUNT];
    inputs[input::DRIVE] = at.drive_v;
    inputs[input::PLATFORM_RATE] = at.platform.rate;
    inputs[input::MOTOR_TORQUE] = ports[0];
    inputs[input::HUB_TORQUE] = ports[1];
    inputs[input::LOAD] = ports[2];
    inputs[input::MESH_TORQUE] = at.offset;
    super::linear::dot(&hold.inputs, &inputs) - hold.platform * at.acceleration
}

/// How far a joint at rest is from breaking away: negative beyond it.
fn holding_margin(stick: &Stick, torque_nm: f64) -> f64 {
    (stick.positive_nm - torque_nm).min(stick.negative_nm + torque_nm)
}

/// How far a sliding joint is from the end of its state: negative beyond it.
fn sliding_margin(state: f64, rate: f64, band: f64, rounding: f64) -> f64 {
    let along = rate * state.signum() + rounding;
    if state.abs() > 1.0 { along.min(band - rate.abs() + rounding) } else { along - band }
}

impl Stepper {
    /// Margins of a joint along the step that was tried, at its nodes; the first is not negative.
    pub(crate) fn joint_margins(&self, joint: usize, rates: &[f64; 4]) -> [f64; 4] {
        let (state, band) = (self.friction().get(joint), self.ports.band(joint));
        rates.map(|rate| sliding_margin(state, rate, band, ROUNDING * self.turns[joint]))
    }

    /// Margins of a joint at rest along the step that was tried, with their fractions of it: at its nodes and in its middle.
    pub(crate) fn rest_margins(
        &self,
        joint: usize,
        hold: &Strips,
        instant: impl Fn(f64) -> Instant,
    ) -> [(f64, f64); 5] {
        let [core, attempt] = [self.core(), self.attempt.end()];
        let ends = [(0.0, core, *self.attempt.start_ports()), (1.0, attempt, self.attempt.end_ports())];
        let [first, last] = ends.map(|(part, core, ports)| {
            let at = instant(part);
            let (stick, torque) = self.load(joint, core, &ports, &at);
            (part, holding_margin(&stick, torque))
        });
        let (shares, ports) = (self.attempt.held(hold, joint), self.attempt.inner_ports());
        let outputs = self.attempt.outputs();
        let seen = [outputs[1], outputs[2], self.attempt.middle_outputs()];
        let inner = |k: usize| {
            let part = [NODES[1], NODES[2], 0.5][k];
            let at = instant(part);
            let torque = shares[k] + beside(&self.linear().holds[joint], &ports[k], &at);
            (part, holding_margin(&self.stick_at(joint, &seen[k], &at), torque))
        };
        [first, inner(0), inner(2), inner(1), last]
    }

    /// What a joint can hold where its nonlinear parts see these outputs.
    fn stick_at(&self, joint: usize, outputs: &[f64; OUTPUTS], at: &Instant) -> Stick {
        let about = AngleNearby::new(outputs[2]);
        let point = Point { time_s: at.time_s, outputs, platform: &at.platform, about: &about };
        let none = Stick { positive_nm: 0.0, negative_nm: 0.0, rest_rate_rad_s: 0.0 };
        self.ports.stick(&self.plant, joint, &point).unwrap_or(none)
    }

    /// What a joint can hold, and the torque that it holds at rest, at a state of the core.
    pub(crate) fn load(
        &self,
        joint: usize,
        core: &[f64],
        ports: &[f64; PORTS],
        at: &Instant,
    ) -> (Stick, f64) {
        let linear = self.linear();
        let seen = linear.see(core);
        let stick = self.stick_at(joint, super::linear::outputs(&seen), at);
        (stick, holding(&linear.holds[joint], core, ports, at))
    }

    /// The state of the joints at the beginning of a sample: as they were, unless the platform's rate jumped.
    pub(crate) fn settle(&mut self, sample: &Sample) {
        let platform = sample.motion.at(0.0);
        for joint in [0, 1] {
            if !self.ports.sticks(joint) {
                continue;
            }
            let rate = self.ports.rates(self.outputs(), platform.rate)[joint];
            let state = self.friction().get(joint);
            let rounding = ROUNDING * self.turns[joint];
            if state == 0.0 && rate.abs() <= AT_REST * self.turns[joint] {
                self.arrest(joint, rate);
            } else if state == 0.0 || rate * state.signum() < -rounding {
                self.slide(joint, rate);
            }
        }
    }

    /// What a committed step leads to: joints that came to rest, broke away, or left Karnopp's band. Tells whether any.
    pub(crate) fn transitions(&mut self, at: &Instant) -> bool {
        let mut any = false;
        for joint in [0, 1] {
            if self.ports.sticks(joint) {
                any |= self.transition(joint, at);
            }
        }
        any
    }

    fn transition(&mut self, joint: usize, at: &Instant) -> bool {
        let state = self.friction().get(joint);
        if state == 0.0 {
            return self.break_away(joint, at);
        }
        let rate = self.ports.rates(self.outputs(), at.platform.rate)[joint];
        let rounding = ROUNDING * self.turns[joint];
        if rate * state.signum() < -rounding {
            self.arrest(joint, rate);
            self.set_friction(joint, 0.0);
            self.break_away(joint, at);
            return true;
        }
        if sliding_margin(state, rate, self.ports.band(joint), rounding) < 0.0 {
            self.slide(joint, if rate == 0.0 { state } else { rate });
            return true;
        }
        false
    }

    /// Lets a joint at rest slide where it cannot hold.
    fn break_away(&mut self, joint: usize, at: &Instant) -> bool {
        let ports = self.ports_at(at);
        let (stick, torque) = self.load(joint, self.core(), &ports, at);
        if stick.holds(torque) {
            return false;
        }
        let within = if self.ports.band(joint) > 0.0 { 2.0 } else { 1.0 };
        self.set_friction(joint, within * torque.signum());
        true
    }

    /// The state of a joint that slides at a rate.
    fn slide(&mut self, joint: usize, rate: f64) {
        let within = if rate.abs() < self.ports.band(joint) { 2.0 } else { 1.0 };
        self.set_friction(joint, within * rate.signum());
    }
}
