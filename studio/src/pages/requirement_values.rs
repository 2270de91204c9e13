//! The requirements of the project as it stands, each with the newest value of its figure.

use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_project::Project;
use counterpoise_verify::{MeasuredFigure, Requirement, Value, Verdict, Verification};

use crate::editing::limit_paths::limit_paths;
use crate::editing::session::Session;
use crate::results::{ComputedResults, VerificationState};
use crate::versioned_results::Freshness;

/// A requirement with the newest value of its figure.
#[derive(Debug, Clone)]
pub struct RequirementValue {
    /// The requirement, with the limit of the project as it stands.
    pub requirement: Requirement,
    /// The verdict on the newest value; `None` if there is no value yet.
    pub verdict: Option<Verdict>,
    /// Whether the value belongs to the design as it stands.
    pub freshness: Freshness,
}

/// The results from which values are read, as far as they are there.
#[derive(Clone, Copy, Default)]
pub struct ValueSources<'a> {
    /// The design of the project as it stands.
    pub design: Option<&'a DesignPreview>,
    /// The newest verification.
    pub verification: Option<&'a Verification>,
    /// Its state.
    pub state: Option<VerificationState>,
}

impl<'a> ValueSources<'a> {
    /// Returns the design of a revision if there is one, and the newest verification.
    pub fn of_results(results: &'a ComputedResults, revision: u64) -> Self {
        let design = results.design_at(revision).filter(|(_, age)| *age == Freshness::Current);
        let verification = results.verification(revision);
        Self {
            design: design.map(|(design, _)| design.as_ref()),
            verification: verification.map(|(found, _)| found),
            state: verification.map(|(_, state)| state),
        }
    }
}

/// The requirements of the project with their values, and the paths of their limits.
#[derive(Debug, Clone, Default)]
pub struct Requirements {
    /// The requirements.
    pub values: Vec<RequirementValue>,
    /// The path of the limit of each; empty if the text has errors, so that none can be changed.
    pub paths: Vec<String>,
}

impl Requirements {
    /// Returns the requirements of a project with the newest values of their figures.
    pub fn new(session: &Session, project: &Project, sources: ValueSources) -> Self {
        let values = requirement_values(project, sources);
        let mut paths = limit_paths(session.document());
        if paths.len() != values.len() || !session.errors().is_empty() {
            paths.clear();
        }
        Self { values, paths }
    }
}

/// Returns every requirement of a project. Figures of the linear loop are those of the design, which follows a dragged weight at
/// once; the others are those of the verification.
fn requirement_values(project: &Project, sources: ValueSources) -> Vec<RequirementValue> {
    let live = sources.design.map(DesignPreview::live_figures).unwrap_or_default();
    let requirements =
        project.verify.as_ref().map(|verify| verify.requirements.as_slice()).unwrap_or_default();
    let verified = |requirement: &Requirement| {
        let verification = sources.verification?;
        verification
            .verdicts
            .iter()
            .find(|(judged, _)| judged.figure == requirement.figure)
            .map(|(_, verdict)| verdict)
    };
    let one = |requirement: &Requirement| {
        let (verdict, freshness) = match live.iter().find(|measured| measured.figure == requirement.figure) {
            Some(MeasuredFigure { value: Value::Is(value), .. }) => {
                (Some(requirement.judge(*value)), Freshness::Current)
            }
            _ => {
                let is_current = sources.state.is_some_and(|state| state != VerificationState::Stale);
                let freshness = if is_current { Freshness::Current } else { Freshness::Stale };
                (verified(requirement).map(|verdict| judge_again(requirement, verdict)), freshness)
            }
        };
        RequirementValue { requirement: requirement.clone(), verdict, freshness }
    };
    requirements.iter().map(one).collect()
}

/// Returns the verdict on a measured value with the limit as it stands, which may have been moved since.
fn judge_again(requirement: &Requirement, verdict: &Verdict) -> Verdict {
    match verdict {
        Verdict::Holds { value, .. } | Verdict::Fails { value, .. } => requirement.judge(*value),
        Verdict::NotApplicable { .. } => verdict.clone(),
    }
}
