//! Curves and areas cut to their panel: plotters draws everything that it is given.
//!
//! Points are places on both axes: (0, 0) is the lower left corner of the panel, (1, 1) the upper right one.

use crate::figure::Point;

/// Returns the parts of a polyline that lie in the panel (Liang and Barsky, 1984, segment by segment). A single point is a part.
pub(crate) fn polyline(points: &[Point]) -> Vec<Vec<Point>> {
    if let [point] = points {
        let is_inside = (0.0..=1.0).contains(&point.x) && (0.0..=1.0).contains(&point.y);
        return if is_inside { vec![vec![*point]] } else { Vec::new() };
    }
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut is_open = false;
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let Some((first, last)) = part_inside(from, to) else {
            is_open = false;
            continue;
        };
        match parts.last_mut().filter(|_| is_open && first == 0.0) {
            Some(part) => part.push(interpolate_point(from, to, last)),
            None => parts.push(vec![interpolate_point(from, to, first), interpolate_point(from, to, last)]),
        }
        is_open = last == 1.0;
    }
    parts
}

/// Returns where a segment enters and leaves the panel, as parts of its length.
fn part_inside(from: Point, to: Point) -> Option<(f64, f64)> {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let edges = [(-dx, from.x), (dx, 1.0 - from.x), (-dy, from.y), (dy, 1.0 - from.y)];
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (towards, room) in edges {
        if towards == 0.0 && room < 0.0 {
            return None;
        } else if towards < 0.0 {
            first = first.max(room / towards);
        } else if towards > 0.0 {
            last = last.min(room / towards);
        }
    }
    (first <= last).then_some((first, last))
}

fn interpolate_point(from: Point, to: Point, part: f64) -> Point {
    match part {
        0.0 => from,
        1.0 => to,
        _ => Point::new(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)),
    }
}

/// Returns the part of a closed area that lies in the panel (Sutherland and Hodgman, 1974).
pub(crate) fn polygon(corners: &[Point]) -> Vec<Point> {
    let room: [fn(Point) -> f64; 4] = [|p| p.x, |p| 1.0 - p.x, |p| p.y, |p| 1.0 - p.y];
    room.into_iter().fold(corners.to_vec(), |corners, room| cut(&corners, room))
}

/// Returns the part of an area in which there is room.
fn cut(corners: &[Point], room: fn(Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(corners.len() + 2);
    for (k, to) in corners.iter().enumerate() {
        let from = corners[(k + corners.len() - 1) % corners.len()];
        let (before, after) = (room(from), room(*to));
        if (before < 0.0) != (after < 0.0) {
            kept.push(interpolate_point(from, *to, before / (before - after)));
        }
        if after >= 0.0 {
            kept.push(*to);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points<const N: usize>(of: [(f64, f64); N]) -> [Point; N] {
        of.map(Point::from)
    }

    #[test]
    fn a_curve_that_leaves_and_returns_has_two_parts_that_end_at_the_edge() {
        let parts = polyline(&points([(0.1, 0.5), (0.3, 1.5), (0.5, 0.5), (0.6, 0.5)]));
        let expected = [
            points([(0.1, 0.5), (0.2, 1.0)]).to_vec(),
            points([(0.4, 1.0), (0.5, 0.5), (0.6, 0.5)]).to_vec(),
        ];
        assert_eq!(parts, expected);
    }

    #[test]
    fn what_crosses_the_panel_without_a_point_in_it_is_drawn() {
        assert_eq!(polyline(&points([(0.5, -1.0), (0.5, 2.0)])), [points([(0.5, 0.0), (0.5, 1.0)])]);
        assert!(polyline(&points([(-1.0, 0.5), (0.5, 2.1)])).is_empty());
        assert!(polyline(&[]).is_empty() && polyline(&points([(2.0, 0.5)])).is_empty());
    }

    #[test]
    fn an_area_is_cut_at_every_edge() {
        let cut = polygon(&points([(-1.0, -1.0), (2.0, -1.0), (2.0, 0.5), (-1.0, 0.5)]));
        assert!(cut.iter().all(|p| (0.0..=1.0).contains(&p.x) && (0.0..=0.5).contains(&p.y)), "{cut:?}");
        assert_eq!(cut.len(), 4);
        assert!(polygon(&[]).is_empty());
    }
}
