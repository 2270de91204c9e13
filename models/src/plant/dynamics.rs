//! The plant's nonlinear right-hand side.

use super::core::{input, state};
use super::free_functions::{JointMotion, LearnedRegime};
use super::mesh_loss::MeshLoss;
use super::{Core, CylinderPoint, Mesh, Plant};
use crate::friction::{FrictionConditions, FrictionModel};
use crate::loads::LoadPoint;
use crate::parameters::LearnedPlace;
use crate::tolerance::POWER_REVERSAL_RATE;

/// Inputs that act on the plant at an instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Excitation {
    /// Time since the start, s (for the warm-up of friction).
    pub time_s: f64,
    /// Control after the output converter, V.
    pub control_v: f64,
    /// Heave: upward acceleration of the pivot without gravity, m/s^2.
    pub heave_m_s2: f64,
    /// Platform angle, rad.
    pub platform_angle_rad: f64,
    /// Platform pitch rate, rad/s.
    pub platform_rate_rad_s: f64,
    /// Platform pitch acceleration, rad/s^2: only a rotor behind a rigid transmission feels it.
    pub platform_acceleration_rad_s2: f64,
    /// Surge: forward acceleration of the pivot, m/s^2.
    pub surge_m_s2: f64,
    /// Rates of the platform about its forward and its upward axis, rad/s; [`crate::base_motion`] defines the axes.
    pub off_axis_rates_rad_s: [f64; 2],
}

impl Plant {
    /// Returns the number of states of the right-hand side: those of the core, then the dry friction state at the motor and at
    /// the pivot (always both; a law without a state leaves its own at rest), then a hose's torque and that of the transmission's
    /// hysteresis if there is one.
    pub fn order(&self) -> usize {
        self.core_order() + 2 + usize::from(self.hose.is_some()) + usize::from(self.gear_hysteresis.is_some())
    }

    /// Returns the derivative of the state \[core ([`state`]), motor friction, pivot friction, hose, gear hysteresis\]: the
    /// definition of the plant.
    ///
    /// Laws with one state are continuous and are taken as they are (a torque in N m for Dahl and Walrath, a deflection in
    /// rad for LuGre and the reset integrator); laws that truly stick slide at any rate but zero, and bristles are taken
    /// at their mean sliding level. A voltage at the bus limit stays there. The simulator treats the same equations piecewise
    /// exactly; this form is for second opinions.
    pub fn derivative(&self, x: &[f64], at: &Excitation, dx: &mut [f64]) {
        let n = self.core_order();
        let dot = |row: &[f64]| row.iter().zip(x).map(|(c, s)| c * s).sum::<f64>();
        let (hub_rate, hub_angle) = (dot(&self.hub_rate_row()), dot(&self.hub_angle_row()));
        let relative_rate = hub_rate - at.platform_rate_rad_s;
        let relative_angle = hub_angle - at.platform_angle_rad;
        let motor = self.motor_motion(x, relative_angle, at.platform_rate_rad_s);
        let (motor_rate, motor_angle) = (motor.rate_rad_s, motor.angle_rad);
        let (mesh, offset) = self.mesh(x[state::WINDUP]);
        let core = self.core(mesh);
        let mesh_torque = self.mesh_torque_nm(x[state::WINDUP], hub_rate, motor_rate, at.platform_rate_rad_s);
        let ratio = self.parameters.gearbox.ratio;
        let (sin, cos) = self.tilt(hub_angle);
        let gravity = self.parameters.gravity_m_s2 + at.heave_m_s2;
        let mut u = [0.0; input::COUNT];
        let hub = JointMotion { angle_rad: relative_angle, rate_rad_s: relative_rate };
        let regime = self.regime(x, at, [motor, hub], mesh_torque);
        u[input::DRIVE] = regime.drive_v;
        u[input::PLATFORM_RATE] = at.platform_rate_rad_s;
        let loss = self.mesh_loss_nm(mesh_torque, motor_rate);
        let hysteresis = if self.gear_hysteresis.is_some() { x[self.order() - 1] } else { 0.0 };
        let error = self.kinematic_error_nm(mesh_torque + hysteresis, motor_angle, motor_rate);
        let added = self.learned_torques(&regime);
        let [motor_dry, pivot_dry] = self.dry_parts(&regime, [x[n], x[n + 1]]);
        u[input::MOTOR_TORQUE] = self.motor_torque_nm(regime.current_a, motor_angle, motor_rate)
            + loss.motor_nm
            - motor_dry.torque_nm
            + error.motor_nm
            - hysteresis / ratio
            + added.motor_nm;
        u[input::HUB_TORQUE] = self.hub_torque_nm(relative_angle, motor_angle, relative_rate) + loss.hub_nm
            - pivot_dry.torque_nm
            - if self.hose.is_some() { x[n + 2] } else { 0.0 }
            + error.hub_nm
            + hysteresis
            + gravity * self.body.vertical_offset_kg_m * sin
            + at.surge_m_s2 * self.body.vertical_offset_kg_m * cos
            + self.gyroscopic_torque_nm(SinCos { sin, cos }, at.off_axis_rates_rad_s)
            + added.hub_nm;
        u[input::LOAD] = gravity * cos - at.surge_m_s2 * sin;
        if let Some(loads) = &self.loads {
            u[input::HUB_TORQUE] += loads.torque_nm(&LoadPoint {
                time_s: at.time_s,
                angle_rad: relative_angle,
                rate_rad_s: relative_rate,
                hub_rate_rad_s: hub_rate,
                load_m_s2: u[input::LOAD],
            });
        }
        u[input::MESH_TORQUE] = offset;
        self.move_force_to_hub(x, &hub, &mut u);
        multiply(&core, x, &u, dx);
        self.complete_core(&core, x, at, dx);
        dx[n] = motor_dry.slope;
        dx[n + 1] = pivot_dry.slope;
        self.hose_and_hysteresis(x, relative_rate, motor_rate / ratio - relative_rate, dx);
    }

