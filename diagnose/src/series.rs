//! What is done to series of samples everywhere: means that move, slopes, deviations.

use crate::bench::rms;

/// Mean over `half` samples to either side; missing where a sample in the window is.
pub(crate) fn moving_mean(series: &[f64], half: usize) -> Vec<f64> {
    let (mut sums, mut holes) = (vec![0.0], vec![0usize]);
    for value in series {
        sums.push(sums[sums.len() - 1] + if value.is_finite() { *value } else { 0.0 });
        holes.push(holes[holes.len() - 1] + usize::from(!value.is_finite()));
    }
    let at = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half + 1).min(series.len()));
        if holes[to] > holes[from] { f64::NAN } else { (sums[to] - sums[from]) / (to - from) as f64 }
    };
    (0..series.len()).map(at).collect()
}

/// Twice the moving mean.
pub(crate) fn low_pass(series: &[f64], half: usize) -> Vec<f64> {
    moving_mean(&moving_mean(series, half), half)
}

/// Central differences; one-sided at the ends.
pub(crate) fn derivative(series: &[f64], period_s: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1);
    let at = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        if to == from { 0.0 } else { (series[to] - series[from]) / ((to - from) as f64 * period_s) }
    };
    (0..series.len()).map(at).collect()
}

/// Deviation about the mean of what is there.
pub(crate) fn deviation(series: &[f64]) -> f64 {
    let there: Vec<f64> = series.iter().copied().filter(|v| v.is_finite()).collect();
    let mean = there.iter().sum::<f64>() / there.len().max(1) as f64;
    rms(&there.iter().map(|v| v - mean).collect::<Vec<f64>>())
}
