//! Amplitude spectral densities of recorded channels and of what models leave of them.

use counterpoise_verify::signals::{WelchOptions, welch};

/// Segments of a record, at least: fewer leave a density that scatters by half of its size.
const FEWEST_SEGMENTS: usize = 8;
/// Samples of a segment at most: at a kilohertz the lowest frequency is then an eighth of a hertz.
const LONGEST_SEGMENT: usize = 8192;
/// Probability of the confidence interval, which is not shown.
const CONFIDENCE: f64 = 0.95;

/// An amplitude spectral density, by Welch's method.
#[derive(Debug, Clone, PartialEq)]
pub struct AmplitudeDensity {
    /// Frequencies, Hz, from the first above 0 to half of the sample rate.
    pub frequency_hz: Vec<f64>,
    /// Density, the unit of the series over the root of a hertz.
    pub density: Vec<f64>,
}

impl AmplitudeDensity {
    /// Returns the density of a series over its longest stretch without gaps: Hann windows that overlap by half, each less its mean. `None` if that is too
    /// short, or does not move.
    pub fn of(series: &[f64], sample_period_s: f64) -> Option<Self> {
        let stretches = series.split(|value| !value.is_finite());
        let longest = stretches.max_by_key(|stretch| stretch.len())?;
        let segment = (2 * longest.len() / (FEWEST_SEGMENTS + 1)).min(LONGEST_SEGMENT) / 2 * 2;
        let options = WelchOptions { segment, confidence: CONFIDENCE };
        let found = welch(longest, longest, sample_period_s, options).ok()?;
        let density = found.amplitude_density_of_x();
        let is_zero = density.iter().all(|value| *value == 0.0);
        // the mean of each segment is taken out, so that the first line says nothing
        (!is_zero)
            .then(|| Self { frequency_hz: found.frequency_hz[1..].to_vec(), density: density[1..].to_vec() })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_sine_and_white_noise_have_their_densities() {
        let period_s = 1e-3;
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        // even noise of width 1 has the variance 1/12, over 500 Hz
        let noise: Vec<f64> = (0..60_000).map(|_| uniform()).collect();
        let found = AmplitudeDensity::of(&noise, period_s).unwrap();
        let mean = found.density.iter().map(|d| d * d).sum::<f64>() / found.density.len() as f64;
        assert!((mean * 500.0 * 12.0 - 1.0).abs() < 0.03, "{mean}");
        // the power of a sine is in the lines about its frequency, whatever the gap in it
        let mut sine: Vec<f64> = (0..40_000).map(|k| 0.3 * (0.05 * f64::from(k)).sin()).collect();
        sine[3] = f64::NAN;
        let found = AmplitudeDensity::of(&sine, period_s).unwrap();
        let line = found.frequency_hz[1] - found.frequency_hz[0];
        let power: f64 = found.density.iter().map(|d| d * d * line).sum();
        assert!((power / 0.045 - 1.0).abs() < 1e-3, "{power}");
        let peak =
            (0..found.density.len()).max_by(|&a, &b| found.density[a].total_cmp(&found.density[b])).unwrap();
        assert!((found.frequency_hz[peak] - 50.0 / std::f64::consts::TAU).abs() < line);
        assert_eq!(AmplitudeDensity::of(&[0.0; 4000], period_s), None);
        assert_eq!(AmplitudeDensity::of(&noise[..20], period_s), None);
        assert_eq!(AmplitudeDensity::of(&[], period_s), None);
    }
}
