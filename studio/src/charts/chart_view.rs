//! A chart drawn in the window: its title and legend, its plot, and the cursor that charts of a group share.

use egui::{Ui, Vec2};
use egui_plot::{AxisHints, Line, LineStyle, Plot, PlotPoints, PlotTransform};

use super::axis_ticks::{X_DISTANCE, Y_DISTANCE, axis_ticks, format_decade_tick, format_linear_tick};
use super::bound_regions::draw_bounds;
use super::chart::{AxisScale, Chart, ChartCurve, LineDash, PlotAxis};
use super::chart_heading::{HeadingResponse, HeadingStyle, show_heading};
use super::hidden_curves::HiddenCurves;
use super::line_simplification::simplify_line;
use super::plot_labels::draw_labels;
use super::plot_limits::PlotLimits;
use super::second_cursor::{second_cursor, toggle_second_cursor};
use crate::theme::WindowTheme;
use crate::tolerance::FEWEST_BAND_POINTS;

/// Margin of the card around a plot, both sides together, points.
const CARD_MARGIN: f32 = 18.0;
/// Length of an axis beside which no label stands: the numbers of the other axis, points.
const AXIS_ROOM: f32 = 30.0;
/// Least height of a plot, points.
const LEAST_HEIGHT: f32 = 40.0;

/// Style of a chart.
#[derive(Debug, Clone, Copy)]
pub struct ChartStyle<'a> {
    /// Colours.
    pub theme: &'a WindowTheme,
    /// Key of the limits beside the chart's own axes: if it changes, the chart is fitted again.
    pub scope: &'a str,
    /// What the button in the corner of a tile does; `None` for a chart that is no tile.
    pub corner: Option<&'a str>,
}

/// Response of a chart to the user.
pub struct ChartResponse {
    /// Transform from plot coordinates to the screen; logarithmic axes are in decades.
    pub transform: PlotTransform,
    /// The plot as a widget.
    pub response: egui::Response,
    /// The limits, to be reset.
    pub limits: PlotLimits,
    /// The title, and the button in the corner.
    pub heading: HeadingResponse,
}

/// Shows a chart in a card, with the legend above the plot.
pub fn show_chart(ui: &mut Ui, chart: &Chart, style: ChartStyle, size: Vec2) -> ChartResponse {
    let inner = size - Vec2::splat(CARD_MARGIN);
    style
        .theme
        .card()
        .show(ui, |ui| {
            ui.set_width(inner.x);
            ui.spacing_mut().item_spacing.y = 2.0;
            let mut limits = PlotLimits::new(chart, style.scope);
            let top = ui.cursor().top();
            let cursor = cursor_position(ui, chart);
            let second = second_cursor(ui.ctx(), chart);
            let heading_style = HeadingStyle { theme: style.theme, corner: style.corner, cursor, second };
            let heading = show_heading(ui, chart, &heading_style, &limits);
            let height = (inner.y - (ui.cursor().top() - top) - 2.0).max(LEAST_HEIGHT);
            let (transform, response) =
                show_plot(ui, chart, style.theme, Vec2::new(inner.x, height), &mut limits);
            if response.double_clicked() {
                limits.reset(ui);
            }
            ChartResponse { transform, response, limits, heading }
        })
        .inner
}

/// Returns the name under which the cursor of the chart, or of its group, is kept.
fn cursor_id(chart: &Chart) -> egui::Id {
    egui::Id::unique(("cursor", chart.group.unwrap_or(chart.title.as_str())))
}

/// Returns where the pointer stood on the chart, or on another of its group, in the frame before.
pub fn cursor_position(ui: &Ui, chart: &Chart) -> Option<f64> {
    let kept: Option<(u64, f64)> = ui.data(|d| d.get_temp(cursor_id(chart)));
    let (frame, x) = kept?;
    (ui.ctx().cumulative_frame_nr() <= frame + 1).then_some(x)
}

fn keep_cursor(ui: &Ui, chart: &Chart, transform: &PlotTransform, response: &egui::Response) {
    if let Some(at) = response.hover_pos() {
        let x = chart.value_at(PlotAxis::X, transform.value_from_position(at).x);
        let frame = ui.ctx().cumulative_frame_nr();
        ui.data_mut(|d| d.insert_temp(cursor_id(chart), (frame, x)));
    }
}

