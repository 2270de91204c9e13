//! Long series for the screen: lowest and highest points of ever longer stretches, found once, so that a view costs what it shows.

use std::borrow::Cow;
use std::sync::Arc;

/// Points in a stretch of the lowest level.
const STRETCH: usize = 16;
/// Stretches of one level in a stretch of the next.
const FAN: usize = 4;
/// Below this many points for each pixel every point is shown.
const PLAIN: usize = 4;

/// A series whose x rises, with the extremes of its stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct Pyramid {
    points: Vec<[f64; 2]>,
    /// Level by level, for each stretch where its lowest and its highest point stand.
    levels: Vec<Vec<[u32; 2]>>,
}

impl Pyramid {
    /// The pyramid over a series; points that are no numbers are left out.
    pub fn new(mut points: Vec<[f64; 2]>) -> Self {
        points.retain(|p| p[0].is_finite() && p[1].is_finite());
        let mut levels: Vec<Vec<[u32; 2]>> = Vec::new();
        if points.len() > STRETCH {
            let each: Vec<[u32; 2]> = (0..points.len() as u32).map(|k| [k, k]).collect();
            levels.push(above(&points, &each, STRETCH));
        }
        while let Some(last) = levels.last().filter(|level| level.len() > FAN) {
            let next = above(&points, last, FAN);
            levels.push(next);
        }
        Self { points, levels }
    }

    /// Every point.
    pub fn all(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// What a screen of some pixels shows of the part from `low` to `high`: the lowest and the highest point of each pixel.
    pub fn shown(&self, (low, high): (f64, f64), pixels: usize) -> Cow<'_, [[f64; 2]]> {
        let from = self.points.partition_point(|p| p[0] < low).saturating_sub(1);
        let to = (self.points.partition_point(|p| p[0] <= high) + 1).min(self.points.len());
        let seen = if from < to { from..to } else { 0..0 };
        let pixels = pixels.max(64);
        if seen.len() <= PLAIN * pixels {
            return Cow::Borrowed(&self.points[seen]);
        }
        let (mut level, mut size) = (0, STRETCH);
        while level + 1 < self.levels.len() && size * FAN * pixels <= seen.len() {
            (level, size) = (level + 1, size * FAN);
        }
        let stretches = &self.levels[level][seen.start / size..seen.end.div_ceil(size)];
        let mut kept = Vec::with_capacity(2 * stretches.len());
        for [low, high] in stretches {
            let (a, b) = (low.min(high), low.max(high));
            kept.extend([a, b].map(|k| self.points[*k as usize]));
        }
        Cow::Owned(kept)
    }
}

/// The extremes of every `fan` stretches.
fn above(points: &[[f64; 2]], below: &[[u32; 2]], fan: usize) -> Vec<[u32; 2]> {
    let value = |k: &u32| points[*k as usize][1];
    let extremes = |group: &[[u32; 2]]| {
        let low = group.iter().map(|s| s[0]).min_by(|a, b| value(a).total_cmp(&value(b)));
        let high = group.iter().map(|s| s[1]).max_by(|a, b| value(a).total_cmp(&value(b)));
        [low.unwrap_or_default(), high.unwrap_or_default()]
    };
    below.chunks(fan).map(extremes).collect()
}

/// The points of a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Points {
    /// A few thousand at most.
    Few(Vec<[f64; 2]>),
    /// As many as a recording has, with what their values are multiplied by.
    Many(Arc<Pyramid>, f64),
}

impl Points {
    /// Every point.
    pub fn all(&self) -> Cow<'_, [[f64; 2]]> {
        match self {
            Self::Few(points) => Cow::Borrowed(points),
            Self::Many(pyramid, factor) => scaled(Cow::Borrowed(pyramid.all()), *factor),
        }
    }

    /// What a screen shows of a part.
    pub fn shown(&self, range: (f64, f64), pixels: usize) -> Cow<'_, [[f64; 2]]> {
        match self {
            Self::Few(points) => crate::thinning::thin(points, range, pixels),
            Self::Many(pyramid, factor) => scaled(pyramid.shown(range, pixels), *factor),
        }
    }

    /// The value at a place, by straight lines between the points; none outside.
    pub fn at(&self, x: f64) -> Option<f64> {
        let (all, factor) = match self {
            Self::Few(points) => (points.as_slice(), 1.0),
            Self::Many(pyramid, factor) => (pyramid.all(), *factor),
        };
        let after = all.partition_point(|p| p[0] < x);
        let (a, b) = (all.get(after.checked_sub(1)?)?, all.get(after)?);
        let share = if b[0] > a[0] { (x - a[0]) / (b[0] - a[0]) } else { 0.0 };
        Some(factor * (a[1] + share * (b[1] - a[1])))
    }
}

fn scaled(points: Cow<'_, [[f64; 2]]>, factor: f64) -> Cow<'_, [[f64; 2]]> {
    if factor == 1.0 { points } else { points.iter().map(|p| [p[0], factor * p[1]]).collect() }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_single_peak_is_seen_from_any_distance_and_little_else_is_drawn() {
        let mut points: Vec<[f64; 2]> =
            (0..600_000).map(|k| [f64::from(k) * 1e-3, (f64::from(k) * 0.01).sin()]).collect();
        points[123_456][1] = 9.0;
        let pyramid = Pyramid::new(points);
        for half_width in [300.0, 100.0, 30.0, 10.0, 3.0, 0.5] {
            let seen = pyramid.shown((123.456 - half_width, 123.456 + half_width), 1000);
            assert!(seen.iter().any(|p| p[1] == 9.0), "{half_width}");
            assert!(seen.len() <= 8 * 1000, "{half_width}: {}", seen.len());
            assert!(seen.windows(2).all(|w| w[0][0] <= w[1][0]), "{half_width}");
        }
    }

    #[test]
    fn a_value_between_points_is_on_the_line() {
        let points = Points::Few(vec![[0.0, 0.0], [1.0, 10.0], [3.0, 0.0]]);
        assert_eq!(points.at(0.5), Some(5.0));
        assert_eq!(points.at(2.0), Some(5.0));
        assert_eq!((points.at(-1.0), points.at(4.0)), (None, None));
    }
}
