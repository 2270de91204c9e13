//! Trials: the directions in an effect's knobs along which a look is taken, and where a fit starts from what it finds.

use counterpoise_models::Parameters;

use crate::fit::{from_variable, to_variable};
use crate::library::{Effect, Mapping};
use crate::look::{Scene, Sizes};

/// One effect at one set of directions in its knobs' fit variables.
pub(crate) struct Trial {
    pub effect: &'static Effect,
    pub origin: Vec<f64>,
    pub directions: Vec<Vec<f64>>,
    pub combine: Combine,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Combine {
    /// Any multiple of each direction.
    Free,
    /// From nothing towards the direction, not beyond twice its length.
    Towards,
    /// Sine and cosine of a ripple: amplitude and phase.
    Ripple,
    /// A stiffness slack at zero and one slack at another place, at a stiffness of zero: stiffness and torque there.
    Centred,
}

/// Multiples of a direction that a look may ask for.
const MULTIPLES: f64 = 30.0;
/// The same where the typical sizes are not the machine's: of a plain quantity, and the change of a logarithm.
const FAR_MULTIPLES: f64 = 3e3;
const FAR_LOGARITHM: f64 = 3.0;
/// The same of a torque that repeats.
const FAR_RIPPLE: f64 = 500.0;

/// How far each direction of a trial may be followed.
pub(crate) fn limits(trial: &Trial, sizes: Sizes) -> Vec<[f64; 2]> {
    let both = |limit: f64| [-limit, limit];
    let far = |direction: &Vec<f64>| {
        let moved = |k: &usize| direction[*k] != 0.0 && trial.effect.knobs[*k].mapping == Mapping::Log;
        let of = |k: usize| FAR_LOGARITHM / (direction[k].abs() * trial.effect.knobs[k].size);
        (0..direction.len()).find(moved).map_or(FAR_MULTIPLES, of)
    };
    let one = |direction: &Vec<f64>| match trial.combine {
        Combine::Towards => [0.0, 2.0],
        Combine::Free if !sizes.typical => both(far(direction)),
        Combine::Ripple if !sizes.typical => both(FAR_RIPPLE),
        _ => both(MULTIPLES),
    };
    trial.directions.iter().map(one).collect()
}

/// By how much the first direction changes the first knob.
pub(crate) fn first_change(trial: &Trial) -> f64 {
    let knob = &trial.effect.knobs[0];
    let there = from_variable(knob, trial.origin[0] + trial.directions[0][0]);
    (there - from_variable(knob, trial.origin[0])).abs()
}

pub(crate) fn moved(base: &Parameters, trial: &Trial, direction: &[f64]) -> Parameters {
    let x = trial.origin.iter().zip(direction).map(|(a, b)| a + b);
    let values: Vec<f64> = trial.effect.knobs.iter().zip(x).map(|(k, x)| from_variable(k, x)).collect();
    trial.effect.applied(base, &values)
}

pub(crate) fn start_values(trial: &Trial, coefficients: &[f64], most: f64) -> Vec<f64> {
    let mut x = trial.origin.clone();
    if trial.combine == Combine::Ripple {
        let (sine, cosine) = (coefficients[0], coefficients[1]);
        x[0] += sine.hypot(cosine).clamp(0.2, most) * trial.directions[0][0];
        x[2] = to_variable(&trial.effect.knobs[2], cosine.atan2(sine));
    } else if trial.combine == Combine::Centred {
        x[0] = coefficients[0] + coefficients[1];
        x[1] = coefficients[1] / if x[0] == 0.0 { 1.0 } else { x[0] };
    } else {
        for (direction, &c) in trial.directions.iter().zip(coefficients) {
            x.iter_mut().zip(direction).for_each(|(x, d)| *x += c * d);
        }
    }
    trial.effect.knobs.iter().zip(x).map(|(k, x)| from_variable(k, x)).collect()
}

/// Times its value to which a quantity that is positive by nature is taken where the machine's sizes are not known: dry friction
/// that a model has next to none of, for one.
const FAR_FACTORS: [f64; 2] = [4.0, 16.0];

pub(crate) fn trials(effect: &'static Effect, scene: &Scene) -> Vec<Trial> {
    let (base, knobs) = (scene.base, effect.knobs);
    let origin: Vec<f64> = knobs.iter().map(|k| to_variable(k, k.read(base))).collect();
    let trial = |origin: Vec<f64>, directions, combine| Trial { effect, origin, directions, combine };
    if knobs[0].mapping == Mapping::Whole {
        let towards = |d: usize| trial(origin.clone(), vec![vec![d as f64]], Combine::Towards);
        return [1, 2, 4, 8].into_iter().map(towards).collect();
    }
    if !effect.starts.is_empty() {
        let all = effect.starts.iter().map(|start| towards(effect, base, start));
        let mut all: Vec<Trial> = all.filter(|trial| trial.directions[0][0] != 0.0).collect();
        if is_centred(effect) && origin[0] == 0.0 {
            let from = vec![0.0; 2];
            all.push(trial(from, vec![vec![1.0, 0.0], vec![1.0, 1.0]], Combine::Centred));
        }
        return all;
    }
    let unit = |j: usize| (0..knobs.len()).map(|i| if i == j { 0.1 } else { 0.0 }).collect();
    let mut all = vec![trial(origin, (0..knobs.len()).map(unit).collect(), Combine::Free)];
    if let ([knob], false) = (knobs, scene.sizes.typical)
        && knob.mapping == Mapping::Log
    {
        let far = |factor: &f64| towards(effect, base, &[knob.read(base) * factor]);
        all.extend(FAR_FACTORS.iter().map(far).filter(|trial| trial.directions[0][0] != 0.0));
    }
    all
}

/// Whether the knobs are a stiffness and where it is slack.
fn is_centred(effect: &Effect) -> bool {
    effect.knobs.len() == 2 && effect.knobs[1].name == "centre"
}

/// From the model as it is towards a start; shape knobs (all but the first) jump, the first one goes there.
pub(crate) fn towards(effect: &'static Effect, base: &Parameters, start: &[f64]) -> Trial {
    let target: Vec<f64> = effect.knobs.iter().zip(start).map(|(k, &v)| to_variable(k, v)).collect();
    let mut origin = target.clone();
    origin[0] = to_variable(&effect.knobs[0], effect.knobs[0].read(base));
    let mut direction = vec![0.0; target.len()];
    direction[0] = target[0] - origin[0];
    Trial { effect, origin, directions: vec![direction], combine: Combine::Towards }
}

pub(crate) fn ripple(effect: &'static Effect, order: f64) -> Trial {
    let knobs = effect.knobs;
    let origin = vec![0.0, to_variable(&knobs[1], order), 0.0];
    let quarter = to_variable(&knobs[2], std::f64::consts::FRAC_PI_2);
    let directions = vec![vec![0.3, 0.0, 0.0], vec![0.3, 0.0, quarter]];
    Trial { effect, origin, directions, combine: Combine::Ripple }
}
