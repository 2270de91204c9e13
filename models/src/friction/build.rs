//! From parameters to a checked law.

use super::bristle::Bristle;
use super::dahl::Dahl;
use super::law::Law;
use super::lugre::Lugre;
use super::reset::ResetIntegrator;
use super::sliding::Sliding;
use super::stribeck::StribeckLevel;
use super::walrath::Walrath;
use crate::Error;
use crate::parameters::{Friction, FrictionLaw, StribeckCurve};

/// The dry law with its own parameters checked.
pub(super) fn law(friction: &Friction) -> Result<Law, Error> {
    let coulomb = friction.coulomb_nm();
    if coulomb == 0.0 {
        return Ok(Law::None);
    }
    let gaussian = stribeck(friction, StribeckCurve::Gaussian);
    Ok(match friction.law {
        FrictionLaw::None => Law::None,
        FrictionLaw::Dahl { rest_stiffness_nm_rad, exponent, .. } => Law::Dahl(Dahl {
            level: gaussian,
            rest_stiffness_nm_rad: positive("dahl.rest_stiffness", rest_stiffness_nm_rad)?,
            exponent: positive("dahl.exponent", exponent)?,
        }),
        FrictionLaw::Lugre { bristle_stiffness_nm_rad, bristle_damping_nm_s_rad, .. } => Law::Lugre(Lugre {
            level: gaussian,
            stiffness_nm_rad: positive("lugre.bristle_stiffness", bristle_stiffness_nm_rad)?,
            damping_nm_s_rad: not_negative("lugre.bristle_damping", bristle_damping_nm_s_rad)?,
        }),
        FrictionLaw::Coulomb { .. } => Law::Sliding(sticking(friction, 0.0)?),
        FrictionLaw::Karnopp { stick_rate_rad_s, .. } => {
            Law::Sliding(sticking(friction, positive("karnopp.stick_rate", stick_rate_rad_s)?)?)
        }
        FrictionLaw::Stribeck { curve, .. } => Law::Sliding(falling(friction, curve)?),
        FrictionLaw::ResetIntegrator { deflection_rad, damping_nm_s_rad, .. } => {
            Law::ResetIntegrator(reset(friction, deflection_rad, damping_nm_s_rad)?)
        }
        FrictionLaw::Walrath { time_constant_s, smoothing_rate_rad_s, .. } => Law::Walrath(Walrath {
            coulomb_nm: coulomb,
            time_constant_s: positive("walrath.time_constant", time_constant_s)?,
            smoothing_rate_rad_s: positive("walrath.smoothing_rate", smoothing_rate_rad_s)?,
        }),
        FrictionLaw::Bristle { bristles, bond_rad, .. } => {
            positive("bristle.bristles", bristles as f64)?;
            Law::Bristle(Bristle { level: gaussian, bristles, bond_rad: positive("bristle.bond", bond_rad)? })
        }
    })
}

fn stribeck(friction: &Friction, curve: StribeckCurve) -> StribeckLevel {
    StribeckLevel::new(friction.coulomb_nm(), friction.static_ratio, friction.stribeck_rate_rad_s, curve)
}

/// Coulomb sliding with its own breakaway level.
fn sticking(friction: &Friction, rest_rate_rad_s: f64) -> Result<Sliding, Error> {
    not_below_one("friction.static_ratio", friction.static_ratio)?;
    let level = stribeck(&Friction { static_ratio: 1.0, ..friction.clone() }, StribeckCurve::Gaussian);
    Ok(Sliding { level, breakaway_ratio: friction.static_ratio, rest_rate_rad_s })
}

fn reset(friction: &Friction, deflection_rad: f64, damping_nm_s_rad: f64) -> Result<ResetIntegrator, Error> {
    Ok(ResetIntegrator {
        coulomb_nm: friction.coulomb_nm(),
        static_ratio: not_below_one("friction.static_ratio", friction.static_ratio)?,
        deflection_rad: positive("reset.deflection", deflection_rad)?,
        damping_nm_s_rad: not_negative("reset.damping", damping_nm_s_rad)?,
    })
}