    /// Returns the motion of the motor on the platform; of a cylinder that of its piston.
    fn motor_motion(&self, x: &[f64], relative_angle: f64, platform_rate: f64) -> JointMotion {
        let dot = |row: &[f64]| row.iter().zip(x).map(|(c, s)| c * s).sum::<f64>();
        match self.lever_at(relative_angle) {
            Some(lever) => JointMotion {
                angle_rad: lever.travel_m,
                rate_rad_s: lever.arm_m * (dot(&self.hub_rate_row()) - platform_rate),
            },
            None => JointMotion {
                angle_rad: self.parameters.gearbox.ratio * (x[state::WINDUP] + relative_angle),
                rate_rad_s: dot(&self.motor_rate_row()) - self.motor_share() * platform_rate,
            },
        }
    }

    /// With a cylinder the force on the piston acts on the hub by the lever at its angle, beside what the valve and the lever add.
    fn move_force_to_hub(&self, x: &[f64], hub: &JointMotion, u: &mut [f64; input::COUNT]) {
        if self.parameters.cylinder.is_none() {
            return;
        }
        let parts = self.cylinder_parts(&CylinderPoint {
            opening_l_s: x[state::VOLTAGE],
            pressure_mpa: x[state::CURRENT],
            angle_rad: hub.angle_rad,
            rate_rad_s: hub.rate_rad_s,
            force_n: u[input::MOTOR_TORQUE],
        });
        u[input::MOTOR_TORQUE] = 0.0;
        u[input::FLOW] = parts.flow_l_s;
        u[input::HUB_TORQUE] += parts.hub_nm;
    }

    /// Sets the derivatives of a hose's torque and of that of the transmission's hysteresis, where there are such.
    fn hose_and_hysteresis(&self, x: &[f64], hub_rate_rad_s: f64, twist_rate_rad_s: f64, dx: &mut [f64]) {
        if let Some(hose) = self.hose {
            let place = self.core_order() + 2;
            dx[place] = hose.slope(x[place], hub_rate_rad_s);
        }
        if let Some(hysteresis) = self.gear_hysteresis {
            let last = self.order() - 1;
            dx[last] = hysteresis.slope(x[last], twist_rate_rad_s);
        }
    }

