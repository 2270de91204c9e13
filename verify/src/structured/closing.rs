//! The loop closed with a perturbation, exactly as it is sampled: the judge of what the bounds say.

use counterpoise_controller::{COMMON_READINGS, Controller};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, append, lft, poles, series};
use counterpoise_models::ControlledQuantity;
use counterpoise_models::parameters::Parameters;
use counterpoise_models::plant::{
    Angles, FrictionLinearisation, Impedance, LinearPlant, OperatingPoint, Plant,
};

use super::places::LinearisedDryFriction;
use crate::Error;
use crate::linear_loop::SampledPlant;
use crate::linear_loop::closed_loop::resolver_use;
use crate::tolerance::NEUTRAL;

/// Errors of the plant's gain at one frequency: what the loop is closed with is an all-pass of first order with that value there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainErrors {
    /// Relative error at the plant's input and of the hub gyroscope's reading.
    pub at: [C64; 2],
    /// Frequencies of these values, rad/s.
    pub rate_rad_s: f64,
}

/// The mechanism, whose dry friction does not act, linearised with the springs of presliding: without angles if there are none.
pub(super) fn linearise(
    body: &Plant,
    at: &OperatingPoint,
    dry: &LinearisedDryFriction,
) -> Result<LinearPlant, Error> {
    let spring = |stiffness| Impedance { stiffness, damping: 0.0 };
    let (friction, angles) = if dry.springs == [0.0; 2] {
        (FrictionLinearisation::Viscous, body.angles())
    } else {
        let [motor, pivot] = dry.springs.map(spring);
        let rate = body.angles() == Angles::Drop;
        (
            FrictionLinearisation::Impedances { motor, pivot },
            if rate { Angles::Relative } else { body.angles() },
        )
    };
    Ok(body.linearise(&body.equilibrium(at), friction, angles)?)
}

/// A perturbed mechanism as it is sampled, and what closes the loop around it.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopClosure {
    /// The sampled plant: the control is its last input, the readings are its last outputs.
    pub plant: StateSpace,
    /// The controller with the gain errors before and behind it.
    pub controller: StateSpace,
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
}

/// Returns the perturbed mechanism and what closes the loop around it.
///
/// # Errors
/// As [`outermost_pole`].
pub fn close_perturbed_loop(
    parameters: &Parameters,
    dry: &LinearisedDryFriction,
    controller: &Controller,
    at: &OperatingPoint,
    errors: &GainErrors,
) -> Result<LoopClosure, Error> {
    let body = Plant::from_lumped(parameters)?;
    let linear = linearise(&body, at, dry)?;
    let plant = SampledPlant::new(&linear, parameters, resolver_use(controller))?;
    let K = controller.linear(controller.parts().design_out_of_balance_kg_m)?;
    let period_s = plant.sample_period_s;
    let [input, output] = errors.at.map(|error| with_error(error, errors.rate_rad_s * period_s, period_s));
    let discrete = Timebase::Discrete { period_s };
    let before = append(&StateSpace::gain(Mat::eye(1), discrete)?, &output?)?;
    let readings = append(&before, &StateSpace::gain(Mat::eye(COMMON_READINGS - 2), discrete)?)?;
    Ok(LoopClosure {
        controller: series(&series(&readings, &K)?, &input?)?,
        plant: plant.sampled,
        controlled: parameters.controlled_quantity(),
    })
}

/// Returns the closed loop's pole of largest modulus, the perturbed mechanism's parameters and gain errors given. With springs of
/// presliding, poles of constants that nothing changes are left out.
///
/// # Errors
/// Parameters that make no mechanism, and those of the sampling and of the connection.
pub fn outermost_pole(
    parameters: &Parameters,
    dry: &LinearisedDryFriction,
    controller: &Controller,
    at: &OperatingPoint,
    errors: &GainErrors,
) -> Result<C64, Error> {
    let closed = close_perturbed_loop(parameters, dry, controller, at, errors)?;
    let system = lft(&closed.plant, &closed.controller)?;
    let all: Vec<C64> = if dry.springs == [0.0; 2] {
        poles(&system)?
    } else {
        poles(&system)?.into_iter().filter(|pole| (pole - 1.0).norm() > NEUTRAL).collect()
    };
    Ok(all.into_iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or(C64::new(0.0, 0.0)))
}

/// 1 + error, the error being an all-pass times its size
///
/// ```text
///     e(z) = s r (1 - c z) / (z - c),   |c| < 1,   s = 1 or -1,   e(exp(j angle)) = error
/// ```
fn with_error(error: C64, angle: f64, period_s: f64) -> Result<StateSpace, Error> {
    let timebase = Timebase::Discrete { period_s };
    let size = error.norm();
    let turned = if error.arg() < 0.0 { error.arg() } else { error.arg() - std::f64::consts::PI };
    let gain = if error.arg() < 0.0 { size } else { -size };
    let below = (0.5 * (turned - angle)).sin();
    let c = (0.5 * (turned + angle)).sin() / below;
    if size == 0.0 || c.is_nan() || c.abs() >= 1.0 {
        return Ok(StateSpace::gain(Mat::row(&[1.0 + error.re]), timebase)?);
    }
    // (1 - c z) / (z - c) = -c + (1 - c^2) / (z - c)
    let one = |x: f64| Mat::row(&[x]);
    Ok(StateSpace::new(one(c), one(1.0), one(gain * (1.0 - c * c)), one(1.0 - gain * c), timebase)?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::response_at;

    #[test]
    fn an_error_has_its_value_where_it_should_and_its_size_everywhere() {
        for phase in [-3.0, -1.0, -0.1, 0.2, 1.5, 3.0] {
            for rate in [3.0, 200.0, 2500.0] {
                let error = C64::from_polar(0.3, phase);
                let system = with_error(error, rate * 1e-3, 1e-3).unwrap();
                let one = C64::new(1.0, 0.0);
                assert!((response_at(&system, rate).unwrap()[(0, 0)] - one - error).norm() < 1e-9);
                let elsewhere = response_at(&system, 0.3 * rate).unwrap()[(0, 0)] - one;
                assert!((elsewhere.norm() - 0.3).abs() < 1e-9);
            }
        }
    }
}
