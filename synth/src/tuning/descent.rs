//! The descent from one start: tangent programs in a trust region.

use super::evaluation::Evaluation;
use super::problem::Problem;
use super::tangent::{PENALTY, merit, tangent_step};
use crate::Error;
use crate::tolerance::{
    DESCENT_PROMISED, DESCENT_STEPS, DESCENT_WORTHWHILE, REGION_AGAIN, REGION_FIRST, REGION_LARGEST,
    REGION_LAST, START_HALVINGS, STEP_GOOD, STEP_TAKEN,
};

/// The end of a descent.
#[derive(Debug, Clone)]
pub(crate) struct DescentResult {
    /// Logarithms of the open parameters.
    pub at: Vec<f64>,
    /// ln of the residual rate on the worst plant.
    pub objective: f64,
    /// Excess over the worst limit.
    pub missed: f64,
    /// Objective and penalty.
    pub merit: f64,
    /// Loops that were evaluated.
    pub evaluations: usize,
}

/// Descends from a start to the end; `None` if no loop near it is stable.
///
/// # Errors
/// [`Error::System`] if a program cannot be set up.
pub(crate) fn descend(problem: &Problem<'_>, start: &[f64]) -> Result<Option<DescentResult>, Error> {
    descend_some(problem, start, DESCENT_STEPS)
}

/// Descends from a start by at most `steps` steps; `None` if no loop near it is stable.
///
/// # Errors
/// As [`descend`].
pub(crate) fn descend_some(
    problem: &Problem<'_>,
    start: &[f64],
    steps: usize,
) -> Result<Option<DescentResult>, Error> {
    let Some(mut at) = stable_start(problem, start) else { return Ok(None) };
    let Ok(mut found) = problem.evaluate(&at) else { return Ok(None) };
    let (mut radius, mut evaluations, mut settled) = (REGION_FIRST, 1, f64::INFINITY);
    for _ in 0..steps {
        let within = |k: usize, sign: f64| {
            let range = problem.family.ranges()[k];
            let room = if sign > 0.0 { range[1] - at[k] } else { at[k] - range[0] };
            sign * room.clamp(0.0, radius)
        };
        let low: Vec<f64> = (0..at.len()).map(|k| within(k, -1.0)).collect();
        let high: Vec<f64> = (0..at.len()).map(|k| within(k, 1.0)).collect();
        let step = tangent_step(&found, &low, &high)?;
        let promised = step.as_ref().map_or(0.0, |step| merit(&found) - step.predicted);
        let Some(step) = step.filter(|_| promised > DESCENT_PROMISED) else {
            radius *= 0.25;
            if radius < REGION_LAST {
                break;
            }
            continue;
        };
        let next: Vec<f64> = at.iter().zip(&step.h).map(|(at, h)| at + h).collect();
        evaluations += 1;
        match gain(problem, &next, &found)? {
            Some((better, gained)) if gained >= STEP_TAKEN * promised => {
                (at, found) = (next, better);
                radius =
                    if gained >= STEP_GOOD * promised { (2.0 * radius).min(REGION_LARGEST) } else { radius };
            }
            _ => radius *= 0.35,
        }
        if radius < REGION_LAST {
            // The region may have shrunk at a kink that the lines of another point see.
            if merit(&found) > settled - DESCENT_WORTHWHILE {
                break;
            }
            settled = merit(&found);
            radius = REGION_AGAIN;
        }
    }
    let (objective, missed) = (found.objective(), found.worst_exceedance());
    Ok(Some(DescentResult { at, objective, missed, merit: objective + PENALTY * missed, evaluations }))
}

/// The loop at a point and by how much its merit is less; `None` if it is not less, the loop is not stable, or there is none.
fn gain(problem: &Problem<'_>, at: &[f64], before: &Evaluation) -> Result<Option<(Evaluation, f64)>, Error> {
    let Ok(found) = problem.evaluate(at) else { return Ok(None) };
    let gained = merit(before) - merit(&found);
    Ok((gained > 0.0 && problem.is_stable(at)).then_some((found, gained)))
}

/// The start with its gain lowered until the loop is stable.
fn stable_start(problem: &Problem<'_>, start: &[f64]) -> Option<Vec<f64>> {
    let ranges = problem.family.ranges();
    let mut at: Vec<f64> =
        start.iter().zip(ranges).map(|(value, range)| value.clamp(range[0], range[1])).collect();
    for _ in 0..START_HALVINGS {
        if problem.is_stable(&at) {
            return Some(at);
        }
        at = problem.family.calmer_point(&at)?;
    }
    None
}
