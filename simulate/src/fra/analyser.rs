//! The analyser itself: mean, fundamental and harmonics of sampled signals over whole cycles.

use crate::Error;
use counterpoise_linalg as linalg;
use counterpoise_linalg::{C64, Mat};
use std::f64::consts::TAU;

/// Harmonics that are fitted beside the mean, the fundamental included.
pub const HARMONICS: usize = 5;

/// A periodic signal: mean + sum over k of Re(c_k exp(i k w t)) with t from the start of the window's first sample.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicSpectrum {
    /// Mean, the "DC" of an analyser.
    pub mean: f64,
    /// Complex amplitudes of the fundamental and its harmonics: c_1, c_2, ...
    pub harmonics: Vec<C64>,
    /// RMS of what is left: noise and what is not periodic.
    pub residual_rms: f64,
}

/// A response at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredResponse {
    /// Frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Output over input at the fundamental.
    pub value: C64,
    /// The input.
    pub input: HarmonicSpectrum,
    /// The output.
    pub output: HarmonicSpectrum,
    /// Whole cycles in the window.
    pub cycles: usize,
}

impl MeasuredResponse {
    /// Returns the gain, dB.
    pub fn gain_db(&self) -> f64 {
        20.0 * self.value.norm().log10()
    }

    /// Returns the phase, rad, from -pi to pi: atan2 of the parts, not the arc tangent of their ratio.
    pub fn phase_rad(&self) -> f64 {
        self.value.arg()
    }

    /// Returns the root of the sum of squares of the output's harmonics from the second on, relative to its fundamental.
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
pub fn harmonic_spectrum(
    samples: &[f64],
    period_s: f64,
    frequency_rad_s: f64,
) -> Result<HarmonicSpectrum, Error> {
    Harmonics::new(samples.len(), period_s, frequency_rad_s)?.spectrum(samples)
}

/// Mean, fundamental and harmonics at the samples of a window, for the spectra of many signals over windows of one length.
#[derive(Debug, Clone)]
pub(crate) struct Harmonics {
    /// Angle of the fundamental per sample, rad.
    step: f64,
    /// Harmonics, the fundamental included.
    count: usize,
    /// \[1, cos, sin, cos 2, sin 2, ...\] sample by sample.
    rows: Vec<f64>,
    /// Sum of the products of the rows with themselves, if no sample is left out.
    normal: Mat,
}

impl Harmonics {
    /// Returns them for windows of so many samples.
    ///
    /// # Errors
    /// A frequency that is not between 0 and the Nyquist frequency.
    pub fn new(samples: usize, period_s: f64, frequency_rad_s: f64) -> Result<Self, Error> {
        let step = frequency_rad_s * period_s;
        if !(step > 0.0 && step < 0.5 * TAU) {
            let allowed = "above 0 and below the Nyquist frequency";
            return Err(Error::Range { what: "frequency_rad_s", value: frequency_rad_s, allowed });
        }
        let count = HARMONICS.min(((0.5 * TAU / step).ceil() as usize - 1).max(1));
        let unknowns = 1 + 2 * count;
        let mut rows = Vec::with_capacity(samples * unknowns);
        (0..samples).for_each(|k| push_row(k, step, count, &mut rows));
        let normal = normal(rows.chunks_exact(unknowns), unknowns);
        Ok(Self { step, count, rows, normal })
    }

    /// Returns the number of samples in a window.
    pub fn samples(&self) -> usize {
        self.rows.len() / self.unknowns()
    }

    /// Returns the spectrum of the samples of a window; see [`harmonic_spectrum`].
    ///
    /// # Errors
    /// Fewer samples than unknowns, and a window in which they cannot be told apart.
    pub fn spectrum(&self, samples: &[f64]) -> Result<HarmonicSpectrum, Error> {
        let usable = samples.iter().filter(|y| y.is_finite()).count();
        if usable < self.unknowns() {
            let expected = self.unknowns();
            return Err(Error::Length { what: "the analyser's window", found: usable, expected });
        }
        let solution = self.fit(samples, usable)?;
        let harmonics =
            (0..self.count).map(|k| C64::new(solution[1 + 2 * k], -solution[2 + 2 * k])).collect();
        let left: f64 = self.usable_rows(samples).map(|(row, y)| (y - dot(row, &solution)).powi(2)).sum();
        Ok(HarmonicSpectrum { mean: solution[0], harmonics, residual_rms: (left / usable as f64).sqrt() })
    }

    fn unknowns(&self) -> usize {
        1 + 2 * self.count
    }

    /// The rows of the samples that are numbers, and those samples.
    fn usable_rows<'a>(&'a self, samples: &'a [f64]) -> impl Iterator<Item = (&'a [f64], &'a f64)> {
        self.rows.chunks_exact(self.unknowns()).zip(samples).filter(|(_, y)| y.is_finite())
    }

    fn fit(&self, samples: &[f64], usable: usize) -> Result<Vec<f64>, Error> {
        let n = self.unknowns();
        let mut right = Mat::zeros(n, 1);
        for (row, y) in self.usable_rows(samples) {
            right.column_mut(0).iter_mut().zip(row).for_each(|(sum, entry)| *sum += entry * y);
        }
        let partial =
            (usable < samples.len()).then(|| normal(self.usable_rows(samples).map(|(row, _)| row), n));
        let solution =
            linalg::solve(partial.as_ref().unwrap_or(&self.normal), &right).map_err(|_| Error::Range {
                what: "angle per sample, rad",
                value: self.step,
                allowed: "such that the window tells mean and harmonics apart",
            })?;
        Ok(solution.column(0).to_vec())
    }
}

