//! The amplifier's curve with its points free: where they lie is chosen by the recordings.

use std::sync::{Mutex, PoisonError};

use super::{Access, Effect, Kind, Knob, Mapping};
use counterpoise_models::{MapPoint, Parameters};

/// Inputs at which a curve is described before the recordings have asked for others, V; above the last one it is linear.
pub const FREE_INPUTS_V: [f64; 14] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.95, 1.1, 1.25, 1.4, 1.7, 2.0];

/// Every curve that was asked for: an effect lives as long as the program, so each set of inputs is made once.
static CURVES: Mutex<Vec<&'static Effect>> = Mutex::new(Vec::new());

/// The amplifier's curve with a free point at each of some inputs, V, rising and positive.
pub fn curve_of(inputs_v: &[f64]) -> &'static Effect {
    let mut known = CURVES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(same) = known.iter().copied().find(|e| curve_inputs(e) == Some(inputs_v)) {
        return same;
    }
    let made: &'static Effect = Box::leak(Box::new(made(inputs_v)));
    known.push(made);
    made
}

/// The curve with a free point at each of the usual inputs.
pub fn free_curve() -> &'static Effect {
    curve_of(&FREE_INPUTS_V)
}

/// The inputs of a curve's points, V; none for another effect, and for a curve of another form.
pub fn curve_inputs(effect: &Effect) -> Option<&'static [f64]> {
    match effect.knobs.first()?.access {
        Access::Curve { inputs_v, .. } => Some(inputs_v),
        Access::Field { .. } => None,
    }
}

fn made(inputs_v: &[f64]) -> Effect {
    let inputs_v: &'static [f64] = Box::leak(inputs_v.to_vec().into_boxed_slice());
    let knob = |(point, input): (usize, &f64)| Knob {
        name: Box::leak(format!("gain at {input} V").into_boxed_str()),
        unit: "1",
        bounds: [0.05, 4.0],
        size: 0.1,
        mapping: Mapping::Linear,
        access: Access::Curve { inputs_v, point },
    };
    Effect {
        effect: "gain_curve",
        component: "amplifier",
        kind: Kind::MissingPhysics,
        equation: "current = odd, piecewise linear map of the input; each point as a fraction of the linear gain",
        source: "Dholiwar 2007, tables 7-1 and 7-2",
        when: "at small control voltages, whatever the rate",
        experiment: "stalled amplifier map, or runs at two out-of-balances",
        knobs: Box::leak(inputs_v.iter().enumerate().map(knob).collect()),
        starts: &[],
    }
}

/// The curve at an input as a fraction of the linear gain.
pub(super) fn fraction(p: &Parameters, input_v: f64) -> f64 {
    let linear = static_gain(p) * input_v;
    interpolated(&p.amplifier.map, input_v).unwrap_or(linear) / linear
}

/// Sets a point of a curve as a fraction of the linear gain, on a map with all the curve's inputs.
pub(super) fn set_fraction(p: &mut Parameters, (inputs_v, point): (&[f64], usize), fraction: f64) {
    let gain = static_gain(p);
    let map = &mut p.amplifier.map;
    let same = map.len() == inputs_v.len() && map.iter().zip(inputs_v).all(|(m, v)| m.input_v == *v);
    if !same {
        let old = std::mem::take(map);
        let at = |&v: &f64| MapPoint { input_v: v, current_a: interpolated(&old, v).unwrap_or(gain * v) };
        *map = inputs_v.iter().map(at).collect();
    }
    map[point].current_a = fraction * gain * inputs_v[point];
}

/// Stalled gain of the linear amplifier, A/V.
pub(super) fn static_gain(p: &Parameters) -> f64 {
    p.amplifier.gain / (p.motor.resistance_ohm + p.amplifier.gain * p.amplifier.current_feedback_v_a)
}

/// The map's current at `v > 0`, piecewise linear through the origin; none where there is no map or beyond it.
fn interpolated(map: &[MapPoint], v: f64) -> Option<f64> {
    let mut from = MapPoint { input_v: 0.0, current_a: 0.0 };
    for &to in map {
        if v <= to.input_v {
            let share = (v - from.input_v) / (to.input_v - from.input_v);
            return Some(from.current_a + share * (to.current_a - from.current_a));
        }
        from = to;
    }
    None
}
