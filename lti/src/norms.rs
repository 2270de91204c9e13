//! H2, L-infinity and H-infinity norms.

use crate::discretise::d2c_tustin;
use crate::error::During;
use crate::gramians::ctrb_factor;
use crate::response::Response;
use crate::roots::{is_stable, poles};
use crate::scaling::balance;
use crate::{Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Steps of the Hamiltonian iteration; it converges quadratically, four to six are usual.
const HAMILTONIAN_STEPS: usize = 40;

/// Eigenvalues this near to the imaginary axis, relative to their size, are looked at as frequencies. A false one
/// costs one evaluation.
const NEAR_AXIS: f64 = 1e-6;

/// As [`NEAR_AXIS`], relative to the norm of the Hamiltonian.
const NEAR_AXIS_NORM: f64 = 1e-12;

/// Poles this near to the border of stability, relative to the largest, are on it.
const ON_AXIS: f64 = 1e-14;

/// The largest value of a function of frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// The value.
    pub value: f64,
    /// Where, in rad/s; infinite where the direct path is the largest.
    pub rate_rad_s: f64,
}

/// The H2 norm, sqrt(trace(C P C' + D D' where sampled)): the rms output for white noise of unit intensity.
///
/// Infinite for an unstable system, and for a continuous one with a direct path: that is its value, not an error.
///
/// # Errors
/// [`Error::Matrix`] where the Lyapunov equation fails.
pub fn h2norm(g: &StateSpace) -> Result<f64, Error> {
    if g.timebase == Timebase::Continuous && g.D.norm_max() > 0.0 {
        return Ok(f64::INFINITY);
    }
    match ctrb_factor(&balance(g).0) {
        Err(Error::Pole { .. }) => Ok(f64::INFINITY),
        Err(other) => Err(other),
        Ok(L) => Ok((&balance(g).0.C * &L).norm_fro().hypot(g.D.norm_fro())),
    }
}

/// The H-infinity norm: the peak of the largest singular value for a stable system, infinite for another.
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

/// The L-infinity norm: the peak of the largest singular value on the frequency axis, stable or not.
///
/// Bruinsma and Steinbuch's iteration (Systems & Control Letters 14 (1990) 287): the frequencies at which a singular
/// value takes a trial value are the imaginary eigenvalues of a Hamiltonian matrix; the response between them raises
/// the trial. Every value returned was evaluated on the system itself. Sampled systems by the bilinear map.
///
/// # Errors
/// [`Error::Range`] for a tolerance outside (0, 1), [`Error::NotConverged`], [`Error::Matrix`].
pub fn linfnorm(g: &StateSpace, tolerance: f64) -> Result<Peak, Error> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(Error::Range { what: "tolerance", value: tolerance, allowed: "between 0 and 1" });
    }
    if let Some(rate_rad_s) = pole_on_the_border(g)? {
        return Ok(Peak { value: f64::INFINITY, rate_rad_s });
    }
    let Timebase::Discrete { period_s } = g.timebase else {
        return continuous(&balance(g).0, tolerance);
    };
    let peak = continuous(&balance(&d2c_tustin(g, None)?).0, tolerance)?;
    Ok(Peak { rate_rad_s: 2.0 / period_s * (0.5 * period_s * peak.rate_rad_s).atan(), ..peak })
}

fn pole_on_the_border(g: &StateSpace) -> Result<Option<f64>, Error> {
    let poles = poles(g)?;
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    Ok(match g.timebase {
        Timebase::Continuous => poles.iter().find(|p| p.re.abs() <= ON_AXIS * largest).map(|p| p.im.abs()),
        Timebase::Discrete { period_s } => {
            poles.iter().find(|p| (p.norm() - 1.0).abs() <= ON_AXIS).map(|p| p.arg().abs() / period_s)
        }
    })
}

