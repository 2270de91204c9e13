//! The values of free functions in a mechanism.

use counterpoise_models::{LearnedElement, Parameters};

/// Returns the value of a free function at a point in a mechanism; the neutral one if the mechanism does not have it.
pub(super) fn read(of: &Parameters, element: &LearnedElement, point: usize) -> f64 {
    let found = of.learned.iter().find(|e| is_same(e, element));
    found.map_or(element.quantity.neutral(), |e| e.values[point])
}

/// Sets the value of a free function at a point; a mechanism that does not have the function is given it.
pub(super) fn write(of: &mut Parameters, element: &LearnedElement, point: usize, value: f64) {
    let place = of.learned.iter().position(|e| is_same(e, element)).unwrap_or_else(|| {
        of.learned.push(element.clone());
        of.learned.len() - 1
    });
    of.learned[place].values[point] = value;
}

/// Returns whether an element of a machine is the fitted one, whatever its values.
fn is_same(a: &LearnedElement, b: &LearnedElement) -> bool {
    (a.place, a.quantity, a.variable, &a.points) == (b.place, b.quantity, b.variable, &b.points)
        && a.name == b.name
}
