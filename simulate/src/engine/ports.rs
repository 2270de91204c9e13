//! The nonlinear parts of the plant along a step: dry friction, gravity's angle, and everything that is not linear.

use super::moments::NODES;
use super::tables::{OUTPUTS, PORTS, STAGES};
use crate::Error;
use crate::firing::Firing;
use crate::tolerance::{NEAR_ANGLE_RAD, SMALL_ACCELERATION, SMALL_FLOW};
use counterpoise_models::friction::{Bristle, FrictionConditions, FrictionModel, Law, Stick};
use counterpoise_models::plant::{CylinderPoint, Hose, JointMotion, LearnedFunctions, LearnedRegime, SinCos};
use counterpoise_models::{AxisKind, FeedbackSignal, LearnedPlace, LoadPoint, Loads, Parameters, Plant};

/// The indices of the outputs (see [`OUTPUTS`]).
const MOTOR: usize = 0;
const WINDUP: usize = 1;
const HUB_ANGLE: usize = 2;
const HUB_RATE: usize = 3;
const CURRENT: usize = 4;

/// The states of dry friction: at the motor and at the pivot. N m for Dahl and Walrath, rad for LuGre and the reset
/// integrator, the sum of the deflections, rad, for bristles. For a law that truly sticks: 0 at rest, the sign of the
/// rate while it slides, twice that inside the band of rates in which Karnopp's law has its breakaway level.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrictionState {
    /// At the motor shaft.
    pub motor: f64,
    /// At the hub pivot.
    pub pivot: f64,
    /// Torque of a hose between hub and platform, N m.
    pub hose: f64,
    /// Torque of the hysteresis of the transmission's compliance at its output, N m.
    pub gear: f64,
}

impl FrictionState {
    /// Returns the state of the motor's (0) or the pivot's (1) friction.
    pub(crate) fn get(&self, joint: usize) -> f64 {
        [self.motor, self.pivot][joint]
    }

    /// Sets the state of the motor's (0) or the pivot's (1) friction.
    pub(crate) fn set(&mut self, joint: usize, value: f64) {
        *[&mut self.motor, &mut self.pivot][joint] = value;
    }
}

/// The platform at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PlatformPoint {
    pub angle: f64,
    pub rate: f64,
    pub heave: f64,
}

/// The motion of a platform beside heave and pitch.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct FurtherPoint {
    pub surge: f64,
    /// About the forward and about the upward axis.
    pub rates: [f64; 2],
    /// Torque on the hub that another axis makes, N m.
    pub torque: f64,
}

/// The platform along a step: at the four nodes and in the middle.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PlatformSpan {
    pub nodes: [PlatformPoint; 4],
    pub middle: PlatformPoint,
    /// At the nodes, then in the middle; `None` if the platform only heaves and pitches.
    pub further: Option<[FurtherPoint; 5]>,
}

impl PlatformSpan {
    /// Returns what the platform does beside heave and pitch at a node.
    #[inline]
    pub fn further_at(&self, node: usize) -> Option<&FurtherPoint> {
        self.further.as_ref().map(|all| &all[node])
    }

    /// Returns it in the middle.
    #[inline]
    pub fn further_amid(&self) -> Option<&FurtherPoint> {
        self.further_at(4)
    }
}

/// The bonds of bristle friction at motor and pivot, as [`counterpoise_models::friction::Bristle`] has them; empty
/// if friction has none, or while all are unbent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bonds {
    /// At the motor shaft.
    pub motor: Vec<f64>,
    /// At the hub pivot.
    pub pivot: Vec<f64>,
}

impl Bonds {
    /// Takes the bonds of another without a new allocation.
    pub(crate) fn copy(&mut self, from: &Self) {
        self.motor.clone_from(&from.motor);
        self.pivot.clone_from(&from.pivot);
    }
}

/// The values of the ports along a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PortSpan {
    /// Values at the stages, stage by stage.
    pub values: [f64; STAGES * PORTS],
    /// Friction at the stages.
    pub memory: [FrictionState; STAGES],
    /// Angles of motor and pivot to which friction has travelled, rad.
    pub travelled: [f64; 2],
}