/// Sliding by a falling curve.
fn falling(friction: &Friction, curve: StribeckCurve) -> Result<Sliding, Error> {
    check_curve(friction, curve)?;
    Ok(Sliding { level: stribeck(friction, curve), breakaway_ratio: 1.0, rest_rate_rad_s: 0.0 })
}

/// The parameters that every law shares.
pub(super) fn check(friction: &Friction) -> Result<(), Error> {
    not_negative("friction.coulomb", friction.coulomb_nm())?;
    not_negative("friction.viscous", friction.viscous_nm_s_rad)?;
    not_negative("friction.quadratic", friction.quadratic_nm_s2_rad2)?;
    positive("friction.static_ratio", friction.static_ratio)?;
    positive("friction.stribeck_rate", friction.stribeck_rate_rad_s)?;
    below_one("friction.asymmetry", friction.asymmetry)?;
    below_one("friction.viscous_asymmetry", friction.viscous_asymmetry)?;
    below_one("friction.position_ripple.amplitude", friction.position_ripple.amplitude)?;
    if finite("friction.warm_up", friction.warm_up)? >= 1.0 {
        return Err(refused("friction.warm_up", friction.warm_up, "must be below 1"));
    }
    positive("friction.warm_up_time", friction.warm_up_time_s)?;
    not_negative("friction.load_coefficient", friction.load_coefficient)?;
    if friction.load_coefficient > 0.0 && friction.coulomb_nm() == 0.0 {
        return Err(refused("friction.load_coefficient", friction.load_coefficient, "needs a Coulomb level"));
    }
    Ok(())
}

fn check_curve(friction: &Friction, curve: StribeckCurve) -> Result<(), Error> {
    match curve {
        StribeckCurve::Exponential { exponent } => positive("stribeck.exponent", exponent).map(|_| ()),
        StribeckCurve::Polynomial { coefficients } => {
            coefficients.iter().try_for_each(|&c| finite("stribeck.coefficients", c).map(|_| ()))?;
            let level = stribeck(friction, curve);
            let rate = |k: i32| friction.stribeck_rate_rad_s * f64::from(k) / f64::from(POLYNOMIAL_CHECKS);
            let least = (0..=POLYNOMIAL_CHECKS).map(|k| level.at(rate(k))).fold(f64::INFINITY, f64::min);
            positive("stribeck.polynomial's least level", least).map(|_| ())
        }
        _ => Ok(()),
    }
}

/// Rates at which a polynomial's level is looked at.
const POLYNOMIAL_CHECKS: i32 = 200;

fn refused(parameter: &str, value: f64, allowed: &'static str) -> Error {
    Error::Parameter { parameter: parameter.to_owned(), value, allowed }
}

fn finite(parameter: &str, value: f64) -> Result<f64, Error> {
    if value.is_finite() { Ok(value) } else { Err(refused(parameter, value, "must be finite")) }
}

fn positive(parameter: &str, value: f64) -> Result<f64, Error> {
    let finite = finite(parameter, value)?;
    if finite > 0.0 { Ok(finite) } else { Err(refused(parameter, value, "must be positive")) }
}

fn not_negative(parameter: &str, value: f64) -> Result<f64, Error> {
    let finite = finite(parameter, value)?;
    if finite >= 0.0 { Ok(finite) } else { Err(refused(parameter, value, "must not be negative")) }
}

fn not_below_one(parameter: &str, value: f64) -> Result<f64, Error> {
    let finite = finite(parameter, value)?;
    if finite >= 1.0 {
        Ok(finite)
    } else {
        Err(refused(parameter, value, "must not be below 1 for this law"))
    }
}

fn below_one(parameter: &str, value: f64) -> Result<f64, Error> {
    let finite = finite(parameter, value)?;
    if finite.abs() < 1.0 { Ok(finite) } else { Err(refused(parameter, value, "must be between -1 and 1")) }
}
