//! A feedback that sees the error alone, as one from demand and reading.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, series};

use crate::Error;

/// Returns the continuous controller from (demand, reading) to the control that sees their difference alone: u = C (r - y).
///
/// # Errors
/// [`Error::Lti`] for a system in sampled time, or with more than one input.
pub fn from_demand_and_reading(C: &StateSpace) -> Result<StateSpace, Error> {
    let difference = StateSpace::gain(Mat::row(&[1.0, -1.0]), Timebase::Continuous)?;
    Ok(series(&difference, C)?)
}
