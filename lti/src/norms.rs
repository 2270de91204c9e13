//! H2, L-infinity and H-infinity norms.

use crate::bounds::{is_kept_by_riccati, is_nowhere, with_care};
use crate::discretise::d2c_tustin;
use crate::error::OperationContext;
use crate::gramians::{is_faded, is_lightly_damped, is_magnified};
use crate::hidden_modes::{has_lone_boundary_pole, without_hidden_modes};
use crate::level::{Level, climb_between, search_everywhere, with_middles};
use crate::peak::{Peak, largest_gains};
use crate::response::Response;
use crate::roots::{boundary, examine_poles, is_stable, poles};
use crate::scaling::balance;
use crate::tolerance::{FIRST_SAME_RATE, HAMILTONIAN_STEPS, LARGEST_EXCESS, NORM_POLE_ON_AXIS, PRECISE_SIZE};
use crate::{C64, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Returns the H2 norm, sqrt(trace(C P C' + D D' where sampled)): the rms output for white noise of unit
/// intensity.
///
/// Infinite for an unstable system, and for a continuous one with a direct path: that is its value, not an error. A mode on the boundary of
/// stability makes the norm infinite if the response contains it; one that no input reaches or no output sees, the entries of the system taken as
/// exact, does not count.
///
/// # Errors
/// [`Error::Matrix`] if the Lyapunov equation fails.
pub fn h2norm(g: &StateSpace) -> Result<f64, Error> {
    if g.timebase == Timebase::Continuous && g.D.norm_max() > 0.0 {
        return Ok(f64::INFINITY);
    }
    let scaled = balance(g).0;
    match square_norm(&scaled)? {
        Some(norm) => Ok(norm),
        None => match without_hidden_modes(&scaled)? {
            Some(visible) => Ok(square_norm(&visible)?.unwrap_or(f64::INFINITY)),
            None => Ok(f64::INFINITY),
        },
    }
}

/// Returns the H2 norm of a stable balanced system; `None` for another.
fn square_norm(g: &StateSpace) -> Result<Option<f64>, Error> {
    if has_lone_boundary_pole(g) {
        return Ok(None);
    }
    let factor = match g.timebase {
        Timebase::Continuous => linalg::lyap_square_factor(&g.A, &g.B),
        Timebase::Discrete { .. } => linalg::dlyap_square_factor(&g.A, &g.B),
    };
    match factor {
        Err(linalg::Error::NotStable { eigenvalue, .. }) => lightly_damped_norm(g, eigenvalue),
        other => {
            let factor = other.with_operation("Gramian")?;
            if (is_magnified(g, &factor, &g.B) || is_faded(g, &g.C, &factor))
                && let Some(norm) = refined_norm(g)?
            {
                return Ok(Some(norm));
            }
            let norm = (&g.C * &factor).norm_fro().hypot(g.D.norm_fro());
            let known =
                if norm.is_nan() { Err(linalg::Error::OutOfRange { what: "the H2 norm" }) } else { Ok(norm) };
            known.map(Some).with_operation("H2 norm")
        }
    }
}

/// Returns the H2 norm with a refined Gramian; `None` if it does not settle.
fn refined_norm(g: &StateSpace) -> Result<Option<f64>, Error> {
    let found =
        linalg::refined_square_norm(&g.A, &g.B, &g.C, boundary(g.timebase)).with_operation("H2 norm")?;
    let square = found.filter(|square| *square >= 0.0 && square.is_finite());
    Ok(square.map(|square| square.sqrt().hypot(g.D.norm_fro())))
}

/// Returns the H2 norm of a small system of which an eigenvalue in doubles is not stable, if that is the rounding of the eigenvalue; `None` otherwise.
fn lightly_damped_norm(g: &StateSpace, eigenvalue: C64) -> Result<Option<f64>, Error> {
    if is_lightly_damped(g, eigenvalue)? { refined_norm(g) } else { Ok(None) }
}

/// Returns the H-infinity norm: the peak of the largest singular value for a stable system, infinite for
/// another.
///
/// `tolerance` is relative, 1e-10 say. Method and errors as [`linfnorm`].
///
/// # Errors
/// As [`linfnorm`].
pub fn hinfnorm(g: &StateSpace, tolerance: f64) -> Result<Peak, Error> {
    if is_stable(g)? {
        return linfnorm(g, tolerance);
    }
    let poles = poles(g)?;
    let worst = match g.timebase {
        Timebase::Continuous => poles.iter().max_by(|a, b| a.re.total_cmp(&b.re)).map(|p| p.im.abs()),
        Timebase::Discrete { period_s } => {
            poles.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).map(|p| p.arg().abs() / period_s)
        }
    };
    Ok(Peak { value: f64::INFINITY, rate_rad_s: worst.unwrap_or(0.0) })
}

