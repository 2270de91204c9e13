//! The finite eigenvalues of a small pencil that are all simple, corrected in 32 digits one by one.
//!
//! Method: Newton's iteration on eigenvalue and eigenvector together (J. Dongarra, C. Moler and J. Wilkinson, SIAM Journal on
//! Numerical Analysis 20 (1983) 23). Residuals are computed with 32 digits from the entries as they are given, corrections with the
//! factors of one matrix of doubles. Each correction gains the digits that the condition of this matrix leaves, at the cost of n^2
//! operations.

use crate::long_complex::LongComplex;
use crate::mat::{C64, Mat};
use crate::tolerance::{
    PENCIL_APPROACH, PENCIL_CONVERGED, PENCIL_CORRECTIONS, PENCIL_NEAR, PENCIL_TOGETHER, PENCIL_VECTOR,
};

/// Corrects approximations of all finite eigenvalues of `M - s E`; `E` diagonal, given by its diagonal of zeros and ones. Approximations
/// that are exactly zero are kept, and the others must come in conjugate pairs. Returns `None` if a correction does not converge to a
/// simple eigenvalue near its own approximation.
pub(crate) fn simple_roots(M: &Mat, E: &[f64], starts: &[C64]) -> Option<Vec<C64>> {
    let mut roots = vec![C64::ZERO; starts.len()];
    for (k, &start) in starts.iter().enumerate().filter(|(_, start)| start.norm() > 0.0) {
        if start.im < 0.0 {
            continue;
        }
        let root = correct_eigenvalue(M, E, start)?;
        if (root - start).norm() > PENCIL_NEAR * distance_to_others(starts, k) {
            return None;
        }
        roots[k] = root;
        if start.im > 0.0 {
            roots[conjugate(starts, start)?] = root.conj();
        }
    }
    let is_whole = starts.iter().zip(&roots).all(|(start, root)| (start.norm() > 0.0) == (root.norm() > 0.0));
    (is_whole && are_apart(&roots)).then_some(roots)
}

/// The distance from an approximation to the nearest other one.
fn distance_to_others(starts: &[C64], k: usize) -> f64 {
    let others = starts.iter().enumerate().filter(|(j, _)| *j != k);
    others.map(|(_, other)| (other - starts[k]).norm()).fold(f64::INFINITY, f64::min)
}

/// The place of the conjugate of an approximation; `None` if the nearest one is as far from it as another eigenvalue may be.
fn conjugate(starts: &[C64], start: C64) -> Option<usize> {
    let distance = |k: &usize| (starts[*k] - start.conj()).norm();
    let below = (0..starts.len()).filter(|&k| starts[k].im < 0.0);
    let nearest = below.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(&nearest) <= PENCIL_TOGETHER * start.norm()).then_some(nearest)
}

fn are_apart(roots: &[C64]) -> bool {
    let other_than_zero: Vec<C64> = roots.iter().copied().filter(|root| root.norm() > 0.0).collect();
    let apart = |a: C64, b: C64| (a - b).norm() > PENCIL_TOGETHER * a.norm();
    (0..other_than_zero.len())
        .all(|k| other_than_zero[..k].iter().all(|other| apart(other_than_zero[k], *other)))
}

/// One eigenvalue, corrected until a correction is below [`PENCIL_CONVERGED`] of it.
fn correct_eigenvalue(M: &Mat, E: &[f64], start: C64) -> Option<C64> {
    let n = M.nrows();
    let (x, largest) = vector(M, E, start)?;
    // Column `largest` of the eigenvector stays 1, and the correction of the eigenvalue takes its place.
    let bordered =
        Factors::of(n, |i, j| if j == largest { -x[i] * E[i] } else { shifted_entry(M, E, start, i, j) })?;
    if bordered.is_singular {
        // Two eigenvalues share an eigenvector, as far as doubles tell: corrections would be of any size.
        return None;
    }
    let mut x: Vec<LongComplex> = x.into_iter().map(LongComplex::of).collect();
    let mut s = LongComplex::of(start);
    let mut last = f64::INFINITY;
    for _ in 0..PENCIL_CORRECTIONS {
        let step = bordered.solve(residual(M, E, s, &x).into_iter().map(LongComplex::round).collect());
        let size = step[largest].norm() / start.norm();
        let moved = (0..n).filter(|&j| j != largest).map(|j| step[j].norm()).fold(0.0, f64::max);
        if !(size.is_finite() && moved.is_finite()) || size > PENCIL_APPROACH * last {
            return None;
        }
        s = s - LongComplex::of(step[largest]);
        for j in (0..n).filter(|&j| j != largest) {
            x[j] = x[j] - LongComplex::of(step[j]);
        }
        if size <= PENCIL_CONVERGED && moved <= PENCIL_VECTOR {
            return Some(s.round());
        }
        last = size.max(PENCIL_CONVERGED / PENCIL_APPROACH);
    }
    None
}

