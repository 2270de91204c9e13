//! The robustness campaign that the project asks for.

use std::collections::BTreeMap;

use counterpoise_controller::Controller;
use counterpoise_models::ControlledQuantity;
use counterpoise_pool::{Pool, map};
use counterpoise_verify::robustness;
use counterpoise_verify::robustness::{
    Campaign, FamilyMember, Layout, ParameterInfluence, Sample, Sense, Summary, Variation, WorstMechanism,
    compare_configurations, one_at_a_time, rank_parameters, summarise_requirement, worst_case,
};
use counterpoise_verify::structured::{Joints, RobustStability, Uncertainty};
use counterpoise_verify::{Limit, LoopFigure, PerformanceFigure, Requirement, VerifiedController};
use ndarray::Array2;
use serde::Serialize;

use super::certificate::RegimeRobustness;
use crate::tolerance::DRIFTING_POLE;
use crate::{PipelineError, PlantModel, World, project_procedure};
use counterpoise_project::Project;

/// A campaign that was run, with everything that a report, a terminal or another program shows of it.
#[derive(Debug, Clone)]
pub struct CampaignResult {
    /// The requirements that were judged.
    pub requirements: Vec<Requirement>,
    /// Quantity that the loop controls; the figures have its names and unit.
    pub controlled: ControlledQuantity,
    /// Parameters that varied.
    pub variations: Vec<Variation>,
    /// Factors: one row a mechanism, one column a variation.
    pub factors: Array2<f64>,
    /// Figures: one row a mechanism, one column a requirement; NaN if a figure could not be measured.
    pub values: Array2<f64>,
    /// Number of mechanisms that meet every requirement.
    pub passing: usize,
    /// Statistics of each requirement.
    pub summaries: Vec<Summary>,
    /// Distribution of the figure of each requirement: each value with the percentage of mechanisms at or below it.
    pub distributions: Vec<Vec<[f64; 2]>>,
    /// The variations of each requirement by rank correlation, strongest first.
    pub rankings: Vec<Vec<ParameterInfluence>>,
    /// The worst case of each requirement; `None` if no mechanism could be judged.
    pub worst: Vec<Option<WorstMechanism>>,
    /// Each parameter varied alone, and each configuration.
    pub families: Vec<FamilyMember>,
    /// The linear worst case; `None` if nothing that enters the linear loop varies.
    pub stability: Option<RobustStability>,
    /// The linear worst case in the other cases of the schedule and regimes of friction.
    pub regimes: Vec<RegimeRobustness>,
}

/// The mechanisms of a campaign as columns: factors of what varies, and figures, a number a mechanism.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MechanismColumns {
    /// Number of the mechanism.
    pub sample: Vec<usize>,
    /// The columns: factors as `factor.KEY`, figures by the keys of their requirements.
    #[serde(flatten)]
    pub values: BTreeMap<String, Vec<f64>>,
}

impl From<&CampaignResult> for MechanismColumns {
    fn from(found: &CampaignResult) -> Self {
        let factors = found.variations.iter().zip(found.factors.columns());
        let factors = factors.map(|(v, column)| (format!("factor.{}", v.parameter.key()), column.to_vec()));
        let figures = found.requirements.iter().zip(found.values.columns());
        let figures = figures.map(|(r, column)| (r.figure.key_in(found.controlled), column.to_vec()));
        Self { sample: (0..found.samples()).collect(), values: factors.chain(figures).collect() }
    }
}

/// How far the stated ranges may be widened together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobustnessLimit<'a> {
    /// The factor on the ranges.
    pub factor: f64,
    /// Where; `None` for the design's own case with sliding friction.
    pub at: Option<&'a RegimeRobustness>,
}

/// Results of a campaign beside its samples.
#[derive(Debug, Clone, Default)]
pub struct BesideSamples {
    /// The worst case of each requirement.
    pub worst: Vec<Option<WorstMechanism>>,
    /// Each parameter varied alone, and each configuration.
    pub families: Vec<FamilyMember>,
    /// The linear worst case.
    pub stability: Option<RobustStability>,
    /// The linear worst case in the other cases and regimes.
    pub regimes: Vec<RegimeRobustness>,
}

