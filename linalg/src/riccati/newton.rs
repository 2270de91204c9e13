//! Newton steps that make a Riccati solution as good as its data.
//!
//! Each step solves `L(E) = -residual(X)`, `L` the Lyapunov operator of the closed loop, whose Schur form is kept. The
//! residual is computed in twice the working precision and the sum is kept as two doubles, so that the steps contract
//! until `X` is right to its last bits, whatever the condition of the equation up to 1/eps.

use crate::extended_precision::ExtendedMatrix;
use crate::lyapunov::{Operator, dlyap, lyap, transpose_form};
use crate::mat::Mat;
use crate::schur::schur;
use crate::sylvester::Kind;
use crate::tolerance::{
    EPS, NEWTON_FIRST_CONTRACTION, NEWTON_NEAR_START, NEWTON_SHORT_STEP, NEWTON_SPOILT, NEWTON_STALE_LOOP,
    NEWTON_STALE_RENEWED, NEWTON_STEPS, ROUNDING,
};

use super::Reason;

/// An equation at an approximation `X`.
pub(super) struct Evaluation {
    /// The residual, in twice the working precision before it was rounded.
    pub(super) residual: Mat,
    /// The sum of the norms of the equation's terms.
    pub(super) terms: f64,
    /// The gain that belongs to `X` (`G X` where no input is known).
    pub(super) gain: Mat,
}

/// The change of gain and residual by a step, to working precision.
pub(super) struct Change {
    pub(super) gain: Mat,
    pub(super) residual: Mat,
}

/// The data that Newton's method needs of an equation.
pub(super) trait Equation {
    /// The equation at `X`; `None` if a weight is singular.
    fn evaluate(&self, X: &ExtendedMatrix) -> Option<Evaluation>;
    /// Returns what the step `E` to `X` does, by the identities `K(X+E) = K + W^-1 B'EA_K` and `residual(X+E) = residual(X) + L(E) -
    /// (B'EA_K)'W^-1 B'EA_K`, `A_K = A - BK` (continuous: without `A_K` beside `E`), `W` the weight at `X + E`.
    fn change(&self, before: &Evaluation, E: &Mat, X: &Mat) -> Option<Change>;
    /// `A - B K` (`A - K` where no input is known).
    fn closed_loop(&self, K: &Mat) -> Mat;
    /// By how much the computed residual at `X` may be off: rounding of the gain `K`, which counts in second order, and of
    /// products whose terms cancel.
    fn residual_error(&self, K: &Mat, X: &Mat) -> f64;
    /// Returns which Lyapunov operator the derivative is.
    fn kind(&self) -> Kind;
}

/// A refined solution.
pub(super) struct RefinedSolution {
    pub(super) X: Mat,
    /// The gain, from `X` before it was rounded.
    pub(super) gain: Mat,
    /// The residual of `X` as it is rounded, and by how much its computation may be off.
    pub(super) residual: Mat,
    pub(super) residual_error: f64,
    /// The sum of the norms of the equation's terms.
    pub(super) terms: f64,
    /// The Lyapunov operator of the closed loop's transpose.
    pub(super) derivative: Operator,
    /// The distance of the closed loop from that of the operator, relative to its norm.
    pub(super) moved: f64,
    pub(super) steps: usize,
    /// The ratio of the last step to the one before it, zero if there was one step: small if the derivative was computed well.
    pub(super) contraction: f64,
}

/// The effort spent on the derivative of a step; more if the steps shrink by too little.
#[derive(Clone, Copy, PartialEq)]
enum DerivativeCare {
    /// The closed loop's Schur form is kept while the steps are short.
    Kept,
    /// It is computed anew after all but the shortest steps.
    Renewed,
    /// It is computed anew for each step, balanced, and the step is refined.
    Refined,
}

impl DerivativeCare {
    fn raise(self) -> Self {
        if self == Self::Kept { Self::Renewed } else { Self::Refined }
    }