/// The places at which the nonlinear parts are evaluated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point<'a> {
    pub time_s: f64,
    pub outputs: &'a [f64; OUTPUTS],
    pub platform: &'a PlatformPoint,
    /// `None` if the platform only heaves and pitches.
    pub further: Option<&'a FurtherPoint>,
    /// Drive of the amplifier, V.
    pub drive_v: f64,
    pub about: &'a NearbyAngle,
}

/// The quantities that the loop's sensor may feel at one instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SensorPoint<'a> {
    pub outputs: &'a [f64; OUTPUTS],
    pub platform: &'a PlatformPoint,
    /// Torque of the transmission's hysteresis, N m.
    pub gear_hysteresis_nm: f64,
}

/// Sine and cosine of angles near one whose own are known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearbyAngle {
    angle: f64,
    sin: f64,
    cos: f64,
}

impl NearbyAngle {
    pub fn new(angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { angle, sin, cos }
    }

    /// Returns the sine and the cosine of an angle, about which the next angles are taken to lie.
    #[inline]
    pub fn follow(&mut self, angle: f64) -> SinCos {
        *self = self.move_to(angle);
        self.sin_cos(angle)
    }

    /// Returns the angle, its sine and its cosine.
    pub fn parts(&self) -> [f64; 3] {
        [self.angle, self.sin, self.cos]
    }

    /// Returns the values of an angle whose sine and cosine are known.
    pub fn from_parts([angle, sin, cos]: [f64; 3]) -> Self {
        Self { angle, sin, cos }
    }

    /// Returns these values, or those about a new angle if it is far.
    #[inline]
    pub fn move_to(self, angle: f64) -> Self {
        if (angle - self.angle).abs() < 0.5 * NEAR_ANGLE_RAD { self } else { Self::new(angle) }
    }

    /// Returns the sine and cosine by the addition theorem, of the difference by its series.
    #[inline]
    fn sin_cos(&self, angle: f64) -> SinCos {
        let d = angle - self.angle;
        if d.abs() > NEAR_ANGLE_RAD {
            return SinCos::of(angle);
        }
        let square = d * d;
        let (sin, cos) =
            (d * (1.0 - square / 6.0 * (1.0 - square / 20.0)), 1.0 - 0.5 * square * (1.0 - square / 12.0));
        SinCos { sin: self.sin * cos + self.cos * sin, cos: self.cos * cos - self.sin * sin }
    }
}

/// The time over which friction is advanced.
#[derive(Debug, Clone, Copy)]
struct Interval {
    /// Time at which the level of friction is taken, s: the start of the step.
    level_at_s: f64,
    /// Its length, s.
    length_s: f64,
}

/// Relative motions at a point.
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    motor_rate: f64,
    motor_angle: f64,
    pivot_rate: f64,
    pivot_angle: f64,
    mesh_torque: f64,
    /// Of the transmission; only with hysteresis.
    wind_up: f64,
}

impl Motion {
    /// Returns where the plant is, as its free functions see it, but for drive and current.
    #[inline]
    fn regime(&self, time_s: f64) -> LearnedRegime {
        LearnedRegime {
            time_s,
            drive_v: 0.0,
            current_a: 0.0,
            motor: JointMotion { angle_rad: self.motor_angle, rate_rad_s: self.motor_rate },
            hub: JointMotion { angle_rad: self.pivot_angle, rate_rad_s: self.pivot_rate },
            wind_up_rad: self.wind_up,
            mesh_torque_nm: self.mesh_torque,
        }
    }
}

/// The plant's nonlinear parts, ready for evaluation.
#[derive(Debug, Clone)]
pub(crate) struct Ports {
    motor: FrictionModel,
    pivot: FrictionModel,
    ratio: f64,
    coupling: f64,
    gravity: f64,
    vertical_offset: f64,
    motor_extras: bool,
    hub_extras: bool,
    hose: Option<Hose>,
    gear_hysteresis: Option<Hose>,
    /// `true` if the transmission has a kinematic error.
    wavy: bool,
    axis: AxisKind,
    measured: FeedbackSignal,
    lossy: bool,
    needs_mesh_torque: bool,
    learned: Option<Box<LearnedFunctions>>,
    loads: Option<Box<Loads>>,
    /// `true` if a hydraulic cylinder drives: the valve's opening then takes the place of the wind-up.
    has_cylinder: bool,
    /// Lowest and highest current that the drive gives, A; `None` if the amplifier alone limits it.
    current_range_a: Option<[f64; 2]>,
    /// Torques and loads against which an error at a port is small.
    pub scales: [f64; PORTS],
}

