//! Three designs of the feedback side by side: H2, LQG/LTR and H-infinity on one plant and one pair of weights.
//!
//! Each answer is a controller from (demand, measured rate) to the control that sees the error alone, so that the same
//! figures can be drawn from all three.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, append, series};

use crate::error_feedback::from_demand_and_reading;
use crate::tolerance::{ALTERNATIVE_BOUND, SLOWEST_RAD_S};
use crate::{
    DesignPlant, Error, FeedbackWeights, GeneralisedPlant, Reference, StateOrigin, Weight, design_feedback,
    h2syn, hinfsyn, lqg_ltr,
};

/// Method by which a controller was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SynthesisMethod {
    /// The structured H2 design of [`design_feedback()`].
    ThreePart,
    /// Textbook H2 on the generalised plant, observer and weights in one: [`h2syn()`].
    JointH2,
    /// [`lqg_ltr`] with the quotient of the weights as loop shape.
    LqgLtr,
    /// [`hinfsyn()`] on the generalised plant.
    HInfinity,
}

/// A feedback controller from (demand, measured rate) to the control, with what its method minimised.
#[derive(Debug, Clone, PartialEq)]
pub struct Alternative {
    /// The method.
    pub method: SynthesisMethod,
    /// The controller: u = C (r - y).
    pub controller: StateSpace,
    /// The norm it reached: H2 or H-infinity from the noises to the weighted error and control; none for LQG/LTR.
    pub norm: Option<f64>,
    /// The controller on the generalised plant, from its measurement to its control; `None` if the method has none.
    pub on_generalised: Option<StateSpace>,
}

/// Returns the feedback designed by one method. Weights and plant are the same for all.
///
/// # Errors
/// [`Error`] for weights without realisation; without solution [`Error::Refused`].
pub fn design_alternative(
    plant: &DesignPlant,
    weights: &FeedbackWeights,
    method: SynthesisMethod,
) -> Result<Alternative, Error> {
    match method {
        SynthesisMethod::ThreePart => {
            let part = design_feedback(plant, weights, Reference::Error)?;
            let norm = part.cost.achieved.map(f64::sqrt);
            let controller = part.controller.select(&[0], &[0, 1]);
            Ok(Alternative { method, controller, norm, on_generalised: None })
        }
        SynthesisMethod::JointH2 => {
            let part = h2syn(&generalised_plant(plant, weights)?)?;
            let (controller, norm) = (from_error(&part.controller, weights)?, Some(part.achieved_norm));
            Ok(Alternative { method, controller, norm, on_generalised: Some(part.controller) })
        }
        SynthesisMethod::HInfinity => {
            let part = hinfsyn(&generalised_plant(plant, weights)?, ALTERNATIVE_BOUND)?;
            let (controller, norm) = (from_error(&part.controller, weights)?, Some(part.achieved_norm));
            Ok(Alternative { method, controller, norm, on_generalised: Some(part.controller) })
        }
        SynthesisMethod::LqgLtr => {
            let seen = plant.measured_plant()?.select(&[0], &[plant.control]);
            let shape = series(&weights.error.realise()?, &weights.control.realise_inverse()?)?;
            let recovery = weights.loop_recovery.max(f64::MIN_POSITIVE) / weights.measurement_noise;
            let part = lqg_ltr(&seen, &shape, 1.0, recovery)?;
            let controller = from_demand_and_reading(&part.controller.negate())?;
            Ok(Alternative { method, controller, norm: None, on_generalised: None })
        }
    }
}

/// Returns the textbook's plant for the feedback
///
/// ```text
///     w = (white disturbances, noise)   u = v, the weighted control     z = (H_q e, v)     y = e = -(rate + noise)
/// ```
///
/// with H_r^-1 before the plant (no far pole is needed for an improper H_r) and the error weight's poles on the axis
/// moved to -[`SLOWEST_RAD_S`]: y does not show the error weight's states, and a textbook filter must be able to let
/// them decay. The direct part of an error weight ends in a pole at 1e4 rad/s.
///
/// # Errors
/// [`Error`] for a plant or weights that are not ones.
pub fn generalised_plant(plant: &DesignPlant, weights: &FeedbackWeights) -> Result<GeneralisedPlant, Error> {
    let seen = plant.measured_plant()?;
    let mut inputs: Vec<usize> = weights.disturbances.iter().map(|entry| entry.index).collect();
    let mut densities: Vec<f64> = weights.disturbances.iter().map(|entry| entry.value.sqrt()).collect();
    inputs.extend([plant.control, plant.control]);
    densities.extend([weights.loop_recovery.sqrt(), 1.0]);
    let count = inputs.len();
    let driven = seen.select(&[0], &inputs).scale_io(&[-1.0], &densities)?;
    let inverse = weights.control.realise_inverse()?;
    let wires = |n: usize| StateSpace::gain(Mat::eye(n), Timebase::Continuous);
    let driven = series(&append(&wires(count - 1)?, &inverse)?, &driven)?;
    // Inputs (disturbances, noise, v); outputs (e, v).
    let mut spread = Mat::zeros(count + 2, count + 1);
    for i in 0..count - 1 {
        spread[(i, i)] = 1.0;
    }
    spread[(count - 1, count)] = 1.0;
    spread[(count, count - 1)] = -weights.measurement_noise.sqrt();
    spread[(count + 1, count)] = 1.0;
    let spread = StateSpace::gain(spread, Timebase::Continuous)?;
    let passed = series(&spread, &append(&driven, &wires(2)?)?)?;
    let sum = Mat::from_rows(&[&[1.0, 1.0, 0.0], &[0.0, 0.0, 1.0], &[1.0, 1.0, 0.0]]);
    let summed = series(&passed, &StateSpace::gain(sum, Timebase::Continuous)?)?;
    let weighted = series(&summed, &append(&textbook(&weights.error).realise()?, &wires(2)?)?)?;
    let of_error = weighted.order() - inverse.order() - seen.order();
    GeneralisedPlant::new(weighted, 1, 1)?.of_blocks(vec![
        StateOrigin::new("the control weight", inverse.order()),
        StateOrigin::new("the plant", seen.order()),
        StateOrigin::new("the error weight", of_error),
    ])
}

/// The error weight with its poles on the axis moved off it, and strictly proper.
fn textbook(weight: &Weight) -> Weight {
    let rational = weight.rational().mirror_to_left();
    let moved = |pole: &counterpoise_linalg::C64| if pole.re == 0.0 { pole - SLOWEST_RAD_S } else { *pole };
    let mut poles: Vec<_> = rational.poles.iter().map(moved).collect();
    let mut gain = rational.gain;
    if rational.zeros.len() == poles.len() {
        poles.push(counterpoise_linalg::C64::new(-FAST_RAD_S, 0.0));
        gain *= FAST_RAD_S;
    }
    Weight::ZeroPoleGain { zeros: rational.zeros, poles, gain }
}

/// Rate at which the direct part of an error weight ends in a textbook's plant, rad/s.
const FAST_RAD_S: f64 = 1e4;

/// H_r^-1 K from the error, with the demand's path.
fn from_error(K: &StateSpace, weights: &FeedbackWeights) -> Result<StateSpace, Error> {
    from_demand_and_reading(&series(K, &weights.control.realise_inverse()?)?)
}
