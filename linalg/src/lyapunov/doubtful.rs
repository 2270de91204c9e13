//! Lyapunov equations that are singular or nearly so: found out, and solved as well as they can be.

use crate::error::Error;
use crate::extended_precision::Extended;
use crate::mat::Mat;
use crate::precise::Precise;
use crate::smith;
use crate::spectrum::Spectrum;
use crate::sylvester::Kind;
use crate::tolerance::{EPS, LYAPUNOV_REFINEMENTS, PRECISE_STATES, REFINED};

use super::{Operator, is_symmetric, nearest_pair};

/// Refines `X`, a solution for the balanced `A`, or says which eigenvalues make the equation singular.
///
/// First residuals in twice the working precision, and if they do not converge the whole equation in 32 digits.
pub(super) fn settle(operator: Operator, A: &Mat, Q: &Mat, X: Mat) -> Result<Mat, Error> {
    let kind = operator.kind;
    let Some((first, second)) = nearest_pair(&operator.form.eigenvalues(), kind) else { return Ok(X) };
    let separation = kind.gap(first, second);
    let equation = if kind == Kind::Continuous { "A X + X A' + Q = 0" } else { "A X A' - X + Q = 0" };
    let meeting = Error::CommonEigenvalue { equation, first, second, separation };
    let refined = refine(&operator, A, Q, X);
    let Operator { form, .. } = operator;
    let spectrum = Spectrum::from_form(A.clone(), form, vec![1.0; A.nrows()]);
    let moved =
        spectrum.movement(first) * weight(second, kind) + spectrum.movement(second) * weight(first, kind);
    if separation <= moved {
        return Err(meeting);
    }
    refined.or_else(|| solve_precisely(A, Q, kind)).ok_or(meeting)
}

/// One correction by the residual in twice the working precision: it leaves the rounding of the solution where the Schur form left that of the
/// norms of the equation, which the entries of a matrix far from normal do not show.
pub(super) fn correct_once(operator: &Operator, A: &Mat, Q: &Mat, X: Mat) -> Mat {
    let step = operator.solve_any(&residual(A, Q, &X.clone().into(), operator.kind));
    if step.norm_fro() < REFINED.sqrt() * X.norm_fro() { X + step } else { X }
}

/// By how much a movement of the one eigenvalue changes the gap.
fn weight(other: crate::mat::C64, kind: Kind) -> f64 {
    if kind == Kind::Continuous { 1.0 } else { other.norm() }
}

/// Adds corrections until they are rounding; `None` if they do not shrink.
fn refine(operator: &Operator, A: &Mat, Q: &Mat, X: Mat) -> Option<Mat> {
    let mut X = Extended::from(X);
    let mut before = f64::INFINITY;
    for _ in 0..LYAPUNOV_REFINEMENTS {
        let step = operator.solve_any(&residual(A, Q, &X, operator.kind));
        let size = step.norm_fro() / X.high.norm_fro().max(f64::MIN_POSITIVE);
        if !size.is_finite() || size > 0.5 * before {
            return (before < REFINED).then(|| X.collapse());
        }
        X = X.add(&step.into());
        before = size;
        if size < EPS {
            return Some(X.collapse());
        }
    }
    None
}

/// The residual of `X` in twice the working precision.
fn residual(A: &Mat, Q: &Mat, X: &Extended, kind: Kind) -> Mat {
    let (left, right) = (Extended::from(A.clone()), Extended::from(A.t()));
    let sum = match kind {
        Kind::Continuous => left.times(X).add(&X.times(&right)),
        Kind::Discrete => left.times(&X.times(&right)).add(&X.neg()),
    };
    let sum = sum.add(&Q.clone().into()).collapse();
    if is_symmetric(Q) { sum.symmetric_part() } else { sum }
}

fn solve_precisely(A: &Mat, Q: &Mat, kind: Kind) -> Option<Mat> {
    if A.nrows() > PRECISE_STATES {
        return None;
    }
    let [X] = smith::lyapunov(&Precise::from(&A.t()), [Precise::from(Q)], kind)?;
    Some(X.round())
}
