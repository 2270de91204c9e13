//! The dense matrix that every crate of the workspace passes around: real [`Mat`], complex [`CMat`].
//!
//! Column-major, owned, without views: the sizes of this tool are small (10 to 600), and a plain value is easier to
//! hand over than a borrow. Shapes that do not fit are a programming error and are asserted; a public routine that
//! takes matrices from outside checks them first and returns an error.

use std::fmt;
use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

pub use crate::scalar::{C64, Scalar};
use crate::tolerance::SAFE_SQUARES;

/// A dense real matrix.
pub type Mat = Dense<f64>;

/// A dense complex matrix.
pub type CMat = Dense<C64>;

/// Side of the tiles in which a matrix is transposed.
const TILE: usize = 16;

/// Columns of a tile that are transposed side by side: a line of the cache holds eight doubles.
const STRIPE: usize = 8;

/// A dense column-major matrix of `T`.
#[derive(Clone, PartialEq)]
pub struct Dense<T> {
    rows: usize,
    cols: usize,
    data: Vec<T>,
}

impl<T: Scalar> Dense<T> {
    /// Returns the `rows` x `cols` matrix of zeros.
    pub fn zeros(rows: usize, cols: usize) -> Self {
        Self { rows, cols, data: vec![T::ZERO; rows * cols] }
    }

    /// Returns the identity of size `n`.
    pub fn eye(n: usize) -> Self {
        let mut out = Self::zeros(n, n);
        out.data.iter_mut().step_by(n + 1).for_each(|e| *e = T::ONE);
        out
    }

    /// Returns the matrix whose entry (i, j) is `entry(i, j)`.
    pub fn from_fn(rows: usize, cols: usize, mut entry: impl FnMut(usize, usize) -> T) -> Self {
        let mut data = Vec::with_capacity(rows * cols);
        for j in 0..cols {
            data.extend((0..rows).map(|i| entry(i, j)));
        }
        Self { rows, cols, data }
    }

    /// Returns the matrix with the given rows, all of one length.
    pub fn from_rows<R: AsRef<[T]>>(rows: &[R]) -> Self {
        let cols = rows.first().map_or(0, |row| row.as_ref().len());
        assert!(rows.iter().all(|row| row.as_ref().len() == cols), "rows of different lengths");
        Self::from_fn(rows.len(), cols, |i, j| rows[i].as_ref()[j])
    }

    /// Returns the matrix with the given column-major data.
    pub fn from_column_major(rows: usize, cols: usize, data: Vec<T>) -> Self {
        assert_eq!(data.len(), rows * cols, "data does not fill {rows} x {cols}");
        Self { rows, cols, data }
    }

    /// Returns a column vector.
    pub fn col(entries: &[T]) -> Self {
        Self::from_column_major(entries.len(), 1, entries.to_vec())
    }

    /// Returns a row vector.
    pub fn row(entries: &[T]) -> Self {
        Self::from_column_major(1, entries.len(), entries.to_vec())
    }

    /// Returns the square matrix with the given diagonal.
    pub fn diag(entries: &[T]) -> Self {
        let n = entries.len();
        Self::from_fn(n, n, |i, j| if i == j { entries[i] } else { T::ZERO })
    }

    /// Returns the matrix put together from blocks, row of blocks by row of blocks.
    pub fn from_blocks(blocks: &[&[&Self]]) -> Self {
        let rows: usize = blocks.iter().map(|line| line[0].rows).sum();
        let cols: usize = blocks.first().map_or(0, |line| line.iter().map(|b| b.cols).sum());
        let mut out = Self::zeros(rows, cols);
        let mut top = 0;
        for line in blocks {
            let mut left = 0;
            for block in *line {
                out.set_block(top, left, block);
                left += block.cols;
            }
            assert_eq!(left, cols, "rows of blocks of different widths");
            top += line[0].rows;
        }
        out
    }

    /// Returns `[a b]`.
    pub fn hstack(&self, right: &Self) -> Self {
        Self::from_blocks(&[&[self, right]])
    }

    /// Returns `[a; b]`.
    pub fn vstack(&self, below: &Self) -> Self {
        Self::from_blocks(&[&[self], &[below]])
    }

    /// Returns the block-diagonal matrix of `self` and `other`.
    pub fn block_diag(&self, other: &Self) -> Self {
        let mut out = Self::zeros(self.rows + other.rows, self.cols + other.cols);
        out.set_block(0, 0, self);
        out.set_block(self.rows, self.cols, other);
        out
    }

    /// Returns the number of rows.
    pub fn nrows(&self) -> usize {
        self.rows
    }

    /// Returns the number of columns.
    pub fn ncols(&self) -> usize {
        self.cols
    }

