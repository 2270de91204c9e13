//! The loop with its describing functions at a predicted limit cycle, as plain data.

use counterpoise_controller::{COMMON_READINGS, READING_NAMES};
use counterpoise_verify::certificate::CycleBalance;
use counterpoise_verify::certificate::balance::{HubOutput, JointBalance, MeshBalance};
use serde::Serialize;

use crate::exchange::SystemResult;

/// A loop in which every nonlinear part is its describing function, at an amplitude on one side of a predicted limit cycle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CycleBalanceResult {
    /// Amplitude of the hub's rate, rad/s.
    pub amplitude_rad_s: f64,
    /// Frequency for which the describing functions hold, Hz.
    pub frequency_hz: f64,
    /// Growth of the least stable pole, 1/s.
    pub growth_per_s: f64,
    /// Amplitude of the motor's motion over that of the hub.
    pub motor_over_hub: f64,
    /// Turns of the motor for one of the hub.
    pub gear_ratio: f64,
    /// Dry friction at motor and pivot.
    pub joints: Vec<JointFrictionResult>,
    /// The gear's gap.
    pub mesh: MeshResult,
    /// The friction observers, in the controller's order.
    pub observers: Vec<ObserverResult>,
    /// `mechanism_without_friction` (control, torques on motor shaft and hub), `mechanism` with the describing functions, `sampled_mechanism`
    /// and `controller`.
    pub systems: Vec<SystemResult>,
}

/// The describing function of a joint's dry friction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointFrictionResult {
    /// `motor` or `pivot`.
    pub joint: &'static str,
    /// Amplitude of the relative angle, rad.
    pub amplitude_rad: f64,
    /// Equivalent stiffness of the first harmonic, N m/rad.
    pub stiffness_nm_rad: f64,
    /// And damping, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// Coulomb level of a law of Dahl, N m; `None` for other laws.
    pub dahl_coulomb_nm: Option<f64>,
    /// Rest stiffness of a law of Dahl, N m/rad; `None` for other laws.
    pub dahl_stiffness_nm_rad: Option<f64>,
    /// Torque over a period of x = A sin(w t), N m, sample k = 1, 2, ... at w t = 2 pi k / count; absent unless time histories were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub torque_nm: Vec<f64>,
}

/// The describing function of the gear's gap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeshResult {
    /// Amplitude of the wind-up, rad.
    pub wind_up_rad: f64,
    /// Wind-up by which the teeth are pressed together, rad; negative inside the gap.
    pub pressed_rad: f64,
    /// The gap, rad; 0 if the teeth are taken as touching.
    pub gap_rad: f64,
    /// Share of the gear's stiffness and damping that acts.
    pub share: f64,
}

/// A friction observer as a linear path: volts = direct x rate + integral x the rate's integral.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ObserverResult {
    /// Volts per rate, V s/rad.
    pub direct_v_s_rad: f64,
    /// Volts per angle, V/rad.
    pub integral_v_rad: f64,
}

impl CycleBalanceResult {
    /// Leaves out the torques of a period.
    pub(super) fn leave_torques_out(&mut self) {
        self.joints.iter_mut().for_each(|joint| joint.torque_nm.clear());
    }
}

impl From<&CycleBalance> for CycleBalanceResult {
    fn from(at: &CycleBalance) -> Self {
        let torques = ["control_v", "motor_torque_nm", "hub_torque_nm"];
        let readings = &READING_NAMES[..COMMON_READINGS];
        let hub = match at.hub_output {
            HubOutput::Rate => "hub_rate_rad_s",
            HubOutput::Position => "hub_rad",
            HubOutput::Effort => "effort",
        };
        let felt = [hub, "tip", "motor_rate_rad_s", "current_a"];
        let observer = |gain: &counterpoise_verify::certificate::elements::ObserverGain| ObserverResult {
            direct_v_s_rad: gain.direct,
            integral_v_rad: gain.integral,
        };
        Self {
            amplitude_rad_s: at.rate_rad_s,
            frequency_hz: at.frequency_rad_s / std::f64::consts::TAU,
            growth_per_s: at.growth_per_s,
            motor_over_hub: at.motor_over_hub,
            gear_ratio: at.gear_ratio,
            joints: vec![joint("motor", &at.motor), joint("pivot", &at.pivot)],
            mesh: MeshResult::from(&at.mesh),
            observers: at.observers.iter().map(observer).collect(),
            systems: vec![
                SystemResult::new("mechanism_without_friction", &at.without_friction, &torques, &felt),
                SystemResult::new("mechanism", &at.mechanism, &torques[..1], &felt),
                SystemResult::new("sampled_mechanism", &at.sampled, &torques[..1], readings),
                SystemResult::new("controller", &at.controller, readings, &torques[..1]),
            ],
        }
    }
}

fn joint(name: &'static str, of: &JointBalance) -> JointFrictionResult {
    JointFrictionResult {
        joint: name,
        amplitude_rad: of.amplitude_rad,
        stiffness_nm_rad: of.impedance.stiffness,
        damping_nm_s_rad: of.impedance.damping,
        dahl_coulomb_nm: of.dahl.map(|law| law[0]),
        dahl_stiffness_nm_rad: of.dahl.map(|law| law[1]),
        torque_nm: of.torque_nm.clone(),
    }
}

impl From<&MeshBalance> for MeshResult {
    fn from(of: &MeshBalance) -> Self {
        let MeshBalance { wind_up_rad, pressed_rad, gap_rad, share } = *of;
        Self { wind_up_rad, pressed_rad, gap_rad, share }
    }
}
