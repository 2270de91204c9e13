//! The finite eigenvalues of a small pencil `M - s E`, corrected in 32 digits.
//!
//! Method: eigenvalues that are all simple are corrected one by one (`simple_roots`). Otherwise, Aberth's simultaneous iteration (Math. Comp. 27 (1973) 339) on the determinant, whose logarithmic derivative is
//! `-trace((M - s E)^-1 E)`. The LU factors of each step are computed with 32 digits from the entries as they are given, so that
//! nothing is lost in transformations of the pencil: eigenvalues that differ by many decades keep their digits.

use crate::error::{Error, check_shape, check_square};
use crate::long_complex::LongComplex;
use crate::mat::{C64, Mat};
use crate::simple_roots::simple_roots;
use crate::tolerance::{
    PENCIL_APART, PENCIL_CONVERGED, PENCIL_MODES, PENCIL_NEARLY_REAL, PENCIL_REAL, PENCIL_STALLED,
    PENCIL_SWEEPS, PENCIL_TOGETHER, PENCIL_TURN,
};

/// Corrects approximations of all finite eigenvalues of the pencil `M - s E`; `E` diagonal, given by its diagonal of zeros and ones.
/// Returns `None` if the iteration does not converge.
///
/// The number of approximations is taken as the number of eigenvalues; an approximation that is exactly zero is kept. Cost: n^3
/// operations for each eigenvalue if all are simple; otherwise 8 n^3 operations with 32 digits for each eigenvalue and sweep, of which
/// there are four to ten.
///
/// # Errors
/// Wrong shapes, or entries that are not finite.
pub fn pencil_roots(M: &Mat, E: &[f64], starts: &[C64]) -> Result<Option<Vec<C64>>, Error> {
    check_square("M", M)?;
    check_shape("E", &Mat::col(E), M.nrows(), 1)?;
    if let Some(roots) = simple_roots(M, E, starts) {
        return Ok(Some(pair_conjugates(roots)));
    }
    Ok(simultaneous_roots(M, E, starts))
}

/// The eigenvalues by the simultaneous iteration; `None` if it does not converge.
///
/// Two real eigenvalues that differ by rounding are never found from a conjugate pair of approximations, which stays one, and a conjugate pair is never found from
/// real approximations, which stay real: these are moved then.
pub(crate) fn simultaneous_roots(M: &Mat, E: &[f64], starts: &[C64]) -> Option<Vec<C64>> {
    let nearly_real = |s: &C64| s.im > 0.0 && s.im <= PENCIL_NEARLY_REAL * s.norm();
    let apart = |s: &C64| if nearly_real(s) { C64::new(s.re + s.im, 0.5 * s.im) } else { *s };
    let turn = |k: usize| C64::from_polar(1.0, if k.is_multiple_of(2) { PENCIL_TURN } else { -PENCIL_TURN });
    let off_axis = |(k, s): (usize, &C64)| if s.im == 0.0 { s * turn(k) } else { *s };
    let from = |moved: Vec<C64>| if moved == starts { None } else { iterate(M, E, separate_starts(&moved)) };
    iterate(M, E, separate_starts(starts))
        .or_else(|| from(starts.iter().map(apart).collect()))
        .or_else(|| from(starts.iter().enumerate().map(off_axis).collect()))
}

/// The simultaneous iteration from given approximations.
fn iterate(M: &Mat, E: &[f64], mut roots: Vec<LongComplex>) -> Option<Vec<C64>> {
    let mut settled: Vec<bool> = roots.iter().map(|root| root.is_zero()).collect();
    let mut last = vec![f64::INFINITY; roots.len()];
    for _ in 0..PENCIL_SWEEPS {
        for k in 0..roots.len() {
            if settled[k] {
                continue;
            }
            let Some(step) = correction(M, E, &roots, k) else {
                settled[k] = true;
                continue;
            };
            if !step.size().is_finite() {
                return None;
            }
            roots[k] = roots[k] - step;
            let size = step.size() / roots[k].size();
            // Steps that no longer shrink are rounding in 32 digits of a matrix that is nearly singular beside its norm.
            let is_rounding = size <= PENCIL_STALLED && size >= 0.5 * last[k];
            settled[k] = size <= PENCIL_CONVERGED || is_rounding;
            last[k] = size;
        }
        if settled.iter().all(|s| *s) {
            return Some(pair_conjugates(roots.into_iter().map(LongComplex::round).collect()));
        }
    }
    None
}

