//! LU factors and the Hessenberg form for the sizes of this tool, in plain loops over columns.
//!
//! Below a few dozen rows a blocked kernel spends more on its set-up and its copies than on arithmetic.

use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::tolerance::ZERO_COLUMN;

/// Systems with up to this many unknowns are solved here; from twenty on faer is as fast, from forty on faster.
pub(crate) const SYSTEMS: usize = 18;

/// Two products of matrices with up to this many rows are the same doubles as one of matrices with twice as many columns.
pub(crate) const PRODUCTS: usize = 12;

/// Matrices with up to this many rows are brought to Hessenberg form here.
pub(crate) const SIMILARITIES: usize = 64;

/// `A^-1 B` by LU with partial pivoting; `None` if a pivot is zero.
pub(crate) fn solve(A: &Mat, B: &Mat) -> Option<Mat> {
    Some(Factors::of(A.clone())?.solve(B.clone()))
}

/// The LU factors of a matrix, and the row that changed places with each.
pub(crate) struct Factors {
    factors: Mat,
    exchanged: Vec<usize>,
}

impl Factors {
    /// `None` if a pivot is zero.
    pub(crate) fn of(mut A: Mat) -> Option<Self> {
        let exchanged = factor(&mut A)?;
        Some(Self { factors: A, exchanged })
    }

    /// `A^-1 B`
    pub(crate) fn solve(&self, mut B: Mat) -> Mat {
        substitute(&self.factors, &self.exchanged, &mut B);
        B
    }
}

vectorised! {
    /// Overwrites a square matrix by its LU factors; returns the row that changed places with each, `None` for a zero pivot.
    fn factor<'a>(A: &'a mut Mat) -> Option<Vec<usize>> {
        let n = A.nrows();
        let mut exchanged = Vec::with_capacity(n);
        for k in 0..n {
            let row = largest(&A.column(k)[k..]) + k;
            exchanged.push(row);
            if row != k {
                A.as_mut_slice().chunks_exact_mut(n).for_each(|column| column.swap(k, row));
            }
            let pivot = A[(k, k)];
            if pivot == 0.0 {
                return None;
            }
            let (done, rest) = A.as_mut_slice().split_at_mut((k + 1) * n);
            let multipliers = &mut done[k * n + k + 1..];
            multipliers.iter_mut().for_each(|l| *l /= pivot);
            take_out(multipliers, k, k + 1, rest, n);
        }
        Some(exchanged)
    }
}

vectorised! {
    /// Forward and back substitution of every column of `X`.
    fn substitute<'a>(factors: &'a Mat, exchanged: &'a [usize], X: &'a mut Mat) -> () {
        let n = factors.nrows();
        if n == 0 || X.ncols() == 0 {
            return;
        }
        for column in X.as_mut_slice().chunks_exact_mut(n) {
            exchanged.iter().enumerate().for_each(|(k, &row)| column.swap(k, row));
        }
        for k in 0..n {
            take_out(&factors.column(k)[k + 1..], k, k + 1, X.as_mut_slice(), n);
        }
        for k in (0..n).rev() {
            let pivot = factors[(k, k)];
            X.as_mut_slice()[k..].iter_mut().step_by(n).for_each(|x| *x /= pivot);
            take_out(&factors.column(k)[..k], k, 0, X.as_mut_slice(), n);
        }
    }
}

/// Returns where the entry of largest modulus is.
#[inline(always)]
fn largest(entries: &[f64]) -> usize {
    let mut best = 0;
    for (i, e) in entries.iter().enumerate() {
        if e.abs() > entries[best].abs() {
            best = i;
        }
    }
    best
}

/// Takes `v` times its entry `at` out of the entries `from..` of each column of length `ld`, four columns at a time.
#[inline(always)]
fn take_out(v: &[f64], at: usize, from: usize, columns: &mut [f64], ld: usize) {
    let to = from + v.len();
    let mut fours = columns.chunks_exact_mut(4 * ld);
    for four in &mut fours {
        let (left, right) = four.split_at_mut(2 * ld);
        let ((a, b), (c, d)) = (left.split_at_mut(ld), right.split_at_mut(ld));
        let factors = [a[at], b[at], c[at], d[at]];
        if factors == [0.0; 4] {
            continue;
        }
        let pairs =
            a[from..to].iter_mut().zip(&mut b[from..to]).zip(c[from..to].iter_mut().zip(&mut d[from..to]));
        for (((a, b), (c, d)), &v) in pairs.zip(v) {
            *a -= factors[0] * v;
            *b -= factors[1] * v;
            *c -= factors[2] * v;
            *d -= factors[3] * v;
        }
    }
    for column in fours.into_remainder().chunks_exact_mut(ld) {
        let factor = column[at];
        column[from..to].iter_mut().zip(v).for_each(|(x, &v)| *x -= factor * v);
    }
}

