//! The period with which a motion repeats itself.

use super::statistics::subtract_mean;
use crate::tolerance::{REPEATS, SHORTEST_LAG_SHARE};

/// Samples that are correlated at most: longer series are averaged in blocks first.
const SAMPLES: usize = 4000;

/// Returns the frequency with which a series repeats itself, Hz: of its fundamental, however strong its harmonics are. `None` if it does not
/// repeat itself at least twice.
///
/// The lag is where the normalised autocorrelation has its first peak after a change of sign, by a parabola through three points.
pub fn fundamental_hz(samples: &[f64], period_s: f64) -> Option<f64> {
    let block = samples.len().div_ceil(SAMPLES).max(1);
    let means: Vec<f64> = samples.chunks_exact(block).map(super::mean).collect();
    let x = subtract_mean(&means);
    let size = |part: &[f64]| part.iter().map(|v| v * v).sum::<f64>();
    let correlation = |lag: usize| {
        let (early, late) = (&x[..x.len() - lag], &x[lag..]);
        let product: f64 = early.iter().zip(late).map(|(a, b)| a * b).sum();
        product / (size(early) * size(late)).sqrt()
    };
    let all: Vec<f64> = (0..=x.len() / 2).map(correlation).collect();
    let first = all.iter().position(|r| *r <= 0.0)?;
    let is_peak = |k: &usize| all[*k] >= all[k - 1] && all[*k] >= all[k + 1];
    let peaks: Vec<usize> = (first.max(1)..all.len().saturating_sub(1)).filter(is_peak).collect();
    let most = peaks.iter().map(|k| all[*k]).fold(REPEATS, f64::max);
    let lag = *peaks.iter().find(|k| all[**k] >= (SHORTEST_LAG_SHARE * most).max(REPEATS))?;
    let bend = all[lag - 1] - 2.0 * all[lag] + all[lag + 1];
    let shift = if bend < 0.0 { 0.5 * (all[lag - 1] - all[lag + 1]) / bend } else { 0.0 };
    Some(1.0 / ((lag as f64 + shift) * block as f64 * period_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn series(at: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..10_000).map(|k| at(f64::from(k) * 1e-3)).collect()
    }

    #[test]
    fn the_fundamental_is_found_below_strong_harmonics() {
        for hz in [0.7, 6.3, 19.0] {
            let wave = series(|t| (TAU * hz * t).sin() + 1.5 * (TAU * 3.0 * hz * t + 1.0).sin());
            let found = fundamental_hz(&wave, 1e-3).unwrap_or(0.0);
            assert!((found / hz - 1.0).abs() < 2e-3, "{hz}: {found}");
        }
    }

    #[test]
    fn a_motion_that_does_not_repeat_itself_has_none() {
        assert_eq!(fundamental_hz(&series(|t| (-t).exp()), 1e-3), None);
        assert_eq!(fundamental_hz(&series(|t| (1e4 * t * t).sin()), 1e-3), None);
        assert_eq!(fundamental_hz(&[], 1e-3), None);
        assert_eq!(fundamental_hz(&[1.0; 100], 1e-3), None);
    }
}
