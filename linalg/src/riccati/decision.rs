//! The last word on a problem: accepted as solved in doubles, solved again in 32 digits, or refused with the reason.

use crate::error::{Error, check_range};
use crate::mat::Mat;
use crate::sylvester::Kind;
use crate::tolerance::{
    DATA_LIMITED_STATES, EPS, NEWTON_CONTRACTS, PRECISE_STATES, RICCATI_DETERMINED,
    RICCATI_DOUBTFUL_SEPARATION, RICCATI_ERROR, RICCATI_HARDLY_REACHED, RICCATI_RESIDUAL,
    RICCATI_UNDETERMINED, SENSITIVE, TRUSTED_SEPARATION,
};

use super::certificate::{CertifiedSolution, certify_precise};
use super::long_solution::{self, PreciseEquation, relative_step};
use super::modes::Modes;
use super::newton::Equation;
use super::reason::{self, NearestEigenvalue, Nearness};
use super::scaling::{Problem, ScaledProblem, rescale};
use super::{Outcome, Reason, Riccati, RiccatiCertificate};

/// Returns whether a solution in doubles is accepted without further questions.
pub(super) fn is_beyond_doubt(found: &CertifiedSolution, problem: &Problem, kind: Kind) -> bool {
    let size = size(problem, kind).max(found.operator_norm);
    found.solution.certificate.separation > RICCATI_DOUBTFUL_SEPARATION * size && is_accurate(found)
}

/// Returns whether the error that is left is small beside each pair of states; of a larger problem, whose solution in 32 digits takes many times as
/// long, also if rounding the data changes the solution by more.
fn is_accurate(found: &CertifiedSolution) -> bool {
    let large = found.solution.X.nrows() > DATA_LIMITED_STATES;
    let by_data = EPS * found.solution.certificate.condition;
    let limit = if large { RICCATI_ERROR.max(by_data) } else { RICCATI_ERROR };
    relative_step(&found.solution.certificate.forward_error, &found.solution.X) <= limit
}

/// Returns whether neither the data nor the computation determines a solution: the data to no digit, the computation to less than three. It is what
/// Newton's method makes of a multiple mode that is out of reach.
fn is_undetermined(found: &CertifiedSolution, problem: &Problem) -> bool {
    let RiccatiCertificate { forward_error, .. } = &found.solution.certificate;
    relative_step(forward_error, &found.solution.X) > SENSITIVE
        && found.normwise_condition(problem) * EPS > RICCATI_UNDETERMINED
}

/// Returns whether an approximation that is in doubt is no solution: 32 digits do not lead to one, or the problem is too large for them, and the
/// residual is not small beside the terms. It may still be rounding beside the factors of the terms if these nearly cancel, as those of a
/// level just below the norm of a difference of two systems do, for which there is none.
fn is_spurious(found: &CertifiedSolution) -> bool {
    found.solution.certificate.relative_residual > RICCATI_RESIDUAL
}

/// The size to which a separation is compared.
fn size(problem: &Problem, kind: Kind) -> f64 {
    if kind == Kind::Continuous { problem.A.norm_fro() } else { 1.0 }
}

/// Why doubles gave no solution, as far as the solvers know.
pub(super) struct Refusal {
    pub(super) reason: Reason,
    /// The facts that are known of the eigenvalue of the Hamiltonian matrix nearest to the boundary.
    pub(super) nearest: NearestEigenvalue,
}

impl From<Reason> for Refusal {
    fn from(reason: Reason) -> Self {
        Self { reason, nearest: NearestEigenvalue::Unknown }
    }
}

/// Returns what `solve` makes of the first approximation of a solution; it is told what a failed refinement means.
///
/// An approximation may be so large because rounding alone put a mode within reach. The mode is looked for before one is refined that is larger
/// than doubles can tell from infinity, and after that if the solution failed or the data do not determine it: rounding the data would change the
/// solution that belongs to a lost mode by as much as itself.
pub(super) fn unless_lost(
    first: &Mat,
    modes: &Modes,
    solve: impl FnOnce(fn(Reason) -> Failure) -> Result<CertifiedSolution, Failure>,
) -> Result<CertifiedSolution, Failure> {
    let lost = || reason::certainly_lost(modes).map(Failure::Certain);
    if reason::is_beyond_doubles(first, modes) {
        return lost().map_or_else(|| solve(Failure::from_hopeless), Err);
    }
    let found = solve(Failure::from);
    let is_determined = |c: &CertifiedSolution| EPS * c.solution.certificate.condition <= RICCATI_DETERMINED;
    if !reason::is_suspicious(first, modes) || found.as_ref().is_ok_and(is_determined) {
        return found;
    }
    lost().map_or(found, Err)
}

