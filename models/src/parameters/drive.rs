//! The drive: gearbox, motor and amplifier.

use super::Ripple;

/// Transmission between motor and hub; every kind has the same parameters, some of them 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Transmission {
    /// Nothing: the motor sits on the hub's axis.
    #[default]
    Direct,
    /// A gearbox.
    Gearbox,
    /// A toothed belt.
    Belt,
    /// A harmonic drive.
    HarmonicDrive,
    /// A cable.
    Cable,
    /// A ball screw: its ratio is 2 pi over the lead.
    BallScrew {
        /// Travel a turn, m.
        lead_m: f64,
    },
}

/// Transmission between motor and hub; stiffness, damping and backlash at the output.
#[derive(Debug, Clone, PartialEq)]
pub struct Gearbox {
    /// Kind.
    pub kind: Transmission,
    /// Motor turns per hub turn.
    pub ratio: f64,
    /// Mesh stiffness, N m/rad; infinite if the transmission is rigid.
    pub stiffness_nm_rad: f64,
    /// Mesh damping, N m s/rad, only while the teeth touch.
    pub damping_nm_s_rad: f64,
    /// Total gap, rad.
    pub backlash_rad: f64,
    /// Torque on the hub that repeats with the motor angle, N m (amplitude 0: none).
    pub mesh_ripple: Ripple,
    /// Fraction of the mesh torque that reaches the other side while it drives; 1 is ideal.
    pub mesh_efficiency: f64,
    /// Error of the output angle that repeats with the motor angle, rad: a harmonic drive's has two periods a turn of its
    /// wave generator. The mesh stretches by it, and by virtual work it also turns mesh torque into motor torque.
    pub kinematic_error: Ripple,
    /// Largest torque of the compliance's hysteresis, N m at the output; 0 if there is none.
    pub hysteresis_nm: f64,
    /// Stiffness of that hysteresis when it springs back, N m/rad, beside the mesh stiffness.
    pub hysteresis_stiffness_nm_rad: f64,
}

impl Gearbox {
    /// A rigid connection of motor and hub, one turn to one.
    pub const DIRECT: Self = Self {
        kind: Transmission::Direct,
        ratio: 1.0,
        stiffness_nm_rad: f64::INFINITY,
        damping_nm_s_rad: 0.0,
        backlash_rad: 0.0,
        mesh_ripple: Ripple::NONE,
        mesh_efficiency: 1.0,
        kinematic_error: Ripple::NONE,
        hysteresis_nm: 0.0,
        hysteresis_stiffness_nm_rad: 0.0,
    };

    /// Returns whether motor and hub turn as one body.
    pub fn is_rigid(&self) -> bool {
        self.stiffness_nm_rad == f64::INFINITY
    }
}

/// Motor with its electrical circuit.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Inertia of rotor and gearbox input, kg m^2; 0 is allowed if the transmission is rigid.
    pub inertia_kg_m2: f64,
    /// Torque constant, N m/A.
    pub torque_constant_nm_a: f64,
    /// Back-EMF constant, V s/rad.
    pub back_emf_v_s_rad: f64,
    /// Resistance, ohm.
    pub resistance_ohm: f64,
    /// Inductance, H; 0 if the current follows the voltage at once.
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
    /// Time constant, s; 0 if the voltage follows the input at once.
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
    /// Dynamics between its input and the motor's current.
    pub dynamics: AmplifierDynamics,
}

/// Dynamics between an amplifier's input and the motor's current.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum AmplifierDynamics {
    /// The amplifier's lag, both feedbacks, the armature and its back-EMF.
    #[default]
    Modelled,
    /// An ideal current source: i = (static gain of the closed amplifier loop) x (input after limit, dead zone and map), whatever
    /// the motor's speed. It follows its input within [`IDEAL_LAG_S`].
    IdealCurrent,
    /// A current loop: the current follows gain x input with a first-order lag, whatever the motor's speed.
    CurrentLoop {
        /// Rate at which the lag has taken 3 dB, rad/s.
        bandwidth_rad_s: f64,
        /// Delay of its command, s; part of the interface's whole samples of delay, and kept here for the file.
        delay_s: f64,
    },
    /// A current that is gain x input at once, without a state: the drive takes a torque.
    TorqueCommand,
    /// The same of a drive that takes a current, whose file states its limit as one.
    CurrentCommand,
}

impl AmplifierDynamics {
    /// Returns whether the current is what is commanded, at once and without a state.
    pub fn is_command(self) -> bool {
        matches!(self, Self::TorqueCommand | Self::CurrentCommand)
    }
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