vectorised! {
    /// Overwrites a square matrix by its Hessenberg form `H`, `A = Q H Q'`, and returns `Q`.
    pub(crate) fn hessenberg<'a>(A: &'a mut Mat) -> Mat {
        let n = A.nrows();
        let reflectors = reduce(A);
        let mut Q = Mat::eye(n);
        for (k, reflector) in reflectors.iter().enumerate().rev() {
            reflector.apply_left(&mut Q.as_mut_slice()[(k + 1) * n..], n, k + 1);
        }
        Q
    }
}

vectorised! {
    /// Overwrites a square matrix by its Hessenberg form.
    pub(crate) fn hessenberg_values<'a>(A: &'a mut Mat) -> () {
        reduce(A);
    }
}

/// Overwrites a square matrix by its Hessenberg form; returns the reflections that lead there.
#[inline(always)]
fn reduce(A: &mut Mat) -> Vec<Reflector> {
    let n = A.nrows();
    let mut reflectors = Vec::with_capacity(n);
    for k in 0..n.saturating_sub(2) {
        let (done, rest) = A.as_mut_slice().split_at_mut((k + 1) * n);
        let reflector = Reflector::of(&mut done[k * n + k + 1..]);
        reflector.apply_left(rest, n, k + 1);
        reflector.apply_right(rest, n);
        reflectors.push(reflector);
    }
    reflectors
}

/// `I - tau v v'`, the first entry of `v` one.
#[derive(Debug)]
pub(crate) struct Reflector {
    v: Vec<f64>,
    tau: f64,
}

impl Reflector {
    /// The reflection that takes `x` to a multiple of the first unit vector; `x` becomes that.
    #[inline(always)]
    pub(crate) fn of(x: &mut [f64]) -> Self {
        let mut v = x.to_vec();
        let (alpha, tail) = (x[0], dot(&x[1..], &x[1..]));
        x[1..].fill(0.0);
        if tail < ZERO_COLUMN {
            return Self { v, tau: 0.0 };
        }
        let beta = -(alpha * alpha + tail).sqrt().copysign(alpha);
        x[0] = beta;
        v[0] = 1.0;
        let scale = 1.0 / (alpha - beta);
        v[1..].iter_mut().for_each(|e| *e *= scale);
        Self { v, tau: (beta - alpha) / beta }
    }

    /// Applied to the rows from `from` on of each column of length `ld`.
    #[inline(always)]
    pub(crate) fn apply_left(&self, columns: &mut [f64], ld: usize, from: usize) {
        if self.tau == 0.0 {
            return;
        }
        for column in columns.chunks_exact_mut(ld) {
            let part = &mut column[from..];
            let factor = self.tau * dot(&self.v, part);
            part.iter_mut().zip(&self.v).for_each(|(x, &v)| *x -= factor * v);
        }
    }

    /// Applied from the right to all rows of the columns of length `ld`, as many as `v` has entries.
    #[inline(always)]
    pub(crate) fn apply_right(&self, columns: &mut [f64], ld: usize) {
        if self.tau == 0.0 {
            return;
        }
        let mut sum = vec![0.0; ld];
        for (column, &v) in columns.chunks_exact(ld).zip(&self.v) {
            sum.iter_mut().zip(column).for_each(|(s, &x)| *s += v * x);
        }
        sum.iter_mut().for_each(|s| *s *= self.tau);
        for (column, &v) in columns.chunks_exact_mut(ld).zip(&self.v) {
            column.iter_mut().zip(&sum).for_each(|(x, &s)| *x -= s * v);
        }
    }
}

/// The scalar product by four partial sums, so that the additions overlap.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, others) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = fours.remainder().iter().zip(others.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in fours.zip(others) {
        (0..4).for_each(|i| sums[i] += x[i] * y[i]);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn sample(n: usize) -> Mat {
        Mat::from_fn(n, n, |i, j| ((5 * i + 7 * j) % 13) as f64 - 6.0 + if i == j { 3.5 } else { 0.0 })
    }

    #[test]
    fn systems_of_every_small_size_are_solved() {
        for n in 0..=SYSTEMS {
            let (A, X) = (sample(n), Mat::from_fn(n, n % 7 + 1, |i, j| (i + 3 * j) as f64));
            let found = solve(&A, &(&A * &X)).unwrap();
            assert!((&found - &X).norm_fro() <= 1e-11 * X.norm_fro().max(1.0), "{n}");
        }
        assert!(solve(&Mat::zeros(3, 3), &Mat::eye(3)).is_none());
    }

    #[test]
    fn the_hessenberg_form_is_a_similarity() {
        for n in [1, 2, 3, 4, 9, 20, SIMILARITIES] {
            let (A, mut H) = (sample(n), sample(n));
            let Q = hessenberg(&mut H);
            let tolerance = 1e-14 * (n as f64) * A.norm_fro();
            assert!((&A * &Q - &Q * &H).norm_fro() < tolerance, "{n}");
            assert!((Q.t() * &Q - Mat::eye(n)).norm_fro() < 1e-14 * n as f64);
            assert!((0..n).all(|j| H.column(j).iter().skip(j + 2).all(|&e| e == 0.0)));
        }
    }
}
