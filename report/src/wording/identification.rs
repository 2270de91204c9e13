//! The identified values, with their notes in sentences.

use counterpoise_diagnose::identification::{
    BalanceState, BalanceUnknown, Estimate, FrictionPicture, GainCurveObstacle, GainPoint, Identification,
    IdentifiedAmplifier, Lobes, NormalEquations, Note, SensorErrors,
};
use counterpoise_pipeline::recordings::identify::IdentifiedRecordings;
use serde::Serialize;

use super::recordings::describe_column_remark;

/// Everything that was identified, with its notes in sentences.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IdentificationText {
    /// One for each state of balance, in the order given.
    pub balances: Vec<BalanceState>,
    /// Coulomb friction, pivot + N x motor, N m.
    pub coulomb_nm: Estimate,
    /// Viscous friction, pivot + N^2 x motor, N m s/rad.
    pub viscous_nm_s_rad: Estimate,
    /// Highest friction torque after a reversal, mean over the reversals, N m; `None` if there are too few.
    pub breakaway_nm: Option<Estimate>,
    /// Amplifier.
    pub amplifier: AmplifierText,
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
    pub notes: Vec<String>,
    /// Errors of the sensors; absent if the recordings show none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensors: Option<SensorErrors>,
    /// The least squares from which the values and their intervals follow.
    pub regression: RegressionText,
}

/// A least squares, its unknowns named by the places of their values in the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegressionText {
    /// The unknowns, in the order of the equations.
    pub unknowns: Vec<String>,
    /// The sums over all rows.
    #[serde(flatten)]
    pub equations: NormalEquations,
}

impl IdentificationText {
    /// Returns the errors of the sensors that were identified, each with its name and unit.
    pub fn sensor_errors(&self) -> Vec<(&'static str, Estimate, &'static str)> {
        let SensorErrors { lever_arm_m, roll_misalignment_rad, yaw_misalignment_rad } =
            self.sensors.unwrap_or_default();
        let named = [
            ("lever arm of accelerometer", lever_arm_m, "m"),
            ("gyroscopes apart, roll", roll_misalignment_rad, "rad"),
            ("gyroscopes apart, yaw", yaw_misalignment_rad, "rad"),
        ];
        named.into_iter().filter_map(|(name, estimate, unit)| Some((name, estimate?, unit))).collect()
    }
}

/// Result of the identification of the amplifier, in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "outcome", rename_all = "snake_case")]
pub enum AmplifierText {
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
        /// Why not, and what would.
        why: &'static str,
    },
}

impl AmplifierText {
    /// Returns the points of the curve; none if it is not identifiable.
    pub fn points(&self) -> &[GainPoint] {
        match self {
            Self::Curve { points } | Self::AsInProject { points } => points,
            Self::NotIdentifiable { .. } => &[],
        }
    }
}

/// Describes what was identified from files: what was found on reading them comes last among the notes.
pub fn describe_identified_recordings(found: &IdentifiedRecordings) -> IdentificationText {
    let mut described = describe_identification(&found.identified);
    for (file, remarks) in &found.remarks {
        described
            .notes
            .extend(remarks.iter().map(|remark| format!("{file}: {}", describe_column_remark(remark))));
    }
    described
}

/// Describes what was identified.
pub fn describe_identification(found: &Identification) -> IdentificationText {
    IdentificationText {
        balances: found.balances.clone(),
        coulomb_nm: found.coulomb_nm,
        viscous_nm_s_rad: found.viscous_nm_s_rad,
        breakaway_nm: found.breakaway_nm,
        amplifier: describe_amplifier(&found.amplifier),
        lobes: found.lobes,
        loops: found.loops.clone(),
        residual_nm: found.residual_nm,
        noise_share: found.noise_share,
        sliding_s: found.sliding_s,
        notes: found.notes.iter().map(|note| describe_note(*note)).collect(),
        sensors: Some(found.sensors).filter(|errors| !errors.is_empty()),
        regression: RegressionText {
            unknowns: found.regression.unknowns.iter().map(|unknown| place_of_unknown(*unknown)).collect(),
            equations: found.regression.equations.clone(),
        },
    }
}

/// Returns the place in the result of the value of an unknown; of a change, in words.
fn place_of_unknown(unknown: BalanceUnknown) -> String {
    match unknown {
        BalanceUnknown::OutOfBalance(state) => format!("balances[{state}].out_of_balance_kg_m"),
        BalanceUnknown::Inertia(state) => format!("balances[{state}].inertia_kg_m2"),
        BalanceUnknown::Coulomb => "coulomb_nm".to_owned(),
        BalanceUnknown::Viscous => "viscous_nm_s_rad".to_owned(),
        BalanceUnknown::AmplifierCurve(input_v) => {
            format!("change of the current over the project's gain, V, at an input of {input_v} V")
        }
        BalanceUnknown::LeverArm => "change of sensors.lever_arm_m".to_owned(),
    }
}

fn describe_amplifier(amplifier: &IdentifiedAmplifier) -> AmplifierText {
    match amplifier {
        IdentifiedAmplifier::Curve { points } => AmplifierText::Curve { points: points.clone() },
        IdentifiedAmplifier::AsInProject { points } => AmplifierText::AsInProject { points: points.clone() },
        IdentifiedAmplifier::NotIdentifiable { reason } => {
            let why = match reason {
                GainCurveObstacle::ControlStaysLarge => {
                    "the control stays where the amplifier is taken as linear; recordings near balance take it through small values"
                }
                GainCurveObstacle::ConfusedWithFriction => {
                    "the curve cannot be distinguished from friction here; recordings at another out-of-balance can"
                }
                GainCurveObstacle::TooUncertain => {
                    "the curve cannot be distinguished from friction to 15 % here; recordings at another out-of-balance can"
                }
            };
            AmplifierText::NotIdentifiable { why }
        }
    }
}

fn describe_note(note: Note) -> String {
    match note {
        Note::FrictionIsASum => {
            "friction is the sum of pivot and motor, at the hub: one state of the rig does not separate them"
                .to_owned()
        }
        Note::KnownTakenAsExact => {
            "the intervals take gear ratio, motor constants and sensor lags as exact".to_owned()
        }
        Note::SomethingElseActs { share } => format!(
            "the torque balance leaves {:.0} % of the Coulomb friction: something else acts, `diagnose` looks for it",
            100.0 * share
        ),
        Note::NoMotorRate => {
            "no motor rate: it is the hub's on the platform and the gear's twist, with the project's gear stiffness"
                .to_owned()
        }
        Note::NoHubPosition => {
            "no hub position: the angle is the integral of the rates from level".to_owned()
        }
        Note::RigidBeam => "no lumped structure in the project: the beam is taken as rigid".to_owned(),
        Note::TransmissionNotLinear => {
            "the transmission's hysteresis and kinematic error are no part of the balance: they bend the values by more than the intervals say; `diagnose` knows them".to_owned()
        }
        Note::NoWeight => {
            "neither gravity nor heave acts on this axis, so that the out-of-balance makes no torque and is not identified".to_owned()
        }
        Note::NegativeViscous => {
            "viscous friction would be below zero, which no joint has: it is held at the project's. Causes are a motion at nearly one speed (move at several), friction that falls with speed, or a lag of drive or sensor that differs from the project's".to_owned()
        }
        Note::CurveFromOneState => {
            "the gain curve comes from one state of balance: recordings at a second one would distinguish it from friction with certainty"
                .to_owned()
        }
    }
}
