//! Dashed lines as the dashes they are made of: plotters' bitmap backend draws unbroken lines alone.

use plotters_backend::BackendCoord;

/// Returns the dashes of a line through points; the whole line if there are no lengths.
pub(crate) fn cut_dashes(points: &[BackendCoord], lengths: &[f64]) -> Vec<Vec<BackendCoord>> {
    if lengths.is_empty() || lengths.iter().sum::<f64>() < 1.0 {
        return vec![points.to_vec()];
    }
    let mut dashes = Vec::new();
    let mut dash: Vec<BackendCoord> = points.first().copied().into_iter().collect();
    let (mut turn, mut left) = (0, lengths[0]);
    for pair in points.windows(2) {
        let (dx, dy) = (f64::from(pair[1].0 - pair[0].0), f64::from(pair[1].1 - pair[0].1));
        let length = dx.hypot(dy);
        let mut gone = 0.0;
        while length - gone > left {
            gone += left;
            let part = gone / length;
            let at = (
                (f64::from(pair[0].0) + part * dx).round() as i32,
                (f64::from(pair[0].1) + part * dy).round() as i32,
            );
            dash.push(at);
            if turn % 2 == 0 {
                dash.dedup();
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash = vec![at];
            }
            turn += 1;
            left = lengths[turn % lengths.len()].max(0.1);
        }
        left -= length - gone;
        dash.push(pair[1]);
    }
    if turn % 2 == 0 && dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_run_on_over_corners() {
        let dashes = cut_dashes(&[(0, 0), (10, 0), (10, 10)], &[4.0, 2.0]);
        assert_eq!(
            dashes,
            [vec![(0, 0), (4, 0)], vec![(6, 0), (10, 0)], vec![(10, 2), (10, 6)], vec![(10, 8), (10, 10)]]
        );
        assert_eq!(cut_dashes(&[(0, 0), (3, 0)], &[]), [vec![(0, 0), (3, 0)]]);
    }
}
