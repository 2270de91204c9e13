//! The heading of a chart: its title, and the legend with the values at the cursor.

use egui::{Color32, Ui, Vec2};

use super::chart::{Chart, ChartCurve, LineDash};
use super::hidden_curves::HiddenCurves;
use super::plot_limits::PlotLimits;
use crate::help::glossary::describe_terms;
use crate::number_format::format_short;
use crate::theme::WindowTheme;

/// Height of the row with title and legend, points.
const ROW_HEIGHT: f32 = 20.0;
/// Size of titles and of legends, points.
const TITLE_SIZE: f32 = 13.0;
const LEGEND_SIZE: f32 = 12.0;
/// Share of the colour of a hidden curve's sign.
const HIDDEN_SHARE: f32 = 0.35;
/// Width of the sign of a curve.
const SWATCH_WIDTH: f32 = 16.0;
/// Gap between the parts of a legend.
const GAP: f32 = 5.0;
/// Room in the row of the title for the value at the cursor and the button Fit.
const TITLE_ROOM: f32 = 60.0;
/// Size of the button in the corner of a tile, points.
const CORNER_SIZE: f32 = 14.0;
/// Room for the number of the curves that a legend leaves out.
const REST_WIDTH: f32 = 30.0;

/// What a heading shows beside the chart's own title and legend.
pub struct HeadingStyle<'a> {
    /// Colours.
    pub theme: &'a WindowTheme,
    /// What the button in the corner does; `None` for a chart that is no tile.
    pub corner: Option<&'a str>,
    /// Position of the cursor on the x axis.
    pub cursor: Option<f64>,
    /// Position of the second cursor, from which differences are measured.
    pub second: Option<f64>,
}

/// Response of a heading to the user.
pub struct HeadingResponse {
    /// The title, by which a tile is dragged.
    pub title: egui::Response,
    /// The button in the corner of a tile.
    pub corner: Option<egui::Response>,
}

/// Shows title and legend in one row; if they do not fit, the legend has a row of its own.
pub fn show_heading(
    ui: &mut Ui,
    chart: &Chart,
    style: &HeadingStyle,
    limits: &PlotLimits,
) -> HeadingResponse {
    // the names alone decide, so that the plot does not jump when the pointer enters it
    let names = legend_width(ui, &legend_entries(chart, None, None));
    let room =
        ui.available_width() - TITLE_ROOM - if style.corner.is_some() { CORNER_SIZE + GAP } else { 0.0 };
    let fits = text_width(ui, &chart.title, TITLE_SIZE) + names < room;
    let entries = legend_entries(chart, style.cursor, style.second);
    let response = ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        let title = fits.then(|| show_title(ui, chart, style));
        let rest = ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            let corner =
                style.corner.map(|action| show_corner(ui, style.theme, &format!("{action} {}", chart.title)));
            if limits.is_users(ui) && ui.small_button("Fit").on_hover_text("double-click or Ctrl+F").clicked()
            {
                limits.reset(ui);
            }
            if let Some(x) = style.cursor {
                let difference = style.second.map_or_else(String::new, |from| difference_text(x - from));
                let text = egui::RichText::new(format!("at {}{difference}", format_short(x)));
                ui.label(text.small().color(style.theme.accent));
            }
            let left = ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| match title {
                Some(title) => {
                    ui.add_space((ui.available_width() - legend_width(ui, &entries)).max(0.0));
                    show_entries(ui, chart, &entries, style.theme);
                    title
                }
                None => show_title(ui, chart, style),
            });
            HeadingResponse { title: left.inner, corner }
        });
        rest.inner
    });
    if !fits {
        ui.horizontal(|ui| show_entries(ui, chart, &entries, style.theme));
    }
    response.inner
}

/// Shows the title, which is dragged if the chart is a tile.
fn show_title(ui: &mut Ui, chart: &Chart, style: &HeadingStyle) -> egui::Response {
    let text = egui::RichText::new(&chart.title).strong();
    let label = egui::Label::new(text).truncate().selectable(false);
    if style.corner.is_none() {
        return with_terms(ui.add(label), &chart.title, "");
    }
    let title = ui.add(label.sense(egui::Sense::click_and_drag())).on_hover_cursor(egui::CursorIcon::Grab);
    with_terms(title, &chart.title, "drag it to move the plot, double-click to maximise it")
}

/// Shows the button in the corner of a tile: a frame, as that of a window.
fn show_corner(ui: &mut Ui, theme: &WindowTheme, name: &str) -> egui::Response {
    let (area, response) = ui.allocate_exact_size(Vec2::splat(CORNER_SIZE), egui::Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    let colour = if response.hovered() || response.has_focus() { theme.accent } else { theme.weak };
    let frame = area.shrink(2.0);
    ui.painter().rect_stroke(frame, 1.0, egui::Stroke::new(1.0, colour), egui::StrokeKind::Inside);
    ui.painter().hline(frame.x_range(), frame.top() + 1.0, egui::Stroke::new(2.0, colour));
    response.on_hover_text(name)
}

/// Shows the glossary's terms of a title and a hint while the pointer is on it.
fn with_terms(response: egui::Response, title: &str, hint: &str) -> egui::Response {
    if !response.hovered() {
        return response;
    }
    let terms = describe_terms(title).unwrap_or_default();
    let lines: Vec<&str> = [terms.as_str(), hint].into_iter().filter(|line| !line.is_empty()).collect();
    if lines.is_empty() { response } else { response.on_hover_text(lines.join("\n")) }
}

/// A curve with its text in the legend.
struct LegendEntry<'a> {
    curve: &'a ChartCurve,
    text: String,
}

