//! Operations on a column beyond a factor and an offset: unrolled counters, slopes, another clock, another rate.

use crate::tolerance::SAME_PLACE_SAMPLES;
use crate::tolerance::WINDOW_SHIFT_SAMPLES;
use ndarray::{Array1, ArrayView1, s};

/// Adds a turn wherever a counter has started again: a step of more than half a turn is not the machine's.
pub(crate) fn unroll(mut values: Array1<f64>, turn: f64) -> Array1<f64> {
    let (mut turns, mut last) = (0.0, f64::NAN);
    for value in values.iter_mut().filter(|v| v.is_finite()) {
        let step = *value - last;
        if step.is_finite() {
            turns -= (step / turn).round();
        }
        last = *value;
        *value += turns * turn;
    }
    values
}

/// Returns a column in which a missing sample repeats the one before; the first ones repeat the first that is there, and a column of none is 0.
pub fn repeat_last(values: &[f64]) -> Vec<f64> {
    let mut last = values.iter().copied().find(|value| value.is_finite()).unwrap_or(0.0);
    let at = |value: &f64| {
        last = if value.is_finite() { *value } else { last };
        last
    };
    values.iter().map(at).collect()
}

/// Returns central differences over the given time, at least one sample to either side; one-sided at the ends.
pub(crate) fn slopes(values: &[f64], period_s: f64, over_s: f64) -> Array1<f64> {
    let half = (0.5 * over_s / period_s).round().max(1.0) as usize;
    let last = values.len().saturating_sub(1);
    let at = |k: usize| {
        let (low, high) = (k.saturating_sub(half), (k + half).min(last));
        if high == low { 0.0 } else { (values[high] - values[low]) / ((high - low) as f64 * period_s) }
    };
    (0..values.len()).map(at).collect()
}

/// Returns the slope of what follows the values with a lag: (x - y) / lag, y' = (x - y) / lag held over each sample, y = x at
/// first.
///
/// A controller `k (r - q) / lag - k q'` of a position is, with this slope of r as its demand, the proportional and
/// integral one of the rate: `k (d - q') + k / lag (integral of d - q')`, sample for sample.
pub(crate) fn lagging_slopes(values: &[f64], period_s: f64, lag_s: f64) -> Array1<f64> {
    let mut follower = values.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
    let step = |value: &f64| {
        let slope = (value - follower) / lag_s;
        follower += if slope.is_finite() { period_s * slope } else { 0.0 };
        slope
    };
    values.iter().map(step).collect()
}

/// Returns a column that has a clock of its own on the file's clock: linear between its samples, NaN outside of them.
pub(crate) fn interpolate_on_clock(
    values: ArrayView1<'_, f64>,
    own_s: ArrayView1<'_, f64>,
    clock_s: ArrayView1<'_, f64>,
) -> Array1<f64> {
    let samples = own_s.iter().zip(values).map(|(&at_s, &value)| Sample { at_s, value });
    let known: Vec<Sample> = samples.filter(|one| one.at_s.is_finite() && one.value.is_finite()).collect();
    clock_s.mapv(|t| interpolate_samples(&known, t))
}

/// A value of a column that has a clock of its own.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at_s: f64,
    value: f64,
}

/// Interpolates linearly in samples that are sorted by time; NaN outside.
fn interpolate_samples(known: &[Sample], t: f64) -> f64 {
    let after = known.partition_point(|sample| sample.at_s < t);
    match (after.checked_sub(1).map(|before| known[before]), known.get(after)) {
        (_, Some(next)) if next.at_s == t => next.value,
        (Some(before), Some(next)) => {
            before.value + (next.value - before.value) * (t - before.at_s) / (next.at_s - before.at_s)
        }
        _ => f64::NAN,
    }
}

/// The way in which the samples of a channel are put on another clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Resampling {
    /// A value that holds until the next one: averaged over the new sample that it is held for.
    Held,
    /// A reading at one instant: averaged over a new period about its instant, or interpolated on a finer clock.
    Read,
}

/// Returns uniform values on another uniform clock that starts with them.
pub(crate) fn resample(kind: Resampling, values: &[f64], from_s: f64, to_s: f64) -> Array1<f64> {
    let values = ArrayView1::from(values);
    let ratio = to_s / from_s;
    let count = ((values.len().max(1) - 1) as f64 / ratio + SAME_PLACE_SAMPLES).floor() as usize + 1;
    let at = |k: usize| {
        let place = k as f64 * ratio;
        match (kind, ratio > 1.0) {
            (Resampling::Held, true) => mean(values, place, place + ratio),
            (Resampling::Held, false) => {
                values[((place + SAME_PLACE_SAMPLES) as usize).min(values.len() - 1)]
            }
            (Resampling::Read, true) => mean_about(values, place, 0.5 * ratio),
            (Resampling::Read, false) => interpolate_value(values, place),
        }
    };
    if values.is_empty() { Array1::default(0) } else { (0..count).map(at).collect() }
}

/// Returns the mean of the samples about a place; those at the two ends have half their weight.
fn mean_about(values: ArrayView1<'_, f64>, place: f64, half: f64) -> f64 {
    let (from, to) = (place - half, place + half);
    0.5 * (mean(values, from, to) + mean(values, from + WINDOW_SHIFT_SAMPLES, to + WINDOW_SHIFT_SAMPLES))
}

/// Returns the mean of the samples with an index from `from` up to, but not including, `to`.
fn mean(values: ArrayView1<'_, f64>, from: f64, to: f64) -> f64 {
    let index = |place: f64| (place - SAME_PLACE_SAMPLES).ceil().max(0.0) as usize;
    let first = index(from).min(values.len() - 1);
    let part = values.slice(s![first..index(to).clamp(first + 1, values.len())]);
    part.iter().sum::<f64>() / part.len() as f64
}

/// Interpolates linearly between two samples; the last value holds beyond the end.
fn interpolate_value(values: ArrayView1<'_, f64>, place: f64) -> f64 {
    let (low, last) = (place.floor() as usize, values.len() - 1);
    let (low, high) = (low.min(last), (low + 1).min(last));
    let share = place - low as f64;
    if share < SAME_PLACE_SAMPLES { values[low] } else { values[low] * (1.0 - share) + values[high] * share }
}
