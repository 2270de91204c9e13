//! Free functions as effects: one parameter for each point of a table, so that they are fitted as every effect is.

use std::sync::{Mutex, PoisonError};

use counterpoise_models::{LearnedElement, LearnedPlace};

use super::effect::{Access, Effect, EffectKind, EffectParameter, ParameterMapping};
use super::names::{Component, EffectName};
use crate::tolerance::FIT_STEP;
use crate::tolerance::learning::{FACTOR_BOUNDS, TORQUE_BOUND};

/// Every element that was requested: an effect lives as long as the program, so each is made once.
static ELEMENTS: Mutex<Vec<(&'static LearnedElement, &'static Effect)>> = Mutex::new(Vec::new());

/// Returns the effect whose parameters are the values of a free function at its points; `step` is a change of a value that the
/// converters do not hide, in its unit.
pub fn make_learned_effect(element: &LearnedElement, step: f64) -> &'static Effect {
    let mut known = ELEMENTS.lock().unwrap_or_else(PoisonError::into_inner);
    let size = step / FIT_STEP;
    let same =
        |(k, e): &&(&'static LearnedElement, &'static Effect)| *k == element && e.parameters[0].size == size;
    if let Some((_, effect)) = known.iter().find(same) {
        return effect;
    }
    let element: &'static LearnedElement = Box::leak(Box::new(element.clone()));
    let made: &'static Effect = Box::leak(Box::new(make_effect(element, size)));
    known.push((element, made));
    made
}

/// Returns the element of a free function in the library; `None` for another effect.
pub fn learned_element(effect: &Effect) -> Option<&'static LearnedElement> {
    match effect.parameters.first()?.access {
        Access::Learned { element, .. } => Some(element),
        _ => None,
    }
}

fn make_effect(element: &'static LearnedElement, size: f64) -> Effect {
    let bound = TORQUE_BOUND * size * FIT_STEP;
    let bounds = if element.quantity.is_factor() { FACTOR_BOUNDS } else { [-bound, bound] };
    let unit = if element.quantity.is_factor() { "1" } else { "N m" };
    let parameter = |(point, at): (usize, &f64)| EffectParameter {
        name: Box::leak(format!("value at {at:.4} {}", element.variable.unit()).into_boxed_str()),
        unit,
        bounds,
        size,
        mapping: ParameterMapping::Linear,
        access: Access::Learned { element, point },
    };
    Effect {
        // a free function of one regime variable (Kennedy, O'Hagan 2001: discrepancy of a model)
        effect: EffectName::Unknown,
        component: component_of(element.place),
        kind: EffectKind::MissingPhysics,
        parameters: Box::leak(element.points.iter().enumerate().map(parameter).collect()),
        starts: &[],
    }
}

/// Returns the component at which a free function acts.
pub fn component_of(place: LearnedPlace) -> Component {
    match place {
        LearnedPlace::Pivot => Component::Pivot,
        LearnedPlace::Motor => Component::Motor,
        LearnedPlace::Gearbox => Component::Gearbox,
    }
}
