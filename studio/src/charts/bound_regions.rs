//! The limits of a chart: the region on the wrong side of each is shaded.

use egui::{Color32, Pos2, Rect, Stroke, Ui};
use egui_plot::PlotTransform;

use super::chart::{BoundTone, Chart, ChartBound, ForbiddenSide, PlotAxis};
use crate::theme::WindowTheme;

/// Opacity of a region whose limit holds, of one whose limit is broken, and of what lies outside a window.
const OPACITY: [f32; 3] = [0.10, 0.24, 0.16];

/// Distance of the first grip from the end of its edge, as a share of it, and of the next ones from each other.
const GRIP_PLACE: f32 = 0.06;
const GRIP_STEP: f32 = 0.13;

/// A limit as it lies in a plot on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundArea {
    /// The shaded region.
    pub region: Rect,
    /// The two ends of the limit itself.
    pub edge: [Pos2; 2],
}

impl BoundArea {
    /// Returns the middle of the grip of the limit with a number: grips of limits that lie together stand beside each other.
    pub fn grip_centre(&self, index: usize) -> Pos2 {
        let [start, end] = self.edge;
        let share = (GRIP_PLACE + GRIP_STEP * index as f32).min(1.0 - GRIP_PLACE);
        end + (start - end) * share
    }
}

/// Returns where a limit lies on the screen; `None` if neither the limit nor anything of its region is in view.
pub fn bound_area(chart: &Chart, bound: &ChartBound, transform: &PlotTransform) -> Option<BoundArea> {
    let bounds = transform.bounds();
    let view = |axis: PlotAxis| (bounds.min()[axis.index()], bounds.max()[axis.index()]);
    let limit = chart.plot_coordinate(bound.axis, bound.at);
    let (low, high) = view(bound.axis);
    let along_axis = match bound.side {
        ForbiddenSide::Larger => (limit.max(low), high),
        ForbiddenSide::Smaller => (low, limit.min(high)),
    };
    let other = bound.axis.other();
    let (first, last) = view(other);
    let across = bound.span.map_or((first, last), |[from, to]| {
        (chart.plot_coordinate(other, from).max(first), chart.plot_coordinate(other, to).min(last))
    });
    if along_axis.0 > along_axis.1 || across.0 >= across.1 {
        return None;
    }
    let screen = |along: f64, across: f64| {
        let [x, y] = if bound.axis == PlotAxis::X { [along, across] } else { [across, along] };
        transform.position_from_point(&egui_plot::PlotPoint::new(x, y))
    };
    let region = Rect::from_two_pos(screen(along_axis.0, across.0), screen(along_axis.1, across.1));
    let edge = limit.clamp(low, high);
    Some(BoundArea { region, edge: [screen(edge, across.0), screen(edge, across.1)] })
}

/// Returns the colour of a region.
pub fn bound_colour(bound: &ChartBound, theme: &WindowTheme) -> Color32 {
    if bound.tone == BoundTone::Outside { theme.accent } else { theme.bad }
}

/// Draws the limits of a chart over its plot.
pub fn draw_bounds(ui: &Ui, chart: &Chart, theme: &WindowTheme, transform: &PlotTransform) {
    let painter = ui.painter().with_clip_rect(transform.frame().intersect(ui.clip_rect()));
    for bound in &chart.bounds {
        let Some(BoundArea { region, edge }) = bound_area(chart, bound, transform) else { continue };
        let colour = bound_colour(bound, theme);
        let opacity = match bound.tone {
            BoundTone::Kept => OPACITY[0],
            BoundTone::Broken => OPACITY[1],
            BoundTone::Outside => OPACITY[2],
        };
        painter.rect_filled(region, 0.0, colour.gamma_multiply(opacity));
        let width = if bound.is_selected { 2.0 } else { 1.0 };
        let line = if bound.is_selected { colour } else { colour.gamma_multiply(0.6) };
        painter.line_segment(edge, Stroke::new(width, line));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use egui::pos2;
    use egui_plot::PlotBounds;

    #[test]
    fn a_region_lies_on_the_wrong_side_and_ends_with_the_plot() {
        let chart = Chart::new("step", "time, s", "rate");
        let frame = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));
        let transform =
            PlotTransform::new(frame, PlotBounds::from_min_max([0.0, 0.0], [10.0, 10.0]), [false; 2]);
        let mut bound = ChartBound {
            label: "overshoot".to_owned(),
            axis: PlotAxis::Y,
            at: 8.0,
            side: ForbiddenSide::Larger,
            span: Some([5.0, f64::INFINITY]),
            tone: BoundTone::Kept,
            is_selected: false,
        };
        let area = bound_area(&chart, &bound, &transform).unwrap();
        assert_eq!(area.region, Rect::from_min_max(pos2(50.0, 0.0), pos2(100.0, 20.0)));
        assert_eq!(area.edge, [pos2(50.0, 20.0), pos2(100.0, 20.0)]);
        bound.side = ForbiddenSide::Smaller;
        assert_eq!(bound_area(&chart, &bound, &transform).unwrap().region.height(), 80.0);
        bound.at = -1.0;
        assert_eq!(bound_area(&chart, &bound, &transform), None, "nothing of it is in view");
    }
}
