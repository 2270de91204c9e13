//! LQR, the Kalman filter, and LQG with loop transfer recovery.

use counterpoise_linalg::{C64, Mat, Riccati, care, dare};
use counterpoise_lti::{StateSpace, Timebase, series};

use crate::Error;
use crate::cause::DesignEquation;
use crate::certificate::{Equation, riccati};
use crate::finding::Part;

/// A state feedback or an observer gain.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// K of u = -K x (m x n), or L of x' = ... + L (y - C x) (n x p).
    pub gain: Mat,
    /// The solution of the Riccati equation.
    pub X: Mat,
    /// Residual and the spectrum of A - BK or A - LC.
    pub equation: Equation,
}

/// Returns the state feedback that makes the integral (sum) of x'Q x + u'R u + 2 x'N u smallest
///
/// ```text
///     continuous:  A'X + XA - (XB + N) R^-1 (B'X + N') + Q = 0,               K = R^-1 (B'X + N')
///     discrete:    A'XA - X - (A'XB + N)(R + B'XB)^-1 (B'XA + N') + Q = 0,    K = (R + B'XB)^-1 (B'XA + N')
/// ```
///
/// # Errors
/// [`Error::Linalg`] for wrong shapes or matrices that are not symmetric; without stabilising solution
/// [`Error::Refused`] with the mode that is in the way.
pub fn lqr(g: &StateSpace, Q: &Mat, R: &Mat, N: Option<&Mat>) -> Result<Gain, Error> {
    let solved = match g.timebase {
        Timebase::Continuous => care(&g.A, &g.B, Q, R, N)?,
        Timebase::Discrete { .. } => dare(&g.A, &g.B, Q, R, N)?,
    };
    named_gain(DesignEquation::Regulator, solved, |F| F)
}

/// Returns the observer of x' = A x + w, y = C x + v with covariances W of w and V of v; in discrete time the gain of the
/// prediction x\[k+1\] = A x + L (y - C x).
///
/// # Errors
/// As [`lqr`].
pub fn kalman(g: &StateSpace, W: &Mat, V: &Mat) -> Result<Gain, Error> {
    let (A, C) = (g.A.t(), g.C.t());
    let solved = match g.timebase {
        Timebase::Continuous => care(&A, &C, W, V, None)?,
        Timebase::Discrete { .. } => dare(&A, &C, W, V, None)?,
    };
    named_gain(DesignEquation::Filter, solved, |F| F.t())
}

fn named_gain(
    equation: DesignEquation,
    solved: counterpoise_linalg::Outcome<Riccati>,
    shape: impl Fn(Mat) -> Mat,
) -> Result<Gain, Error> {
    let solution = riccati(equation, Part::Generalised, solved)?;
    Ok(Gain { gain: shape(solution.F.clone()), X: solution.X.clone(), equation: solution.into() })
}

/// Returns the observer-based controller from y to u = -K x, for a plant without direct path: x' = (A - BK - LC) x + L y, or
/// x\[k+1\] likewise.
///
/// # Errors
/// [`Error::System`] for a plant with a direct path, [`Error::Lti`] if the gains do not fit.
pub fn observer_controller(g: &StateSpace, K: &Mat, L: &Mat) -> Result<StateSpace, Error> {
    if g.D.norm_max() != 0.0 {
        return Err(Error::System {
            what: "plant",
            problem: "the observer expects no direct path (D is not zero)",
        });
    }
    let (n, m, p) = (g.order(), g.inputs(), g.outputs());
    for (what, found, expected) in [("K", K.shape(), (m, n)), ("L", L.shape(), (n, p))] {
        if found != expected {
            return Err(counterpoise_lti::Error::Shape { what, found, expected }.into());
        }
    }
    let A = &(&g.A - &(&g.B * K)) - &(L * &g.C);
    Ok(StateSpace::new(A, L.clone(), -K, Mat::zeros(K.nrows(), L.ncols()), g.timebase)?)
}

/// An LQG/LTR design.
#[derive(Debug, Clone, PartialEq)]
pub struct LqgLtrDesign {
    /// From y to u, the shaping filter included: closes the loop with the plant by u = K y.
    pub controller: StateSpace,
    /// The loop of the state feedback that is recovered, cut at the shaped plant's input: K (sI - A)^-1 B.
    pub target: StateSpace,
    /// State feedback of the shaped plant.
    pub regulator: Gain,
    /// Observer of the shaped plant.
    pub filter: Gain,
    /// Poles of the loop, by separation.
    pub closed_loop: Vec<C64>,
}

/// Designs LQG with loop transfer recovery at the plant's input (Doyle and Stein, IEEE TAC 26 (1981) 4).
///
/// `shape` goes before the plant: Ga = g shape, an integrator for instance. The state feedback of Ga with Q = C'C and
/// R = `control_weight` is the target; the observer takes white noise of density `recovery` on the input of Ga and of
/// density 1 on the measurement. As `recovery` grows, the loop tends to the target where the plant is of minimum phase.
///
/// # Errors
/// [`Error::Range`] for weights that are not positive, [`Error::System`] for a shaped plant with a direct path. Without
/// solution: [`Error::Refused`].
pub fn lqg_ltr(
    g: &StateSpace,
    shape: &StateSpace,
    control_weight: f64,
    recovery: f64,
) -> Result<LqgLtrDesign, Error> {
    for (what, value) in [("control weight", control_weight), ("recovery", recovery)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::Range { what, value, allowed: "positive" });
        }
    }
    let shaped = series(shape, g)?;
    let (m, p) = (shaped.inputs(), shaped.outputs());
    let regulator = lqr(&shaped, &(&shaped.C.t() * &shaped.C), &Mat::eye(m).scale(control_weight), None)?;
    let W = (&shaped.B * &shaped.B.t()).scale(recovery);
    let filter = kalman(&shaped, &W, &Mat::eye(p))?;
    let inner = observer_controller(&shaped, &regulator.gain, &filter.gain)?;
    let D = Mat::zeros(m, m);
    let target =
        StateSpace::new(shaped.A.clone(), shaped.B.clone(), regulator.gain.clone(), D, shaped.timebase)?;
    let closed_loop = [regulator.equation.spectrum.as_slice(), filter.equation.spectrum.as_slice()].concat();
    Ok(LqgLtrDesign { controller: series(&inner, shape)?, target, regulator, filter, closed_loop })
}