/// The nonlinear parts of a mechanism that has no others than dry friction, gravity's angle, and torques of angle, rate and current.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CommonParts {
    pub has_motor_extras: bool,
    pub has_hub_extras: bool,
    pub axis: AxisKind,
    pub measured: FeedbackSignal,
}

impl Ports {
    pub fn new(plant: &Plant) -> Result<Self, Error> {
        let parameters = plant.parameters();
        let motor = FrictionModel::new(&parameters.motor_friction)?;
        let pivot = FrictionModel::new(&parameters.pivot_friction)?;
        let lossy = parameters.gearbox.mesh_efficiency != 1.0;
        let wavy = parameters.gearbox.kinematic_error.amplitude != 0.0;
        let loaded = |f: &counterpoise_models::Friction| f.load_coefficient != 0.0;
        let held = plant.body().out_of_balance_kg_m.abs() * parameters.gravity_m_s2.abs();
        let ratio = parameters.gearbox.ratio;
        let loaded_nm = plant.loads().map_or(0.0, Loads::scale_nm);
        let hub_scale = parameters.pivot_friction.coulomb_nm()
            + 0.1 * held
            + transmission_scale_nm(parameters)
            + loaded_nm;
        let motor_scale = parameters.motor_friction.coulomb_nm() + 0.1 * held / ratio;
        // an end of the gear without dry friction or weight of its own is measured by the other end's
        let own_or = |own: f64, others: f64| if own > 0.0 { own } else { others };
        // a machine without either is measured by its inertia
        let hub_scale = own_or(hub_scale, motor_scale * ratio);
        let hub_scale = own_or(hub_scale, SMALL_ACCELERATION * plant.body().inertia_kg_m2);
        let drive_scale = match &parameters.cylinder {
            Some(_) => SMALL_FLOW * parameters.amplifier.gain * parameters.amplifier.input_limit_v,
            None => own_or(motor_scale, hub_scale / ratio),
        };
        let scales = [drive_scale, own_or(hub_scale, motor_scale * ratio), 1.0];
        Ok(Self {
            motor,
            pivot,
            ratio,
            coupling: plant.motor_share(),
            gravity: parameters.gravity_m_s2,
            vertical_offset: plant.body().vertical_offset_kg_m,
            motor_extras: has_motor_extras(plant),
            hub_extras: plant.spring_torque_nm(0.0) != plant.spring_torque_nm(1.0)
                || parameters.gearbox.mesh_ripple.amplitude != 0.0
                || parameters.pivot_friction.has_drag(),
            hose: plant.hose(),
            gear_hysteresis: plant.gear_hysteresis(),
            wavy,
            axis: parameters.axis,
            measured: parameters.sensors.measured,
            lossy,
            needs_mesh_torque: lossy
                || wavy
                || loaded(&parameters.motor_friction)
                || loaded(&parameters.pivot_friction)
                || plant.learned_functions().is_some_and(LearnedFunctions::needs_mesh_torque),
            learned: plant.learned_functions().cloned().map(Box::new),
            loads: plant.loads().cloned().map(Box::new),
            has_cylinder: parameters.cylinder.is_some(),
            current_range_a: None,
            scales,
        })
    }

    /// Returns the parts that nearly every mechanism has; `None` if there are others.
    pub fn common_parts(&self) -> Option<CommonParts> {
        let has_others = self.hose.is_some()
            || self.gear_hysteresis.is_some()
            || self.needs_mesh_torque
            || self.learned.is_some()
            || self.loads.is_some()
            || self.has_cylinder
            || self.measured == FeedbackSignal::Torque
            || self.frictions().iter().any(|friction| friction.is_modulated());
        (!has_others).then_some(CommonParts {
            has_motor_extras: self.motor_extras,
            has_hub_extras: self.hub_extras,
            axis: self.axis,
            measured: self.measured,
        })
    }

