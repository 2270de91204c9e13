//! The identified values: plain data.

use serde::Serialize;

use super::regression::NormalEquations;

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The value; NaN (null in JSON) if nothing in the recordings depends on it.
    pub value: f64,
    /// 95 % interval: Newey and West's, Student's quantile.
    pub ci95: [f64; 2],
    /// Value in the project; NaN (null in JSON) if it has none.
    pub before: f64,
}

impl Estimate {
    /// Returns half the width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.ci95[1] - self.ci95[0])
    }
}

/// The mechanism in one state of balance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BalanceState {
    /// First moment of mass about the pivot, kg m, positive nose-heavy.
    pub out_of_balance_kg_m: Estimate,
    /// Moment of inertia about the pivot without the rotor's, kg m^2.
    pub inertia_kg_m2: Estimate,
}

/// The picture of control against rate, of one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrictionPicture {
    /// Name of the recording.
    pub recording: String,
    /// Index of its state of balance.
    pub balance: usize,
    /// (hub rate rad/s, control V, control that the identified mechanism needs V), in time, all after the low-pass.
    pub points: Vec<[f64; 3]>,
}

/// The loop's lobes in volts, as one reads them from the picture; linear amplifier.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Lobes {
    /// Control that holds the out-of-balance of the first state, level, V.
    pub offset_v: f64,
    /// Step of the control where the rate changes sign: twice the Coulomb friction, V.
    pub step_v: f64,
    /// Slope of the lobes: viscous friction and back-EMF, V s/rad.
    pub slope_v_s_rad: f64,
    /// Width of the loop per acceleration: inertia of structure and rotor, twice, V s^2/rad.
    pub width_v_s2_rad: f64,
}

/// A point of the amplifier's gain curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GainPoint {
    /// Input, V.
    pub input_v: f64,
    /// Stalled current, A.
    pub current_a: f64,
    /// 95 % interval, A.
    pub ci95_a: [f64; 2],
    /// Current of the linear amplifier, A.
    pub linear_a: f64,
    /// RMS of the single readings near the input about the curve, A.
    pub scatter_a: f64,
}

/// Why the amplifier's gain curve cannot be identified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GainCurveObstacle {
    /// The control stays in the range in which the amplifier is taken as linear.
    ControlStaysLarge,
    /// The curve and friction cannot be told apart.
    ConfusedWithFriction,
    /// The curve and friction can be told apart, but not accurately enough.
    TooUncertain,
}

/// An unknown of the torque balance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BalanceUnknown {
    /// The out-of-balance of a state of balance.
    OutOfBalance(usize),
    /// The inertia of a state of balance.
    Inertia(usize),
    /// The Coulomb friction.
    Coulomb,
    /// The viscous friction.
    Viscous,
    /// What the stalled current at an input of the amplifier, V, exceeds that of the project by, over the project's gain.
    AmplifierCurve(f64),
    /// What the lever arm of the platform's accelerometer exceeds that of the project by.
    LeverArm,
}

/// The least squares that gave the identified values.
#[derive(Debug, Clone, PartialEq)]
pub struct BalanceRegression {
    /// The unknowns, in the order of the equations.
    pub unknowns: Vec<BalanceUnknown>,
    /// The sums over all rows.
    pub equations: NormalEquations,
}

/// Condition under which the identified values hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Note {
    /// Friction is the sum of pivot and motor.
    FrictionIsASum,
    /// The intervals take gear ratio, motor constants and sensor lags as exact.
    KnownTakenAsExact,
    /// The torque balance leaves more than noise.
    SomethingElseActs {
        /// The residual, as a share of the Coulomb friction.
        share: f64,
    },
    /// The motor's rate was not recorded.
    NoMotorRate,
    /// The hub's position was not recorded.
    NoHubPosition,
    /// The project has no lumped structure.
    RigidBeam,
    /// The gain curve comes from one state of balance.
    CurveFromOneState,
    /// The transmission's hysteresis or kinematic error is no part of the torque balance.
    TransmissionNotLinear,
    /// Viscous friction came out below zero, which no joint has, and was held at the project's.
    NegativeViscous,
    /// Neither gravity nor heave acts, so that the out-of-balance makes no torque.
    NoWeight,
}

/// Errors of the sensors that recordings on a moving base show; `None` for what they do not show.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct SensorErrors {
    /// Distance of the platform's accelerometer from the pivot, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lever_arm_m: Option<Estimate>,
    /// Sensitivity of the hub gyroscope to roll less that of the platform gyroscope, rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roll_misalignment_rad: Option<Estimate>,
    /// The same to yaw, rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yaw_misalignment_rad: Option<Estimate>,
}

impl SensorErrors {
    /// Returns whether the recordings show none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Result of the identification of the amplifier.
#[derive(Debug, Clone, PartialEq)]
pub enum IdentifiedAmplifier {
    /// The gain curve differs from the project's; the mechanism was identified together with it.
    Curve {
        /// The curve, by rising input.
        points: Vec<GainPoint>,
    },
    /// The gain curve was seen, and is the project's.
    AsInProject {
        /// The curve, by rising input.
        points: Vec<GainPoint>,
    },
    /// These recordings do not show it.
    NotIdentifiable {
        /// Why not.
        reason: GainCurveObstacle,
    },
}

/// Everything that was identified. All torques are at the output (hub) side.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// One for each state of balance, in the order given.
    pub balances: Vec<BalanceState>,
    /// Coulomb friction, pivot + N x motor, N m.
    pub coulomb_nm: Estimate,
    /// Viscous friction, pivot + N^2 x motor, N m s/rad.
    pub viscous_nm_s_rad: Estimate,
    /// Highest friction torque after a reversal, mean over the reversals, N m; `None` if there are too few. It contains backlash
    /// and bending that a reversal excites.
    pub breakaway_nm: Option<Estimate>,
    /// Amplifier.
    pub amplifier: IdentifiedAmplifier,
    /// The lobes in volts.
    pub lobes: Lobes,
    /// Control against rate, recording by recording.
    pub loops: Vec<FrictionPicture>,
    /// RMS torque that the balance leaves, N m.
    pub residual_nm: f64,
    /// Largest share of a regressor's power that is sensor noise; it was taken off.
    pub noise_share: f64,
    /// Time that entered, s.
    pub sliding_s: f64,
    /// Remarks that belong to the numbers.
    pub notes: Vec<Note>,
    /// Errors of the sensors.
    pub sensors: SensorErrors,
    /// The least squares behind the values.
    pub regression: BalanceRegression,
}

impl Estimate {
    /// Returns a value with the half width of its interval.
    pub fn new(value: f64, half_width: f64, before: f64) -> Self {
        Self { value, ci95: [value - half_width, value + half_width], before }
    }

    /// Returns whether the recordings determine the value.
    pub fn is_known(&self) -> bool {
        self.value.is_finite()
    }

    /// Returns whether the interval holds a value.
    pub fn holds(&self, value: f64) -> bool {
        self.ci95[0] <= value && value <= self.ci95[1]
    }
}

impl IdentifiedAmplifier {
    /// Returns the points of the curve; none if it is not identifiable.
    pub fn points(&self) -> &[GainPoint] {
        match self {
            Self::Curve { points } | Self::AsInProject { points } => points,
            Self::NotIdentifiable { .. } => &[],
        }
    }
}
