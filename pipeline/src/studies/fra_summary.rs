//! What a measured map shows as a whole: the points of each amplitude, how far the linear models are off, and where the joint sticks.

use super::fra::{Map, Point};

/// The points of a map at one amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct AmplitudePoints<'a> {
    /// Amplitude of the excitation, in the input's unit; NaN for a recording, which has no single one.
    pub amplitude: f64,
    /// The points, frequency rising.
    pub points: Vec<&'a Point>,
}

/// An amplitude at which nothing moves at some frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Sticking {
    /// The amplitude, in the input's unit.
    pub amplitude: f64,
    /// The frequencies, rising, Hz; never empty.
    pub frequencies_hz: Vec<f64>,
    /// The next amplitude of the map that moves the joint at all of these frequencies; `None` if the map has none.
    pub moved_by: Option<f64>,
}

impl Point {
    /// Returns whether nothing moves: there is no response whose gain could be stated in dB.
    pub fn sticks(&self) -> bool {
        self.gain_db == f64::NEG_INFINITY
    }

    /// Returns the gain of the linear model without dry friction, dB.
    pub fn linear_gain_db(&self) -> f64 {
        gain_db(self.linear)
    }

    /// Returns the gain of the linear model with the describing function, dB; `None` if the point has none.
    pub fn describing_gain_db(&self) -> Option<f64> {
        self.describing.map(gain_db)
    }
}

impl<'a> AmplitudePoints<'a> {
    /// Returns the point with the largest gain; `None` if there are no points.
    pub fn highest_point(&self) -> Option<&'a Point> {
        self.points.iter().copied().max_by(|a, b| a.gain_db.total_cmp(&b.gain_db))
    }

    /// Returns how far the gain of the linear model is off, dB: the upper median over the points. NaN if there are no points.
    pub fn linear_error_db(&self) -> f64 {
        upper_median(self.points.iter().map(|p| (p.linear_gain_db() - p.gain_db).abs()).collect())
    }

    /// Returns the same for the model with the describing function, over the points that have one.
    pub fn describing_error_db(&self) -> f64 {
        let error = |p: &&Point| p.describing_gain_db().map(|gain| (gain - p.gain_db).abs());
        upper_median(self.points.iter().filter_map(error).collect())
    }

    /// Returns the amplitude with the frequencies at which nothing moves; `None` if the joint moves at all of them.
    fn sticking(&self, all: &[AmplitudePoints<'_>]) -> Option<Sticking> {
        let frequencies_hz: Vec<f64> =
            self.points.iter().filter(|p| p.sticks()).map(|p| p.frequency_hz).collect();
        let moves = |other: &&AmplitudePoints<'_>| {
            let moving = |p: &&Point| !(p.sticks() && frequencies_hz.contains(&p.frequency_hz));
            other.amplitude > self.amplitude && other.points.iter().all(moving)
        };
        let moved_by = all.iter().filter(moves).map(|other| other.amplitude).min_by(f64::total_cmp);
        (!frequencies_hz.is_empty()).then_some(Sticking {
            amplitude: self.amplitude,
            frequencies_hz,
            moved_by,
        })
    }
}

impl<Remark> Map<Remark> {
    /// Returns the points of each amplitude, in the order of the map; those of a recording together.
    pub fn points_by_amplitude(&self) -> Vec<AmplitudePoints<'_>> {
        let mut out: Vec<AmplitudePoints<'_>> = Vec::new();
        if self.recording.is_some() {
            return vec![AmplitudePoints { amplitude: f64::NAN, points: self.points.iter().collect() }];
        }
        for point in &self.points {
            match out.last_mut() {
                Some(group) if group.amplitude == point.amplitude => group.points.push(point),
                _ => out.push(AmplitudePoints { amplitude: point.amplitude, points: vec![point] }),
            }
        }
        out
    }

    /// Returns the largest difference of gain between amplitudes at one frequency, dB.
    pub fn widest_spread_db(&self) -> f64 {
        let groups = self.points_by_amplitude();
        let count = groups.iter().map(|group| group.points.len()).min().unwrap_or(0);
        let spread = |k: usize| {
            let gains = groups.iter().map(|group| group.points[k].gain_db);
            gains.clone().fold(f64::MIN, f64::max) - gains.fold(f64::MAX, f64::min)
        };
        (0..count).map(spread).fold(0.0, f64::max)
    }

    /// Returns the largest gain of the map, dB.
    pub fn largest_gain_db(&self) -> f64 {
        self.points.iter().map(|p| p.gain_db).fold(f64::MIN, f64::max)
    }

    /// Returns the largest share of harmonics in the fundamental.
    pub fn largest_distortion(&self) -> f64 {
        self.points.iter().map(|p| p.distortion).fold(0.0, f64::max)
    }

    /// Returns the number of points that had not settled, or were not excited on a recording.
    pub fn unsettled_count(&self) -> usize {
        self.points.iter().filter(|p| !p.settled).count()
    }

    /// Returns the amplitudes at which the joint sticks at some frequency.
    pub fn sticking_amplitudes(&self) -> Vec<Sticking> {
        let all = self.points_by_amplitude();
        all.iter().filter_map(|group| group.sticking(&all)).collect()
    }
}

fn gain_db(h: [f64; 2]) -> f64 {
    20.0 * h[0].hypot(h[1]).log10()
}

fn upper_median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