/// An eigenvalue whose digits do not decide on which side of the boundary it lies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DoubtfulMode {
    /// Approximation.
    pub eigenvalue: C64,
    /// By how much rounding may move it across the boundary.
    pub across: f64,
}

/// Corrects some eigenvalues of a matrix in 32 digits, each to a hundredth of what rounding may move it across the boundary; `all` are approximations of all eigenvalues. Returns
/// pairs of an approximation and its correction; none if the matrix has more than [`PENCIL_MODES`] rows or the iteration does not converge.
///
/// The others need no correction: Aberth's step vanishes at an eigenvalue wherever they are.
pub(crate) fn corrected_modes(M: &Mat, all: &[C64], doubtful: &[DoubtfulMode]) -> Vec<(C64, C64)> {
    let n = M.nrows();
    if doubtful.is_empty() || n > PENCIL_MODES {
        return Vec::new();
    }
    let mass = vec![1.0; n];
    let within = |l: &C64| {
        doubtful.iter().find(|d| d.eigenvalue == *l || d.eigenvalue.conj() == *l).map(|d| 0.01 * d.across)
    };
    let limits: Vec<Option<f64>> = all.iter().map(within).collect();
    // A pair of real approximations may belong to a complex pair, which no step along the axis finds.
    let turn = C64::from_polar(1.0, PENCIL_TURN);
    let start =
        |(l, limit): (&C64, &Option<f64>)| LongComplex::of(if limit.is_some() { l * turn } else { *l });
    let mut roots: Vec<LongComplex> = all.iter().zip(&limits).map(start).collect();
    let mut settled: Vec<bool> = limits.iter().map(Option::is_none).collect();
    for _ in 0..PENCIL_SWEEPS {
        for k in 0..n {
            if settled[k] {
                continue;
            }
            let step = correction(M, &mass, &roots, k).unwrap_or_default();
            if !step.size().is_finite() {
                return Vec::new();
            }
            roots[k] = roots[k] - step;
            settled[k] = step.size() <= limits[k].unwrap_or(0.0);
        }
    }
    if settled.contains(&false) {
        return Vec::new();
    }
    all.iter().copied().zip(roots.into_iter().map(LongComplex::round)).collect()
}

/// The approximations with those that coincide moved apart, because the iteration never separates equal ones.
fn separate_starts(starts: &[C64]) -> Vec<LongComplex> {
    let mut out: Vec<C64> = Vec::with_capacity(starts.len());
    for (k, &start) in starts.iter().enumerate() {
        let near = |other: &&C64| (**other - start).norm() <= PENCIL_TOGETHER * start.norm();
        let same = out.iter().filter(near).count();
        let turn = C64::from_polar(1.0 + PENCIL_APART * same as f64, PENCIL_APART * (same * (k + 1)) as f64);
        out.push(if same > 0 { start * turn } else { start });
    }
    out.into_iter().map(LongComplex::of).collect()
}

/// Aberth's correction of root `k`; `None` if the pencil is singular there: it is an eigenvalue.
fn correction(M: &Mat, E: &[f64], roots: &[LongComplex], k: usize) -> Option<LongComplex> {
    let z = roots[k];
    let mut slope = logarithmic_slope(M, E, z)?;
    let one = LongComplex::of(C64::new(1.0, 0.0));
    for (j, other) in roots.iter().enumerate().filter(|(j, _)| *j != k) {
        let distance = z - *other;
        if distance.is_zero() {
            // Two roots on one place: the later one moves aside by the rounding of a double.
            return (j < k)
                .then(|| LongComplex::of(C64::new(f64::EPSILON * z.size(), f64::EPSILON * z.size())));
        }
        slope = slope - one / distance;
    }
    Some(one / slope)
}

