//! The balance of weight and drive at the operating point, as plain data: how the holding control is found.

use counterpoise_models::parameters::cylinder::LAMINAR_SHARE;
use counterpoise_models::parameters::{AmplifierDynamics, Parameters};
use counterpoise_models::plant::LinearPlant;
use counterpoise_models::plant::Plant;
use serde::Serialize;

/// The balance of weight and drive. The gear passes gravity x (out-of-balance cos - offset sin) less spring and ripple; the current is that
/// torque at the motor, less cogging, over the torque constant; the drive is the current times `drive_v_per_a`; the control is the smallest
/// one whose drive that is. With a cylinder the current stands for the load pressure p, MPa, the torque constant for the piston's area, and
/// the drive, V, is the opening over the valve's gain, the opening that which passes what leaks at p (see [`ValveBalance`]).
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
    /// Torque at the motor for 1 N m that the gear passes; force of the piston for 1 N m at the hub.
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
    /// The valve of a cylinder; `None` with a motor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valve: Option<ValveBalance>,
    /// `true` if free functions of a diagnosis add torques, which are not part of this balance.
    pub has_free_functions: bool,
}

/// The valve of a cylinder at rest: with the load pressure p it is opened, for p > 0, by
///
/// ```text
///     o = C p / root(1 - p/p_s) + o_0        root(x) = x / sqrt(max(|x|, laminar share))
/// ```
///
/// and the drive is o over the gain; openings are counted as the flow that the valve would pass without load and overlap, L/s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ValveBalance {
    /// Leakage C between both sides, L/s/MPa.
    pub leakage_l_s_mpa: f64,
    /// Supply pressure less that of the tank p_s, MPa.
    pub supply_mpa: f64,
    /// Share of the supply pressure below which the flow is proportional to the pressure drop.
    pub laminar_share: f64,
    /// Overlap o_0, L/s.
    pub overlap_l_s: f64,
    /// Opening for a drive, L/s/V.
    pub gain_l_s_v: f64,
}

impl ValveBalance {
    fn of(parameters: &Parameters) -> Option<Self> {
        let cylinder = parameters.cylinder.as_ref()?;
        Some(Self {
            leakage_l_s_mpa: parameters.motor.resistance_ohm,
            supply_mpa: cylinder.supply_mpa,
            laminar_share: LAMINAR_SHARE,
            overlap_l_s: cylinder.overlap_l_s,
            gain_l_s_v: parameters.amplifier.gain,
        })
    }
}

impl BalanceResult {
    /// Returns the balance of a plant where it was linearised.
    pub fn of(plant: &Plant, linear: &LinearPlant) -> Self {
        let at = &linear.equilibrium;
        let (parameters, point) = (plant.parameters(), &at.point);
        let (gearbox, motor, amplifier) = (&parameters.gearbox, &parameters.motor, &parameters.amplifier);
        let (sin, cos) = plant.tilt(point.hub_angle_rad);
        let stall = amplifier.stall_gain_a_v(motor);
        let lever = plant.lever_at(point.hub_angle_rad - point.platform_angle_rad);
        let arm = lever.map_or(gearbox.ratio, |it| it.arm_m);
        Self {
            gravity_m_s2: parameters.gravity_m_s2,
            tilt: [cos, sin],
            vertical_offset_kg_m: plant.body().vertical_offset_kg_m,
            spring_nm: plant.support_torque_nm(point.hub_angle_rad - point.platform_angle_rad),
            mesh_ripple_nm: gearbox.mesh_ripple.at(at.motor_angle_rad),
            motor_share: 1.0 / arm + gearbox.kinematic_error.slope_at(at.motor_angle_rad),
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
            valve: ValveBalance::of(parameters),
            has_free_functions: plant.learned_functions().is_some(),
        }
    }
}
