//! The labels in a plot: of the selected limit, of marks and of points. None lies over another.

use egui::{Align2, Color32, FontId, Pos2, Rect, Ui, Vec2, pos2};
use egui_plot::{PlotPoint, PlotTransform};

use super::bound_regions::{bound_area, bound_colour};
use super::chart::{Chart, PlotAxis};
use crate::theme::WindowTheme;

/// Size of the text, points.
const TEXT_SIZE: f32 = 12.0;
/// Distance of a label from the edges of the plot and from its line, points.
const DISTANCE: f32 = 4.0;
/// Room that the grip of a limit takes, points.
const GRIP_SIZE: f32 = 18.0;
/// Distance of the label of a point from it, points: the radius of the point and a gap.
const POINT_DISTANCE: f32 = 7.0;

/// The places of labels in a plot.
struct LabelPlaces {
    frame: Rect,
    taken: Vec<Rect>,
}

impl LabelPlaces {
    fn is_free(&self, area: Rect) -> bool {
        self.frame.contains_rect(area) && !self.taken.iter().any(|other| other.intersects(area))
    }

    /// Takes the first free place, or the first place if none is free.
    fn take(&mut self, places: &[Rect]) -> Option<Pos2> {
        let place = places.iter().find(|place| self.is_free(**place)).or(places.first()).copied()?;
        self.taken.push(place);
        Some(place.min)
    }
}

/// Draws the labels of a chart over its plot.
pub fn draw_labels(ui: &Ui, chart: &Chart, theme: &WindowTheme, transform: &PlotTransform) {
    let frame = *transform.frame();
    let painter = ui.painter().with_clip_rect(frame.intersect(ui.clip_rect()));
    let mut places = LabelPlaces { frame, taken: Vec::new() };
    let layout = |text: &str, colour: Color32| {
        let room = (frame.width() - 2.0 * DISTANCE).max(TEXT_SIZE);
        painter.layout(text.to_owned(), FontId::proportional(TEXT_SIZE), colour, room)
    };
    for (index, bound) in chart.bounds.iter().enumerate() {
        let area = bound_area(chart, bound, transform);
        let grip = area.map(|area| Rect::from_center_size(area.grip_centre(index), Vec2::splat(GRIP_SIZE)));
        places.taken.extend(grip);
    }
    for bound in chart.bounds.iter().filter(|bound| bound.is_selected) {
        let Some(area) = bound_area(chart, bound, transform) else { continue };
        let galley = layout(&bound.label, bound_colour(bound, theme));
        let rows =
            rows_below(pos2(area.region.left() + DISTANCE, area.region.top() + 2.0), galley.size(), frame);
        if let Some(at) = places.take(&rows) {
            painter.galley(at, galley, theme.bad);
        }
    }
    for mark in chart.marks.iter().filter(|mark| !mark.label.is_empty()) {
        let x = chart.plot_coordinate(PlotAxis::X, mark.x);
        let line = transform.position_from_point(&PlotPoint::new(x, transform.bounds().min()[1])).x;
        if !frame.x_range().contains(line) {
            continue;
        }
        let galley = layout(&mark.label, theme.weak);
        let width = galley.size().x + DISTANCE;
        let right = if line + width < frame.right() { line + DISTANCE } else { line - width };
        let rows = rows_below(pos2(right, frame.top() + 2.0), galley.size(), frame);
        if let Some(at) = places.take(&rows) {
            painter.galley(at, galley, theme.weak);
        }
    }
    for spot in chart.spots.iter().filter(|spot| !spot.label.is_empty()) {
        let x = chart.plot_coordinate(PlotAxis::X, spot.at[0]);
        let y = chart.plot_coordinate(PlotAxis::Y, spot.at[1]);
        let at = transform.position_from_point(&PlotPoint::new(x, y));
        if !frame.contains(at) {
            continue;
        }
        let galley = layout(&spot.label, theme.text);
        if let Some(at) = places.take(&corners_about(at, galley.size())) {
            painter.galley(at, galley, theme.text);
        }
    }
}

/// Returns the places of a label in rows from a place downwards; it is moved to the left if it ends beyond the plot.
fn rows_below(at: Pos2, size: Vec2, frame: Rect) -> Vec<Rect> {
    let left = at.x.min(frame.right() - size.x - DISTANCE).max(frame.left());
    let top = at.y.max(frame.top() + 2.0);
    let count = ((frame.bottom() - top) / size.y.max(1.0)).max(1.0) as usize;
    (0..count).map(|k| Rect::from_min_size(pos2(left, top + k as f32 * size.y), size)).collect()
}

/// Returns the places of a label beside a point.
fn corners_about(at: Pos2, size: Vec2) -> Vec<Rect> {
    let d = POINT_DISTANCE;
    [
        (Align2::LEFT_BOTTOM, Vec2::new(d, -1.0)),
        (Align2::LEFT_TOP, Vec2::new(d, 1.0)),
        (Align2::RIGHT_BOTTOM, Vec2::new(-d, -1.0)),
        (Align2::RIGHT_TOP, Vec2::new(-d, 1.0)),
        (Align2::CENTER_BOTTOM, Vec2::new(0.0, -d - size.y)),
        (Align2::CENTER_TOP, Vec2::new(0.0, d + size.y)),
    ]
    .into_iter()
    .map(|(anchor, offset)| anchor.anchor_size(at + offset, size))
    .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_label_moves_down_until_it_is_free_and_stays_in_the_plot() {
        let frame = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 60.0));
        let mut places = LabelPlaces { frame, taken: Vec::new() };
        let size = Vec2::new(50.0, 12.0);
        let first = places.take(&rows_below(pos2(80.0, 0.0), size, frame)).unwrap();
        assert_eq!(first, pos2(46.0, 2.0), "it is moved into the plot");
        let second = places.take(&rows_below(pos2(60.0, 0.0), size, frame)).unwrap();
        assert!(second.y >= first.y + size.y, "it stands below the first");
        let beside = places.take(&corners_about(pos2(60.0, 20.0), Vec2::new(20.0, 12.0))).unwrap();
        let area = Rect::from_min_size(beside, Vec2::new(20.0, 12.0));
        assert_eq!(places.taken.iter().filter(|other| other.intersects(area)).count(), 1, "only itself");
    }
}