    /// Returns the friction at the motor and at the pivot.
    pub fn frictions(&self) -> [&FrictionModel; 2] {
        [&self.motor, &self.pivot]
    }

    /// Returns the port values at the start of a step, where friction's state is known.
    pub fn at(&self, plant: &Plant, at: &Point, memory: &FrictionState) -> [f64; PORTS] {
        let motion = self.motion(plant, at);
        self.values(plant, at, &motion, memory)
    }

    /// Returns the dry friction torques at the motor and at the pivot.
    pub fn dry_torques(&self, plant: &Plant, at: &Point, memory: &FrictionState) -> [f64; 2] {
        let motion = self.motion(plant, at);
        [
            dry_torque(&self.motor, motion.motor_rate, self.motor_level(&motion, at.time_s), memory.motor),
            dry_torque(&self.pivot, motion.pivot_rate, self.pivot_level(&motion, at.time_s), memory.pivot),
        ]
    }

    /// Returns what the friction at the motor (0) or at the pivot (1) holds at a point; `None` if its law does not stick.
    pub fn stick(&self, plant: &Plant, joint: usize, at: &Point) -> Option<Stick> {
        let motion = self.motion(plant, at);
        match joint {
            0 => self.motor.stick(self.motor_level(&motion, at.time_s)),
            _ => self.pivot.stick(self.pivot_level(&motion, at.time_s)),
        }
    }

    /// Returns the band of rates in which a sliding joint has its breakaway level, rad/s; 0 if that is its sliding level.
    pub fn band(&self, joint: usize) -> f64 {
        match [&self.motor, &self.pivot][joint].law() {
            Law::Sliding(law) if law.breakaway_ratio > 1.0 => law.rest_rate_rad_s,
            _ => 0.0,
        }
    }

    /// Returns whether the law at the motor (0) or at the pivot (1) truly sticks.
    pub fn sticks(&self, joint: usize) -> bool {
        matches!([&self.motor, &self.pivot][joint].law(), Law::Sliding(_))
    }

    /// Returns whether either law is that of bristles, whose torque jumps with every bond that snaps.
    pub fn has_bristles(&self) -> bool {
        [&self.motor, &self.pivot].iter().any(|model| matches!(model.law(), Law::Bristle(_)))
    }

    /// Returns the rates of the motor and of the pivot relative to the platform.
    #[inline]
    pub fn rates(&self, outputs: &[f64; OUTPUTS], platform_rate: f64) -> [f64; 2] {
        [outputs[MOTOR] - self.coupling * platform_rate, outputs[HUB_RATE] - platform_rate]
    }

    /// Returns what the loop's sensor feels at a point.
    #[inline]
    pub fn sensor_reading(&self, plant: &Plant, at: &SensorPoint) -> f64 {
        let SensorPoint { outputs, platform, .. } = at;
        match self.measured {
            FeedbackSignal::HubRate => outputs[HUB_RATE],
            FeedbackSignal::RelativeRate => outputs[HUB_RATE] - platform.rate,
            FeedbackSignal::MotorRate => (outputs[MOTOR] - self.coupling * platform.rate) / self.ratio,
            FeedbackSignal::HubPosition => outputs[HUB_ANGLE] - platform.angle,
            FeedbackSignal::MotorPosition => self.wind_up(outputs) + outputs[HUB_ANGLE] - platform.angle,
            FeedbackSignal::Torque => {
                let motor_rate = outputs[MOTOR] - self.coupling * platform.rate;
                let motor_angle = self.ratio * (outputs[WINDUP] + outputs[HUB_ANGLE] - platform.angle);
                let spring =
                    plant.mesh_torque_nm(outputs[WINDUP], outputs[HUB_RATE], motor_rate, platform.rate);
                let passed = spring + at.gear_hysteresis_nm;
                passed + plant.kinematic_error_nm(passed, motor_angle, motor_rate).hub_nm
            }
            FeedbackSignal::Current => outputs[CURRENT],
        }
    }