fn show_plot(
    ui: &mut Ui,
    chart: &Chart,
    theme: &WindowTheme,
    size: Vec2,
    limits: &mut PlotLimits,
) -> (PlotTransform, egui::Response) {
    let area = egui::Rect::from_min_size(ui.cursor().min, size);
    let label_lengths = [size.x, size.y].map(|side| side - AXIS_ROOM);
    let labels: [String; 2] = std::array::from_fn(|k| fit_label(ui, &chart.labels[k], label_lengths[k]));
    let hints = |axis: PlotAxis| axis_hints(&labels[axis.index()], chart.scales[axis.index()], axis, theme);
    limits.take_wheel(ui, area);
    let hidden = HiddenCurves::load(ui.ctx(), chart);
    let scales = chart.scales;
    // a plot keeps its limits wherever its tile stands
    let mut plot = Plot::new(("chart", &chart.title))
        .id(egui::Id::unique(("chart", &chart.title)))
        .width(size.x)
        .height(size.y)
        .custom_x_axes(vec![hints(PlotAxis::X)])
        .custom_y_axes(vec![hints(PlotAxis::Y).min_thickness(48.0)])
        .grid_color(theme.grid)
        .grid_spacing(egui::Rangef::new(5.0, 60.0))
        .show_background(false)
        .allow_double_click_reset(false)
        .allow_scroll(false)
        .set_margin_fraction(Vec2::new(0.0, 0.06))
        .label_formatter(|_| None)
        .x_grid_spacer(move |input| axis_ticks(scales[0], input, size.x / X_DISTANCE))
        .y_grid_spacer(move |input| axis_ticks(scales[1], input, size.y / Y_DISTANCE));
    if let Some(group) = chart.group {
        let id = egui::Id::unique(("group", group));
        plot = plot.link_axis(id, [true, false]).link_cursor(id, [true, false]);
    }
    let second = second_cursor(ui.ctx(), chart);
    let shown = plot.show(ui, |plot| {
        limits.apply(chart, plot);
        draw_second_cursor(plot, chart, theme, second);
        draw_chart(plot, chart, &hidden, theme, size);
    });
    let (title, response) = (chart.title.clone(), shown.response);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("plot: {title}")));
    keep_cursor(ui, chart, &shown.transform, &response);
    if response.clicked()
        && ui.input(|input| input.modifiers.shift)
        && let Some(x) = cursor_position(ui, chart)
    {
        toggle_second_cursor(ui.ctx(), chart, x);
    }
    draw_bounds(ui, chart, theme, &shown.transform);
    draw_labels(ui, chart, theme, &shown.transform);
    (shown.transform, response)
}

/// Returns the label of an axis as it fits beside it: whole, or its unit, or cut.
fn fit_label(ui: &Ui, label: &str, length: f32) -> String {
    let fits = |text: &str| {
        let font = egui::TextStyle::Small.resolve(ui.style());
        ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::WHITE).size().x <= length
    };
    if fits(label) {
        return label.to_owned();
    }
    if let Some((_, unit)) = label.rsplit_once(", ").filter(|(_, unit)| fits(unit)) {
        return unit.to_owned();
    }
    let letters: Vec<char> = label.chars().collect();
    let cut = |count: usize| letters[..count].iter().collect::<String>().trim_end().to_owned() + "\u{2026}";
    let most = (1..letters.len()).rev().map(cut).find(|text| fits(text));
    most.unwrap_or_default()
}

fn axis_hints<'a>(label: &str, scale: AxisScale, axis: PlotAxis, theme: &WindowTheme) -> AxisHints<'a> {
    let hints = if axis == PlotAxis::X { AxisHints::new_x() } else { AxisHints::new_y() };
    let format_tick = match scale {
        AxisScale::Linear => format_linear_tick,
        AxisScale::Log => format_decade_tick,
    };
    hints
        .label(egui::RichText::new(label).small().color(theme.weak))
        .formatter(move |mark, _| format_tick(mark))
        .label_spacing(egui::Rangef::new(1.0, 2.0))
        .tick_label_color(theme.text.gamma_multiply(0.85))
        .tick_label_font(egui::FontId::proportional(12.0))
}

