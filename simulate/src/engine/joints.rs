//! True stick in the mechanism: which joints rest, when they break away, when sliding joints come to rest.
//!
//! A joint at rest has no freedom: the linear core is one of its own, without it, and the joint's friction is the
//! torque of that constraint. It breaks away where that torque reaches the breakaway level. A joint that slides has
//! its sliding torque in one direction until its rate is zero; then it rests, or slides on the other way where the
//! constraint would need more than friction can hold. Both instants are found on the exact flow of the core. D.
//! Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic systems", ASME JDSMC 107, 1985, has the
//! constraint's torque for one mass; the band of rates of that paper is where the breakaway level still acts here, so
//! that nothing jumps.

use super::attempt::Attempt;
use super::crossing::Margin;
use super::linear_core::{Hold, dot, outputs};
use super::moments::NODES;
use super::ports::NearbyAngle;
use super::present_plant::{Instant, PresentPlant, Sample};
use super::strips::Strips;
use super::tables::{OUTPUTS, PORTS};
use crate::tolerance::{AT_REST_RATE_RAD_S, HOLD_ROUNDING, RATE_ROUNDING_RAD_S};
use counterpoise_models::friction::Stick;
use counterpoise_models::plant::core::input;

/// A joint at rest: what its friction can hold, and the torque that it must.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Load {
    pub stick: Stick,
    pub torque_nm: f64,
}

impl Load {
    /// Returns how far the joint is from breaking away, N m: negative beyond it.
    ///
    /// A torque that differs from it by no more than rounding counts as one at it: a machine that was put down holds exactly what its friction can, and would
    /// break away and be at rest again without end.
    fn margin(&self) -> f64 {
        let margin = (self.stick.positive_nm - self.torque_nm).min(self.stick.negative_nm + self.torque_nm);
        let rounding = HOLD_ROUNDING * (self.stick.positive_nm + self.stick.negative_nm);
        if margin.abs() <= rounding { 0.0 } else { margin }
    }
}

/// The result of a committed step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Transition {
    /// Every joint stays as it was.
    None,
    /// A joint came to rest, broke away, or left Karnopp's band.
    Changed,
}

/// Returns the torque that holds a joint, for a state, its ports without this joint's friction, and an instant.
fn holding_torque(hold: &Hold, core: &[f64], ports: &[f64; PORTS], at: &Instant) -> f64 {
    dot(&hold.row, core) + holding_inputs(hold, ports, at)
}

/// Returns the part of the torque that holds a joint which ports, control and platform make.
fn holding_inputs(hold: &Hold, ports: &[f64; PORTS], at: &Instant) -> f64 {
    let mut inputs = [0.0; input::COUNT];
    inputs[input::DRIVE] = at.drive_v;
    inputs[input::PLATFORM_RATE] = at.platform.rate;
    for (port, value) in hold.ports.iter().zip(ports) {
        inputs[*port] = *value;
    }
    inputs[input::MESH_TORQUE] = at.offset;
    dot(&hold.inputs, &inputs) - hold.platform * at.acceleration
}

/// Returns how far a sliding joint is from the end of its state: negative beyond it.
fn sliding_margin(state: f64, rate: f64, band: f64, rounding: f64) -> f64 {
    let along = rate * state.signum() + rounding;
    if state.abs() > 1.0 { along.min(band - rate.abs() + rounding) } else { along - band }
}

impl PresentPlant {
    /// Rate of a joint that is zero but for rounding, rad/s.
    fn rate_rounding(&self, joint: usize) -> f64 {
        RATE_ROUNDING_RAD_S * self.turns[joint]
    }

    /// Returns the margins of a sliding joint at rates along a step; the first is not negative.
    pub fn sliding_margins(&self, joint: usize, rates: &[f64; 4]) -> [f64; 4] {
        let (state, band) = (self.friction().get(joint), self.ports.band(joint));
        rates.map(|rate| sliding_margin(state, rate, band, self.rate_rounding(joint)))
    }

