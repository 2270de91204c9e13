//! The summary of a measured map: the points of each amplitude, how far the linear models are off, and where the joint sticks.

use super::fra::ResponseMap;
use super::fra_points::{ResponseMapPoint, gain_db};
use counterpoise_linalg::C64;
use ndarray::ArrayView1;

/// The points of a map at one amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct AmplitudePoints {
    /// Amplitude of the excitation, in the input's unit; NaN for a recording, which has no single one.
    pub amplitude: f64,
    /// The points, frequency rising.
    pub points: Vec<ResponseMapPoint>,
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

impl AmplitudePoints {
    /// Returns the point with the largest gain; `None` if there are no points.
    pub fn highest_point(&self) -> Option<ResponseMapPoint> {
        self.points.iter().copied().max_by(|a, b| a.gain_db.total_cmp(&b.gain_db))
    }

    /// Returns how far the gain of the linear model is off, dB: the upper median over the points. NaN if there are no points.
    pub fn linear_error_db(&self) -> f64 {
        upper_median(self.points.iter().map(|p| (p.linear_gain_db() - p.gain_db).abs()).collect())
    }

    /// Returns the same for the model with the describing function, over the points that have one.
    pub fn describing_error_db(&self) -> f64 {
        let error = |p: &ResponseMapPoint| p.describing_gain_db().map(|gain| (gain - p.gain_db).abs());
        upper_median(self.points.iter().filter_map(error).collect())
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

impl<Remark> ResponseMap<Remark> {
    /// Returns the points of each amplitude, in the order of the map; those of a recording together.
    pub fn points_by_amplitude(&self) -> Vec<AmplitudePoints> {
        let of_amplitude = |k: usize| {
            let points: Vec<ResponseMapPoint> = self.points.of_amplitude(k).collect();
            let first = points.first().filter(|_| self.recording.is_none());
            AmplitudePoints { amplitude: first.map_or(f64::NAN, |point| point.amplitude), points }
        };
        (0..self.points.amplitudes()).map(of_amplitude).collect()
    }

    /// Returns the largest difference of gain between amplitudes at one frequency, dB.
    pub fn widest_spread_db(&self) -> f64 {
        let spread = |gains: ArrayView1<'_, f64>| {
            let [most, least] =
                [gains.fold(f64::MIN, |a, b| a.max(*b)), gains.fold(f64::MAX, |a, b| a.min(*b))];
            most - least
        };
        self.points.gain_db().rows().into_iter().map(spread).fold(0.0, f64::max)
    }

    /// Returns the largest gain of the map, dB.
    pub fn largest_gain_db(&self) -> f64 {
        self.points.gain_db().fold(f64::MIN, |most, gain| most.max(*gain))
    }

    /// Returns the largest share of harmonics in the fundamental.
    pub fn largest_distortion(&self) -> f64 {
        self.points.distortion.fold(0.0, |most, share| most.max(*share))
    }

    /// Returns the number of points that had not settled, or were not excited on a recording.
    pub fn unsettled_count(&self) -> usize {
        self.points.settled.iter().filter(|settled| !**settled).count()
    }

    /// Returns the amplitudes at which the joint sticks at some frequency.
    pub fn sticking_amplitudes(&self) -> Vec<StickingAmplitude> {
        let all = self.points_by_amplitude();
        all.iter().filter_map(|group| group.sticking_amplitude(&all)).collect()
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

/// The numbers of several maps together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapTotals {
    /// Points.
    pub points: usize,
    /// Points that had not settled, or were not excited on a recording.
    pub unsettled: usize,
    /// Simulated time of the mechanism, s.
    pub simulated_s: f64,
}

impl MapTotals {
    /// Returns the numbers of maps together.
    pub fn of<Remark>(maps: &[ResponseMap<Remark>]) -> Self {
        Self {
            points: maps.iter().map(|map| map.points.len()).sum(),
            unsettled: maps.iter().map(|map| map.unsettled_count()).sum(),
            simulated_s: maps.iter().map(|map| map.simulated_s).sum(),
        }
    }
}

fn gain_of([re, im]: [f64; 2]) -> f64 {
    gain_db(C64::new(re, im))
}

fn upper_median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
