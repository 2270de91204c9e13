//! The model of the next round: values within their tolerances, then what no value explains.

use std::sync::Arc;

use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict, Hypothesis};
use counterpoise_diagnose::library::{Component, EffectName, find_effects};
use counterpoise_pool::Pool;
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::{ControllerSource, RecordingController};
use counterpoise_project::resolve::controller_file::ControllerContent;
use counterpoise_verify::{Limit, LoopFigure, PerformanceFigure, Requirement};

use super::posterior::{Posterior, Problem, RecordedRuns, ValuedEffect, fit_from, fit_tolerances};
use super::screening::screen_effects;
use crate::PipelineError;
use crate::recordings::read::{control_for, recording_controller};
use crate::recordings::{DiagnosedRecordings, GapTreatment, RecordingFile, diagnose, read_files};
use crate::tolerance::{
    AS_GOOD, CAUTIOUS_GAIN_MARGIN_DB, EFFECT_GAIN, EXPLAINED_FLOORS, MOST_CANDIDATES, MOST_EFFECTS,
    NEARLY_AS_GOOD, POSTERIOR_STEPS, RANKING_STEPS,
};

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
            all.extend(effect.map(|effect| ValuedEffect::new(effect, values)));
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

/// A model that is fitted to the recordings of a round, with what it takes to fit it again.
struct Fitting<'a> {
    project: &'a Project,
    recorded: &'a RecordedRuns<'a>,
    pool: &'a dyn Pool,
}

impl Fitting<'_> {
    /// Returns the best of several effects, each fitted beside what a model has; `None` if none removes enough of the residual.
    fn best_of(&self, model: &Posterior, candidates: &[ValuedEffect]) -> Option<Posterior> {
        let is_new =
            |candidate: &&ValuedEffect| !model.effects.iter().any(|one| one.has_effect_of(candidate));
        let mut ranked: Vec<Posterior> = Vec::new();
        for candidate in candidates.iter().filter(is_new) {
            let effects = [model.effects.as_slice(), std::slice::from_ref(candidate)].concat();
            // A machine with such an effect may be none that can be simulated.
            let Ok(fitted) = self.fit(model, &effects, RANKING_STEPS) else { continue };
            if fitted.power_after < EFFECT_GAIN * model.power_after {
                ranked.push(fitted);
            }
        }
        ranked.sort_by(|a, b| a.power_after.total_cmp(&b.power_after));
        let best = ranked.first()?;
        let explained = model.power_after - best.power_after;
        let is_near = |other: &&Posterior| other.power_after - best.power_after <= NEARLY_AS_GOOD * explained;
        let others = ranked[1..].iter().filter(is_near).filter_map(|other| other.effects.last().cloned());
        let mut effects = best.effects.clone();
        if let Some(added) = effects.last_mut() {
            added.equivalents.extend(others);
        }
        self.fit(best, &effects, POSTERIOR_STEPS).ok()
    }

    /// Tries the effects that were nearly as good as those that were added in their places, now that the model has everything: each gives way to one that leaves less, and
    /// keeps those that leave as little as equivalents.
    fn settle_equivalents(&self, mut model: Posterior) -> Posterior {
        for k in 0..model.effects.len() {
            let others = std::mem::take(&mut model.effects[k].equivalents);
            let mut fits = vec![model];
            for other in others {
                let mut effects = fits[0].effects.clone();
                effects[k] = other;
                fits.extend(self.fit(&fits[0], &effects, POSTERIOR_STEPS).ok());
            }
            fits.sort_by(|a, b| a.power_after.total_cmp(&b.power_after));
            let most = AS_GOOD * fits[0].power_after;
            let as_good = fits[1..].iter().filter(|fit| fit.power_after <= most);
            let equivalents = as_good.map(|fit| fit.effects[k].clone()).collect();
            model = fits.swap_remove(0);
            model.effects[k].equivalents = equivalents;
        }
        model
    }

    fn fit(
        &self,
        earlier: &Posterior,
        effects: &[ValuedEffect],
        steps: usize,
    ) -> Result<Posterior, PipelineError> {
        fit_from(earlier, self.project, self.recorded, effects, steps, self.pool)
    }

    /// Returns whether a model leaves more than the noise, and room for an effect.
    fn wants_effect(model: &Posterior) -> bool {
        model.residual_after > EXPLAINED_FLOORS && model.effects.len() < MOST_EFFECTS
    }

    /// Adds the best of a model's candidates one after the other, as long as one removes enough of the residual.
    fn add_effects(
        &self,
        mut model: Posterior,
        candidates_of: impl Fn(&Posterior) -> Result<Vec<ValuedEffect>, PipelineError>,
    ) -> Result<Posterior, PipelineError> {
        while Self::wants_effect(&model) {
            let Some(better) = self.best_of(&model, &candidates_of(&model)?) else { break };
            model = better;
        }
        Ok(model)
    }

    /// Adds effects that screening ranks first.
    fn add_screened(&self, model: Posterior) -> Result<Posterior, PipelineError> {
        self.add_effects(model, |model| {
            let problem = Problem::new(self.project, self.recorded, &model.effects, self.pool);
            let mut candidates = screen_effects(&problem, model)?;
            candidates.truncate(MOST_CANDIDATES);
            Ok(candidates)
        })
    }
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
/// The values that are known within tolerances are fitted first. If the model then leaves more than the noise, the effects of the library that could explain the rest beside
/// these values are fitted together with them. If more than the noise is still left, the recordings are diagnosed, and what the diagnosis found, or nearly found, is tried too.
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
    let recorded = &RecordedRuns::prepare(&given, &read, &control)?;
    let fitting = Fitting { project: &given, recorded, pool };
    let mut posterior = fitting.add_screened(fit_tolerances(&given, recorded, &[], pool)?)?;
    let mut diagnosed = None;
    if Fitting::wants_effect(&posterior) {
        let found = diagnose(&recorded_under(&posterior.project), files, pool)?;
        let candidates = candidate_effects(&found.diagnosis.answer);
        posterior = fitting.add_effects(posterior, |_| Ok(candidates.clone()))?;
        posterior = fitting.add_screened(posterior)?;
        diagnosed = Some(Box::new(found));
    }
    let posterior = fitting.settle_equivalents(posterior);
    let updated = Project {
        plant: posterior.project.plant.clone(),
        tolerances: posterior.project.tolerances.clone(),
        ..project.clone()
    };
    let residual = posterior.residual_after;
    let update = ModelUpdate { project: updated, posterior, diagnosed, residual };
    Ok(ModelUpdate { project: with_caution(&update), ..update })
}

/// Returns the updated project, whose design is asked for a wide gain margin as long as its model does not explain the recordings: what is
/// missing in the model may be a lag or a mode, and these raise the loop's gain where nothing was measured.
fn with_caution(update: &ModelUpdate) -> Project {
    let mut project = update.project.clone();
    let Some(verify) = &mut project.verify else { return project };
    verify.requirements.retain(|requirement| requirement.source != CAUTION);
    if !update.explains() {
        verify.requirements.push(Requirement {
            figure: PerformanceFigure::Loop(LoopFigure::GainMargin),
            limit: Limit::AtLeast(CAUTIOUS_GAIN_MARGIN_DB),
            source: CAUTION.to_owned(),
        });
    }
    project
}

/// Source of the requirement that a commissioning adds.
const CAUTION: &str = "caution of the commissioning: the model does not explain its recordings";
