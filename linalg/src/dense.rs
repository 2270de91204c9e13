//! Linear systems and orthogonal factors: what the matrix equations are made of. Thin, checked wrappers of faer.
//!
//! Real and complex routines come in pairs and are not generic, so that dependants compile quickly.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::traits::ComplexField;
use faer::{MatMut, MatRef};

use crate::error::{Error, check_finite, check_shape, check_square};
use crate::mat::{C64, CMat, Dense, Mat, Scalar};
use crate::small_factors;

/// The matrix as faer sees it, without a copy.
pub(crate) fn view<T: Scalar>(A: &Dense<T>) -> MatRef<'_, T> {
    MatRef::from_column_major_slice(A.as_slice(), A.nrows(), A.ncols())
}

/// The matrix as faer writes it, without a copy.
pub(crate) fn view_mut<T: Scalar>(A: &mut Dense<T>) -> MatMut<'_, T> {
    let (rows, cols) = A.shape();
    MatMut::from_column_major_slice_mut(A.as_mut_slice(), rows, cols)
}

/// A copy of what faer computed.
pub(crate) fn copy<T: Scalar>(A: MatRef<'_, T>) -> Dense<T> {
    Dense::from_fn(A.nrows(), A.ncols(), |i, j| A[(i, j)])
}

/// Returns `A'B` without writing the transpose down; `A` n x k, `B` n x m, both tall.
///
/// # Errors
/// Returns [`Error::Shape`] if the numbers of rows differ.
pub fn transpose_times(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    let (n, m) = B.shape();
    if A.nrows() != n {
        let (rows, cols) = A.shape();
        return Err(Error::Shape { what: "A", rows, cols, needed_rows: n, needed_cols: cols });
    }
    let mut out = Mat::zeros(A.ncols(), m);
    if n > 0 && m > 0 && A.ncols() > 0 {
        let (left, seq) = (view(A).transpose(), faer::Par::Seq);
        faer::linalg::matmul::matmul(view_mut(&mut out), faer::Accum::Replace, left, view(B), 1.0, seq);
    }
    Ok(out)
}

/// Symmetric products with more rows than this are computed by halves: below, the calls of the kernel cost more than the half that they save.
pub(crate) const LARGE_SYMMETRIC: usize = 64;

/// Columns of a symmetric product that are computed together.
const STRIP: usize = 48;

/// Adds to the lower half of `out` that of `A B`; other entries are not determined.
pub(crate) fn add_lower_half(out: &mut Mat, A: MatRef<'_, f64>, B: MatRef<'_, f64>) {
    let (n, k) = (A.nrows(), A.ncols());
    let mut out = view_mut(out);
    for left in (0..n).step_by(STRIP) {
        let (rows, cols) = (n - left, STRIP.min(n - left));
        faer::linalg::matmul::matmul(
            out.as_mut().submatrix_mut(left, left, rows, cols),
            faer::Accum::Add,
            A.submatrix(left, 0, rows, k),
            B.submatrix(0, left, k, cols),
            1.0,
            faer::Par::Seq,
        );
    }
}

/// Copies the lower half of a square matrix to the upper one.
pub(crate) fn copy_lower_to_upper(M: &mut Mat) {
    let n = M.nrows();
    for top in (0..n).step_by(STRIP) {
        for j in top + 1..n {
            let rows = top..(top + STRIP).min(j);
            rows.for_each(|i| M[(i, j)] = M[(j, i)]);
        }
    }
}

/// `A B`, which is known to be symmetric; half of it is computed if it is large.
pub(crate) fn symmetric_product(A: MatRef<'_, f64>, B: &Mat) -> Mat {
    let mut out = Mat::zeros(A.nrows(), B.ncols());
    add_lower_half(&mut out, A, view(B));
    copy_lower_to_upper(&mut out);
    out
}

/// Solves `A X = B` by LU with partial pivoting; `A` n x n, `B` n x m.
///
/// # Errors
/// Wrong shapes, entries that are not finite, and a pivot that is zero to working precision ([`Error::Singular`]).
pub fn solve(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    if A.nrows() > small_factors::SYSTEMS {
        return lu_solve(A, B);
    }
    check_square("A", A)?;
    check_shape("B", B, A.nrows(), B.ncols())?;
    let singular = Error::Singular { what: "A", rcond: 0.0 };
    small_factors::solve(A, B).filter(Mat::is_finite).ok_or(singular)
}

/// The largest of the moduli of a matrix's entries, each over that of another one of non-negative entries; an entry of zero counts as nothing.
pub(crate) fn largest_share(entries: &Mat, sizes: &Mat) -> f64 {
    let shares = entries.as_slice().iter().zip(sizes.as_slice()).filter(|(entry, _)| **entry != 0.0);
    shares.fold(
        0.0,
        |worst, (entry, size)| {
            if entry.abs() <= worst * size { worst } else { entry.abs() / size }
        },
    )
}

/// Returns the power of two that brings a size to about 1; 1 if the size is zero, not finite or below the normal numbers.
pub fn unit_power(size: f64) -> f64 {
    if size.is_normal() { (-size.log2().round()).exp2() } else { 1.0 }
}

/// Solves the complex system `A X = B` by LU with partial pivoting. Errors as for [`solve`].
pub fn csolve(A: &CMat, B: &CMat) -> Result<CMat, Error> {
    lu_solve(A, B)
}