fn shifted_entry(M: &Mat, E: &[f64], s: C64, i: usize, j: usize) -> C64 {
    let value = C64::new(M[(i, j)], 0.0);
    if i == j { value - s * E[i] } else { value }
}

/// (M - s E) x.
fn residual(M: &Mat, E: &[f64], s: LongComplex, x: &[LongComplex]) -> Vec<LongComplex> {
    let row = |i: usize| {
        let sum = (0..x.len())
            .filter(|&j| M[(i, j)] != 0.0)
            .fold(LongComplex::default(), |sum, j| sum + x[j].times(M[(i, j)]));
        if E[i] == 0.0 { sum } else { sum - s * x[i] }
    };
    (0..x.len()).map(row).collect()
}

/// The eigenvector of an approximation by inverse iteration, its largest entry 1, and the place of that.
fn vector(M: &Mat, E: &[f64], s: C64) -> Option<(Vec<C64>, usize)> {
    let n = M.nrows();
    let factors = Factors::of(n, |i, j| shifted_entry(M, E, s, i, j))?;
    let mut x = vec![C64::ONE; n];
    let mut largest = 0;
    for _ in 0..2 {
        let right = x.iter().zip(E).map(|(x, e)| x * e).collect();
        x = factors.solve(right);
        largest = (0..n).max_by(|&a, &b| x[a].norm().total_cmp(&x[b].norm()))?;
        let scale = x[largest];
        if !(scale.norm().is_normal()) {
            return None;
        }
        x.iter_mut().for_each(|entry| *entry /= scale);
    }
    x[largest] = C64::ONE;
    Some((x, largest))
}

/// The triangular factors of a matrix whose rows and columns are scaled by powers of two.
struct Factors {
    n: usize,
    /// Row by row, the rows in their new order.
    entries: Vec<C64>,
    order: Vec<usize>,
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// Whether a pivot vanished.
    is_singular: bool,
}

impl Factors {
    /// Returns the factors of a matrix given by its entries; a pivot that vanishes is replaced by a rounding error. `None` if a row or a
    /// column is zero or not finite.
    fn of(n: usize, entry: impl Fn(usize, usize) -> C64) -> Option<Self> {
        let mut entries: Vec<C64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let power = |size: f64| (-size.log2().round()).exp2();
        let rows: Vec<f64> =
            (0..n).map(|i| power((0..n).map(|j| entries[i * n + j].norm()).fold(0.0, f64::max))).collect();
        (0..n * n).for_each(|k| entries[k] *= rows[k / n]);
        let columns: Vec<f64> =
            (0..n).map(|j| power((0..n).map(|i| entries[i * n + j].norm()).fold(0.0, f64::max))).collect();
        (0..n * n).for_each(|k| entries[k] *= columns[k % n]);
        if !rows.iter().chain(&columns).all(|scale| scale.is_normal()) {
            return None;
        }
        let mut factors = Self { n, entries, order: (0..n).collect(), rows, columns, is_singular: false };
        (0..n).for_each(|k| factors.eliminate(k));
        Some(factors)
    }

    fn eliminate(&mut self, k: usize) {
        let n = self.n;
        let size = |at: usize| self.entries[at * n + k].norm();
        let pivot = (k..n).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(k);
        if pivot != k {
            (0..n).for_each(|j| self.entries.swap(k * n + j, pivot * n + j));
            self.order.swap(k, pivot);
        }
        if self.entries[k * n + k].norm() < f64::EPSILON {
            self.entries[k * n + k] = C64::new(f64::EPSILON, 0.0);
            self.is_singular = true;
        }
        let (above, below) = self.entries.split_at_mut((k + 1) * n);
        let top = &above[k * n..];
        for row in below.chunks_mut(n).filter(|row| row[k] != C64::ZERO) {
            let factor = row[k] / top[k];
            row[k] = factor;
            for (target, source) in row[k + 1..].iter_mut().zip(&top[k + 1..]) {
                *target -= factor * source;
            }
        }
    }

    fn solve(&self, right: Vec<C64>) -> Vec<C64> {
        let n = self.n;
        let mut x: Vec<C64> = self.order.iter().map(|&i| right[i] * self.rows[i]).collect();
        for i in 0..n {
            let known: C64 = (0..i).map(|j| self.entries[i * n + j] * x[j]).sum();
            x[i] -= known;
        }
        for i in (0..n).rev() {
            let known: C64 = (i + 1..n).map(|j| self.entries[i * n + j] * x[j]).sum();
            x[i] = (x[i] - known) / self.entries[i * n + i];
        }
        x.iter().zip(&self.columns).map(|(x, scale)| x * scale).collect()
    }
}
