//! A matrix whose entries remember how large the numbers were that they were summed from: an entry that cancelled to
//! rounding error is known to be zero, whatever the scale of its neighbours.

use crate::tolerance::{CANCELLED, CANCELLED_TO_ROUNDING};
use counterpoise_linalg::{self as linalg, Mat};

#[derive(Debug, Clone)]
pub(crate) struct TrackedMatrix {
    /// The entries.
    pub value: Mat,
    /// The largest sums of magnitudes that made them.
    size: Mat,
    /// The share of its size below which an entry counts as zero.
    cancelled: f64,
    /// `true` if an entry counted as zero that is more than the rounding of what it was summed from.
    pub lost_more_than_rounding: bool,
}

impl TrackedMatrix {
    /// Takes data as they are given: nothing has cancelled yet.
    pub fn of(value: Mat) -> Self {
        Self::with_share(value, CANCELLED)
    }

    /// Takes data of which sums below a share of their terms count as zero.
    pub fn with_share(value: Mat, cancelled: f64) -> Self {
        let size = value.map(f64::abs);
        Self { value, size, cancelled, lost_more_than_rounding: false }
    }

    pub fn select(&self, rows: &[usize], cols: &[usize]) -> Self {
        Self { value: self.value.select(rows, cols), size: self.size.select(rows, cols), ..*self }
    }

    /// Returns whether the whole column is zero.
    pub fn column_is_zero(&self, j: usize) -> bool {
        self.value.column(j).iter().all(|&entry| entry == 0.0)
    }

    /// Returns the transpose.
    pub fn t(&self) -> Self {
        Self { value: self.value.t(), size: self.size.t(), ..*self }
    }

    /// Returns the rows of `self` above those of `below`.
    pub fn vstack(&self, below: &Self) -> Self {
        let lost_more_than_rounding = self.lost_more_than_rounding || below.lost_more_than_rounding;
        let (value, size) = (self.value.vstack(&below.value), self.size.vstack(&below.size));
        Self { value, size, lost_more_than_rounding, ..*self }
    }

    /// Returns self + left right, entries that cancel set to zero.
    pub fn plus_product(&self, left: &Mat, right: &Self) -> Self {
        self.t().minus_product(&right.t(), &-&left.t()).t()
    }

    /// Returns self - left right, entries that cancel set to zero.
    pub fn minus_product(&self, left: &Self, right: &Mat) -> Self {
        let value = &self.value - &(&left.value * right);
        let size = &self.size + &(&left.size * &right.map(f64::abs));
        let lost_more_than_rounding = self.lost_more_than_rounding || left.lost_more_than_rounding;
        let mut found = Self { value, size, lost_more_than_rounding, ..*self };
        (0..found.value.ncols()).for_each(|j| found.clean(j));
        found
    }

    /// Subtracts `factors[i]` times row p from each row i.
    fn reduce_rows(&mut self, p: usize, factors: &[f64]) {
        for j in 0..self.value.ncols() {
            let (pivot, size) = (self.value[(p, j)], self.size[(p, j)]);
            if pivot == 0.0 {
                continue;
            }
            let entries = self.value.column_mut(j).iter_mut().zip(self.size.column_mut(j)).zip(factors);
            for ((value, total), &factor) in entries.filter(|(_, factor)| **factor != 0.0) {
                *value -= factor * pivot;
                *total += factor.abs() * size;
            }
            self.clean(j);
        }
    }

    fn clean(&mut self, j: usize) {
        for (value, size) in self.value.column_mut(j).iter_mut().zip(self.size.column(j)) {
            if value.abs() <= self.cancelled * size {
                self.lost_more_than_rounding |= value.abs() > CANCELLED_TO_ROUNDING * size;
                *value = 0.0;
            }
        }
    }
}

/// An entry by which an elimination divides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pivot {
    /// Row, from 0.
    pub row: usize,
    /// Column, from 0.
    pub column: usize,
}

/// Gauss' elimination of `rows` of M with complete pivoting among `cols`; the same row operations are applied to
/// `others`. Pivots leave both lists: rows that remain are zero in these columns. Returns the pivots.
pub(crate) fn eliminate(
    M: &mut TrackedMatrix,
    others: &mut [&mut TrackedMatrix],
    rows: &mut Vec<usize>,
    cols: &mut Vec<usize>,
) -> Vec<Pivot> {
    let mut pivots = Vec::new();
    while let Some((i, j)) = largest(&M.value, rows, cols) {
        let (p, q) = (rows.swap_remove(i), cols.swap_remove(j));
        let mut factors = vec![0.0; M.value.nrows()];
        for &row in rows.iter() {
            factors[row] = M.value[(row, q)] / M.value[(p, q)];
        }
        M.reduce_rows(p, &factors);
        others.iter_mut().for_each(|other| other.reduce_rows(p, &factors));
        rows.iter().for_each(|&row| M.value[(row, q)] = 0.0);
        pivots.push(Pivot { row: p, column: q });
    }
    pivots
}

/// Returns the place in the lists of the largest entry, `None` if all are zero.
fn largest(M: &Mat, rows: &[usize], cols: &[usize]) -> Option<(usize, usize)> {
    let (mut best, mut found) = (0.0, None);
    for (j, &col) in cols.iter().enumerate() {
        let column = M.column(col);
        for (i, &row) in rows.iter().enumerate() {
            if column[row].abs() > best {
                (best, found) = (column[row].abs(), Some((i, j)));
            }
        }
    }
    found
}

/// Returns the solution of `M[rows, cols] X = right[rows]`, the columns being those of pivots in these rows.
pub(crate) fn solve_pivots(M: &Mat, pivots: &[Pivot], right: &Mat) -> Result<Mat, linalg::Error> {
    let rows: Vec<usize> = pivots.iter().map(|pivot| pivot.row).collect();
    let cols: Vec<usize> = pivots.iter().map(|pivot| pivot.column).collect();
    let every: Vec<usize> = (0..right.ncols()).collect();
    if rows.is_empty() {
        return Ok(Mat::zeros(0, right.ncols()));
    }
    linalg::solve(&M.select(&rows, &cols), &right.select(&rows, &every))
}
