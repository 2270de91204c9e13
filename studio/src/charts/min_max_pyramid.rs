//! Long series for the screen: the lowest and highest points of ever longer stretches.
//!
//! They are found once, so that a view costs what it shows and not what the series holds.

use std::borrow::Cow;

/// Points in a stretch of the lowest level.
const STRETCH: usize = 16;
/// Stretches of one level in a stretch of the next.
const FAN: usize = 4;
/// With fewer points for each pixel than this every point is shown: drawing them costs less than searching.
const SHOWN_WHOLE: usize = 4;

/// A series whose x rises, with the extremes of its stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct MinMaxPyramid {
    points: Vec<[f64; 2]>,
    /// For each level and each stretch, the indices of its lowest and its highest point.
    levels: Vec<Vec<[u32; 2]>>,
}

impl MinMaxPyramid {
    /// Builds the pyramid of a series; points that are no numbers are left out.
    pub fn new(mut points: Vec<[f64; 2]>) -> Self {
        points.retain(|p| p[0].is_finite() && p[1].is_finite());
        let mut levels: Vec<Vec<[u32; 2]>> = Vec::new();
        if points.len() > STRETCH {
            let each: Vec<[u32; 2]> = (0..points.len() as u32).map(|k| [k, k]).collect();
            levels.push(extremes_above(&points, &each, STRETCH));
        }
        while let Some(last) = levels.last().filter(|level| level.len() > FAN) {
            let next = extremes_above(&points, last, FAN);
            levels.push(next);
        }
        Self { points, levels }
    }

    /// Returns every point.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Returns what a screen of some pixels shows of a range of x: about the lowest and the highest point of each pixel.
    pub fn visible_points(&self, [low, high]: [f64; 2], pixels: usize) -> Cow<'_, [[f64; 2]]> {
        let from = self.points.partition_point(|p| p[0] < low).saturating_sub(1);
        let to = (self.points.partition_point(|p| p[0] <= high) + 1).min(self.points.len());
        let seen = if from < to { from..to } else { 0..0 };
        let pixels = pixels.max(64);
        if seen.len() <= SHOWN_WHOLE * pixels {
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

/// Returns the extremes of every `fan` stretches.
fn extremes_above(points: &[[f64; 2]], below: &[[u32; 2]], fan: usize) -> Vec<[u32; 2]> {
    let value = |k: &u32| points[*k as usize][1];
    let extremes = |group: &[[u32; 2]]| {
        let low = group.iter().map(|s| s[0]).min_by(|a, b| value(a).total_cmp(&value(b)));
        let high = group.iter().map(|s| s[1]).max_by(|a, b| value(a).total_cmp(&value(b)));
        [low.unwrap_or_default(), high.unwrap_or_default()]
    };
    below.chunks(fan).map(extremes).collect()
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
        let pyramid = MinMaxPyramid::new(points);
        for half_width in [300.0, 100.0, 30.0, 10.0, 3.0, 0.5] {
            let seen = pyramid.visible_points([123.456 - half_width, 123.456 + half_width], 1000);
            assert!(seen.iter().any(|p| p[1] == 9.0), "{half_width}");
            assert!(seen.len() <= 8 * 1000, "{half_width}: {}", seen.len());
            assert!(seen.windows(2).all(|w| w[0][0] <= w[1][0]), "{half_width}");
        }
    }
}
