//! What chance would explain: how much an effect gains, in the mean, on the noise of the sensors in the loop alone.
//!
//! The noise of the gyroscope in the loop moves the mechanism, and a rate that is a little off adds up to an angle that
//! wanders: slow motion that no replay repeats, and that an effect with a slow signature fits. The likelihood of white
//! residuals takes that for evidence. So other noise is played, and what the effect takes off it is what chance gives.

use counterpoise_linalg::{Mat, solve};
use counterpoise_models::Parameters;

use crate::bench::{Bench, Judged, Pool, Span, map};
use crate::fit::{Fit, from_variable, to_variable};
use crate::library::{Knob, Mapping};
use crate::tolerance::{CHANCES, FIT_STEP};

/// What one recording says: inner products of the columns, and of the columns with each outcome of noise.
struct Said {
    gram: Mat,
    right: Vec<Vec<f64>>,
}

/// Log-likelihood, in nats, that the newest effect of a fit would gain in the mean on other noise; 0 where the simulator has
/// none.
pub(crate) fn by_chance(bench: &dyn Bench, pool: &dyn Pool, fit: &Fit, stances: &[Judged]) -> f64 {
    let Some(newest) = fit.effects.last() else { return 0.0 };
    let knobs = newest.knobs;
    let values = &fit.values[fit.values.len() - knobs.len()..];
    let said = map(pool, stances.len(), |r| said(bench, &fit.parameters, (knobs, values), r, &stances[r]));
    let said: Vec<Said> = said.into_iter().flatten().collect();
    let Some(first) = said.first() else { return 0.0 };
    let mut gram = said.iter().skip(1).fold(first.gram.clone(), |sum, s| &sum + &s.gram);
    let ridge = 1e-9 * gram.trace().max(f64::MIN_POSITIVE);
    (0..knobs.len()).for_each(|j| gram[(j, j)] += ridge);
    let outcomes = said.iter().map(|s| s.right.len()).min().unwrap_or(0);
    let one = |k: usize| {
        let right: Vec<f64> = (0..knobs.len()).map(|j| said.iter().map(|s| s.right[k][j]).sum()).collect();
        let found = solve(&gram, &Mat::col(&right)).ok()?;
        Some(0.5 * dot(found.as_slice(), &right))
    };
    let each: Vec<f64> = (0..outcomes).filter_map(one).filter(|e: &f64| e.is_finite()).collect();
    each.iter().sum::<f64>() / each.len().max(1) as f64
}

fn said(
    bench: &dyn Bench,
    parameters: &Parameters,
    (knobs, values): (&[Knob], &[f64]),
    index: usize,
    near: &Judged,
) -> Option<Said> {
    let here = bench.misfit(parameters, index, Span::Whole, near)?;
    let weights: Vec<f64> = here.iter().map(|m| 1.0 / m.relative_rms().max(1.0)).collect();
    let column = |(knob, &value): (&Knob, &f64)| {
        let step = if knob.mapping == Mapping::Whole { 1.0 } else { 10.0 * FIT_STEP };
        let mut moved = parameters.clone();
        knob.write(&mut moved, from_variable(knob, to_variable(knob, value) + step));
        let there = bench.misfit(&moved, index, Span::Whole, near)?;
        let change = |(c, (t, h)): (usize, (&crate::bench::Misfit, &crate::bench::Misfit))| {
            let pairs = t.residual.iter().zip(&h.residual);
            pairs.map(|(a, b)| weights[c] * (a - b) / step).collect::<Vec<f64>>()
        };
        Some(there.iter().zip(&here).enumerate().flat_map(change).collect::<Vec<f64>>())
    };
    let columns: Vec<Vec<f64>> = knobs.iter().zip(values).map(column).collect::<Option<_>>()?;
    let gram = Mat::from_fn(columns.len(), columns.len(), |i, j| dot(&columns[i], &columns[j]));
    let outcome = |which: u64| {
        let moved = bench.chance(parameters, index, near, which)?;
        let weighted = moved.iter().zip(&weights).flat_map(|(channel, w)| channel.iter().map(move |d| w * d));
        let series: Vec<f64> = weighted.collect();
        Some(columns.iter().map(|c| dot(c, &series)).collect())
    };
    Some(Said { gram, right: (0..CHANCES).map_while(outcome).collect() })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
