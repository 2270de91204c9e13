//! Least squares over the samples that are numbers, and delayed series.

use crate::tolerance::recording::ON_SAMPLE;
use counterpoise_linalg::{Mat, inverse};

/// y = X b, found.
pub(super) struct Regression {
    /// The coefficients.
    pub value: Vec<f64>,
    /// The uncertainty of each if all that is left were systematic: RMS left over the RMS of what its column alone brings.
    pub doubt: Vec<f64>,
    /// RMS of what is left.
    pub left: f64,
    /// The same as a share of the RMS of y about its mean.
    pub share: f64,
}

/// Minimises |y - X b|^2 over the rows in which everything is a number; returns `None` if the columns are nearly dependent or the
/// rows too few.
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

/// Returns a series delayed by a time that need not be whole samples; not a number where it would need samples from outside.
pub(super) fn delay_series(series: &[f64], samples: f64) -> Vec<f64> {
    let at = |k: usize| {
        let place = k as f64 - samples;
        let low = place.floor();
        let share = place - low;
        if low < 0.0 || low as usize >= series.len() {
            return f64::NAN;
        }
        let low = low as usize;
        match series.get(low + 1) {
            _ if share < ON_SAMPLE => series[low],
            Some(next) => series[low] * (1.0 - share) + next * share,
            None => f64::NAN,
        }
    };
    (0..series.len()).map(at).collect()
}
