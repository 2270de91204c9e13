//! The continuous equation.

use crate::dense::{inverse, solve};
use crate::error::{Error, check_shape, check_square, check_symmetric};
use crate::mat::Mat;
use crate::sylvester::Kind;
use crate::tolerance::PRECISE_STATES;

use super::certificate::{CertifiedSolution, certify};
use super::decision::{Failure, Refusal, convert_to_callers_units, decide, is_beyond_doubt, unless_lost};
use super::doubling::{PARAMETERS, solve_by_doubling};
use super::equation::{ContinuousRiccati, Data, Quadratic};
use super::long_solution::PreciseEquation;
use super::modes::Modes;
use super::newton::{Equation, refine};
use super::reason::{self, NearestEigenvalue};
use super::scaling::{Problem, rescale, scale};
use super::{Outcome, Reason, Riccati, RiccatiMethod, subspace};

/// Solves `A'X + XA - (XB + S) R^-1 (B'X + S') + Q = 0` for the stabilising `X`: `A - B F` is stable with
/// `F = R^-1 (B'X + S')`. `A` n x n, `B` n x m, `Q` n x n symmetric, `R` m x m symmetric and not singular (of either
/// sign), `S` n x m.
///
/// A solution exists if (A, B) is stabilisable and, for `R > 0` and `[Q S; S' R] >= 0`, the cost sees every mode of `A`
/// on the imaginary axis. Method: symplectic scaling by powers of two; ordered Schur form of the Hamiltonian matrix or
/// structured doubling, each the fallback of the other; Newton steps with residuals in twice the working precision.
/// Cost: about 300 n^3.
///
/// # Errors
/// Wrong shapes, entries that are not finite, `Q` or `R` not symmetric. A problem without a solution is
/// [`Outcome::Infeasible`] with the mode in the way.
pub fn care(A: &Mat, B: &Mat, Q: &Mat, R: &Mat, S: Option<&Mat>) -> Result<Outcome<Riccati>, Error> {
    check_input(A, B, Q, R, S)?;
    let Some(problem) = remove_cross_term(A, B, Q, R, S) else {
        return Ok(Outcome::Infeasible(Reason::SingularWeight { rcond: crate::decomposition::rcond_one(R) }));
    };
    let scaled = scale(problem);
    let (back, ones) = (scaled.inverse(), vec![1.0; R.nrows()]);
    let equation = ContinuousRiccati(Data::convert(&scaled, A, B, Q, R, S));
    let terms = |found: &Riccati| {
        let last = found.X.clone() * B * &found.F;
        2.0 * (A.t() * &found.X).norm_fro() + last.norm_fro() + Q.norm_fro()
    };
    let gain = |F: &Mat| rescale(F, &ones, &back);
    solve_scaled(&equation, &scaled.problem)
        .try_map(|found| convert_to_callers_units(found, &scaled, gain, terms))
}

/// Solves `A'X + XA - XGX + Q = 0` for the stabilising `X`: `A - G X` is stable. `G` and `Q` symmetric, of any sign, as
/// H-infinity control needs them. `F` of the answer is `G X`.
///
/// A stabilising solution exists if and only if the Hamiltonian matrix `[A -G; -Q -A']` has no eigenvalue on the
/// imaginary axis and its stable subspace is a graph. Method as for [`care`].
///
/// # Errors
/// As for [`care`].
pub fn care_g(A: &Mat, G: &Mat, Q: &Mat) -> Result<Outcome<Riccati>, Error> {
    check_square("A", A)?;
    check_shape("G", G, A.nrows(), A.ncols())?;
    check_shape("Q", Q, A.nrows(), A.ncols())?;
    check_symmetric("G", G)?;
    check_symmetric("Q", Q)?;
    let scaled = scale(Problem { A: A.clone(), G: G.clone(), Q: Q.clone() });
    let inner = scaled.problem.clone();
    let equation = Quadratic { A: inner.A, G: inner.G, Q: inner.Q };
    let (d, back) = (&scaled.scale, scaled.inverse());
    let terms = |found: &Riccati| {
        2.0 * (A.t() * &found.X).norm_fro() + (&found.X * &found.F).norm_fro() + Q.norm_fro()
    };
    let gain = |F: &Mat| rescale(F, d, &back);
    solve_scaled(&equation, &scaled.problem)
        .try_map(|found| convert_to_callers_units(found, &scaled, gain, terms))
}

/// The checks that both time bases share.
pub(super) fn check_input(A: &Mat, B: &Mat, Q: &Mat, R: &Mat, S: Option<&Mat>) -> Result<(), Error> {
    check_square("A", A)?;
    let (n, m) = (A.nrows(), B.ncols());
    check_shape("B", B, n, m)?;
    check_shape("Q", Q, n, n)?;
    check_shape("R", R, m, m)?;
    check_symmetric("Q", Q)?;
    check_symmetric("R", R)?;
    S.map_or(Ok(()), |S| check_shape("S", S, n, m))
}