    /// Returns the margins of a joint at rest along the step that was tried: at its nodes and in its middle.
    pub fn rest_margins(
        &self,
        attempt: &Attempt,
        joint: usize,
        hold: &Strips,
        instant: impl Fn(f64) -> Instant,
    ) -> [Margin; 5] {
        let first = self.load(joint, self.core(), attempt.start_ports(), &instant(0.0));
        let last = self.load(joint, attempt.end(), &attempt.end_ports(), &instant(1.0));
        let (shares, ports) = (attempt.holding_torque_share(hold, joint), attempt.inner_ports());
        let outputs = attempt.outputs();
        let seen = [outputs[1], outputs[2], attempt.middle_outputs()];
        let inner = |k: usize| {
            let part = [NODES[1], NODES[2], 0.5][k];
            let at = instant(part);
            let torque_nm = shares[k] + holding_inputs(&self.linear().holds[joint], &ports[k], &at);
            let load = Load { stick: self.stick_at(joint, &seen[k], &at), torque_nm };
            Margin { part, value: load.margin() }
        };
        let start = Margin { part: 0.0, value: first.margin() };
        [start, inner(0), inner(2), inner(1), Margin { part: 1.0, value: last.margin() }]
    }

    /// Returns what a joint can hold where its nonlinear parts see these outputs.
    fn stick_at(&self, joint: usize, outputs: &[f64; OUTPUTS], at: &Instant) -> Stick {
        let about = NearbyAngle::new(outputs[2]);
        let none = Stick { positive_nm: 0.0, negative_nm: 0.0, rest_rate_rad_s: 0.0 };
        self.ports.stick(&self.plant, joint, &at.point(outputs, &about)).unwrap_or(none)
    }

    /// Returns the load of a joint at rest, at a state of the core.
    pub fn load(&self, joint: usize, core: &[f64], ports: &[f64; PORTS], at: &Instant) -> Load {
        let linear = self.linear();
        let seen = linear.outputs_at(core);
        let stick = self.stick_at(joint, outputs(&seen), at);
        Load { stick, torque_nm: holding_torque(&linear.holds[joint], core, ports, at) }
    }

    /// Puts the joints into their state at the beginning of a sample: as they were, unless the platform's rate jumped.
    pub fn settle_joints(&mut self, sample: &Sample) {
        let platform = sample.motion.at(0.0);
        for joint in [0, 1] {
            if !self.ports.sticks(joint) {
                continue;
            }
            let rate = self.ports.rates(self.outputs(), platform.rate)[joint];
            let state = self.friction().get(joint);
            if state == 0.0 && rate.abs() <= AT_REST_RATE_RAD_S * self.turns[joint] {
                self.stop_joint(joint, rate);
            } else if state == 0.0 || rate * state.signum() < -self.rate_rounding(joint) {
                self.slide(joint, rate);
            }
        }
    }

    /// Carries out what a committed step leads to: joints that came to rest, broke away, or left Karnopp's band.
    pub fn make_transitions(&mut self, at: &Instant) -> Transition {
        let mut changed = Transition::None;
        for joint in [0, 1] {
            if self.ports.sticks(joint) && self.make_transition(joint, at) == Transition::Changed {
                changed = Transition::Changed;
            }
        }
        changed
    }

    fn make_transition(&mut self, joint: usize, at: &Instant) -> Transition {
        let state = self.friction().get(joint);
        if state == 0.0 {
            return self.break_away(joint, at);
        }
        let rate = self.ports.rates(self.outputs(), at.platform.rate)[joint];
        let rounding = self.rate_rounding(joint);
        if rate * state.signum() < -rounding {
            self.stop_joint(joint, rate);
            self.set_friction(joint, 0.0);
            self.break_away(joint, at);
            return Transition::Changed;
        }
        if sliding_margin(state, rate, self.ports.band(joint), rounding) < 0.0 {
            self.slide(joint, if rate == 0.0 { state } else { rate });
            return Transition::Changed;
        }
        Transition::None
    }

    /// Lets a joint at rest slide if its friction cannot hold the load.
    fn break_away(&mut self, joint: usize, at: &Instant) -> Transition {
        let ports = self.ports_at(at);
        let load = self.load(joint, self.core(), &ports, at);
        if load.stick.holds(load.torque_nm) {
            return Transition::None;
        }
        let within = if self.ports.band(joint) > 0.0 { 2.0 } else { 1.0 };
        self.set_friction(joint, within * load.torque_nm.signum());
        Transition::Changed
    }

    /// Sets the state of a joint that slides at a rate.
    fn slide(&mut self, joint: usize, rate: f64) {
        let within = if rate.abs() < self.ports.band(joint) { 2.0 } else { 1.0 };
        self.set_friction(joint, within * rate.signum());
    }
}
