//! Least squares over the samples that are there, and the smoothing that goes before it.

use counterpoise_linalg::{Mat, inverse};

/// y = X b, found.
pub(super) struct Regression {
    /// The coefficients.
    pub value: Vec<f64>,
    /// How far each may be off if all that is left were systematic: RMS left over the RMS of what its column alone brings.
    pub doubt: Vec<f64>,
    /// RMS of what is left.
    pub left: f64,
    /// The same as a share of the RMS of y about its mean.
    pub share: f64,
}

/// min |y - X b|^2 over the rows in which all is finite; none where the columns cannot be told apart or rows are few.
pub(super) fn regress(columns: &[&[f64]], y: &[f64]) -> Option<Regression> {
    let there = |k: &usize| y[*k].is_finite() && columns.iter().all(|c| c[*k].is_finite());
    let rows: Vec<usize> = (0..y.len()).filter(there).collect();
    let n = columns.len();
    if rows.len() < 20 * n {
        return None;
    }
    let size = |c: &[f64]| (rows.iter().map(|k| c[*k] * c[*k]).sum::<f64>() / rows.len() as f64).sqrt();
    let sizes: Vec<f64> = columns.iter().map(|c| size(c)).collect();
    if sizes.contains(&0.0) {
        return None;
    }
    let mut gram = Mat::zeros(n, n);
    let mut right = Mat::zeros(n, 1);
    for &k in &rows {
        for i in 0..n {
            let x = columns[i][k] / sizes[i];
            right[(i, 0)] += x * y[k];
            (0..n).for_each(|j| gram[(i, j)] += x * columns[j][k] / sizes[j]);
        }
    }
    let inverted = inverse(&gram).ok()?;
    let scaled = &inverted * &right;
    let value: Vec<f64> = (0..n).map(|i| scaled[(i, 0)] / sizes[i]).collect();
    let error = |k: &usize| y[*k] - (0..n).map(|i| value[i] * columns[i][*k]).sum::<f64>();
    let count = rows.len() as f64;
    let left = (rows.iter().map(|k| error(k).powi(2)).sum::<f64>() / count).sqrt();
    let mean = rows.iter().map(|k| y[*k]).sum::<f64>() / count;
    let power = rows.iter().map(|k| (y[*k] - mean).powi(2)).sum::<f64>() / count;
    let doubt = (0..n).map(|i| left * (count * inverted[(i, i)].max(0.0)).sqrt() / sizes[i]).collect();
    Some(Regression { value, doubt, left, share: left / power.sqrt().max(f64::MIN_POSITIVE) })
}

/// Twice the moving mean over `half` samples to either side; missing where a sample in the window is.
pub(super) fn smooth(series: &[f64], half: usize) -> Vec<f64> {
    let once = |series: &[f64]| {
        let (mut sums, mut holes) = (vec![0.0], vec![0usize]);
        for value in series {
            sums.push(sums[sums.len() - 1] + if value.is_finite() { *value } else { 0.0 });
            holes.push(holes[holes.len() - 1] + usize::from(!value.is_finite()));
        }
        let at = |k: usize| {
            let (from, to) = (k.saturating_sub(half), (k + half + 1).min(series.len()));
            if holes[to] > holes[from] { f64::NAN } else { (sums[to] - sums[from]) / (to - from) as f64 }
        };
        (0..series.len()).map(at).collect::<Vec<f64>>()
    };
    once(&once(series))
}

/// Central differences.
pub(super) fn slope(series: &[f64], period_s: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1);
    let at = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        (series[to] - series[from]) / ((to - from).max(1) as f64 * period_s)
    };
    (0..series.len()).map(at).collect()
}

/// A series late by a time that need not be whole samples; missing where it would have to be known from outside.
pub(super) fn late(series: &[f64], samples: f64) -> Vec<f64> {
    let at = |k: usize| {
        let place = k as f64 - samples;
        let low = place.floor();
        let share = place - low;
        if low < 0.0 || low as usize >= series.len() {
            return f64::NAN;
        }
        let low = low as usize;
        match series.get(low + 1) {
            _ if share < 1e-9 => series[low],
            Some(next) => series[low] * (1.0 - share) + next * share,
            None => f64::NAN,
        }
    };
    (0..series.len()).map(at).collect()
}

/// Deviation about the mean of what is there.
pub(super) fn deviation(series: &[f64]) -> f64 {
    let there: Vec<f64> = series.iter().copied().filter(|v| v.is_finite()).collect();
    let count = there.len().max(1) as f64;
    let mean = there.iter().sum::<f64>() / count;
    (there.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt()
}