impl CampaignResult {
    /// Computes the statistics of the samples of a campaign.
    pub fn new(campaign: &Campaign, samples: &[Sample], others: BesideSamples) -> Self {
        let (requirements, variations) = (campaign.requirements(), campaign.variations());
        let each = 0..requirements.len();
        Self {
            requirements: requirements.to_vec(),
            controlled: campaign.controlled_quantity(),
            variations: variations.to_vec(),
            factors: Array2::from_shape_fn((samples.len(), variations.len()), |(i, k)| samples[i].factors[k]),
            values: Array2::from_shape_fn((samples.len(), requirements.len()), |(i, k)| samples[i].values[k]),
            passing: samples.iter().filter(|sample| campaign.passes(sample)).count(),
            summaries: each.clone().map(|k| summarise_requirement(campaign, samples, k)).collect(),
            distributions: each.clone().map(|k| distribution(samples, k)).collect(),
            rankings: each.map(|k| rank_parameters(campaign, samples, k)).collect(),
            worst: others.worst,
            families: others.families,
            stability: others.stability,
            regimes: others.regimes,
        }
    }

    /// Returns how far the ranges can be widened in each case and regime, the design's own case first: 0 if the loop is unstable without any
    /// deviation. Empty if nothing that enters the linear loop varies.
    pub fn robustness_limits(&self) -> impl Iterator<Item = RobustnessLimit<'_>> {
        let own = self.stability.as_ref().map(|found| RobustnessLimit { factor: found.guaranteed, at: None });
        let factor = |at: &RegimeRobustness| at.found.as_ref().map_or(0.0, |found| found.guaranteed);
        own.into_iter()
            .chain(self.regimes.iter().map(move |at| RobustnessLimit { factor: factor(at), at: Some(at) }))
    }

    /// Returns the case and regime whose ranges can be widened least; `None` if nothing that enters the linear loop varies.
    pub fn least_robust(&self) -> Option<RobustnessLimit<'_>> {
        self.robustness_limits().min_by(|a, b| a.factor.total_cmp(&b.factor))
    }

    /// Returns the state of friction of the design's own linear worst case.
    pub fn own_joints(&self) -> Joints {
        let rests = self.regimes.iter().any(|at| at.joints == Joints::AtRest);
        if rests { Joints::Sliding } else { Joints::Frictionless }
    }

    /// Returns the number of mechanisms.
    pub fn samples(&self) -> usize {
        self.values.nrows()
    }

    /// Returns the rank correlation that chance alone exceeds in about one case of twenty.
    pub fn chance_correlation(&self) -> f64 {
        2.0 / (self.samples().max(1) as f64).sqrt()
    }

    /// Returns the variations whose rank correlation with the figure of a requirement stands out from chance, strongest first.
    pub fn clear_rankings(&self, requirement: usize) -> impl Iterator<Item = &ParameterInfluence> {
        let chance = self.chance_correlation();
        self.rankings[requirement].iter().filter(move |one| one.correlation.abs() >= chance)
    }
}

/// Returns each value of the figure of a requirement with the percentage of mechanisms at or below it.
fn distribution(samples: &[Sample], requirement: usize) -> Vec<[f64; 2]> {
    let all = samples.iter().map(|sample| sample.values[requirement]);
    let mut values: Vec<f64> = all.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let count = samples.len().max(1) as f64;
    values.iter().enumerate().map(|(k, value)| [*value, 100.0 * (k + 1) as f64 / count]).collect()
}

/// Checks that a project says what a campaign varies and judges: asked before the design, which takes longer.
///
/// # Errors
/// [`PipelineError::NothingVaries`].
pub fn campaign_is_stated(project: &Project) -> Result<(), PipelineError> {
    match project.campaign() {
        Some(asked) if !asked.variations.is_empty() => Ok(()),
        _ => Err(PipelineError::NothingVaries),
    }
}

/// Returns the requirements that a campaign judges: those of the project that can be measured on one of many mechanisms, or
/// [`usual_requirements`] if there are none. The stability certificate is computed for the design alone.
fn judged_requirements(project: &Project) -> Vec<Requirement> {
    let mut stated = project.verify.as_ref().map(|asked| asked.requirements.clone()).unwrap_or_default();
    stated.retain(|requirement| !matches!(requirement.figure, PerformanceFigure::Certificate(_)));
    if stated.is_empty() { usual_requirements() } else { stated }
}

