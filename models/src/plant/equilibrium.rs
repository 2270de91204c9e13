//! The operating point: what the motor must do to hold the out-of-balance.

use super::core::state;
use super::mesh_loss::MeshLoss;
use super::{Mesh, Plant};
use crate::parameters::AmplifierDynamics;
use crate::tolerance::KINEMATIC_ITERATIONS;

/// Operating point at which the mechanism is held.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OperatingPoint {
    /// Hub angle, rad, inertial.
    pub hub_angle_rad: f64,
    /// Platform angle, rad, inertial.
    pub platform_angle_rad: f64,
}

/// The mechanism at rest, friction without load: the motor alone holds weight and spring.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The operating point.
    pub point: OperatingPoint,
    /// Control that holds it, V: the smallest one in size; the input limit if none suffices.
    pub control_v: f64,
    /// Drive of the linear amplifier that holds it, V.
    pub drive_v: f64,
    /// Armature current, A.
    pub current_a: f64,
    /// Gear torque at the output, N m.
    pub mesh_torque_nm: f64,
    /// The contact of the teeth: they touch unless no torque passes and there is a gap.
    pub mesh: Mesh,
    /// Motor angle relative to the platform, rad.
    pub motor_angle_rad: f64,
    /// The states of the linear core ([`state`]).
    pub core_state: Vec<f64>,
}

impl Plant {
    /// Returns the equilibrium under added torques at the motor and at the hub.
    pub(super) fn equilibrium_under(&self, point: &OperatingPoint, added: MeshLoss) -> Equilibrium {
        let (gearbox, motor) = (&self.parameters.gearbox, &self.parameters.motor);
        let relative = point.hub_angle_rad - point.platform_angle_rad;
        let held = self.held_torque_nm(point) - added.hub_nm;
        let wind_up = held / gearbox.stiffness_nm_rad + half_gap(held, gearbox.backlash_rad);
        let motor_angle = gearbox.ratio * (wind_up + relative);
        let mesh_torque = held - gearbox.mesh_ripple.at(motor_angle);
        let error = self.error_at_rest(held, motor_angle);
        let motor_angle = motor_angle - gearbox.ratio * error;
        let turned = gearbox.kinematic_error.slope_at(motor_angle);
        let shaft = mesh_torque / gearbox.ratio + mesh_torque * turned
            - motor.cogging.at(motor_angle)
            - added.motor_nm;
        let current = shaft / (motor.torque_constant_nm_a * (1.0 + motor.torque_ripple.at(motor_angle)));
        let amplifier = &self.parameters.amplifier;
        let drive = match amplifier.dynamics {
            AmplifierDynamics::Modelled | AmplifierDynamics::IdealCurrent => {
                current * (motor.resistance_ohm / amplifier.gain + amplifier.current_feedback_v_a)
            }
            _ => current / amplifier.gain,
        };
        let mut core_state = self.held_shape(point, held + added.hub_nm);
        core_state[state::VOLTAGE] = match amplifier.dynamics {
            AmplifierDynamics::Modelled if self.has_state(state::VOLTAGE) => motor.resistance_ohm * current,
            _ => 0.0,
        };
        core_state[state::CURRENT] = if self.has_state(state::CURRENT) { current } else { 0.0 };
        core_state[state::WINDUP] =
            mesh_torque / gearbox.stiffness_nm_rad + half_gap(mesh_torque, gearbox.backlash_rad) - error;
        Equilibrium {
            point: *point,
            control_v: amplifier.control_v(drive, motor),
            drive_v: drive,
            current_a: current,
            mesh_torque_nm: mesh_torque,
            mesh: if mesh_torque == 0.0 && gearbox.backlash_rad > 0.0 { Mesh::Free } else { Mesh::Touching },
            motor_angle_rad: gearbox.ratio * (core_state[state::WINDUP] + relative),
            core_state,
        }
    }

    /// Returns the kinematic error e at rest, by iteration on theta_m = N (delta + theta_h - theta_p) with delta = delta_0 - e; `angle`
    /// is theta_m at delta_0.
    fn error_at_rest(&self, held_nm: f64, angle_rad: f64) -> f64 {
        let gearbox = &self.parameters.gearbox;
        if gearbox.kinematic_error.amplitude == 0.0 || held_nm.is_nan() {
            return 0.0;
        }
        (0..KINEMATIC_ITERATIONS).fold(0.0, |e, _| gearbox.kinematic_error.at(angle_rad - gearbox.ratio * e))
    }

    /// Returns the torque that the gear must pass for the hub to rest.
    fn held_torque_nm(&self, point: &OperatingPoint) -> f64 {
        let (sin, cos) = self.tilt(point.hub_angle_rad);
        let gravity = self.parameters.gravity_m_s2;
        let weight = self.body.out_of_balance_kg_m * cos - self.body.vertical_offset_kg_m * sin;
        gravity * weight - self.support_torque_nm(point.hub_angle_rad - point.platform_angle_rad)
    }

    /// Returns the angle and the modes of the structure under its weight, held at the hub by `held` less the spring.
    fn held_shape(&self, point: &OperatingPoint, held: f64) -> Vec<f64> {
        let (sin, cos) = self.tilt(point.hub_angle_rad);
        let gravity = self.parameters.gravity_m_s2;
        let relative = point.hub_angle_rad - point.platform_angle_rad;
        let lift = gravity * self.body.vertical_offset_kg_m * sin;
        let hub_torque = held + self.support_torque_nm(relative) + lift;
        let mut shape = vec![0.0; self.core_order()];
        let mut rigid = point.hub_angle_rad;
        for (k, mode) in self.body.modes.iter().enumerate() {
            let forced = mode.hub_shape * hub_torque - mode.load_share_kg_m * gravity * cos;
            let q = forced / mode.frequency_rad_s.powi(2);
            shape[state::MODES + 2 * k] = q;
            rigid -= mode.hub_shape * q;
        }
        shape[state::ANGLE] = rigid;
        shape
    }
}

/// Half of the gap, on the side on which a torque presses.
fn half_gap(torque_nm: f64, backlash_rad: f64) -> f64 {
    if torque_nm == 0.0 { 0.0 } else { 0.5 * backlash_rad * torque_nm.signum() }
}
