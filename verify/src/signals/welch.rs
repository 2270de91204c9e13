//! Spectra and the transfer from x to y by Welch's method, with coherence and confidence.

use std::f64::consts::PI;

use num_complex::Complex64;
use realfft::RealFftPlanner;

use super::{check_finite, check_length, mean};
use crate::Error;
use crate::tolerance::{FEWEST_DEGREES_OF_FREEDOM, FEWEST_SAMPLES_A_SEGMENT};

/// Squared correlation of neighbouring Hann segments that overlap by half: (1/6)^2.
const OVERLAP_CORRELATION: f64 = 1.0 / 36.0;

/// Division of a record into segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WelchOptions {
    /// Samples in a segment; even.
    pub segment: usize,
    /// Probability that a confidence interval holds the truth, for example 0.95.
    pub confidence: f64,
}

/// One-sided spectra and the transfer from x to y. The vectors run over the same frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectra {
    /// Frequencies, Hz, from 0 to half the sample rate.
    pub frequency_hz: Vec<f64>,
    /// Power spectral density of x, unit of x squared per Hz.
    pub pxx: Vec<f64>,
    /// Power spectral density of y, unit of y squared per Hz.
    pub pyy: Vec<f64>,
    /// Pxy / Pxx: gain and phase from x to y.
    pub transfer: Vec<Complex64>,
    /// |Pxy|^2 / (Pxx Pyy), 0 to 1.
    pub coherence: Vec<f64>,
    /// Radius of the disk about `transfer` that holds the truth with the asked probability.
    pub radius: Vec<f64>,
    /// 20 log10 |Pxy / Pxx|, dB: the disturbance rejection ratio where x is the platform's motion and y the hub's.
    pub ratio_db: Vec<f64>,
    /// The lower and upper limit of the ratio in dB; the lower limit is minus infinity if the disk holds 0.
    pub interval_db: Vec<[f64; 2]>,
    /// Phase of Pxy / Pxx, degrees from -180 to 180.
    pub phase_deg: Vec<f64>,
    /// Number of segments that were averaged.
    pub segments: usize,
}

impl Spectra {
    /// Returns the amplitude spectral density of x, unit of x per root of a hertz.
    pub fn amplitude_density_of_x(&self) -> Vec<f64> {
        self.pxx.iter().map(|power| power.sqrt()).collect()
    }
}

/// Averages Hann-windowed segments that overlap by half, each less its mean:
///
/// ```text
///     Pxx = c sum |X_k|^2    Pyy = c sum |Y_k|^2    Pxy = c sum conj(X_k) Y_k
///     |H - Pxy/Pxx|^2 <= (alpha^(-2/(n-2)) - 1) (1 - coherence) Pyy / Pxx      with probability 1 - alpha
/// ```
///
/// n is twice the number of independent averages (overlap counted after Welch 1967); the disk is that of Bendat and Piersol,
/// *Random Data*, section 9.2, with the F quantile for 2 and n - 2 degrees of freedom in closed form.
///
/// # Errors
/// [`Error::Length`] if the series differ or hold fewer than two segments, [`Error::NotFinite`], [`Error::Range`] for a segment
/// that is odd or short, a sample period that is not positive or a confidence outside (0, 1).
pub fn welch(x: &[f64], y: &[f64], sample_period_s: f64, options: WelchOptions) -> Result<Spectra, Error> {
    check(x, y, sample_period_s, options)?;
    let segment = options.segment;
    let window: Vec<f64> =
        (0..segment).map(|k| 0.5 - 0.5 * (2.0 * PI * k as f64 / segment as f64).cos()).collect();
    let mut sums = Sums::new(segment / 2 + 1);
    let mut transform = Transform::new(segment);
    let mut start = 0;
    while start + segment <= x.len() {
        let spectrum_x = transform.of(&x[start..start + segment], &window);
        let spectrum_y = transform.of(&y[start..start + segment], &window);
        sums.add(&spectrum_x, &spectrum_y);
        start += segment / 2;
    }
    // realfft normalises nothing: the window's power and the sample rate make a density
    let power: f64 = window.iter().map(|w| w * w).sum();
    Ok(sums.finish(sample_period_s / power, 1.0 / (segment as f64 * sample_period_s), options.confidence))
}

fn check(x: &[f64], y: &[f64], sample_period_s: f64, options: WelchOptions) -> Result<(), Error> {
    check_length("y beside x", y.len(), x.len())?;
    check_finite("x", x)?;
    check_finite("y", y)?;
    let segment = options.segment;
    if segment < FEWEST_SAMPLES_A_SEGMENT || segment % 2 == 1 {
        return Err(Error::Range { what: "segment", value: segment as f64, allowed: "even and at least 8" });
    }
    if x.len() < segment + segment / 2 {
        return Err(Error::Length {
            what: "series for spectra",
            found: x.len(),
            needed: segment + segment / 2,
        });
    }
    if !(sample_period_s > 0.0 && sample_period_s.is_finite()) {
        return Err(Error::Range {
            what: "sample period",
            value: sample_period_s,
            allowed: "positive, in s",
        });
    }
    if !(options.confidence > 0.0 && options.confidence < 1.0) {
        return Err(Error::Range {
            what: "confidence",
            value: options.confidence,
            allowed: "between 0 and 1",
        });
    }
    Ok(())
}

struct Transform {
    plan: std::sync::Arc<dyn realfft::RealToComplex<f64>>,
    input: Vec<f64>,
}

