//! The largest value of a function of frequency, and the gains of a response among which it is sought.

use crate::error::OperationContext;
use crate::response::Response;
use crate::{CMat, Error};
use counterpoise_linalg as linalg;

/// The largest value of a function of frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// The value.
    pub value: f64,
    /// The frequency of the value, rad/s; infinite if the direct path has the largest gain.
    pub rate_rad_s: f64,
}

/// Returns the largest singular value of the response at each frequency, rad/s.
///
/// # Errors
/// Returns [`Error::Pole`] if a frequency is that of a pole.
pub(crate) fn largest_gains(response: &Response, rates: &[f64]) -> Result<Vec<f64>, Error> {
    let largest = |H: &CMat| linalg::largest_singular_value(H).with_operation("L-infinity norm");
    response.at_all(rates)?.iter().map(largest).collect()
}
