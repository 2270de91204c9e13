//! Long series reduced to what a screen can show.

use ndarray::{ArrayView1, ArrayView2, Axis};

/// The number of points above which a figure thins a series: two for each of its pixels, and some room.
pub const MOST_POINTS: usize = 1600;

/// Returns the indices of the points to draw: of each of `stretches` stretches the first, the lowest, the highest and the last,
/// so that every peak stays. Each row of `points` is (x, y). A stretch that holds a point without a finite y keeps it, so that gaps
/// stay gaps. With at most four points for each stretch, all are kept.
pub fn thin_points(points: ArrayView2<f64>, stretches: usize) -> Vec<usize> {
    let (count, stretches) = (points.nrows(), stretches.max(1));
    if count <= 4 * stretches {
        return (0..count).collect();
    }
    let length = count.div_ceil(stretches);
    let ordinates = points.index_axis(Axis(1), 1);
    let starts = (0..count).step_by(length);
    starts.flat_map(|start| extremes(ordinates, start, (start + length).min(count))).collect()
}

/// Returns the first, lowest, highest, one that is not finite, and last point of a stretch.
fn extremes(ordinates: ArrayView1<f64>, start: usize, end: usize) -> Vec<usize> {
    let finite = || (start..end).filter(|k| ordinates[*k].is_finite());
    let lowest = finite().min_by(|a, b| ordinates[*a].total_cmp(&ordinates[*b]));
    let highest = finite().max_by(|a, b| ordinates[*a].total_cmp(&ordinates[*b]));
    let gap = (start..end).find(|k| !ordinates[*k].is_finite());
    let mut kept: Vec<usize> =
        [Some(start), lowest, highest, gap, Some(end - 1)].into_iter().flatten().collect();
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn wave(count: usize) -> Array2<f64> {
        Array2::from_shape_fn(
            (count, 2),
            |(k, column)| {
                if column == 0 { k as f64 } else { (k as f64 * 0.01).sin() }
            },
        )
    }

    #[test]
    fn peaks_survive_and_order_stays() {
        let mut points = wave(100_000);
        points[[77_777, 1]] = 9.0;
        points[[12_345, 1]] = -9.0;
        let kept = thin_points(points.view(), MOST_POINTS / 4);
        assert!(kept.len() <= MOST_POINTS);
        assert!(kept.contains(&77_777) && kept.contains(&12_345));
        assert!(kept.is_sorted());
    }

    #[test]
    fn a_gap_stays_a_gap_and_a_short_series_stays_whole() {
        let mut points = wave(10_000);
        points[[5_003, 1]] = f64::NAN;
        assert!(thin_points(points.view(), 400).contains(&5_003));
        assert_eq!(thin_points(wave(1600).view(), 400).len(), 1600);
        assert!(thin_points(Array2::zeros((0, 2)).view(), 400).is_empty());
    }
}
