//! Certificates of the L-infinity norm: values of the response computed with care, and levels that it does not reach.

use std::f64::consts::PI;

use crate::error::OperationContext;
use crate::level::Level;
use crate::peak::Peak;
use crate::response::point_of_rate;
use crate::tolerance::{
    CAREFUL_BEYOND, CAREFUL_PER_DECADE, CLEAR_OF_AXIS, GOLDEN_STEPS, KNOWN_SOLUTION, NARROW_PEAK, PEAK_STEP,
    PEAK_WIDTHS, PRECISE_SIZE, VERTEX_RISE,
};
use crate::{C64, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg::{self as linalg, StateRealisation};

/// Returns the peak with its value computed with residuals in twice the working precision. Where that differs by more than the tolerance
/// from what was known, the place is uncertain, too, and a small system's response is searched.
///
/// # Errors
/// [`Error::Matrix`] if a decomposition fails.
pub(crate) fn with_care(g: &StateSpace, peak: Peak, tolerance: f64) -> Result<Peak, Error> {
    if !peak.rate_rad_s.is_finite() || g.order() == 0 || peak.value == 0.0 {
        return Ok(peak);
    }
    let Some(value) = gain(g, peak.rate_rad_s)? else { return Ok(peak) };
    let careful = Peak { value, ..peak };
    let is_settled = (value / peak.value - 1.0).abs() <= tolerance;
    if is_settled || g.order() > PRECISE_SIZE || peak.rate_rad_s == 0.0 {
        Ok(careful)
    } else {
        climb(g, careful)
    }
}

/// Returns the largest singular value at a frequency, of the system as it is given; `None` at a pole.
fn gain(g: &StateSpace, rate_rad_s: f64) -> Result<Option<f64>, Error> {
    let system = StateRealisation { A: &g.A, B: &g.B, C: &g.C, D: &g.D };
    let Ok(H) = linalg::refined_transfer(system, point_of_rate(rate_rad_s, g.timebase)) else {
        return Ok(None);
    };
    Ok(Some(linalg::largest_singular_value(&H).with_operation("L-infinity norm")?))
}

/// Returns the highest hill where rounding has made the place uncertain: the best of the known frequency, zero, those of the poles and a logarithmic
/// grid, then a golden section between its neighbours, steps of several widths both ways, and a golden section there.
fn climb(g: &StateSpace, start: Peak) -> Result<Peak, Error> {
    let at = |rate_rad_s: f64| -> Result<Peak, Error> {
        Ok(Peak { value: gain(g, rate_rad_s)?.unwrap_or(0.0), rate_rad_s })
    };
    let rates = places(g, start.rate_rad_s)?;
    let mut top = start;
    for &rate in &rates {
        let found = at(rate)?;
        top = if found.value > top.value { found } else { top };
    }
    if top.rate_rad_s == 0.0 {
        return Ok(top);
    }
    let below = rates.iter().copied().filter(|&rate| rate < top.rate_rad_s).fold(0.0, f64::max);
    let above = rates.iter().copied().filter(|&rate| rate > top.rate_rad_s).fold(f64::INFINITY, f64::min);
    if below > 0.0 && above.is_finite() {
        top = golden_section(&at, [below, above], top)?;
    }
    let middle = top.rate_rad_s;
    let mut width = 0.0;
    for share in PEAK_WIDTHS {
        for factor in [1.0 - share, 1.0 + share] {
            let found = at(middle * factor)?;
            if found.value > top.value {
                (top, width) = (found, share);
            }
        }
    }
    // The top lies before the next step, which was not higher.
    let width = if width > 0.0 { PEAK_STEP * width } else { PEAK_WIDTHS[0] };
    let top = golden_section(&at, [top.rate_rad_s * (1.0 - width), top.rate_rad_s * (1.0 + width)], top)?;
    between_doubles(&at, top)
}

/// Returns the top of a resonance so narrow that it lies between two doubles: the vertex of the parabola of the inverse square of the gain through the
/// known point and two beside it, at which that has risen by [`VERTEX_RISE`] at least. The known point if there is none, or if it is no less.
fn between_doubles(at: &impl Fn(f64) -> Result<Peak, Error>, top: Peak) -> Result<Peak, Error> {
    let of = |peak: Peak| (top.value / peak.value).powi(2);
    let mut share = f64::EPSILON;
    while share <= NARROW_PEAK {
        let (left, right) = (at(top.rate_rad_s * (1.0 - share))?, at(top.rate_rad_s * (1.0 + share))?);
        if of(left).min(of(right)) < 1.0 + VERTEX_RISE {
            share *= 2.0;
            continue;
        }
        let (a, b) = (left.rate_rad_s - top.rate_rad_s, right.rate_rad_s - top.rate_rad_s);
        let (rise_left, rise_right) = ((of(left) - 1.0) / a, (of(right) - 1.0) / b);
        let curvature = (rise_right - rise_left) / (b - a);
        let slope = rise_left - curvature * a;
        let lowest = 1.0 - slope * slope / (4.0 * curvature);
        let value = top.value / lowest.sqrt();
        return Ok(if value > top.value { Peak { value, ..top } } else { top });
    }
    Ok(top)
}

/// Returns frequencies near which the top may lie, ascending: a known one, zero, those of the poles, and a logarithmic grid about these.
fn places(g: &StateSpace, known: f64) -> Result<Vec<f64>, Error> {
    let mut rates: Vec<f64> =
        crate::poles(g)?.into_iter().flat_map(|pole| rates_of(pole, g.timebase)).collect();
    rates.push(known);
    rates.retain(|&rate| rate > 0.0);
    let end = if let Timebase::Discrete { period_s } = g.timebase { PI / period_s } else { f64::INFINITY };
    let low = rates.iter().copied().fold(f64::INFINITY, f64::min) / CAREFUL_BEYOND;
    let high = (rates.iter().copied().fold(0.0, f64::max) * CAREFUL_BEYOND).min(end);
    let count = ((high / low).log10() * CAREFUL_PER_DECADE).ceil().max(1.0) as usize;
    rates.extend((0..=count).map(|k| low * (high / low).powf(k as f64 / count as f64)));
    rates.push(0.0);
    rates.retain(|rate| rate.is_finite() && *rate <= end);
    rates.sort_by(f64::total_cmp);
    Ok(rates)
}

/// Returns the best of a known point and those of a golden section between two positive frequencies.
fn golden_section(
    at: &impl Fn(f64) -> Result<Peak, Error>,
    [mut low, mut high]: [f64; 2],
    mut top: Peak,
) -> Result<Peak, Error> {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let inside = |low: f64, high: f64, share: f64| at(low + share * (high - low));
    let (mut left, mut right) = (inside(low, high, 1.0 - ratio)?, inside(low, high, ratio)?);
    for _ in 0..GOLDEN_STEPS {
        if left.value > right.value {
            (high, right) = (right.rate_rad_s, left);
            left = inside(low, high, 1.0 - ratio)?;
        } else {
            (low, left) = (left.rate_rad_s, right);
            right = inside(low, high, ratio)?;
        }
        let better = if left.value > right.value { left } else { right };
        top = if better.value > top.value { better } else { top };
    }
    Ok(top)
}

/// Returns the frequencies of a pole with and without its damping, rad/s.
fn rates_of(pole: C64, timebase: Timebase) -> [f64; 2] {
    match timebase {
        Timebase::Continuous => [pole.im.abs(), pole.norm()],
        Timebase::Discrete { period_s } => [pole.arg().abs() / period_s, pole.ln().norm() / period_s],
    }
}

/// Returns whether the Riccati equation of the bounded real lemma has a stabilising solution at a level, so that no singular value of the
/// response of a continuous system takes it:
///
/// ```text
///     A'X + XA - [XB  C'] [-gI  D'; D  -gI]^-1 [B'X; C] = 0
/// ```
///
/// Every entry of the equation is one of the system or the level: no product is rounded, so that the answer holds also for a difference
/// of two systems that nearly cancel (K. Zhou, J. Doyle and K. Glover, Robust and Optimal Control, 1996, corollary 13.24).
pub(crate) fn is_kept_by_riccati(g: &StateSpace, level: f64) -> bool {
    let (n, m, p) = (g.order(), g.inputs(), g.outputs());
    let minus = |k: usize| Mat::eye(k).scale(-level);
    let B = g.B.hstack(&Mat::zeros(n, p));
    let S = Mat::zeros(n, m).hstack(&g.C.t());
    let R = Mat::from_blocks(&[&[&minus(m), &g.D.t()], &[&g.D, &minus(p)]]);
    let outcome = linalg::care(&g.A, &B, &Mat::zeros(n, n), &R, Some(&S));
    let solution = outcome.ok().and_then(linalg::Outcome::solution);
    solution.is_some_and(|found| {
        let known = found.certificate.forward_error.norm_fro() <= KNOWN_SOLUTION * found.X.norm_fro();
        found.certificate.method == linalg::RiccatiMethod::Precise || known
    })
}

/// Returns whether a singular value of the response of a small continuous system takes a level nowhere: all 2 n
/// eigenvalues of
///
/// ```text
///     [ A   0   B    0 ]        [ I       ]
///     [ 0  -A'  0   -C']  -  s  [    I    ]
///     [ C   0   D  -gI ]        [       0 ]
///     [ 0   B' -gI   D']        [       0 ]
/// ```
///
/// are computed in 32 digits from the entries of the system as they are given, and none is on the axis. `false` for a larger system, or if the
/// eigenvalues cannot be computed.
pub(crate) fn is_nowhere(g: &StateSpace, level: f64, known: &Level) -> bool {
    let (n, m, p) = (g.order(), g.inputs(), g.outputs());
    let size = 2 * n + m + p;
    if size > PRECISE_SIZE {
        return false;
    }
    let (O, Z) = (Mat::zeros(n, n), |rows, cols| Mat::zeros(rows, cols));
    let minus = |k: usize| Mat::eye(k).scale(-level);
    let M = Mat::from_blocks(&[
        &[&g.A, &O, &g.B, &Z(n, p)],
        &[&O, &-g.A.t(), &Z(n, m), &-g.C.t()],
        &[&g.C, &Z(p, n), &g.D, &minus(p)],
        &[&Z(m, n), &g.B.t(), &minus(m), &g.D.t()],
    ]);
    let mass: Vec<f64> = (0..size).map(|k| if k < 2 * n { 1.0 } else { 0.0 }).collect();
    let is_off_axis = |root: &C64| root.re.abs() > CLEAR_OF_AXIS * root.norm();
    match linalg::pencil_roots(&M, &mass, known.eigenvalues()) {
        Ok(Some(roots)) => roots.iter().all(is_off_axis),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_riccati_equation_tells_levels_above_the_norm_of_a_difference_from_those_below() {
        // 1/(s+1) - 1/(s+1+e) has the norm e/(1+e), at the frequency zero; its parts are 2^20 and 2^30 times as large.
        for e in [f64::exp2(-20.0), f64::exp2(-30.0)] {
            let A = Mat::from_rows(&[&[-1.0, 0.0], &[0.0, -1.0 - e]]);
            let (B, C) = (Mat::col(&[1.0, 1.0]), Mat::from_rows(&[&[1.0, -1.0]]));
            let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
            let norm = e / (1.0 + e);
            for excess in [1e-6, 1e-3, 1.0] {
                // Of the second system not even 32 digits find the solution: no claim is made then.
                let is_kept = is_kept_by_riccati(&g, norm * (1.0 + excess));
                assert!(is_kept || e < 1e-8, "{e} {excess}");
                assert!(!is_kept_by_riccati(&g, norm / (1.0 + excess)), "{e} {excess}");
            }
        }
    }
}