/// Returns the L-infinity norm: the peak of the largest singular value on the frequency axis, stable or not.
///
/// Bruinsma and Steinbuch's iteration (Systems & Control Letters 14 (1990) 287): the frequencies at which a singular
/// value takes a trial value are the imaginary eigenvalues of a Hamiltonian matrix; the response between them raises
/// the trial. Before the iteration ends, the response is searched at the frequency of every eigenvalue and uphill from
/// there, because rounding may have moved eigenvalues off the axis. The value returned was evaluated on the system itself with residuals in
/// twice the working precision, so that it is a lower bound also for a difference of two systems that nearly cancel; [`linfnorm_bounds`] gives an upper one, too. Sampled systems by the bilinear map.
///
/// # Errors
/// [`Error::Range`] for a tolerance outside (0, 1), [`Error::NotConverged`], [`Error::Matrix`].
pub fn linfnorm(g: &StateSpace, tolerance: f64) -> Result<Peak, Error> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(Error::Range { what: "tolerance", value: tolerance, allowed: "between 0 and 1" });
    }
    let poles = poles(g)?;
    if let Some(rate_rad_s) = pole_on_the_border(g, &poles)? {
        return Ok(Peak { value: f64::INFINITY, rate_rad_s });
    }
    let scaled = balance(g).0;
    let Timebase::Discrete { period_s } = g.timebase else {
        return with_care(&scaled, continuous_peak(&scaled, &poles, tolerance)?, tolerance);
    };
    let mapped: Vec<C64> = poles.iter().map(|z| 2.0 / period_s * (z - 1.0) / (z + 1.0)).collect();
    let peak = continuous_peak(&balance(&d2c_tustin(g, None)?).0, &mapped, tolerance)?;
    let rate_rad_s = 2.0 / period_s * (0.5 * period_s * peak.rate_rad_s).atan();
    with_care(&scaled, Peak { rate_rad_s, ..peak }, tolerance)
}

/// The L-infinity norm between two bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormBounds {
    /// The largest value found, and where: the norm is at least this.
    pub lower: Peak,
    /// A value that the response does not reach: the norm is at most this.
    pub upper: f64,
}

/// Returns the L-infinity norm with a bound from above: the smallest level among `lower (1 + tolerance 10^k)` at which the Hamiltonian matrix has no
/// eigenvalue on the imaginary axis, rounding of its entries included to first order; or at which the Riccati equation of the bounded real lemma has
/// a stabilising solution; of a small system also if the eigenvalues are off the axis in 32 digits. The upper bound is infinite if there is no such
/// level up to ten times the lower bound.
///
/// # Errors
/// As [`linfnorm`].
pub fn linfnorm_bounds(g: &StateSpace, tolerance: f64) -> Result<NormBounds, Error> {
    let lower = linfnorm(g, tolerance)?;
    if lower.value.is_infinite() || g.order() == 0 {
        return Ok(NormBounds { lower, upper: lower.value });
    }
    let continuous = match g.timebase {
        Timebase::Continuous => g.clone(),
        Timebase::Discrete { .. } => d2c_tustin(g, None)?,
    };
    let scaled = balance(&continuous).0;
    let mut excess = tolerance;
    while excess <= LARGEST_EXCESS {
        let upper = (1.0 + excess) * lower.value.max(f64::MIN_POSITIVE);
        let is_above = |level: &Level| {
            level.is_clear() || is_kept_by_riccati(&scaled, upper) || is_nowhere(&scaled, upper, level)
        };
        if Level::of(&scaled, upper).is_ok_and(|level| is_above(&level)) {
            return Ok(NormBounds { lower, upper });
        }
        excess *= 10.0;
    }
    Ok(NormBounds { lower, upper: f64::INFINITY })
}

