//! The nonlinear parts of several mechanisms side by side: those that most mechanisms have.

use super::number::{LANES, Lane, Lanes, load_registers};
use crate::engine::moments::NODES;
use crate::engine::ports::Ports;
use crate::engine::tables::{OUTPUTS, PORTS, STAGES};
use counterpoise_models::friction::{DryFriction, Real};
use counterpoise_models::{AxisKind, FeedbackSignal, Plant};
use pulp::Simd;

const MOTOR: usize = 0;
const WINDUP: usize = 1;
const HUB_ANGLE: usize = 2;
const HUB_RATE: usize = 3;
const CURRENT: usize = 4;

/// The nonlinear parts, as [`Ports`] has them for one mechanism. Their operations are in the same order.
#[derive(Debug, Clone)]
pub(crate) struct LanePorts<R = Lanes> {
    motor: DryFriction<R>,
    pivot: DryFriction<R>,
    ratio: R,
    coupling: R,
    gravity: R,
    vertical_offset: R,
    has_motor_extras: bool,
    has_hub_extras: bool,
    axis: AxisKind,
    measured: FeedbackSignal,
    /// Torques and loads against which an error at a port is small.
    pub scales: [R; PORTS],
}

/// The platform at an instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LanePlatform<R> {
    pub angle: R,
    pub rate: R,
    pub heave: R,
}

/// Sine and cosine of angles near one whose own are known, as [`crate::engine::ports::NearbyAngle`] has them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LaneAngle<R> {
    pub angle: R,
    pub sin: R,
    pub cos: R,
}

/// Relative motions at a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LaneMotion<S: Simd> {
    motor_rate: Lane<S>,
    motor_angle: Lane<S>,
    pivot_rate: Lane<S>,
    pivot_angle: Lane<S>,
}

impl<S: Simd> LaneMotion<S> {
    /// Returns the angles of motor and pivot.
    #[inline(always)]
    pub fn angles(&self) -> [Lane<S>; 2] {
        [self.motor_angle, self.pivot_angle]
    }

    /// Returns the motion with other angles.
    #[inline(always)]
    pub fn at_angles(self, [motor_angle, pivot_angle]: [Lane<S>; 2]) -> Self {
        Self { motor_angle, pivot_angle, ..self }
    }
}

/// The places at which the nonlinear parts are evaluated.
#[derive(Clone, Copy)]
pub(crate) struct LanePoint<'a, S: Simd> {
    pub outputs: &'a [Lane<S>; OUTPUTS],
    pub platform: &'a LanePlatform<Lane<S>>,
    pub about: &'a LaneAngle<Lane<S>>,
    /// Drives of the amplifiers, V.
    pub drive_v: &'a Lanes,
    pub plants: [&'a Plant; LANES],
}

impl LanePorts {
    /// Returns the nonlinear parts of mechanisms; `None` if they are not of one kind, or have parts beyond those that are evaluated side by side.
    pub fn new(ports: [&Ports; LANES], plants: [&Plant; LANES]) -> Option<Self> {
        let common = ports.map(Ports::common_parts);
        let first = common[0]?;
        if !common.iter().all(|other| *other == Some(first)) {
            return None;
        }
        let of = |value: &dyn Fn(&Plant) -> f64| plants.map(value);
        Some(Self {
            motor: DryFriction::join(ports.map(|ports| ports.frictions()[0]))?,
            pivot: DryFriction::join(ports.map(|ports| ports.frictions()[1]))?,
            ratio: of(&|plant| plant.parameters().gearbox.ratio),
            coupling: of(&Plant::motor_share),
            gravity: of(&|plant| plant.parameters().gravity_m_s2),
            vertical_offset: of(&|plant| plant.body().vertical_offset_kg_m),
            has_motor_extras: first.has_motor_extras,
            has_hub_extras: first.has_hub_extras,
            axis: first.axis,
            measured: first.measured,
            scales: std::array::from_fn(|port| ports.map(|ports| ports.scales[port])),
        })
    }

