//! One signal against another: pairs of samples of the same time, thinned to what a screen shows.

/// Cells of the coarsest grid that is tried first, on each axis: about the pixels of a plot.
const CELLS: f64 = 600.0;
/// Growth of a cell until few enough points are left.
const CELL_GROWTH: f64 = 1.5;

/// Returns the values of two signals at the times of a window that both have; both are pairs of time and value with rising times.
pub fn pair_samples(x: &[[f64; 2]], y: &[[f64; 2]], window_s: [f64; 2]) -> Vec<[f64; 2]> {
    let start = |samples: &[[f64; 2]]| samples.partition_point(|sample| sample[0] < window_s[0]);
    let (mut i, mut j) = (start(x), start(y));
    let mut pairs = Vec::new();
    while let (Some(a), Some(b)) = (x.get(i), y.get(j)) {
        if a[0] > window_s[1] || b[0] > window_s[1] {
            break;
        }
        // samples without a number were left out of either signal
        if a[0] == b[0] {
            pairs.push([a[1], b[1]]);
        }
        i += usize::from(a[0] <= b[0]);
        j += usize::from(b[0] <= a[0]);
    }
    pairs
}

/// Returns a path with at most so many points that differs from the given one by less than a cell of a grid over its range: of points
/// that follow each other in one cell, the first is kept.
pub fn thin_path(mut points: Vec<[f64; 2]>, most: usize) -> Vec<[f64; 2]> {
    let mut cells = CELLS;
    while points.len() > most.max(1) {
        let [low, high] = corners(&points);
        let cell = |point: &[f64; 2]| {
            [0, 1].map(|k| (cells * (point[k] - low[k]) / (high[k] - low[k]).max(f64::MIN_POSITIVE)) as i64)
        };
        points.dedup_by_key(|point| cell(point));
        cells /= CELL_GROWTH;
    }
    points
}

/// Returns the smallest and the largest coordinates of points.
fn corners(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let fold =
        |of: fn(f64, f64) -> f64, start: f64| [0, 1].map(|k| points.iter().map(|p| p[k]).fold(start, of));
    [fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_samples_of_the_same_time_and_window_are_paired() {
        let x = [[0.0, 1.0], [1.0, 2.0], [2.0, 3.0], [3.0, 4.0]];
        let y = [[0.0, 10.0], [2.0, 30.0], [3.0, 40.0]];
        assert_eq!(pair_samples(&x, &y, [0.0, 2.5]), [[1.0, 10.0], [3.0, 30.0]]);
        assert_eq!(pair_samples(&x, &y, [1.5, 9.0]), [[3.0, 30.0], [4.0, 40.0]]);
        assert!(pair_samples(&x, &[], [0.0, 9.0]).is_empty());
    }

    #[test]
    fn a_long_path_is_thinned_and_stays_where_it_was() {
        let circle = |k: usize| {
            let angle = 1e-4 * k as f64;
            [angle.cos(), angle.sin()]
        };
        let thin = thin_path((0..500_000).map(circle).collect(), 8000);
        assert!(thin.len() <= 8000 && thin.len() > 400, "{}", thin.len());
        for k in (0..60_000).step_by(500) {
            let at = circle(k);
            let distance =
                thin.iter().map(|p| (p[0] - at[0]).hypot(p[1] - at[1])).fold(f64::INFINITY, f64::min);
            assert!(distance < 0.1, "{k} {distance}");
        }
        let constant = thin_path(vec![[1.0, 1.0]; 20_000], 100);
        assert_eq!(constant, [[1.0, 1.0]]);
    }
}
