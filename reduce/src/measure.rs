//! The error of a reduction, measured on the systems themselves.

use crate::Error;
use crate::reduction::Warning;
use crate::tolerance::{EXACT_NORM, EXACT_ORDER, GRID_BEYOND, GRID_POINTS};
use counterpoise_linalg::C64;
use counterpoise_lti::{Peak, StateSpace, Timebase, linfnorm, parallel, poles, sigma};

/// Returns the H-infinity norm of `g - reduced` (poles that both share and that cancel do not count), and where it
/// is taken.
///
/// Up to [`EXACT_ORDER`] states by the Hamiltonian, above on a grid of all resonances and a logarithmic one between,
/// with a warning.
///
/// # Errors
/// [`Error::System`] if the systems do not fit.
pub fn error_norm(g: &StateSpace, reduced: &StateSpace) -> Result<(Peak, Option<Warning>), Error> {
    if g.order() + reduced.order() <= EXACT_ORDER {
        return Ok((linfnorm(&parallel(g, &reduced.negate())?, EXACT_NORM)?, None));
    }
    let mut roots = poles(g)?;
    roots.extend(poles(reduced)?);
    let rates = grid(&roots, g.timebase);
    let difference = difference(g, reduced, &rates)?;
    let mut peak = Peak { value: 0.0, rate_rad_s: 0.0 };
    for (&value, &rate_rad_s) in difference.iter().zip(&rates) {
        peak = if value > peak.value { Peak { value, rate_rad_s } } else { peak };
    }
    Ok((peak, Some(Warning::MeasuredOnGrid { points: rates.len() })))
}

/// Returns the largest singular value of the difference at each frequency.
fn difference(g: &StateSpace, reduced: &StateSpace, rates: &[f64]) -> Result<Vec<f64>, Error> {
    let error = parallel(g, &reduced.negate())?;
    Ok(sigma(&error, rates)?.iter().map(|values| values.first().copied().unwrap_or(0.0)).collect())
}

fn grid(poles: &[C64], timebase: Timebase) -> Vec<f64> {
    let in_s = |pole: &C64| match timebase {
        Timebase::Continuous => *pole,
        Timebase::Discrete { period_s } => pole.ln() / period_s,
    };
    let highest = match timebase {
        Timebase::Continuous => f64::INFINITY,
        Timebase::Discrete { period_s } => std::f64::consts::PI / period_s,
    };
    let roots: Vec<C64> = poles.iter().map(in_s).filter(|root| root.norm().is_normal()).collect();
    let low = roots.iter().map(|root| root.norm()).fold(f64::INFINITY, f64::min) / GRID_BEYOND;
    let high = (roots.iter().map(|root| root.norm()).fold(0.0, f64::max) * GRID_BEYOND).min(highest);
    let mut rates = vec![low];
    rates.extend((1..GRID_POINTS).map(|k| low * (high / low).powf(k as f64 / (GRID_POINTS - 1) as f64)));
    rates.extend(roots.iter().filter(|root| root.im > 0.0).flat_map(|root| [root.im, root.norm()]));
    rates.retain(|rate| rate.is_normal() && *rate <= highest);
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    rates
}
