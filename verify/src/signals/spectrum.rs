//! Platform motion that has a given spectrum, and the motion of a simulator that only pitches.
//!
//! A spectrum is a one-sided power spectral density by its points, straight between them on logarithmic scales. It is realised
//! as a sum of sines at logarithmically spaced frequencies with random phases (S. Rice, Bell System Technical Journal 23, 1944):
//! each has the exact variance of its band, so that the variance of the sum does not depend on the seed.

use std::f64::consts::TAU;

use counterpoise_recordings::Signals;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::tolerance::{FLAT_EXPONENT, LONGEST_MOTION_S};
use crate::{Error, Road, RoadOrigin};

/// A sine of a platform's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionTone {
    /// Frequency, rad/s.
    pub rate_rad_s: f64,
    /// Amplitude, in the unit of what moves.
    pub amplitude: f64,
    /// Phase at the start, rad.
    pub phase_rad: f64,
}

/// Duration of a motion, and how it begins and ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionRealisation {
    /// Duration, s.
    pub duration_s: f64,
    /// Time in which the motion fades in and out, s.
    pub fade_s: f64,
    /// Seed of the phases.
    pub seed: u64,
}

/// Sines of a realisation.
pub(super) const SINES: usize = 300;
/// Period of the samples, s.
pub(super) const PERIOD_S: f64 = 1e-3;
/// Highest frequency that samples of that period carry to about 1 %, Hz.
const HIGHEST_HZ: f64 = 50.0;
/// The pitch's phases are drawn from a sequence of their own.
const PITCH_STREAM: u64 = 1;

/// Returns independent heave and pitch with given spectra, from rest to rest; heave in points [Hz, (m/s^2)^2/Hz], pitch rate in
/// points [Hz, (rad/s)^2/Hz]. No points: no motion.
///
/// # Errors
/// As [`spectrum_tones`], and for a duration or fade out of range.
pub fn random_motion(heave: &[[f64; 2]], pitch: &[[f64; 2]], how: MotionRealisation) -> Result<Road, Error> {
    let samples = check(how)?;
    let series = |points: &[[f64; 2]], stream: u64| -> Result<Vec<f64>, Error> {
        let tones = spectrum_tones(points, how.seed, stream)?;
        let at = |k: usize| {
            let t = k as f64 * PERIOD_S;
            window(t, how)[0] * sum(&tones, t)[0]
        };
        Ok((0..samples).map(at).collect())
    };
    Ok(Road {
        origin: RoadOrigin::Spectrum { seed: how.seed },
        sample_period_s: PERIOD_S,
        signals: Signals::stack([&series(heave, 0)?[..], &series(pitch, PITCH_STREAM)?]),
    })
}

/// Returns the motion of a platform motion simulator that only pitches, the mechanism's pivot standing `offset_m` in front of its axis:
///
/// ```text
///     theta(t) = fade(t) sum a_k sin(w_k t + phase_k),   pitch rate = theta',   heave = offset theta''
/// ```
///
/// exactly, the fade being twice differentiable, from rest to rest.
///
/// # Errors
/// For a duration, fade, offset, amplitude or frequency out of range.
pub fn pitch_simulator(angle: &[MotionTone], offset_m: f64, how: MotionRealisation) -> Result<Road, Error> {
    let samples = check(how)?;
    check_pitch_simulator(angle, offset_m)?;
    let at = |k: usize| {
        let t = k as f64 * PERIOD_S;
        let (w, x) = (window(t, how), sum(angle, t));
        let rate = w[1] * x[0] + w[0] * x[1];
        (offset_m * (w[2] * x[0] + 2.0 * w[1] * x[1] + w[0] * x[2]), rate)
    };
    let (heave_m_s2, pitch_rate_rad_s): (Vec<f64>, Vec<f64>) = (0..samples).map(at).unzip();
    Ok(Road {
        origin: RoadOrigin::MotionSimulator { offset_m },
        sample_period_s: PERIOD_S,
        signals: Signals::stack([&heave_m_s2[..], &pitch_rate_rad_s]),
    })
}

/// Checks what a motion simulator is given, without realising it: the sines of its pitch angle and its pivot's distance from the axis, m.
///
/// # Errors
/// [`Error::Range`] for an offset or amplitude that is not finite, and for a frequency out of range.
pub fn check_pitch_simulator(angle: &[MotionTone], offset_m: f64) -> Result<(), Error> {
    if !offset_m.is_finite() {
        return Err(range_error("offset of the pivot in m", offset_m, "finite"));
    }
    for tone in angle {
        if !tone.amplitude.is_finite() {
            return Err(range_error("amplitude of the pitch in rad", tone.amplitude, "finite"));
        }
        frequency(tone.rate_rad_s / TAU)?;
    }
    Ok(())
}

