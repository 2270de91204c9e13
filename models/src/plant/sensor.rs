//! Sensors as linear systems.

use crate::Error;
use crate::parameters::Sensor;
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

impl Sensor {
    /// Returns the sensor's dynamics with its gain: gain w^2 / (s^2 + 2 z w s + w^2), with the states [reading / gain, its
    /// derivative]; the gain alone if the natural frequency is infinite. Bias, delay and noise are left out.
    ///
    /// # Errors
    /// A natural frequency, damping or gain that is not a number.
    pub fn dynamics(&self) -> Result<StateSpace, Error> {
        let gain = Mat::from_rows(&[&[self.gain]]);
        if self.natural_frequency_rad_s.is_infinite() {
            return Ok(StateSpace::gain(gain, Timebase::Continuous)?);
        }
        let (w, z) = (self.natural_frequency_rad_s, self.damping_ratio);
        let A = Mat::from_rows(&[&[0.0, 1.0], &[-w * w, -2.0 * z * w]]);
        let B = Mat::col(&[0.0, w * w]);
        let C = Mat::row(&[self.gain, 0.0]);
        Ok(StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous)?)
    }
}
