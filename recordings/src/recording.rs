//! A recording: channels of one machine on one uniform clock.

use std::collections::BTreeMap;
use std::ops::Range;

use ndarray::{Array1, Array2, ArrayView2, Axis, ShapeBuilder as _, s};

use crate::tolerance::FEWEST_PERIODS;
use crate::{Channel, Error, Remark};

/// Channels of one experiment on one uniform clock, in SI units; NaN if a sample is missing.
///
/// A channel that was not recorded is absent. Without a platform gyroscope the platform is taken to be at rest, without an
/// accelerometer it is taken not to heave.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// Name, for reports.
    pub name: String,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Time of the first sample on the file's clock, s.
    pub start_s: f64,
    /// Remarks for the user of the recording.
    pub remarks: Vec<Remark>,
    /// The samples, time x channel, each column contiguous in memory; a channel that is shorter than others ends in NaN.
    signals: Array2<f64>,
    /// The column of each channel that was recorded.
    columns: BTreeMap<Channel, usize>,
}

impl PartialEq for Recording {
    /// Compares everything but the order in which the channels were added.
    fn eq(&self, other: &Self) -> bool {
        let plain = |one: &Self| (one.sample_period_s, one.start_s);
        (&self.name, &self.remarks, plain(self)) == (&other.name, &other.remarks, plain(other))
            && self.channels().eq(other.channels())
    }
}

impl Recording {
    /// Returns a recording without channels, whose first sample is at 0 s.
    pub fn new(name: impl Into<String>, sample_period_s: f64) -> Self {
        Self { name: name.into(), sample_period_s, ..Self::default() }
    }

    /// Returns a recording of signals, time x channel, with a channel for each column, whose first sample is at 0 s. The columns must be
    /// contiguous in memory, as those of [`stack_columns`](crate::clock::stack_columns) are.
    pub(crate) fn from_signals(
        name: impl Into<String>,
        sample_period_s: f64,
        channels: &[Channel],
        signals: Array2<f64>,
    ) -> Self {
        let columns = channels.iter().copied().zip(0..).collect();
        Self { signals, columns, ..Self::new(name, sample_period_s) }
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

    /// Sets the samples of a channel and returns those that it had. If the channels differ in length, the shorter ones end in NaN.
    pub fn set(&mut self, channel: Channel, samples: impl Into<Array1<f64>>) -> Option<Array1<f64>> {
        let samples = samples.into();
        let before = self.columns.get(&channel).map(|column| self.signals.column(*column).to_owned());
        let count = self.columns.len();
        let column = *self.columns.entry(channel).or_insert(count);
        let has_others = self.columns.len() > 1;
        let rows = if has_others { samples.len().max(self.signals.nrows()) } else { samples.len() };
        if self.signals.dim() != (rows, self.columns.len()) {
            self.signals = resize_array(self.signals.view(), [rows, self.columns.len()]);
        }
        let mut written = self.signals.column_mut(column);
        written.fill(f64::NAN);
        written.slice_mut(s![..samples.len()]).assign(&samples);
        before
    }

    /// Removes a channel and returns its samples; `None` if it was not recorded.
    pub fn remove(&mut self, channel: Channel) -> Option<Array1<f64>> {
        let removed = self.columns.remove(&channel)?;
        let samples = self.signals.column(removed).to_owned();
        self.columns.values_mut().filter(|column| **column > removed).for_each(|column| *column -= 1);
        self.signals.remove_index(Axis(1), removed);
        Some(samples)
    }

    /// Returns whether a channel was recorded.
    pub fn has(&self, channel: Channel) -> bool {
        self.columns.contains_key(&channel)
    }

    /// Returns the samples of a channel; `None` if it was not recorded.
    pub fn samples(&self, channel: Channel) -> Option<&[f64]> {
        self.signals.column(*self.columns.get(&channel)?).to_slice()
    }

    /// Returns the samples of a channel, to be changed; `None` if it was not recorded.
    pub fn samples_mut(&mut self, channel: Channel) -> Option<&mut [f64]> {
        self.signals.column_mut(*self.columns.get(&channel)?).into_slice()
    }

    /// Returns the recorded channels and their samples, in the order of [`Channel::ALL`].
    pub fn channels(&self) -> impl Iterator<Item = (Channel, &[f64])> {
        self.columns.keys().filter_map(|channel| Some((*channel, self.samples(*channel)?)))
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        if self.columns.is_empty() { 0 } else { self.signals.nrows() }
    }

    /// Returns whether no channel has a sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the samples `range` of every channel, or as many of them as were recorded. Name and remarks are kept.
    pub fn part(&self, range: Range<usize>) -> Self {
        let end = range.end.min(self.len());
        let view = self.signals.slice(s![range.start.min(end)..end, ..]);
        Self {
            name: self.name.clone(),
            sample_period_s: self.sample_period_s,
            start_s: self.start_s + range.start as f64 * self.sample_period_s,
            remarks: self.remarks.clone(),
            signals: resize_array(view, [view.nrows(), view.ncols()]),
            columns: self.columns.clone(),
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

/// Returns signals in an array of another size whose columns are contiguous: NaN in what is added.
fn resize_array(signals: ArrayView2<'_, f64>, [rows, columns]: [usize; 2]) -> Array2<f64> {
    let mut out = Array2::from_elem((rows, columns).f(), f64::NAN);
    let kept = s![..rows.min(signals.nrows()), ..columns.min(signals.ncols())];
    out.slice_mut(kept).assign(&signals.slice(kept));
    out
}