/// Returns the frequency of a pole on the boundary of stability, if there is one.
fn pole_on_the_border(g: &StateSpace, poles: &[C64]) -> Result<Option<f64>, Error> {
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let on_border = |p: &&C64| match g.timebase {
        Timebase::Continuous => p.re.abs() <= NORM_POLE_ON_AXIS * largest,
        Timebase::Discrete { .. } => (p.norm() - 1.0).abs() <= NORM_POLE_ON_AXIS,
    };
    // The eigenvalues of a small matrix beside the boundary are corrected in 32 digits before they are examined.
    let quick = if g.order() > PRECISE_SIZE { poles.iter().find(on_border) } else { None };
    let pole = match quick {
        Some(pole) => Some(*pole),
        None => examine_poles(g, poles)?.pop(),
    };
    Ok(pole.map(|p| match g.timebase {
        Timebase::Continuous => p.im.abs(),
        Timebase::Discrete { period_s } => p.arg().abs() / period_s,
    }))
}

/// Returns the peak of a balanced continuous system with the given poles.
fn continuous_peak(g: &StateSpace, poles: &[C64], tolerance: f64) -> Result<Peak, Error> {
    let response = Response::of(g)?;
    let direct = largest_singular_value(&g.D)?;
    let mut best = Peak { value: direct, rate_rad_s: f64::INFINITY };
    let mut rates: Vec<f64> = poles.iter().flat_map(|p| [p.im.abs(), p.norm()]).collect();
    rates.push(0.0);
    rates.retain(|rate| rate.is_finite());
    rates.sort_by(f64::total_cmp);
    rates.dedup_by(|b, a| *b - *a <= FIRST_SAME_RATE * *b);
    raise(&mut best, &response, &rates)?;
    // Each level costs the eigenvalues of a matrix of twice the order, so that the first one starts from the top of a hill.
    climb_between(&mut best, &response, &rates)?;
    let mut change = f64::INFINITY;
    for _ in 0..HAMILTONIAN_STEPS {
        if best.value == 0.0 || g.order() == 0 {
            return Ok(best);
        }
        let level = Level::of(g, best.value * (1.0 + tolerance))?;
        let before = best.value;
        raise(&mut best, &response, &with_middles(&level.frequencies()))?;
        change = best.value / before - 1.0;
        if change <= tolerance && !search_everywhere(&mut best, &response, &level, tolerance)? {
            return Ok(best);
        }
    }
    Err(Error::NotConverged { what: "L-infinity norm", iterations: HAMILTONIAN_STEPS, change })
}

/// Raises the peak to the largest value at the given frequencies.
fn raise(best: &mut Peak, response: &Response, rates: &[f64]) -> Result<(), Error> {
    for (value, &rate_rad_s) in largest_gains(response, rates)?.into_iter().zip(rates) {
        if value > best.value {
            *best = Peak { value, rate_rad_s };
        }
    }
    Ok(())
}

