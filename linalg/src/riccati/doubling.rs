//! Structure-preserving doubling: quadratically convergent, made of products and one LU a step.
//!
//! Source: Chu, Fan and Lin, A structure-preserving doubling algorithm for continuous-time algebraic Riccati equations,
//! Lin. Alg. Appl. 396 (2005); for discrete time the same with Hwang and Wang, Int. J. Control 77 (2004).

use crate::dense::{Factors, LARGE_SYMMETRIC, solve, symmetric_product, view};
use crate::error::Error;
use crate::mat::Mat;
use crate::small_factors;
use crate::tolerance::{
    DOUBLING_EARLY, DOUBLING_EARLY_LARGE, DOUBLING_GROWING, DOUBLING_LATE, DOUBLING_SETTLED, DOUBLING_STEPS,
    PRECISE_STATES,
};

use super::Reason;
use super::modes::Modes;
use super::reason::certainly_unsolvable;
use super::scaling::Problem;

/// Parameters of the Cayley transform, relative to the size of the data: the usual one, and others for a breakdown.
pub(super) const PARAMETERS: [f64; 3] = [0.3, 1.7, 0.05];

/// A first approximation of the stabilising solution of the continuous equation with the first of the parameters that leads
/// to one; `None` if the iteration breaks down with each or does not settle.
///
/// # Errors
/// The reason why there is no solution, if a solution that keeps growing made the question worth its time.
pub(super) fn solve_by_doubling(modes: &Modes, parameters: &[f64]) -> Result<Option<Mat>, Reason> {
    let Problem { A, G, Q } = modes.problem;
    let early = if A.nrows() > PRECISE_STATES { DOUBLING_EARLY_LARGE } else { DOUBLING_EARLY };
    let base = A.norm_fro().max((G.norm_fro() * Q.norm_fro()).sqrt()) / (A.nrows() as f64).sqrt();
    for factor in parameters {
        let question = |X: &Mat| certainly_unsolvable(modes, X);
        match cayley(A, G, Q, factor * base).map(|form| iterate(form, early, question)) {
            Ok(Doubling::Settled(X)) => return Ok(Some(X)),
            Ok(Doubling::Unsolvable(reason)) => return Err(reason),
            // Another parameter settles no equation that this one does not; it may only avoid a singular step.
            Ok(Doubling::Unsettled) => return Ok(None),
            Ok(Doubling::Broken) | Err(_) => {}
        }
    }
    Ok(None)
}

/// The outcome of a doubling iteration.
pub(super) enum Doubling {
    /// It stands still: an approximation of the solution.
    Settled(Mat),
    /// It goes on for ever, as it does if a mode that is not stable is out of reach.
    Unsettled,
    /// It goes on for ever, and this is why.
    Unsolvable(Reason),
    /// A step was singular or not finite.
    Broken,
}

impl Doubling {
    /// The approximation, if there is one.
    pub(super) fn approximation(self) -> Option<Mat> {
        match self {
            Self::Settled(X) => Some(X),
            Self::Unsettled | Self::Unsolvable(_) | Self::Broken => None,
        }
    }
}

/// The Cayley transform with parameter `gamma`: the discrete equation with the same solution.
fn cayley(A: &Mat, G: &Mat, Q: &Mat, gamma: f64) -> Result<Problem, Error> {
    let n = A.nrows();
    let identity = Mat::eye(n);
    let shifted = A - &identity.scale(gamma);
    let forward = solve(&shifted, &G.hstack(&identity))?;
    let (AG, inverse) = (forward.block(0, 0, n, n), forward.block(0, n, n, n));
    let W = shifted.t() + Q * &AG;
    let QA = Q * &inverse;
    let right = solve(&W, &QA.hstack(&identity))?;
    let H = right.block(0, 0, n, n).scale(2.0 * gamma);
    let W_inverse = right.block(0, n, n, n);
    let G = (&AG * &W_inverse).scale(2.0 * gamma);
    let A = identity + W_inverse.t().scale(2.0 * gamma);
    Ok(Problem { A, G: G.symmetric_part(), Q: H.symmetric_part() })
}

