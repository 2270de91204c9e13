//! A recording: channels of one machine on one uniform clock.

use std::collections::BTreeMap;
use std::ops::Range;

use ndarray::Array1;

use crate::tolerance::FEWEST_PERIODS;
use crate::{Channel, Error, Remark};

/// Channels of one experiment on one uniform clock, in SI units; NaN where a sample is missing.
///
/// A channel that was not recorded is absent. Without a platform gyroscope the platform is taken to be at rest, without an
/// accelerometer it is taken not to heave.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// Name, for reports.
    pub name: String,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Time of the first sample on the file's clock, s.
    pub start_s: f64,
    /// What the user of the recording should know.
    pub remarks: Vec<Remark>,
    /// The samples of each channel, contiguous in memory.
    signals: BTreeMap<Channel, Array1<f64>>,
}

impl Recording {
    /// Returns a recording without channels, whose first sample is at 0 s.
    pub fn new(name: impl Into<String>, sample_period_s: f64) -> Self {
        Self { name: name.into(), sample_period_s, ..Self::default() }
    }

    /// Returns the recording under another name.
    #[must_use]
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Returns the recording with the samples of a channel, which replace those that it had.
    #[must_use]
    pub fn with(mut self, channel: Channel, samples: impl Into<Array1<f64>>) -> Self {
        self.set(channel, samples);
        self
    }

    /// Sets the samples of a channel and returns those that it had.
    pub fn set(&mut self, channel: Channel, samples: impl Into<Array1<f64>>) -> Option<Array1<f64>> {
        let samples = samples.into();
        let contiguous =
            if samples.is_standard_layout() { samples } else { samples.iter().copied().collect() };
        self.signals.insert(channel, contiguous)
    }

    /// Removes a channel and returns its samples; `None` if it was not recorded.
    pub fn remove(&mut self, channel: Channel) -> Option<Array1<f64>> {
        self.signals.remove(&channel)
    }

    /// Returns whether a channel was recorded.
    pub fn has(&self, channel: Channel) -> bool {
        self.signals.contains_key(&channel)
    }

    /// Returns the samples of a channel; `None` if it was not recorded.
    pub fn samples(&self, channel: Channel) -> Option<&[f64]> {
        self.signals.get(&channel)?.as_slice()
    }

    /// Returns the samples of a channel, to be changed; `None` if it was not recorded.
    pub fn samples_mut(&mut self, channel: Channel) -> Option<&mut [f64]> {
        self.signals.get_mut(&channel)?.as_slice_mut()
    }

    /// Returns the recorded channels and their samples, in the order of [`Channel::ALL`].
    pub fn channels(&self) -> impl Iterator<Item = (Channel, &[f64])> {
        self.signals.iter().filter_map(|(channel, samples)| Some((*channel, samples.as_slice()?)))
    }

    /// Returns the number of samples: that of the longest channel.
    pub fn len(&self) -> usize {
        self.signals.values().map(Array1::len).max().unwrap_or(0)
    }

    /// Returns whether no channel has a sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the samples `range` of every channel, or as many of them as a shorter channel has. Name and remarks are kept.
    pub fn part(&self, range: Range<usize>) -> Self {
        let cut = |samples: &[f64]| {
            let end = range.end.min(samples.len());
            Array1::from(samples[range.start.min(end)..end].to_vec())
        };
        Self {
            name: self.name.clone(),
            sample_period_s: self.sample_period_s,
            start_s: self.start_s + range.start as f64 * self.sample_period_s,
            remarks: self.remarks.clone(),
            signals: self.channels().map(|(channel, samples)| (channel, cut(samples))).collect(),
        }
    }

    /// Returns the part between two times, s from the first sample, with the times in its name.
    ///
    /// # Errors
    /// [`Error::Window`] if the recording does not cover it.
    pub fn window(&self, [from_s, to_s]: [f64; 2]) -> Result<Self, Error> {
        let length = self.channels().next().map_or(0, |(_, samples)| samples.len());
        let (from, to) = ((from_s / self.sample_period_s).round(), (to_s / self.sample_period_s).round());
        if from >= 0.0 && to > from + FEWEST_PERIODS && to <= length as f64 {
            let part = self.part(from as usize..to as usize);
            return Ok(Self { name: format!("{}, {from_s} to {to_s} s", self.name), ..part });
        }
        let length_s = length as f64 * self.sample_period_s;
        Err(Error::Window { file: self.name.clone(), from_s, to_s, length_s })
    }
}
