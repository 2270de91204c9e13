//! Ranges of the numbers of loads and of a cylinder.

use crate::Error;

/// Refuses a number outside a range, named with its path.
pub(crate) fn require(
    is_allowed: impl Fn(f64) -> bool,
    parameter: &str,
    value: f64,
    allowed: &str,
) -> Result<(), Error> {
    if is_allowed(value) {
        return Ok(());
    }
    Err(Error::Parameter { parameter: parameter.to_owned(), value, allowed: allowed.to_owned().into() })
}

pub(crate) fn require_positive(parameter: &str, value: f64) -> Result<(), Error> {
    require(|value| value > 0.0 && value.is_finite(), parameter, value, "must be positive and finite")
}

pub(crate) fn not_negative(parameter: &str, value: f64) -> Result<(), Error> {
    require(|value| value >= 0.0 && value.is_finite(), parameter, value, "must be 0 or more, and finite")
}

pub(crate) fn require_finite(parameter: &str, value: f64) -> Result<(), Error> {
    require(f64::is_finite, parameter, value, "must be finite")
}
