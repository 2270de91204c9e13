//! Matrices of numbers with 32 digits, each the unevaluated sum of two doubles, correct entry by entry.
//!
//! [`crate::extended_precision`] is faster, but its error is small beside the norms only. The hard problems whose entries spread over
//! many decades are solved with these matrices from the first step to the last.
//! Sources: Dekker, Numer. Math. 18 (1971); Hida, Li and Bailey, Algorithms for quad-double precision floating point
//! arithmetic, ARITH-15 (2001).

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::extended_precision::ExtendedMatrix;
use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::tolerance::LONG_PIVOT;

/// A number of about 32 decimal digits: `high + low`, `low` at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LongReal {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

impl LongReal {
    #[inline(always)]
    fn from_parts(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    /// Returns the root of a positive number: that of doubles and one step of Newton's method.
    fn square_root(self) -> Self {
        let first = Self::from(self.high.sqrt());
        first + (self - first * first) / Self::from(2.0 * first.high)
    }

    /// Returns `self + a b`.
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        let product = a.high * b.high;
        let lost = a.high.mul_add(b.high, -product) + (a.high * b.low + a.low * b.high);
        let sum = self.high + product;
        let back = sum - self.high;
        let error = (self.high - (sum - back)) + (product - back);
        Self::from_parts(sum, error + (self.low + lost))
    }
}

impl From<f64> for LongReal {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for LongReal {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for LongReal {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.plus_product(other, Self::from(1.0))
    }
}

impl Sub for LongReal {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for LongReal {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::default().plus_product(self, other)
    }
}

impl Div for LongReal {
    type Output = Self;
    /// Three steps of long division in doubles.
    fn div(self, other: Self) -> Self {
        let first = Self::from(self.high / other.high);
        let rest = self - first * other;
        let second = Self::from(rest.high / other.high);
        let third = Self::from((rest - second * other).high / other.high);
        first + second + third
    }
}

/// A matrix of [`LongReal`] numbers.
#[derive(Clone, Debug)]
pub(crate) struct LongMatrix {
    pub(crate) high: Mat,
    pub(crate) low: Mat,
}

impl From<&Mat> for LongMatrix {
    fn from(high: &Mat) -> Self {
        Self { high: high.clone(), low: Mat::zeros(high.nrows(), high.ncols()) }
    }
}

impl From<&ExtendedMatrix> for LongMatrix {
    fn from(sum: &ExtendedMatrix) -> Self {
        let low = sum.low.clone().unwrap_or_else(|| Mat::zeros(sum.high.nrows(), sum.high.ncols()));
        Self { high: sum.high.clone(), low }
    }
}

impl LongMatrix {
    /// The identity times a number.
    pub(crate) fn identity(n: usize, factor: f64) -> Self {
        Self::from(&Mat::eye(n).scale(factor))
    }

    /// The entry (i, j).
    pub(crate) fn at(&self, i: usize, j: usize) -> LongReal {
        LongReal { high: self.high[(i, j)], low: self.low[(i, j)] }
    }

    /// The nearest matrix of doubles.
    pub(crate) fn round(&self) -> Mat {
        &self.high + &self.low
    }

    pub(crate) fn t(&self) -> Self {
        Self { high: self.high.t(), low: self.low.t() }
    }

    /// Every entry times a power of two.
    pub(crate) fn scale(&self, power: f64) -> Self {
        Self { high: self.high.scale(power), low: self.low.scale(power) }
    }

    /// Entry (i, j) times `left[i] right[j]`, powers of two.
    pub(crate) fn rescale(&self, left: &[f64], right: &[f64]) -> Self {
        let scaled = |M: &Mat| Mat::from_fn(M.nrows(), M.ncols(), |i, j| left[i] * M[(i, j)] * right[j]);
        Self { high: scaled(&self.high), low: scaled(&self.low) }
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        add_into(&mut sum.high, &mut sum.low, &other.high, &other.low, LongReal::from(1.0));
        sum
    }

    pub(crate) fn difference(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        add_into(&mut sum.high, &mut sum.low, &other.high, &other.low, LongReal::from(-1.0));
        sum
    }

    /// Adds a multiple of another matrix.
    pub(crate) fn add_times(&mut self, other: &Self, factor: LongReal) {
        add_into(&mut self.high, &mut self.low, &other.high, &other.low, factor);
    }

    /// `(M + M') / 2`
    pub(crate) fn symmetric_part(&self) -> Self {
        self.plus(&self.t()).scale(0.5)
    }

    /// `[self other]`
    pub(crate) fn hstack(&self, other: &Self) -> Self {
        Self { high: self.high.hstack(&other.high), low: self.low.hstack(&other.low) }
    }