/// Returns the tones of sines that are given by amplitude and frequency in Hz, with phase 0.
pub fn sine_tones(sines: &[[f64; 2]]) -> Vec<MotionTone> {
    let tone = |&[amplitude, hz]: &[f64; 2]| MotionTone { rate_rad_s: TAU * hz, amplitude, phase_rad: 0.0 };
    sines.iter().map(tone).collect()
}

/// Checks the points of a density, without realising it.
///
/// # Errors
/// [`Error::Range`] for a single point, frequencies that do not rise, are not positive or are above 50 Hz, and densities that are
/// not positive.
pub fn check_density(points: &[[f64; 2]]) -> Result<(), Error> {
    if points.len() == 1 {
        return Err(range_error("points of a spectrum", points.len() as f64, "at least 2"));
    }
    for two in points.windows(2) {
        let rises = two[1][0] > two[0][0];
        if !rises {
            return Err(range_error("frequency of a spectrum in Hz", two[1][0], "above the one before"));
        }
    }
    for [hz, density] in points {
        frequency(*hz)?;
        if !(*density > 0.0 && density.is_finite()) {
            return Err(range_error("density of a spectrum", *density, "positive"));
        }
    }
    Ok(())
}

/// Returns the sines of a realisation, each with the variance of its band; seeds and streams have phases of their own.
///
/// # Errors
/// As [`check_density`].
pub fn spectrum_tones(points: &[[f64; 2]], seed: u64, stream: u64) -> Result<Vec<MotionTone>, Error> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Ok(Vec::new()) };
    check_density(points)?;
    let mut source = ChaCha8Rng::seed_from_u64(seed);
    source.set_stream(stream);
    let ratio = (last[0] / first[0]).powf(1.0 / SINES as f64);
    let tone = |k: usize| {
        let low = first[0] * ratio.powi(k as i32);
        let variance = power_in_band(points, low, low * ratio);
        MotionTone {
            rate_rad_s: TAU * low * ratio.sqrt(),
            amplitude: (2.0 * variance).sqrt(),
            phase_rad: TAU * (source.next_u64() >> 11) as f64 / (1u64 << 53) as f64,
        }
    };
    Ok((0..SINES).map(tone).collect())
}

/// Returns the tones of the angle whose rate the given tones are.
#[must_use]
pub fn angle_tones(rate: &[MotionTone]) -> Vec<MotionTone> {
    let turned = |tone: &MotionTone| MotionTone {
        amplitude: tone.amplitude / tone.rate_rad_s,
        phase_rad: tone.phase_rad - std::f64::consts::FRAC_PI_2,
        ..*tone
    };
    rate.iter().map(turned).collect()
}

/// Returns the integral of the density over a band, exactly: between two points it is c f^p.
pub fn power_in_band(points: &[[f64; 2]], low_hz: f64, high_hz: f64) -> f64 {
    let piece = |two: &[[f64; 2]]| {
        let (from, to) = (two[0][0].max(low_hz), two[1][0].min(high_hz));
        if to <= from {
            return 0.0;
        }
        let slope = (two[1][1] / two[0][1]).ln() / (two[1][0] / two[0][0]).ln();
        let at = two[0][1] * (from / two[0][0]).powf(slope);
        let (p, span) = (slope + 1.0, (to / from).ln());
        at * from * if p.abs() * span < FLAT_EXPONENT { span } else { (p * span).exp_m1() / p }
    };
    points.windows(2).map(piece).sum()
}

/// A sum of sines and its first two derivatives.
pub(super) fn sum(tones: &[MotionTone], time_s: f64) -> [f64; 3] {
    tones.iter().fold([0.0; 3], |[x, v, a], tone| {
        let w = tone.rate_rad_s;
        let (sin, cos) = (w * time_s + tone.phase_rad).sin_cos();
        [x + tone.amplitude * sin, v + tone.amplitude * w * cos, a - tone.amplitude * w * w * sin]
    })
}

/// The fade s^3 (10 - 15 s + 6 s^2) in and out, and its first two derivatives.
pub(super) fn window(time_s: f64, how: MotionRealisation) -> [f64; 3] {
    let left = (how.duration_s - time_s).max(0.0);
    let (from_end, sign) = if time_s <= left { (time_s, 1.0) } else { (left, -1.0) };
    if from_end >= how.fade_s {
        return [1.0, 0.0, 0.0];
    }
    let (s, f) = (from_end / how.fade_s, how.fade_s);
    let value = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    let slope = 30.0 * s * s * (1.0 - s) * (1.0 - s) / f;
    [value, sign * slope, 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (f * f)]
}

pub(super) fn check(how: MotionRealisation) -> Result<usize, Error> {
    if !(how.duration_s > 0.0 && how.duration_s <= LONGEST_MOTION_S) {
        return Err(range_error("duration of the motion in s", how.duration_s, "positive, at most 3600"));
    }
    if !(how.fade_s >= 0.0 && 2.0 * how.fade_s <= how.duration_s) {
        return Err(range_error("fade of the motion in s", how.fade_s, "at most half the duration"));
    }
    Ok((how.duration_s / PERIOD_S).round() as usize + 1)
}

