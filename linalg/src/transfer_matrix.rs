//! The transfer matrix `C (sI - A)^-1 B + D` at one point, by residuals in twice the working precision.

use crate::dense::Factors;
use crate::error::{Error, check_shape, check_square};
use crate::long_matrix::LongMatrix;
use crate::mat::{C64, CMat, Mat};
use crate::tolerance::{EPS, PRECISE_TRANSFER_STATES, TRANSFER_REFINEMENTS, TRANSFER_SETTLED};

/// The four matrices of a transfer matrix: `A` n x n, `B` n x m, `C` p x n, `D` p x m.
#[derive(Clone, Copy, Debug)]
pub struct StateRealisation<'a> {
    /// Dynamics matrix.
    pub A: &'a Mat,
    /// Input matrix.
    pub B: &'a Mat,
    /// Output matrix.
    pub C: &'a Mat,
    /// The direct path.
    pub D: &'a Mat,
}

/// Returns `C (sI - A)^-1 B + D`, p x m, every entry to about a rounding of a double, unless the linear equations are singular to
/// working precision.
///
/// The equations are solved by LU, and the residual of the solution, which is kept as a sum of two doubles, is computed in 32 digits from
/// the entries as they are given, so that systems whose parts nearly cancel keep their digits. Source: Higham, Accuracy and Stability of
/// Numerical Algorithms, chapter 12. Cost: one LU factorisation of order n and two to ten solutions. If the corrections do not settle, because the
/// equations are singular to doubles, those of a system of at most 32 states are solved in 32 digits.
///
/// # Errors
/// Wrong shapes, entries that are not finite, [`Error::Singular`] at a pole, or if the equations of a larger system are singular to doubles.
pub fn refined_transfer(system: StateRealisation, s: C64) -> Result<CMat, Error> {
    let StateRealisation { A, B, C, D } = system;
    check_square("A", A)?;
    let (n, m, p) = (A.nrows(), B.ncols(), C.nrows());
    check_shape("B", B, n, m)?;
    check_shape("C", C, p, n)?;
    check_shape("D", D, p, m)?;
    let entry = |i: usize, j: usize| if i == j { s } else { C64::default() };
    let shifted = CMat::from_fn(n, n, |i, j| entry(i, j) - A[(i, j)]);
    let (Re, Im) =
        (LongMatrix::identity(n, s.re).difference(&LongMatrix::from(A)), LongMatrix::identity(n, s.im));
    let (X, is_settled) = refined_states(&Factors::of(&shifted)?, &Re, &Im, B)?;
    let singular = Error::Singular { what: "sI - A", rcond: 0.0 };
    let X = match is_settled {
        true => X,
        false if n <= PRECISE_TRANSFER_STATES => precise_states(&Re, &Im, B).ok_or(singular)?,
        false => return Err(singular),
    };
    let C = LongMatrix::from(C);
    let (re, im) = (C.times(&X.0).plus(&LongMatrix::from(D)).round(), C.times(&X.1).round());
    Ok(CMat::from_fn(p, m, |i, j| C64::new(re[(i, j)], im[(i, j)])))
}

/// Real and imaginary part of `(Re + j Im)^-1 B` by corrections of a solution in doubles, and whether they settled to a rounding of a double.
fn refined_states(
    factors: &Factors<C64>,
    Re: &LongMatrix,
    Im: &LongMatrix,
    B: &Mat,
) -> Result<((LongMatrix, LongMatrix), bool), Error> {
    let (n, m) = B.shape();
    let mut rest = (LongMatrix::from(B), LongMatrix::from(&Mat::zeros(n, m)));
    let mut X = (LongMatrix::from(&Mat::zeros(n, m)), LongMatrix::from(&Mat::zeros(n, m)));
    let (mut last, mut is_settled) = (f64::INFINITY, false);
    for _ in 0..=TRANSFER_REFINEMENTS {
        let (re, im) = (rest.0.round(), rest.1.round());
        let step = factors.solve(CMat::from_fn(n, m, |i, j| C64::new(re[(i, j)], im[(i, j)])))?;
        let size = step.as_slice().iter().map(C64::norm_sqr).sum::<f64>().sqrt();
        let known = X.0.high.norm_fro().hypot(X.1.high.norm_fro());
        is_settled = size <= EPS * known;
        if size.is_nan() || size >= 0.5 * last {
            break;
        }
        last = size;
        let part = |of: fn(&C64) -> f64| LongMatrix::from(&Mat::from_fn(n, m, |i, j| of(&step[(i, j)])));
        X = (X.0.plus(&part(|z| z.re)), X.1.plus(&part(|z| z.im)));
        let real = Re.times(&X.0).difference(&Im.times(&X.1));
        let imaginary = Re.times(&X.1).plus(&Im.times(&X.0));
        rest = (LongMatrix::from(B).difference(&real), imaginary.scale(-1.0));
        if size <= TRANSFER_SETTLED * X.0.high.norm_fro().hypot(X.1.high.norm_fro()) {
            break;
        }
    }
    Ok((X, is_settled))
}

/// The same by the real equations `[Re -Im; Im Re] [X; Y] = [B; 0]` in 32 digits; `None` if a pivot is zero.
fn precise_states(Re: &LongMatrix, Im: &LongMatrix, B: &Mat) -> Option<(LongMatrix, LongMatrix)> {
    let (n, m) = B.shape();
    let upper = Re.hstack(&Im.scale(-1.0)).t();
    let M = upper.hstack(&Im.hstack(Re).t()).t();
    let X = M.solve(&LongMatrix::from(&B.vstack(&Mat::zeros(n, m))))?;
    Some((X.block(0, 0, n, m), X.block(n, 0, n, m)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn equations_that_are_singular_to_doubles_are_solved_in_32_digits() {
        // Lags in series, from 1e-6 to 1e3 rad/s: partial pivoting divides by the couplings, and the corrections do not settle.
        let A = Mat::from_rows(&[
            &[-0.0001, 0.0, 0.0, 0.0],
            &[99999.9999, -1e-6, 0.0, 0.0],
            &[99999.9999, -1000.000001, -1e-6, 0.0],
            &[99999.9999, -1000.000001, 1999.999999, -1000.0],
        ]);
        let (B, C) = (Mat::col(&[1.0; 4]), Mat::row(&[0.0, 0.0, 0.0, 100.0]));
        let system = StateRealisation { A: &A, B: &B, C: &C, D: &Mat::zeros(1, 1) };
        let found = refined_transfer(system, C64::default()).unwrap()[(0, 0)];
        assert!((found.norm() / 2e26 - 1.0).abs() < 1e-10 && found.im == 0.0, "{found}");
    }

    #[test]
    fn a_difference_of_two_systems_keeps_its_digits() {
        // 1/(s+1) - 1/(s+1+e), e = 2^-40: e / ((s+1)(s+1+e)).
        let e = f64::exp2(-40.0);
        let A = Mat::from_rows(&[&[-1.0, 0.0], &[0.0, -1.0 - e]]);
        let (B, C) = (Mat::col(&[1.0, 1.0]), Mat::from_rows(&[&[1.0, -1.0]]));
        let s = C64::new(0.0, 0.7);
        let system = StateRealisation { A: &A, B: &B, C: &C, D: &Mat::zeros(1, 1) };
        let found = refined_transfer(system, s).unwrap()[(0, 0)];
        let exact = C64::new(e, 0.0) / ((s + 1.0) * (s + 1.0 + e));
        assert!(((found - exact) / exact).norm() < 1e-15, "{found} {exact}");
    }
}
