//! The model of the next round: values within their tolerances, then what no value explains.

use std::sync::Arc;

use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict, Hypothesis};
use counterpoise_diagnose::library::{Component, EffectName, find_effects};
use counterpoise_pool::Pool;
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::{ControllerSource, RecordingController};
use counterpoise_project::resolve::controller_file::ControllerContent;

use super::posterior::{Posterior, RecordedRuns, ValuedEffect, fit_tolerances};
use crate::PipelineError;
use crate::recordings::read::{control_for, recording_controller};
use crate::recordings::{DiagnosedRecordings, GapTreatment, RecordingFile, diagnose, read_files};
use crate::tolerance::{EFFECT_GAIN, EXPLAINED_FLOORS, MOST_CANDIDATES, MOST_EFFECTS};

/// The model that the recordings of a round leave.
#[derive(Debug, Clone)]
pub struct ModelUpdate {
    /// The project with the updated model and tolerances.
    pub project: Project,
    /// The rest of the tolerances.
    pub posterior: Posterior,
    /// The diagnosis of what no value within the tolerances explains, if there was anything.
    pub diagnosed: Option<Box<DiagnosedRecordings>>,
    /// Largest residual of a channel over its noise floor with the updated model.
    pub residual: f64,
}

impl ModelUpdate {
    /// Returns whether the updated model explains the recordings.
    pub fn explains(&self) -> bool {
        let is_consistent = self
            .diagnosed
            .as_ref()
            .is_some_and(|found| found.diagnosis.answer.verdict == DiagnosisVerdict::Consistent);
        self.residual <= EXPLAINED_FLOORS || is_consistent
    }
}

/// Returns the effects that a diagnosis found or nearly found, the best first.
fn candidate_effects(answer: &Answer) -> Vec<ValuedEffect> {
    let mut all: Vec<ValuedEffect> = Vec::new();
    let mut add = |component: Component, name: EffectName, values: Vec<f64>| {
        let known =
            |valued: &ValuedEffect| valued.effect.component == component && valued.effect.effect == name;
        let is_useful =
            values.iter().all(|value| value.is_finite()) && values.iter().any(|value| *value != 0.0);
        if is_useful && !all.iter().any(known) {
            let effect = find_effects(component, name).find(|effect| effect.parameters.len() == values.len());
            all.extend(effect.map(|effect| ValuedEffect { effect, values }));
        }
    };
    for finding in &answer.findings {
        add(finding.component, finding.effect, finding.parameters.iter().map(|one| one.value).collect());
    }
    let mut tried: Vec<&Hypothesis> = answer.hypotheses.iter().collect();
    tried.sort_by(|a, b| b.log_likelihood_gain.total_cmp(&a.log_likelihood_gain));
    for hypothesis in tried {
        add(hypothesis.component, hypothesis.effect, hypothesis.values.iter().map(|one| one.value).collect());
    }
    all.truncate(MOST_CANDIDATES);
    all
}

fn is_same_effect(one: &ValuedEffect, other: &ValuedEffect) -> bool {
    one.effect.component == other.effect.component && one.effect.effect == other.effect.effect
}

/// Adds effects to a model one after the other, as long as one lowers the residual, each fitted from the file's own values together with these.
fn add_effects(
    project: &Project,
    recorded: RecordedRuns<'_>,
    mut best: Posterior,
    candidates: &[ValuedEffect],
    pool: &dyn Pool,
) -> Result<Posterior, PipelineError> {
    for _ in 0..MOST_EFFECTS {
        let mut improved: Option<Posterior> = None;
        for candidate in candidates {
            if best.effects.iter().any(|known| is_same_effect(known, candidate)) {
                continue;
            }
            let effects = [best.effects.as_slice(), std::slice::from_ref(candidate)].concat();
            // A machine with such an effect may be none that can be simulated.
            let Ok(fitted) = fit_tolerances(project, recorded, &effects, pool) else { continue };
            let least = improved.as_ref().map_or(EFFECT_GAIN * best.residual_after, |one| one.residual_after);
            if fitted.residual_after < least {
                improved = Some(fitted);
            }
        }
        let Some(improved) = improved else { break };
        best = Posterior { residual_before: best.residual_before, ..improved };
        if best.residual_after <= EXPLAINED_FLOORS {
            break;
        }
    }
    Ok(best)
}

/// Returns a project whose recordings are made under an exported controller.
pub fn assign_controller(project: &Project, content: &Arc<ControllerContent>) -> Project {
    let source = ControllerSource {
        file: "controller.json".to_owned(),
        hash: content.project_hash.clone(),
        content: Some(content.clone()),
    };
    Project { recording_controller: Some(RecordingController::Exported(source)), ..project.clone() }
}

/// Returns the model of a project, updated by recordings that were made under one exported controller.
///
/// The values that are known within tolerances are fitted first. If the model then leaves more than the noise, the recordings are diagnosed, and what the diagnosis
/// found, or nearly found, is tried beside the file's own values, which are fitted together with it.
///
/// # Errors
/// As [`read_files`], [`fit_tolerances`] and [`diagnose`].
pub fn update_model(
    project: &Project,
    content: &Arc<ControllerContent>,
    files: &[RecordingFile],
    pool: &dyn Pool,
) -> Result<ModelUpdate, PipelineError> {
    let recorded_under = |project: &Project| assign_controller(project, content);
    let given = recorded_under(project);
    let in_loop = recording_controller(&given)?;
    let read = read_files(&given, in_loop.as_ref(), files, GapTreatment::Repaired)?;
    let control = control_for(&given, in_loop.as_ref(), read.iter().map(|item| &item.recording));
    let recorded = RecordedRuns { read: &read, control: &control };
    let mut posterior = fit_tolerances(&given, recorded, &[], pool)?;
    let mut diagnosed = None;
    if posterior.residual_after > EXPLAINED_FLOORS {
        let found = diagnose(&recorded_under(&posterior.project), files, pool)?;
        let candidates = candidate_effects(&found.diagnosis.answer);
        posterior = add_effects(&given, recorded, posterior, &candidates, pool)?;
        diagnosed = Some(Box::new(found));
    }
    let updated = Project {
        plant: posterior.project.plant.clone(),
        tolerances: posterior.project.tolerances.clone(),
        ..project.clone()
    };
    let residual = posterior.residual_after;
    Ok(ModelUpdate { project: updated, posterior, diagnosed, residual })
}
