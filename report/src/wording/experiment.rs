//! The plan of an experiment in words and as plain data.

use counterpoise_diagnose::experiment::{DemandShape, ExperimentPlan, PlannedExperiment, Refit};
use counterpoise_plot::number::short_number;
use serde::Serialize;

/// A plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExperimentPlanText {
    /// The machines that are left, the likeliest first.
    pub machines: Vec<String>,
    /// The demand of the best experiment.
    pub what: String,
    /// Separation of each two machines.
    pub separations: Vec<SeparationText>,
    /// Largest angle from the start that a machine reaches, rad.
    pub reached_angle_rad: f64,
    /// Largest rate, rad/s.
    pub reached_rate_rad_s: f64,
    /// Largest current, A.
    pub reached_current_a: f64,
    /// The experiments that separate next best.
    pub others: Vec<OtherExperiment>,
}

/// Separation of two machines, in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeparationText {
    /// Index of one machine, from 0.
    pub first: usize,
    /// Index of the other.
    pub second: usize,
    /// Expected log-likelihood ratio.
    pub log_likelihood_ratio: f64,
    /// Probability that the new recording decides between them.
    pub probability: f64,
    /// The first as true and the second fitted to it, then the other way round: the ratio is the smaller of both.
    pub refits: [RefitText; 2],
}

/// The linear fit of a rival to the machine that is true, over the noise. The expected ratio is half of what it leaves of the squared distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RefitText {
    /// Squared distance of what both record.
    pub squared_distance: f64,
    /// Products of the slopes of the rival's recording with each other.
    pub slopes: Vec<Vec<f64>>,
    /// Products of the slopes with the distance.
    pub slopes_with_distance: Vec<f64>,
}

impl From<&Refit> for RefitText {
    fn from(found: &Refit) -> Self {
        let Refit { squared_distance, slopes, slopes_with_distance } = found.clone();
        Self { squared_distance, slopes, slopes_with_distance }
    }
}

/// Another experiment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OtherExperiment {
    /// Demand.
    pub what: String,
    /// Expected log-likelihood ratio of the two machines that are hardest to separate.
    pub log_likelihood_ratio: f64,
}

/// Experiments that are listed beside the best one.
const OTHERS: usize = 3;

/// Describes a plan.
pub fn describe_plan(plan: &ExperimentPlan) -> ExperimentPlanText {
    let best = plan.experiments.first();
    let separations = best.iter().flat_map(|e| &e.separations).map(|s| SeparationText {
        first: s.first,
        second: s.second,
        log_likelihood_ratio: s.log_likelihood_ratio,
        probability: s.probability,
        refits: s.refits.each_ref().map(RefitText::from),
    });
    let other = |e: &PlannedExperiment| OtherExperiment {
        what: describe_demand(e),
        log_likelihood_ratio: e.weakest_separation().map_or(0.0, |s| s.log_likelihood_ratio),
    };
    let reached = best.map(|e| e.reached).unwrap_or_default();
    ExperimentPlanText {
        machines: plan.machines.iter().map(|m| m.name.clone()).collect(),
        what: best.map(describe_demand).unwrap_or_default(),
        separations: separations.collect(),
        reached_angle_rad: reached.angle_rad,
        reached_rate_rad_s: reached.rate_rad_s,
        reached_current_a: reached.current_a,
        others: plan.experiments.iter().skip(1).take(OTHERS).map(other).collect(),
    }
}

/// Describes the demand of an experiment.
fn describe_demand(experiment: &PlannedExperiment) -> String {
    let shape = match experiment.shape {
        DemandShape::Triangle { periods } => format!("triangle waves of the rate, {periods} periods"),
        DemandShape::Staircase => "a ladder of constant rates in both directions".to_owned(),
        DemandShape::GrowingSine => "a slow sine that grows from nothing".to_owned(),
        DemandShape::Multisine => "sines at many frequencies".to_owned(),
        DemandShape::Steps => "steps of the rate with rests".to_owned(),
    };
    format!("{shape}, with a rate of up to {} rad/s", short_number(experiment.reached.rate_rad_s))
}