    /// Returns the parts in registers.
    #[inline(always)]
    pub fn load_registers<S: Simd>(&self, simd: S) -> LanePorts<Lane<S>> {
        let load = |values: Lanes| Lane::new(simd, values);
        LanePorts {
            motor: self.motor.map_numbers(load),
            pivot: self.pivot.map_numbers(load),
            ratio: load(self.ratio),
            coupling: load(self.coupling),
            gravity: load(self.gravity),
            vertical_offset: load(self.vertical_offset),
            has_motor_extras: self.has_motor_extras,
            has_hub_extras: self.has_hub_extras,
            axis: self.axis,
            measured: self.measured,
            scales: load_registers(simd, &self.scales),
        }
    }
}

impl<S: Simd> LanePorts<Lane<S>> {
    /// Returns the relative motions at a point.
    #[inline(always)]
    pub fn motion(&self, at: &LanePoint<S>) -> LaneMotion<S> {
        let pivot_angle = at.outputs[HUB_ANGLE] - at.platform.angle;
        LaneMotion {
            motor_rate: at.outputs[MOTOR] - self.coupling * at.platform.rate,
            motor_angle: self.ratio * (at.outputs[WINDUP] + pivot_angle),
            pivot_rate: at.outputs[HUB_RATE] - at.platform.rate,
            pivot_angle,
        }
    }

    /// Returns the states of dry friction after a motion.
    #[inline(always)]
    pub fn advance(
        &self,
        before: &LaneMotion<S>,
        after: &LaneMotion<S>,
        length_s: Lane<S>,
        memory: [Lane<S>; 2],
    ) -> [Lane<S>; 2] {
        let motor = Path {
            rates: [before.motor_rate, after.motor_rate],
            travel: after.motor_angle - before.motor_angle,
            time: length_s,
        };
        let pivot = Path {
            rates: [before.pivot_rate, after.pivot_rate],
            travel: after.pivot_angle - before.pivot_angle,
            time: length_s,
        };
        [motor.advance(&self.motor, memory[0]), pivot.advance(&self.pivot, memory[1])]
    }

    /// Returns the dry friction torques at motor and pivot.
    #[inline(always)]
    pub fn dry_torques(&self, motion: &LaneMotion<S>, memory: [Lane<S>; 2]) -> [Lane<S>; 2] {
        [self.motor.torque(motion.motor_rate, memory[0]), self.pivot.torque(motion.pivot_rate, memory[1])]
    }

    /// Returns the values of the ports.
    #[inline(always)]
    pub fn values(
        &self,
        at: &LanePoint<S>,
        motion: &LaneMotion<S>,
        memory: [Lane<S>; 2],
    ) -> [Lane<S>; PORTS] {
        let [sin, cos] = self.tilt(at.about, at.outputs[HUB_ANGLE]);
        let gravity = self.gravity + at.platform.heave;
        let [motor_dry, pivot_dry] = self.dry_torques(motion, memory);
        let mut motor = -motor_dry;
        let mut hub = gravity * self.vertical_offset * sin - pivot_dry;
        if self.has_motor_extras {
            motor = motor + self.motor_extras(at, motion);
        }
        if self.has_hub_extras {
            hub = hub + self.hub_extras(at, motion);
        }
        [motor, hub, gravity * cos]
    }

    #[inline(always)]
    fn motor_extras(&self, at: &LanePoint<S>, motion: &LaneMotion<S>) -> Lane<S> {
        let (current, rate) = (at.outputs[CURRENT].values(), at.platform.rate.values());
        let (angles, rates) = (motion.motor_angle.values(), motion.motor_rate.values());
        let torques: Lanes = std::array::from_fn(|k| {
            let current = current[k] + at.plants[k].direct_current_a(at.drive_v[k], rate[k]);
            at.plants[k].motor_torque_nm(current, angles[k], rates[k])
        });
        at.outputs[MOTOR].with_values(torques)
    }

    #[inline(always)]
    fn hub_extras(&self, at: &LanePoint<S>, motion: &LaneMotion<S>) -> Lane<S> {
        let (hub, motor, rate) =
            (motion.pivot_angle.values(), motion.motor_angle.values(), motion.pivot_rate.values());
        let torques: Lanes = std::array::from_fn(|k| at.plants[k].hub_torque_nm(hub[k], motor[k], rate[k]));
        at.outputs[MOTOR].with_values(torques)
    }

    /// Returns the load at a tilt.
    #[inline(always)]
    pub fn load(&self, tilt: [Lane<S>; 2], heave: Lane<S>) -> Lane<S> {
        (self.gravity + heave) * tilt[1]
    }

