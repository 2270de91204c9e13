//! Free functions as effects: one parameter for each point of a table, so that they are fitted as every effect is.

use std::sync::{Mutex, PoisonError};

use counterpoise_linalg::{Mat, inverse};
use counterpoise_models::{LearnedElement, LearnedPlace, Parameters};

use super::effect::{Access, Effect, EffectKind, EffectParameter, ParameterMapping};
use super::learned_values;
use super::names::{Component, EffectName};
use crate::tolerance::FIT_STEP;
use crate::tolerance::learning::{FACTOR_BOUNDS, FORM_BOUND, INDISTINCT_ROWS, TORQUE_BOUND};

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
        Access::Learned { element, .. } | Access::Coefficient { element, .. } => Some(element),
        _ => None,
    }
}

/// Returns whether the parameters of an effect are the values of a free function at its points, each free.
pub(crate) fn has_free_points(effect: &Effect) -> bool {
    effect.parameters.first().is_some_and(|first| matches!(first.access, Access::Learned { .. }))
}

/// Returns what each parameter of a free function changes of its values at the points, row by row: itself, or a row of a form.
pub(crate) fn value_rows(effect: &Effect) -> Vec<Vec<f64>> {
    let row = |parameter: &EffectParameter| match parameter.access {
        Access::Coefficient { row, .. } => row.to_vec(),
        Access::Learned { element, point } => {
            (0..element.points.len()).map(|k| if k == point { 1.0 } else { 0.0 }).collect()
        }
        _ => Vec::new(),
    };
    effect.parameters.iter().map(row).collect()
}

/// Returns the values of a free function in a mechanism.
pub(crate) fn learned_values_in(of: &Parameters, element: &LearnedElement) -> Vec<f64> {
    (0..element.points.len()).map(|point| learned_values::read(of, element, point)).collect()
}

/// Returns the effect whose parameters are the coefficients of a free function that is a sum of rows over its points; `None` if the rows
/// do not determine their coefficients. `step` is a change of a value that the converters do not hide, in its unit.
///
/// It lives as long as the program: some thousand numbers for each form that a diagnosis fits.
pub(crate) fn make_form_effect(
    element: &LearnedElement,
    rows: &[Vec<f64>],
    step: f64,
) -> Option<&'static Effect> {
    let duals = dual_rows(rows)?;
    let element: &'static LearnedElement = Box::leak(Box::new(element.clone()));
    let unit = unit_of(element);
    let parameter = |(row, dual): (&Vec<f64>, Vec<f64>)| {
        let largest = row.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let size = step / FIT_STEP / largest;
        let bound = match element.quantity.is_factor() {
            true => FACTOR_BOUNDS[1] / largest,
            false => FORM_BOUND * size * FIT_STEP,
        };
        EffectParameter {
            name: "coefficient",
            unit,
            bounds: [-bound, bound],
            size,
            mapping: ParameterMapping::Linear,
            access: Access::Coefficient {
                element,
                row: Box::leak(row.clone().into_boxed_slice()),
                dual: Box::leak(dual.into_boxed_slice()),
            },
        }
    };
    Some(Box::leak(Box::new(Effect {
        effect: EffectName::Unknown,
        component: component_of(element.place),
        kind: EffectKind::MissingPhysics,
        parameters: Box::leak(rows.iter().zip(duals).map(parameter).collect()),
        starts: &[],
    })))
}

/// Returns the rows of the pseudo-inverse of a sum of rows: dual `i` times row `j` is 1 if they are the same, else 0.
fn dual_rows(rows: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let count = rows.len();
    let sizes: Vec<f64> = rows.iter().map(|row| row.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    let dot = |i: usize, j: usize| rows[i].iter().zip(&rows[j]).map(|(a, b)| a * b).sum::<f64>();
    let gram = Mat::from_fn(count, count, |i, j| dot(i, j) / (sizes[i] * sizes[j]));
    let inverse = inverse(&gram).ok().filter(Mat::is_finite)?;
    let largest = (0..count).map(|i| inverse[(i, i)]).fold(0.0, f64::max);
    let dual = |i: usize| {
        let entry = |k: usize| {
            let terms = (0..count).map(|j| inverse[(i, j)] * rows[j][k] / sizes[j]);
            terms.sum::<f64>() / sizes[i]
        };
        (0..rows[0].len()).map(entry).collect()
    };
    (largest < INDISTINCT_ROWS).then(|| (0..count).map(dual).collect())
}

fn unit_of(element: &LearnedElement) -> &'static str {
    if element.quantity.is_factor() { "1" } else { element.value_unit() }
}

fn make_effect(element: &'static LearnedElement, size: f64) -> Effect {
    let bound = TORQUE_BOUND * size * FIT_STEP;
    let bounds = if element.quantity.is_factor() { FACTOR_BOUNDS } else { [-bound, bound] };
    let unit = unit_of(element);
    let parameter = |(point, at): (usize, &f64)| EffectParameter {
        name: Box::leak(format!("value at {at:.4} {}", element.variable_unit()).into_boxed_str()),
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
        LearnedPlace::LoopSensor => Component::HubGyro,
        LearnedPlace::MotorTachometer => Component::MotorTachometer,
        LearnedPlace::HubResolver => Component::HubResolver,
        LearnedPlace::PlatformGyro => Component::PlatformGyro,
        LearnedPlace::PlatformAccelerometer => Component::PlatformAccelerometer,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use counterpoise_models::{LearnedQuantity, RegimeVariable, reference};

    use super::*;

    #[test]
    fn coefficients_of_a_form_are_read_as_they_were_written() {
        let points: Vec<f64> = (0..21).map(|k| 0.2 * f64::from(k) - 1.0).collect();
        let rows = [vec![1.0; 21], points.clone(), points.iter().map(|x| x.powi(3)).collect()];
        let (place, quantity) = (LearnedPlace::Pivot, LearnedQuantity::FrictionLevel);
        let element = LearnedElement::neutral(place, quantity, RegimeVariable::Rate, points.clone());
        let effect = make_form_effect(&element, &rows, 0.1).unwrap();
        let machine = effect.apply_to(&reference::rig(), &[0.5, -0.2, 0.3]);
        let read = effect.values(&machine);
        let expected = [0.5, -0.2, 0.3];
        assert!(read.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{read:?}");
        let at = |x: f64| 1.0 + 0.5 - 0.2 * x + 0.3 * x.powi(3);
        let values = learned_values_in(&machine, &element);
        assert!(values.iter().zip(&points).all(|(value, x)| (value - at(*x)).abs() < 1e-12), "{values:?}");
        assert_eq!(effect.values(&reference::rig()), [0.0; 3]);
    }

    #[test]
    fn rows_that_do_not_determine_their_coefficients_make_no_effect() {
        let points: Vec<f64> = (0..9).map(f64::from).collect();
        let place = (LearnedPlace::Pivot, LearnedQuantity::Torque);
        let element = LearnedElement::neutral(place.0, place.1, RegimeVariable::Angle, points.clone());
        let twice = points.iter().map(|x| 2.0 * x).collect();
        assert!(make_form_effect(&element, &[points.clone(), twice], 0.1).is_none());
        assert!(make_form_effect(&element, &[points, vec![0.0; 9]], 0.1).is_none());
    }
}
