//! Long series thinned to what a screen can show.

/// The least points a series has to have before it is thinned.
pub const MOST_POINTS: usize = 1600;

/// Keeps, of each of `MOST_POINTS / 4` stretches, the first, the lowest, the highest and the last point: every peak stays. Points
/// that are not finite are kept where a stretch begins or ends, so that gaps stay gaps.
pub fn thin(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let stretch = points.len().div_ceil(MOST_POINTS / 4);
    points.chunks(stretch).flat_map(|part| extremes(part).into_iter().map(|k| part[k])).collect()
}

fn extremes(part: &[(f64, f64)]) -> Vec<usize> {
    let lowest = (0..part.len()).fold(0, |best, k| if part[k].1 < part[best].1 { k } else { best });
    let highest = (0..part.len()).fold(0, |best, k| if part[k].1 > part[best].1 { k } else { best });
    let mut kept = vec![0, lowest, highest, part.len() - 1];
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_survive_and_order_stays() {
        let mut points: Vec<(f64, f64)> =
            (0..100_000).map(|k| (f64::from(k), (f64::from(k) * 0.01).sin())).collect();
        points[77_777].1 = 9.0;
        points[12_345].1 = -9.0;
        let thinned = thin(&points);
        assert!(thinned.len() <= MOST_POINTS);
        assert!(thinned.contains(&(77_777.0, 9.0)) && thinned.contains(&(12_345.0, -9.0)));
        assert!(thinned.is_sorted_by(|a, b| a.0 < b.0));
    }
}
