//! From requirements to weights: the search, its trade-off curve, and the project with the weights that were found.

use counterpoise_synth::{
    Figures, Requirements, SearchResult, SearchTask, SearchTrial, sampled_loop_figures, search_specification,
    trade_off,
};

use counterpoise_verify::VerifiedController;

use crate::design_views::{WeightResponses, weight_responses};
use crate::synth::{design_plant, sampling};
use crate::{PipelineError, PlantModel, ReducedPlant, World, synthesise, verify};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_project::resolve::synthesis_options::WeightSearch;

/// A point of the trade-off between rejection and sensitivity.
#[derive(Debug, Clone)]
pub struct TradeOffPoint {
    /// The limit of the largest sensitivity Ms.
    pub ms_limit: f64,
    /// Result under it.
    pub found: SearchResult,
}

/// The answer of a search.
#[derive(Debug, Clone)]
pub struct SearchAnswer {
    /// Result.
    pub found: SearchResult,
    /// The trade-off between rejection and sensitivity, in the order of the project's limits.
    pub curve: Vec<TradeOffPoint>,
    /// The figures of what was found on the plant as it was before reduction.
    pub on_full_plant: Figures,
    /// The shortfall of the best trial there, 0 if the requirements hold.
    pub missed_on_full_plant: f64,
    /// The project with the weights that were found.
    pub project: Project,
    /// The design that this project asks for.
    pub asked: DesignRequest,
    /// The frequency responses of its weights.
    pub weight_responses: Vec<WeightResponses>,
}

/// Searches the weights and the loop recovery of the feedback; `go_on` is asked before each trial.
///
/// # Errors
/// A project without requirements, and those of the plant and the design.
pub fn search_weights(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    go_on: &mut dyn FnMut(&SearchTrial) -> bool,
) -> Result<SearchAnswer, PipelineError> {
    let missing = |section| PipelineError::Missing { section, needed_by: "the search for weights" };
    let asked = project.synth.as_ref().ok_or(missing("synth"))?;
    let wanted: &WeightSearch = asked.options.search.as_ref().ok_or(missing("synth.search"))?;
    let plant = design_plant(asked, modelled, reduced)?;
    let sampling = sampling(asked, modelled)?;
    let task = SearchTask {
        plant: &plant,
        start: &asked.specification,
        requirements: &wanted.requirements,
        sampling: &sampling,
        most_trials: wanted.trials,
    };
    let mut found = search_specification(&task, go_on)?;
    let mut curve = Vec::new();
    if !wanted.ms_limits.is_empty() {
        let from = SearchTask { start: &found.best.specification, ..task };
        let points = trade_off(&from, &wanted.ms_limits, go_on)?;
        let limits = wanted.ms_limits.iter().zip(points);
        curve = limits.map(|(&ms_limit, found)| TradeOffPoint { ms_limit, found }).collect();
    }
    if let Some(better) = better_point(&curve, &found, &wanted.requirements) {
        found.best = better;
    }
    let asked_with = DesignRequest { specification: found.best.specification.clone(), ..asked.clone() };
    let project = Project { synth: Some(asked_with.clone()), ..project.clone() };
    let full = counterpoise_synth::DesignPlant { system: modelled.linear.system.clone(), ..plant.clone() };
    let designed = counterpoise_synth::design(&plant, &found.best.specification)?;
    let sampled = counterpoise_synth::discretise(&designed, &sampling)?;
    let around_full = counterpoise_synth::check_sampled_loop(&full, sampled.controller, &sampling)?;
    let of_all = sampled_loop_figures(&full, &around_full, &sampling, wanted.requirements.band_rad_s)?;
    let rejection = wanted.requirements.share_left(&around_full.loop_gain, &full, &asked.specification)?;
    let on_full_plant = Figures { rejection, ..of_all };
    let missed_on_full_plant = wanted.requirements.total_shortfall(&on_full_plant);
    let weight_responses = weight_responses(&found.best.specification);
    Ok(SearchAnswer {
        found,
        curve,
        on_full_plant,
        missed_on_full_plant,
        project,
        asked: asked_with,
        weight_responses,
    })
}

/// Returns the trial of the curve that keeps the requirements and rejects more than the answer, if there is one: its
/// points were searched further.
fn better_point(curve: &[TradeOffPoint], found: &SearchResult, wanted: &Requirements) -> Option<SearchTrial> {
    let rejection = |trial: &SearchTrial| trial.figures.rejection;
    let points = curve.iter().map(|point| &point.found.best);
    points
        .filter(|trial| wanted.total_shortfall(&trial.figures) == 0.0)
        .filter(|trial| found.best.missed > 0.0 || rejection(trial) < rejection(&found.best))
        .min_by(|a, b| rejection(a).total_cmp(&rejection(b)))
        .cloned()
}

/// Weights that were found, with the project's own verdicts on them: on the full nonlinear plant.
#[derive(Debug, Clone)]
pub struct JudgedWeights {
    /// The limit of Ms under which they were found; none for the answer itself.
    pub ms_limit: Option<f64>,
    /// Result.
    pub found: SearchResult,
    /// The verified controller.
    pub verified: VerifiedController,
    /// The project with these weights.
    pub project: Project,
}

impl JudgedWeights {
    /// Returns whether the searched requirements and every verdict hold.
    pub fn holds(&self) -> bool {
        self.found.best.missed == 0.0 && self.verified.verification().passes()
    }
}

/// Returns the answer of a search and the points of its curve, each verified by the project's `[verify]`: the answer
/// first, the points then in the order of their rejection. `go_on` is asked before each.
///
/// # Errors
/// A project without `[verify]`, and those of the design and the verification.
pub fn verify_found(
    searched: &SearchAnswer,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    world: &dyn World,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Vec<JudgedWeights>, PipelineError> {
    let mut points: Vec<(Option<f64>, &SearchResult)> =
        searched.curve.iter().map(|point| (Some(point.ms_limit), &point.found)).collect();
    points.sort_by(|a, b| a.1.best.figures.rejection.total_cmp(&b.1.best.figures.rejection));
    let mut all = Vec::new();
    for (ms_limit, found) in std::iter::once((None, &searched.found)).chain(points) {
        if !go_on() {
            break;
        }
        let mut project = searched.project.clone();
        if let Some(synth) = &mut project.synth {
            synth.specification = found.best.specification.clone();
        }
        let made = synthesise(&project, modelled, reduced)?;
        let verified = verify(&project, modelled, &made, world)?;
        all.push(JudgedWeights { ms_limit, found: found.clone(), verified, project });
    }
    Ok(all)
}
