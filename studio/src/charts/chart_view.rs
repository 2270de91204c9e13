//! A chart drawn in the window: its title and legend, its plot, and the cursor that charts of a group share.

use egui::{Color32, Ui, Vec2};
use egui_plot::{AxisHints, Line, LineStyle, Plot, PlotPoint, PlotPoints, PlotTransform};

use super::axis_ticks::{X_DISTANCE, Y_DISTANCE, axis_ticks, format_decade_tick, format_linear_tick};
use super::bound_regions::draw_bounds;
use super::chart::{AxisScale, Chart, ChartCurve, LineDash, PlotAxis};
use super::line_simplification::simplify_line;
use super::plot_limits::PlotLimits;
use crate::help::glossary::describe_terms;
use crate::number_format::format_short;
use crate::theme::WindowTheme;

/// Height of the row with title and legend, points.
const HEADING_HEIGHT: f32 = 20.0;
/// Margin of the card around a plot, both sides together, points.
const CARD_MARGIN: f32 = 18.0;
/// Least height of a plot, points.
const LEAST_HEIGHT: f32 = 40.0;

/// Style of a chart.
#[derive(Debug, Clone, Copy)]
pub struct ChartStyle<'a> {
    /// Colours.
    pub theme: &'a WindowTheme,
    /// Key of the limits beside the chart's own axes: if it changes, the chart is fitted again.
    pub scope: &'a str,
}

/// Response of a chart to the user.
pub struct ChartResponse {
    /// Transform from plot coordinates to the screen; logarithmic axes are in decades.
    pub transform: PlotTransform,
    /// The plot as a widget.
    pub response: egui::Response,
    /// The limits, to be reset.
    pub limits: PlotLimits,
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
            show_heading(ui, chart, style.theme, &limits);
            let height = (inner.y - (ui.cursor().top() - top) - 2.0).max(LEAST_HEIGHT);
            let (transform, response) =
                show_plot(ui, chart, style.theme, Vec2::new(inner.x, height), &mut limits);
            if response.double_clicked() {
                limits.reset(ui);
            }
            ChartResponse { transform, response, limits }
        })
        .inner
}

/// Shows title and legend in one row; if they do not fit, the legend has a row of its own.
fn show_heading(ui: &mut Ui, chart: &Chart, theme: &WindowTheme, limits: &PlotLimits) {
    let cursor = cursor_position(ui, chart);
    let entries = legend_entries(chart, cursor);
    let width = |ui: &Ui, text: &str, size: f32| {
        let font = egui::FontId::proportional(size);
        ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE).size().x
    };
    let legend_width: f32 = entries.iter().map(|entry| width(ui, &entry.text, 11.0) + 28.0).sum();
    let fits = width(ui, &chart.title, 13.0) + legend_width + 60.0 < ui.available_width();
    ui.horizontal(|ui| {
        ui.set_height(HEADING_HEIGHT);
        if fits {
            with_terms(ui.label(egui::RichText::new(&chart.title).strong()), &chart.title);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 5.0;
            if limits.is_users(ui) && ui.small_button("Fit").on_hover_text("double-click or Ctrl+F").clicked()
            {
                limits.reset(ui);
            }
            if let Some(x) = cursor {
                ui.label(egui::RichText::new(format!("at {}", format_short(x))).small().color(theme.accent));
            }
            if fits {
                show_legend(ui, entries.iter().rev(), theme);
            } else {
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let title = egui::Label::new(egui::RichText::new(&chart.title).strong()).truncate();
                    with_terms(ui.add(title), &chart.title);
                });
            }
        });
    });
    if !fits {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 5.0;
            for entry in &entries {
                ui.horizontal(|ui| {
                    draw_swatch(ui, entry.curve);
                    ui.label(egui::RichText::new(&entry.text).small().color(theme.weak));
                });
            }
        });
    }
}

/// Shows the glossary's terms of a title while the pointer is on it.
fn with_terms(response: egui::Response, title: &str) {
    if response.hovered()
        && let Some(terms) = describe_terms(title)
    {
        response.on_hover_text(terms);
    }
}

/// A curve with its text in the legend.
struct LegendEntry<'a> {
    curve: &'a ChartCurve,
    text: String,
}

/// Returns the named curves with their names, and with their values at the cursor if there is one.
fn legend_entries(chart: &Chart, cursor: Option<f64>) -> Vec<LegendEntry<'_>> {
    let text = |curve: &ChartCurve| match cursor.and_then(|x| curve.points.value_at(x)) {
        Some(value) => format!("{} {}", curve.name, format_short(value)),
        None => curve.name.clone(),
    };
    chart
        .curves
        .iter()
        .filter(|c| !c.name.is_empty())
        .map(|curve| LegendEntry { curve, text: text(curve) })
        .collect()
}

/// Shows a legend from the right to the left.
fn show_legend<'a>(ui: &mut Ui, entries: impl Iterator<Item = &'a LegendEntry<'a>>, theme: &WindowTheme) {
    for LegendEntry { curve, text } in entries {
        ui.label(egui::RichText::new(text).small().color(theme.weak));
        draw_swatch(ui, curve);
    }
}

