//! The points of a curve, few or as many as a recording has.

use std::borrow::Cow;
use std::sync::Arc;

use super::line_simplification::decimate;
use super::min_max_pyramid::MinMaxPyramid;

/// The points of a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum CurvePoints {
    /// A few thousand at most.
    Few(Vec<[f64; 2]>),
    /// A few thousand at most, of a path that may turn back: it is drawn whole and has no value at an x.
    Path(Vec<[f64; 2]>),
    /// As many as a recording has, with the factor on their values.
    Many(Arc<MinMaxPyramid>, f64),
}

impl CurvePoints {
    /// Returns every point.
    pub fn all(&self) -> Cow<'_, [[f64; 2]]> {
        match self {
            Self::Few(points) | Self::Path(points) => Cow::Borrowed(points),
            Self::Many(pyramid, factor) => multiply_values(Cow::Borrowed(pyramid.points()), *factor),
        }
    }

    /// Returns what a screen of some pixels shows of a range of x.
    pub fn visible_points(&self, range: [f64; 2], pixels: usize) -> Cow<'_, [[f64; 2]]> {
        match self {
            Self::Few(points) => decimate(points, range, pixels),
            Self::Path(points) => Cow::Borrowed(points),
            Self::Many(pyramid, factor) => multiply_values(pyramid.visible_points(range, pixels), *factor),
        }
    }

    /// Returns the value at x by straight lines between the points, or `None` outside them.
    pub fn value_at(&self, x: f64) -> Option<f64> {
        let (all, factor) = match self {
            Self::Few(points) => (points.as_slice(), 1.0),
            Self::Path(_) => return None,
            Self::Many(pyramid, factor) => (pyramid.points(), *factor),
        };
        let after = all.partition_point(|p| p[0] < x);
        let (a, b) = (all.get(after.checked_sub(1)?)?, all.get(after)?);
        let share = if b[0] > a[0] { (x - a[0]) / (b[0] - a[0]) } else { 0.0 };
        Some(factor * (a[1] + share * (b[1] - a[1])))
    }
}

fn multiply_values(points: Cow<'_, [[f64; 2]]>, factor: f64) -> Cow<'_, [[f64; 2]]> {
    if factor == 1.0 { points } else { points.iter().map(|p| [p[0], factor * p[1]]).collect() }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_value_between_points_is_on_the_line() {
        let points = CurvePoints::Few(vec![[0.0, 0.0], [1.0, 10.0], [3.0, 0.0]]);
        assert_eq!(points.value_at(0.5), Some(5.0));
        assert_eq!(points.value_at(2.0), Some(5.0));
        assert_eq!((points.value_at(-1.0), points.value_at(4.0)), (None, None));
    }
}
