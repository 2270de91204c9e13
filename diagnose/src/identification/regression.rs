//! Least squares with noisy regressors and correlated residuals.

use counterpoise_linalg::{Mat, inverse, sym_eigenvalues};
use serde::Serialize;

use crate::tolerance::identification::{NORMAL_95, WORST_CONDITION};

/// Rows of one recording.
pub struct Block<'a> {
    /// One column an unknown; `None` if the unknown is not in this recording.
    pub columns: Vec<Option<&'a [f64]>>,
    /// Value of the sum.
    pub target: &'a [f64],
    /// The rows that count.
    pub counts: &'a [bool],
    /// Variance of the noise in each column.
    pub noise: Vec<f64>,
    /// Covariance of the noise in each column with the noise in the target.
    pub shared: Vec<f64>,
    /// Samples over which residuals are correlated.
    pub memory: usize,
}

/// The sums over the rows from which values, intervals and residual of a regression follow ([`fit_rows`]). Unknowns stand in the order of the columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct NormalEquations {
    /// X'X, row by row.
    pub regressors: Vec<Vec<f64>>,
    /// Diagonal of sum D: the power of the noise in each column, which is taken off.
    pub noise: Vec<f64>,
    /// X'y.
    pub with_target: Vec<f64>,
    /// sum c: the noise that each column shares with the target, which is taken off.
    pub shared_noise: Vec<f64>,
    /// y'y.
    pub target: f64,
    /// S, row by row.
    pub spread: Vec<Vec<f64>>,
    /// Student's quantile, half the width of a 95 % interval over the standard deviation.
    pub quantile: f64,
    /// Rows that count.
    pub rows: f64,
}

/// Result of a regression.
#[derive(Debug, Clone, PartialEq)]
pub struct RegressionFit {
    /// The unknowns.
    pub value: Vec<f64>,
    /// Half widths of their 95 % intervals.
    pub half_width: Vec<f64>,
    /// RMS of the residual.
    pub residual_rms: f64,
    /// Largest share of a regressor's power that is noise.
    pub noise_share: f64,
    /// The sums from which all of it follows.
    pub equations: NormalEquations,
}

/// Sums over the rows of all recordings.
struct Sums {
    regressors: Mat,
    noise: Vec<f64>,
    with_target: Vec<f64>,
    shared_noise: Vec<f64>,
    target: f64,
}

/// Solves min |y - X b|^2 over the rows that count, the noise of the regressors taken off:
///
/// ```text
///     (X'X - sum D) b = X'y - sum c,   cov b = (X'X - sum D)^-1 S (X'X - sum D)^-1,
///     S = 1/L sum_t s_t s_t',  s_t = sum of x r over the L rows from t on
/// ```
///
/// D is the diagonal of noise variances, c the covariances of that noise with the target's; S is Newey and West's estimate with
/// Bartlett's weights over L rows in time, written as sums over windows (Econometrica 55, 1987). The quantile grows with
/// 1 / (number of independent windows). An unknown whose column is 0 throughout is not a number. Returns `None` if the other columns
/// cannot be told apart.
pub fn fit_rows(blocks: &[Block]) -> Option<RegressionFit> {
    let n = blocks.first()?.columns.len();
    let Sums { regressors, noise, with_target, shared_noise, target } = sums_of(blocks, n);
    let noise_share =
        (0..n).map(|i| noise[i] / regressors[(i, i)].max(f64::MIN_POSITIVE)).fold(0.0, f64::max);
    let seen: Vec<usize> = (0..n).filter(|i| regressors[(*i, *i)] > 0.0).collect();
    let mut normal = regressors.clone();
    (0..n).for_each(|i| normal[(i, i)] -= noise[i]);
    let inverted = inverse_of_seen(&normal, &seen)?;
    let right = Mat::from_fn(n, 1, |i, _| with_target[i] - shared_noise[i]);
    let value = (&inverted * &right).as_slice().to_vec();
    let residuals: Vec<Vec<f64>> = blocks.iter().map(|block| residual(block, &value)).collect();
    let mut spread = Mat::zeros(n, n);
    let mut windows = 0.0;
    for (block, residual) in blocks.iter().zip(&residuals) {
        windows += count_samples(block) / block.memory as f64;
        add_spread(block, residual, &mut spread);
    }
    let covariance = &(&inverted * &spread) * &inverted;
    let quantile = student_95((windows - 1.0).max(1.0));
    let power: f64 = residuals.iter().flatten().map(|r| r * r).sum();
    let rows: f64 = blocks.iter().map(count_samples).sum();
    let unseen = |i: usize| if seen.contains(&i) { 0.0 } else { f64::NAN };
    let value = value.iter().enumerate().map(|(i, v)| v + unseen(i)).collect();
    Some(RegressionFit {
        half_width: (0..n).map(|i| quantile * covariance[(i, i)].max(0.0).sqrt()).collect(),
        value,
        residual_rms: (power / rows.max(1.0)).sqrt(),
        noise_share,
        equations: NormalEquations {
            regressors: rows_of(&regressors),
            noise,
            with_target,
            shared_noise,
            target,
            spread: rows_of(&spread),
            quantile,
            rows,
        },
    })
}

fn rows_of(matrix: &Mat) -> Vec<Vec<f64>> {
    (0..matrix.nrows()).map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect()).collect()
}

/// Returns the residual at every row; 0 at rows that do not count.
fn residual(block: &Block, value: &[f64]) -> Vec<f64> {
    let at = |k: usize| {
        let explained: f64 = block.columns.iter().zip(value).map(|(c, b)| c.map_or(0.0, |c| b * c[k])).sum();
        if block.counts[k] { block.target[k] - explained } else { 0.0 }
    };
    (0..block.target.len()).map(at).collect()
}

