//! The discrete equation.

use crate::error::Error;
use crate::mat::Mat;
use crate::sylvester::Kind;
use crate::tolerance::EPS;

use super::certificate::{CertifiedSolution, certify};
use super::continuous_equation::{check_input, remove_cross_term};
use super::decision::{Failure, convert_to_callers_units, decide, is_beyond_doubt, unless_lost};
use super::equation::{Data, DiscreteRiccati};
use super::long_solution::PreciseEquation;
use super::modes::Modes;
use super::newton::refine;
use super::scaling::{Problem, rescale, scale};
use super::{Outcome, Reason, Riccati, RiccatiMethod, doubling, reason, subspace};

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
    let weight = input_weight(B, Q, R);
    let units = scale(Problem { A: A.clone(), G: (B * B.t()).scale(1.0 / weight), Q: Q.clone() });
    let (back, ones) = (units.inverse(), vec![1.0; R.nrows()]);
    let data = Data::convert(&units, A, B, Q, R, S);
    let terms = |found: &Riccati| {
        let XA = &found.X * A;
        let last = XA.t() * B * &found.F;
        (A.t() * &XA).norm_fro() + found.X.norm_fro() + last.norm_fro() + Q.norm_fro()
    };
    let gain = |F: &Mat| rescale(F, &ones, &back);
    solve_in_units(&DiscreteRiccati(data))
        .try_map(|found| convert_to_callers_units(found, &units, gain, terms))
}

/// The size of `R`, or where that vanishes beside what the cost makes of the input after one step, of `B'QB`.
fn input_weight(B: &Mat, Q: &Mat, R: &Mat) -> f64 {
    let own = R.norm_fro();
    let later = (B.t() * Q * B).norm_fro();
    let weight = if own > EPS * later { own } else { later };
    if weight > 0.0 { weight } else { 1.0 }
}

/// The equation in units that suit it, with one shift after the other, and in 32 digits if doubles do not settle it.
fn solve_in_units(equation: &DiscreteRiccati) -> Outcome<CertifiedSolution> {
    let data = &equation.0;
    let mut refusal = Reason::SingularWeight { rcond: crate::decomposition::rcond_one(&data.R) };
    let mut first = None;
    for shift in equation.shifts() {
        let Some(problem) = shifted_problem(data, shift) else { continue };
        for method in [RiccatiMethod::Doubling, RiccatiMethod::Schur] {
            match attempt(equation, &problem, shift, method) {
                Ok(found) if is_beyond_doubt(&found, &problem, Kind::Discrete) => {
                    return Outcome::Solved(found);
                }
                Ok(found) => {
                    let modes = Modes::of(&problem, Kind::Discrete);
                    return decide(equation, &modes, Some(found), refusal.into());
                }
                Err(Failure::Certain(reason)) => return Outcome::Infeasible(reason),
                Err(Failure::Hopeless(reason)) => {
                    let modes = Modes::of(&problem, Kind::Discrete);
                    return decide(equation, &modes, None, reason.into());
                }
                Err(Failure::Doubtful(reason)) => refusal = reason,
            }
        }
        if first.is_none()
            && let Some(reason) = reason::certainly_lost(&Modes::of(&problem, Kind::Discrete))
        {
            return Outcome::Infeasible(reason);
        }
        first.get_or_insert(problem);
    }
    match first {
        Some(problem) => decide(equation, &Modes::of(&problem, Kind::Discrete), None, refusal.into()),
        None => Outcome::Infeasible(refusal),
    }
}

/// The equation for `Z = X - sI`, its cross term folded away.
fn shifted_problem(Data { A, B, Q, R, S }: &Data, shift: f64) -> Option<Problem> {
    if shift == 0.0 {
        return remove_cross_term(A, B, Q, R, S.as_ref());
    }
    let Q = (Q + &(A.t() * A - Mat::eye(A.nrows())).scale(shift)).symmetric_part();
    let R = (R + &(B.t() * B).scale(shift)).symmetric_part();
    let mut cross = (A.t() * B).scale(shift);
    if let Some(S) = S {
        cross += S;
    }
    remove_cross_term(A, B, &Q, &R, Some(&cross))
}

fn attempt(
    equation: &DiscreteRiccati,
    problem: &Problem,
    shift: f64,
    method: RiccatiMethod,
) -> Result<CertifiedSolution, Failure> {
    let scaled = scale(problem.clone());
    let first = match method {
        RiccatiMethod::Schur => subspace::solve_by_discrete_schur(&scaled.problem),
        RiccatiMethod::Doubling | RiccatiMethod::Precise => {
            doubling::run(scaled.problem.clone()).approximation()
        }
    };
    let first = first.ok_or(Reason::NoGraph)?;
    let modes = Modes::of(&scaled.problem, Kind::Discrete);
    let offset = Mat::eye(problem.A.nrows()).scale(shift);
    unless_lost(&first, &modes, |failure| {
        let refined = refine(equation, scaled.restore(&first) + offset).map_err(failure)?;
        Ok(certify(equation, problem, refined, method)?)
    })
}
