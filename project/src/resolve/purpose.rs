//! The purposes that a project file is read for, and the sections that must then be there.

use super::Project;
use crate::diagnostic::{Diagnostic, DiagnosticKind, Severity};
use crate::file::Document;
use crate::file::source::Remark;

/// Purpose for which a project file is read: each command needs only its own sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Model and frequency responses of the plant.
    Model,
    /// Reduction of the plant.
    Reduce,
    /// Identification from recordings.
    Identify,
    /// Replay of recordings in closed loop.
    Replay,
    /// Plan of an experiment from recordings.
    Experiment,
    /// Diagnosis of recordings.
    Diagnose,
    /// The design of a controller, without judging it.
    Synth,
    /// The front of designs. The weights are chosen by the search, and nothing of the file is tuned before.
    Front,
    /// Several designs in one table, simulated.
    Compare,
    /// The design of a controller and its verification.
    Verify,
    /// The whole road, to code.
    Design,
    /// Code alone.
    Export,
    /// A robustness campaign.
    Sweep,
}

/// The keys to add to a file that does not say under which controller its recordings are made.
const RECORDED_UNDER: &str = "for recordings under this project's own design add recording_controller = { kind = \"project\" }, under an exported one { kind = \"exported\", file = \"controller.json\" }";

impl Purpose {
    /// Returns the sections that must be there; the others have usual values.
    pub fn sections(self) -> &'static [&'static str] {
        match self {
            Self::Replay | Self::Experiment => &["plant", "recording_controller"],
            _ => &["plant"],
        }
    }

    /// Returns whether the weights of the controller are needed: those that a file does not state are chosen, for the motions of
    /// `[verify]` or for the usual ones, so that every command chooses the same.
    pub fn needs_weights(self) -> bool {
        matches!(self, Self::Synth | Self::Compare | Self::Verify | Self::Design | Self::Export | Self::Sweep)
    }

    /// Returns whether recordings are read, which may have been made under the project's own design.
    pub fn reads_recordings(self) -> bool {
        matches!(self, Self::Identify | Self::Replay | Self::Experiment | Self::Diagnose)
    }

    /// Returns the command's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Reduce => "reduce",
            Self::Identify => "identify",
            Self::Replay => "replay",
            Self::Experiment => "experiment",
            Self::Diagnose => "diagnose",
            Self::Synth | Self::Front => "synth",
            Self::Compare => "compare",
            Self::Verify => "verify",
            Self::Design => "design",
            Self::Export => "export",
            Self::Sweep => "sweep",
        }
    }
}

impl Project {
    /// Returns whether a file has the sections that a purpose needs.
    pub fn supports(&self, document: &Document, purpose: Purpose) -> bool {
        self.missing_for(document, purpose).is_empty()
    }

    pub(super) fn missing_for(&self, document: &Document, purpose: Purpose) -> Vec<Diagnostic> {
        let there = |section: &str| document.entries.iter().any(|e| e.key == section);
        let absent = purpose.sections().iter().filter(|section| !there(section));
        let remark = |section: &&str| {
            let allowed = format!("section [{section}] is missing; `{}` needs it", purpose.name());
            let hint = (*section == "recording_controller").then(|| RECORDED_UNDER.to_owned());
            document
                .finding(Severity::Error, Remark::new(DiagnosticKind::Missing, section, allowed).hint(hint))
        };
        absent.map(remark).collect()
    }
}
