//! Tests of a residual: its correlation with itself and with the signals that drive the machine.
//!
//! A model that explains a recording leaves only noise, which is white and independent of every signal. The bands are Bartlett's
//! (1946): for series that are themselves correlated in time, the correlation of two independent ones scatters by `(1/N) sum over
//! lags of r_x r_y`, not by `1/N`.

use crate::recording::series::rms;
use crate::tolerance::fitting::{BAND_95, WHITENESS_LAGS};
use counterpoise_recordings::Channel;

/// The correlations of one residual.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualTest {
    /// Autocorrelation at lags of 0, 1, ... samples.
    pub autocorrelation: Vec<f64>,
    /// Half width of its 95 % band if the residual were white.
    pub band: f64,
    /// Share of the lags outside that band; 0.05 of a white residual.
    pub outside: f64,
    /// The correlation with each signal, where it is largest against its band.
    pub cross: Vec<CrossCorrelation>,
}

/// The correlation of a residual with a signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossCorrelation {
    /// The signal.
    pub with: Channel,
    /// Largest value over the lags, with its sign.
    pub largest: f64,
    /// Lag of the residual behind the signal there, samples.
    pub lag: isize,
    /// Half width of the 95 % band if they were independent.
    pub band: f64,
}

impl CrossCorrelation {
    /// Returns the largest correlation in units of its band: above 1 the residual depends on the signal.
    pub fn size(&self) -> f64 {
        self.largest.abs() / self.band
    }
}

/// A signal that drives the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredSignal<'a> {
    /// Channel.
    pub channel: Channel,
    /// Values, one a sample of the residual.
    pub values: &'a [f64],
}

/// Tests a residual against itself and against signals of its length; returns `None` if it is too short for the lags, constant, or
/// not finite.
pub fn test_residual(residual: &[f64], signals: &[MeasuredSignal<'_>]) -> Option<ResidualTest> {
    let residual = standard(residual).filter(|r| r.len() > 4 * WHITENESS_LAGS)?;
    let own = correlations(&residual, &residual);
    let band = BAND_95 / (residual.len() as f64).sqrt();
    let outside = own[1..].iter().filter(|r| r.abs() > band).count() as f64 / WHITENESS_LAGS as f64;
    let cross = signals.iter().filter_map(|signal| cross(&residual, &own, signal)).collect();
    Some(ResidualTest { autocorrelation: own, band, outside, cross })
}

fn cross(residual: &[f64], own: &[f64], signal: &MeasuredSignal<'_>) -> Option<CrossCorrelation> {
    let with = signal.channel;
    let signal = standard(signal.values).filter(|s| s.len() == residual.len())?;
    let theirs = correlations(&signal, &signal);
    let memory = 1.0 + 2.0 * own[1..].iter().zip(&theirs[1..]).map(|(a, b)| a * b).sum::<f64>();
    let band = BAND_95 * (memory.max(1.0) / residual.len() as f64).sqrt();
    let (behind, ahead) = (correlations(&signal, residual), correlations(residual, &signal));
    let lags = behind.iter().enumerate().map(|(k, r)| (k.cast_signed(), *r));
    let lags = lags.chain(ahead.iter().enumerate().map(|(k, r)| (-k.cast_signed(), *r)));
    let (lag, largest) = lags.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(CrossCorrelation { with, largest, lag, band })
}

/// Returns the series less its mean, over its deviation; `None` if it has no deviation.
fn standard(series: &[f64]) -> Option<Vec<f64>> {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    let centred: Vec<f64> = series.iter().map(|v| v - mean).collect();
    let deviation = rms(&centred);
    (deviation.is_finite() && deviation > 0.0).then(|| centred.iter().map(|v| v / deviation).collect())
}

/// Returns the correlation of `x[k]` with `y[k + lag]`, lags from 0.
fn correlations(x: &[f64], y: &[f64]) -> Vec<f64> {
    let at = |lag: usize| x.iter().zip(&y[lag..]).map(|(a, b)| a * b).sum::<f64>() / x.len() as f64;
    (0..=WHITENESS_LAGS).map(at).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn noise(count: usize, mut seed: u64) -> Vec<f64> {
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn white_noise_passes_and_what_follows_a_signal_does_not() {
        let (white, signal) = (noise(4000, 1), noise(4000, 2));
        let found = test_residual(&white, &[MeasuredSignal { channel: Channel::MotorRate, values: &signal }])
            .unwrap();
        assert!(found.outside < 0.15, "{}", found.outside);
        assert!(found.cross[0].size() < 2.0, "{:?}", found.cross);
        let follows: Vec<f64> = (0..4000).map(|k| white[k] + 0.3 * signal[k.saturating_sub(7)]).collect();
        let found =
            test_residual(&follows, &[MeasuredSignal { channel: Channel::MotorRate, values: &signal }])
                .unwrap();
        assert!(found.cross[0].size() > 5.0 && found.cross[0].lag == 7, "{:?}", found.cross);
    }

    #[test]
    fn slow_independent_series_are_not_taken_for_dependent() {
        let slow = |seed| {
            let mut state = 0.0;
            let step = |v: f64| {
                state = 0.9 * state + v;
                state
            };
            noise(8000, seed).into_iter().map(step).collect::<Vec<f64>>()
        };
        let found =
            test_residual(&slow(3), &[MeasuredSignal { channel: Channel::MotorRate, values: &slow(4) }])
                .unwrap();
        assert!(found.outside > 0.15 && found.cross[0].size() < 2.0, "{:?}", found.cross);
    }

    #[test]
    fn nothing_is_said_of_a_constant() {
        assert!(test_residual(&[1.0; 1000], &[]).is_none());
    }
}