    /// The columns `from..from + count`.
    pub(crate) fn columns(&self, from: usize, count: usize) -> Self {
        let rows = self.high.nrows();
        Self { high: self.high.block(0, from, rows, count), low: self.low.block(0, from, rows, count) }
    }

    /// The block of `rows` x `cols` entries whose first one is at (top, left).
    pub(crate) fn block(&self, top: usize, left: usize, rows: usize, cols: usize) -> Self {
        Self { high: self.high.block(top, left, rows, cols), low: self.low.block(top, left, rows, cols) }
    }

    /// Writes `block` over the entries from (top, left) on.
    pub(crate) fn set_block(&mut self, top: usize, left: usize, block: &Self) {
        self.high.set_block(top, left, &block.high);
        self.low.set_block(top, left, &block.low);
    }

    /// The product, every entry to about 2^-100 of the sum of the moduli of its terms.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let (rows, cols) = (self.high.nrows(), other.high.ncols());
        let mut product = Self { high: Mat::zeros(rows, cols), low: Mat::zeros(rows, cols) };
        multiply(&self.high, &self.low, &other.high, &other.low, &mut product.high, &mut product.low);
        product
    }

    /// The solution `X` of `self X = B` by LU with partial pivoting; `None` if a pivot is zero.
    pub(crate) fn solve(&self, B: &Self) -> Option<Self> {
        let n = self.high.nrows();
        let (mut factors, mut X) = (self.clone(), B.clone());
        for k in 0..n {
            let row =
                (k..n).max_by(|&a, &b| factors.high[(a, k)].abs().total_cmp(&factors.high[(b, k)].abs()))?;
            factors.exchange(k, row);
            X.exchange(k, row);
            let pivot = factors.at(k, k);
            if pivot.high == 0.0 || !pivot.high.is_finite() {
                return None;
            }
            let multipliers: Vec<LongReal> = (k + 1..n).map(|i| factors.at(i, k) / pivot).collect();
            let multipliers = Column::of(&multipliers);
            eliminate(&mut factors.high, &mut factors.low, &multipliers, k, k + 1..n, k + 1);
            eliminate(&mut X.high, &mut X.low, &multipliers, k, k + 1..n, 0);
        }
        for k in (0..n).rev() {
            X.divide_row(k, factors.at(k, k));
            let column: Vec<LongReal> = (0..k).map(|i| factors.at(i, k)).collect();
            eliminate(&mut X.high, &mut X.low, &Column::of(&column), k, 0..k, 0);
        }
        X.high.is_finite().then_some(X)
    }

    /// A factor `L`, `L L' = self`, of a positive semidefinite matrix, lower triangular but for the order of its rows. The pivot is the diagonal entry
    /// of which the largest share is left: in the given order, rounding errors of the matrix over the root of a much smaller pivot would become
    /// entries of `L`. A direction that is left with rounding errors only gets a column of zeros.
    pub(crate) fn semidefinite_factor(&self) -> Self {
        let n = self.high.nrows();
        let (mut rest, mut L) = (self.clone(), Self::from(&Mat::zeros(n, n)));
        let mut open: Vec<usize> = (0..n).filter(|&k| self.high[(k, k)] > 0.0).collect();
        let share = |rest: &Self, k: usize| rest.high[(k, k)] / self.high[(k, k)];
        for column in 0..n {
            let largest =
                open.iter().enumerate().max_by(|a, b| share(&rest, *a.1).total_cmp(&share(&rest, *b.1)));
            let Some(k) = largest.map(|(at, _)| at).map(|at| open.swap_remove(at)) else { break };
            if share(&rest, k).is_nan() || share(&rest, k) <= LONG_PIVOT {
                break;
            }
            let pivot = rest.at(k, k).square_root();
            (L.high[(k, column)], L.low[(k, column)]) = (pivot.high, pivot.low);
            let entries: Vec<LongReal> = open.iter().map(|&i| rest.at(i, k) / pivot).collect();
            for (&i, entry) in open.iter().zip(&entries) {
                (L.high[(i, column)], L.low[(i, column)]) = (entry.high, entry.low);
                for (&j, other) in open.iter().zip(&entries) {
                    let left = rest.at(i, j) - *entry * *other;
                    (rest.high[(i, j)], rest.low[(i, j)]) = (left.high, left.low);
                }
            }
        }
        L
    }

    fn exchange(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        for M in [&mut self.high, &mut self.low] {
            (0..M.ncols()).for_each(|j| M.column_mut(j).swap(a, b));
        }
    }

    fn divide_row(&mut self, k: usize, pivot: LongReal) {
        for j in 0..self.high.ncols() {
            let quotient = self.at(k, j) / pivot;
            (self.high[(k, j)], self.low[(k, j)]) = (quotient.high, quotient.low);
        }
    }
}