/// Returns what every loop of a campaign should keep if nothing else is required: a largest sensitivity of at most 2, which leaves a
/// gain margin of 6 dB and a phase margin of 29 degrees, and closed-loop poles inside the unit circle.
fn usual_requirements() -> Vec<Requirement> {
    let require = |figure, limit| Requirement {
        figure: PerformanceFigure::Loop(figure),
        limit,
        source: USUAL_REQUIREMENT.to_owned(),
    };
    vec![
        require(LoopFigure::MaxSensitivity, Limit::AtMost(USUAL_SENSITIVITY)),
        require(LoopFigure::PoleRadius, Limit::AtMost(1.0 + DRIFTING_POLE)),
    ]
}

/// The source of a requirement that no project states.
const USUAL_REQUIREMENT: &str = "usual, because the project states no requirement";

/// Largest sensitivity that is reasonable, 1.4 to 2 (K. J. Astrom and R. M. Murray, Feedback Systems, section 12.3).
const USUAL_SENSITIVITY: f64 = 2.0;

/// Returns the Monte Carlo campaign of the project's requirements over its variations.
///
/// # Errors
/// A section that is missing, a recorded road that cannot be read, variations that make no mechanism.
pub fn prepare_campaign(
    project: &Project,
    modelled: &PlantModel,
    verified: &VerifiedController,
    world: &dyn World,
) -> Result<Campaign, PipelineError> {
    let asked = project.campaign().ok_or(PipelineError::NothingVaries)?;
    campaign_is_stated(project)?;
    Ok(Campaign::new(
        modelled.parameters.clone(),
        verified.controller().clone(),
        project_procedure(project, world)?,
        asked.variations.clone(),
        judged_requirements(project),
        Layout { samples: asked.samples, seed: asked.seed, points: asked.layout },
    )?)
}

/// Returns the figures of the project's requirements in each configuration and with each parameter of a family
/// varied alone.
///
/// # Errors
/// As [`prepare_campaign`].
pub fn vary_families(
    project: &Project,
    modelled: &PlantModel,
    verified: &VerifiedController,
    world: &dyn World,
) -> Result<Vec<FamilyMember>, PipelineError> {
    let asked =
        project.campaign().ok_or(PipelineError::Missing { section: "sweep", needed_by: "the families" })?;
    let figures: Vec<PerformanceFigure> =
        judged_requirements(project).iter().map(|requirement| requirement.figure).collect();
    let (parameters, controller, procedure) =
        (&modelled.parameters, verified.controller(), project_procedure(project, world)?);
    let mut members = one_at_a_time(parameters, controller, &procedure, &figures, &asked.families)?;
    members.extend(compare_configurations(parameters, controller, &procedure, &figures)?);
    Ok(members)
}

/// Returns how far the ranges of the project's variations may be widened together before the linear loop can be unstable;
/// `None` if the project varies nothing, has no lumped structure, or its loop is unstable as it is.
///
/// # Errors
/// As [`prepare_campaign`], and those of the linear loop.
pub fn robust_stability(
    project: &Project,
    modelled: &PlantModel,
    controller: &Controller,
    world: &dyn World,
) -> Result<Option<RobustStability>, PipelineError> {
    let Some(asked) = project.campaign() else { return Ok(None) };
    if modelled.parameters.lumped.is_none() {
        return Ok(None);
    }
    let uncertainty = Uncertainty {
        variations: asked.variations.clone(),
        input_error: asked.input_error,
        output_error: asked.output_error,
    };
    let procedure = project_procedure(project, world)?;
    let parameters = &modelled.parameters;
    Ok(counterpoise_verify::structured::robust_stability(parameters, controller, &procedure, &uncertainty)?)
}

/// Why shards do not make the samples of a campaign.
#[derive(Debug)]
pub enum ShardsProblem {
    /// No shard has some of the samples.
    Missing {
        /// Number of missing samples.
        count: usize,
        /// Number of samples of the campaign.
        all: usize,
        /// The first that is missing.
        first: usize,
        /// The last that is missing.
        last: usize,
    },
    /// A sample comes twice, or there are too many.
    Inconsistent(counterpoise_verify::Error),
}