    /// Returns what follows a step of the given size relative to `X`.
    fn step_end(self, relative: f64) -> StepEnd {
        let longest = if self == Self::Renewed { NEWTON_STALE_RENEWED } else { NEWTON_STALE_LOOP };
        if relative > longest { StepEnd::RenewDerivative } else { StepEnd::KeepDerivative }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum StepEnd {
    KeepDerivative,
    RenewDerivative,
}

/// Refines `X`.
///
/// # Errors
/// [`Reason::NoGraph`] if the closed loop has no Schur form or a step cannot be computed, [`Reason::Inaccurate`] if the start is too
/// far from a solution.
pub(super) fn refine(equation: &impl Equation, X: Mat) -> Result<RefinedSolution, Reason> {
    let mut path = Path::from(equation, X).ok_or(Reason::NoGraph)?;
    let mut size = f64::INFINITY;
    let mut steps = 0;
    let (mut derivative, mut contraction) = (DerivativeCare::Kept, 0.0_f64);
    while steps < NEWTON_STEPS {
        let careful = if derivative == DerivativeCare::Refined { path.careful_step(equation) } else { None };
        let step = careful.unwrap_or_else(|| path.derivative.solve(&path.residual)).symmetric_part();
        let relative = step.norm_fro() / path.X.high.norm_fro().max(f64::MIN_POSITIVE);
        let stuck = relative > 0.5 * size && size < NEWTON_STALE_LOOP;
        if relative > NEWTON_NEAR_START
            && path.derivative.outermost_eigenvalue() >= path.derivative.boundary()
        {
            let residual = path.residual.norm_fro() / path.here.terms.max(f64::MIN_POSITIVE);
            return Err(Reason::Inaccurate {
                residual,
                stability: path.derivative.outermost_eigenvalue(),
                hardest: None,
            });
        }
        if stuck && derivative == DerivativeCare::Renewed {
            derivative = DerivativeCare::Refined;
            continue;
        }
        if !relative.is_finite() || stuck {
            break;
        }
        steps += 1;
        let rate = if size.is_finite() { relative / size } else { NEWTON_FIRST_CONTRACTION * relative };
        if rate > NEWTON_SPOILT && size.is_finite() {
            derivative = derivative.raise();
        }
        if size.is_finite() {
            contraction = rate;
        }
        size = relative;
        path.advance(equation, &step, derivative.step_end(relative)).ok_or(Reason::NoGraph)?;
        if relative * rate < EPS / 16.0 {
            break;
        }
    }
    let refined = path.end(equation).ok_or(Reason::NoGraph)?;
    Ok(RefinedSolution { steps, contraction, ..refined })
}

/// The iterate of Newton's method: `X + ahead`. What the short steps `ahead` do to the equation is computed in working precision.
struct Path {
    X: ExtendedMatrix,
    here: Evaluation,
    ahead: Mat,
    /// The residual at `X + ahead`.
    residual: Mat,
    derivative: Operator,
    /// The closed loop of the derivative.
    closed: Mat,
}

impl Path {
    fn from(equation: &impl Equation, X: Mat) -> Option<Self> {
        let ahead = Mat::zeros(X.nrows(), X.ncols());
        let X = ExtendedMatrix::from(X);
        let here = equation.evaluate(&X)?;
        let closed = equation.closed_loop(&here.gain);
        let derivative = derivative_of(&closed, equation.kind())?;
        Some(Self { X, residual: here.residual.clone(), here, ahead, derivative, closed })
    }

    /// Takes a step, which may make the derivative stale.
    fn advance(&mut self, equation: &impl Equation, step: &Mat, end: StepEnd) -> Option<()> {
        self.ahead += step;
        if self.ahead.norm_fro() <= short_step(equation.kind()) * self.X.high.norm_fro() {
            let X = &self.X.high + &self.ahead;
            self.residual = &self.here.residual + &equation.change(&self.here, &self.ahead, &X)?.residual;
            return Some(());
        }
        self.X = self.X.add(&self.ahead.clone().into());
        self.ahead = Mat::zeros(step.nrows(), step.ncols());
        self.here = equation.evaluate(&self.X)?;
        self.residual = self.here.residual.clone();
        if end == StepEnd::RenewDerivative {
            self.closed = equation.closed_loop(&self.here.gain);
            self.derivative = derivative_of(&self.closed, equation.kind())?;
        }
        Some(())
    }

    /// The step from the closed loop as it is now, balanced first: a pole close to the border of stability keeps its
    /// distance from it, also where the states' units lie far apart.
    fn careful_step(&self, equation: &impl Equation) -> Option<Mat> {
        let X = &self.X.high + &self.ahead;
        let gain = &self.here.gain + &equation.change(&self.here, &self.ahead, &X)?.gain;
        let closed = equation.closed_loop(&gain).t();
        match equation.kind() {
            Kind::Continuous => lyap(&closed, &self.residual).ok(),
            Kind::Discrete => dlyap(&closed, &self.residual).ok(),
        }
    }

    /// The solution, rounded.
    fn end(self, equation: &impl Equation) -> Option<RefinedSolution> {
        let X = self.X.add(&self.ahead.clone().into()).to_double().symmetric_part();
        let rounded = self.X.neg().add(&X.clone().into()).to_double();
        let gain = &self.here.gain + &equation.change(&self.here, &self.ahead, &X)?.gain;
        let residual = &self.here.residual + &equation.change(&self.here, &rounded, &X)?.residual;
        let closed = equation.closed_loop(&gain);
        let size = self.closed.norm_fro();
        let operator = if equation.kind() == Kind::Continuous { 2.0 * size } else { 1.0 + size * size };
        Some(RefinedSolution {
            residual: residual.symmetric_part(),
            residual_error: equation.residual_error(&gain, &X) + ROUNDING * rounded.norm_fro() * operator,
            terms: self.here.terms,
            derivative: self.derivative,
            moved: (&closed - &self.closed).norm_fro() / size.max(f64::MIN_POSITIVE),
            X,
            gain,
            steps: 0,
            contraction: 0.0,
        })
    }
}

/// Returns what a step is short below, relative to `X`: of the continuous equation, whose residual costs half as much, none is.
fn short_step(kind: Kind) -> f64 {
    if kind == Kind::Continuous { 0.0 } else { NEWTON_SHORT_STEP }
}

fn derivative_of(closed: &Mat, kind: Kind) -> Option<Operator> {
    Operator::new(transpose_form(&schur(closed).ok()?), kind).ok()
}
