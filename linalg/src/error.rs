//! Everything that can be wrong with what this crate is given, and the checks that find it.

use std::fmt;
use std::ops::Range;

use crate::mat::{C64, Dense, Scalar};

/// Sizes of numbers that a message shows without an exponent.
const PLAIN_DECIMALS: Range<f64> = 1e-3..1e6;

/// Why a matrix routine could not answer.
///
/// A problem that has no solution is not an error where the routine returns an [`crate::Outcome`]; these are bad
/// input, and the (rare) iterations that stop at their limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A matrix has the wrong size for the equation.
    #[error("{what} is {rows} x {cols}, the equation needs {needed_rows} x {needed_cols}")]
    Shape {
        /// The matrix.
        what: &'static str,
        /// Rows it has.
        rows: usize,
        /// Columns it has.
        cols: usize,
        /// Rows it should have.
        needed_rows: usize,
        /// Columns it should have.
        needed_cols: usize,
    },
    /// A matrix must be square.
    #[error("{what} must be square, it is {rows} x {cols}")]
    NotSquare {
        /// The matrix.
        what: &'static str,
        /// Rows it has.
        rows: usize,
        /// Columns it has.
        cols: usize,
    },
    /// An entry is infinite or not a number.
    #[error("{what} has the entry {value} at row {row}, column {col}")]
    NotFinite {
        /// The matrix.
        what: &'static str,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        col: usize,
        /// Modulus of the entry.
        value: f64,
    },
    /// A matrix must be symmetric.
    #[error("{what} is not symmetric: the relative difference from its transpose is {relative:.1e}")]
    NotSymmetric {
        /// The matrix.
        what: &'static str,
        /// `norm(M - M') / norm(M)`.
        relative: f64,
    },
    /// A matrix that must be inverted is singular to working precision.
    #[error("{what} is singular to working precision (reciprocal condition {rcond:.1e})")]
    Singular {
        /// The matrix.
        what: &'static str,
        /// Estimated reciprocal condition number.
        rcond: f64,
    },
    /// A matrix must be positive definite.
    #[error("{what} is not positive definite")]
    NotPositiveDefinite {
        /// The matrix.
        what: &'static str,
    },
    /// A factored Lyapunov equation needs a stable matrix.
    #[error("{what} is not stable: it has the eigenvalue {}", ShortNumber(*eigenvalue))]
    NotStable {
        /// The matrix.
        what: &'static str,
        /// The offending eigenvalue.
        eigenvalue: C64,
    },
    /// A linear matrix equation has no unique solution, or rounding its entries may leave it without one.
    #[error(
        "{equation} is singular within the rounding of its entries: the eigenvalues {} and {} meet (separation {separation:.1e})", ShortNumber(*first), ShortNumber(*second)
    )]
    CommonEigenvalue {
        /// The equation.
        equation: &'static str,
        /// Eigenvalue of the first matrix.
        first: C64,
        /// Eigenvalue of the second matrix that it meets.
        second: C64,
        /// The gap that is left between them.
        separation: f64,
    },
    /// An iteration reached its limit.
    #[error("{what} did not converge within {limit} iterations")]
    NoConvergence {
        /// The iteration.
        what: &'static str,
        /// Limit.
        limit: usize,
    },
    /// A large computation does not fit into memory.
    #[error("{what} with {rows} rows do not fit into memory: reduce the model before it is imported")]
    TooLarge {
        /// The argument that does not fit.
        what: &'static str,
        /// Rows of the matrix.
        rows: usize,
    },
    /// The answer, or a number on the way to it, leaves the range of doubles.
    #[error(
        "{what} leaves the range of numbers (1e308): choose units in which the entries are nearer to one"
    )]
    OutOfRange {
        /// Name of the computation.
        what: &'static str,
    },
    /// The caller asked to stop.
    #[error("the computation was cancelled ({what})")]
    Cancelled {
        /// The result that was being computed.
        what: &'static str,
    },
    /// Two eigenvalues are too close to change places without spoiling the matrix.
    #[error(
        "the eigenvalues {} and {} are too close to be reordered (backward error {error:.1e})", ShortNumber(*first), ShortNumber(*second)
    )]
    SwapRejected {
        /// The eigenvalue that should move down.
        first: C64,
        /// The eigenvalue that should move up.
        second: C64,
        /// Relative backward error that the swap would have cost.
        error: f64,
    },
}

/// A complex number as a message shows it: six digits, with an exponent if it is far from one.
pub(crate) struct ShortNumber(pub(crate) C64);

impl fmt::Display for ShortNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = |f: &mut fmt::Formatter<'_>, x: f64| match x.abs() {
            size if size == 0.0 || PLAIN_DECIMALS.contains(&size) => write!(f, "{x:.6}"),
            _ => write!(f, "{x:.6e}"),
        };
        part(f, self.0.re)?;
        if self.0.im != 0.0 {
            f.write_str(if self.0.im < 0.0 { " - " } else { " + " })?;
            part(f, self.0.im.abs())?;
            f.write_str("j")?;
        }
        Ok(())
    }
}

/// Returns whether `matrix` has the shape that the equation needs.
pub(crate) fn check_shape<T: Scalar>(
    what: &'static str,
    matrix: &Dense<T>,
    needed_rows: usize,
    needed_cols: usize,
) -> Result<(), Error> {
    let (rows, cols) = matrix.shape();
    if (rows, cols) != (needed_rows, needed_cols) {
        return Err(Error::Shape { what, rows, cols, needed_rows, needed_cols });
    }
    check_finite(what, matrix)
}

/// Returns whether `matrix` is square and finite.
pub(crate) fn check_square<T: Scalar>(what: &'static str, matrix: &Dense<T>) -> Result<(), Error> {
    if !matrix.is_square() {
        return Err(Error::NotSquare { what, rows: matrix.nrows(), cols: matrix.ncols() });
    }
    check_finite(what, matrix)
}

/// Returns whether every entry is finite.
pub(crate) fn check_finite<T: Scalar>(what: &'static str, matrix: &Dense<T>) -> Result<(), Error> {
    if matrix.is_finite() {
        return Ok(());
    }
    match matrix.as_slice().iter().position(|e| !e.modulus().is_finite()) {
        None => Ok(()),
        Some(at) => {
            let rows = matrix.nrows();
            let value = matrix.as_slice()[at].modulus();
            Err(Error::NotFinite { what, row: at % rows, col: at / rows, value })
        }
    }
}

/// Returns a computed matrix if every entry is finite.
pub(crate) fn check_range<T: Scalar>(what: &'static str, matrix: Dense<T>) -> Result<Dense<T>, Error> {
    if matrix.is_finite() { Ok(matrix) } else { Err(Error::OutOfRange { what }) }
}

/// Returns whether `matrix` is square, finite and symmetric.
pub(crate) fn check_symmetric(what: &'static str, matrix: &Dense<f64>) -> Result<(), Error> {
    check_square(what, matrix)?;
    let size = matrix.norm_max();
    let n = matrix.nrows();
    let mut worst = 0.0_f64;
    for j in 0..n {
        for i in 0..j {
            worst = worst.max((matrix[(i, j)] - matrix[(j, i)]).abs());
        }
    }
    if worst > crate::tolerance::SYMMETRY * size {
        return Err(Error::NotSymmetric { what, relative: worst / size });
    }
    Ok(())
}
