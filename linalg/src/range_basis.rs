//! An orthogonal basis whose first vectors span the range of a matrix, kept as reflections: applied to a matrix of order n it costs
//! n^2 operations for each column of the matrix that it came from, not n^3.
//!
//! Source: Golub and Van Loan, Matrix Computations, 5.2 and 5.4.6 (QR first, then singular values of the triangle).

use crate::decomposition::{power_of_two, svd};
use crate::error::{Error, check_shape};
use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::small_factors::Reflector;

/// An orthogonal `U`, m x m, whose first [`rank`](Self::rank) columns span the range of a matrix with m rows.
#[derive(Debug)]
pub struct RangeBasis {
    rows: usize,
    reflectors: Vec<Reflector>,
    /// The matrix that turns the first rows after the reflections; orthogonal.
    top: Mat,
    rank: usize,
}

impl RangeBasis {
    /// Returns the basis of `M`, m x n, whose singular values above `tolerance` count.
    ///
    /// # Errors
    /// Entries that are not finite, or no convergence.
    pub fn of(M: &Mat, tolerance: f64) -> Result<Self, Error> {
        let (rows, cols) = M.shape();
        let size = M.norm_max();
        if rows == 0 || cols == 0 || size == 0.0 {
            return Ok(Self { rows, reflectors: Vec::new(), top: Mat::zeros(0, 0), rank: 0 });
        }
        // Near one the squares stay in range, and the basis does not depend on the size.
        let factor = power_of_two(1.0 / size);
        let mut R = M.scale(factor);
        let reflectors = if cols < rows { triangularise(&mut R) } else { Vec::new() };
        let parts = svd(&R.block(0, 0, rows.min(cols), cols))?;
        let rank = parts.s.iter().filter(|&&s| s > factor * tolerance).count();
        Ok(Self { rows, reflectors, top: parts.U, rank })
    }

    /// Returns how many singular values exceed the tolerance.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Returns `U' A` for `A` with m rows.
    ///
    /// # Errors
    /// Another number of rows.
    pub fn transpose_times(&self, A: &Mat) -> Result<Mat, Error> {
        check_shape("A", A, self.rows, A.ncols())?;
        let mut out = A.clone();
        reflect_rows(&self.reflectors, &mut out);
        let k = self.top.nrows();
        if k > 1 {
            out.set_block(0, 0, &(self.top.t() * &out.block(0, 0, k, A.ncols())));
        }
        Ok(out)
    }

    /// Returns `A U` for `A` with m columns.
    ///
    /// # Errors
    /// Another number of columns.
    pub fn times(&self, A: &Mat) -> Result<Mat, Error> {
        check_shape("A", A, A.nrows(), self.rows)?;
        let mut out = A.clone();
        reflect_columns(&self.reflectors, &mut out);
        let k = self.top.nrows();
        if k > 1 {
            out.set_block(0, 0, &(out.block(0, 0, A.nrows(), k) * &self.top));
        }
        Ok(out)
    }
}

vectorised! {
    /// Overwrites a tall matrix by its triangle; returns the reflections that lead there.
    fn triangularise<'a>(A: &'a mut Mat) -> Vec<Reflector> {
        let (rows, cols) = A.shape();
        let mut reflectors = Vec::with_capacity(cols);
        for k in 0..cols {
            let (done, rest) = A.as_mut_slice().split_at_mut((k + 1) * rows);
            let reflector = Reflector::of(&mut done[k * rows + k..]);
            reflector.apply_left(rest, rows, k);
            reflectors.push(reflector);
        }
        reflectors
    }
}

vectorised! {
    /// Reflects the columns of `A`, the first reflection first.
    fn reflect_rows<'a>(reflectors: &'a [Reflector], A: &'a mut Mat) -> () {
        let rows = A.nrows();
        for (k, reflector) in reflectors.iter().enumerate() {
            reflector.apply_left(A.as_mut_slice(), rows, k);
        }
    }
}

vectorised! {
    /// Reflects the rows of `A`, the first reflection first.
    fn reflect_columns<'a>(reflectors: &'a [Reflector], A: &'a mut Mat) -> () {
        let rows = A.nrows();
        if rows == 0 {
            return;
        }
        for (k, reflector) in reflectors.iter().enumerate() {
            reflector.apply_right(&mut A.as_mut_slice()[k * rows..], rows);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_first_vectors_span_the_range() {
        for (rows, cols, rank) in
            [(7, 3, 3), (7, 4, 2), (3, 7, 2), (5, 5, 5), (6, 1, 1), (1, 4, 1), (4, 2, 0)]
        {
            let left = Mat::from_fn(rows, rank, |i, j| ((1 + i * i + 3 * i * j + 7 * j) as f64).sin());
            let right = Mat::from_fn(rank, cols, |i, j| ((2 + 5 * i + i * j * j + 2 * j) as f64).cos());
            let M = (&left * &right).scale(1e-150);
            let basis = RangeBasis::of(&M, 1e-13 * M.norm_max()).unwrap();
            assert_eq!(basis.rank(), rank);
            let U = basis.times(&Mat::eye(rows)).unwrap();
            assert!((U.t() * &U - Mat::eye(rows)).norm_fro() < 1e-14);
            let A = Mat::from_fn(rows, 4, |i, j| (i + 2 * j) as f64);
            assert!((basis.transpose_times(&A).unwrap() - U.t() * &A).norm_fro() < 1e-13);
            let rest = basis.transpose_times(&M).unwrap().block(rank, 0, rows - rank, cols);
            assert!(rest.norm_max() <= 1e-14 * M.norm_max(), "{rows} {cols} {rank}");
        }
        assert!(RangeBasis::of(&Mat::eye(2), 0.0).unwrap().times(&Mat::eye(3)).is_err());
    }
}
