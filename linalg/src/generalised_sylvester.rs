//! The generalised Sylvester equation `A X B + C X D = E`.

use crate::decomposition::rcond_one;
use crate::dense::solve;
use crate::error::{Error, check_shape, check_square};
use crate::extended_precision::ExtendedMatrix;
use crate::mat::Mat;
use crate::sylvester::sylvester;
use crate::tolerance::{EPS, GENERALISED_SYLVESTER_REFINEMENTS};

/// Solves `A X B + C X D = E`; `A`, `C` m x m, `B`, `D` n x n, `E` and `X` m x n.
///
/// A unique solution exists if and only if the pencils `A - l C` and `D + l B` are regular and share no eigenvalue.
/// Method: of each pair the better conditioned matrix is inverted, which leaves a Sylvester equation; the solution is
/// refined with residuals in twice the working precision, so that what the inversion cost is won back.
///
/// # Errors
/// Wrong shapes, entries that are not finite, [`Error::CommonEigenvalue`], or [`Error::Singular`] if both matrices of a
/// pair are singular (the equation may still have a solution, this method does not find it).
pub fn gsylvester(A: &Mat, B: &Mat, C: &Mat, D: &Mat, E: &Mat) -> Result<Mat, Error> {
    let (m, n) = E.shape();
    check_square("A", A)?;
    check_square("B", B)?;
    for (what, matrix, rows, columns) in
        [("A", A, m, m), ("B", B, n, n), ("C", C, m, m), ("D", D, n, n), ("E", E, m, n)]
    {
        check_shape(what, matrix, rows, columns)?;
    }
    let reduced = ReducedEquation::of(A, B, C, D)?;
    let mut X = ExtendedMatrix::from(reduced.solve(E)?);
    for _ in 0..GENERALISED_SYLVESTER_REFINEMENTS {
        let first = ExtendedMatrix::from(A.clone()).times(&X.times(&B.clone().into()));
        let second = ExtendedMatrix::from(C.clone()).times(&X.times(&D.clone().into()));
        let residual = first.add(&second).neg().add(&E.clone().into()).to_double();
        let step = reduced.solve(&residual)?;
        X = X.add(&step.clone().into());
        if step.norm_fro() <= EPS * X.high.norm_fro() {
            break;
        }
    }
    Ok(X.to_double())
}

/// `P X + X S = L^-1 E M^-1` with `P = L^-1 L'` and `S = M' M^-1` for the pairs (L, L') and (M, M') that were chosen.
struct ReducedEquation {
    left: Mat,
    right: Mat,
    P: Mat,
    S: Mat,
}

impl ReducedEquation {
    /// `A` and `D` inverted, or `C` and `B`: whichever pair is the better conditioned one.
    fn of(A: &Mat, B: &Mat, C: &Mat, D: &Mat) -> Result<Self, Error> {
        let (ad, cb) = (rcond_one(A).min(rcond_one(D)), rcond_one(C).min(rcond_one(B)));
        let (left, other, right, opposite) = if ad >= cb { (A, C, D, B) } else { (C, A, B, D) };
        let rcond = ad.max(cb);
        if rcond < EPS {
            return Err(Error::Singular { what: "each pair of A, D and of C, B", rcond });
        }
        let P = solve(left, other)?;
        let S = solve(&right.t(), &opposite.t())?.t();
        Ok(Self { left: left.clone(), right: right.clone(), P, S })
    }

    /// `left X opposite + other X right = E`, that is `X S + P X = left^-1 E right^-1`.
    fn solve(&self, E: &Mat) -> Result<Mat, Error> {
        let half = solve(&self.left, E)?;
        let right = solve(&self.right.t(), &half.t())?.t();
        sylvester(&self.P, &self.S, &right)
    }
}
