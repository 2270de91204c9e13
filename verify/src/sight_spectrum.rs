//! The spectrum of the line of sight: how the mean square of its error is divided over frequency.
//!
//! An estimate by sine tapers (K. Riedel and A. Sidorenko, IEEE Transactions on Signal Processing 43, 1995, p. 188): unlike a window of
//! constant height they do not smear a slow drift over all frequencies, and unlike one window that fades to both ends a few of them together use
//! the whole record. The estimate is scaled to the mean square of the record, so that the sum over all bands is the square of the RMS, exactly.

use num_complex::Complex64;
use realfft::RealFftPlanner;

use crate::line_of_sight::SightAngles;
use crate::signals::rms;
use crate::signals::statistics::subtract_mean;
use crate::tolerance::{SIGHT_BANDS_A_DECADE, SIGHT_TAPERS};

/// Bands of frequency that cover a record: each holds a whole number of the frequencies of its Fourier transform.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// Edges, Hz, one more than bands: from 0 to half the sample rate.
    pub edges_hz: Vec<f64>,
    /// The first frequency of the transform in each band, and behind them their number.
    first: Vec<usize>,
    samples: usize,
    period_s: f64,
}

/// The mean square of the error in each band, rad^2.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SightSpectrum {
    /// At the hub.
    pub hub_rad2: Vec<f64>,
    /// At the tip.
    pub tip_rad2: Vec<f64>,
    /// Of the tip against the hub.
    pub bending_rad2: Vec<f64>,
}

impl Bands {
    /// Returns the bands of a record: the lowest as wide as the tapers resolve, the others [`SIGHT_BANDS_A_DECADE`] a decade, as far as the
    /// record resolves them.
    pub fn of(samples: usize, period_s: f64) -> Self {
        let last = samples / 2;
        let ratio = 10f64.powf(1.0 / SIGHT_BANDS_A_DECADE);
        // the tapers resolve (K + 1) / 2 steps of the transform to either side
        let mut next = (SIGHT_TAPERS + 1).div_ceil(2);
        let mut first = vec![0];
        while next <= last {
            first.push(next);
            next = (next + 1).max((next as f64 * ratio).round() as usize);
        }
        let step_hz = 1.0 / (samples.max(1) as f64 * period_s);
        let edge = |k: &usize| if *k == 0 { 0.0 } else { (*k as f64 - 0.5) * step_hz };
        let edges_hz = first.iter().map(edge).chain([0.5 / period_s]).collect();
        first.push(last + 1);
        Self { edges_hz, first, samples, period_s }
    }

    /// Returns the number of bands.
    pub fn len(&self) -> usize {
        self.edges_hz.len() - 1
    }

    /// Returns whether there is no band, which no record has.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the length of the record, s.
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 * self.period_s
    }

    /// Returns the spectrum of angles as long as the record.
    pub fn spectrum(&self, angles: &SightAngles) -> SightSpectrum {
        let bending: Vec<f64> =
            angles.tip_rad.iter().zip(&angles.hub_rad).map(|(tip, hub)| tip - hub).collect();
        SightSpectrum {
            hub_rad2: self.mean_squares(&angles.hub_rad),
            tip_rad2: self.mean_squares(&angles.tip_rad),
            bending_rad2: self.mean_squares(&bending),
        }
    }

    /// Returns the mean square of a record about its mean, in each band.
    fn mean_squares(&self, record: &[f64]) -> Vec<f64> {
        let record = subtract_mean(record);
        let total = rms(&record).powi(2);
        let mut sums = vec![0.0; self.len()];
        let plan = RealFftPlanner::<f64>::new().plan_fft_forward(record.len().max(1));
        let mut output = plan.make_output_vec();
        for taper in 1..=SIGHT_TAPERS {
            let angle = std::f64::consts::PI * taper as f64 / (record.len() + 1) as f64;
            let mut tapered: Vec<f64> =
                record.iter().enumerate().map(|(n, value)| value * (angle * (n + 1) as f64).sin()).collect();
            if plan.process(&mut tapered, &mut output).is_ok() {
                self.add(&output, &mut sums);
            }
        }
        let estimated: f64 = sums.iter().sum();
        let scale = if estimated > 0.0 { total / estimated } else { 0.0 };
        sums.into_iter().map(|sum| scale * sum).collect()
    }

    fn add(&self, transform: &[Complex64], sums: &mut [f64]) {
        for (sum, range) in sums.iter_mut().zip(self.first.windows(2)) {
            let last = range[1].min(transform.len());
            // frequencies between the ends stand for their negatives, too
            let is_end = |k: usize| k == 0 || 2 * k == self.samples;
            *sum += (range[0]..last)
                .map(|k| if is_end(k) { 1.0 } else { 2.0 } * transform[k].norm_sqr())
                .sum::<f64>();
        }
    }
}

