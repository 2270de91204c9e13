//! Lyapunov equations that are singular or nearly so: found out, and solved as well as they can be.

use crate::error::Error;
use crate::extended_precision::{ExtendedMatrix, exact_product};
use crate::long_matrix::LongMatrix;
use crate::mat::{C64, Mat};
use crate::smith;
use crate::spectrum::Spectrum;
use crate::sylvester::Kind;
use crate::tolerance::{EPS, FADED_TRACE, LYAPUNOV_REFINEMENTS, PRECISE_STATES, REFINED};

use super::{Operator, is_symmetric, nearest_pair};

/// Refines `X`, a solution for the balanced `A`, or says which eigenvalues make the equation singular.
///
/// First residuals in twice the working precision, and if they do not converge the whole equation in 32 digits.
pub(super) fn refine_or_refuse(operator: Operator, A: &Mat, Q: &Mat, X: Mat) -> Result<Mat, Error> {
    let kind = operator.kind;
    let Some((first, second)) = nearest_pair(&operator.form.eigenvalues(), kind) else { return Ok(X) };
    let separation = kind.gap(first, second);
    let equation = if kind == Kind::Continuous { "A X + X A' + Q = 0" } else { "A X A' - X + Q = 0" };
    let meeting = Error::CommonEigenvalue { equation, first, second, separation };
    let refined = refine(&operator, A, &Q.clone().into(), X).map(|X| X.to_double());
    let Operator { form, .. } = operator;
    let spectrum = Spectrum::from_form(A.clone(), form, vec![1.0; A.nrows()]);
    let moved = spectrum.rounding_error(first) * weight(second, kind)
        + spectrum.rounding_error(second) * weight(first, kind);
    // A mode and its conjugate, or a real one with itself, meet on the boundary of stability.
    let is_apart = |spectrum: &Spectrum| {
        first.conj() == second
            && !spectrum.eigenvalues_on_boundary(kind.into()).iter().any(|l| is_one_of(*l, first))
    };
    if separation <= moved {
        // The Schur form does not tell how far apart they are.
        return if is_apart(&spectrum) {
            solve_precisely(A, Q, kind).or(refined).ok_or(meeting)
        } else {
            Err(meeting)
        };
    }
    refined.or_else(|| solve_precisely(A, Q, kind)).ok_or(meeting)
}

/// One correction by the residual in twice the working precision: it leaves the rounding of the solution where the Schur form left that of the
/// norms of the equation, which the entries of a matrix far from normal do not show.
pub(super) fn correct_once(operator: &Operator, A: &Mat, Q: &Mat, X: Mat) -> Mat {
    let step = operator.solve_any(&residual(A, &Q.clone().into(), &X.clone().into(), operator.kind));
    if step.norm_fro() < REFINED.sqrt() * X.norm_fro() { X + step } else { X }
}

/// By how much a movement of the one eigenvalue changes the gap.
fn weight(other: C64, kind: Kind) -> f64 {
    if kind == Kind::Continuous { 1.0 } else { other.norm() }
}

/// Returns whether an eigenvalue is another one or its conjugate.
fn is_one_of(eigenvalue: C64, other: C64) -> bool {
    eigenvalue == other || eigenvalue == other.conj()
}

/// The trace of `C X C'` for the solution `X` for the balanced `A` and `Q = B B'`, refined, or of an equation in 32 digits; `None` if neither settles.
pub(super) fn refined_trace(operator: &Operator, A: &Mat, [B, C]: [&Mat; 2]) -> Option<f64> {
    let Q = exact_product(B, &B.t());
    let X = operator.solve(&Q.to_double());
    let Some(X) = refine(operator, A, &Q, X) else { return precise_trace(A, [B, C], operator.kind) };
    let CX = ExtendedMatrix::from(C.clone()).times(&X);
    let square = CX.times(&ExtendedMatrix::from(C.t())).to_double();
    let trace: f64 = square.diagonal().iter().sum();
    // The solution is known beside its norm, of which the output may see a part below that.
    if trace <= FADED_TRACE * C.norm_fro().powi(2) * X.high.norm_fro() {
        return precise_trace(A, [B, C], operator.kind).or(Some(trace));
    }
    Some(trace)
}

/// The same in 32 digits throughout; `None` if `A` is not stable or has more than 64 rows.
pub(super) fn precise_trace(A: &Mat, [B, C]: [&Mat; 2], kind: Kind) -> Option<f64> {
    if A.nrows() > PRECISE_STATES {
        return None;
    }
    let (B, C) = (LongMatrix::from(B), LongMatrix::from(C));
    let [X] = smith::lyapunov(&LongMatrix::from(&A.t()), [B.times(&B.t())], kind)?;
    Some(C.times(&X).times(&C.t()).round().diagonal().iter().sum())
}

/// The factors of both Gramians in 32 digits; `None` if `A` is not stable or has more than 64 rows.
pub(super) fn precise_factors(A: &Mat, [B, C]: [&Mat; 2], kind: Kind) -> Option<[Mat; 2]> {
    if A.nrows() > PRECISE_STATES {
        return None;
    }
    let gramian = |F: &Mat, W: &LongMatrix| smith::lyapunov(&LongMatrix::from(F), [W.times(&W.t())], kind);
    let [P] = gramian(&A.t(), &LongMatrix::from(B))?;
    let [Q] = gramian(A, &LongMatrix::from(&C.t()))?;
    Some([P, Q].map(|X| X.symmetric_part().semidefinite_factor().round()))
}

/// Adds corrections until they are rounding; `None` if they do not shrink.
fn refine(operator: &Operator, A: &Mat, Q: &ExtendedMatrix, X: Mat) -> Option<ExtendedMatrix> {
    let mut X = ExtendedMatrix::from(X);
    let mut before = f64::INFINITY;
    for _ in 0..LYAPUNOV_REFINEMENTS {
        let step = operator.solve_any(&residual(A, Q, &X, operator.kind));
        let size = step.norm_fro() / X.high.norm_fro().max(f64::MIN_POSITIVE);
        if !size.is_finite() || size > 0.5 * before {
            return (before < REFINED).then_some(X);
        }
        X = X.add(&step.into());
        before = size;
        if size < EPS {
            return Some(X);
        }
    }
    None
}

/// The residual of `X` in twice the working precision.
fn residual(A: &Mat, Q: &ExtendedMatrix, X: &ExtendedMatrix, kind: Kind) -> Mat {
    let (left, right) = (ExtendedMatrix::from(A.clone()), ExtendedMatrix::from(A.t()));
    let sum = match kind {
        Kind::Continuous => left.times(X).add(&X.times(&right)),
        Kind::Discrete => left.times(&X.times(&right)).add(&X.neg()),
    };
    let sum = sum.add(Q).to_double();
    if is_symmetric(&Q.high) { sum.symmetric_part() } else { sum }
}

fn solve_precisely(A: &Mat, Q: &Mat, kind: Kind) -> Option<Mat> {
    if A.nrows() > PRECISE_STATES {
        return None;
    }
    let [X] = smith::lyapunov(&LongMatrix::from(&A.t()), [LongMatrix::from(Q)], kind)?;
    Some(X.round())
}
