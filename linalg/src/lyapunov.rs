//! Lyapunov equations, continuous and discrete, solved for the whole matrix.

use crate::error::{Error, check_shape, check_square};
use crate::mat::Mat;
use crate::schur::{Schur, schur};
use crate::sylvester::{Kind, solve_with_forms};

/// Solves `A X + X A' + Q = 0`; all n x n. `X` is symmetric where `Q` is, and positive semidefinite where `A` is stable
/// and `Q` is positive semidefinite.
///
/// A unique solution exists if and only if no two eigenvalues of `A` sum to zero (stable `A`: always).
/// Method: balancing by powers of two, one real Schur form, Bartels and Stewart by recursive blocks. Cost about 32 n^3.
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::CommonEigenvalue`].
pub fn lyap(A: &Mat, Q: &Mat) -> Result<Mat, Error> {
    solve(A, Q, Kind::Continuous)
}

/// Solves `A X A' - X + Q = 0`; all n x n. Symmetry and definiteness as for [`lyap`].
///
/// A unique solution exists if and only if no product of two eigenvalues of `A` is 1 (all moduli below 1: always).
/// Method, cost and errors as for [`lyap`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::CommonEigenvalue`].
pub fn dlyap(A: &Mat, Q: &Mat) -> Result<Mat, Error> {
    solve(A, Q, Kind::Discrete)
}

fn solve(A: &Mat, Q: &Mat, kind: Kind) -> Result<Mat, Error> {
    check_square("A", A)?;
    check_shape("Q", Q, A.shape())?;
    let balanced = crate::balance::balance(A)?;
    let d = &balanced.scale;
    let inner = Mat::from_fn(Q.nrows(), Q.ncols(), |i, j| Q[(i, j)] / d[i] / d[j]);
    let form = schur(&balanced.A)?;
    let X = solve_with_form(&form, &inner, kind)?;
    let X = if is_symmetric(Q) { X.symmetric_part() } else { X };
    Ok(Mat::from_fn(X.nrows(), X.ncols(), |i, j| X[(i, j)] * d[i] * d[j]))
}

fn is_symmetric(Q: &Mat) -> bool {
    *Q == Q.t()
}

/// The equation for a matrix whose Schur form is known.
pub(crate) fn solve_with_form(form: &Schur, Q: &Mat, kind: Kind) -> Result<Mat, Error> {
    solve_with_forms(form, &transposed(form), &-Q, kind)
}

/// The Schur form of `A'`: rows, columns and blocks in reverse order.
pub(crate) fn transposed(form: &Schur) -> Schur {
    let n = form.T.nrows();
    let T = Mat::from_fn(n, n, |i, j| form.T[(n - 1 - j, n - 1 - i)]);
    let U = Mat::from_fn(n, n, |i, j| form.U[(i, n - 1 - j)]);
    Schur { T, U }
}
