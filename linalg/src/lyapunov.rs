//! Lyapunov equations, continuous and discrete, solved for the whole matrix.

use crate::error::{Error, check_shape, check_square};
use crate::mat::Mat;
use crate::schur::{Schur, schur};
use crate::sylvester::{Kind, check_spectra, solve_triangular};

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
    let X = Operator::new(schur(&balanced.A)?, kind)?.solve(&inner);
    let X = if is_symmetric(Q) { X.symmetric_part() } else { X };
    Ok(Mat::from_fn(X.nrows(), X.ncols(), |i, j| X[(i, j)] * d[i] * d[j]))
}

fn is_symmetric(Q: &Mat) -> bool {
    *Q == Q.t()
}

/// A Lyapunov operator `X -> A X + X A'` or `X -> A X A' - X` that is inverted more than once.
pub(crate) struct Operator {
    /// `A = U T U'`
    pub(crate) form: Schur,
    /// The triangle of `A'` with its rows and columns in reverse order.
    reversed: Mat,
    kind: Kind,
}

impl Operator {
    /// The operator of the matrix with the given Schur form.
    pub(crate) fn new(form: Schur, kind: Kind) -> Result<Self, Error> {
        let eigenvalues = form.eigenvalues();
        check_spectra(&eigenvalues, &eigenvalues, kind)?;
        let n = form.T.nrows();
        let reversed = Mat::from_fn(n, n, |i, j| form.T[(n - 1 - j, n - 1 - i)]);
        Ok(Self { form, reversed, kind })
    }

    /// `X` with `operator(X) + Q = 0`.
    pub(crate) fn solve(&self, Q: &Mat) -> Mat {
        let U = &self.form.U;
        let inner = self.solve_inner(&(U.t() * Q * U));
        U * &inner * U.t()
    }

    /// The same in the coordinates of the Schur form: `U'XU` for `U'QU`.
    pub(crate) fn solve_inner(&self, Q: &Mat) -> Mat {
        let mut X = flipped(Q, -1.0);
        solve_triangular(&self.form.T, &self.reversed, &mut X, self.kind);
        flipped(&X, 1.0)
    }
}

/// The columns in reverse order, times a number.
fn flipped(M: &Mat, factor: f64) -> Mat {
    let n = M.ncols();
    let mut out = Mat::zeros(M.nrows(), n);
    for j in 0..n {
        out.column_mut(j).iter_mut().zip(M.column(n - 1 - j)).for_each(|(o, &e)| *o = factor * e);
    }
    out
}

/// The Schur form of `A'`: rows, columns and blocks in reverse order.
pub(crate) fn transposed(form: &Schur) -> Schur {
    let n = form.T.nrows();
    let T = Mat::from_fn(n, n, |i, j| form.T[(n - 1 - j, n - 1 - i)]);
    let U = Mat::from_fn(n, n, |i, j| form.U[(i, n - 1 - j)]);
    Schur { T, U }
}
