//! The motion that the loop's sensor shows at the start of a recording: a parabola through its first angles, or a line through its first rates.

use super::platform::{reading_floor, sensor_of};
use crate::tolerance::{FIRST_MOTION_ERRORS, FIRST_MOTION_LEFT, FIRST_MOTION_SAMPLES};
use counterpoise_models::{FeedbackSignal, Parameters, Sensor};
use counterpoise_recordings::{Channel, Recording};
use nalgebra::{Matrix3, Vector3};

/// Motion of the hub on the platform at the first sample.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FirstMotion {
    /// Angle, rad; `None` if the loop's sensor shows none.
    pub angle_rad: Option<f64>,
    /// Rate, rad/s.
    pub rate_rad_s: f64,
    /// Standard error of the rate from the sensor's noise and rounding, rad/s.
    rate_error_rad_s: f64,
    /// Acceleration, rad/s^2; 0 if the hub does not clearly move.
    pub acceleration_rad_s2: f64,
}

impl FirstMotion {
    /// Returns the motion; at rest if the sensor measures a torque or a current, if a reading is missing, or if no parabola follows the first
    /// readings, as where a step begins with the recording.
    pub fn of(parameters: &Parameters, recording: &Recording, platform_rate: f64) -> Self {
        let measured = parameters.sensors.measured;
        let read = recording.samples(Channel::HubRate).unwrap_or_default();
        let floor = sensor_of(parameters, Channel::HubRate)
            .map_or(0.0, |sensor| reading_floor(sensor, &parameters.interface));
        let follows = |count: &usize| {
            let read = read.get(..*count).filter(|read| read.iter().all(|v| v.is_finite()))?;
            let parabola = Parabola::fit(read, recording.sample_period_s)?;
            (parabola.left <= FIRST_MOTION_LEFT * floor).then_some(parabola)
        };
        let found = FIRST_MOTION_SAMPLES.iter().find_map(follows);
        let Some(parabola) = found.filter(|_| !measured.is_effort()) else { return Self::default() };
        let [level, slope, bend] = parabola.terms;
        let found = if measured.is_position() {
            Self {
                angle_rad: Some(level),
                rate_rad_s: slope,
                rate_error_rad_s: floor * parabola.errors[1],
                acceleration_rad_s2: 2.0 * bend,
            }
        } else {
            let of_platform = if measured == FeedbackSignal::HubRate { platform_rate } else { 0.0 };
            Self {
                angle_rad: None,
                rate_rad_s: level - of_platform,
                rate_error_rad_s: floor * parabola.errors[0],
                acceleration_rad_s2: slope,
            }
        };
        if found.is_moving() { found } else { Self { acceleration_rad_s2: 0.0, ..found } }
    }

    /// Returns output and slope of a sensor's filter whose input has a value and has moved as the readings do: y'' + 2 z w y' + w^2 y = w^2 r
    /// follows r = a t with y = a t - 2 z a / w.
    pub fn sensor_state(&self, input: f64, sensor: &Sensor) -> [f64; 2] {
        let lag_s = 2.0 * sensor.damping_ratio / sensor.natural_frequency_rad_s;
        let slope = self.slope();
        [input - lag_s * slope, slope]
    }

    /// Returns the rate of change of what the sensor measures, in its unit over s; 0 if the hub does not clearly move.
    fn slope(&self) -> f64 {
        if self.angle_rad.is_some() && self.is_moving() { self.rate_rad_s } else { self.acceleration_rad_s2 }
    }

    /// Returns whether the hub moves by more than the sensor's noise and rounding show of a hub at rest.
    pub fn is_moving(&self) -> bool {
        self.rate_rad_s.abs() > FIRST_MOTION_ERRORS * self.rate_error_rad_s
    }
}

/// y(t) = terms\[0\] + terms\[1\] t + terms\[2\] t^2, in least squares.
struct Parabola {
    terms: [f64; 3],
    /// Standard error of each term for readings with a noise of 1.
    errors: [f64; 3],
    /// RMS of what the parabola leaves.
    left: f64,
}

impl Parabola {
    /// Returns the parabola through samples of a period; `None` if they are too few.
    fn fit(samples: &[f64], period_s: f64) -> Option<Self> {
        // in units of the samples' span, in which the equations are well conditioned
        let span_s = samples.len() as f64 * period_s;
        let powers = |k: usize| {
            let t = k as f64 / samples.len() as f64;
            Vector3::new(1.0, t, t * t)
        };
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (k, sample) in samples.iter().enumerate() {
            let row = powers(k);
            matrix += row * row.transpose();
            right += row * *sample;
        }
        let inverse = matrix.try_inverse()?;
        let scales = [1.0, 1.0 / span_s, 1.0 / (span_s * span_s)];
        let found = inverse * right;
        let squared = |(k, sample): (usize, &f64)| (sample - powers(k).dot(&found)).powi(2);
        let freedom = samples.len().checked_sub(3).filter(|left| *left > 0)?;
        let left = (samples.iter().enumerate().map(squared).sum::<f64>() / freedom as f64).sqrt();
        Some(Self {
            left,
            terms: [0, 1, 2].map(|i| found[i] * scales[i]),
            errors: [0, 1, 2].map(|i| inverse[(i, i)].sqrt() * scales[i]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_found_and_its_errors_are_those_of_least_squares() {
        let value = |k: usize| 0.3 - 2.0 * (k as f64 * 1e-3) + 40.0 * (k as f64 * 1e-3).powi(2);
        let samples: Vec<f64> = (0..20).map(value).collect();
        let found = Parabola::fit(&samples, 1e-3).unwrap();
        for (term, expected) in found.terms.iter().zip([0.3, -2.0, 40.0]) {
            assert!((term / expected - 1.0).abs() < 1e-8, "{:?}", found.terms);
        }
        // the error of a parabola's slope at the first of n samples is about sqrt(192 / n^3) of a reading's noise over the period
        let slope = (192.0f64 / 8000.0).sqrt() / 1e-3;
        assert!((found.errors[1] / slope - 1.0).abs() < 0.2, "{:?}", found.errors);
    }
}
