//! What a picture of a front shows of its designs: the best figure of each objective, and the designs of a kind that no other beats in two objectives.

use counterpoise_synth::FrontObjective;

/// The figures of a design, by its place among the designs of the front.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedFigures<'a> {
    pub place: usize,
    pub figures: &'a [f64],
}

/// Returns the best figure of any design in each objective.
pub(super) fn best_figures(designs: &[PlacedFigures<'_>], objectives: &[FrontObjective]) -> Vec<f64> {
    let best = |(k, objective): (usize, &FrontObjective)| {
        let all = designs.iter().map(|design| design.figures[k]);
        if objective.is_margin() {
            all.fold(f64::NEG_INFINITY, f64::max)
        } else {
            all.fold(f64::INFINITY, f64::min)
        }
    };
    objectives.iter().enumerate().map(best).collect()
}

/// Returns, for each objective but the first one, the places of the designs that no other of them beats in it and in the first one.
pub(super) fn best_places(designs: &[PlacedFigures<'_>], objectives: &[FrontObjective]) -> Vec<Vec<usize>> {
    let turn = |k: usize| if objectives[k].is_margin() { -1.0 } else { 1.0 };
    let edge = |other: usize| {
        let point = |design: &PlacedFigures<'_>| EdgePoint {
            place: design.place,
            costs: [other, 0].map(|k| turn(k) * design.figures[k]),
        };
        let is_finite = |point: &EdgePoint| point.costs.iter().all(|cost| cost.is_finite());
        lower_edge(designs.iter().map(point).filter(is_finite).collect())
    };
    (1..objectives.len()).map(edge).collect()
}

/// A design in two objectives, of each of which less is better.
#[derive(Debug, Clone, Copy)]
struct EdgePoint {
    place: usize,
    costs: [f64; 2],
}

/// Returns the places of the points that no other beats in both costs, by the first one.
fn lower_edge(mut points: Vec<EdgePoint>) -> Vec<usize> {
    let order = |a: &EdgePoint, b: &EdgePoint| {
        a.costs[0].total_cmp(&b.costs[0]).then(a.costs[1].total_cmp(&b.costs[1]))
    };
    points.sort_by(order);
    let mut edge: Vec<EdgePoint> = Vec::new();
    for point in points {
        if edge.last().is_none_or(|last| point.costs[1] < last.costs[1]) {
            edge.push(point);
        }
    }
    edge.into_iter().map(|point| point.place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_joins_the_points_that_no_other_beats() {
        let places = |costs: &[[f64; 2]]| {
            let point = |(place, costs): (usize, &[f64; 2])| EdgePoint { place, costs: *costs };
            lower_edge(costs.iter().enumerate().map(point).collect())
        };
        let points = [[2.0, 2.0], [1.0, 3.0], [3.0, 2.5], [4.0, 1.0], [1.0, 4.0]];
        assert_eq!(places(&points), [1, 0, 3]);
        assert_eq!(places(&points.map(|[x, y]| [-x, y])), [3]);
        assert!(places(&[]).is_empty());
    }
}
