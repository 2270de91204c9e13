//! Operations on series of samples: moving means, slopes, deviations, products.

use crate::tolerance::recording::UNCORRELATED;

/// Returns the root of the mean square; 0 for an empty series.
pub(crate) fn rms(series: &[f64]) -> f64 {
    if series.is_empty() {
        0.0
    } else {
        (series.iter().map(|r| r * r).sum::<f64>() / series.len() as f64).sqrt()
    }
}

/// Returns the sum of the products of two series.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Returns the mean over `half` samples to either side; not a number if one in the window is missing.
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

/// Returns the moving mean of the moving mean.
pub(crate) fn low_pass(series: &[f64], half: usize) -> Vec<f64> {
    moving_mean(&moving_mean(series, half), half)
}

/// Returns central differences, one-sided at the ends.
pub(crate) fn derivative(series: &[f64], period_s: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1);
    let at = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        if to == from { 0.0 } else { (series[to] - series[from]) / ((to - from) as f64 * period_s) }
    };
    (0..series.len()).map(at).collect()
}

/// Returns the standard deviation of the samples that are numbers.
pub(crate) fn deviation(series: &[f64]) -> f64 {
    let there: Vec<f64> = series.iter().copied().filter(|v| v.is_finite()).collect();
    let mean = there.iter().sum::<f64>() / there.len().max(1) as f64;
    rms(&there.iter().map(|v| v - mean).collect::<Vec<f64>>())
}

/// Returns the integrated correlation time of a series in samples, 1 for white noise (initial positive sequence, Geyer 1992).
pub(crate) fn correlation_time(series: &[f64]) -> f64 {
    let power = series.iter().map(|r| r * r).sum::<f64>();
    if power == 0.0 {
        return 1.0;
    }
    let lagged = |lag: usize| series.iter().zip(&series[lag..]).map(|(a, b)| a * b).sum::<f64>() / power;
    let mut time = 1.0;
    let mut lag = 1;
    while lag < series.len() / 4 {
        let correlation = lagged(lag);
        if correlation < UNCORRELATED {
            break;
        }
        let stride = (lag / 8).max(1);
        time += 2.0 * correlation * stride as f64;
        lag += stride;
    }
    time
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_time_of_a_first_order_process() {
        let (mut state, mut seed) = (0.0, 1u64);
        let mut noise = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0
        };
        let series: Vec<f64> = (0..200_000)
            .map(|_| {
                state = 0.9 * state + noise();
                state
            })
            .collect();
        let time = correlation_time(&series);
        assert!((time / 19.0 - 1.0).abs() < 0.15, "{time}");
    }
}
