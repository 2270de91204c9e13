//! The inverse of a matrix with zeros, with the digits of its small entries.

use crate::dense::solve;
use crate::error::{Error, check_square};
use crate::long_matrix::LongMatrix;
use crate::mat::Mat;
use crate::tolerance::{
    ENTRYWISE_ERROR, ENTRYWISE_REFINEMENTS, ENTRYWISE_STATES, EPS, FADED_ENTRY, RESIDUAL_ROUNDINGS,
};

/// Returns the inverse of a square matrix. Of a matrix with zeros and up to 64 rows, entries that fade along a chain of states are as good as the others: elimination
/// leaves them with the rounding errors of the largest ones, and residuals in 32 digits correct them.
///
/// # Errors
/// Not square, not finite, or singular.
pub fn entrywise_inverse(A: &Mat) -> Result<Mat, Error> {
    check_square("A", A)?;
    let X = solve(A, &Mat::eye(A.nrows()))?;
    if A.nrows() <= ENTRYWISE_STATES && has_zeros(A) && has_faded(&X) && is_blurred(A, &X) {
        Ok(refine(A, X))
    } else {
        Ok(X)
    }
}

fn has_zeros(A: &Mat) -> bool {
    A.as_slice().contains(&0.0)
}

/// Returns whether an entry of an inverse is far smaller than the diagonal entries of its row and column.
fn has_faded(X: &Mat) -> bool {
    let roots: Vec<f64> = X.diagonal().iter().map(|e| e.abs().sqrt()).collect();
    (0..X.ncols()).any(|j| {
        X.column(j).iter().zip(&roots).any(|(e, root)| *e != 0.0 && e.abs() < FADED_ENTRY * root * roots[j])
    })
}

/// Returns whether the residual of an inverse is not that of rounding its own entries: elimination has left some with the errors of larger ones.
fn is_blurred(A: &Mat, X: &Mat) -> bool {
    let residual = &Mat::eye(A.nrows()) - &(A * X);
    let size = &A.map(f64::abs) * &X.map(f64::abs);
    let mut entries = residual.as_slice().iter().zip(size.as_slice());
    entries.any(|(residual, size)| residual.abs() > RESIDUAL_ROUNDINGS * EPS * size)
}

/// Adds `X (I - A X)` until it changes no entry.
fn refine(A: &Mat, first: Mat) -> Mat {
    let (long, identity) = (LongMatrix::from(A), LongMatrix::identity(A.nrows(), 1.0));
    let mut X = first.clone();
    for _ in 0..ENTRYWISE_REFINEMENTS {
        let step = &X * &identity.difference(&long.times(&LongMatrix::from(&X))).round();
        let is_settled = |(s, x): (&f64, &f64)| s.abs() <= ENTRYWISE_ERROR * x.abs();
        let settled = step.as_slice().iter().zip(X.as_slice()).all(is_settled);
        X += &step;
        if settled {
            return X;
        }
    }
    // Too ill-conditioned for corrections from doubles.
    if X.is_finite() { X } else { first }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_far_corners_of_the_inverse_of_a_chain_keep_their_digits() {
        // A row of masses between springs, x of the diagonal entry: the corner is x^(n-1) over the determinant.
        for (n, x) in [(6_usize, 1e-3), (20, 1e-4), (40, 1e-6), (60, 0.1)] {
            let A = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => 1.0 + 2.0 * x,
                1 => -x,
                _ => 0.0,
            });
            let found = entrywise_inverse(&A).unwrap();

            let (mut before, mut determinant) = (1.0_f64, 1.0 + 2.0 * x);
            for _ in 1..n {
                (before, determinant) = (determinant, (1.0 + 2.0 * x) * determinant - x * x * before);
            }
            let exact = x.powi(n as i32 - 1) / determinant;
            assert!((found[(0, n - 1)] / exact - 1.0).abs() < 1e-13, "{n} {x} {} {exact}", found[(0, n - 1)]);
        }
    }
}