fn draw_swatch(ui: &mut Ui, curve: &ChartCurve) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(16.0, 10.0), egui::Sense::hover());
    let line = [rect.left_center(), rect.right_center()];
    let stroke = egui::Stroke::new(2.0, curve.colour);
    match curve.dash {
        LineDash::Solid => {
            ui.painter().line_segment(line, stroke);
        }
        LineDash::Dashed => ui.painter().extend(egui::Shape::dashed_line(&line, stroke, 5.0, 3.0)),
        LineDash::Dotted => ui.painter().extend(egui::Shape::dotted_line(&line, curve.colour, 4.0, 1.2)),
    }
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
    limits.take_wheel(ui, area);
    let scales = chart.scales;
    let mut plot = Plot::new(("chart", &chart.title))
        .width(size.x)
        .height(size.y)
        .custom_x_axes(vec![axis_hints(chart, PlotAxis::X, theme)])
        .custom_y_axes(vec![axis_hints(chart, PlotAxis::Y, theme).min_thickness(48.0)])
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
    let shown = plot.show(ui, |plot| {
        limits.apply(chart, plot);
        draw_chart(plot, chart, theme, size);
    });
    let (title, response) = (chart.title.clone(), shown.response);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("plot: {title}")));
    keep_cursor(ui, chart, &shown.transform, &response);
    draw_bounds(ui, chart, theme, &shown.transform);
    (shown.transform, response)
}

fn axis_hints<'a>(chart: &Chart, axis: PlotAxis, theme: &WindowTheme) -> AxisHints<'a> {
    let hints = if axis == PlotAxis::X { AxisHints::new_x() } else { AxisHints::new_y() };
    let format_tick = match chart.scales[axis.index()] {
        AxisScale::Linear => format_linear_tick,
        AxisScale::Log => format_decade_tick,
    };
    hints
        .label(egui::RichText::new(&chart.labels[axis.index()]).small().color(theme.weak))
        .formatter(move |mark, _| format_tick(mark))
        .label_spacing(egui::Rangef::new(1.0, 2.0))
        .tick_label_color(theme.text.gamma_multiply(0.85))
        .tick_label_font(egui::FontId::proportional(11.0))
}

fn draw_chart<'a>(plot: &mut egui_plot::PlotUi<'a>, chart: &'a Chart, theme: &WindowTheme, size: Vec2) {
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
    for curve in &chart.curves {
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
    let line = Line::new(&curve.name, PlotPoints::from(points));
    plot.line(line.color(curve.colour).width(1.6).style(style));
}

fn draw_spots(plot: &mut egui_plot::PlotUi<'_>, chart: &Chart, theme: &WindowTheme) {
    for spot in &chart.spots {
        let place =
            [chart.plot_coordinate(PlotAxis::X, spot.at[0]), chart.plot_coordinate(PlotAxis::Y, spot.at[1])];
        let point = egui_plot::Points::new("", vec![place]);
        plot.points(point.color(theme.accent).radius(4.5).allow_hover(false));
        let text = egui::RichText::new(format!("  {}", spot.label)).small().color(theme.text);
        let at = PlotPoint::new(place[0], place[1]);
        plot.text(egui_plot::Text::new("", at, text).anchor(egui::Align2::LEFT_BOTTOM));
    }
}

/// Share of the height at which the label of the first mark stands, and by which that of a mark close by stands lower.
const LABEL_HEIGHT: f64 = 0.94;
const LABEL_STEP: f64 = 0.08;
/// Share of the width from which a label stands to the left of its mark.
const LEFT_LABEL_FROM: f64 = 0.7;
/// Share of the width within which two labels would overlap.
const LABEL_WIDTH: f64 = 0.16;

fn draw_marks(plot: &mut egui_plot::PlotUi<'_>, chart: &Chart, theme: &WindowTheme) {
    let bounds = plot.plot_bounds();
    let mut labelled: Vec<f64> = Vec::new();
    for mark in &chart.marks {
        let x = chart.plot_coordinate(PlotAxis::X, mark.x);
        let colour = theme.weak.gamma_multiply(0.7);
        plot.vline(egui_plot::VLine::new("", x).color(colour).width(1.0).allow_hover(false));
        let close = labelled.iter().filter(|other| (*other - x).abs() < LABEL_WIDTH * bounds.width()).count();
        labelled.push(x);
        let height = LABEL_HEIGHT - LABEL_STEP * close as f64;
        let y = bounds.min()[1] + height * (bounds.max()[1] - bounds.min()[1]);
        let text = egui::RichText::new(format!(" {} ", mark.label)).small().color(theme.weak);
        let is_right = x > bounds.min()[0] + LEFT_LABEL_FROM * bounds.width();
        let side = if is_right { egui::Align2::RIGHT_CENTER } else { egui::Align2::LEFT_CENTER };
        plot.text(egui_plot::Text::new("", PlotPoint::new(x, y), text).anchor(side));
    }
}
