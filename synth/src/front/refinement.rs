//! The refinement of a front: from some of its points the tuner descends in the residual while every other objective stays where it is.

use super::FrontObjective;
use super::evaluator::{Candidate, Evaluator};
use crate::tuning::descent::descend_some;
use crate::tuning::problem::Problem;
use crate::{Error, LoopLimits};

/// What the descents from a front found.
pub(super) struct Refinement {
    pub found: Vec<Candidate>,
    pub evaluations: usize,
}

/// Descends from points by at most `steps` steps each; `None` if the user asked to stop.
///
/// # Errors
/// Those of the descent.
pub(super) fn refine(
    evaluator: &Evaluator<'_>,
    objectives: &[FrontObjective],
    points: &[Candidate],
    steps: usize,
) -> Result<Option<Refinement>, Error> {
    let done = evaluator.map_places(points.len(), |problem, k| {
        let limits = limits_at(problem, objectives, &points[k]);
        problem.limits = limits;
        let Some(found) = descend_some(problem, &points[k].at, steps)? else { return Ok((None, 1)) };
        let rating = evaluator.judge(problem, &found.at);
        let evaluations = 1 + found.evaluations * problem.family.response_feedbacks();
        Ok((Some(Candidate { at: found.at, rating }), evaluations))
    })?;
    Ok(done.map(|done| Refinement {
        evaluations: done.iter().map(|(_, evaluations)| evaluations).sum(),
        found: done.into_iter().filter_map(|(found, _)| found).collect(),
    }))
}

/// The limits of a problem, and those that keep every objective of a point but the residual.
fn limits_at(problem: &Problem<'_>, objectives: &[FrontObjective], point: &Candidate) -> LoopLimits {
    let mut limits = problem.limits;
    for (objective, cost) in objectives.iter().zip(&point.rating.costs) {
        let (largest, least) = (cost.exp(), -cost);
        match objective {
            FrontObjective::Residual => {}
            FrontObjective::Effort => limits.effort_v = limits.effort_v.min(largest),
            FrontObjective::NoiseGain => limits.noise_gain = limits.noise_gain.min(largest),
            FrontObjective::MaxSensitivity => limits.max_sensitivity = limits.max_sensitivity.min(largest),
            FrontObjective::MaxComplementary => {
                limits.max_complementary = limits.max_complementary.min(largest)
            }
            FrontObjective::ControlPeak => limits.control_peak = limits.control_peak.min(largest),
            FrontObjective::GainMargin => limits.gain_margin_db = limits.gain_margin_db.max(least),
            FrontObjective::PhaseMargin => limits.phase_margin_deg = limits.phase_margin_deg.max(least),
            FrontObjective::DelayMargin => limits.delay_margin_s = limits.delay_margin_s.max(least),
        }
    }
    limits
}
