//! The drive: gearbox, motor and amplifier.

use super::Ripple;

/// Gearbox between motor and hub; stiffness, damping and backlash at the output.
#[derive(Debug, Clone, PartialEq)]
pub struct Gearbox {
    /// Motor turns per hub turn.
    pub ratio: f64,
    /// Mesh stiffness, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Mesh damping, N m s/rad, only while the teeth touch.
    pub damping_nm_s_rad: f64,
    /// Total gap, rad.
    pub backlash_rad: f64,
    /// Torque on the hub that repeats with the motor angle, N m (amplitude 0: none).
    pub mesh_ripple: Ripple,
    /// Fraction of the mesh torque that reaches the other side while it drives; 1 is ideal.
    pub mesh_efficiency: f64,
}

/// Motor with its electrical circuit.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Inertia of rotor and gearbox input, kg m^2.
    pub inertia_kg_m2: f64,
    /// Torque constant, N m/A.
    pub torque_constant_nm_a: f64,
    /// Back-EMF constant, V s/rad.
    pub back_emf_v_s_rad: f64,
    /// Resistance, ohm.
    pub resistance_ohm: f64,
    /// Inductance, H.
    pub inductance_h: f64,
    /// Torque on the shaft that repeats with the motor angle and does not need current, N m.
    pub cogging: Ripple,
    /// Variation of the torque constant with the motor angle, as a fraction.
    pub torque_ripple: Ripple,
    /// Sense of the rotor's inertial coupling to the platform: J_m (theta_m'' + s theta_p''). 0, +1 or -1.
    pub platform_coupling: f64,
}

/// Amplifier with voltage and current feedback.
#[derive(Debug, Clone, PartialEq)]
pub struct Amplifier {
    /// Voltage gain, V/V.
    pub gain: f64,
    /// Current feedback, V/A.
    pub current_feedback_v_a: f64,
    /// Time constant, s.
    pub time_constant_s: f64,
    /// Input is clipped to +/- this, V.
    pub input_limit_v: f64,
    /// Output is clipped to +/- this, V.
    pub bus_voltage_v: f64,
    /// Measured static map from input voltage to stalled current, odd, by its points with v > 0; empty: linear.
    pub map: Vec<MapPoint>,
    /// Half width of a dead zone at the input, V.
    pub dead_zone_v: f64,
    /// Current is clipped to +/- this, A; infinite if there is no limit.
    pub current_limit_a: f64,
    /// What lies between its input and the motor's current.
    pub dynamics: AmplifierDynamics,
}

/// What lies between an amplifier's input and the motor's current.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AmplifierDynamics {
    /// The amplifier's lag, both feedbacks, the armature and its back-EMF.
    #[default]
    Modelled,
    /// An ideal current source: i = (static gain of the closed amplifier loop) x (input after limit, dead zone and map), whatever
    /// the motor's speed. It follows its input within [`IDEAL_LAG_S`].
    IdealCurrent,
}

/// Time constant with which an ideal current source follows its input, s: a hundredth of the shortest sample period in use.
pub const IDEAL_LAG_S: f64 = 1e-5;

/// A point of the amplifier's measured map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPoint {
    /// Input voltage, V.
    pub input_v: f64,
    /// Stalled current, A.
    pub current_a: f64,
}