fn count_samples(block: &Block) -> f64 {
    block.counts.iter().filter(|c| **c).count() as f64
}

fn row(block: &Block, k: usize) -> Vec<f64> {
    block.columns.iter().map(|c| c.map_or(0.0, |c| c[k])).collect()
}

fn sums_of(blocks: &[Block], n: usize) -> Sums {
    let none = || vec![0.0; n];
    let mut sums = Sums {
        regressors: Mat::zeros(n, n),
        noise: none(),
        with_target: none(),
        shared_noise: none(),
        target: 0.0,
    };
    blocks.iter().for_each(|block| accumulate(block, &mut sums));
    sums
}

fn accumulate(block: &Block, sums: &mut Sums) {
    for k in (0..block.target.len()).filter(|k| block.counts[*k]) {
        let x = row(block, k);
        sums.target += block.target[k] * block.target[k];
        for i in (0..x.len()).filter(|i| x[*i] != 0.0) {
            sums.with_target[i] += x[i] * block.target[k];
            (0..x.len()).for_each(|j| sums.regressors[(i, j)] += x[i] * x[j]);
        }
    }
    let rows = count_samples(block);
    sums.noise.iter_mut().zip(&block.noise).for_each(|(sum, variance)| *sum += rows * variance);
    sums.shared_noise.iter_mut().zip(&block.shared).for_each(|(sum, covariance)| *sum += rows * covariance);
}

fn add_spread(block: &Block, residual: &[f64], spread: &mut Mat) {
    let (n, length, memory) = (block.columns.len(), residual.len(), block.memory.max(1));
    let scores: Vec<Vec<f64>> =
        (0..length).map(|k| row(block, k).iter().map(|x| x * residual[k]).collect()).collect();
    let mut window = vec![0.0; n];
    for end in 0..length + memory {
        if end < length {
            window.iter_mut().zip(&scores[end]).for_each(|(w, s)| *w += s);
        }
        if end >= memory {
            window.iter_mut().zip(&scores[end - memory]).for_each(|(w, s)| *w -= s);
        }
        for i in (0..n).filter(|i| window[*i] != 0.0) {
            (0..n).for_each(|j| spread[(i, j)] += window[i] * window[j] / memory as f64);
        }
    }
}

/// Returns the inverse on the unknowns whose columns are not 0, and zeros elsewhere; `None` if it is singular to the tolerance.
fn inverse_of_seen(normal: &Mat, seen: &[usize]) -> Option<Mat> {
    let n = normal.nrows();
    if seen.len() == n {
        return scaled_inverse(normal);
    }
    let inner = scaled_inverse(&Mat::from_fn(seen.len(), seen.len(), |i, j| normal[(seen[i], seen[j])]))?;
    let mut out = Mat::zeros(n, n);
    for (i, &row) in seen.iter().enumerate() {
        for (j, &column) in seen.iter().enumerate() {
            out[(row, column)] = inner[(i, j)];
        }
    }
    Some(out)
}

/// Returns the inverse by way of a unit diagonal; `None` if it is singular to the tolerance.
fn scaled_inverse(normal: &Mat) -> Option<Mat> {
    let n = normal.nrows();
    let scale: Vec<f64> = (0..n).map(|i| normal[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| !s.is_finite() || *s <= 0.0) {
        return None;
    }
    let mut unit = normal.clone();
    (0..n).for_each(|i| (0..n).for_each(|j| unit[(i, j)] /= scale[i] * scale[j]));
    let values = sym_eigenvalues(&unit).ok()?;
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    if least * WORST_CONDITION < most {
        return None;
    }
    let mut out = inverse(&unit).ok()?;
    (0..n).for_each(|i| (0..n).for_each(|j| out[(i, j)] /= scale[i] * scale[j]));
    Some(out)
}

/// Returns the 97.5 % quantile of Student's t by its expansion about the normal one (Abramowitz and Stegun 26.7.5).
pub fn student_95(freedom: f64) -> f64 {
    let z = NORMAL_95;
    let (z3, z5) = (z.powi(3), z.powi(5));
    z + (z3 + z) / (4.0 * freedom) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    fn block<'a>(columns: &[&'a [f64]], target: &'a [f64], counts: &'a [bool]) -> Block<'a> {
        let columns: Vec<_> = columns.iter().map(|c| Some(*c)).collect();
        let none = || vec![0.0; columns.len()];
        Block { noise: none(), shared: none(), columns, target, counts, memory: 10 }
    }

    #[test]
    fn exact_data_give_exact_unknowns() {
        let x: Vec<f64> = (0..200).map(|k| (0.3 * f64::from(k)).sin()).collect();
        let one = vec![1.0; 200];
        let y: Vec<f64> = x.iter().map(|x| 2.0 - 3.0 * x).collect();
        let fit = fit_rows(&[block(&[&one, &x], &y, &[true; 200])]).unwrap();
        assert!((fit.value[0] - 2.0).abs() < 1e-12 && (fit.value[1] + 3.0).abs() < 1e-12);
        assert!(fit.half_width[1] < 1e-12 && fit.residual_rms < 1e-12);
    }

    #[test]
    fn equal_columns_are_refused() {
        let x: Vec<f64> = (0..200).map(|k| (0.3 * f64::from(k)).sin()).collect();
        assert!(fit_rows(&[block(&[&x, &x], &x, &[true; 200])]).is_none());
    }

    #[test]
    fn students_quantile() {
        assert!((student_95(10.0) - 2.228).abs() < 0.01 && (student_95(30.0) - 2.042).abs() < 2e-3);
    }
}
