//! Project files to start from: seven kinds of machine, each by the few values that a data sheet states, and the questions that fill
//! them in.

use crate::file::{Attachments, Document, EditError, SettingValue};
use crate::resolve::Project;

/// A kind of machine to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StarterKind {
    /// A stabilised sight.
    Sight,
    /// A gun in elevation.
    Gun,
    /// An antenna in azimuth.
    Antenna,
    /// A joint of a robot.
    RobotJoint,
    /// A camera gimbal.
    Gimbal,
    /// A slide on a ball screw.
    LinearAxis,
    /// A pendulum on a motor's shaft.
    Pendulum,
}

/// A question about one value of a starting file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StarterQuestion {
    /// Path of the key that the answer fills in.
    pub path: &'static str,
    /// The question, with its mark.
    pub text: &'static str,
}

const fn ask(path: &'static str, text: &'static str) -> StarterQuestion {
    StarterQuestion { path, text }
}

const PERIOD: StarterQuestion =
    ask("plant.interface.sample_period", "How often does the controller run (sample period)?");
const TORQUE: StarterQuestion = ask("plant.drive.limit", "What is the largest torque of the motor?");
const NOISE: StarterQuestion = ask("plant.sensors.hub_gyro.noise", "What is the RMS noise of the gyroscope?");

/// Each kind with its name, its file, and its questions after that for the kind.
const KINDS: [(StarterKind, &str, &str, [StarterQuestion; 4]); 7] = [
    (
        StarterKind::Sight,
        "sight",
        include_str!("sight.toml"),
        [
            ask("plant.inertia", "What is the moment of inertia of the head?"),
            ask("plant.gearbox.ratio", "How many turns does the motor make for one turn of the head?"),
            TORQUE,
            PERIOD,
        ],
    ),
    (
        StarterKind::Gun,
        "gun",
        include_str!("gun.toml"),
        [
            ask("plant.lumped.hub_inertia", "What is the moment of inertia of the gun about its trunnions?"),
            ask("plant.lumped.out_of_balance", "What is its out-of-balance (mass times distance)?"),
            TORQUE,
            PERIOD,
        ],
    ),
    (
        StarterKind::Antenna,
        "antenna",
        include_str!("antenna.toml"),
        [
            ask("plant.inertia", "What is the moment of inertia of the antenna?"),
            ask("plant.belt.ratio", "How many turns does the motor make for one turn of the antenna?"),
            TORQUE,
            PERIOD,
        ],
    ),
    (
        StarterKind::RobotJoint,
        "robot-joint",
        include_str!("robot-joint.toml"),
        [
            ask("plant.inertia", "What is the moment of inertia of the arm about the joint?"),
            ask(
                "plant.harmonic_drive.ratio",
                "How many turns does the motor make for one turn of the joint?",
            ),
            ask("plant.drive.limit", "What is the largest current of the motor?"),
            PERIOD,
        ],
    ),
    (
        StarterKind::Gimbal,
        "gimbal",
        include_str!("gimbal.toml"),
        [ask("plant.inertia", "What is the moment of inertia of camera and frame?"), TORQUE, NOISE, PERIOD],
    ),
    (
        StarterKind::LinearAxis,
        "linear-axis",
        include_str!("linear-axis.toml"),
        [
            ask("plant.mass", "What is the mass of all that slides?"),
            ask("plant.ball_screw.lead", "How far does the slide travel for one turn of the motor?"),
            TORQUE,
            PERIOD,
        ],
    ),
    (
        StarterKind::Pendulum,
        "pendulum",
        include_str!("pendulum.toml"),
        [
            ask("plant.lumped.hub_inertia", "What is the moment of inertia of the arm about the shaft?"),
            ask("plant.lumped.out_of_balance", "What is its out-of-balance (mass times distance)?"),
            TORQUE,
            PERIOD,
        ],
    ),
];

impl StarterKind {
    /// Every kind.
    pub const ALL: [Self; 7] = [
        Self::Sight,
        Self::Gun,
        Self::Antenna,
        Self::RobotJoint,
        Self::Gimbal,
        Self::LinearAxis,
        Self::Pendulum,
    ];

    fn row(self) -> &'static (StarterKind, &'static str, &'static str, [StarterQuestion; 4]) {
        KINDS.iter().find(|row| row.0 == self).unwrap_or(&KINDS[0])
    }

    /// Returns the name by which a kind is asked for.
    pub fn name(self) -> &'static str {
        self.row().1
    }

    /// Returns the kind of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        KINDS.iter().find(|row| row.1 == name).map(|row| row.0)
    }

    /// Returns the text of the file.
    pub fn text(self) -> &'static str {
        self.row().2
    }

    /// Returns the questions whose answers turn the starter into a file of the user's own machine.
    pub fn questions(self) -> &'static [StarterQuestion; 4] {
        &self.row().3
    }
}

/// Returns a starting file with an answer filled in: a bare number, or a number with its unit.
///
/// # Errors
/// The problem with the answer, in words.
pub fn with_answer(document: &Document, path: &str, answer: &str) -> Result<Document, String> {
    let answer = answer.trim();
    let setting = answer.parse().map_or_else(|_| SettingValue::Text(answer.to_owned()), SettingValue::Number);
    let filled = document.replace(path, &setting).map_err(|error: EditError| error.to_string())?;
    match Project::resolve(&filled, &Attachments::none()) {
        Ok(_) => Ok(filled),
        Err(errors) => Err(errors.first().map_or_else(String::new, |error| match &error.hint {
            Some(hint) => format!("{} ({hint})", error.allowed),
            None => error.allowed.clone(),
        })),
    }
}