pub(super) fn frequency(hz: f64) -> Result<(), Error> {
    if hz > 0.0 && hz <= HIGHEST_HZ {
        Ok(())
    } else {
        Err(range_error("frequency of the platform in Hz", hz, "positive, at most 50"))
    }
}

pub(super) fn range_error(what: &'static str, value: f64, allowed: &'static str) -> Error {
    Error::Range { what, value, allowed }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::signals::rms;
    use crate::signals::welch::{WelchOptions, welch};

    const HOW: MotionRealisation = MotionRealisation { duration_s: 120.0, fade_s: 0.0, seed: 7 };
    const POINTS: [[f64; 2]; 3] = [[0.3, 0.02], [1.5, 0.5], [12.0, 0.004]];

    #[test]
    fn the_variance_is_the_integral_of_the_density() {
        let tones = spectrum_tones(&POINTS, 3, 0).unwrap();
        let variance: f64 = tones.iter().map(|t| 0.5 * t.amplitude * t.amplitude).sum();
        assert!((variance / power_in_band(&POINTS, 0.0, 100.0) - 1.0).abs() < 1e-9);
        // 1/f from 1 to e has the integral 1
        let e = std::f64::consts::E;
        assert!((power_in_band(&[[1.0, 1.0], [e, 1.0 / e]], 0.0, 9.0) - 1.0).abs() < 1e-12);
        let made = random_motion(&POINTS, &[], HOW).unwrap();
        assert!((rms(made.heave_m_s2()).powi(2) / variance - 1.0).abs() < 0.1);
        assert!(made.pitch_rate_rad_s().iter().all(|p| *p == 0.0));
    }

    #[test]
    fn the_estimated_spectrum_is_the_given_one() {
        let made = random_motion(&POINTS, &[], HOW).unwrap();
        let options = WelchOptions { segment: 8192, confidence: 0.95 };
        let found = welch(made.heave_m_s2(), made.heave_m_s2(), made.sample_period_s, options).unwrap();
        for (low, high) in [(0.5, 1.0), (1.0, 2.0), (2.0, 4.0), (4.0, 8.0)] {
            let step = found.frequency_hz[1] - found.frequency_hz[0];
            let inside = |hz: f64| hz >= low && hz < high;
            let pairs = found.frequency_hz.iter().zip(&found.pxx);
            let sum: f64 = pairs.filter(|(hz, _)| inside(**hz)).map(|(_, density)| density * step).sum();
            let ratio = sum / power_in_band(&POINTS, low, high);
            assert!((0.7..1.4).contains(&ratio), "{low} to {high} Hz: {ratio}");
        }
    }

    #[test]
    fn a_pitch_simulator_heaves_with_its_pitch_acceleration() {
        let angle = [MotionTone { rate_rad_s: 9.0, amplitude: 0.03, phase_rad: 0.4 }];
        let how = MotionRealisation { duration_s: 6.0, fade_s: 1.0, seed: 1 };
        let made = pitch_simulator(&angle, 1.7, how).unwrap();
        let rate = &made.pitch_rate_rad_s();
        // where the fade begins or ends its third derivative jumps, which a difference quotient sees
        let jumps = [1.0, 5.0].map(|t: f64| (t / PERIOD_S).round() as usize);
        for k in (1..rate.len() - 1).filter(|k| !jumps.contains(k)) {
            let slope = (rate[k + 1] - rate[k - 1]) / (2.0 * PERIOD_S);
            assert!((made.heave_m_s2()[k] - 1.7 * slope).abs() < 2e-4, "{k}");
        }
        assert_eq!((rate[0], made.heave_m_s2()[0]), (0.0, 0.0));
        let turned: f64 = rate.iter().map(|r| r * PERIOD_S).sum();
        assert!(turned.abs() < 1e-6, "it comes back to where it was: {turned}");
    }

    #[test]
    fn a_seed_repeats_and_nonsense_is_refused() {
        let made = |seed| {
            random_motion(&POINTS, &POINTS, MotionRealisation { seed, duration_s: 5.0, ..HOW }).unwrap()
        };
        assert_eq!(made(1), made(1));
        assert_ne!(made(1).heave_m_s2(), made(2).heave_m_s2());
        assert_ne!(made(1).heave_m_s2(), made(1).pitch_rate_rad_s());
        for bad in [
            vec![[1.0, 1.0]],
            vec![[2.0, 1.0], [1.0, 1.0]],
            vec![[1.0, 0.0], [2.0, 1.0]],
            vec![[1.0, 1.0], [80.0, 1.0]],
        ] {
            assert!(random_motion(&bad, &[], HOW).is_err(), "{bad:?}");
        }
        assert!(random_motion(&POINTS, &[], MotionRealisation { fade_s: 70.0, ..HOW }).is_err());
    }
}
