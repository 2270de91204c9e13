//! The cascade: a proportional position loop around the rate loop of the H2 design, with one sensor of position.
//!
//! ```text
//!   r --o--> K_p --o--> [ rate controller ] --> u
//!       |-         |-
//!       |          +--[ s / (1 + s T/2) ]--+
//!       +----------------------------------+-- y
//! ```
//!
//! The bilinear map makes `s / (1 + s T/2)` exactly `(1 - 1/z) / T`: the controller that runs takes the rate as the difference of
//! two readings over the sample period. Both loops together are one linear controller from (demand, position), so everything that
//! is stated of the sampled loop (margins at the plant's input, stability, rounding, code) holds for the cascade as a whole.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, series};

use crate::{DesignPlant, Error};

/// Returns the lag that a difference of two readings over a period adds to their rate: `1 / (1 + s T/2)`.
///
/// # Errors
/// A period that is not a positive number.
pub fn difference_lag(period_s: f64) -> Result<StateSpace, Error> {
    check_period(period_s)?;
    let rate = 2.0 / period_s;
    let (A, B) = (Mat::from_rows(&[&[-rate]]), Mat::from_rows(&[&[rate]]));
    Ok(StateSpace::new(A, B, Mat::eye(1), Mat::zeros(1, 1), Timebase::Continuous)?)
}

/// Returns the controller from (demand, measured rate) with the position loop of a plant around it, from (demand, measured
/// position); `None` if the plant has no inner loop.
///
/// # Errors
/// A cascade without a positive gain of its position loop.
pub(crate) fn with_position_loop(
    plant: &DesignPlant,
    rate_controller: &StateSpace,
    position_gain: Option<f64>,
) -> Result<Option<StateSpace>, Error> {
    let Some(inner) = &plant.rate_loop else { return Ok(None) };
    let gain = position_gain.unwrap_or(0.0);
    if !(gain > 0.0 && gain.is_finite()) {
        return Err(Error::Range {
            what: "gain of the position loop in 1/s",
            value: gain,
            allowed: "positive",
        });
    }
    let front = outer_loop(gain, inner.period_s)?;
    Ok(Some(series(&front, &rate_controller.select(&[0], &[0, 1]))?))
}

/// From (demand, position) to (demanded rate, differenced position).
fn outer_loop(gain: f64, period_s: f64) -> Result<StateSpace, Error> {
    check_period(period_s)?;
    let rate = 2.0 / period_s;
    let (A, B) = (Mat::from_rows(&[&[-rate]]), Mat::from_rows(&[&[0.0, rate]]));
    let C = Mat::from_rows(&[&[0.0], &[-rate]]);
    let D = Mat::from_rows(&[&[gain, -gain], &[0.0, rate]]);
    Ok(StateSpace::new(A, B, C, D, Timebase::Continuous)?)
}

fn check_period(period_s: f64) -> Result<(), Error> {
    if period_s > 0.0 && period_s.is_finite() {
        return Ok(());
    }
    Err(Error::Range { what: "sample period in s", value: period_s, allowed: "positive" })
}

/// Returns a controller from (demand, reading) as one from (demand less reading, reading).
pub(crate) fn from_error_and_reading(controller: &StateSpace) -> StateSpace {
    let summed = |columns: &Mat| {
        Mat::from_fn(columns.nrows(), 2, |i, j| match j {
            0 => columns[(i, 0)],
            _ => columns[(i, 0)] + columns[(i, 1)],
        })
    };
    StateSpace { B: summed(&controller.B), D: summed(&controller.D), ..controller.clone() }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::{Discretisation, c2d};

    #[test]
    fn the_sampled_rate_is_the_difference_of_two_readings() {
        let period_s = 5e-4;
        let tustin = Discretisation::Tustin { prewarp_rad_s: None };
        let sampled = c2d(&outer_loop(20.0, period_s).unwrap(), period_s, tustin).unwrap();
        assert!(sampled.A[(0, 0)].abs() < 1e-15, "the state is the reading before: {:?}", sampled.A);
        let (direct, before) = (sampled.D[(1, 1)], sampled.C[(1, 0)] * sampled.B[(0, 1)]);
        assert!((direct * period_s - 1.0).abs() < 1e-12, "{direct}");
        assert!((before * period_s + 1.0).abs() < 1e-12, "{before}");
        assert_eq!((sampled.D[(0, 0)], sampled.D[(0, 1)]), (20.0, -20.0));
    }

    #[test]
    fn the_error_and_the_reading_carry_the_same_as_demand_and_reading() {
        let D = Mat::from_rows(&[&[3.0, -5.0]]);
        let found = from_error_and_reading(&StateSpace::gain(D, Timebase::Continuous).unwrap());
        let (demand, reading) = (0.7, 0.2);
        let expected = 3.0 * demand - 5.0 * reading;
        let answer = found.D[(0, 0)] * (demand - reading) + found.D[(0, 1)] * reading;
        assert!((answer - expected).abs() < 1e-12);
    }
}
