//! The certificate of a Riccati solution, computed from what is returned.

use crate::mat::{C64, Mat};
use crate::schur::eigenvalues;
use crate::sylvester::Kind;
use crate::tolerance::{RICCATI_RESIDUAL, ROUNDING};

use super::newton::{Equation, Refined};
use super::reason::{excess, hardest_mode};
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
    let (separation, condition) = sensitivity(problem, refined);
    let closed_loop = spectrum(equation, refined, condition);
    let worst = closed_loop.iter().map(|&l| excess(l, kind)).fold(f64::NEG_INFINITY, f64::max);
    let stability = if kind == Kind::Continuous { worst } else { worst + 1.0 };
    let inaccurate =
        |residual| Reason::Inaccurate { residual, stability, hardest: hardest_mode(problem, kind) };
    let (residual, size) =
        equation.residual(&refined.X.clone().into()).ok_or_else(|| inaccurate(f64::INFINITY))?;
    let residual = residual.norm_fro();
    let relative_residual = if size > 0.0 { residual / size } else { 0.0 };
    let backward_error = residual / data_size(problem, &refined.X);
    let sound = relative_residual <= RICCATI_RESIDUAL || backward_error <= ROUNDING;
    if !sound || (worst >= 0.0 && !closed_loop.is_empty()) {
        return Err(inaccurate(relative_residual));
    }
    let symmetry = asymmetry(&refined.X);
    let newton_steps = refined.steps;
    let certificate = Certificate {
        relative_residual,
        backward_error,
        symmetry,
        separation,
        condition,
        method,
        newton_steps,
    };
    Ok((closed_loop, certificate))
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

/// Where the solution is this sensitive, the spectrum of the first approximation is not that of the last.
const SENSITIVE: f64 = 1e6;

/// The eigenvalues of the closed loop, sorted.
fn spectrum(equation: &impl Equation, refined: &Refined, condition: f64) -> Vec<C64> {
    if condition > SENSITIVE
        && let Ok(sorted) = eigenvalues(&equation.closed_loop(&refined.gain))
    {
        return sorted;
    }
    let mut values = refined.derivative.form.eigenvalues();
    values.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    values
}

/// Separation and Kenney-Hewer condition number. For a stable operator the solution for the identity attains the norm of
/// the inverse, so that the separation is exact in the 2-norm (here bounded by the Frobenius norm).
fn sensitivity(problem: &Problem, refined: &Refined) -> (f64, f64) {
    let n = problem.A.nrows();
    let U = &refined.derivative.form.U;
    let X = U.t() * &refined.X * U;
    let h0 = refined.derivative.solve_inner(&Mat::eye(n)).norm_fro();
    let h2 = refined.derivative.solve_inner(&(&X * &X)).norm_fro();
    let data =
        h0 * problem.Q.norm_fro() + 2.0 * (h0 * h2).sqrt() * problem.A.norm_fro() + h2 * problem.G.norm_fro();
    (1.0 / h0, data / X.norm_fro().max(f64::MIN_POSITIVE))
}