impl Transform {
    fn new(segment: usize) -> Self {
        Self { plan: RealFftPlanner::new().plan_fft_forward(segment), input: vec![0.0; segment] }
    }

    /// The spectrum of a segment less its mean, windowed. The lengths fit by construction, so the transform cannot fail.
    fn of(&mut self, samples: &[f64], window: &[f64]) -> Vec<Complex64> {
        let middle = mean(samples);
        for (k, value) in samples.iter().enumerate() {
            self.input[k] = (value - middle) * window[k];
        }
        let mut output = self.plan.make_output_vec();
        let done = self.plan.process(&mut self.input, &mut output);
        debug_assert!(done.is_ok(), "lengths fit");
        output
    }
}

struct Sums {
    xx: Vec<f64>,
    yy: Vec<f64>,
    xy: Vec<Complex64>,
    count: usize,
}

impl Sums {
    fn new(bins: usize) -> Self {
        Self { xx: vec![0.0; bins], yy: vec![0.0; bins], xy: vec![Complex64::new(0.0, 0.0); bins], count: 0 }
    }

    fn add(&mut self, x: &[Complex64], y: &[Complex64]) {
        for k in 0..x.len() {
            self.xx[k] += x[k].norm_sqr();
            self.yy[k] += y[k].norm_sqr();
            self.xy[k] += x[k].conj() * y[k];
        }
        self.count += 1;
    }

    fn finish(self, density: f64, spacing_hz: f64, confidence: f64) -> Spectra {
        let last = self.xx.len() - 1;
        let segments = self.count as f64;
        let one_sided =
            |k: usize| if k == 0 || k == last { density / segments } else { 2.0 * density / segments };
        let independent = segments / (1.0 + 2.0 * OVERLAP_CORRELATION * (segments - 1.0) / segments);
        let freedom = (2.0 * independent - 2.0).max(FEWEST_DEGREES_OF_FREEDOM);
        let quantile = (1.0 - confidence).powf(-2.0 / freedom) - 1.0;
        let coherence: Vec<f64> =
            (0..=last).map(|k| coherence_of(self.xx[k], self.yy[k], self.xy[k])).collect();
        let leftover = |k: usize| quantile * (1.0 - coherence[k]).max(0.0) * ratio(self.yy[k], self.xx[k]);
        let transfer: Vec<Complex64> = (0..=last).map(|k| self.xy[k] * ratio(1.0, self.xx[k])).collect();
        let radius: Vec<f64> = (0..=last).map(|k| leftover(k).sqrt()).collect();
        let interval = |(h, r): (&Complex64, &f64)| {
            [20.0 * (h.norm() - r).max(0.0).log10(), 20.0 * (h.norm() + r).log10()]
        };
        Spectra {
            ratio_db: transfer.iter().map(|h| 20.0 * h.norm().log10()).collect(),
            interval_db: transfer.iter().zip(&radius).map(interval).collect(),
            phase_deg: transfer.iter().map(|h| h.arg().to_degrees()).collect(),
            frequency_hz: (0..=last).map(|k| k as f64 * spacing_hz).collect(),
            pxx: (0..=last).map(|k| self.xx[k] * one_sided(k)).collect(),
            pyy: (0..=last).map(|k| self.yy[k] * one_sided(k)).collect(),
            transfer,
            radius,
            coherence,
            segments: self.count,
        }
    }
}

/// a / b, and 0 if b is 0: a bin without excitation says nothing.
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

fn coherence_of(xx: f64, yy: f64, xy: Complex64) -> f64 {
    let both = xx * yy;
    if both > 0.0 { (xy.norm_sqr() / both).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// White, unit variance: sums of a linear congruential generator's numbers.
    fn white(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    const OPTIONS: WelchOptions = WelchOptions { segment: 512, confidence: 0.95 };

    #[test]
    fn the_density_of_white_noise_integrates_to_its_variance() {
        let x = white(1, 100_000);
        let found = welch(&x, &x, 1e-3, OPTIONS).unwrap();
        let power: f64 = found.pxx.iter().sum::<f64>() * found.frequency_hz[1];
        assert!((power - 1.0).abs() < 0.03, "{power}");
        assert!(found.coherence.iter().all(|&c| (c - 1.0).abs() < 1e-12));
    }

    #[test]
    fn a_known_filter_lies_in_its_confidence_disk_as_often_as_promised() {
        let x = white(2, 40_000);
        let noise = white(3, 40_000);
        let mut y = vec![0.0; x.len()];
        for k in 1..x.len() {
            y[k] = 0.9 * y[k - 1] + 0.1 * x[k];
        }
        let measured: Vec<f64> = y.iter().zip(&noise).map(|(a, b)| a + 0.1 * b).collect();
        let found = welch(&x, &measured, 1e-3, OPTIONS).unwrap();
        let inside = (2..255).filter(|&k| {
            let z = Complex64::from_polar(1.0, 2.0 * PI * found.frequency_hz[k] * 1e-3);
            (found.transfer[k] - 0.1 / (1.0 - 0.9 / z)).norm() <= found.radius[k]
        });
        let share = inside.count() as f64 / 253.0;
        assert!((0.90..=0.99).contains(&share), "{share}");
    }

    #[test]
    fn short_records_are_refused() {
        assert!(matches!(
            welch(&[0.0; 600], &[0.0; 600], 1e-3, OPTIONS),
            Err(Error::Length { needed: 768, .. })
        ));
        assert!(matches!(welch(&[0.0; 600], &[0.0; 599], 1e-3, OPTIONS), Err(Error::Length { .. })));
    }
}