    /// Returns (rows, columns).
    pub fn shape(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    /// Returns whether there are as many rows as columns.
    pub fn is_square(&self) -> bool {
        self.rows == self.cols
    }

    /// Returns the entries, column by column.
    pub fn as_slice(&self) -> &[T] {
        &self.data
    }

    /// Returns the entries, column by column, to write.
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// Returns column `j`.
    pub fn column(&self, j: usize) -> &[T] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Returns column `j`, to write.
    pub fn column_mut(&mut self, j: usize) -> &mut [T] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Returns row `i`, copied.
    pub fn row_vec(&self, i: usize) -> Vec<T> {
        (0..self.cols).map(|j| self[(i, j)]).collect()
    }

    /// Returns the diagonal.
    pub fn diagonal(&self) -> Vec<T> {
        (0..self.rows.min(self.cols)).map(|i| self[(i, i)]).collect()
    }

    /// Returns the transpose.
    pub fn t(&self) -> Self {
        if self.rows <= TILE && self.cols <= TILE {
            let mut data = Vec::with_capacity(self.data.len());
            (0..self.rows).for_each(|i| data.extend(self.data.iter().skip(i).step_by(self.rows)));
            return Self { rows: self.cols, cols: self.rows, data };
        }
        let mut out = Self::zeros(self.cols, self.rows);
        for top in (0..self.rows).step_by(TILE) {
            for left in (0..self.cols).step_by(STRIPE) {
                self.transpose_tile(&mut out, top, left);
            }
        }
        out
    }

    /// Writes the transpose of the tile at (top, left): [`STRIPE`] columns side by side.
    fn transpose_tile(&self, out: &mut Self, top: usize, left: usize) {
        let height = TILE.min(self.rows - top);
        let column = |j: usize| &self.data[j * self.rows + top..][..height];
        let rows = out.data[top * self.cols..].chunks_exact_mut(self.cols).take(height);
        if left + STRIPE > self.cols {
            for (i, row) in rows.enumerate() {
                row[left..].iter_mut().zip(left..).for_each(|(t, j)| *t = column(j)[i]);
            }
            return;
        }
        let columns: [&[T]; STRIPE] = std::array::from_fn(|q| column(left + q));
        for (i, row) in rows.enumerate() {
            row[left..left + STRIPE].iter_mut().zip(columns).for_each(|(t, column)| *t = column[i]);
        }
    }

    /// Returns the conjugate transpose.
    pub fn h(&self) -> Self {
        Self::from_fn(self.cols, self.rows, |i, j| self[(j, i)].conjugate())
    }

    /// Returns the block of `rows` x `cols` entries whose first one is at (top, left).
    pub fn block(&self, top: usize, left: usize, rows: usize, cols: usize) -> Self {
        assert!(top + rows <= self.rows, "the block reaches below the matrix");
        let mut data = Vec::with_capacity(rows * cols);
        for j in left..left + cols {
            data.extend_from_slice(&self.column(j)[top..top + rows]);
        }
        Self { rows, cols, data }
    }

    /// Writes `block` over the entries from (top, left) on.
    pub fn set_block(&mut self, top: usize, left: usize, block: &Self) {
        for j in 0..block.cols {
            self.column_mut(left + j)[top..top + block.rows].copy_from_slice(block.column(j));
        }
    }

    /// Returns the rows and columns with the given indices, in that order.
    pub fn select(&self, rows: &[usize], cols: &[usize]) -> Self {
        Self::from_fn(rows.len(), cols.len(), |i, j| self[(rows[i], cols[j])])
    }

    /// Returns `self` times a number.
    pub fn scale(&self, factor: T) -> Self {
        self.map(|entry| entry * factor)
    }

    /// Returns the matrix with `change` applied to every entry.
    pub fn map<U: Scalar>(&self, mut change: impl FnMut(T) -> U) -> Dense<U> {
        Dense { rows: self.rows, cols: self.cols, data: self.data.iter().map(|&e| change(e)).collect() }
    }

    /// Returns the sum of the diagonal.
    pub fn trace(&self) -> T {
        self.diagonal().into_iter().fold(T::ZERO, |sum, entry| sum + entry)
    }

    /// Returns the square root of the sum of the squares, scaled against overflow.
    pub fn norm_fro(&self) -> f64 {
        let plain = T::sum_of_squares(&self.data);
        if plain > SAFE_SQUARES.0 && plain < SAFE_SQUARES.1 {
            return plain.sqrt();
        }
        let largest = self.norm_max();
        if largest == 0.0 || !largest.is_finite() {
            return largest;
        }
        let sum: f64 = self.data.iter().map(|e| (e.modulus() / largest).powi(2)).sum();
        largest * sum.sqrt()
    }

    /// Returns the largest modulus of an entry; NaN if an entry is NaN.
    pub fn norm_max(&self) -> f64 {
        self.data.iter().map(|e| e.modulus()).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
    }

    /// Returns the largest column sum of moduli.
    pub fn norm_one(&self) -> f64 {
        (0..self.cols).map(|j| self.column(j).iter().map(|e| e.modulus()).sum()).fold(0.0, f64::max)
    }

    /// Returns whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        T::all_finite(&self.data)
    }
}

impl Mat {
    /// Adds `A B`.
    pub(crate) fn add_product(&mut self, A: &Self, B: &Self) {
        assert_eq!((A.cols, self.shape()), (B.rows, (A.rows, B.cols)), "shapes differ");
        f64::gemm(A.rows, A.cols, B.cols, &A.data, &B.data, &mut self.data);
    }