    /// Adds what the platform's acceleration does to the core, and holds a voltage at the bus limit.
    fn complete_core(&self, core: &Core, x: &[f64], at: &Excitation, dx: &mut [f64]) {
        for (slope, carried) in dx.iter_mut().zip(&core.carried) {
            *slope += carried * at.platform_acceleration_rad_s2;
        }
        let bus = self.parameters.amplifier.bus_voltage_v;
        if x[state::VOLTAGE].abs() >= bus && dx[state::VOLTAGE] * x[state::VOLTAGE] > 0.0 {
            dx[state::VOLTAGE] = 0.0;
        }
    }

    /// Returns where the plant is, as its free functions see it, with the motion of the motor and of the hub on the platform.
    fn regime(
        &self,
        x: &[f64],
        at: &Excitation,
        [motor, hub]: [JointMotion; 2],
        mesh_torque_nm: f64,
    ) -> LearnedRegime {
        let drive_v = self.parameters.amplifier.drive_v(at.control_v, &self.parameters.motor);
        let of_states: f64 =
            self.current_row().iter().zip(x).take(self.core_order()).map(|(c, s)| c * s).sum();
        LearnedRegime {
            time_s: at.time_s,
            drive_v,
            current_a: of_states + self.direct_current_a(drive_v, at.platform_rate_rad_s),
            motor,
            hub,
            wind_up_rad: x[state::WINDUP],
            mesh_torque_nm,
        }
    }

    /// Returns dry friction at the motor and at the pivot, from their states.
    fn dry_parts(&self, at: &LearnedRegime, states: [f64; 2]) -> [DryPart; 2] {
        let ratio = self.parameters.gearbox.ratio;
        let part =
            |friction: &FrictionModel, place: LearnedPlace, motion: JointMotion, load_nm: f64, z: f64| {
                let around = FrictionConditions { angle_rad: motion.angle_rad, load_nm, time_s: at.time_s };
                let level = self.learned_level(place, at) * friction.level(&around);
                dry_part(friction, motion.rate_rad_s, level, z)
            };
        [
            part(&self.motor_friction, LearnedPlace::Motor, at.motor, at.mesh_torque_nm / ratio, states[0]),
            part(&self.pivot_friction, LearnedPlace::Pivot, at.hub, at.mesh_torque_nm, states[1]),
        ]
    }

    /// Returns whether the teeth touch at a wind-up, and the torque that takes half the gap off the spring, N m.
    #[inline]
    pub fn mesh(&self, wind_up_rad: f64) -> (Mesh, f64) {
        let half = 0.5 * self.parameters.gearbox.backlash_rad;
        if half == 0.0 {
            return (Mesh::Touching, -0.0);
        }
        if half > 0.0 && wind_up_rad.abs() <= half {
            return (Mesh::Free, 0.0);
        }
        let sign = if half > 0.0 { wind_up_rad.signum() } else { 0.0 };
        (Mesh::Touching, -sign * half * self.parameters.gearbox.stiffness_nm_rad)
    }

    /// Returns the gear torque T_2 at the output, N m, without kinematic error and hysteresis; 0 if the transmission is rigid, whose
    /// torque is no function of the motion.
    pub fn mesh_torque_nm(
        &self,
        wind_up_rad: f64,
        hub_rate: f64,
        motor_rate: f64,
        platform_rate: f64,
    ) -> f64 {
        let gearbox = &self.parameters.gearbox;
        if gearbox.is_rigid() {
            return 0.0;
        }
        match self.mesh(wind_up_rad) {
            (Mesh::Free, _) => 0.0,
            (Mesh::Touching, offset) => {
                let rate = motor_rate / gearbox.ratio + platform_rate - hub_rate;
                gearbox.stiffness_nm_rad * wind_up_rad + gearbox.damping_nm_s_rad * rate + offset
            }
        }
    }

