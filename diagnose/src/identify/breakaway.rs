//! The highest friction after a reversal.

use counterpoise_models::Parameters;
use counterpoise_simulate::recording::Recording;

use super::outcome::Estimate;
use super::problem::Problem;
use super::regression::{Fit, student_95};
use super::rows::Rows;
use super::tolerance::{BREAKAWAY_DEVIATION_S, LEAST_REVERSALS};
use crate::Error;

/// Torque that the balance leaves beside weight, viscous friction and inertia, through a shorter low-pass: its highest
/// value between a reversal and the end of presliding, mean over all reversals; `before` is the project's. None where
/// there are too few.
pub fn breakaway(
    p: &Parameters,
    states: &[&[Recording]],
    problem: &Problem,
    fit: &Fit,
    before: f64,
) -> Result<Option<Estimate>, Error> {
    // the gain curve is left out: a reversal is over before a small control lasts
    let short = Problem::through(p, states, &[], BREAKAWAY_DEVIATION_S)?;
    let mut value = fit.value[..problem.layout.knot(0)].to_vec();
    value[problem.layout.coulomb()] = 0.0;
    let peaks: Vec<f64> = short
        .parts
        .iter()
        .enumerate()
        .flat_map(|(index, part)| peaks(&part.rows, &short.residual(index, &value)))
        .collect();
    if peaks.len() < LEAST_REVERSALS {
        return Ok(None);
    }
    let count = peaks.len() as f64;
    let mean = peaks.iter().sum::<f64>() / count;
    let spread = (peaks.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    let half = student_95(count - 1.0) * spread / count.sqrt();
    Ok(Some(Estimate::new(mean, half, before)))
}

/// The peak after each reversal that ends in sliding; the first stretch of a recording is no reversal.
fn peaks(rows: &Rows, friction: &[f64]) -> Vec<f64> {
    let mut out = Vec::new();
    let mut peak: Option<f64> = None;
    for k in 1..friction.len() {
        let reversed = rows.direction[k] != rows.direction[k - 1];
        if reversed {
            peak = Some(f64::NEG_INFINITY);
        }
        if !rows.turning[k] {
            out.extend(peak.take().filter(|x| x.is_finite()));
        }
        peak = peak.map(|x| x.max(friction[k] * rows.direction[k]));
    }
    out
}
