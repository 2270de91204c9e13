//! The certificate of a Riccati solution, computed from what is returned.

use crate::long_matrix::LongMatrix;
use crate::lyapunov::Operator;
use crate::mat::{C64, Mat};
use crate::schur::eigenvalues;
use crate::sylvester::Kind;
use crate::tolerance::{EPS, RICCATI_RESIDUAL, RICCATI_SPECTRUM_MOVES, RICCATI_SPECTRUM_SHARE, ROUNDING};

use super::long_solution::{self, InverseNorms, PreciseEquation, relative_step};
use super::newton::{Equation, RefinedSolution};
use super::reason::excess;
use super::scaling::Problem;
use super::{Reason, Riccati, RiccatiCertificate, RiccatiMethod};

/// A solution in scaled units with its residual.
pub(super) struct CertifiedSolution {
    pub(super) solution: Riccati,
    /// The residual of the solution as it is returned.
    pub(super) residual: Mat,
    /// The norm of the closed loop's Lyapunov operator, to which its separation is compared.
    pub(super) operator_norm: f64,
    /// The ratio of the last Newton step to the one before it.
    pub(super) contraction: f64,
    normwise: ConditionBasis,
}

/// The data that Kenney and Hewer's condition number is computed from, if it is asked for.
enum ConditionBasis {
    /// The norms of the inverse Lyapunov operator applied to `I` and to `X^2`.
    Norms(InverseNorms),
    /// The first of them, and the operator.
    Operator(f64, Operator),
}

impl CertifiedSolution {
    /// Kenney and Hewer's condition number in scaled units, of changes that are small beside the norms of the data.
    pub(super) fn normwise_condition(&self, problem: &Problem) -> f64 {
        match &self.normwise {
            ConditionBasis::Norms(norms) => condition(problem, *norms, &self.solution.X),
            ConditionBasis::Operator(h0, derivative) => normwise(problem, derivative, *h0, &self.solution.X),
        }
    }
}

/// A refined solution with its closed loop and certificate, or why it is refused.
pub(super) fn certify(
    equation: &(impl Equation + PreciseEquation),
    problem: &Problem,
    refined: RefinedSolution,
    method: RiccatiMethod,
) -> Result<CertifiedSolution, Reason> {
    let kind = Equation::kind(equation);
    let h0 = refined.derivative.solve_inner(&Mat::eye(problem.A.nrows())).norm_fro();
    // For a stable operator the solution for the identity attains the norm of the inverse, so that the separation is exact in the 2-norm
    // (here bounded by the Frobenius norm).
    let separation = 1.0 / h0;
    let closed_loop = spectrum(equation, &refined, h0);
    let worst = worst_excess(&closed_loop, kind);
    let inaccurate = |residual| inaccuracy_reason(residual, worst, kind);
    let remaining = refined.residual.norm_fro();
    let size = refined.terms;
    let relative_residual = if size > 0.0 { remaining / size } else { 0.0 };
    let backward_error = remaining / data_size(problem, &refined.X);
    let sound = relative_residual <= RICCATI_RESIDUAL || backward_error <= ROUNDING;
    if !sound || (worst >= 0.0 && !closed_loop.is_empty()) {
        return Err(inaccurate(relative_residual));
    }
    let unknown = refined.residual_error / separation;
    let forward_error = refined.derivative.solve(&refined.residual).map(|e| e.abs() + unknown);
    let moduli = equation.moduli(&refined.gain, &refined.X);
    let data_change = refined.derivative.solve(&moduli).map(f64::abs);
    let operator_norm = operator_norm(refined.derivative.form.T.norm_fro(), kind);
    let certificate = RiccatiCertificate {
        relative_residual,
        backward_error,
        symmetry: asymmetry(&refined.X),
        separation,
        condition: relative_step(&data_change, &refined.X),
        data_error: data_change.scale(EPS),
        forward_error,
        residual_norm: remaining,
        term_norm: size,
        scale: Vec::new(),
        method,
        newton_steps: refined.steps,
    };
    let solution = Riccati { X: refined.X, F: refined.gain, closed_loop, certificate };
    let normwise = ConditionBasis::Operator(h0, refined.derivative);
    Ok(CertifiedSolution {
        solution,
        residual: refined.residual,
        operator_norm,
        contraction: refined.contraction,
        normwise,
    })
}

