//! The amplifier's map from input to stalled current, read and written as fractions of the linear gain.

use counterpoise_models::{MapPoint, Parameters};

/// Returns the curve at an input as a fraction of the linear gain.
pub(super) fn fraction(p: &Parameters, input_v: f64) -> f64 {
    let linear = static_gain(p) * input_v;
    interpolate_current(&p.amplifier.map, input_v).unwrap_or(linear) / linear
}

/// A point of a curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurvePoint<'a> {
    /// Inputs of all points of the curve, V, rising.
    pub inputs_v: &'a [f64],
    /// The index among them.
    pub point: usize,
}

/// Sets a point of a curve as a fraction of the linear gain, on a map with all the curve's inputs.
pub(super) fn set_fraction(p: &mut Parameters, at: CurvePoint, fraction: f64) {
    let CurvePoint { inputs_v, point } = at;
    let gain = static_gain(p);
    let map = &mut p.amplifier.map;
    let same = map.len() == inputs_v.len() && map.iter().zip(inputs_v).all(|(m, v)| m.input_v == *v);
    if !same {
        let old = std::mem::take(map);
        let at =
            |&v: &f64| MapPoint { input_v: v, current_a: interpolate_current(&old, v).unwrap_or(gain * v) };
        *map = inputs_v.iter().map(at).collect();
    }
    map[point].current_a = fraction * gain * inputs_v[point];
}

/// Returns the stalled gain of the linear amplifier, A/V.
pub(super) fn static_gain(p: &Parameters) -> f64 {
    p.amplifier.gain / (p.motor.resistance_ohm + p.amplifier.gain * p.amplifier.current_feedback_v_a)
}

/// Returns the map's current at `v > 0`, piecewise linear through the origin; `None` if there is no map or if `v` is beyond it.
fn interpolate_current(map: &[MapPoint], v: f64) -> Option<f64> {
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