    /// Returns the torque that the transmission passes to the hub at rest, N m, with its kinematic error, at a wind-up and a position of
    /// the hub on the platform.
    pub fn transmitted_torque_at_rest_nm(&self, wind_up_rad: f64, position_rad: f64) -> f64 {
        let spring_nm = self.mesh_torque_nm(wind_up_rad, 0.0, 0.0, 0.0);
        let motor_angle_rad = self.parameters.gearbox.ratio * (wind_up_rad + position_rad);
        spring_nm + self.kinematic_error_nm(spring_nm, motor_angle_rad, 0.0).hub_nm
    }

    /// Returns the smooth torques on the motor shaft beside those of the core: cogging, torque ripple, current limit, drag, N m.
    pub fn motor_torque_nm(&self, current_a: f64, motor_angle_rad: f64, motor_rate_rad_s: f64) -> f64 {
        let motor = &self.parameters.motor;
        let limit = self.parameters.amplifier.current_limit_a;
        let limited = current_a.clamp(-limit, limit);
        let constant = motor.torque_constant_nm_a;
        constant * (limited * (1.0 + motor.torque_ripple.at(motor_angle_rad)) - current_a)
            + motor.cogging.at(motor_angle_rad)
            - self.parameters.motor_friction.drag_nm(motor_rate_rad_s)
    }

    /// Returns the torque on the hub, N m, of a platform that turns about its forward axis (the first rate) and its upward one (the second):
    ///
    /// ```text
    ///     T = -J' (P cos + R sin) (R cos - P sin)
    /// ```
    ///
    /// J' is the inertia about the normal of the beam less that about the beam. That of a slender beam is its inertia about the pivot, without the
    /// rotor of a rigid transmission. A linear axis has none.
    #[inline]
    pub fn gyroscopic_torque_nm(&self, hub: SinCos, [roll, yaw]: [f64; 2]) -> f64 {
        if self.parameters.axis == crate::AxisKind::Linear {
            return 0.0;
        }
        let slender = self.body.inertia_kg_m2 - self.parameters.reflected_inertia_kg_m2();
        -slender * (roll * hub.cos + yaw * hub.sin) * (yaw * hub.cos - roll * hub.sin)
    }

    /// Returns the smooth torques on the hub beside those of the core: spring, mesh ripple, drag, N m.
    pub fn hub_torque_nm(
        &self,
        relative_angle_rad: f64,
        motor_angle_rad: f64,
        relative_rate_rad_s: f64,
    ) -> f64 {
        self.spring_torque_nm(relative_angle_rad) + self.parameters.gearbox.mesh_ripple.at(motor_angle_rad)
            - self.parameters.pivot_friction.drag_nm(relative_rate_rad_s)
    }
}

impl Plant {
    /// Returns the slopes of [`Plant::motor_torque_nm`] over current, motor angle and motor rate; beyond the limit of the current it does
    /// not follow the current.
    pub fn motor_torque_slopes(
        &self,
        current_a: f64,
        motor_angle_rad: f64,
        motor_rate_rad_s: f64,
    ) -> [f64; 3] {
        let motor = &self.parameters.motor;
        let limit = self.parameters.amplifier.current_limit_a;
        let limited = current_a.clamp(-limit, limit);
        let follows =
            if current_a.abs() <= limit { 1.0 + motor.torque_ripple.at(motor_angle_rad) } else { 0.0 };
        let constant = motor.torque_constant_nm_a;
        [
            constant * (follows - 1.0),
            constant * limited * motor.torque_ripple.slope_at(motor_angle_rad)
                + motor.cogging.slope_at(motor_angle_rad),
            -self.parameters.motor_friction.drag_slope_nm_s_rad(motor_rate_rad_s),
        ]
    }