/// A solution in 32 digits, rounded, with its certificate.
pub(super) fn certify_precise(
    equation: &(impl Equation + PreciseEquation),
    problem: &Problem,
    found: long_solution::Solution,
) -> Option<CertifiedSolution> {
    let kind = Equation::kind(equation);
    let X = found.X.round().symmetric_part();
    let residual = equation.linearise(&LongMatrix::from(&X))?.residual.high;
    let size = equation.evaluate(&X.clone().into())?.terms;
    let remaining = residual.norm_fro();
    let rounding = found.X.difference(&LongMatrix::from(&X)).high;
    let certificate = RiccatiCertificate {
        relative_residual: if size > 0.0 { remaining / size } else { 0.0 },
        backward_error: remaining / data_size(problem, &X),
        symmetry: asymmetry(&X),
        separation: 1.0 / found.inverse_norms.of_identity,
        condition: relative_step(&found.data_change, &X),
        data_error: found.data_change.map(f64::abs).scale(EPS),
        forward_error: rounding.map(f64::abs) + found.last_step.map(f64::abs),
        residual_norm: remaining,
        term_norm: size,
        scale: Vec::new(),
        method: RiccatiMethod::Precise,
        newton_steps: found.steps,
    };
    let normwise = ConditionBasis::Norms(found.inverse_norms);
    let mut closed_loop = eigenvalues(&found.closed.round()).ok()?;
    closed_loop.iter_mut().for_each(|l| *l = mirror_inside(*l, kind));
    let solution = Riccati { X, F: found.gain.round(), closed_loop, certificate };
    let operator_norm = operator_norm(found.closed.high.norm_fro(), kind);
    Some(CertifiedSolution { solution, residual, operator_norm, contraction: 0.0, normwise })
}

/// A bound of the norm of the Lyapunov operator of a closed loop of the given norm.
fn operator_norm(closed: f64, kind: Kind) -> f64 {
    match kind {
        Kind::Continuous => 2.0 * closed,
        Kind::Discrete => 1.0 + closed * closed,
    }
}

/// An eigenvalue of a closed loop whose powers tend to zero: what rounding put on or beyond the boundary is mirrored.
fn mirror_inside(l: C64, kind: Kind) -> C64 {
    match kind {
        Kind::Continuous if l.re >= 0.0 => C64::new(-l.re.max(f64::MIN_POSITIVE), l.im),
        Kind::Discrete if l.norm() >= 1.0 => l / (l.norm_sqr() * (1.0 + EPS)),
        _ => l,
    }
}

/// The largest excess of the eigenvalues beyond the stability boundary.
fn worst_excess(closed_loop: &[C64], kind: Kind) -> f64 {
    closed_loop.iter().map(|&l| excess(l, kind)).fold(f64::NEG_INFINITY, f64::max)
}

/// The refusal of an approximation, without the mode behind it.
fn inaccuracy_reason(residual: f64, worst: f64, kind: Kind) -> Reason {
    let stability = if kind == Kind::Continuous { worst } else { worst + 1.0 };
    Reason::Inaccurate { residual, stability, hardest: None }
}

/// `norm(X - X') / norm(X)`
fn asymmetry(X: &Mat) -> f64 {
    (X - &X.t()).norm_fro() / X.norm_fro().max(f64::MIN_POSITIVE)
}

/// `norm(Q) + 2 norm(A) norm(X) + norm(G) norm(X)^2`: what rounding `X` moves the residual by, over eps.
fn data_size(problem: &Problem, X: &Mat) -> f64 {
    let x = X.norm_fro();
    let size = problem.Q.norm_fro() + 2.0 * problem.A.norm_fro() * x + problem.G.norm_fro() * x * x;
    size.max(f64::MIN_POSITIVE)
}

/// The eigenvalues of the closed loop, sorted: those of the operator, unless the closed loop has moved since; `h0` is the norm of the inverse
/// operator applied to `I`.
fn spectrum(equation: &impl Equation, refined: &RefinedSolution, h0: f64) -> Vec<C64> {
    let change = refined.moved * refined.derivative.form.T.norm_fro();
    if (refined.moved > RICCATI_SPECTRUM_MOVES || change * h0 > RICCATI_SPECTRUM_SHARE)
        && let Ok(sorted) = eigenvalues(&equation.closed_loop(&refined.gain))
    {
        return sorted;
    }
    let mut values = refined.derivative.form.eigenvalues();
    values.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    values
}

/// Kenney and Hewer's condition number; `h0` is the norm of the inverse operator applied to `I`.
fn normwise(problem: &Problem, derivative: &Operator, h0: f64, solution: &Mat) -> f64 {
    let U = &derivative.form.U;
    let X = U.t() * solution * U;
    let h2 = derivative.solve_inner(&(&X * &X)).norm_fro();
    condition(problem, InverseNorms { of_identity: h0, of_square: h2 }, &X)
}

/// The condition number from the norms of the inverse operator applied to `I` and to `X^2`.
fn condition(problem: &Problem, norms: InverseNorms, X: &Mat) -> f64 {
    let InverseNorms { of_identity: h0, of_square: h2 } = norms;
    let data =
        h0 * problem.Q.norm_fro() + 2.0 * (h0 * h2).sqrt() * problem.A.norm_fro() + h2 * problem.G.norm_fro();
    data / X.norm_fro().max(f64::MIN_POSITIVE)
}
