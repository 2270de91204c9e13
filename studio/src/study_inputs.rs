//! The studies that can be made of a project in the window, and what the user gives them.

use serde::{Deserialize, Serialize};

/// A study of a project: each is what a command of the command line does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StudyKind {
    /// A search over designs of every kind.
    Search,
    /// The project's own design beside others.
    Compare,
    /// An adaptation put to the test.
    Adapt,
    /// What changed from another project.
    Against,
    /// Values identified from recordings.
    Identify,
    /// The next experiment.
    Experiment,
}

impl StudyKind {
    /// All studies, in the order of the work.
    pub const ALL: [StudyKind; 6] = [
        StudyKind::Search,
        StudyKind::Compare,
        StudyKind::Adapt,
        StudyKind::Against,
        StudyKind::Identify,
        StudyKind::Experiment,
    ];

    /// Returns the name of the study.
    pub fn name(self) -> &'static str {
        match self {
            StudyKind::Search => "Search designs",
            StudyKind::Compare => "Compare designs",
            StudyKind::Adapt => "Test the adaptation",
            StudyKind::Against => "Compare with another project",
            StudyKind::Identify => "Identify from recordings",
            StudyKind::Experiment => "Plan an experiment",
        }
    }

    /// Returns what the study answers, and the command that does the same.
    pub fn summary(self) -> &'static str {
        match self {
            StudyKind::Search => {
                "Designs of every kind of which none is better than another in every objective, with a tuned PI as the bar to clear; or weights for the requirements of [synth.search] (`counterpoise synth --search`)."
            }
            StudyKind::Compare => {
                "The project's own design, the joint optimum and tuned fixed structures in one table, simulated on the full plant (`counterpoise compare`)."
            }
            StudyKind::Adapt => {
                "An out-of-balance that steps while the platform moves, with and without adaptation (`counterpoise adapt`)."
            }
            StudyKind::Against => {
                "Every figure of this project beside that of another one, the verdicts that turned first (`counterpoise verify --against`)."
            }
            StudyKind::Identify => {
                "Out-of-balance, friction, inertia and amplifier from triangle waves among the recordings of the page Diagnose (`counterpoise identify`)."
            }
            StudyKind::Experiment => {
                "The demand within stated limits that best separates what the diagnosis leaves possible, or what machines most often lack (`counterpoise experiment`)."
            }
        }
    }
}

/// What the user gives the studies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyInputs {
    /// The other project, a file or its folder; a relative path begins in the folder of the project.
    pub against: String,
    /// File for the demand of an experiment, in the folder of the project.
    pub demand_file: String,
    /// Largest angle from the start, rad.
    pub angle_rad: f64,
    /// Largest rate, rad/s.
    pub rate_rad_s: f64,
    /// Largest current, A; 0 for no limit.
    pub current_a: f64,
    /// Duration of an experiment, s.
    pub duration_s: f64,
}

impl Default for StudyInputs {
    fn default() -> Self {
        Self {
            against: String::new(),
            demand_file: "demand.csv".to_owned(),
            angle_rad: 0.1,
            rate_rad_s: 0.2,
            current_a: 0.0,
            duration_s: 10.0,
        }
    }
}
