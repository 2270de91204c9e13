//! How well a model fits the recordings, channel by channel.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::fitting::score::Score;

/// Fit of one channel over all recordings: the roots of the mean squares of what each recording has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PooledFit {
    /// RMS of the residual.
    pub rms_error: f64,
    /// Noise floor: the RMS of the residual of a perfect model.
    pub floor: f64,
}

impl PooledFit {
    /// Returns the pooled RMS of the residual over the pooled noise floor.
    pub fn pooled_residual_over_floor(&self) -> f64 {
        self.rms_error / self.floor
    }
}

/// Fit of every channel, over all recordings.
pub type Channels = BTreeMap<&'static str, PooledFit>;

/// Returns the largest RMS error over its noise floor of all channels; 0 without channels.
pub(crate) fn largest_ratio(channels: &Channels) -> f64 {
    channels.values().map(PooledFit::pooled_residual_over_floor).fold(0.0, f64::max)
}

/// Returns the RMS over the recordings, channel by channel.
pub(crate) fn fits_by_channel(score: &Score) -> Channels {
    let mut sums: BTreeMap<&'static str, (f64, f64, f64)> = BTreeMap::new();
    for cell in &score.cells {
        let sum = sums.entry(cell.channel.name()).or_default();
        *sum = (sum.0 + cell.rms_error.powi(2), sum.1 + cell.floor.powi(2), sum.2 + 1.0);
    }
    let fit = |(e, f, n): (f64, f64, f64)| PooledFit { rms_error: (e / n).sqrt(), floor: (f / n).sqrt() };
    sums.into_iter().map(|(channel, sum)| (channel, fit(sum))).collect()
}
