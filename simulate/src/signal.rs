//! Signals over time: what is demanded, and how the platform moves.

use crate::tolerance::HELD_ROUNDING;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// Samples behind the last one of a run that the interpolation of a signal uses: two for the slope at the end of an interval, and one for the
/// rounding of a time.
pub(crate) const LOOK_AHEAD: usize = 3;

/// A scalar function of time, defined for every time.
#[derive(Debug, Clone, PartialEq)]
pub enum Signal {
    /// The same value for ever.
    Constant(f64),
    /// A sum of sines, each amplitude x sin(frequency t + phase).
    Sines(Vec<Sine>),
    /// Constant between changes: each entry is (time s, value from then on); 0 before the first.
    Steps(Vec<(f64, f64)>),
    /// A triangle wave that starts at 0 and rises.
    Triangle {
        /// Peak value.
        amplitude: f64,
        /// Period, s.
        period_s: f64,
    },
    /// Values at t = 0, period, 2 period, ...; a cubic through slopes by central differences between them, constant
    /// beyond the ends.
    Samples {
        /// Time between values, s.
        period_s: f64,
        /// The values.
        values: Vec<f64>,
    },
    /// Values that are held from sample to sample; the last one for ever.
    Held {
        /// Time between values, s.
        period_s: f64,
        /// The values.
        values: Vec<f64>,
    },
    /// A sum of signals.
    Sum(Vec<Signal>),
    /// A signal with its course over each sample, which many runs share.
    WithCourse(Arc<SignalCourse>),
}

/// A signal with the polynomials by which the integrator follows it, sample by sample: computed once for many runs.
#[derive(Debug)]
pub struct SignalCourse {
    signal: Signal,
    period_s: f64,
    quartics: Vec<[f64; 5]>,
}

impl PartialEq for SignalCourse {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other) || (self.period_s == other.period_s && self.signal == other.signal)
    }
}

impl SignalCourse {
    /// Returns a signal with its quartics in the fraction of each sample, from the first on.
    pub(crate) fn new(signal: Signal, period_s: f64, quartics: Vec<[f64; 5]>) -> Self {
        Self { signal, period_s, quartics }
    }

    /// Returns the signal itself.
    pub(crate) fn signal(&self) -> &Signal {
        &self.signal
    }

    /// Returns the quartics over samples of a length; `None` if they were computed for another.
    pub(crate) fn quartics(&self, period_s: f64) -> Option<&[[f64; 5]]> {
        (self.period_s == period_s).then_some(&self.quartics)
    }
}

/// A sine of a [`Signal::Sines`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sine {
    /// Amplitude in the signal's unit.
    pub amplitude: f64,
    /// Angular frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Phase at t = 0, rad.
    pub phase_rad: f64,
}

impl Signal {
    /// Nothing at all.
    pub const ZERO: Self = Self::Constant(0.0);

    /// Returns a single sine.
    pub fn sine(amplitude: f64, frequency_rad_s: f64) -> Self {
        Self::Sines(vec![Sine { amplitude, frequency_rad_s, phase_rad: 0.0 }])
    }

    /// Returns a step of a size at a time.
    pub fn step(time_s: f64, size: f64) -> Self {
        Self::Steps(vec![(time_s, size)])
    }

    /// Returns the value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Sines(sines) => sines.iter().map(|s| s.at(time_s)).sum(),
            Self::Steps(steps) => {
                let passed = steps.iter().take_while(|(start, _)| *start <= time_s);
                passed.last().map_or(0.0, |&(_, value)| value)
            }
            Self::Triangle { amplitude, period_s } => amplitude * triangle(time_s / period_s),
            Self::Samples { period_s, values } => smooth(values, time_s / period_s),
            Self::Held { period_s, values } => hold_value(values, time_s / period_s),
            Self::Sum(parts) => parts.iter().map(|part| part.at(time_s)).sum(),
            Self::WithCourse(course) => course.signal.at(time_s),
        }
    }

    /// Returns the values at five times, as [`Signal::at`] does; samples between which all of them lie are looked up once.
    pub(crate) fn at_each(&self, times_s: [f64; 5]) -> [f64; 5] {
        let Self::Samples { period_s, values } = self else { return times_s.map(|time_s| self.at(time_s)) };
        let positions = times_s.map(|time_s| time_s / period_s);
        let index = positions[0] as usize;
        let inside = positions[0] > 0.0 && index + 1 < values.len();
        if inside && positions.iter().all(|position| *position as usize == index) {
            let between = CubicSegment::new(values, index);
            positions.map(|position| between.at(position))
        } else {
            positions.map(|position| smooth(values, position))
        }
    }

    /// Returns the signal from one of its samples on, as far as a run over so many samples looks; a signal that is not made of samples is
    /// returned as it is.
    pub(crate) fn part(&self, samples: Range<usize>) -> Self {
        match self {
            Self::Samples { period_s, values } => {
                let end = (samples.end + LOOK_AHEAD).min(values.len());
                let start = samples.start.min(end.saturating_sub(1));
                Self::Samples { period_s: *period_s, values: values[start..end].to_vec() }
            }
            Self::WithCourse(course) if samples.start > 0 => course.signal.part(samples),
            other => other.clone(),
        }
    }

    /// Returns the signal without a course that was computed before.
    pub(crate) fn without_course(&self) -> &Self {
        match self {
            Self::WithCourse(course) => &course.signal,
            other => other,
        }
    }

    /// Returns whether the signal is 0 at every time.
    pub fn is_zero(&self) -> bool {
        match self {
            Self::Constant(value) => *value == 0.0,
            Self::Sines(sines) => sines.iter().all(|s| s.amplitude == 0.0),
            Self::Steps(steps) => steps.iter().all(|&(_, value)| value == 0.0),
            Self::Triangle { amplitude, .. } => *amplitude == 0.0,
            Self::Samples { values, .. } | Self::Held { values, .. } => values.iter().all(|&v| v == 0.0),
            Self::Sum(parts) => parts.iter().all(Self::is_zero),
            Self::WithCourse(course) => course.signal.is_zero(),
        }
    }
}

