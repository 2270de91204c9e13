//! What is made of a column beyond a factor and an offset: unrolled counters, slopes, another clock.

use super::{Channel, RecordingError};

/// Adds a turn wherever a counter has started anew: a step of more than half a turn is none of the machine's.
pub(super) fn unroll(values: &mut [f64], turn: f64) {
    let (mut turns, mut last) = (0.0, f64::NAN);
    for value in values.iter_mut().filter(|v| v.is_finite()) {
        let step = *value - last;
        if step.is_finite() {
            turns -= (step / turn).round();
        }
        last = *value;
        *value += turns * turn;
    }
}

/// Central differences over the given time, at least one sample to either side; one-sided at the ends.
pub(super) fn slopes(values: &[f64], period_s: f64, over_s: f64) -> Vec<f64> {
    let half = (0.5 * over_s / period_s).round().max(1.0) as usize;
    let last = values.len().saturating_sub(1);
    let at = |k: usize| {
        let (low, high) = (k.saturating_sub(half), (k + half).min(last));
        if high == low { 0.0 } else { (values[high] - values[low]) / ((high - low) as f64 * period_s) }
    };
    (0..values.len()).map(at).collect()
}

/// Slope of what follows the values with a lag: (x - y) / lag, y' = (x - y) / lag held over each sample, y = x at first.
///
/// A controller `k (r - q) / lag - k q'` of a position is, with this slope of r for its demand, the proportional and
/// integral one of the rate: `k (d - q') + k / lag (integral of d - q')`, sample for sample.
pub(super) fn lagging_slopes(values: &[f64], period_s: f64, lag_s: f64) -> Vec<f64> {
    let mut follower = values.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
    let step = |value: &f64| {
        let slope = (value - follower) / lag_s;
        follower += if slope.is_finite() { period_s * slope } else { 0.0 };
        slope
    };
    values.iter().map(step).collect()
}

/// A column with a clock of its own on the file's clock: linear in between, missing outside of what it covers.
pub(super) fn on_clock(values: &[f64], own_s: &[f64], clock_s: &[f64]) -> Vec<f64> {
    let known: Vec<(f64, f64)> = own_s
        .iter()
        .copied()
        .zip(values.iter().copied())
        .filter(|(t, v)| t.is_finite() && v.is_finite())
        .collect();
    clock_s.iter().map(|t| between(&known, *t)).collect()
}

/// Linear interpolation in points that are sorted by time; NaN outside.
fn between(known: &[(f64, f64)], t: f64) -> f64 {
    let after = known.partition_point(|(at, _)| *at < t);
    match (after.checked_sub(1).map(|before| known[before]), known.get(after)) {
        (_, Some((at, value))) if *at == t => *value,
        (Some((t0, v0)), Some((t1, v1))) => v0 + (v1 - v0) * (t - t0) / (t1 - t0),
        _ => f64::NAN,
    }
}

/// Uniform values on another uniform clock that starts with them. What is held (control, demand) keeps its value until
/// the next one comes and is averaged over the new sample that it is held for; what is read is averaged over a new period
/// about its instant. On a finer clock what is read is interpolated.
pub(super) fn resampled(channel: Channel, values: &[f64], from_s: f64, to_s: f64) -> Vec<f64> {
    let ratio = to_s / from_s;
    let count = ((values.len().max(1) - 1) as f64 / ratio + 1e-9).floor() as usize + 1;
    let held = matches!(channel, Channel::Control | Channel::Demand);
    let at = |k: usize| {
        let place = k as f64 * ratio;
        match (held, ratio > 1.0) {
            (true, true) => mean(values, place, place + ratio),
            (true, false) => values[((place + 1e-9) as usize).min(values.len() - 1)],
            (false, true) => about(values, place, 0.5 * ratio),
            (false, false) => linear(values, place),
        }
    };
    if values.is_empty() { Vec::new() } else { (0..count).map(at).collect() }
}

/// Mean of the samples about a place, those at the very ends with half their weight.
fn about(values: &[f64], place: f64, half: f64) -> f64 {
    let (from, to) = (place - half, place + half);
    0.5 * (mean(values, from, to) + mean(values, from + 1e-6, to + 1e-6))
}

/// Mean of the samples with an index from `from` up to, but not including, `to`.
fn mean(values: &[f64], from: f64, to: f64) -> f64 {
    let index = |place: f64| (place - 1e-9).ceil().max(0.0) as usize;
    let first = index(from).min(values.len() - 1);
    let part = &values[first..index(to).clamp(first + 1, values.len())];
    part.iter().sum::<f64>() / part.len() as f64
}

fn linear(values: &[f64], place: f64) -> f64 {
    let (low, last) = (place.floor() as usize, values.len() - 1);
    let (low, high) = (low.min(last), (low + 1).min(last));
    let share = place - low as f64;
    if share < 1e-9 { values[low] } else { values[low] * (1.0 - share) + values[high] * share }
}

/// A part of a recording, from one time to another, in samples.
pub(super) fn samples_of(
    file: &str,
    [from_s, to_s]: [f64; 2],
    period_s: f64,
    length: usize,
) -> Result<std::ops::Range<usize>, RecordingError> {
    let (from, to) = ((from_s / period_s).round(), (to_s / period_s).round());
    if from >= 0.0 && to > from + 2.0 && to <= length as f64 {
        return Ok(from as usize..to as usize);
    }
    let length_s = length as f64 * period_s;
    Err(RecordingError::Window { file: file.to_owned(), from_s, to_s, length_s })
}
