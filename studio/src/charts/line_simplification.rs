//! Fewer points that look the same on a screen.

use crate::tolerance::TOLERANCE_PX;
use std::borrow::Cow;

use ndarray::aview2;

/// Returns what a screen can show of a long curve: the first, lowest, highest and last point of each pixel.
pub fn decimate(points: &[[f64; 2]], [low, high]: [f64; 2], pixels: usize) -> Cow<'_, [[f64; 2]]> {
    let from = points.partition_point(|p| p[0] < low).saturating_sub(1);
    let to = (points.partition_point(|p| p[0] <= high) + 1).min(points.len());
    let seen = if from < to { &points[from..to] } else { points };
    let stretches = pixels.max(64);
    if seen.len() <= 4 * stretches {
        return Cow::Borrowed(seen);
    }
    let kept = counterpoise_plot::thinning::thin_points(aview2(seen), stretches);
    Cow::Owned(kept.into_iter().map(|k| seen[k]).collect())
}

/// Returns the corners of a curve whose straight connections look like it (Ramer, Douglas and Peucker). Dashes need segments that
/// are longer than themselves.
pub fn simplify_line(points: &[[f64; 2]], per_unit: [f64; 2]) -> Vec<[f64; 2]> {
    let at = |k: usize| [points[k][0] * per_unit[0], points[k][1] * per_unit[1]];
    let mut kept = vec![false; points.len()];
    let mut open = vec![(0, points.len().saturating_sub(1))];
    while let Some((a, b)) = open.pop() {
        if b >= kept.len() {
            break;
        }
        (kept[a], kept[b]) = (true, true);
        let (from, to) = (at(a), at(b));
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
        let distance = |k: usize| ((at(k)[0] - from[0]) * dy - (at(k)[1] - from[1]) * dx).abs() / length;
        let far = (a + 1..b).map(|k| (k, distance(k))).max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((k, _)) = far.filter(|(_, far)| *far > TOLERANCE_PX) {
            open.extend([(a, k), (k, b)]);
        }
    }
    points.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(p, _)| *p).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn peaks_survive_and_the_rest_is_left_out() {
        let mut points: Vec<[f64; 2]> =
            (0..600_000).map(|k| [f64::from(k) * 1e-3, (f64::from(k) * 0.01).sin()]).collect();
        points[123_456][1] = 9.0;
        let all = decimate(&points, [0.0, 600.0], 1000);
        assert!(all.len() <= 4000 && all.iter().any(|p| p[1] == 9.0));
        let part = decimate(&points, [10.0, 11.0], 1000);
        assert!(part.len() <= 1003 && part[0][0] <= 10.0 && part[part.len() - 1][0] >= 11.0);
    }

    #[test]
    fn a_straight_line_has_two_corners_and_a_step_four() {
        let line: Vec<[f64; 2]> = (0..1000).map(|k| [f64::from(k), 5.0]).collect();
        assert_eq!(simplify_line(&line, [0.4, 1.0]).len(), 2);
        let step: Vec<[f64; 2]> =
            (0..1000).map(|k| [f64::from(k), if k < 500 { 0.0 } else { 50.0 }]).collect();
        assert_eq!(simplify_line(&step, [0.4, 1.0]).len(), 4);
        assert!(simplify_line(&[], [1.0, 1.0]).is_empty());
    }
}