impl SightSpectrum {
    /// Returns a spectrum of a number of bands in which nothing moves.
    pub fn at_rest(bands: usize) -> Self {
        Self { hub_rad2: vec![0.0; bands], tip_rad2: vec![0.0; bands], bending_rad2: vec![0.0; bands] }
    }

    /// Returns the sum of this spectrum and a multiple of another.
    #[must_use]
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + factor * b).collect();
        Self {
            hub_rad2: sum(&self.hub_rad2, &other.hub_rad2),
            tip_rad2: sum(&self.tip_rad2, &other.tip_rad2),
            bending_rad2: sum(&self.bending_rad2, &other.bending_rad2),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::TAU;

    fn angles(hub: impl Fn(f64) -> f64, samples: usize) -> SightAngles {
        let hub_rad: Vec<f64> = (0..samples).map(|k| hub(1e-3 * k as f64)).collect();
        SightAngles { period_s: 1e-3, tip_rad: hub_rad.iter().map(|hub| 3.0 * hub).collect(), hub_rad }
    }

    #[test]
    fn bands_cover_every_frequency_once() {
        for samples in [2, 3, 10, 101, 1000, 20_001] {
            let bands = Bands::of(samples, 1e-3);
            assert_eq!((bands.first[0], *bands.first.last().unwrap()), (0, samples / 2 + 1));
            assert!(bands.first.windows(2).all(|pair| pair[0] < pair[1]), "{samples}");
            assert!(bands.edges_hz.windows(2).all(|pair| pair[0] < pair[1]), "{samples}: {bands:?}");
            assert_eq!((bands.edges_hz[0], *bands.edges_hz.last().unwrap()), (0.0, 500.0));
        }
    }

    #[test]
    fn the_bands_add_up_to_the_mean_square() {
        for samples in [2, 57, 1000, 4001] {
            let of = |t: f64| (TAU * 3.0 * t).sin() + 0.2 * (TAU * 71.0 * t).cos() + 4.0 * t;
            let angles = angles(of, samples);
            let found = Bands::of(samples, 1e-3).spectrum(&angles);
            let expected = rms(&subtract_mean(&angles.hub_rad)).powi(2);
            for (bands, factor) in
                [(&found.hub_rad2, 1.0), (&found.tip_rad2, 9.0), (&found.bending_rad2, 4.0)]
            {
                let sum: f64 = bands.iter().sum();
                assert!((sum / (factor * expected) - 1.0).abs() < 1e-12, "{samples}: {sum} {expected}");
            }
        }
    }

    /// Two sines: each in its own band and its neighbours, with its own mean square.
    #[test]
    fn a_sine_stays_near_its_frequency() {
        let (samples, hz) = (10_000, [2.0, 40.0]);
        let angles = angles(|t| (TAU * hz[0] * t).sin() + 0.1 * (TAU * hz[1] * t).cos(), samples);
        let bands = Bands::of(samples, 1e-3);
        let found = bands.spectrum(&angles).hub_rad2;
        for (hz, expected) in hz.into_iter().zip([0.5, 0.005]) {
            let near = |edges: &[f64]| edges[1] > 0.8 * hz && edges[0] < 1.25 * hz;
            let inside: f64 = bands
                .edges_hz
                .windows(2)
                .zip(&found)
                .filter(|(edges, _)| near(edges))
                .map(|(_, power)| power)
                .sum();
            assert!((inside / expected - 1.0).abs() < 0.02, "{hz}: {inside} {expected}");
        }
    }

    /// A slow drift does not hide what is fast: a taper that falls to 0 with a slope leaves 1/f^4 of a straight line, 1e-7 of it above 100 periods of the
    /// record. A window of constant height leaves 1/f^2, 1e-2 of it.
    #[test]
    fn a_drift_stays_at_low_frequency() {
        let bands = Bands::of(10_000, 1e-3);
        let found = bands.spectrum(&angles(|t| t, 10_000)).hub_rad2;
        let total: f64 = found.iter().sum();
        let fast: f64 =
            bands.edges_hz.iter().zip(&found).filter(|(low, _)| **low > 10.0).map(|(_, power)| power).sum();
        assert!(fast < 1e-6 * total, "{fast} {total}");
    }
}
