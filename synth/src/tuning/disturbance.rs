//! The disturbance of the loop that is tuned: a line spectrum at the plant's output, and the noise of the reading.

use crate::Error;

/// Disturbance that acts on a loop. The rate that it leaves is the square root of `sum power |S|^2 + noise^2 mean |T|^2`.
#[derive(Debug, Clone, PartialEq)]
pub struct Disturbance {
    /// Frequency in rad/s and power in (rad/s)^2 of each line of the rate that would be there without feedback.
    pub lines: Vec<[f64; 2]>,
    /// RMS of the white noise of a reading, rad/s.
    pub reading_noise_rad_s: f64,
}

/// Lines of a band that is weighted evenly.
const BAND_LINES: usize = 96;

impl Disturbance {
    /// Returns a disturbance of unit power that is spread evenly over the logarithm of frequency in a band: the rate that it leaves
    /// is the RMS of |S| over the band.
    pub fn of_band([low, high]: [f64; 2]) -> Self {
        let rate = |k: usize| low * (high / low).powf((k as f64 + 0.5) / BAND_LINES as f64);
        let lines = (0..BAND_LINES).map(|k| [rate(k), 1.0 / BAND_LINES as f64]).collect();
        Self { lines, reading_noise_rad_s: 0.0 }
    }

    /// Refuses a disturbance that leaves nothing to minimise.
    pub(crate) fn check(&self, highest_rad_s: f64) -> Result<(), Error> {
        let is_good = |line: &[f64; 2]| line[0] > 0.0 && line[0] < highest_rad_s && line[1] >= 0.0;
        if !self.lines.iter().all(is_good) {
            let problem =
                "its lines must lie above 0 and below half the sample rate, with powers of 0 or more";
            return Err(Error::System { what: "disturbance", problem });
        }
        let power: f64 = self.lines.iter().map(|line| line[1]).sum();
        if power > 0.0 && power.is_finite() {
            return Ok(());
        }
        Err(Error::System { what: "disturbance", problem: "it has no power: nothing moves the mechanism" })
    }
}