/// Doubles `X = A'X (I + G X)^-1 A + Q` until `Q`, which tends to `X`, stands still.
pub(super) fn run(form: Problem) -> Doubling {
    iterate(form, DOUBLING_EARLY, |_| None)
}

/// The same; `question` is asked once if the solution still grows after `early` doublings.
fn iterate(mut form: Problem, early: usize, question: impl Fn(&Mat) -> Option<Reason>) -> Doubling {
    for count in 1..=DOUBLING_STEPS {
        let Some(change) = double(&mut form) else { return Doubling::Broken };
        if change < DOUBLING_SETTLED {
            return Doubling::Settled(form.Q);
        }
        let grows = change > DOUBLING_GROWING;
        if grows && count > DOUBLING_LATE {
            return Doubling::Unsettled;
        }
        if grows
            && count == early
            && let Some(reason) = question(&form.Q)
        {
            return Doubling::Unsolvable(reason);
        }
    }
    Doubling::Unsettled
}

/// One doubling; returns the relative change of `Q`, or `None` if it is singular or not finite.
fn double(form: &mut Problem) -> Option<f64> {
    let n = form.A.nrows();
    if n > LARGE_SYMMETRIC {
        return double_large(form);
    }
    if n <= small_factors::PRODUCTS {
        return double_small(form);
    }
    let middle = shifted_product(&form.G, &form.Q);
    // Both parts of the next form, (I + G Q)^-1 [A, G].
    let solved = solve(&middle, &form.A.hstack(&form.G)).ok()?;
    let transposed = form.A.t();
    let step = (&transposed * (&form.Q * &solved.block(0, 0, n, n))).symmetric_part();
    form.Q += &step;
    let change = step.norm_fro() / form.Q.norm_fro().max(f64::MIN_POSITIVE);
    if !change.is_finite() {
        return None;
    }
    if change >= DOUBLING_SETTLED {
        let moved = &form.A * &solved;
        form.G += &(&moved.block(0, n, n, n) * &transposed).symmetric_part();
        form.A = moved.block(0, 0, n, n);
    }
    Some(change)
}

/// `I + G Q`
fn shifted_product(G: &Mat, Q: &Mat) -> Mat {
    let mut product = G * Q;
    (0..product.nrows()).for_each(|k| product[(k, k)] += 1.0);
    product
}

/// The same for a small problem, with fewer matrices: `(I + G Q)^-1 G` is computed only if there is a next form.
fn double_small(form: &mut Problem) -> Option<f64> {
    let factors = small_factors::Factors::of(shifted_product(&form.G, &form.Q))?;
    let moved = factors.solve(form.A.clone());
    let transposed = form.A.t();
    let step = (&transposed * (&form.Q * &moved)).symmetric_part();
    form.Q += &step;
    let change = step.norm_fro() / form.Q.norm_fro().max(f64::MIN_POSITIVE);
    if !change.is_finite() {
        return None;
    }
    if change >= DOUBLING_SETTLED {
        let driven = &form.A * &factors.solve(form.G.clone());
        if !driven.is_finite() {
            return None;
        }
        form.G += &(&driven * &transposed).symmetric_part();
        form.A = &form.A * &moved;
    }
    Some(change)
}

/// The same for a large problem: half of each symmetric product is computed, and `(I + G Q)^-1 G` only if there is a next form.
fn double_large(form: &mut Problem) -> Option<f64> {
    let middle = shifted_product(&form.G, &form.Q);
    let factors = Factors::of(&middle).ok()?;
    let moved = factors.solve(form.A.clone()).ok()?;
    let step = symmetric_product(view(&form.A).transpose(), &(&form.Q * &moved));
    form.Q += &step;
    let change = step.norm_fro() / form.Q.norm_fro().max(f64::MIN_POSITIVE);
    if !change.is_finite() {
        return None;
    }
    if change >= DOUBLING_SETTLED {
        let driven = &form.A * &factors.solve(form.G.clone()).ok()?;
        form.G += &symmetric_product(view(&driven), &form.A.t());
        form.A = &form.A * &moved;
    }
    Some(change)
}