/// Returns the inverse of a square matrix, by LU with partial pivoting.
///
/// # Errors
/// As for [`solve`].
pub fn inverse(A: &Mat) -> Result<Mat, Error> {
    check_square("A", A)?;
    if A.nrows() <= small_factors::SYSTEMS {
        return solve(A, &Mat::eye(A.nrows()));
    }
    let lu = view(A).partial_piv_lu();
    check_pivots(lu.U())?;
    Ok(copy(lu.inverse().as_ref()))
}

fn lu_solve<T: Scalar + ComplexField>(A: &Dense<T>, B: &Dense<T>) -> Result<Dense<T>, Error> {
    check_square("A", A)?;
    check_shape("B", B, A.nrows(), B.ncols())?;
    let lu = view(A).partial_piv_lu();
    check_pivots(lu.U())?;
    let mut X = B.clone();
    lu.solve_in_place(view_mut(&mut X));
    if !X.is_finite() {
        return Err(Error::Singular { what: "A", rcond: 0.0 });
    }
    Ok(X)
}

/// The LU factors of a matrix, for several right-hand sides one after the other.
pub(crate) struct Factors<T: Scalar + ComplexField>(faer::linalg::solvers::PartialPivLu<T>);

impl<T: Scalar + ComplexField> Factors<T> {
    /// The factors.
    ///
    /// # Errors
    /// As for [`csolve`].
    pub(crate) fn of(A: &Dense<T>) -> Result<Self, Error> {
        check_square("A", A)?;
        let lu = view(A).partial_piv_lu();
        check_pivots(lu.U())?;
        Ok(Self(lu))
    }

    /// `A^-1 B`, to the last bit as [`csolve`] has it.
    ///
    /// # Errors
    /// As for [`csolve`].
    pub(crate) fn solve(&self, mut B: Dense<T>) -> Result<Dense<T>, Error> {
        check_shape("B", &B, self.0.U().nrows(), B.ncols())?;
        self.0.solve_in_place(view_mut(&mut B));
        if B.is_finite() { Ok(B) } else { Err(Error::Singular { what: "A", rcond: 0.0 }) }
    }
}

/// The smallest pivot against the largest is a cheap upper bound of the reciprocal condition number.
fn check_pivots<T: Scalar>(U: MatRef<'_, T>) -> Result<(), Error> {
    let pivots: Vec<f64> = (0..U.nrows()).map(|i| U[(i, i)].modulus()).collect();
    if pivots.contains(&0.0) {
        return Err(Error::Singular { what: "A", rcond: 0.0 });
    }
    Ok(())
}

/// Returns the Cholesky factor: lower triangular `L` with `A = L L'`, `A` symmetric positive definite (its lower half is read).
///
/// # Errors
/// Not square, not finite, or [`Error::NotPositiveDefinite`].
pub fn cholesky(A: &Mat) -> Result<Mat, Error> {
    check_square("A", A)?;
    let llt = view(A).llt(faer::Side::Lower).map_err(|_| Error::NotPositiveDefinite { what: "A" })?;
    let L = llt.L();
    Ok(Mat::from_fn(A.nrows(), A.nrows(), |i, j| if i >= j { L[(i, j)] } else { 0.0 }))
}

/// A thin QR factorisation `A = Q R`: `A` m x n, `Q` m x k with orthonormal columns, `R` k x n upper triangular,
/// k = min(m, n). By Householder reflections.
#[derive(Debug, Clone)]
pub struct Qr {
    /// Orthonormal columns, m x k.
    pub Q: Mat,
    /// Upper triangular, k x n.
    pub R: Mat,
}

/// Returns the thin QR factorisation of any real matrix.
///
/// # Errors
/// Entries that are not finite.
pub fn qr(A: &Mat) -> Result<Qr, Error> {
    check_finite("A", A)?;
    let factors = view(A).qr();
    Ok(Qr { Q: copy(factors.compute_thin_Q().as_ref()), R: copy(factors.thin_R()) })
}

/// Returns the triangle of a thin QR factorisation alone: `R` with `A'A = R'R`.
///
/// # Errors
/// Entries that are not finite.
pub fn qr_r(A: &Mat) -> Result<Mat, Error> {
    check_finite("A", A)?;
    Ok(copy(view(A).qr().thin_R()))
}

/// Returns an orthonormal basis of the range and of its complement: the full m x m `Q` of `A = Q [R; 0]`.
///
/// # Errors
/// Entries that are not finite.
pub fn qr_full_q(A: &Mat) -> Result<Mat, Error> {
    check_finite("A", A)?;
    Ok(copy(view(A).qr().compute_Q().as_ref()))
}

/// Returns `u' v` without conjugation.
pub fn dot(u: &[f64], v: &[f64]) -> f64 {
    u.iter().zip(v).map(|(a, b)| a * b).sum()
}

/// Returns the determinant of a square complex matrix, by LU.
///
/// # Errors
/// Not square, or entries that are not finite.
pub fn cdet(A: &CMat) -> Result<C64, Error> {
    check_square("A", A)?;
    let value = view(A).determinant();
    if value.is_nan() { Err(Error::OutOfRange { what: "the determinant" }) } else { Ok(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_a_symmetric_product_is_the_whole() {
        for n in [1, 2, STRIP - 1, STRIP, STRIP + 1, 2 * STRIP + 7] {
            let A = Mat::from_fn(n, n + 3, |i, j| ((5 * i + 3 * j) % 11) as f64 - 5.0);
            // Small whole numbers: every order of the sums gives the same.
            assert_eq!(symmetric_product(view(&A), &A.t()), &A * A.t(), "{n}");
        }
    }
}