impl LegendEntry<'_> {
    fn width(&self, ui: &Ui) -> f32 {
        text_width(ui, &self.text, LEGEND_SIZE) + SWATCH_WIDTH + 4.0 * GAP
    }
}

fn text_width(ui: &Ui, text: &str, size: f32) -> f32 {
    let font = egui::FontId::proportional(size);
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE).size().x
}

/// Returns a difference with its sign, in brackets.
fn difference_text(difference: f64) -> String {
    format!(" ({}{})", if difference < 0.0 { "" } else { "+" }, format_short(difference))
}

/// Returns the named curves with their names, with their values at the cursor if there is one, and with the differences from those at the second cursor. The curves of the design stand before
/// the dotted ones of others.
fn legend_entries(chart: &Chart, cursor: Option<f64>, second: Option<f64>) -> Vec<LegendEntry<'_>> {
    let text = |curve: &ChartCurve| {
        let at = |x: Option<f64>| x.and_then(|x| curve.points.value_at(x));
        match (at(cursor), at(second)) {
            (Some(value), Some(from)) => {
                format!("{} {}{}", curve.name, format_short(value), difference_text(value - from))
            }
            (Some(value), None) => format!("{} {}", curve.name, format_short(value)),
            (None, _) => curve.name.clone(),
        }
    };
    let named = chart.curves.iter().filter(|curve| !curve.name.is_empty());
    let mut entries: Vec<_> = named.map(|curve| LegendEntry { curve, text: text(curve) }).collect();
    entries.sort_by_key(|entry| entry.curve.dash == LineDash::Dotted);
    entries
}

fn legend_width(ui: &Ui, entries: &[LegendEntry]) -> f32 {
    entries.iter().map(|entry| entry.width(ui)).sum()
}

/// Shows a legend; the curves that do not fit are counted.
fn show_entries(ui: &mut Ui, chart: &Chart, entries: &[LegendEntry], theme: &WindowTheme) {
    let mut hidden = HiddenCurves::load(ui.ctx(), chart);
    let mut changed = false;
    ui.spacing_mut().item_spacing.x = GAP;
    let fits_all = legend_width(ui, entries) <= ui.available_width() + GAP;
    let mut room = ui.available_width() - if fits_all { -GAP } else { REST_WIDTH };
    let fits = |entry: &&LegendEntry| {
        room -= entry.width(ui);
        room >= 0.0
    };
    let shown = entries.iter().take_while(fits).count();
    for entry in &entries[..shown] {
        if show_entry(ui, chart, entry, &hidden, theme).clicked() {
            match ui.input(|input| input.modifiers.command) {
                true => hidden.isolate(chart, &entry.curve.name),
                false => hidden.toggle(&entry.curve.name),
            }
            changed = true;
        }
        ui.add_space(GAP);
    }
    if changed {
        hidden.store(ui.ctx(), chart);
    }
    if shown < entries.len() {
        let names: Vec<&str> = entries[shown..].iter().map(|entry| entry.text.as_str()).collect();
        let rest = egui::RichText::new(format!("+ {}", names.len())).small().color(theme.weak);
        ui.label(rest).on_hover_text(names.join("\n"));
    }
}

/// Shows a curve's sign and name; the name of a hidden one is struck through.
fn show_entry(
    ui: &mut Ui,
    chart: &Chart,
    entry: &LegendEntry,
    hidden: &HiddenCurves,
    theme: &WindowTheme,
) -> egui::Response {
    let is_hidden = hidden.contains(&entry.curve.name);
    draw_swatch(ui, entry.curve, if is_hidden { HIDDEN_SHARE } else { 1.0 });
    let text = egui::RichText::new(&entry.text).small().color(theme.weak);
    let label = egui::Label::new(if is_hidden { text.strikethrough() } else { text });
    let response = ui.add(label.selectable(false).sense(egui::Sense::click()));
    let name = format!("curve {} of {}", entry.curve.name, chart.title);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, !is_hidden, &name));
    response.on_hover_text("click: hide or show; Ctrl+click: this curve alone")
}

fn draw_swatch(ui: &mut Ui, curve: &ChartCurve, share: f32) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(SWATCH_WIDTH, 10.0), egui::Sense::hover());
    let line = [rect.left_center(), rect.right_center()];
    let colour = curve.colour.gamma_multiply(share);
    let stroke = egui::Stroke::new(2.0, colour);
    match curve.dash {
        LineDash::Solid => {
            ui.painter().line_segment(line, stroke);
        }
        LineDash::Dashed => ui.painter().extend(egui::Shape::dashed_line(&line, stroke, 5.0, 3.0)),
        LineDash::Dotted => ui.painter().extend(egui::Shape::dotted_line(&line, colour, 4.0, 1.2)),
    }
}
