//! The certificate of a Riccati solution, computed from what is returned.

use crate::mat::{C64, Mat};
use crate::sylvester::Kind;
use crate::tolerance::RICCATI_RESIDUAL;

use super::newton::{Equation, Refined};
use super::reason::excess;
use super::scaling::Problem;
use super::{Certificate, Method, Reason};

/// The closed loop and the certificate of a refined solution, or why it is refused.
pub(super) fn certify(
    equation: &impl Equation,
    problem: &Problem,
    refined: &Refined,
    method: Method,
) -> Result<(Vec<C64>, Certificate), Reason> {
    let kind = equation.kind();
    let mut closed_loop = refined.derivative.form.eigenvalues();
    closed_loop.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    let worst = closed_loop.iter().map(|&l| excess(l, kind)).fold(f64::NEG_INFINITY, f64::max);
    let stability = if kind == Kind::Continuous { worst } else { worst + 1.0 };
    let inaccurate = |residual| Reason::Inaccurate { residual, stability };
    let (residual, size) = equation.residual(&refined.X.clone().into()).ok_or(inaccurate(f64::INFINITY))?;
    let relative_residual = if size > 0.0 { residual.norm_fro() / size } else { 0.0 };
    let sound = relative_residual.is_finite() && relative_residual <= RICCATI_RESIDUAL;
    if !sound || (worst >= 0.0 && !closed_loop.is_empty()) {
        return Err(inaccurate(relative_residual));
    }
    let (separation, condition) = sensitivity(problem, refined);
    let certificate = Certificate {
        relative_residual,
        symmetry: 0.0,
        separation,
        condition,
        method,
        newton_steps: refined.steps,
    };
    Ok((closed_loop, certificate))
}

/// Separation and Kenney-Hewer condition number. For a stable operator the solution for the identity attains the norm of
/// the inverse, so that the separation is exact in the 2-norm (here bounded by the Frobenius norm).
fn sensitivity(problem: &Problem, refined: &Refined) -> (f64, f64) {
    let n = problem.A.nrows();
    let U = &refined.derivative.form.U;
    let X = U.t() * &refined.X * U;
    let h0 = refined.derivative.solve_inner(&Mat::eye(n)).norm_fro();
    let h2 = refined.derivative.solve_inner(&(&X * &X)).norm_fro();
    let data = h0 * problem.Q.norm_fro() + 2.0 * (h0 * h2).sqrt() * problem.A.norm_fro() + h2 * problem.G.norm_fro();
    (1.0 / h0, data / X.norm_fro().max(f64::MIN_POSITIVE))
}