/// The derivative of `ln det(M - s E)`; `None` if the pencil is singular at `s`.
fn logarithmic_slope(M: &Mat, E: &[f64], s: LongComplex) -> Option<LongComplex> {
    let n = M.nrows();
    let entry = |i: usize, j: usize| {
        let value = LongComplex::of(C64::new(M[(i, j)], 0.0));
        if i == j && E[i] != 0.0 { value - s } else { value }
    };
    let mut rows: Vec<Vec<LongComplex>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    // The inverse grows beside the factors: row i holds the columns n .. 2n of [P, I].
    for (i, row) in rows.iter_mut().enumerate() {
        row.extend((0..n).map(|j| LongComplex::of(C64::new(if i == j { 1.0 } else { 0.0 }, 0.0))));
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].size().total_cmp(&rows[b][k].size()))?;
        if rows[pivot][k].size() == 0.0 || !rows[pivot][k].size().is_finite() {
            return None;
        }
        rows.swap(k, pivot);
        let (above, below) = rows.split_at_mut(k + 1);
        let top = &above[k];
        for row in below.iter_mut().filter(|row| !row[k].is_zero()) {
            let factor = row[k] / top[k];
            for (target, source) in row[k + 1..].iter_mut().zip(&top[k + 1..]) {
                if !source.is_zero() {
                    *target = *target - factor * *source;
                }
            }
        }
    }
    trace(&mut rows, E)
}

/// `-trace(P^-1 E)` from the triangle of P and the columns that were eliminated with it.
fn trace(rows: &mut [Vec<LongComplex>], E: &[f64]) -> Option<LongComplex> {
    let n = rows.len();
    let mut sum = LongComplex::default();
    for column in (0..n).filter(|&j| E[j] != 0.0) {
        // Only the entry of the diagonal is needed: back substitution ends there.
        let mut x = vec![LongComplex::default(); n];
        for i in (column..n).rev() {
            let mut right = rows[i][n + column];
            for j in i + 1..n {
                if !x[j].is_zero() {
                    right = right - rows[i][j] * x[j];
                }
            }
            x[i] = right / rows[i][i];
        }
        sum = sum - x[column];
    }
    sum.size().is_finite().then_some(sum)
}

