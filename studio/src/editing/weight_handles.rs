//! Handles of a weight that are moved by hand: the numbers that the project file gets.

use counterpoise_synth::Weight;
use counterpoise_synth::weight::handles::{HandlePosition, WeightHandle, WeightNumber, move_handle};

/// Returns the keys with their values that a handle sets when it is moved to a position.
pub fn values_when_moved(weight: &Weight, handle: &WeightHandle, to: HandlePosition) -> Vec<WeightNumber> {
    let exact = move_handle(weight, handle, to);
    exact.into_iter().map(|one| WeightNumber { value: round_to_three_digits(one.value), ..one }).collect()
}

/// Rounds to three significant digits: what a hand can place.
pub fn round_to_three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