    /// Returns the port values at the stages of a step, friction advanced from node to node by its own closed form.
    pub fn advance_over_step(&self, plant: &Plant, span: &StepSpan, bonds: &mut Bonds) -> PortSpan {
        let mut result = PortSpan {
            values: [0.0; STAGES * PORTS],
            memory: [FrictionState::default(); STAGES],
            travelled: [0.0; 2],
        };
        let mut memory = *span.memory;
        let mut before = self.start(plant, span);
        for stage in 0..STAGES {
            let at = span.point(stage + 1);
            let after = self.motion(plant, &at);
            let length_s = (NODES[stage + 1] - NODES[stage]) * span.step_s;
            let interval = Interval { level_at_s: span.time_s, length_s };
            self.advance(&before, &after, interval, &mut memory, bonds);
            let values = self.values(plant, &at, &after, &memory);
            result.values[stage * PORTS..(stage + 1) * PORTS].copy_from_slice(&values);
            result.memory[stage] = memory;
            before = after;
        }
        result.travelled = [before.motor_angle, before.pivot_angle];
        result
    }

    /// Returns the motion at the start of a step, with the angles to which friction has travelled: what is seen of the core there is off by
    /// its own rounding, which would add up to a creep from step to step.
    #[inline]
    fn start(&self, plant: &Plant, span: &StepSpan) -> Motion {
        let seen = self.motion(plant, &span.point(0));
        match span.travelled {
            Some([motor_angle, pivot_angle]) => Motion { motor_angle, pivot_angle, ..seen },
            None => seen,
        }
    }

    /// Returns the port values in the middle of a step, from the first stage on.
    pub fn middle_values(
        &self,
        plant: &Plant,
        span: &StepSpan,
        stage: &FrictionState,
        bonds: &mut Bonds,
        middle: &Point,
    ) -> [f64; PORTS] {
        let before = self.motion(plant, &span.point(1));
        let after = self.motion(plant, middle);
        if self.has_bristles() {
            // bonds remember their path: it begins at the first node
            let first = self.start(plant, span);
            let whole = Interval { level_at_s: span.time_s, length_s: span.step_s };
            self.advance(&first, &before, whole, &mut stage.clone(), bonds);
        }
        let mut memory = *stage;
        let interval = Interval { level_at_s: span.time_s, length_s: (0.5 - NODES[1]) * span.step_s };
        self.advance(&before, &after, interval, &mut memory, bonds);
        self.values(plant, middle, &after, &memory)
    }

    /// Returns the load at a tilt under a heave and what comes beside it.
    #[inline]
    pub fn load(&self, tilt: SinCos, heave: f64, further: Option<&FurtherPoint>) -> f64 {
        let load = (self.gravity + heave) * tilt.cos;
        further.map_or(load, |further| load - further.surge * tilt.sin)
    }

    /// Returns the sine and cosine that gravity sees.
    #[inline]
    pub fn tilt(&self, about: &NearbyAngle, hub_angle: f64) -> SinCos {
        match self.axis {
            AxisKind::Rotary => about.sin_cos(hub_angle),
            AxisKind::Linear => SinCos { sin: 0.0, cos: 1.0 },
        }
    }

    /// Returns the wind-up of the transmission, rad; a cylinder has none.
    #[inline]
    fn wind_up(&self, outputs: &[f64; OUTPUTS]) -> f64 {
        if self.has_cylinder { 0.0 } else { outputs[WINDUP] }
    }

    /// Returns the motion of a cylinder's piston and of the hub.
    fn piston(&self, plant: &Plant, at: &Point) -> Motion {
        let (pivot_rate, pivot_angle) =
            (at.outputs[HUB_RATE] - at.platform.rate, at.outputs[HUB_ANGLE] - at.platform.angle);
        let Some(lever) = plant.lever_at(pivot_angle) else { return Motion::default() };
        Motion {
            motor_rate: lever.arm_m * pivot_rate,
            motor_angle: lever.travel_m,
            pivot_rate,
            pivot_angle,
            ..Motion::default()
        }
    }

    /// Returns the ports where a cylinder drives: the force on the piston acts on the hub by its lever, and the first port is the flow of the
    /// nonlinear valve.
    #[inline]
    fn through_cylinder(
        &self,
        plant: &Plant,
        at: &Point,
        motion: &Motion,
        ports: [f64; PORTS],
    ) -> [f64; PORTS] {
        if !self.has_cylinder {
            return ports;
        }
        let [force_n, hub, load] = ports;
        let parts = plant.cylinder_parts(&CylinderPoint {
            opening_l_s: at.outputs[WINDUP],
            pressure_mpa: at.outputs[CURRENT],
            angle_rad: motion.pivot_angle,
            rate_rad_s: motion.pivot_rate,
            force_n,
        });
        [parts.flow_l_s, hub + parts.hub_nm, load]
    }

