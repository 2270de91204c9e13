//! Newton steps that make a Riccati solution as good as its data.
//!
//! Each step solves `L(E) = -residual(X)`, `L` the Lyapunov operator of the closed loop, whose Schur form is kept. The
//! residual is computed in twice the working precision and the sum is kept as two doubles, so that the steps contract
//! until `X` is right to its last bits, whatever the condition of the equation up to 1/eps.

use crate::extended::Extended;
use crate::lyapunov::{Operator, dlyap, lyap, transposed};
use crate::mat::Mat;
use crate::schur::schur;
use crate::sylvester::Kind;
use crate::tolerance::{
    EPS, NEWTON_FIRST_CONTRACTION, NEWTON_NEAR_START, NEWTON_SPOILT, NEWTON_STALE_LOOP, NEWTON_STEPS,
};

use super::Reason;

/// What Newton's method needs to know of an equation.
pub(super) trait Equation {
    /// The residual in twice the working precision, and the sum of the norms of its terms.
    fn residual(&self, X: &Extended) -> Option<(Mat, f64)>;
    /// The gain that belongs to `X` (`G X` where no input is known).
    fn gain(&self, X: &Extended) -> Option<Mat>;
    /// `A - B K` (`A - K` where no input is known).
    fn closed_loop(&self, K: &Mat) -> Mat;
    /// By how much the computed residual at `X` may be off: rounding of the gain `K`, which counts in second order, and of
    /// products whose terms cancel.
    fn residual_error(&self, K: &Mat, X: &Mat) -> f64;
    /// Which Lyapunov operator the derivative is.
    fn kind(&self) -> Kind;
}

/// A refined solution.
pub(super) struct Refined {
    pub(super) X: Mat,
    /// The gain, from `X` before it was rounded.
    pub(super) gain: Mat,
    /// The Lyapunov operator of the closed loop's transpose.
    pub(super) derivative: Operator,
    pub(super) steps: usize,
    /// The ratio of the last step to the one before it, zero if there was one step: small if the derivative was computed well.
    pub(super) contraction: f64,
}

/// Refines `X`.
///
/// # Errors
/// [`Reason::NoGraph`] where the closed loop has no Schur form or a step cannot be computed, [`Reason::Inaccurate`] where the start is too
/// far from a solution.
pub(super) fn refine(equation: &impl Equation, X: Mat) -> Result<Refined, Reason> {
    let mut X = Extended::from(X);
    let mut derivative = derivative_at(equation, &X).ok_or(Reason::NoGraph)?;
    let mut size = f64::INFINITY;
    let mut steps = 0;
    let (mut slow, mut contraction) = (false, 0.0_f64);
    while steps < NEWTON_STEPS {
        let (residual, terms) = equation.residual(&X).ok_or(Reason::NoGraph)?;
        let careful = if slow { careful_step(equation, &X, &residual) } else { None };
        let step = careful.unwrap_or_else(|| derivative.solve(&residual));
        let step = step.symmetric_part();
        let relative = step.norm_fro() / X.high.norm_fro().max(f64::MIN_POSITIVE);
        let stuck = relative > 0.5 * size && size < NEWTON_STALE_LOOP;
        if relative > NEWTON_NEAR_START && derivative.reach() >= derivative.boundary() {
            let residual = residual.norm_fro() / terms.max(f64::MIN_POSITIVE);
            return Err(Reason::Inaccurate { residual, stability: derivative.reach(), hardest: None });
        }
        if !relative.is_finite() || stuck {
            break;
        }
        X = X.add(&step.into());
        steps += 1;
        let rate = if size.is_finite() { relative / size } else { NEWTON_FIRST_CONTRACTION * relative };
        slow = slow || rate > NEWTON_SPOILT && size.is_finite();
        if size.is_finite() {
            contraction = rate;
        }
        if relative > NEWTON_STALE_LOOP {
            derivative = derivative_at(equation, &X).ok_or(Reason::NoGraph)?;
        }
        size = relative;
        if relative * rate < EPS / 16.0 {
            break;
        }
    }
    let gain = equation.gain(&X).ok_or(Reason::NoGraph)?;
    Ok(Refined { X: X.collapse().symmetric_part(), gain, derivative, steps, contraction })
}

/// The step from the closed loop as it is now, balanced first: a pole close to the border of stability keeps its
/// distance from it, also where the states' units lie far apart.
fn careful_step(equation: &impl Equation, X: &Extended, residual: &Mat) -> Option<Mat> {
    let closed = equation.closed_loop(&equation.gain(X)?).t();
    match equation.kind() {
        Kind::Continuous => lyap(&closed, residual).ok(),
        Kind::Discrete => dlyap(&closed, residual).ok(),
    }
}

fn derivative_at(equation: &impl Equation, X: &Extended) -> Option<Operator> {
    let closed = equation.closed_loop(&equation.gain(X)?);
    Operator::new(transposed(&schur(&closed).ok()?), equation.kind()).ok()
}
