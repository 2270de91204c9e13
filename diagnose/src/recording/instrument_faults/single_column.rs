//! Faults that one column shows by itself: a coarse converter, a lower sampling rate, standstill, a limit.

use crate::tolerance::recording::{
    CLIPPED_SHARE, COARSER_CONVERTER, CONVERTER_LIMIT_SHARE, EVEN_RUNS_SHARE, FEWEST_RUNS, FLAT_TOP_SAMPLES,
    FLAT_TOP_STEPS, GRID_DEVIATION, GRID_DIFFERENCES, GRID_SHARE, GRID_STEPS, NOISY_COLUMN_SHARE,
    STUCK_READINGS,
};
use counterpoise_models::Parameters;

use super::column::RecorderColumn;
use super::fault::FaultKind;
use crate::tolerance::recording::SAME_READING;

/// A run of equal readings.
#[derive(Debug, Clone, Copy)]
struct Run {
    from: usize,
    length: usize,
    value: f64,
}

/// A fault of a column, with the samples that are no readings.
pub(super) struct ColumnFault {
    pub kind: FaultKind,
    pub useless: Vec<usize>,
}

/// Detects the faults that a column shows by itself.
pub(super) fn find_faults(
    column: RecorderColumn,
    series: &[f64],
    base: &Parameters,
    period_s: f64,
) -> Vec<ColumnFault> {
    let runs = runs(series);
    let sensor = RecorderColumn::SENSORS.contains(&column);
    // a sensor that is stated to be slower than the controller holds its readings as it should
    let stated = column.sensor(base).map_or(1, |one| one.samples_between_readings(period_s));
    let is_stated = |fault: &ColumnFault| fault.kind == FaultKind::Held { samples: stated };
    match detect_repeated_readings(&runs).filter(|_| sensor) {
        Some(fault) if is_stated(&fault) => return Vec::new(),
        Some(fault) => return vec![fault],
        None => {}
    }
    let own = column.converter_limit(base).map_or(f64::INFINITY, |limit| CONVERTER_LIMIT_SHARE * limit);
    let flat = detect_clipping(series, &runs, own).filter(|_| column != RecorderColumn::Demand);
    let still = match &flat {
        None if column != RecorderColumn::Demand => detect_stuck_readings(&runs, own, period_s),
        _ => None,
    };
    flat.into_iter().chain(still).collect()
}

fn runs(series: &[f64]) -> Vec<Run> {
    let mut out = Vec::new();
    let mut from = 0;
    for chunk in series.chunk_by(|a, b| a == b) {
        out.push(Run { from, length: chunk.len(), value: chunk[0] });
        from += chunk.len();
    }
    out
}

/// Detects readings that change only every so many samples: the first of each run is a reading, the others are not.
fn detect_repeated_readings(runs: &[Run]) -> Option<ColumnFault> {
    let inner = runs.get(1..runs.len().saturating_sub(1)).filter(|inner| inner.len() >= FEWEST_RUNS)?;
    let mut lengths: Vec<usize> = inner.iter().map(|run| run.length).collect();
    lengths.sort_unstable();
    let samples = lengths[lengths.len() / 4];
    let even = lengths.iter().filter(|length| length.is_multiple_of(samples)).count() as f64;
    if samples < 2 || even < EVEN_RUNS_SHARE * lengths.len() as f64 {
        return None;
    }
    let first = inner[0].from % samples;
    let end = runs.last().map_or(0, |run| run.from + run.length);
    let useless = (0..end).filter(|k| k % samples != first).collect();
    Some(ColumnFault { kind: FaultKind::Held { samples }, useless })
}

/// Detects long standstills of readings that otherwise never stand still.
fn detect_stuck_readings(runs: &[Run], own_limit: f64, period_s: f64) -> Option<ColumnFault> {
    let short = || runs.iter().filter(|run| run.length < STUCK_READINGS);
    let pairs: usize = short().map(|run| run.length).sum();
    let equal: usize = short().map(|run| run.length - 1).sum();
    let lively = pairs > STUCK_READINGS && (equal as f64) < NOISY_COLUMN_SHARE * pairs as f64;
    let long: Vec<&Run> =
        runs.iter().filter(|run| run.length >= STUCK_READINGS && run.value.abs() < own_limit).collect();
    let first = long.first().filter(|_| lively)?;
    let samples: usize = long.iter().map(|run| run.length).sum();
    let kind = FaultKind::Stuck {
        from_s: first.from as f64 * period_s,
        for_s: samples as f64 * period_s,
        value: first.value,
    };
    Some(ColumnFault { kind, useless: long.iter().flat_map(|run| run.from..run.from + run.length).collect() })
}