    #[inline]
    fn motion(&self, plant: &Plant, at: &Point) -> Motion {
        if self.has_cylinder {
            return self.piston(plant, at);
        }
        let motor_rate = at.outputs[MOTOR] - self.coupling * at.platform.rate;
        let pivot_angle = at.outputs[HUB_ANGLE] - at.platform.angle;
        let mesh_torque = if self.needs_mesh_torque {
            plant.mesh_torque_nm(at.outputs[WINDUP], at.outputs[HUB_RATE], motor_rate, at.platform.rate)
        } else {
            0.0
        };
        Motion {
            motor_rate,
            motor_angle: self.ratio * (at.outputs[WINDUP] + pivot_angle),
            pivot_rate: at.outputs[HUB_RATE] - at.platform.rate,
            pivot_angle,
            mesh_torque,
            wind_up: at.outputs[WINDUP],
        }
    }

    #[inline]
    fn advance(
        &self,
        before: &Motion,
        after: &Motion,
        interval: Interval,
        memory: &mut FrictionState,
        bonds: &mut Bonds,
    ) {
        let motor = Path {
            rates: [before.motor_rate, after.motor_rate],
            travel: after.motor_angle - before.motor_angle,
            time: interval.length_s,
        };
        let level = self.motor_level(after, interval.level_at_s);
        memory.motor = motor.advance(&self.motor, level, memory.motor, &mut bonds.motor);
        let pivot = Path {
            rates: [before.pivot_rate, after.pivot_rate],
            travel: after.pivot_angle - before.pivot_angle,
            time: interval.length_s,
        };
        let level = self.pivot_level(after, interval.level_at_s);
        memory.pivot = pivot.advance(&self.pivot, level, memory.pivot, &mut bonds.pivot);
        if let Some(hose) = &self.hose {
            memory.hose = pivot.bend(hose, memory.hose);
        }
        if let Some(hysteresis) = &self.gear_hysteresis {
            let wind_up = Path {
                rates: [before, after].map(|at| at.motor_rate / self.ratio - at.pivot_rate),
                travel: after.wind_up - before.wind_up,
                time: interval.length_s,
            };
            memory.gear = wind_up.bend(hysteresis, memory.gear);
        }
    }

    #[inline]
    fn motor_level(&self, at: &Motion, time_s: f64) -> f64 {
        let learned = self.learned_level(LearnedPlace::Motor, at, time_s);
        if !self.motor.is_modulated() {
            return learned;
        }
        let load_nm = at.mesh_torque / self.ratio;
        learned * self.motor.level(&FrictionConditions { angle_rad: at.motor_angle, load_nm, time_s })
    }

    #[inline]
    fn pivot_level(&self, at: &Motion, time_s: f64) -> f64 {
        let learned = self.learned_level(LearnedPlace::Pivot, at, time_s);
        if !self.pivot.is_modulated() {
            return learned;
        }
        learned
            * self.pivot.level(&FrictionConditions {
                angle_rad: at.pivot_angle,
                load_nm: at.mesh_torque,
                time_s,
            })
    }

    /// Returns the factor of the free functions on the level of a joint's friction.
    #[inline]
    fn learned_level(&self, place: LearnedPlace, at: &Motion, time_s: f64) -> f64 {
        match &self.learned {
            Some(functions) => functions.friction_level(place, &at.regime(time_s)),
            None => 1.0,
        }
    }