/// Decides a problem for which doubles gave a doubtful solution (`found`) or none (`refusal`).
pub(super) fn decide(
    equation: &(impl Equation + PreciseEquation),
    modes: &Modes,
    found: Option<CertifiedSolution>,
    refusal: Refusal,
) -> Outcome<CertifiedSolution> {
    let (problem, kind) = (modes.problem, modes.kind);
    let separated = |c: &CertifiedSolution| {
        let large = problem.A.nrows() > DATA_LIMITED_STATES;
        let separation = c.solution.certificate.separation;
        separation > TRUSTED_SEPARATION * size(problem, kind) || large && c.contraction <= NEWTON_CONTRACTS
    };
    let found = match found {
        Some(found) if is_accurate(&found) && separated(&found) => {
            return accept(found, modes, RICCATI_DETERMINED);
        }
        other => other,
    };
    if found.is_none()
        && kind == Kind::Continuous
        && matches!(refusal.nearest, NearestEigenvalue::Unknown)
        && let Some(reason) = reason::certainly_on_boundary(problem)
    {
        return Outcome::Infeasible(reason);
    }
    let start = found.as_ref().map(|found| &found.solution.X);
    if let Some(better) = solve_precisely(equation, problem, start) {
        return accept(better, modes, RICCATI_UNDETERMINED);
    }
    match found {
        Some(found) if is_undetermined(&found, problem) || is_spurious(&found) => {
            let residual = found.solution.certificate.relative_residual;
            let reaches = found.solution.closed_loop.iter().map(|&l| reason::excess(l, kind));
            let boundary = if kind == Kind::Continuous { 0.0 } else { 1.0 };
            let stability = boundary + reaches.fold(f64::NEG_INFINITY, f64::max);
            let reason = Reason::Inaccurate { residual, stability, hardest: None };
            Outcome::Infeasible(explain_refusal(Refusal { reason, ..refusal }, modes))
        }
        Some(found) => accept(found, modes, 0.0),
        None => Outcome::Infeasible(explain_refusal(refusal, modes)),
    }
}

fn solve_precisely(
    equation: &(impl Equation + PreciseEquation),
    problem: &Problem,
    start: Option<&Mat>,
) -> Option<CertifiedSolution> {
    if problem.A.nrows() > PRECISE_STATES {
        return None;
    }
    certify_precise(equation, problem, long_solution::solve(equation, start)?)
}

/// The solution, unless it is so sensitive that a mode may be within reach, or in sight, by rounding alone.
fn accept(found: CertifiedSolution, modes: &Modes, limit: f64) -> Outcome<CertifiedSolution> {
    let lost = if found.normwise_condition(modes.problem) * EPS > limit {
        reason::lost_mode(modes, Nearness::Rounding)
    } else {
        None
    };
    lost.map_or(Outcome::Solved(found), Outcome::Infeasible)
}

/// The mode behind a refusal, if one can be named.
fn explain_refusal(refusal: Refusal, modes: &Modes) -> Reason {
    if let Some(reason) = reason::diagnose(modes, refusal.nearest) {
        return reason;
    }
    match refusal.reason {
        Reason::Inaccurate { residual, stability, .. } => {
            let hardest = reason::hardest_mode(modes).filter(|(_, reach)| *reach < RICCATI_HARDLY_REACHED);
            Reason::Inaccurate { residual, stability, hardest }
        }
        other => other,
    }
}

/// The solution in the caller's units, if they hold it; `terms` gives the sum of the norms of the equation's terms there.
pub(super) fn convert_to_callers_units(
    found: CertifiedSolution,
    units: &ScaledProblem,
    gain: impl FnOnce(&Mat) -> Mat,
    terms: impl FnOnce(&Riccati) -> f64,
) -> Result<Riccati, Error> {
    let CertifiedSolution { mut solution, residual, .. } = found;
    let (d, certificate) = (&units.scale, &mut solution.certificate);
    solution.X = units.restore(&solution.X);
    solution.F = gain(&solution.F);
    certificate.forward_error = units.restore(&certificate.forward_error);
    certificate.data_error = units.restore(&certificate.data_error);
    certificate.scale = d.clone();
    certificate.residual_norm = {
        let back: Vec<f64> = d.iter().map(|d| 1.0 / d).collect();
        rescale(&residual, &back, &back).norm_fro()
    };
    solution.certificate.term_norm = terms(&solution);
    solution.X = check_range("the solution of the Riccati equation", solution.X)?;
    solution.F = check_range("the gain of the Riccati equation", solution.F)?;
    solution.certificate.bound_unknown();
    Ok(solution)
}

/// Why a way did not lead to a solution.
pub(super) enum Failure {
    /// There is none.
    Certain(Reason),
    /// Another way may.
    Doubtful(Reason),
    /// No other way in doubles will.
    Hopeless(Reason),
}

impl Failure {
    /// The failure of a refinement from a start that is larger than doubles can tell from infinity.
    pub(super) fn from_hopeless(reason: Reason) -> Self {
        match Self::from(reason) {
            Self::Doubtful(reason) => Self::Hopeless(reason),
            other => other,
        }
    }
}

impl From<Reason> for Failure {
    fn from(reason: Reason) -> Self {
        match reason {
            Reason::Uncontrollable { .. } => Self::Certain(reason),
            other => Self::Doubtful(other),
        }
    }
}