    /// Returns the sine and cosine that gravity sees; they are right only at angles within [`crate::tolerance::NEAR_ANGLE_RAD`] of the known one.
    #[inline(always)]
    pub fn tilt(&self, about: &LaneAngle<Lane<S>>, hub_angle: Lane<S>) -> [Lane<S>; 2] {
        match self.axis {
            AxisKind::Rotary => about.sin_cos(hub_angle),
            AxisKind::Linear => [hub_angle.constant(0.0), hub_angle.constant(1.0)],
        }
    }

    /// Returns how far a hub angle is from the known one, rad; 0 if gravity does not see the angle.
    #[inline(always)]
    pub fn reach(&self, about: &LaneAngle<Lane<S>>, hub_angle: Lane<S>) -> Lane<S> {
        match self.axis {
            AxisKind::Rotary => (hub_angle - about.angle).abs(),
            AxisKind::Linear => hub_angle.constant(0.0),
        }
    }

    /// Returns what the loop's sensor feels.
    #[inline(always)]
    pub fn sensor_reading(&self, outputs: &[Lane<S>; OUTPUTS], platform: &LanePlatform<Lane<S>>) -> Lane<S> {
        match self.measured {
            FeedbackSignal::HubRate => outputs[HUB_RATE],
            FeedbackSignal::RelativeRate => outputs[HUB_RATE] - platform.rate,
            FeedbackSignal::MotorRate => (outputs[MOTOR] - self.coupling * platform.rate) / self.ratio,
            FeedbackSignal::HubPosition => outputs[HUB_ANGLE] - platform.angle,
            FeedbackSignal::MotorPosition => outputs[WINDUP] + outputs[HUB_ANGLE] - platform.angle,
            // a machine whose loop measures torque runs alone
            FeedbackSignal::Torque | FeedbackSignal::Current => outputs[CURRENT],
        }
    }
}

impl<S: Simd> LaneAngle<Lane<S>> {
    /// Returns the sine and cosine by the addition theorem, of the difference by its series.
    #[inline(always)]
    fn sin_cos(&self, angle: Lane<S>) -> [Lane<S>; 2] {
        let d = angle - self.angle;
        let (one, half) = (d.constant(1.0), d.constant(0.5));
        let (six, twelve, twenty) = (d.constant(6.0), d.constant(12.0), d.constant(20.0));
        let square = d * d;
        let sin = d * (one - square / six * (one - square / twenty));
        let cos = one - half * square * (one - square / twelve);
        [self.sin * cos + self.cos * sin, self.cos * cos - self.sin * sin]
    }
}

/// A relative motion between two instants.
struct Path<S: Simd> {
    rates: [Lane<S>; 2],
    travel: Lane<S>,
    time: Lane<S>,
}

impl<S: Simd> Path<S> {
    /// Friction's state after the motion; a reversal splits it, as in the engine of one mechanism.
    #[inline(always)]
    fn advance(&self, friction: &DryFriction<Lane<S>>, state: Lane<S>) -> Lane<S> {
        if friction.is_none() {
            return state;
        }
        let [before, after] = self.rates;
        let zero = state.constant(0.0);
        let keeps_direction = (before * after).is_at_least(zero);
        let whole = friction.advance(self.travel / self.time, self.time, state);
        if keeps_direction.invert().is_nowhere() {
            return whole;
        }
        let mut turned = state;
        for (travel, time) in self.parts() {
            turned = time.is_above(zero).select(friction.advance(travel / time, time, turned), turned);
        }
        keeps_direction.select(whole, turned)
    }

    /// Returns the travel and time before and after a reversal.
    #[inline(always)]
    fn parts(&self) -> [(Lane<S>, Lane<S>); 2] {
        let [before, after] = self.rates;
        let part = before / (before - after);
        let (half, one) = (part.constant(0.5), part.constant(1.0));
        let (two, three) = (part.constant(2.0), part.constant(3.0));
        let straight = half * (before + after) * self.time;
        let bend = (self.travel - straight) * part * part * (three - two * part);
        let first = half * before * part * self.time + bend;
        [(first, part * self.time), (self.travel - first, (one - part) * self.time)]
    }
}

/// Returns the lengths between the nodes of a step.
#[inline(always)]
pub(crate) fn node_lengths(step_s: f64) -> [f64; STAGES] {
    std::array::from_fn(|stage| (NODES[stage + 1] - NODES[stage]) * step_s)
}
