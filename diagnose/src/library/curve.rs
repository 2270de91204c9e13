//! The amplifier's curve with free knots, whose places the recordings determine.

use std::sync::{Mutex, PoisonError};

use super::effect::{Access, Effect, EffectKind, EffectParameter, ParameterMapping};
use super::names::{Component, EffectName};
use crate::tolerance::fitting::FREE_INPUTS_V;

/// Every curve that was requested: an effect lives as long as the program, so each set of inputs is made once.
static CURVES: Mutex<Vec<&'static Effect>> = Mutex::new(Vec::new());

/// Returns the amplifier's curve with a free knot at each of some inputs, V, rising and positive.
pub fn make_gain_curve(inputs_v: &[f64]) -> &'static Effect {
    let mut known = CURVES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(same) = known.iter().copied().find(|e| gain_curve_inputs(e) == Some(inputs_v)) {
        return same;
    }
    let made: &'static Effect = Box::leak(Box::new(make_effect(inputs_v)));
    known.push(made);
    made
}

/// Returns the curve with a free knot at each of the usual inputs.
pub fn make_free_gain_curve() -> &'static Effect {
    make_gain_curve(&FREE_INPUTS_V)
}

/// Returns the inputs of a curve's knots, V; `None` for another effect, and for a curve of another form.
pub fn gain_curve_inputs(effect: &Effect) -> Option<&'static [f64]> {
    match effect.parameters.first()?.access {
        Access::Curve { inputs_v, .. } => Some(inputs_v),
        Access::Field { .. } | Access::Learned { .. } | Access::Coefficient { .. } => None,
    }
}

fn make_effect(inputs_v: &[f64]) -> Effect {
    let inputs_v: &'static [f64] = Box::leak(inputs_v.to_vec().into_boxed_slice());
    let parameter = |(point, input): (usize, &f64)| EffectParameter {
        name: Box::leak(format!("gain at {input} V").into_boxed_str()),
        unit: "1",
        bounds: [0.05, 4.0],
        size: 0.1,
        mapping: ParameterMapping::Linear,
        access: Access::Curve { inputs_v, point },
    };
    Effect {
        // current = odd, piecewise linear map of the input (Dholiwar 2007, tables 7-1 and 7-2)
        effect: EffectName::GainCurve,
        component: Component::Amplifier,
        kind: EffectKind::MissingPhysics,
        parameters: Box::leak(inputs_v.iter().enumerate().map(parameter).collect()),
        starts: &[],
    }
}
