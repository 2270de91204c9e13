//! Frequency-weighted balancing (Enns 1984), and the reduction of a controller that keeps its loop.

use crate::balanced_truncation::BalancedSystem;
use crate::reduction::choose;
use crate::split::split_stable;
use crate::tolerance::EXACT_NORM;
use crate::{Error, Method, Order, Reduction, Warning};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::scaling::balance;
use counterpoise_lti::{
    Peak, StateSpace, Timebase, ctrb_factor, feedback, is_stable_pole, linfnorm, obsv_factor, parallel,
    poles, series,
};

/// The error that counts is `output (g - reduced) input`.
#[derive(Debug, Clone, Copy)]
pub struct Weights<'a> {
    /// Stable weight on the outputs, as many inputs as g has outputs.
    pub output: &'a StateSpace,
    /// Stable weight on the inputs, as many outputs as g has inputs.
    pub input: &'a StateSpace,
}

/// Returns the frequency-weighted balanced reduction of the stable part of `g`; the rest is kept.
///
/// The Gramians are the blocks that belong to g in those of `g input` and `output g`. There is no a priori bound: the
/// weighted error is measured.
///
/// # Errors
/// [`Error::Unstable`] for a weight that is not stable; as [`crate::balred`].
pub fn weighted_balred(
    g: &StateSpace,
    weights: Weights,
    order: Order,
    method: Method,
) -> Result<Reduction, Error> {
    needs_stable("the output weight", weights.output)?;
    needs_stable("the input weight", weights.input)?;
    let parts = split_stable(g)?;
    let (stable, _) = balance(&parts.first);
    let n = stable.order();
    let driven = ctrb_factor(&series(weights.input, &stable)?)?;
    let R = driven.block(weights.input.order(), 0, n, driven.ncols());
    let seen = obsv_factor(&series(&stable, weights.output)?)?;
    let L = seen.block(0, 0, n, seen.ncols());
    let balanced = BalancedSystem::from_factors(stable.clone(), R, L)?;
    let hankel = balanced.hankel().to_vec();
    let untouched = parts.second.order();
    let (kept, warnings) = choose(&hankel, order, untouched)?;
    let reduced = balanced.reduce(kept, method)?;
    let error = parallel(&stable, &reduced.negate())?;
    let weighted = series(&series(weights.input, &error)?, weights.output)?;
    let measured_error = linfnorm(&weighted, EXACT_NORM)?;
    let system = parallel(&reduced, &parts.second)?;
    Ok(Reduction { system, bound: None, measured_error, hankel, kept, untouched, warnings })
}

/// A reduced controller and what it does to its loop.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerReduction {
    /// The reduction; its measured error is weighted, so that a value below one keeps the loop stable to first order.
    pub reduction: Reduction,
    /// `true` if the loop with the reduced controller is stable.
    pub closed_loop_stable: bool,
    /// Pole of that loop nearest to, or farthest beyond, the border of stability.
    pub critical_pole: C64,
    /// Largest change of the complementary sensitivity G K inv(1 + G K); infinite if the loop is lost.
    pub closed_loop_error: Peak,
}

/// Reduces the controller K of the loop `u = K (r - G u)` so that the loop keeps its response.
///
/// The change of the closed loop is, to first order, inv(1 + GK) G (Kr - K) inv(1 + GK): these are the weights. Integrators
/// and unstable poles of K are kept.
///
/// # Errors
/// [`Error::Unstable`] if the loop is not stable to begin with; as [`weighted_balred`].
pub fn reduce_controller(
    G: &StateSpace,
    K: &StateSpace,
    order: Order,
    method: Method,
) -> Result<ControllerReduction, Error> {
    let unit = StateSpace::gain(Mat::eye(G.outputs()), G.timebase)?;
    let S = feedback(&unit, &series(K, G)?)?;
    needs_stable("the loop", &S)?;
    let SG = feedback(G, K)?;
    let weights = Weights { output: &SG, input: &S };
    let mut reduction = weighted_balred(K, weights, order, method)?;
    let before = feedback(&series(K, G)?, &unit)?;
    let after = feedback(&series(&reduction.system, G)?, &unit)?;
    let critical_pole = critical(&after)?;
    let closed_loop_stable = is_stable_pole(critical_pole, G.timebase);
    let closed_loop_error = if closed_loop_stable {
        linfnorm(&parallel(&before, &after.negate())?, EXACT_NORM)?
    } else {
        reduction.warnings.push(Warning::LoopUnstable { re: critical_pole.re, im: critical_pole.im });
        Peak { value: f64::INFINITY, rate_rad_s: critical_pole.im.abs() }
    };
    Ok(ControllerReduction { reduction, closed_loop_stable, critical_pole, closed_loop_error })
}

fn needs_stable(what: &'static str, g: &StateSpace) -> Result<(), Error> {
    let pole = critical(g)?;
    if g.order() == 0 || is_stable_pole(pole, g.timebase) {
        Ok(())
    } else {
        Err(Error::Unstable { what, re: pole.re, im: pole.im })
    }
}

/// Returns the pole nearest to, or farthest beyond, the border of stability.
fn critical(g: &StateSpace) -> Result<C64, Error> {
    let size = |pole: &C64| if g.timebase == Timebase::Continuous { pole.re } else { pole.norm() };
    Ok(poles(g)?.into_iter().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or_default())
}