/// The roots of a real pencil: nearly real ones made real, the others in exact conjugate pairs.
fn pair_conjugates(mut roots: Vec<C64>) -> Vec<C64> {
    roots.iter_mut().filter(|root| root.im.abs() <= PENCIL_REAL * root.norm()).for_each(|root| root.im = 0.0);
    let mut out: Vec<C64> = roots.iter().copied().filter(|root| root.im == 0.0).collect();
    let mut upper: Vec<C64> = roots.iter().copied().filter(|root| root.im > 0.0).collect();
    let mut lower: Vec<C64> = roots.iter().copied().filter(|root| root.im < 0.0).collect();
    while let Some(root) = upper.pop() {
        let distance = |other: &C64| (other.conj() - root).norm();
        let near = (0..lower.len()).min_by(|&a, &b| distance(&lower[a]).total_cmp(&distance(&lower[b])));
        if let Some(k) = near {
            let other = lower.swap_remove(k);
            let mean = 0.5 * (root + other.conj());
            out.extend([mean, mean.conj()]);
        } else {
            out.push(root);
        }
    }
    out.extend(lower);
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn roots_twelve_decades_apart_have_all_their_digits() {
        // Upper triangular with a dense coupling: the eigenvalues are the diagonal, exactly.
        let exact: [f64; 6] = [-1e-6, -1e-3, -1.0, -2.0, -1e3, -1e6];
        let M = Mat::from_fn(6, 6, |i, j| {
            if i == j {
                exact[i]
            } else if i < j {
                1.0
            } else {
                0.0
            }
        });
        let starts: Vec<C64> = exact.iter().map(|e| C64::new(e * 1.3, e * 0.2)).collect();
        let mut found = pencil_roots(&M, &[1.0; 6], &starts).unwrap().unwrap();
        found.sort_by(|a, b| b.re.total_cmp(&a.re));
        for (root, exact) in found.iter().zip(exact) {
            assert!((root - exact).norm() <= 4e-16 * exact.abs(), "{root} {exact}");
        }
    }

    #[test]
    fn infinite_eigenvalues_stay_away_and_double_ones_are_found() {
        // det [s^2 + 2 s + 1, ...] of a companion matrix, and an algebraic equation beside it.
        let M = Mat::from_rows(&[&[0.0, 1.0, 0.0], &[-1.0, -2.0, 3.0], &[0.0, 0.0, 5.0]]);
        let starts = [C64::new(-0.9, 0.1), C64::new(-1.2, -0.1)];
        let found = pencil_roots(&M, &[1.0, 1.0, 0.0], &starts).unwrap().unwrap();
        assert!(found.iter().all(|root| (root + 1.0).norm() < 1e-13), "{found:?}");
    }

    /// Marsaglia's xorshift generator.
    fn noise(state: &mut u64) -> f64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    #[test]
    fn both_methods_find_the_same_doubles() {
        let mut state = 20_261_125;
        let mut compared = 0;
        for n in [3, 8, 16, 24] {
            for decades in [0.0, 3.0, 6.0] {
                let scales: Vec<f64> = (0..n).map(|_| 10f64.powf(decades * noise(&mut state))).collect();
                let M = Mat::from_fn(n, n, |i, _| scales[i] * noise(&mut state));
                let E: Vec<f64> = (0..n).map(|i| if i + 1 < n { 1.0 } else { 0.0 }).collect();
                // The algebraic row is eliminated for the approximations.
                let inner = M.block(0, 0, n - 1, n - 1);
                let outer = &M.block(0, n - 1, n - 1, 1) * &M.block(n - 1, 0, 1, n - 1);
                let reduced = &inner - &outer.scale(1.0 / M[(n - 1, n - 1)]);
                let starts = crate::schur::eigenvalues(&reduced).unwrap();
                let Some(mut quick) = simple_roots(&M, &E, &starts) else { continue };
                let mut slow = simultaneous_roots(&M, &E, &starts).unwrap();
                let order = |a: &C64, b: &C64| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im));
                quick.sort_by(order);
                slow.sort_by(order);
                assert_eq!(quick, slow, "{n} {decades}");
                compared += 1;
            }
        }
        assert!(compared >= 10, "{compared}");
    }

    #[test]
    fn two_real_roots_that_differ_by_rounding_are_found_from_a_conjugate_pair() {
        let exact = [-241158213.13161114, -241158213.1316111];
        let M = Mat::diag(&[exact[0], exact[1], -1.0]);
        let starts = [C64::new(exact[0], 2.7), C64::new(exact[0], -2.7), C64::new(-1.0, 0.0)];
        let found = pencil_roots(&M, &[1.0; 3], &starts).unwrap().unwrap();
        assert!(found.iter().all(|root| root.im == 0.0), "{found:?}");
    }

    #[test]
    fn a_conjugate_pair_is_found_from_real_approximations() {
        // Zeros of a light mode beside fast lags, of which doubles see the damping alone.
        let M = Mat::from_rows(&[&[0.0, 2e-4, 0.0], &[-2e-4, -1e-8, 0.0], &[0.0, 0.0, -4e11]]);
        let starts = [-1e-8, -1e-11, -4e11].map(|s| C64::new(s, 0.0));
        let found = pencil_roots(&M, &[1.0; 3], &starts).unwrap().unwrap();
        let (re, im) = (-5e-9, (4e-8_f64 - 25e-18).sqrt());
        assert!(found.iter().any(|root| (root - C64::new(re, im)).norm() < 1e-18), "{found:?}");
    }

    #[test]
    fn what_is_not_simple_is_left_to_the_other_method() {
        let M = Mat::from_rows(&[&[-1.0, 1.0], &[0.0, -1.0]]);
        let starts = [C64::new(-1.0 + 1e-9, 0.0), C64::new(-1.0 - 1e-9, 0.0)];
        assert!(simple_roots(&M, &[1.0; 2], &starts).is_none());
    }
}
