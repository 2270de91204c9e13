//! The discrete equation.

use crate::error::Error;
use crate::mat::Mat;
use crate::sylvester::Kind;

use super::continuous::{check_input, fold};
use super::equation::{Data, Discrete};
use super::newton::refine;
use super::scaling::{Problem, rescale, scale};
use super::{Certificate, Method, Outcome, Reason, Riccati, certify, doubling, reason, subspace};

/// Solves `A'XA - X - (A'XB + S)(R + B'XB)^-1 (B'XA + S') + Q = 0` for the stabilising `X`: every eigenvalue of
/// `A - B F` is inside the unit circle, `F = (R + B'XB)^-1 (B'XA + S')`. Shapes as for [`super::care`]; `R` may be
/// singular as long as `R + B'XB` is not.
///
/// A solution exists if (A, B) is stabilisable and the cost sees every mode of `A` on the unit circle.
/// Method: where `R` is (nearly) singular, a shift `X = sI + Z` gives the equation a regular one; symplectic scaling;
/// structured doubling or the ordered Schur form of the Cayley-transformed pencil, each the fallback of the other; Newton
/// steps with residuals in twice the working precision.
///
/// # Errors
/// As for [`super::care`]. A problem without a solution is [`Outcome::Infeasible`] with the mode in the way.
pub fn dare(A: &Mat, B: &Mat, Q: &Mat, R: &Mat, S: Option<&Mat>) -> Result<Outcome<Riccati>, Error> {
    check_input(A, B, Q, R, S)?;
    let G = (B * B.t()).scale(1.0 / R.norm_fro().max(f64::MIN_POSITIVE.sqrt()));
    let units = scale(Problem { A: A.clone(), G, Q: Q.clone() });
    let (d, back, ones) = (&units.scale, units.inverse(), vec![1.0; R.nrows()]);
    let data = Data {
        A: rescale(A, &back, d),
        B: rescale(B, &back, &ones),
        Q: rescale(Q, d, d),
        R: R.clone(),
        S: S.map(|S| rescale(S, d, &ones)),
    };
    let outcome = solve_in_units(Discrete(data));
    Ok(outcome.map(|inner| Riccati {
        X: units.restore(&inner.X),
        F: rescale(&inner.F, &ones, &back),
        ..inner
    }))
}

/// The equation in units that suit it, with one shift after the other.
fn solve_in_units(equation: Discrete) -> Outcome<Riccati> {
    let data = &equation.0;
    let mut refusal = Reason::SingularWeight { rcond: crate::decomposition::rcond_one(&data.R) };
    for shift in shifts(data) {
        let Some(problem) = shifted(data, shift) else { continue };
        for method in [Method::Doubling, Method::Schur] {
            match attempt(&equation, &problem, shift, method) {
                Ok(solution) => return accept(&problem, solution),
                Err(reason) => refusal = reason,
            }
        }
        if let Some(reason) = reason::lost_mode(&problem, Kind::Discrete) {
            return Outcome::Infeasible(reason);
        }
    }
    Outcome::Infeasible(refusal)
}

/// Reciprocal condition of `R` below which the equation is shifted first.
const REGULAR: f64 = 1e-6;

/// The shifts `s` to try: none where `R` is regular, and sizes that make `R + s B'B` so.
fn shifts(Data { B, Q, R, .. }: &Data) -> Vec<f64> {
    let square = B.norm_fro().powi(2).max(f64::MIN_POSITIVE);
    let size = (Q.norm_fro() + R.norm_fro() / square).max(f64::MIN_POSITIVE);
    let regular = crate::decomposition::rcond_one(R) > REGULAR;
    let mut list = vec![size, -size, 0.03 * size, 30.0 * size];
    list.insert(if regular { 0 } else { list.len() }, 0.0);
    list
}

/// The equation for `Z = X - sI`, its cross term folded away.
fn shifted(Data { A, B, Q, R, S }: &Data, shift: f64) -> Option<Problem> {
    if shift == 0.0 {
        return fold(A, B, Q, R, S.as_ref());
    }
    let Q = (Q + &(A.t() * A - Mat::eye(A.nrows())).scale(shift)).symmetric_part();
    let R = (R + &(B.t() * B).scale(shift)).symmetric_part();
    let mut cross = (A.t() * B).scale(shift);
    if let Some(S) = S {
        cross += S;
    }
    fold(A, B, &Q, &R, Some(&cross))
}

fn attempt(equation: &Discrete, problem: &Problem, shift: f64, method: Method) -> Result<Riccati, Reason> {
    let scaled = scale(problem.clone());
    let first = match method {
        Method::Doubling => doubling::run(scaled.problem.clone()),
        Method::Schur => subspace::by_discrete_schur(&scaled.problem),
    };
    let offset = Mat::eye(problem.A.nrows()).scale(shift);
    let refined = first.and_then(|Z| refine(equation, scaled.restore(&Z) + offset)).ok_or(Reason::NoGraph)?;
    let (closed_loop, certificate) = certify::certify(equation, problem, &refined, method)?;
    Ok(Riccati { X: refined.X, F: refined.gain, closed_loop, certificate })
}

/// Below this separation a solution is looked at twice: rounding may have moved a mode that cannot be moved.
const DOUBTFUL: f64 = 1e-7;

fn accept(problem: &Problem, solution: Riccati) -> Outcome<Riccati> {
    let Certificate { separation, .. } = solution.certificate;
    let lost = if separation < DOUBTFUL { reason::lost_mode(problem, Kind::Discrete) } else { None };
    lost.map_or(Outcome::Solved(solution), Outcome::Infeasible)
}
