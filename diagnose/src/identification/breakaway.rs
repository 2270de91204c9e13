//! The highest friction after a reversal.

use counterpoise_models::Parameters;
use counterpoise_recordings::Recording;

use super::outcome::Estimate;
use super::problem::IdentificationProblem;
use super::regression::{RegressionFit, student_95};
use super::rows::Rows;
use crate::Error;
use crate::tolerance::identification::{BREAKAWAY_DEVIATION_S, LEAST_REVERSALS};

/// Returns the Coulomb level plus the mean excess of friction after a reversal, through a shorter low-pass; `None` if there are too
/// few reversals. The excess is the highest friction from the reversal to the end of presliding, less the highest in as long a
/// stretch of sliding that follows, so that noise cancels. `before` is the project's value.
pub fn identify_breakaway(
    p: &Parameters,
    states: &[&[Recording]],
    problem: &IdentificationProblem,
    fit: &RegressionFit,
    before: f64,
) -> Result<Option<Estimate>, Error> {
    let short = IdentificationProblem::with_low_pass(p, states, &problem.knots_v, BREAKAWAY_DEVIATION_S)?;
    let excesses: Vec<f64> = short
        .parts
        .iter()
        .enumerate()
        .flat_map(|(index, part)| excesses(&part.rows, &short.residual(index, &fit.value)))
        .collect();
    if excesses.len() < LEAST_REVERSALS {
        return Ok(None);
    }
    let count = excesses.len() as f64;
    let mean = excesses.iter().sum::<f64>() / count;
    let spread = (excesses.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    let half = student_95(count - 1.0) * spread / count.sqrt();
    Ok(Some(Estimate::new(fit.value[problem.layout.coulomb()] + mean, half, before)))
}

/// Returns each reversal's peak above the peak of the sliding that follows; the start of a recording is no reversal.
fn excesses(rows: &Rows, left: &[f64]) -> Vec<f64> {
    let direction = rows.direction();
    let reversed = |k: &usize| direction[*k] != direction[*k - 1];
    (1..left.len()).filter(reversed).filter_map(|start| excess(rows, left, start)).collect()
}

/// Returns the excess of one reversal; `None` if the motion reverses again before as long a stretch of sliding is over.
fn excess(rows: &Rows, left: &[f64], start: usize) -> Option<f64> {
    let directions = rows.direction();
    let direction = directions[start];
    let until = |from: usize, stops: &dyn Fn(usize) -> bool| (from..left.len()).find(|k| stops(*k));
    let slides = until(start, &|k| !rows.turning[k])?;
    let end = slides + (slides - start);
    let steady = |k: usize| directions[k] == direction && (k < slides || !rows.turning[k]);
    if end > left.len() || !(start..end).all(steady) {
        return None;
    }
    let peak =
        |range: std::ops::Range<usize>| range.map(|k| direction * left[k]).fold(f64::NEG_INFINITY, f64::max);
    Some(peak(start..slides) - peak(slides..end))
}
