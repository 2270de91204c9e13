//! The last word on a problem: accepted as solved in doubles, solved again in 32 digits, or refused with the reason.

use crate::mat::{C64, Mat};
use crate::sylvester::Kind;
use crate::tolerance::{
    EPS, PRECISE_STATES, RICCATI_DETERMINED, RICCATI_DOUBTFUL_SEPARATION, RICCATI_ERROR,
    RICCATI_HARDLY_REACHED, RICCATI_UNDETERMINED, SENSITIVE, TRUSTED_SEPARATION,
};

use super::certify::{Certified, certify_precise};
use super::newton::Equation;
use super::precise::{self, PreciseEquation, relative_step};
use super::reason::{self, Nearness};
use super::scaling::{Problem, Scaled, rescale};
use super::{Certificate, Outcome, Reason, Riccati};

/// Whether a solution in doubles is accepted without further questions.
pub(super) fn is_beyond_doubt(found: &Certified, problem: &Problem, kind: Kind) -> bool {
    let size = size(problem, kind).max(found.operator_norm);
    found.solution.certificate.separation > RICCATI_DOUBTFUL_SEPARATION * size && is_accurate(found)
}

/// Whether the error that is left is small beside each pair of states.
fn is_accurate(found: &Certified) -> bool {
    relative_step(&found.solution.certificate.forward_error, &found.solution.X) <= RICCATI_ERROR
}

/// Whether neither the data nor the computation determines a solution: the data to no digit, the computation to less than three. It is what
/// Newton's method makes of a multiple mode that is out of reach.
fn is_undetermined(found: &Certified) -> bool {
    let Certificate { condition, forward_error, .. } = &found.solution.certificate;
    condition * EPS > RICCATI_UNDETERMINED && relative_step(forward_error, &found.solution.X) > SENSITIVE
}

/// The size to which a separation is compared.
fn size(problem: &Problem, kind: Kind) -> f64 {
    if kind == Kind::Continuous { problem.A.norm_fro() } else { 1.0 }
}

/// Why doubles gave no solution, as far as the solvers know.
pub(super) struct Refusal {
    pub(super) reason: Reason,
    /// The eigenvalue of the Hamiltonian matrix nearest to the boundary, if it is known already.
    pub(super) nearest: Option<C64>,
}

impl From<Reason> for Refusal {
    fn from(reason: Reason) -> Self {
        Self { reason, nearest: None }
    }
}

/// Decides a problem for which doubles gave a doubtful solution (`found`) or none (`refusal`).
pub(super) fn decide(
    equation: &(impl Equation + PreciseEquation),
    problem: &Problem,
    found: Option<Certified>,
    refusal: Refusal,
) -> Outcome<Certified> {
    let kind = Equation::kind(equation);
    let separated =
        |c: &Certified| c.solution.certificate.separation > TRUSTED_SEPARATION * size(problem, kind);
    let found = match found {
        Some(found) if is_accurate(&found) && separated(&found) => {
            return accept(found, problem, kind, RICCATI_DETERMINED);
        }
        other => other,
    };
    if found.is_none()
        && kind == Kind::Continuous
        && refusal.nearest.is_none()
        && let Some(reason) = reason::certainly_on_boundary(problem)
    {
        return Outcome::Infeasible(reason);
    }
    let start = found.as_ref().map(|found| &found.solution.X);
    if let Some(better) = solve_precisely(equation, problem, start) {
        return accept(better, problem, kind, RICCATI_UNDETERMINED);
    }
    match found {
        Some(found) if is_undetermined(&found) => {
            let residual = found.solution.certificate.relative_residual;
            let reaches = found.solution.closed_loop.iter().map(|&l| reason::excess(l, kind));
            let boundary = if kind == Kind::Continuous { 0.0 } else { 1.0 };
            let stability = boundary + reaches.fold(f64::NEG_INFINITY, f64::max);
            let reason = Reason::Inaccurate { residual, stability, hardest: None };
            Outcome::Infeasible(explained(Refusal { reason, ..refusal }, problem, kind))
        }
        Some(found) => accept(found, problem, kind, 0.0),
        None => Outcome::Infeasible(explained(refusal, problem, kind)),
    }
}

fn solve_precisely(
    equation: &(impl Equation + PreciseEquation),
    problem: &Problem,
    start: Option<&Mat>,
) -> Option<Certified> {
    if problem.A.nrows() > PRECISE_STATES {
        return None;
    }
    certify_precise(equation, problem, precise::solve(equation, start)?)
}

/// The solution, unless it is so sensitive that a mode may be within reach, or in sight, by rounding alone.
fn accept(found: Certified, problem: &Problem, kind: Kind, limit: f64) -> Outcome<Certified> {
    let lost = if found.solution.certificate.condition * EPS > limit {
        reason::lost_mode(problem, kind, Nearness::Rounding)
    } else {
        None
    };
    lost.map_or(Outcome::Solved(found), Outcome::Infeasible)
}

/// The mode behind a refusal, if one can be named.
fn explained(refusal: Refusal, problem: &Problem, kind: Kind) -> Reason {
    if let Some(reason) = reason::diagnose(problem, kind, refusal.nearest) {
        return reason;
    }
    match refusal.reason {
        Reason::Inaccurate { residual, stability, .. } => {
            let hardest =
                reason::hardest_mode(problem, kind).filter(|(_, reach)| *reach < RICCATI_HARDLY_REACHED);
            Reason::Inaccurate { residual, stability, hardest }
        }
        other => other,
    }
}

/// The solution in the caller's units; `terms` gives the sum of the norms of the equation's terms there.
pub(super) fn in_callers_units(
    found: Certified,
    units: &Scaled,
    gain: impl FnOnce(&Mat) -> Mat,
    terms: impl FnOnce(&Riccati) -> f64,
) -> Riccati {
    let Certified { mut solution, residual, .. } = found;
    let (d, certificate) = (&units.scale, &mut solution.certificate);
    solution.X = units.restore(&solution.X);
    solution.F = gain(&solution.F);
    certificate.forward_error = units.restore(&certificate.forward_error);
    certificate.residual_norm = {
        let back: Vec<f64> = d.iter().map(|d| 1.0 / d).collect();
        rescale(&residual, &back, &back).norm_fro()
    };
    solution.certificate.term_norm = terms(&solution);
    solution
}
