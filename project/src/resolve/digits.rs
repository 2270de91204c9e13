//! Digits of numbers that a file states and the machine keeps in other terms.

/// Digits after the first that a number keeps.
const DIGITS: usize = 11;

/// Returns a number to twelve digits: what was written in few of them comes back as it was written.
pub(super) fn round_to_digits(value: f64) -> f64 {
    format!("{value:.DIGITS$e}").parse().unwrap_or(value)
}