/// The equation without a cross term: `A - B R^-1 S'`, `B R^-1 B'`, `Q - S R^-1 S'`; `None` for a singular `R`.
pub(super) fn remove_cross_term(A: &Mat, B: &Mat, Q: &Mat, R: &Mat, S: Option<&Mat>) -> Option<Problem> {
    let R_inverse = inverse(R).ok().filter(Mat::is_finite)?;
    let G = (B * &R_inverse * B.t()).symmetric_part();
    let Some(S) = S else { return Some(Problem { A: A.clone(), G, Q: Q.clone() }) };
    let K = solve(R, &S.t()).ok()?;
    Some(Problem { A: A - &(B * &K), G, Q: (Q - &(S * &K)).symmetric_part() })
}

/// Above this size the products of the doubling beat the rotations of the Schur form of twice the size.
const LARGE: usize = 4;

/// A way to a first approximation.
#[derive(Clone, Copy)]
enum Start {
    Schur,
    Doubling(&'static [f64]),
}

/// First approximation, refinement, certificate; the next way if one does not lead there, and 32 digits if doubles do not
/// settle the problem. Everything is in scaled units.
fn solve_scaled(
    equation: &(impl Equation + PreciseEquation),
    problem: &Problem,
) -> Outcome<CertifiedSolution> {
    let (usual, others) = PARAMETERS.split_at(1);
    let ways: &[Start] = match problem.A.nrows() {
        ..=LARGE => &[Start::Schur, Start::Doubling(&PARAMETERS)],
        // A refusal of a large problem must not take many times as long as a solution: each way is tried once.
        n if n > PRECISE_STATES => &[Start::Doubling(&PARAMETERS), Start::Schur],
        _ => &[Start::Doubling(usual), Start::Doubling(others), Start::Schur],
    };
    let modes = Modes::of(problem, Kind::Continuous);
    let mut nearest = NearestEigenvalue::Unknown;
    let mut refusal = Reason::NoGraph;
    for (tried, way) in ways.iter().enumerate() {
        match attempt(equation, &modes, *way, &mut nearest) {
            Ok(found) if is_beyond_doubt(&found, problem, Kind::Continuous) => return Outcome::Solved(found),
            Ok(found) => return decide(equation, &modes, Some(found), Refusal { reason: refusal, nearest }),
            Err(Failure::Certain(reason)) => return Outcome::Infeasible(reason),
            Err(Failure::Hopeless(reason)) => {
                let refusal = Refusal { reason, nearest: NearestEigenvalue::Immaterial };
                return decide(equation, &modes, None, refusal);
            }
            Err(Failure::Doubtful(reason)) => refusal = reason,
        }
        if tried == 0
            && let Some(reason) = certainly_infeasible(&modes)
        {
            return Outcome::Infeasible(reason);
        }
    }
    decide(equation, &modes, None, Refusal { reason: refusal, nearest })
}

/// Returns why a problem that one way in doubles did not solve has no solution for certain. A large one has been asked for eigenvalues on the
/// axis before.
fn certainly_infeasible(modes: &Modes) -> Option<Reason> {
    let states = modes.problem.A.nrows();
    let small = LARGE < states && states <= PRECISE_STATES;
    reason::certainly_lost(modes)
        .or_else(|| if small { reason::certainly_on_boundary(modes.problem) } else { None })
}

/// `nearest` is set to the eigenvalue of the Hamiltonian matrix nearest to the boundary if a large problem's is computed.
fn attempt(
    equation: &(impl Equation + PreciseEquation),
    modes: &Modes,
    way: Start,
    nearest: &mut NearestEigenvalue,
) -> Result<CertifiedSolution, Failure> {
    let problem = modes.problem;
    let (first, method) = match way {
        Start::Schur => {
            let start = subspace::solve_by_schur(problem);
            if let Some(value) = start.nearest.filter(|_| problem.A.nrows() > PRECISE_STATES) {
                *nearest = NearestEigenvalue::Known(value);
            }
            (start.first, RiccatiMethod::Schur)
        }
        Start::Doubling(parameters) => {
            (solve_by_doubling(modes, parameters).map_err(Failure::Certain)?, RiccatiMethod::Doubling)
        }
    };
    let first = first.ok_or(Reason::NoGraph)?;
    unless_lost(&first, modes, |failure| {
        let refined = refine(equation, first.clone()).map_err(failure)?;
        Ok(certify(equation, problem, refined, method)?)
    })
}
