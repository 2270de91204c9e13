//! The verified controller as code, with where it comes from.

use counterpoise_export::{File, Provenance, c99, rust_crate};
use counterpoise_verify::{Verdict, VerifiedController};
use sha2::{Digest, Sha256};

use super::PipelineError;
use crate::Project;
use crate::resolve::design::{Language, Synthesis};

/// The code in the languages that the project asks for.
///
/// # Errors
/// A coefficient that the target's numbers cannot hold.
pub fn export(project: &Project, verified: &VerifiedController) -> Result<Vec<File>, PipelineError> {
    let origin = provenance(project, verified);
    let options = &project.export.options;
    let mut files = Vec::new();
    for language in &project.export.languages {
        files.extend(match language {
            Language::C99 => c99(verified, &origin, options)?,
            Language::Rust => rust_crate(verified, &origin, options)?,
        });
    }
    Ok(files)
}

/// Hash of the project as it was resolved: the same for two files that mean the same.
pub fn project_hash(project: &Project) -> String {
    let digest = Sha256::digest(project.to_text().as_bytes());
    digest.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

fn provenance(project: &Project, verified: &VerifiedController) -> Provenance {
    let verification = verified.verification();
    let verdicts = verification.verdicts.iter().map(|(requirement, verdict)| {
        let figure = requirement.figure.name();
        match verdict {
            Verdict::Holds { value, .. } => format!("{figure}: {value:.4} holds"),
            Verdict::Fails { value, .. } => format!("{figure}: {value:.4} fails"),
            Verdict::NotApplicable { why } => format!("{figure}: not applicable, {why}"),
        }
    });
    Provenance {
        generator: format!("counterpoise {}", env!("CARGO_PKG_VERSION")),
        project: project.plant.name.clone(),
        project_hash: project_hash(project),
        weights: project.synth.as_ref().map(weights).unwrap_or_default(),
        verdicts: verdicts.collect(),
    }
}

/// What each weight asks for, in words, one a line.
pub fn weights(synth: &Synthesis) -> Vec<String> {
    let s = &synth.specification;
    let mut lines = vec![
        format!("feedback error: {}", s.feedback.error.meaning("the measured error")),
        format!("feedback control: {}", s.feedback.control.meaning("the control")),
    ];
    for (name, part) in [("heave", &s.heave), ("pitch", &s.pitch)] {
        if let Some(part) = part {
            lines.push(format!("{name} error: {}", part.error.meaning("the hub rate")));
            lines.push(format!("{name} control: {}", part.control.meaning("the control")));
        }
    }
    lines
}