impl Sine {
    /// Returns the value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        self.amplitude * (self.frequency_rad_s * time_s + self.phase_rad).sin()
    }
}

/// Returns a triangle wave of amplitude and period 1.
fn triangle(turns: f64) -> f64 {
    let part = (turns + 0.25).rem_euclid(1.0);
    1.0 - 4.0 * (part - 0.5).abs()
}

fn hold_value(values: &[f64], position: f64) -> f64 {
    // a time that is a whole number of samples but for rounding belongs to the later sample
    let index = (position * (1.0 + f64::EPSILON * TAU) + HELD_ROUNDING).max(0.0) as usize;
    values.get(index).or(values.last()).copied().unwrap_or(0.0)
}

/// Returns the cubic Hermite interpolation with slopes by central differences.
fn smooth(values: &[f64], position: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    if position <= 0.0 || last == 0 {
        return values[0];
    }
    let index = position as usize;
    if index >= last {
        return values[last];
    }
    CubicSegment::new(values, index).at(position)
}

/// The cubic between two neighbouring values.
struct CubicSegment {
    index: usize,
    /// Coefficients of the powers of the fraction.
    c: [f64; 4],
}

impl CubicSegment {
    /// Returns the cubic from the value at an index to the next, which exists.
    #[inline]
    fn new(values: &[f64], index: usize) -> Self {
        let last = values.len() - 1;
        let (y0, y1) = (values[index], values[index + 1]);
        let d0 = if index == 0 { y1 - y0 } else { 0.5 * (y1 - values[index - 1]) };
        let d1 = if index + 1 == last { y1 - y0 } else { 0.5 * (values[index + 2] - y0) };
        Self { index, c: [y0, d0, 3.0 * (y1 - y0) - 2.0 * d0 - d1, 2.0 * (y0 - y1) + d0 + d1] }
    }

    #[inline]
    fn at(&self, position: f64) -> f64 {
        let (s, [c0, c1, c2, c3]) = (position - self.index as f64, self.c);
        c0 + s * (c1 + s * (c2 + s * c3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triangle_rises_from_zero() {
        let wave = Signal::Triangle { amplitude: 2.0, period_s: 4.0 };
        for (time, value) in [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (2.0, 0.0), (3.0, -2.0), (4.5, 1.0)] {
            assert!((wave.at(time) - value).abs() < 1e-12, "{time}");
        }
    }

    #[test]
    fn samples_of_a_parabola_are_interpolated_exactly_inside() {
        let values: Vec<f64> = (0..10).map(|k| f64::from(k * k)).collect();
        let signal = Signal::Samples { period_s: 0.1, values };
        assert!((signal.at(0.437) - 4.37 * 4.37).abs() < 1e-12);
        assert_eq!(signal.at(5.0), 81.0);
    }

    #[test]
    fn held_values_change_at_their_instants() {
        let signal = Signal::Held { period_s: 1e-3, values: vec![1.0, 2.0, 3.0] };
        assert_eq!(signal.at(2.0 * 1e-3), 3.0);
        assert_eq!(signal.at(0.9e-3), 1.0);
    }

    #[test]
    fn five_times_at_once_give_the_same_bits_as_one_after_the_other() {
        let values: Vec<f64> = (0..40).map(|k| (f64::from(k) * 0.7).sin()).collect();
        let samples = Signal::Samples { period_s: 1e-3, values };
        let single = Signal::Samples { period_s: 1e-3, values: vec![0.3] };
        for signal in [samples, single, Signal::sine(0.4, 80.0)] {
            // before, inside and behind the samples, and across the end of an interval
            for k in -20..450 {
                let times = [0.0, 0.2, 0.5, 0.8, 0.98].map(|s| (f64::from(k) * 0.1 + s) * 1e-3);
                let one_by_one = times.map(|time| signal.at(time).to_bits());
                assert_eq!(signal.at_each(times).map(f64::to_bits), one_by_one, "{k}");
            }
        }
    }
}