/// A column of long numbers, the two parts apart.
struct Column {
    high: Vec<f64>,
    low: Vec<f64>,
}

impl Column {
    fn of(entries: &[LongReal]) -> Self {
        Self { high: entries.iter().map(|e| e.high).collect(), low: entries.iter().map(|e| e.low).collect() }
    }
}

/// `x += factor v`, entry by entry.
#[inline(always)]
fn add_multiple(x_high: &mut [f64], x_low: &mut [f64], v_high: &[f64], v_low: &[f64], factor: LongReal) {
    let entries = x_high.iter_mut().zip(x_low).zip(v_high.iter().zip(v_low));
    for ((high, low), (&a, &b)) in entries {
        let sum = LongReal { high: *high, low: *low }.plus_product(LongReal { high: a, low: b }, factor);
        (*high, *low) = (sum.high, sum.low);
    }
}

vectorised! {
    fn add_into<'a>(high: &'a mut Mat, low: &'a mut Mat, other: &'a Mat, rest: &'a Mat, factor: LongReal) -> () {
        add_multiple(high.as_mut_slice(), low.as_mut_slice(), other.as_slice(), rest.as_slice(), factor);
    }
}

vectorised! {
    fn multiply<'a>(A: &'a Mat, a: &'a Mat, B: &'a Mat, b: &'a Mat, high: &'a mut Mat, low: &'a mut Mat) -> () {
        for j in 0..B.ncols() {
            let out = (high.column_mut(j), low.column_mut(j));
            for k in 0..A.ncols() {
                let factor = LongReal { high: B[(k, j)], low: b[(k, j)] };
                if factor.high != 0.0 {
                    add_multiple(&mut *out.0, &mut *out.1, A.column(k), a.column(k), factor);
                }
            }
        }
    }
}

vectorised! {
    /// Takes `multipliers` times row `k` out of the rows `rows` of every column from `first` on.
    fn eliminate<'a>(high: &'a mut Mat, low: &'a mut Mat, multipliers: &'a Column, k: usize, rows: std::ops::Range<usize>, first: usize) -> () {
        for j in first..high.ncols() {
            let factor = LongReal { high: -high[(k, j)], low: -low[(k, j)] };
            if factor.high != 0.0 {
                let target = (&mut high.column_mut(j)[rows.clone()], &mut low.column_mut(j)[rows.clone()]);
                add_multiple(target.0, target.1, &multipliers.high, &multipliers.low, factor);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_hilbert_system_keeps_its_digits() {
        // The condition number of the Hilbert matrix of size 12 is 1.7e16: doubles keep nothing.
        let n = 12;
        let entry = |i: usize, j: usize| LongReal::from(1.0) / LongReal::from((i + j + 1) as f64);
        let H = LongMatrix {
            high: Mat::from_fn(n, n, |i, j| entry(i, j).high),
            low: Mat::from_fn(n, n, |i, j| entry(i, j).low),
        };
        let exact = LongMatrix::from(&Mat::from_fn(n, 3, |i, j| (i * i + 7 * j) as f64 - 20.0));
        let found = H.solve(&H.times(&exact)).unwrap();
        assert!(found.difference(&exact).round().norm_max() < 1e-11, "{:?}", found.difference(&exact).high);
        assert!(LongMatrix::from(&Mat::zeros(2, 2)).solve(&LongMatrix::identity(2, 1.0)).is_none());
    }

    #[test]
    fn a_semidefinite_matrix_is_the_square_of_its_factor() {
        // Columns over nine decades, the last a sum of the others: one direction is left with nothing.
        let W = Mat::from_fn(5, 4, |i, j| ((3 * i + 5 * j) % 7) as f64 * 10f64.powi(-3 * j as i32));
        let W = W.hstack(&(&W * &Mat::col(&[1.0, 1.0, 1.0, 1.0])));
        let P = LongMatrix::from(&W.t()).times(&LongMatrix::from(&W));
        let L = P.semidefinite_factor();
        let rest = L.times(&L.t()).difference(&P).round();
        let size = |i: usize| P.high[(i, i)].sqrt();
        assert!((0..5).all(|i| (0..5).all(|j| rest[(i, j)].abs() <= 1e-27 * size(i) * size(j))), "{rest:?}");
    }

    #[test]
    fn a_quotient_has_32_digits() {
        let third = LongReal::from(1.0) / LongReal::from(3.0);
        let rest = LongReal::from(1.0) - third * LongReal::from(3.0);
        assert!(rest.high.abs() < 1e-31, "{rest:?}");
    }
}
