//! Modal truncation of a system: slow poles stay.

use crate::measure::error_norm;
use crate::split::split_by;
use crate::{Error, Reduction};
use counterpoise_lti::{StateSpace, Timebase, dcgain, hankel_values, is_stable};

/// Treatment of the fast modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Residual {
    /// Nothing is left of them.
    Drop,
    /// Their gain at zero frequency is added to the direct path.
    MatchDc,
}

/// Keeps the poles slower than a rate in rad/s (|s|, or |ln z|/T where sampled); the fast ones must be stable.
///
/// The Hankel values returned are those of the part dropped, and twice their sum is the bound on the error of
/// [`Residual::Drop`].
///
/// # Errors
/// [`Error::Unstable`] if a fast pole is not stable, [`Error::Matrix`] if slow and fast poles are too close to part.
pub fn modal_truncation(g: &StateSpace, rate_rad_s: f64, residual: Residual) -> Result<Reduction, Error> {
    if rate_rad_s.is_nan() || rate_rad_s <= 0.0 {
        return Err(Error::Range { what: "rate_rad_s", value: rate_rad_s, allowed: "positive" });
    }
    let rate = |pole: counterpoise_linalg::C64| match g.timebase {
        Timebase::Continuous => pole.norm(),
        Timebase::Discrete { period_s } => pole.ln().norm() / period_s,
    };
    let parts = split_by(g, |pole| rate(pole) < rate_rad_s)?;
    let fast = &parts.second;
    if !is_stable(fast)? {
        let poles = counterpoise_lti::poles(fast)?;
        let worst = poles.last().copied().unwrap_or_default();
        return Err(Error::Unstable { what: "the fast part", re: worst.re, im: worst.im });
    }
    let mut system = parts.first.clone();
    let mut instead = StateSpace::gain(fast.D.clone(), g.timebase)?;
    if residual == Residual::MatchDc {
        let gain = dcgain(fast)?;
        system.D = &system.D + &gain;
        instead.D = gain;
    }
    let hankel = hankel_values(fast)?;
    let (measured_error, grid) = error_norm(fast, &instead)?;
    let bound = (residual == Residual::Drop).then(|| 2.0 * hankel.iter().rev().sum::<f64>());
    let untouched = system.order();
    Ok(Reduction {
        system,
        hankel,
        bound,
        measured_error,
        kept: 0,
        untouched,
        warnings: grid.into_iter().collect(),
    })
}
