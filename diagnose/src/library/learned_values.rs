//! The values of free functions in a mechanism.

use counterpoise_models::{LearnedElement, Parameters};

/// Returns the value of a free function at a point in a mechanism; the neutral one if the mechanism does not have it.
pub(super) fn read(of: &Parameters, element: &LearnedElement, point: usize) -> f64 {
    let found = of.learned.iter().find(|e| is_same(e, element));
    found.map_or(element.quantity.neutral(), |e| e.values[point])
}

/// Sets the value of a free function at a point; a mechanism that does not have the function is given it.
pub(super) fn write(of: &mut Parameters, element: &LearnedElement, point: usize, value: f64) {
    values_mut(of, element)[point] = value;
}

/// Returns a coefficient of a free function in a mechanism, of which `dual` tells what it is of the values; 0 if the mechanism does not have it.
pub(super) fn read_coefficient(of: &Parameters, element: &LearnedElement, dual: &[f64]) -> f64 {
    let neutral = element.quantity.neutral();
    let found = of.learned.iter().find(|e| is_same(e, element));
    found.map_or(0.0, |e| e.values.iter().zip(dual).map(|(value, dual)| dual * (value - neutral)).sum())
}

/// Adds a multiple of a row to the values of a free function; a mechanism that does not have the function is given it.
pub(super) fn add_row(of: &mut Parameters, element: &LearnedElement, row: &[f64], by: f64) {
    values_mut(of, element).iter_mut().zip(row).for_each(|(value, row)| *value += by * row);
}

/// Returns the values of a free function in a mechanism; one that does not have the function is given it.
fn values_mut<'p>(of: &'p mut Parameters, element: &LearnedElement) -> &'p mut [f64] {
    let place = of.learned.iter().position(|e| is_same(e, element)).unwrap_or_else(|| {
        of.learned.push(element.clone());
        of.learned.len() - 1
    });
    &mut of.learned[place].values
}

/// Returns whether an element of a machine is the fitted one, whatever its values.
fn is_same(a: &LearnedElement, b: &LearnedElement) -> bool {
    (a.place, a.quantity, a.variable, &a.points) == (b.place, b.quantity, b.variable, &b.points)
        && a.name == b.name
}
