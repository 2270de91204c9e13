//! Grips on the edges of shaded regions in plots: the limits of requirements, and the ends of a window.

use egui::{Id, Rect, Response, Sense, Stroke, Ui, Vec2};

use super::plot_handles::moved_position;
use crate::charts::bound_regions::{bound_area, bound_colour};
use crate::charts::chart::{Chart, ChartBound, PlotAxis};
use crate::charts::chart_view::ChartResponse;
use crate::theme::WindowTheme;

/// Size of a grip on the edge of a region, points.
const GRIP: Vec2 = Vec2::new(18.0, 10.0);

/// A grip on an edge.
pub struct EdgeGrip<'a> {
    /// The chart.
    pub chart: &'a Chart,
    /// The chart on the screen.
    pub shown: &'a ChartResponse,
    /// The region.
    pub bound: &'a ChartBound,
    /// Its number in the chart: grips of edges that lie together stand beside each other.
    pub index: usize,
    /// Name for screen readers, also shown under the pointer.
    pub name: String,
}

/// A grip as it is after a frame.
pub struct GrippedEdge {
    /// The grip.
    pub response: Response,
    /// The place to which its edge is moved, in the unit of its axis.
    pub moved_to: Option<f64>,
}

/// Shows a grip, which is dragged or moved by the arrow keys; `None` if its edge is not in view.
pub fn show_edge_grip(ui: &Ui, theme: &WindowTheme, grip: &EdgeGrip) -> Option<GrippedEdge> {
    let at = bound_area(grip.chart, grip.bound, &grip.shown.transform)?.grip_centre(grip.index);
    let is_level = grip.bound.axis == PlotAxis::Y;
    let (size, icon) = if is_level {
        (GRIP, egui::CursorIcon::ResizeVertical)
    } else {
        (Vec2::new(GRIP.y, GRIP.x), egui::CursorIcon::ResizeHorizontal)
    };
    let id: Id = ui.scope_id().with(("edge", &grip.chart.title, grip.index));
    let area = Rect::from_center_size(at, size);
    let response = ui.interact(area.expand(4.0), id, Sense::click_and_drag()).on_hover_cursor(icon);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, grip.name.clone()));
    let is_active = response.hovered() || response.dragged() || response.has_focus();
    let width = if is_active || grip.bound.is_selected { 2.5 } else { 1.5 };
    let stroke = Stroke::new(width, bound_colour(grip.bound, theme));
    ui.painter().rect(area, 4.0, theme.card, stroke, egui::StrokeKind::Inside);
    let place = |to| {
        let point = grip.shown.transform.value_from_position(to);
        grip.chart.value_at(grip.bound.axis, if is_level { point.y } else { point.x })
    };
    let moved_to = moved_position(ui, &response, at).map(place).filter(|place| place.is_finite());
    let hint = format!("{}\ndrag it, or move it by the arrow keys", grip.name);
    Some(GrippedEdge { response: response.on_hover_text(hint), moved_to })
}