/// Detects repeated flat tops at an extreme: a limit that is not the converter's.
fn detect_clipping(series: &[f64], runs: &[Run], own_limit: f64) -> Option<ColumnFault> {
    let there = || series.iter().copied().filter(|v| v.is_finite());
    let (low, high) = there().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if high - low < FLAT_TOP_STEPS * step(series) {
        return None;
    }
    let tops = |limit: f64| -> Vec<&Run> {
        runs.iter().filter(|run| run.value == limit && run.length >= FLAT_TOP_SAMPLES).collect()
    };
    let samples = |limit: f64| tops(limit).iter().map(|run| run.length).sum::<usize>();
    let limits: Vec<f64> = [low, high]
        .into_iter()
        .filter(|l| {
            l.abs() < own_limit
                && tops(*l).len() > 1
                && samples(*l) as f64 > CLIPPED_SHARE * series.len() as f64
        })
        .collect();
    let limit = limits.iter().copied().max_by_key(|l| samples(*l))?;
    let count: usize = limits.iter().map(|l| samples(*l)).sum();
    let useless = (0..series.len()).filter(|k| limits.contains(&series[*k])).collect();
    Some(ColumnFault {
        kind: FaultKind::Clipped { limit, share: count as f64 / series.len() as f64 },
        useless,
    })
}

/// Detects a sensor's converter that is coarser than the project's; returns `None` for a column that no sensor writes.
pub(super) fn find_coarse_converter(
    column: RecorderColumn,
    series: &[f64],
    base: &Parameters,
) -> Option<FaultKind> {
    let expected = column.converter_step(base).filter(|_| RecorderColumn::SENSORS.contains(&column))?;
    let step = step(series);
    let coarser = step.is_finite() && step > COARSER_CONVERTER * expected && is_grid(series, step);
    coarser.then_some(FaultKind::Coarse { step, expected })
}

/// Returns whether the readings lie on a grid of a step: the small differences of neighbours are whole multiples of it. Readings without a
/// converter have a smallest difference too, which means nothing.
fn is_grid(series: &[f64], step: f64) -> bool {
    let differences = series.windows(2).map(|w| (w[1] - w[0]).abs() / step);
    let small: Vec<f64> = differences.filter(|d| (0.5..GRID_STEPS).contains(d)).collect();
    let whole = small.iter().filter(|d| (*d - d.round()).abs() < GRID_DEVIATION).count();
    small.len() >= GRID_DIFFERENCES && whole as f64 > GRID_SHARE * small.len() as f64
}

/// Returns the smallest difference between two different neighbouring readings; infinite if there are none.
fn step(series: &[f64]) -> f64 {
    let largest = series.iter().filter(|v| v.is_finite()).fold(0.0, |a: f64, v| a.max(v.abs()));
    let differences = series.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > SAME_READING * largest);
    differences.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::expect_used, clippy::panic)]
    use super::*;
    use counterpoise_models::reference;

    /// A rate with noise on it through the reference rig's converter.
    fn reading(count: usize) -> Vec<f64> {
        let mut state = 5u64;
        let step = 20.0 / 65536.0 / 10.0;
        let one = |k: usize| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let noise = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            ((0.1 * (k as f64 * 0.004).sin() + 6e-4 * noise) / step).round() * step
        };
        (0..count).map(one).collect()
    }

    fn detect_kinds(series: &[f64]) -> Vec<FaultKind> {
        let rig = reference::rig();
        find_faults(RecorderColumn::HubRate, series, &rig, 1e-3).iter().map(|s| s.kind.clone()).collect()
    }

    #[test]
    fn a_continuous_reading_has_no_steps() {
        let mut rig = reference::rig();
        rig.interface.input_bits = 40;
        let step = 20.0 / 65536.0 / 10.0;
        let smooth: Vec<f64> = reading(5000)
            .iter()
            .zip(reading(12_000).iter().skip(7000))
            .map(|(a, b)| a + 0.313_707_113 * b + 1e-4 * step * (b * 1e7).sin())
            .collect();
        assert_eq!(find_coarse_converter(RecorderColumn::HubRate, &smooth, &rig), None);
        let stepped = find_coarse_converter(RecorderColumn::HubRate, &reading(5000), &rig);
        let FaultKind::Coarse { step: found, .. } = stepped.expect("steps") else { panic!("another fault") };
        assert!((found / step - 1.0).abs() < 1e-6, "{found}");
    }

    #[test]
    fn a_sound_reading_and_one_at_rest_have_nothing_wrong() {
        assert!(detect_kinds(&reading(5000)).is_empty());
        assert!(detect_kinds(&[0.0; 5000]).is_empty());
    }

    #[test]
    fn standstill_limit_lower_rate_and_coarser_steps_are_told_apart() {
        let mut stuck = reading(5000);
        let value = stuck[4000];
        stuck[4000..].fill(value);
        assert!(matches!(detect_kinds(&stuck)[..], [FaultKind::Stuck { .. }]));
        let clipped: Vec<f64> = reading(5000).iter().map(|v| v.clamp(-0.06, 0.06)).collect();
        assert!(matches!(detect_kinds(&clipped)[..], [FaultKind::Clipped { .. }]));
        let sound = reading(5000);
        let held: Vec<f64> = (0..5000).map(|k| sound[k / 10 * 10]).collect();
        assert!(matches!(detect_kinds(&held)[..], [FaultKind::Held { .. }]));
        let coarse: Vec<f64> = sound.iter().map(|v| (v / 4e-4).round() * 4e-4).collect();
        let rig = reference::rig();
        assert!(find_coarse_converter(RecorderColumn::HubRate, &coarse, &rig).is_some());
        assert!(find_coarse_converter(RecorderColumn::HubRate, &sound, &rig).is_none());
    }
}