    #[inline]
    fn values(&self, plant: &Plant, at: &Point, motion: &Motion, memory: &FrictionState) -> [f64; PORTS] {
        let SinCos { sin, cos } = self.tilt(at.about, at.outputs[HUB_ANGLE]);
        let gravity = self.gravity + at.platform.heave;
        let motor_level = self.motor_level(motion, at.time_s);
        let pivot_level = self.pivot_level(motion, at.time_s);
        let mut motor = -dry_torque(&self.motor, motion.motor_rate, motor_level, memory.motor);
        let mut hub = gravity * self.vertical_offset * sin
            - dry_torque(&self.pivot, motion.pivot_rate, pivot_level, memory.pivot);
        hub -= memory.hose;
        let mut load = gravity * cos;
        if let Some(further) = at.further {
            load -= further.surge * sin;
            hub += self.vertical_offset * further.surge * cos
                + plant.gyroscopic_torque_nm(SinCos { sin, cos }, further.rates)
                + further.torque;
        }
        if self.motor_extras {
            let current = at.outputs[CURRENT] + plant.direct_current_a(at.drive_v, at.platform.rate);
            motor += plant.motor_torque_nm(current, motion.motor_angle, motion.motor_rate);
        }
        if self.hub_extras {
            hub += plant.hub_torque_nm(motion.pivot_angle, motion.motor_angle, motion.pivot_rate);
        }
        if self.lossy {
            let loss = plant.mesh_loss_nm(motion.mesh_torque, motion.motor_rate);
            motor += loss.motor_nm;
            hub += loss.hub_nm;
        }
        if self.gear_hysteresis.is_some() {
            motor -= memory.gear / self.ratio;
            hub += memory.gear;
        }
        if self.wavy {
            let passed = motion.mesh_torque + memory.gear;
            let error = plant.kinematic_error_nm(passed, motion.motor_angle, motion.motor_rate);
            motor += error.motor_nm;
            hub += error.hub_nm;
        }
        if let Some(range) = &self.current_range_a {
            motor += self.cut_torque_nm(plant, at, motion, range);
        }
        if let Some(loads) = &self.loads {
            hub += loads.torque_nm(&LoadPoint {
                time_s: at.time_s,
                angle_rad: motion.pivot_angle,
                rate_rad_s: motion.pivot_rate,
                hub_rate_rad_s: at.outputs[HUB_RATE],
                load_m_s2: load,
            });
        }
        if let Some(functions) = &self.learned {
            let current_a = at.outputs[CURRENT] + plant.direct_current_a(at.drive_v, at.platform.rate);
            let regime = LearnedRegime { current_a, drive_v: at.drive_v, ..motion.regime(at.time_s) };
            let added = functions.torques(plant, &regime);
            motor += added.motor_nm;
            hub += added.hub_nm;
        }
        self.through_cylinder(plant, at, motion, [motor, hub, load])
    }
}

impl Ports {
    /// Leaves the shots of a recoiling machine out, or takes the plant's own.
    pub fn fire(&mut self, plant: &Plant, firing: Firing) {
        self.loads = plant.loads().cloned().map(Box::new);
        if let (Some(loads), Firing::Silent) = (&mut self.loads, firing) {
            loads.recoil = None;
        }
    }

    /// Sets the lowest and the highest current that the drive gives, A.
    pub fn limit_current(&mut self, range_a: Option<[f64; 2]>) {
        self.current_range_a = range_a;
    }

    /// Returns what the limits of the drive take from the motor's torque beside the amplifier's peak current.
    #[inline]
    fn cut_torque_nm(&self, plant: &Plant, at: &Point, motion: &Motion, [low, high]: &[f64; 2]) -> f64 {
        let (motor, amplifier) = (&plant.parameters().motor, &plant.parameters().amplifier);
        let current = at.outputs[CURRENT] + plant.direct_current_a(at.drive_v, at.platform.rate);
        let peak = current.clamp(-amplifier.current_limit_a, amplifier.current_limit_a);
        let given = peak.min(*high).max(*low);
        let constant = motor.torque_constant_nm_a * (1.0 + motor.torque_ripple.at(motion.motor_angle));
        constant * (given - peak)
    }
}

/// A step as the ports see it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepSpan<'a> {
    pub time_s: f64,
    pub step_s: f64,
    pub outputs: &'a [[f64; OUTPUTS]; 4],
    pub platform: &'a PlatformSpan,
    /// Drive of the amplifier, V.
    pub drive_v: f64,
    pub memory: &'a FrictionState,
    /// Angles of motor and pivot to which friction has travelled before the step, rad.
    pub travelled: Option<[f64; 2]>,
    pub about: &'a NearbyAngle,
}