fn continuous(g: &StateSpace, tolerance: f64) -> Result<Peak, Error> {
    let response = Response::of(g)?;
    let direct = largest_singular_value(&g.D)?;
    let mut best = Peak { value: direct, rate_rad_s: f64::INFINITY };
    let mut rates: Vec<f64> = poles(g)?.iter().flat_map(|p| [p.im.abs(), p.norm()]).collect();
    rates.push(0.0);
    raise(&mut best, &response, &rates)?;
    let mut change = f64::INFINITY;
    for _ in 0..HAMILTONIAN_STEPS {
        if best.value == 0.0 || g.order() == 0 {
            return Ok(best);
        }
        let candidates = level_frequencies(g, best.value * (1.0 + tolerance))?;
        let between = candidates.windows(2).map(|w| 0.5 * (w[0] + w[1]));
        let rates: Vec<f64> = candidates.iter().copied().chain(between).collect();
        let before = best.value;
        raise(&mut best, &response, &rates)?;
        change = best.value / before - 1.0;
        if change <= tolerance {
            return Ok(best);
        }
    }
    Err(Error::NotConverged { what: "L-infinity norm", iterations: HAMILTONIAN_STEPS, change })
}

/// Raises the peak to the largest value at the given frequencies.
fn raise(best: &mut Peak, response: &Response, rates: &[f64]) -> Result<(), Error> {
    for (H, &rate_rad_s) in response.at_all(rates)?.iter().zip(rates) {
        let value = linalg::csingular_values(H).during("L-infinity norm")?.first().copied().unwrap_or(0.0);
        if value > best.value {
            *best = Peak { value, rate_rad_s };
        }
    }
    Ok(())
}

/// Frequencies at which a singular value may equal `level`, ascending, from the Hamiltonian's eigenvalues.
fn level_frequencies(g: &StateSpace, level: f64) -> Result<Vec<f64>, Error> {
    let H = hamiltonian(g, level)?;
    let near = NEAR_AXIS_NORM * H.norm_fro();
    let eigenvalues = linalg::eigenvalues(&H).during("L-infinity norm")?;
    let on_axis = |s: &&crate::C64| s.im >= 0.0 && s.re.abs() <= NEAR_AXIS * s.norm() + near;
    let mut rates: Vec<f64> = eigenvalues.iter().filter(on_axis).map(|s| s.im).collect();
    rates.sort_by(f64::total_cmp);
    Ok(rates)
}

/// [F, B inv(R) B'; -C' inv(S) C, -F'] with R = 1 - D'D, S = 1 - DD', F = A + B inv(R) D' C, for the system divided by
/// the level.
fn hamiltonian(g: &StateSpace, level: f64) -> Result<Mat, Error> {
    let root = level.sqrt();
    let (B, C, D) = (g.B.scale(1.0 / root), g.C.scale(1.0 / root), g.D.scale(1.0 / level));
    let R = &Mat::eye(D.ncols()) - &(&D.t() * &D);
    let S = &Mat::eye(D.nrows()) - &(&D * &D.t());
    let RB = linalg::solve(&R, &B.t()).during("L-infinity norm")?;
    let SC = linalg::solve(&S, &C).during("L-infinity norm")?;
    let F = &g.A + &(&RB.t() * &(&D.t() * &C));
    Ok(Mat::from_blocks(&[&[&F, &(&B * &RB)], &[&-(&C.t() * &SC), &-F.t()]]))
}

fn largest_singular_value(D: &Mat) -> Result<f64, Error> {
    if D.norm_max() == 0.0 {
        return Ok(0.0);
    }
    Ok(linalg::singular_values(D).during("L-infinity norm")?.first().copied().unwrap_or(0.0))
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
    fn infinite_norms_are_values() {
        let integrator =
            StateSpace::new(Mat::zeros(1, 1), Mat::eye(1), Mat::eye(1), Mat::eye(1), Timebase::Continuous)
                .unwrap();
        assert_eq!(h2norm(&integrator).unwrap(), f64::INFINITY);
        let peak = hinfnorm(&integrator, 1e-8).unwrap();
        assert_eq!((peak.value, peak.rate_rad_s), (f64::INFINITY, 0.0));
    }
}