/// Puts the samples of shards together, by number.
///
/// # Errors
/// The shards do not make one campaign.
pub fn merge_shards(campaign: &Campaign, shards: Vec<Vec<Sample>>) -> Result<Vec<Sample>, ShardsProblem> {
    match find_missing_samples(&shards, campaign.len()) {
        Some(missing) => Err(missing),
        None => robustness::merge_shards(campaign, shards).map_err(ShardsProblem::Inconsistent),
    }
}

/// Returns which samples no shard has; `None` if all are there.
fn find_missing_samples(shards: &[Vec<Sample>], all: usize) -> Option<ShardsProblem> {
    let mut there = vec![false; all];
    shards.iter().flatten().filter(|sample| sample.index < all).for_each(|sample| there[sample.index] = true);
    let absent: Vec<usize> = (0..all).filter(|k| !there[*k]).collect();
    let (first, last) = (*absent.first()?, *absent.last()?);
    Some(ShardsProblem::Missing { count: absent.len(), all, first, last })
}

/// Most mechanisms that the search for a worst case tries, a requirement.
const TRIED: usize = 60;

/// Returns the worst case of each requirement, by a search from its worst sample; `None` if no sample could be judged.
///
/// # Errors
/// Those of the campaign.
pub fn worst_cases(
    campaign: &Campaign,
    samples: &[Sample],
    pool: &dyn Pool,
) -> Result<Vec<Option<WorstMechanism>>, PipelineError> {
    let judged = |k: usize| samples.iter().any(|sample| !sample.values[k].is_nan());
    let one = |k: usize| judged(k).then(|| worst_case(campaign, samples, k, TRIED)).transpose();
    let found = map(pool, campaign.requirements().len(), one);
    found.into_iter().map(|worst| Ok(worst?)).collect()
}

/// A requirement over the mechanisms of a campaign.
#[derive(Debug, Clone)]
pub struct RequirementSpread {
    /// The requirement.
    pub requirement: Requirement,
    /// Quantity that the loop controls; the figure has its name and unit.
    pub controlled: ControlledQuantity,
    /// Share that meets it, quantiles and the worst value.
    pub summary: Summary,
    /// The parameter that moves the figure most; `None` if no parameter correlates with it.
    pub strongest: Option<StrongestParameter>,
    /// The figure of every mechanism that has one, sorted.
    pub values: Vec<f64>,
}

impl RequirementSpread {
    /// Returns each finite value with the percentage of mechanisms below it; half of the mechanism that has the value counts as below.
    pub fn distribution(&self) -> Vec<[f64; 2]> {
        let count = self.values.len().max(1) as f64;
        let finite = self.values.iter().enumerate().filter(|(_, value)| value.is_finite());
        finite.map(|(k, value)| [*value, 100.0 * (k as f64 + 0.5) / count]).collect()
    }
}

/// The parameter that moves a figure most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrongestParameter {
    /// Key of the parameter.
    pub key: &'static str,
    /// Rank correlation of the figure with the parameter.
    pub correlation: f64,
    /// The dependence of the figure: on the parameter itself or on its distance from the design value.
    pub sense: Sense,
}

/// Returns every requirement of a campaign over the mechanisms that were simulated so far.
pub fn requirement_spreads(campaign: &Campaign, samples: &[Sample]) -> Vec<RequirementSpread> {
    let one = |(k, requirement): (usize, &Requirement)| {
        let mut values: Vec<f64> = samples.iter().map(|s| s.values[k]).filter(|v| !v.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let strongest = rank_parameters(campaign, samples, k).into_iter().find(|r| r.correlation.is_finite());
        let strongest = strongest.map(|r| StrongestParameter {
            key: campaign.variations()[r.variation].parameter.key(),
            correlation: r.correlation,
            sense: r.sense,
        });
        RequirementSpread {
            controlled: campaign.controlled_quantity(),
            requirement: requirement.clone(),
            summary: summarise_requirement(campaign, samples, k),
            strongest,
            values,
        }
    };
    campaign.requirements().iter().enumerate().map(one).collect()
}