    /// Returns the slopes of [`Plant::hub_torque_nm`] over the relative hub angle, the motor angle and the relative hub rate.
    pub fn hub_torque_slopes(&self, motor_angle_rad: f64, relative_rate_rad_s: f64) -> [f64; 3] {
        [
            -self.spring.0,
            self.parameters.gearbox.mesh_ripple.slope_at(motor_angle_rad),
            -self.parameters.pivot_friction.drag_slope_nm_s_rad(relative_rate_rad_s),
        ]
    }
}

/// Sine and cosine of the hub's angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SinCos {
    /// Sine.
    pub sin: f64,
    /// Cosine.
    pub cos: f64,
}

impl SinCos {
    /// Returns sine and cosine of an angle in radians.
    pub fn of(angle_rad: f64) -> Self {
        let (sin, cos) = angle_rad.sin_cos();
        Self { sin, cos }
    }
}

impl Plant {
    /// Returns the mesh's loss: the driven side receives eta T_2. While the motor drives (T_2 w_m > 0) the hub lacks
    /// (1 - eta) T_2; while the hub drives the motor lacks (1 - eta) T_2 / N. The share changes over smoothly within
    /// a motor rate of 0.05 rad/s.
    pub fn mesh_loss_nm(&self, mesh_torque_nm: f64, motor_rate_rad_s: f64) -> MeshLoss {
        let lost = (1.0 - self.parameters.gearbox.mesh_efficiency) * mesh_torque_nm;
        if lost == 0.0 {
            return MeshLoss::default();
        }
        let sense = motor_rate_rad_s / motor_rate_rad_s.hypot(POWER_REVERSAL_RATE) * mesh_torque_nm.signum();
        MeshLoss {
            motor_nm: 0.5 * (1.0 - sense) * lost / self.parameters.gearbox.ratio,
            hub_nm: -0.5 * (1.0 + sense) * lost,
        }
    }
}

impl Plant {
    /// Returns what the transmission's kinematic error e(theta_m) adds at either side, with the torque T_2 that the mesh passes
    /// without it: the mesh stretches by e, so it passes K e + D e' w_m more, and all of it works on the motor by e' as well.
    pub fn kinematic_error_nm(
        &self,
        mesh_torque_nm: f64,
        motor_angle_rad: f64,
        motor_rate_rad_s: f64,
    ) -> MeshLoss {
        let gearbox = &self.parameters.gearbox;
        if gearbox.kinematic_error.amplitude == 0.0 {
            return MeshLoss::default();
        }
        let slope = gearbox.kinematic_error.slope_at(motor_angle_rad);
        let added = gearbox.stiffness_nm_rad * gearbox.kinematic_error.at(motor_angle_rad)
            + gearbox.damping_nm_s_rad * slope * motor_rate_rad_s;
        MeshLoss { motor_nm: -added / gearbox.ratio - (mesh_torque_nm + added) * slope, hub_nm: added }
    }
}

/// dx = A x + B u.
fn multiply(core: &Core, x: &[f64], u: &[f64], dx: &mut [f64]) {
    let n = core.A.nrows();
    for i in 0..n {
        let free: f64 = (0..n).map(|j| core.A[(i, j)] * x[j]).sum();
        let forced: f64 = (0..u.len()).map(|j| core.B[(i, j)] * u[j]).sum();
        dx[i] = free + forced;
    }
}

/// Dry friction of a joint.
struct DryPart {
    torque_nm: f64,
    /// Derivative of its state.
    slope: f64,
}

/// Returns dry friction at a rate and a level, from its state.
fn dry_part(friction: &FrictionModel, rate: f64, level: f64, z: f64) -> DryPart {
    if friction.states() > 1 {
        return DryPart { torque_nm: friction.law().steady_torque(rate, level), slope: 0.0 };
    }
    let mut slope = [0.0];
    friction.derivative(rate, level, &[z], &mut slope);
    DryPart { torque_nm: friction.dry_torque(rate, level, &[z]), slope: slope[0] }
}