/// Returns the response between two sampled signals over the last whole cycles of their common length, at most
/// `most_cycles`.
///
/// # Errors
/// As [`harmonic_spectrum`]; less than one cycle; an input without a fundamental.
pub fn cycle_response(
    input: &[f64],
    output: &[f64],
    period_s: f64,
    frequency_rad_s: f64,
    most_cycles: usize,
) -> Result<MeasuredResponse, Error> {
    let length = input.len().min(output.len());
    let analyser = Analyser::new(length, period_s, frequency_rad_s, most_cycles)?;
    analyser.response(&input[..length], &output[..length])
}

/// An analyser of signals of one length at one frequency.
#[derive(Debug, Clone)]
pub(crate) struct Analyser {
    frequency_rad_s: f64,
    cycles: usize,
    harmonics: Harmonics,
}

impl Analyser {
    /// Returns the analyser over the last whole cycles of signals of a length, at most `most_cycles`.
    ///
    /// # Errors
    /// As [`cycle_response`].
    pub fn new(
        length: usize,
        period_s: f64,
        frequency_rad_s: f64,
        most_cycles: usize,
    ) -> Result<Self, Error> {
        let per_cycle = TAU / (frequency_rad_s * period_s);
        let cycles = ((length as f64 + 0.5) / per_cycle).floor().min(most_cycles as f64);
        if !(cycles >= 1.0 && per_cycle.is_finite()) {
            let expected = if per_cycle.is_finite() { per_cycle.ceil() as usize } else { usize::MAX };
            return Err(Error::Length { what: "one cycle of the recording", found: length, expected });
        }
        let samples = ((cycles * per_cycle).round() as usize).min(length);
        let harmonics = Harmonics::new(samples, period_s, frequency_rad_s)?;
        Ok(Self { frequency_rad_s, cycles: cycles as usize, harmonics })
    }

    /// Returns the response between two signals of the analyser's length.
    ///
    /// # Errors
    /// An input without a fundamental, fewer samples than unknowns.
    pub fn response(&self, input: &[f64], output: &[f64]) -> Result<MeasuredResponse, Error> {
        let last = |signal: &[f64]| {
            let from = signal.len().saturating_sub(self.harmonics.samples());
            self.harmonics.spectrum(&signal[from..])
        };
        let (input, output) = (last(input)?, last(output)?);
        let (u, y) = (input.harmonics[0], output.harmonics[0]);
        if u.norm() == 0.0 {
            return Err(Error::Range { what: "amplitude of the input", value: 0.0, allowed: "above 0" });
        }
        Ok(MeasuredResponse {
            frequency_rad_s: self.frequency_rad_s,
            value: y / u,
            input,
            output,
            cycles: self.cycles,
        })
    }
}

/// Appends \[1, cos, sin, cos 2, sin 2, ...\] at sample k.
fn push_row(k: usize, step: f64, count: usize, rows: &mut Vec<f64>) {
    rows.push(1.0);
    let turn = C64::from_polar(1.0, (k as f64 * step) % TAU);
    let mut power = turn;
    for _ in 0..count {
        rows.extend([power.re, power.im]);
        power *= turn;
    }
}

/// Returns the sum of the products of rows with themselves.
fn normal<'a>(rows: impl Iterator<Item = &'a [f64]>, n: usize) -> Mat {
    let mut normal = Mat::zeros(n, n);
    for row in rows {
        for (j, factor) in row.iter().enumerate() {
            normal.column_mut(j).iter_mut().zip(row).for_each(|(sum, entry)| *sum += entry * factor);
        }
    }
    normal
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
        let found = harmonic_spectrum(&y, 1e-3, w).unwrap();
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
        let found = cycle_response(&input, &output, 1e-3, w, 100).unwrap();
        assert!((found.value - C64::from_polar(3.0, -0.8)).norm() < 1e-9);
        assert_eq!(found.cycles, 5);
    }

    #[test]
    fn samples_that_are_missing_are_left_out() {
        let w = 37.3;
        let exact = |k: i32| 5.0 + 2.0 * (w * f64::from(k) * 1e-3 + 0.3).cos();
        let harmonics = Harmonics::new(1000, 1e-3, w).unwrap();
        let gaps: Vec<f64> = (0..1000).map(|k| if k % 7 == 3 { f64::NAN } else { exact(k) }).collect();
        let found = harmonics.spectrum(&gaps).unwrap();
        assert!((found.mean - 5.0).abs() < 1e-10 && found.residual_rms < 1e-10);
        assert!((found.harmonics[0] - C64::from_polar(2.0, 0.3)).norm() < 1e-10);
        // a window without gaps does not remember those of the one before
        let whole: Vec<f64> = (0..1000).map(exact).collect();
        assert_eq!(harmonics.spectrum(&whole).unwrap(), harmonic_spectrum(&whole, 1e-3, w).unwrap());
    }
}
