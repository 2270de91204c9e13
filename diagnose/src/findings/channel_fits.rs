//! The fit of a model to the recordings, channel by channel.

use std::collections::BTreeMap;

use counterpoise_recordings::Channel;
use serde::{Serialize, Serializer};

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

/// The fit of one channel by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedChannelFit {
    /// The channel.
    pub channel: Channel,
    /// Fit.
    pub fit: PooledFit,
}

/// Fit of every channel, over all recordings, in the order of the channels' names: tables and results list them so.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PooledFits {
    fits: Vec<NamedChannelFit>,
}

impl PooledFits {
    /// Returns the fit of a channel; `None` if it was not scored.
    pub fn get(&self, channel: Channel) -> Option<&PooledFit> {
        self.iter().find(|(each, _)| *each == channel).map(|(_, fit)| fit)
    }

    /// Returns the fit of a channel, to be changed; `None` if it was not scored.
    pub fn get_mut(&mut self, channel: Channel) -> Option<&mut PooledFit> {
        self.fits.iter_mut().find(|each| each.channel == channel).map(|each| &mut each.fit)
    }

    /// Returns the channels with their fits, in the order of the channels' names.
    pub fn iter(&self) -> impl Iterator<Item = (Channel, &PooledFit)> {
        self.fits.iter().map(|each| (each.channel, &each.fit))
    }

    /// Returns the fits, in the order of the channels' names.
    pub fn values(&self) -> impl Iterator<Item = &PooledFit> {
        self.iter().map(|(_, fit)| fit)
    }
}

impl FromIterator<NamedChannelFit> for PooledFits {
    fn from_iter<I: IntoIterator<Item = NamedChannelFit>>(fits: I) -> Self {
        let mut fits: Vec<NamedChannelFit> = fits.into_iter().collect();
        fits.sort_by_key(|each| each.channel.name());
        Self { fits }
    }
}

impl Serialize for PooledFits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter().map(|(channel, fit)| (channel.name(), fit)))
    }
}

/// Returns the largest RMS error over its noise floor of all channels; 0 without channels.
pub(crate) fn largest_ratio(channels: &PooledFits) -> f64 {
    channels.values().map(PooledFit::pooled_residual_over_floor).fold(0.0, f64::max)
}

/// Returns the RMS over the recordings, channel by channel.
pub(crate) fn fits_by_channel(score: &Score) -> PooledFits {
    let mut sums: BTreeMap<Channel, (f64, f64, f64)> = BTreeMap::new();
    for cell in &score.cells {
        let sum = sums.entry(cell.channel).or_default();
        *sum = (sum.0 + cell.rms_error.powi(2), sum.1 + cell.floor.powi(2), sum.2 + 1.0);
    }
    let fit = |(e, f, n): (f64, f64, f64)| PooledFit { rms_error: (e / n).sqrt(), floor: (f / n).sqrt() };
    sums.into_iter().map(|(channel, sum)| NamedChannelFit { channel, fit: fit(sum) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_list_the_channels_in_the_order_of_their_names() {
        let fit = PooledFit { rms_error: 1.0, floor: 0.5 };
        let scored = [Channel::Control, Channel::HubRate, Channel::MotorRate, Channel::HubPosition];
        let fits: PooledFits = scored.into_iter().map(|channel| NamedChannelFit { channel, fit }).collect();
        let names: Vec<&str> = fits.iter().map(|(channel, _)| channel.name()).collect();
        assert_eq!(names, ["control", "hub_position", "hub_rate", "motor_rate"]);
    }
}
