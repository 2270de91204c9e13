//! From parameters to a checked law.

use super::bristle::Bristle;
use super::dahl::Dahl;
use super::law::Law;
use super::lugre::Lugre;
use super::ranges;
use super::reset::ResetIntegrator;
use super::sliding::Sliding;
use super::stribeck::StribeckLevel;
use super::walrath::Walrath;
use crate::parameters::{Friction, FrictionLaw, StribeckCurve};
use crate::tolerance::POLYNOMIAL_CHECKS;
use crate::{Error, Range};

/// Returns the dry law with its own parameters checked; `path` names the friction in errors.
pub(super) fn checked_law(path: &str, friction: &Friction) -> Result<Law, Error> {
    if friction.coulomb_nm() == 0.0 {
        return Ok(Law::None);
    }
    let gaussian = stribeck_level(friction, StribeckCurve::Gaussian);
    let number = |range: Range, name: &str, value: f64| range.check(path, name, value);
    Ok(match friction.law {
        FrictionLaw::None => Law::None,
        FrictionLaw::Dahl { rest_stiffness_nm_rad: stiffness, exponent, .. } => Law::Dahl(Dahl {
            level: gaussian,
            rest_stiffness_nm_rad: number(ranges::REST_STIFFNESS, "rest_stiffness_nm_rad", stiffness)?,
            exponent: number(ranges::EXPONENT, "exponent", exponent)?,
        }),
        FrictionLaw::Lugre {
            bristle_stiffness_nm_rad: stiffness, bristle_damping_nm_s_rad: damping, ..
        } => Law::Lugre(Lugre {
            level: gaussian,
            stiffness_nm_rad: number(ranges::BRISTLE_STIFFNESS, "bristle_stiffness_nm_rad", stiffness)?,
            damping_nm_s_rad: number(ranges::BRISTLE_DAMPING, "bristle_damping_nm_s_rad", damping)?,
        }),
        FrictionLaw::Coulomb { .. } => Law::Sliding(sticking_law(path, friction, 0.0)?),
        FrictionLaw::Karnopp { stick_rate_rad_s: rate, .. } => {
            let rate = number(ranges::STICK_RATE, "stick_rate_rad_s", rate)?;
            Law::Sliding(sticking_law(path, friction, rate)?)
        }
        FrictionLaw::Stribeck { curve, .. } => Law::Sliding(falling_law(path, friction, curve)?),
        FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, damping_nm_s_rad } => {
            Law::ResetIntegrator(ResetIntegrator {
                coulomb_nm,
                static_ratio: breakaway_ratio(path, friction)?,
                deflection_rad: number(ranges::DEFLECTION, "deflection_rad", deflection_rad)?,
                damping_nm_s_rad: number(ranges::DAMPING, "damping_nm_s_rad", damping_nm_s_rad)?,
            })
        }
        FrictionLaw::Walrath { coulomb_nm, time_constant_s, smoothing_rate_rad_s: rate } => {
            Law::Walrath(Walrath {
                coulomb_nm,
                time_constant_s: number(ranges::TIME_CONSTANT, "time_constant_s", time_constant_s)?,
                smoothing_rate_rad_s: number(ranges::SMOOTHING_RATE, "smoothing_rate_rad_s", rate)?,
            })
        }
        FrictionLaw::Bristle { bristles, bond_rad, .. } => {
            number(ranges::BRISTLES, "bristles", bristles as f64)?;
            let bond_rad = number(ranges::BOND, "bond_rad", bond_rad)?;
            Law::Bristle(Bristle { level: gaussian, bristles, bond_rad })
        }
    })
}

fn stribeck_level(friction: &Friction, curve: StribeckCurve) -> StribeckLevel {
    StribeckLevel::new(friction.coulomb_nm(), friction.static_ratio, friction.stribeck_rate_rad_s, curve)
}

/// Returns the Coulomb sliding with a breakaway level of its own.
fn sticking_law(path: &str, friction: &Friction, rest_rate_rad_s: f64) -> Result<Sliding, Error> {
    let breakaway_ratio = breakaway_ratio(path, friction)?;
    let level = stribeck_level(&Friction { static_ratio: 1.0, ..friction.clone() }, StribeckCurve::Gaussian);
    Ok(Sliding { level, breakaway_ratio, rest_rate_rad_s })
}

fn breakaway_ratio(path: &str, friction: &Friction) -> Result<f64, Error> {
    ranges::STATIC_RATIO_OF_BREAKAWAY.check(path, "static_ratio", friction.static_ratio)
}

/// Returns the sliding by a level that falls with the rate.
fn falling_law(path: &str, friction: &Friction, curve: StribeckCurve) -> Result<Sliding, Error> {
    check_curve(path, friction, curve)?;
    Ok(Sliding { level: stribeck_level(friction, curve), breakaway_ratio: 1.0, rest_rate_rad_s: 0.0 })
}

fn check_curve(path: &str, friction: &Friction, curve: StribeckCurve) -> Result<(), Error> {
    match curve {
        StribeckCurve::Exponential { exponent } => {
            ranges::CURVE_EXPONENT.check(path, "curve_exponent", exponent).map(|_| ())
        }
        StribeckCurve::Polynomial { coefficients } => {
            let finite = |&c: &f64| Range::Any.check(path, "coefficients", c).map(|_| ());
            coefficients.iter().try_for_each(finite)?;
            let level = stribeck_level(friction, curve);
            let rate = |k: i32| friction.stribeck_rate_rad_s * f64::from(k) / f64::from(POLYNOMIAL_CHECKS);
            let least = (0..=POLYNOMIAL_CHECKS).map(|k| level.at(rate(k))).fold(f64::INFINITY, f64::min);
            Range::POSITIVE.check(path, "coefficients: least level in N m", least).map(|_| ())
        }
        _ => Ok(()),
    }
}