    /// Returns `(A + A') / 2`.
    pub fn symmetric_part(&self) -> Self {
        let (mut out, n) = (self.clone(), self.rows);
        for left in (0..n).step_by(TILE) {
            for top in (left..n).step_by(TILE) {
                for j in left..(left + TILE).min(n) {
                    for i in top.max(j)..(top + TILE).min(n) {
                        let (below, above) = (i + j * n, j + i * n);
                        let mean = 0.5 * (out.data[below] + out.data[above]);
                        (out.data[below], out.data[above]) = (mean, mean);
                    }
                }
            }
        }
        out
    }

    /// Returns the same numbers as complex ones.
    pub fn to_complex(&self) -> CMat {
        self.map(|entry| C64::new(entry, 0.0))
    }
}

impl<T> Index<(usize, usize)> for Dense<T> {
    type Output = T;
    fn index(&self, (i, j): (usize, usize)) -> &T {
        debug_assert!(i < self.rows && j < self.cols, "({i}, {j}) is outside {} x {}", self.rows, self.cols);
        &self.data[j * self.rows + i]
    }
}

impl<T> IndexMut<(usize, usize)> for Dense<T> {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut T {
        debug_assert!(i < self.rows && j < self.cols, "({i}, {j}) is outside {} x {}", self.rows, self.cols);
        &mut self.data[j * self.rows + i]
    }
}

macro_rules! elementwise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<T: Scalar> $trait<&Dense<T>> for &Dense<T> {
            type Output = Dense<T>;
            fn $method(self, other: &Dense<T>) -> Dense<T> {
                assert_eq!(self.shape(), other.shape(), "shapes differ");
                let data = self.data.iter().zip(&other.data).map(|(&a, &b)| a $op b).collect();
                Dense { rows: self.rows, cols: self.cols, data }
            }
        }
        by_value!($trait, $method);
    };
}

macro_rules! by_value {
    ($trait:ident, $method:ident) => {
        impl<T: Scalar> $trait<Dense<T>> for Dense<T> {
            type Output = Dense<T>;
            fn $method(self, other: Dense<T>) -> Dense<T> {
                $trait::$method(&self, &other)
            }
        }
        impl<T: Scalar> $trait<&Dense<T>> for Dense<T> {
            type Output = Dense<T>;
            fn $method(self, other: &Dense<T>) -> Dense<T> {
                $trait::$method(&self, other)
            }
        }
        impl<T: Scalar> $trait<Dense<T>> for &Dense<T> {
            type Output = Dense<T>;
            fn $method(self, other: Dense<T>) -> Dense<T> {
                $trait::$method(self, &other)
            }
        }
    };
}

elementwise!(Add, add, +);
elementwise!(Sub, sub, -);

impl<T: Scalar> Mul<&Dense<T>> for &Dense<T> {
    type Output = Dense<T>;
    fn mul(self, other: &Dense<T>) -> Dense<T> {
        assert_eq!(self.cols, other.rows, "{:?} times {:?}", self.shape(), other.shape());
        let mut out = Dense::zeros(self.rows, other.cols);
        T::gemm(self.rows, self.cols, other.cols, &self.data, &other.data, &mut out.data);
        out
    }
}
by_value!(Mul, mul);

impl<T: Scalar> Neg for &Dense<T> {
    type Output = Dense<T>;
    fn neg(self) -> Dense<T> {
        self.map(|entry| -entry)
    }
}

impl<T: Scalar> Neg for Dense<T> {
    type Output = Dense<T>;
    fn neg(self) -> Dense<T> {
        -&self
    }
}

impl<T: Scalar> AddAssign<&Dense<T>> for Dense<T> {
    fn add_assign(&mut self, other: &Dense<T>) {
        assert_eq!(self.shape(), other.shape(), "shapes differ");
        self.data.iter_mut().zip(&other.data).for_each(|(a, &b)| *a += b);
    }
}

impl<T: Scalar> SubAssign<&Dense<T>> for Dense<T> {
    fn sub_assign(&mut self, other: &Dense<T>) {
        assert_eq!(self.shape(), other.shape(), "shapes differ");
        self.data.iter_mut().zip(&other.data).for_each(|(a, &b)| *a -= b);
    }
}

impl<T: Scalar> fmt::Debug for Dense<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} x {}", self.rows, self.cols)?;
        (0..self.rows).try_for_each(|i| writeln!(f, "{:?}", self.row_vec(i)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_go_where_they_belong() {
        let a = Mat::from_rows(&[&[1.0, 2.0]]);
        let b = Mat::from_rows(&[&[3.0]]);
        let c = Mat::from_blocks(&[&[&a, &b], &[&b, &a]]);
        assert_eq!(c, Mat::from_rows(&[&[1.0, 2.0, 3.0], &[3.0, 1.0, 2.0]]));
        assert_eq!(c.block(1, 1, 1, 2), a);
    }

    #[test]
    fn norms_do_not_overflow() {
        let a = Mat::from_rows(&[&[3e200, 4e200]]);
        assert!((a.norm_fro() / 5e200 - 1.0).abs() < 1e-15);
    }
}