impl StepSpan<'_> {
    #[inline]
    fn point(&self, node: usize) -> Point<'_> {
        Point {
            time_s: self.time_s + NODES[node] * self.step_s,
            outputs: &self.outputs[node],
            platform: &self.platform.nodes[node],
            further: self.platform.further_at(node),
            drive_v: self.drive_v,
            about: self.about,
        }
    }
}

/// A relative motion between two instants.
struct Path {
    rates: [f64; 2],
    travel: f64,
    time: f64,
}

impl Path {
    /// Friction's state after the motion: exact at a constant level, whatever the rate did between; a reversal
    /// splits the motion where the rate, taken as the cubic through angles and rates demands, is zero.
    #[inline]
    fn advance(&self, model: &FrictionModel, level: f64, state: f64, bonds: &mut Vec<f64>) -> f64 {
        let [before, after] = self.rates;
        match model.law() {
            Law::None | Law::Sliding(_) => return state,
            Law::Bristle(law) => return self.drag(law, bonds),
            _ if self.time == 0.0 => return state,
            _ => {}
        }
        let mut states = [state];
        if before * after >= 0.0 {
            model.advance(self.travel / self.time, self.time, level, &mut states);
            return states[0];
        }
        for (travel, time) in self.parts() {
            if time > 0.0 {
                model.advance(travel / time, time, level, &mut states);
            }
        }
        states[0]
    }

    /// Returns the torque of a hose after the motion.
    #[inline]
    fn bend(&self, hose: &Hose, torque: f64) -> f64 {
        if self.rates[0] * self.rates[1] >= 0.0 {
            return hose.torque_after_nm(torque, self.travel);
        }
        self.parts().iter().fold(torque, |torque, (travel, _)| hose.torque_after_nm(torque, *travel))
    }

    /// Returns the travel and time before and after a reversal.
    fn parts(&self) -> [(f64, f64); 2] {
        let [before, after] = self.rates;
        let part = before / (before - after);
        let straight = 0.5 * (before + after) * self.time;
        let bend = (self.travel - straight) * part * part * (3.0 - 2.0 * part);
        let first = 0.5 * before * part * self.time + bend;
        [(first, part * self.time), (self.travel - first, (1.0 - part) * self.time)]
    }

    /// Bends and snaps the bonds; returns the sum of their deflections.
    fn drag(&self, law: &Bristle, bonds: &mut Vec<f64>) -> f64 {
        bonds.resize(2 * law.bristles, 0.0);
        if self.rates[0] * self.rates[1] >= 0.0 {
            law.displace(self.travel, bonds);
        } else {
            self.parts().iter().for_each(|(travel, _)| law.displace(*travel, bonds));
        }
        bonds[..law.bristles].iter().sum()
    }
}

/// Returns the torque of the dry part: the viscous and quadratic parts are elsewhere. A law that truly sticks slides in the
/// direction that its state tells, and takes no part in the ports at rest.
#[inline]
pub(crate) fn dry_torque(model: &FrictionModel, rate: f64, level: f64, state: f64) -> f64 {
    let Law::Sliding(_) = model.law() else { return model.dry_torque(rate, level, &[state]) };
    if state == 0.0 {
        return 0.0;
    }
    if state.abs() > 1.0
        && let Some(stick) = model.stick(level)
    {
        return if state > 0.0 { stick.positive_nm } else { -stick.negative_nm };
    }
    model.dry_torque(rate.abs().max(f64::MIN_POSITIVE) * state, level, &[])
}

/// Torque of a transmission's own nonlinear parts against which an error is small, N m at the output.
fn transmission_scale_nm(parameters: &Parameters) -> f64 {
    let gearbox = &parameters.gearbox;
    let stretched = match gearbox.kinematic_error.amplitude {
        0.0 => 0.0,
        amplitude => gearbox.stiffness_nm_rad * amplitude.abs(),
    };
    gearbox.hysteresis_nm + 0.1 * stretched
}

fn has_motor_extras(plant: &Plant) -> bool {
    let parameters = plant.parameters();
    parameters.motor.cogging.amplitude != 0.0
        || parameters.motor.torque_ripple.amplitude != 0.0
        || parameters.amplifier.current_limit_a.is_finite()
        || parameters.motor_friction.has_drag()
}
