//! The balance of weight and drive at the operating point, as plain data: how the holding control is found.

use counterpoise_models::parameters::AmplifierDynamics;
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::plant::Plant;
use serde::Serialize;

/// The balance of weight and drive. The gear passes gravity x (out-of-balance cos - offset sin) less spring and ripple; the current is that
/// torque at the motor, less cogging, over the torque constant; the drive is the current times `drive_v_per_a`; the control is the smallest
/// one whose drive that is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BalanceResult {
    /// Gravity, m/s^2.
    pub gravity_m_s2: f64,
    /// Cosine and sine of the angle by which the axis is tilted; 1 and 0 for an axis that slides.
    pub tilt: [f64; 2],
    /// First moment of mass about the pivot across the beam, kg m.
    pub vertical_offset_kg_m: f64,
    /// Torque of spring, equilibrator and stops at the hub, N m.
    pub spring_nm: f64,
    /// Ripple of the gear's torque, N m.
    pub mesh_ripple_nm: f64,
    /// Torque at the motor for 1 N m that the gear passes.
    pub motor_share: f64,
    /// Cogging of the motor, N m.
    pub cogging_nm: f64,
    /// Torque constant where the motor stands, N m/A.
    pub torque_constant_nm_a: f64,
    /// Drive for a current, V/A.
    pub drive_v_per_a: f64,
    /// Dead zone of the amplifier, V.
    pub dead_zone_v: f64,
    /// Largest control that the amplifier takes, V.
    pub input_limit_v: f64,
    /// The amplifier's curve behind its dead zone: points (input, drive), V; beyond the last, or without points, its slope is 1.
    pub curve_v: Vec<[f64; 2]>,
    /// Whether free functions of a diagnosis add torques, which are not part of this balance.
    pub has_free_functions: bool,
}

impl BalanceResult {
    /// Returns the balance of a plant where it was linearised.
    pub fn of(plant: &Plant, linear: &LinearPlant) -> Self {
        let at = &linear.equilibrium;
        let (parameters, point) = (plant.parameters(), &at.point);
        let (gearbox, motor, amplifier) = (&parameters.gearbox, &parameters.motor, &parameters.amplifier);
        let (sin, cos) = plant.tilt(point.hub_angle_rad);
        let stall = amplifier.stall_gain_a_v(motor);
        Self {
            gravity_m_s2: parameters.gravity_m_s2,
            tilt: [cos, sin],
            vertical_offset_kg_m: plant.body().vertical_offset_kg_m,
            spring_nm: plant.support_torque_nm(point.hub_angle_rad - point.platform_angle_rad),
            mesh_ripple_nm: gearbox.mesh_ripple.at(at.motor_angle_rad),
            motor_share: 1.0 / gearbox.ratio + gearbox.kinematic_error.slope_at(at.motor_angle_rad),
            cogging_nm: motor.cogging.at(at.motor_angle_rad),
            torque_constant_nm_a: motor.torque_constant_nm_a
                * (1.0 + motor.torque_ripple.at(at.motor_angle_rad)),
            drive_v_per_a: match amplifier.dynamics {
                AmplifierDynamics::Modelled | AmplifierDynamics::IdealCurrent => {
                    motor.resistance_ohm / amplifier.gain + amplifier.current_feedback_v_a
                }
                _ => 1.0 / amplifier.gain,
            },
            dead_zone_v: amplifier.dead_zone_v,
            input_limit_v: amplifier.input_limit_v,
            curve_v: amplifier.map.iter().map(|point| [point.input_v, point.current_a / stall]).collect(),
            has_free_functions: plant.learned().is_some(),
        }
    }
}
