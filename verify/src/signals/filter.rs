//! A zero-phase low-pass filter, for platform motion recorded on a lighter vehicle.

use std::f64::consts::PI;

use super::{check_finite, mean};
use crate::Error;

/// Second-order sections in each direction: a Butterworth filter of order 4.
const SECTIONS: usize = 2;

/// A Butterworth low-pass of order 4, run forwards and backwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowPass {
    /// Frequency at which the amplitude of both passes together is one half, Hz.
    pub half_amplitude_hz: f64,
}

/// b0 (1 + 2 z^-1 + z^-2) / (1 + a1 z^-1 + a2 z^-2).
#[derive(Debug, Clone, Copy)]
struct Section {
    b0: f64,
    a1: f64,
    a2: f64,
}

/// Low-passes `samples` without shifting them: a Butterworth filter of order 4 (bilinear, frequency prewarped) forwards and then
/// backwards, the ends continued by point reflection. The amplitude at a frequency f is 1 / (1 + (f/f0)^8) up to warping.
///
/// # Errors
/// [`Error::Range`] if the frequency is not between 0 and half the sample rate, [`Error::NotFinite`].
pub fn low_pass(samples: &[f64], sample_period_s: f64, filter: LowPass) -> Result<Vec<f64>, Error> {
    check_finite("signal to low-pass", samples)?;
    let relative = filter.half_amplitude_hz * sample_period_s;
    if !(relative > 0.0 && relative < 0.5) {
        let allowed = "between 0 and half the sample rate";
        return Err(Error::Range {
            what: "low-pass frequency in Hz",
            value: filter.half_amplitude_hz,
            allowed,
        });
    }
    let pad = ((3.0 / relative).ceil() as usize).min(samples.len().saturating_sub(1));
    let mut signal = reflect_ends(samples, pad);
    for _ in 0..2 {
        for section in sections(relative) {
            run(section, &mut signal);
        }
        signal.reverse();
    }
    Ok(signal[pad..pad + samples.len()].to_vec())
}

fn sections(relative: f64) -> [Section; SECTIONS] {
    let k = (PI * relative).tan();
    std::array::from_fn(|i| {
        let damping = 2.0 * (PI * (2 * i + 1) as f64 / (4 * SECTIONS) as f64).sin();
        let scale = 1.0 + damping * k + k * k;
        Section {
            b0: k * k / scale,
            a1: 2.0 * (k * k - 1.0) / scale,
            a2: (1.0 - damping * k + k * k) / scale,
        }
    })
}

/// Transposed direct form II, started in the steady state of the first sample.
fn run(section: Section, signal: &mut [f64]) {
    let Section { b0, a1, a2 } = section;
    let first = signal.first().copied().unwrap_or(0.0);
    let mut s2 = (b0 - a2) * first;
    let mut s1 = (2.0 * b0 - a1) * first + s2;
    for value in signal {
        let x = *value;
        let y = b0 * x + s1;
        s1 = 2.0 * b0 * x - a1 * y + s2;
        s2 = b0 * x - a2 * y;
        *value = y;
    }
}

/// The series with `pad` samples on each side, reflected through its end points.
fn reflect_ends(samples: &[f64], pad: usize) -> Vec<f64> {
    let Some((&first, &last)) = samples.first().zip(samples.last()) else { return Vec::new() };
    let before = (1..=pad).rev().map(|k| 2.0 * first - samples[k]);
    let after = (1..=pad).map(|k| 2.0 * last - samples[samples.len() - 1 - k]);
    before.chain(samples.iter().copied()).chain(after).collect()
}

/// Returns the samples less their mean, faded in and out over `fade_s` seconds by half a cosine, so that a simulation starts from rest.
pub fn from_rest(samples: &[f64], sample_period_s: f64, fade_s: f64) -> Vec<f64> {
    let middle = mean(samples);
    let length = samples.len();
    let weight = |k: usize| {
        let from_end = k.min(length - 1 - k) as f64 * sample_period_s;
        if from_end >= fade_s { 1.0 } else { 0.5 - 0.5 * (PI * from_end / fade_s).cos() }
    };
    samples.iter().enumerate().map(|(k, value)| (value - middle) * weight(k)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn sine(frequency_hz: f64, count: usize) -> Vec<f64> {
        (0..count).map(|k| (2.0 * PI * frequency_hz * k as f64 * 0.01).sin()).collect()
    }

    fn middle_error(frequency_hz: f64, gain: f64) -> f64 {
        let x = sine(frequency_hz, 4000);
        let y = low_pass(&x, 0.01, LowPass { half_amplitude_hz: 5.0 }).unwrap();
        (1000..3000).map(|k| (y[k] - gain * x[k]).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn it_passes_low_halves_at_its_frequency_and_never_shifts() {
        assert!(middle_error(1.0, 1.0) < 1e-4);
        assert!(middle_error(5.0, 0.5) < 1e-9);
        assert!(middle_error(20.0, 0.0) < 1e-5);
    }

    #[test]
    fn a_constant_and_a_ramp_come_through() {
        let ramp: Vec<f64> = (0..500).map(|k| 3.0 + 0.1 * k as f64).collect();
        let out = low_pass(&ramp, 0.01, LowPass { half_amplitude_hz: 5.0 }).unwrap();
        let worst = ramp.iter().zip(&out).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-2, "{worst}");
        assert!((out[250] - ramp[250]).abs() < 1e-9);
    }

    #[test]
    fn frequencies_above_half_the_sample_rate_are_refused() {
        assert!(low_pass(&[0.0; 10], 0.01, LowPass { half_amplitude_hz: 50.0 }).is_err());
        assert!(low_pass(&[], 0.01, LowPass { half_amplitude_hz: 5.0 }).unwrap().is_empty());
    }

    #[test]
    fn motion_from_rest_starts_and_ends_at_zero() {
        let out = from_rest(&sine(1.3, 1000), 0.01, 0.5);
        assert_eq!((out[0], out[999]), (0.0, 0.0));
        assert!(from_rest(&[], 0.01, 0.5).is_empty());
    }
}
