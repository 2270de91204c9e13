//! Perturbations: the directions in an effect's parameters along which its signature is computed, and where a fit starts from what
//! that shows.

use crate::tolerance::selection::{
    CURRENT_LIMIT_STARTS, LARGEST_MULTIPLE, LARGEST_SCALED_LOGARITHM, LARGEST_SCALED_MULTIPLE,
    LARGEST_SCALED_RIPPLE, SCALED_FACTORS, STRIBECK_STARTS,
};
use counterpoise_models::{CONVERTER_RANGE_V, Parameters};

use crate::fitting::output_error::{from_variable, to_variable};
use crate::library::{Component, Effect, EffectName, ParameterMapping};
use crate::selection::sizes::Sizes;

/// One effect with a set of directions in its parameters' fit variables.
pub(crate) struct Perturbation {
    pub effect: &'static Effect,
    pub origin: Vec<f64>,
    pub directions: Vec<Vec<f64>>,
    pub combine: Combination,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Combination {
    /// Any multiple of each direction.
    Free,
    /// From nothing towards the direction, not beyond twice its length.
    Towards,
    /// Sine and cosine of a ripple: amplitude and phase.
    Ripple,
    /// A stiffness slack at zero and one slack at another place, at a stiffness of zero: stiffness and torque there.
    Centred,
}

/// Returns how far each direction of a perturbation may be followed.
pub(crate) fn step_limits(perturbation: &Perturbation, sizes: Sizes) -> Vec<[f64; 2]> {
    let both = |limit: f64| [-limit, limit];
    let far = |direction: &Vec<f64>| {
        let moved = |k: &usize| {
            direction[*k] != 0.0 && perturbation.effect.parameters[*k].mapping == ParameterMapping::Log
        };
        let of = |k: usize| {
            LARGEST_SCALED_LOGARITHM / (direction[k].abs() * perturbation.effect.parameters[k].size)
        };
        (0..direction.len()).find(moved).map_or(LARGEST_SCALED_MULTIPLE, of)
    };
    let one = |direction: &Vec<f64>| match perturbation.combine {
        Combination::Towards => [0.0, 2.0],
        Combination::Free if !sizes.typical => both(far(direction)),
        Combination::Ripple if !sizes.typical => both(LARGEST_SCALED_RIPPLE),
        _ => both(LARGEST_MULTIPLE),
    };
    perturbation.directions.iter().map(one).collect()
}

/// Returns by how much the first direction changes the first parameter.
pub(crate) fn first_change(perturbation: &Perturbation) -> f64 {
    let parameter = &perturbation.effect.parameters[0];
    let there = from_variable(parameter, perturbation.origin[0] + perturbation.directions[0][0]);
    (there - from_variable(parameter, perturbation.origin[0])).abs()
}

/// Returns the mechanism a step away along a perturbation.
pub(crate) fn apply_perturbation(
    base: &Parameters,
    perturbation: &Perturbation,
    direction: &[f64],
) -> Parameters {
    let x = perturbation.origin.iter().zip(direction).map(|(a, b)| a + b);
    let values: Vec<f64> =
        perturbation.effect.parameters.iter().zip(x).map(|(k, x)| from_variable(k, x)).collect();
    perturbation.effect.apply_to(base, &values)
}

pub(crate) fn start_values(perturbation: &Perturbation, coefficients: &[f64], most: f64) -> Vec<f64> {
    let mut x = perturbation.origin.clone();
    if perturbation.combine == Combination::Ripple {
        let (sine, cosine) = (coefficients[0], coefficients[1]);
        x[0] += sine.hypot(cosine).clamp(0.2, most) * perturbation.directions[0][0];
        x[2] = to_variable(&perturbation.effect.parameters[2], cosine.atan2(sine));
    } else if perturbation.combine == Combination::Centred {
        x[0] = coefficients[0] + coefficients[1];
        x[1] = coefficients[1] / if x[0] == 0.0 { 1.0 } else { x[0] };
    } else {
        for (direction, &c) in perturbation.directions.iter().zip(coefficients) {
            x.iter_mut().zip(direction).for_each(|(x, d)| *x += c * d);
        }
    }
    perturbation.effect.parameters.iter().zip(x).map(|(k, x)| from_variable(k, x)).collect()
}

/// Returns every perturbation along which an effect is screened.
pub(crate) fn perturbations_of(
    effect: &'static Effect,
    base: &Parameters,
    sizes: Sizes,
) -> Vec<Perturbation> {
    let free = effect.parameters;
    let origin: Vec<f64> = free.iter().map(|k| to_variable(k, k.read(base))).collect();
    let perturbation =
        |origin: Vec<f64>, directions, combine| Perturbation { effect, origin, directions, combine };
    if free[0].mapping == ParameterMapping::Whole {
        let towards = |d: usize| perturbation(origin.clone(), vec![vec![d as f64]], Combination::Towards);
        return [1, 2, 4, 8].into_iter().map(towards).collect();
    }
    if !effect.starts.is_empty() {
        let all = starts_of(effect, base, sizes).into_iter();
        let all = all.map(|start| perturbation_towards(effect, base, &start));
        let mut all: Vec<Perturbation> =
            all.filter(|perturbation| perturbation.directions[0][0] != 0.0).collect();
        if is_centred(effect) && origin[0] == 0.0 {
            let from = vec![0.0; 2];
            all.push(perturbation(from, vec![vec![1.0, 0.0], vec![1.0, 1.0]], Combination::Centred));
        }
        return all;
    }
    let unit = |j: usize| (0..free.len()).map(|i| if i == j { 0.1 } else { 0.0 }).collect();
    let mut all = vec![perturbation(origin, (0..free.len()).map(unit).collect(), Combination::Free)];
    if let ([parameter], false) = (free, sizes.typical)
        && parameter.mapping == ParameterMapping::Log
    {
        let far = |factor: &f64| perturbation_towards(effect, base, &[parameter.read(base) * factor]);
        all.extend(
            SCALED_FACTORS.iter().map(far).filter(|perturbation| perturbation.directions[0][0] != 0.0),
        );
    }
    all
}

/// Returns the values from which a fit of an effect starts: those of the library, or on a machine of another size those that its recordings and
/// its drive suggest.
fn starts_of(effect: &Effect, base: &Parameters, sizes: Sizes) -> Vec<Vec<f64>> {
    let listed = || effect.starts.iter().map(|start| start.to_vec()).collect();
    if sizes.typical {
        return listed();
    }
    match (effect.effect, effect.component) {
        (EffectName::Stribeck, component) => {
            let ratio = if component == Component::Motor { base.gearbox.ratio } else { 1.0 };
            STRIBECK_STARTS
                .iter()
                .map(|share| vec![effect.starts[0][0], share * ratio * sizes.rate_rad_s])
                .collect()
        }
        (EffectName::CurrentLimit, _) => {
            let shares = |most: f64| CURRENT_LIMIT_STARTS.iter().map(|share| vec![share * most]).collect();
            stall_current_a(base).map_or_else(listed, shares)
        }
        _ => listed(),
    }
}

/// Returns the current that the largest control drives through the motor at rest, A; `None` if nothing bounds it.
pub(crate) fn stall_current_a(base: &Parameters) -> Option<f64> {
    let amplifier = &base.amplifier;
    let most = amplifier.drive_v(CONVERTER_RANGE_V, &base.motor) * amplifier.stall_gain_a_v(&base.motor);
    (most.is_finite() && most > 0.0).then_some(most)
}

/// Returns whether the parameters are a stiffness and the position at which it is slack.
fn is_centred(effect: &Effect) -> bool {
    effect.parameters.len() == 2 && effect.parameters[1].name == "centre"
}

/// Returns the perturbation from the model as it is towards a start: the shape parameters (all but the first) take the start's
/// values, the first one moves towards it.
pub(crate) fn perturbation_towards(
    effect: &'static Effect,
    base: &Parameters,
    start: &[f64],
) -> Perturbation {
    let target: Vec<f64> = effect.parameters.iter().zip(start).map(|(k, &v)| to_variable(k, v)).collect();
    let mut origin = target.clone();
    origin[0] = to_variable(&effect.parameters[0], effect.parameters[0].read(base));
    let mut direction = vec![0.0; target.len()];
    direction[0] = target[0] - origin[0];
    Perturbation { effect, origin, directions: vec![direction], combine: Combination::Towards }
}

pub(crate) fn ripple_perturbation(effect: &'static Effect, order: f64) -> Perturbation {
    let free = effect.parameters;
    let origin = vec![0.0, to_variable(&free[1], order), 0.0];
    let quarter = to_variable(&free[2], std::f64::consts::FRAC_PI_2);
    let directions = vec![vec![0.3, 0.0, 0.0], vec![0.3, 0.0, quarter]];
    Perturbation { effect, origin, directions, combine: Combination::Ripple }
}