fn draw_chart<'a>(
    plot: &mut egui_plot::PlotUi<'a>,
    chart: &'a Chart,
    hidden: &HiddenCurves,
    theme: &WindowTheme,
    size: Vec2,
) {
    for level in &chart.levels {
        let y = chart.plot_coordinate(PlotAxis::Y, *level);
        let colour = theme.weak.gamma_multiply(0.6);
        plot.hline(egui_plot::HLine::new("", y).color(colour).width(1.0).allow_hover(false));
    }
    let bounds = plot.plot_bounds();
    let visible = if plot.auto_bounds().x {
        [f64::NEG_INFINITY, f64::INFINITY]
    } else {
        [chart.value_at(PlotAxis::X, bounds.min()[0]), chart.value_at(PlotAxis::X, bounds.max()[0])]
    };
    let pixels_per_unit = [f64::from(size.x) / bounds.width(), f64::from(size.y) / bounds.height()];
    for curve in chart.curves.iter().filter(|curve| !hidden.contains(&curve.name)) {
        let points = curve.points.visible_points(visible, size.x as usize);
        let coordinates = |p: &[f64; 2]| {
            [chart.plot_coordinate(PlotAxis::X, p[0]), chart.plot_coordinate(PlotAxis::Y, p[1])]
        };
        let points: Vec<[f64; 2]> = points.iter().map(coordinates).collect();
        // a point without numbers breaks a path
        for run in points.split(|point| point.iter().any(|value| value.is_nan())) {
            draw_line(plot, curve, run.to_vec(), pixels_per_unit);
        }
    }
    draw_spots(plot, chart, theme);
    draw_marks(plot, chart, theme);
}

fn draw_line<'a>(
    plot: &mut egui_plot::PlotUi<'a>,
    curve: &'a ChartCurve,
    mut points: Vec<[f64; 2]>,
    pixels_per_unit: [f64; 2],
) {
    let style = match curve.dash {
        LineDash::Solid => LineStyle::Solid,
        LineDash::Dashed => LineStyle::dashed_dense(),
        LineDash::Dotted => LineStyle::dotted_dense(),
    };
    if curve.dash != LineDash::Solid && pixels_per_unit.iter().all(|v| v.is_finite()) {
        points = simplify_line(&points, pixels_per_unit);
    }
    let is_dense = points.len() > FEWEST_BAND_POINTS;
    let line = Line::new(&curve.name, PlotPoints::from(points)).allow_band(is_dense);
    plot.line(line.color(curve.colour).width(1.6).style(style));
}

/// Draws the second cursor as a dashed line.
fn draw_second_cursor(
    plot: &mut egui_plot::PlotUi<'_>,
    chart: &Chart,
    theme: &WindowTheme,
    second: Option<f64>,
) {
    let Some(x) = second.map(|x| chart.plot_coordinate(PlotAxis::X, x)) else { return };
    let line = egui_plot::VLine::new("", x).color(theme.accent).width(1.2).allow_hover(false);
    plot.vline(line.style(LineStyle::dashed_dense()));
}

fn draw_spots(plot: &mut egui_plot::PlotUi<'_>, chart: &Chart, theme: &WindowTheme) {
    for spot in &chart.spots {
        let place =
            [chart.plot_coordinate(PlotAxis::X, spot.at[0]), chart.plot_coordinate(PlotAxis::Y, spot.at[1])];
        let point = egui_plot::Points::new("", vec![place]);
        plot.points(point.color(spot.colour.unwrap_or(theme.accent)).radius(4.5).allow_hover(false));
    }
}

fn draw_marks(plot: &mut egui_plot::PlotUi<'_>, chart: &Chart, theme: &WindowTheme) {
    for mark in &chart.marks {
        let x = chart.plot_coordinate(PlotAxis::X, mark.x);
        let colour = theme.weak.gamma_multiply(0.7);
        plot.vline(egui_plot::VLine::new("", x).color(colour).width(1.0).allow_hover(false));
    }
}
