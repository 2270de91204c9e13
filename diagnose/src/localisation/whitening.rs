//! Whitening: a series of known spectrum made white, so that its samples count equally.
//!
//! The spectrum is that of an autoregression, from the autocovariance of examples (Levinson 1947, Durbin 1960).

use crate::tolerance::localisation::{WHITENING_ORDER, WHITENING_REGULARITY};

/// A filter that makes a series white, of unit variance.
pub(crate) struct Whitener {
    taps: [f64; WHITENING_ORDER + 1],
}

impl Whitener {
    /// Fits the filter to examples.
    pub fn of(examples: &[Vec<f64>]) -> Self {
        let mut covariance = [0.0; WHITENING_ORDER + 1];
        for (lag, sum) in covariance.iter_mut().enumerate() {
            let pairs = |e: &Vec<f64>| e.iter().zip(e.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>();
            *sum = examples.iter().map(pairs).sum();
        }
        let count: usize = examples.iter().map(Vec::len).sum();
        let floor = f64::MIN_POSITIVE.sqrt();
        covariance[0] = covariance[0] * (1.0 + WHITENING_REGULARITY) + floor;
        let (taps, left) = levinson(&covariance);
        let size = (left / count.max(1) as f64).max(floor).sqrt();
        Self { taps: taps.map(|tap| tap / size) }
    }

    /// Returns the whitened series, without its first [`WHITENING_ORDER`] samples.
    pub fn whiten(&self, series: &[f64]) -> Vec<f64> {
        let at = |window: &[f64]| window.iter().rev().zip(&self.taps).map(|(x, tap)| x * tap).sum();
        series.windows(WHITENING_ORDER + 1).map(at).collect()
    }
}

/// Returns the coefficients of the prediction error, and its variance, for an autocovariance.
fn levinson(covariance: &[f64; WHITENING_ORDER + 1]) -> ([f64; WHITENING_ORDER + 1], f64) {
    let mut taps = [0.0; WHITENING_ORDER + 1];
    taps[0] = 1.0;
    let mut left = covariance[0];
    for order in 1..=WHITENING_ORDER {
        let overlap: f64 = (0..order).map(|k| taps[k] * covariance[order - k]).sum();
        let reflection = -overlap / left;
        let before = taps;
        (1..=order).for_each(|k| taps[k] = before[k] + reflection * before[order - k]);
        left *= 1.0 - reflection * reflection;
    }
    (taps, left)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_first_order_process_becomes_white() {
        let (mut state, mut seed) = (0.0, 1u64);
        let mut noise = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            3f64.sqrt() * ((seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0)
        };
        let series: Vec<f64> = (0..50_000)
            .map(|_| {
                state = 0.95 * state + 0.1 * noise();
                state
            })
            .collect();
        let white = Whitener::of(std::slice::from_ref(&series)).whiten(&series);
        assert!((crate::recording::series::rms(&white) - 1.0).abs() < 0.02);
        assert!(crate::recording::series::correlation_time(&white) < 1.1);
    }
}
