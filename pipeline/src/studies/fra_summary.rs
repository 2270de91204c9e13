//! The summary of a measured map: the points of each amplitude, how far the linear models are off, and where the joint sticks.

use super::fra_points::{MapPoints, ResponseMapPoint, gain_db};
use counterpoise_linalg::C64;
use ndarray::ArrayView1;

/// The points of a map at one amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct AmplitudePoints {
    /// Amplitude of the excitation, in the input's unit; NaN for a recording, which has no single one.
    pub amplitude: f64,
    /// The points, frequency rising.
    pub points: Vec<ResponseMapPoint>,
    /// The point with the largest gain; `None` if there are no points.
    pub highest: Option<ResponseMapPoint>,
    /// How far the gain of the linear model is off, dB: the upper median over the points. NaN if there are no points.
    pub linear_error_db: f64,
    /// The same for the model with the describing function, over the points that have one.
    pub describing_error_db: f64,
}

/// An amplitude at which nothing moves at some frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct StickingAmplitude {
    /// The amplitude, in the input's unit.
    pub amplitude: f64,
    /// The frequencies, rising, Hz; never empty.
    pub frequencies_hz: Vec<f64>,
    /// The next amplitude of the map that moves the joint at all of these frequencies; `None` if the map has none.
    pub moved_by: Option<f64>,
}

impl ResponseMapPoint {
    /// Returns whether nothing moves: there is no response whose gain could be stated in dB.
    pub fn sticks(&self) -> bool {
        self.gain_db == f64::NEG_INFINITY
    }

    /// Returns the gain of the linear model without dry friction, dB.
    pub fn linear_gain_db(&self) -> f64 {
        gain_of(self.linear)
    }

    /// Returns the gain of the linear model with the describing function, dB; `None` if the point has none.
    pub fn describing_gain_db(&self) -> Option<f64> {
        self.describing.map(gain_of)
    }
}

/// The numbers of a measured map in a few.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSummary {
    /// The points of each amplitude, in the order of the map; those of a recording together.
    pub amplitudes: Vec<AmplitudePoints>,
    /// Largest difference of gain between amplitudes at one frequency, dB.
    pub widest_spread_db: f64,
    /// Largest gain, dB.
    pub largest_gain_db: f64,
    /// Largest share of harmonics in the fundamental.
    pub largest_distortion: f64,
    /// Number of points that had not settled, or were not excited on a recording.
    pub unsettled: usize,
    /// The amplitudes at which the joint sticks at some frequency.
    pub sticking: Vec<StickingAmplitude>,
}

impl MapSummary {
    /// Summarises the points of a map, which were measured on a recording if it has a name.
    pub(crate) fn of(points: &MapPoints, recording: Option<&str>) -> Self {
        let of_amplitude = |k: usize| {
            let points: Vec<ResponseMapPoint> = points.of_amplitude(k).collect();
            let first = points.first().filter(|_| recording.is_none());
            AmplitudePoints::of(first.map_or(f64::NAN, |point| point.amplitude), points)
        };
        let amplitudes: Vec<AmplitudePoints> = (0..points.amplitudes()).map(of_amplitude).collect();
        let spread = |gains: ArrayView1<'_, f64>| {
            let [most, least] =
                [gains.fold(f64::MIN, |a, b| a.max(*b)), gains.fold(f64::MAX, |a, b| a.min(*b))];
            most - least
        };
        let gain_db = points.gain_db();
        Self {
            widest_spread_db: gain_db.rows().into_iter().map(spread).fold(0.0, f64::max),
            largest_gain_db: gain_db.fold(f64::MIN, |most, gain| most.max(*gain)),
            largest_distortion: points.distortion.fold(0.0, |most, share| most.max(*share)),
            unsettled: points.settled.iter().filter(|settled| !**settled).count(),
            sticking: amplitudes.iter().filter_map(|one| one.sticking_amplitude(&amplitudes)).collect(),
            amplitudes,
        }
    }
}

impl AmplitudePoints {
    fn of(amplitude: f64, points: Vec<ResponseMapPoint>) -> Self {
        let linear = |p: &ResponseMapPoint| (p.linear_gain_db() - p.gain_db).abs();
        let describing = |p: &ResponseMapPoint| p.describing_gain_db().map(|gain| (gain - p.gain_db).abs());
        Self {
            amplitude,
            highest: points.iter().copied().max_by(|a, b| a.gain_db.total_cmp(&b.gain_db)),
            linear_error_db: upper_median(points.iter().map(linear).collect()),
            describing_error_db: upper_median(points.iter().filter_map(describing).collect()),
            points,
        }
    }

    /// Returns the amplitude with the frequencies at which nothing moves; `None` if the joint moves at all of them.
    fn sticking_amplitude(&self, all: &[AmplitudePoints]) -> Option<StickingAmplitude> {
        let frequencies_hz: Vec<f64> =
            self.points.iter().filter(|p| p.sticks()).map(|p| p.frequency_hz).collect();
        let moves = |other: &&AmplitudePoints| {
            let moving = |p: &ResponseMapPoint| !(p.sticks() && frequencies_hz.contains(&p.frequency_hz));
            other.amplitude > self.amplitude && other.points.iter().all(moving)
        };
        let moved_by = all.iter().filter(moves).map(|other| other.amplitude).min_by(f64::total_cmp);
        (!frequencies_hz.is_empty()).then_some(StickingAmplitude {
            amplitude: self.amplitude,
            frequencies_hz,
            moved_by,
        })
    }
}

/// Time that the measurement of a map took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuringPace {
    /// Threads that it was measured on.
    pub threads: usize,
    /// Time, s.
    pub seconds: f64,
}

impl MeasuringPace {
    /// Returns how many times as fast as the first of a list, which is on one thread.
    pub fn speed_up(&self, all: &[MeasuringPace]) -> f64 {
        all.first().map_or(1.0, |first| first.seconds / self.seconds)
    }

    /// Returns how many times as fast as the motion itself, s of motion that were simulated.
    pub fn times_real_time(&self, simulated_s: f64) -> f64 {
        simulated_s / self.seconds
    }
}

fn gain_of([re, im]: [f64; 2]) -> f64 {
    gain_db(C64::new(re, im))
}

fn upper_median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
