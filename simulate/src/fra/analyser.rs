//! The analyser itself: mean, fundamental and harmonics of sampled signals over whole cycles.

use crate::Error;
use counterpoise_lti::C64;
use counterpoise_lti::Mat;
use counterpoise_lti::linalg;
use std::f64::consts::TAU;

/// Harmonics that are fitted beside the mean, the fundamental included.
pub const HARMONICS: usize = 5;

/// A periodic signal: mean + sum over k of Re(c_k exp(i k w t)) with t from the start of the window's first sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Mean, the "DC" of an analyser.
    pub mean: f64,
    /// Complex amplitudes of the fundamental and its harmonics: c_1, c_2, ...
    pub harmonics: Vec<C64>,
    /// RMS of what is left: noise and what is not periodic.
    pub residual_rms: f64,
}

/// A response at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Output over input at the fundamental.
    pub value: C64,
    /// The input.
    pub input: Spectrum,
    /// The output.
    pub output: Spectrum,
    /// Whole cycles in the window.
    pub cycles: usize,
}

impl Response {
    /// Gain, dB.
    pub fn gain_db(&self) -> f64 {
        20.0 * self.value.norm().log10()
    }

    /// Phase, rad, from -pi to pi: atan2 of the parts, not the arc tangent of their ratio.
    pub fn phase_rad(&self) -> f64 {
        self.value.arg()
    }

    /// Root of the sum of squares of the output's harmonics from the second on, relative to its fundamental.
    pub fn distortion(&self) -> f64 {
        let squares = |part: &[C64]| part.iter().map(C64::norm_sqr).sum::<f64>();
        let Some((fundamental, rest)) = self.output.harmonics.split_first() else { return 0.0 };
        if fundamental.norm_sqr() > 0.0 { (squares(rest) / fundamental.norm_sqr()).sqrt() } else { 0.0 }
    }
}

/// Returns the spectrum of samples by least squares on the mean, the fundamental and its harmonics below the Nyquist
/// frequency. Over whole cycles this is the correlation with sine and cosine that an analyser performs; it needs no
/// whole number of samples a cycle, and a mean does not leak into it. Samples that are NaN are left out.
///
/// # Errors
/// A frequency that is not between 0 and the Nyquist frequency, fewer samples than unknowns.
pub fn spectrum(samples: &[f64], period_s: f64, frequency_rad_s: f64) -> Result<Spectrum, Error> {
    let step = frequency_rad_s * period_s;
    if !(step > 0.0 && step < 0.5 * TAU) {
        let allowed = "above 0 and below the Nyquist frequency";
        return Err(Error::Range { what: "frequency_rad_s", value: frequency_rad_s, allowed });
    }
    let count = HARMONICS.min(((0.5 * TAU / step).ceil() as usize - 1).max(1));
    let unknowns = 1 + 2 * count;
    let usable = samples.iter().filter(|y| y.is_finite()).count();
    if usable < unknowns {
        return Err(Error::Length { what: "the analyser's window", found: usable, expected: unknowns });
    }
    let solution = fit(samples, step, count)?;
    let harmonics = (0..count).map(|k| C64::new(solution[1 + 2 * k], -solution[2 + 2 * k])).collect();
    let left: f64 = samples
        .iter()
        .enumerate()
        .filter(|(_, y)| y.is_finite())
        .map(|(k, y)| (y - dot(&regressors(k, step, count), &solution)).powi(2))
        .sum();
    Ok(Spectrum { mean: solution[0], harmonics, residual_rms: (left / usable as f64).sqrt() })
}

/// Returns the response between two sampled signals over the last whole cycles of their common length, at most
/// `most_cycles`.
///
/// # Errors
/// As [`spectrum`]; less than one cycle; an input without a fundamental.
pub fn response(
    input: &[f64],
    output: &[f64],
    period_s: f64,
    frequency_rad_s: f64,
    most_cycles: usize,
) -> Result<Response, Error> {
    let length = input.len().min(output.len());
    let per_cycle = TAU / (frequency_rad_s * period_s);
    let cycles = ((length as f64 + 0.5) / per_cycle).floor().min(most_cycles as f64);
    if !(cycles >= 1.0 && per_cycle.is_finite()) {
        let expected = if per_cycle.is_finite() { per_cycle.ceil() as usize } else { usize::MAX };
        return Err(Error::Length { what: "one cycle of the recording", found: length, expected });
    }
    let window = length - ((cycles * per_cycle).round() as usize).min(length);
    let input = spectrum(&input[window..length], period_s, frequency_rad_s)?;
    let output = spectrum(&output[window..length], period_s, frequency_rad_s)?;
    let (u, y) = (input.harmonics[0], output.harmonics[0]);
    if u.norm() == 0.0 {
        return Err(Error::Range { what: "amplitude of the input", value: 0.0, allowed: "above 0" });
    }
    Ok(Response { frequency_rad_s, value: y / u, input, output, cycles: cycles as usize })
}

/// [1, cos, sin, cos 2, sin 2, ...] at sample k.
fn regressors(k: usize, step: f64, count: usize) -> Vec<f64> {
    let mut row = Vec::with_capacity(1 + 2 * count);
    row.push(1.0);
    let turn = C64::from_polar(1.0, (k as f64 * step) % TAU);
    let mut power = turn;
    for _ in 0..count {
        row.extend([power.re, power.im]);
        power *= turn;
    }
    row
}

fn fit(samples: &[f64], step: f64, count: usize) -> Result<Vec<f64>, Error> {
    let n = 1 + 2 * count;
    let (mut normal, mut right) = (Mat::zeros(n, n), Mat::zeros(n, 1));
    for (k, y) in samples.iter().enumerate().filter(|(_, y)| y.is_finite()) {
        let row = regressors(k, step, count);
        for i in 0..n {
            right[(i, 0)] += row[i] * y;
            for j in 0..n {
                normal[(i, j)] += row[i] * row[j];
            }
        }
    }
    let solution = linalg::solve(&normal, &right).map_err(|_| Error::Range {
        what: "angle per sample, rad",
        value: step,
        allowed: "such that the window tells mean and harmonics apart",
    })?;
    Ok(solution.column(0).to_vec())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_mean_and_harmonics_are_told_apart() {
        let w = 37.3;
        let y: Vec<f64> = (0..1000)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| 5.0 + 2.0 * (w * t + 0.3).cos() + 0.1 * (3.0 * w * t).sin())
            .collect();
        let found = spectrum(&y, 1e-3, w).unwrap();
        assert!((found.mean - 5.0).abs() < 1e-10);
        assert!((found.harmonics[0] - C64::from_polar(2.0, 0.3)).norm() < 1e-10);
        assert!((found.harmonics[2] - C64::new(0.0, -0.1)).norm() < 1e-10);
        assert!(found.residual_rms < 1e-10);
    }

    #[test]
    fn the_response_is_the_ratio_whatever_the_offset() {
        let w = 12.0;
        let sample = |f: &dyn Fn(f64) -> f64| (0..3000).map(|k| f(f64::from(k) * 1e-3)).collect::<Vec<f64>>();
        let input = sample(&|t| 0.5 * (w * t).sin());
        let output = sample(&|t| 7.0 + 1.5 * (w * t - 0.8).sin());
        let found = response(&input, &output, 1e-3, w, 100).unwrap();
        assert!((found.value - C64::from_polar(3.0, -0.8)).norm() < 1e-9);
        assert_eq!(found.cycles, 5);
    }
}