fn largest_singular_value(D: &Mat) -> Result<f64, Error> {
    if D.norm_max() == 0.0 {
        return Ok(0.0);
    }
    Ok(linalg::singular_values(D).with_operation("L-infinity norm")?.first().copied().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{C64, Discretisation, Zpk, c2d, hankelnorm};

    fn resonance(zeta: f64, rate: f64) -> StateSpace {
        let pole = C64::new(-zeta, (1.0 - zeta * zeta).sqrt()) * rate;
        let zpk = Zpk {
            zeros: vec![],
            poles: vec![pole, pole.conj()],
            gain: rate * rate,
            timebase: Timebase::Continuous,
        };
        zpk.to_state_space().unwrap()
    }

    #[test]
    fn a_resonance_has_the_peak_and_the_rms_of_the_closed_forms() {
        for zeta in [0.5, 0.01, 1e-5] {
            let g = resonance(zeta, 30.0);
            let peak = hinfnorm(&g, 1e-12).unwrap();
            let expected = 1.0 / (2.0 * zeta * (1.0 - zeta * zeta).sqrt());
            assert!((peak.value / expected - 1.0).abs() < 1e-9, "{peak:?} {expected}");
            assert!((peak.rate_rad_s / (30.0 * (1.0 - 2.0 * zeta * zeta).sqrt()) - 1.0).abs() < 1e-5);
            let rms = (30.0 / (4.0 * zeta)).sqrt();
            assert!((h2norm(&g).unwrap() / rms - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn the_bilinear_map_keeps_the_peak_and_the_hankel_norm() {
        let g = resonance(0.02, 30.0);
        let sampled = c2d(&g, 0.01, Discretisation::Tustin { prewarp_rad_s: None }).unwrap();
        let (a, b) = (hinfnorm(&g, 1e-10).unwrap(), hinfnorm(&sampled, 1e-10).unwrap());
        assert!((a.value / b.value - 1.0).abs() < 1e-9);
        let at = crate::response_at(&sampled, b.rate_rad_s).unwrap()[(0, 0)].norm();
        assert!((at / b.value - 1.0).abs() < 1e-9);
        assert!((hankelnorm(&g).unwrap() / hankelnorm(&sampled).unwrap() - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_peak_beside_a_point_of_the_grid_is_climbed() {
        // Two lags that nearly cancel: the first climb starts from the frequency of a pole, meets the double next to it with the same gain and
        // must not take it for the far side of the hill.
        let A = Mat::diag(&[-0.8329486557027962, -0.8330319505683664]);
        let g = |b: f64| {
            let (B, C) = (Mat::col(&[b, b]), Mat::row(&[-1.0, 1.0001]));
            StateSpace::new(A.clone(), B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap()
        };
        let peak = linfnorm(&g(0.0566), 1e-10).unwrap();
        let near = |share: f64| {
            let at = crate::response_at(&g(0.0566), peak.rate_rad_s * (1.0 + share)).unwrap()[(0, 0)].norm();
            1.0 - at / peak.value
        };
        for share in [-1e-4, -3e-5, 3e-5, 1e-4] {
            assert!(near(share) > 0.0, "{peak:?} {share} {}", near(share));
        }
    }

    #[test]
    fn a_mode_on_the_boundary_that_no_input_reaches_leaves_the_norm_finite() {
        // An integrator and a lag at -2 in rotated whole numbers: the input acts on the lag alone, so that the response is -1.5 / (s + 2).
        let A = Mat::from_rows(&[&[2.0, 2.0], &[-4.0, -4.0]]);
        let C = Mat::row(&[0.0, 1.5]);
        let norm = |B: &[f64], C: &Mat| {
            let g =
                StateSpace::new(A.clone(), Mat::col(B), C.clone(), Mat::zeros(1, 1), Timebase::Continuous);
            h2norm(&g.unwrap()).unwrap()
        };
        assert!((norm(&[0.5, -1.0], &C) - 0.75).abs() < 1e-15);
        // One that no output sees, and one that is reached by a rounding of the input.
        assert!(norm(&[1.0, 0.0], &Mat::row(&[1.0, 1.0])).is_finite());
        assert_eq!(norm(&[0.5 + f64::EPSILON, -1.0], &C), f64::INFINITY);
        // A sum of the input in sampled time that the output does not see, or hardly sees.
        let A = Mat::from_rows(&[&[1.0, 0.0], &[0.0, 0.5]]);
        let sampled = |c: f64| {
            let g = StateSpace::new(
                A.clone(),
                Mat::col(&[1.0, 1.0]),
                Mat::row(&[c, 1.0]),
                Mat::zeros(1, 1),
                Timebase::Discrete { period_s: 0.1 },
            );
            h2norm(&g.unwrap()).unwrap()
        };
        assert!((sampled(0.0) - (4.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(sampled(1e-12), f64::INFINITY);
    }

    #[test]
    fn an_integrator_that_can_be_read_off_is_not_a_slow_lag() {
        let A = Mat::from_rows(&[&[0.0, 0.0, 0.0], &[-2.0, -1.0, -2.0], &[-3.0, 0.0, -3.0]]);
        let (B, C) = (Mat::col(&[-1.0, 0.0, 1.5]), Mat::row(&[0.0, 1.0, -1.5]));
        let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
        assert_eq!(h2norm(&g).unwrap(), f64::INFINITY);
    }

    #[test]
    fn infinite_norms_are_values() {
        let integrator =
            StateSpace::new(Mat::zeros(1, 1), Mat::eye(1), Mat::eye(1), Mat::eye(1), Timebase::Continuous)
                .unwrap();
        assert_eq!(h2norm(&integrator).unwrap(), f64::INFINITY);
        let peak = hinfnorm(&integrator, 1e-8).unwrap();
        assert_eq!((peak.value, peak.rate_rad_s), (f64::INFINITY, 0.0));
    }
}
