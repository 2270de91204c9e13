//! The heading of a chart: its title, and the legend with the values at the cursor.

use egui::{Color32, Ui, Vec2};

use super::chart::{Chart, ChartCurve, LineDash};
use super::plot_limits::PlotLimits;
use crate::help::glossary::describe_terms;
use crate::number_format::format_short;
use crate::theme::WindowTheme;

/// Height of the row with title and legend, points.
const ROW_HEIGHT: f32 = 20.0;
/// Size of titles and of legends, points.
const TITLE_SIZE: f32 = 13.0;
const LEGEND_SIZE: f32 = 11.0;
/// Width of the sign of a curve.
const SWATCH_WIDTH: f32 = 16.0;
/// Gap between the parts of a legend.
const GAP: f32 = 5.0;
/// Room in the row of the title for the value at the cursor and the button Fit.
const TITLE_ROOM: f32 = 60.0;
/// Room for the number of the curves that a legend leaves out.
const REST_WIDTH: f32 = 30.0;

/// Shows title and legend in one row; if they do not fit, the legend has a row of its own.
pub fn show_heading(
    ui: &mut Ui,
    chart: &Chart,
    theme: &WindowTheme,
    limits: &PlotLimits,
    cursor: Option<f64>,
) {
    // the names alone decide, so that the plot does not jump when the pointer enters it
    let names = legend_width(ui, &legend_entries(chart, None));
    let fits = text_width(ui, &chart.title, TITLE_SIZE) + names + TITLE_ROOM < ui.available_width();
    let entries = legend_entries(chart, cursor);
    ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        if fits {
            with_terms(ui.label(egui::RichText::new(&chart.title).strong()), &chart.title);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            if limits.is_users(ui) && ui.small_button("Fit").on_hover_text("double-click or Ctrl+F").clicked()
            {
                limits.reset(ui);
            }
            if let Some(x) = cursor {
                ui.label(egui::RichText::new(format!("at {}", format_short(x))).small().color(theme.accent));
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                if fits {
                    ui.add_space((ui.available_width() - legend_width(ui, &entries)).max(0.0));
                    show_entries(ui, &entries, theme);
                } else {
                    let title = egui::Label::new(egui::RichText::new(&chart.title).strong()).truncate();
                    with_terms(ui.add(title), &chart.title);
                }
            });
        });
    });
    if !fits {
        ui.horizontal(|ui| show_entries(ui, &entries, theme));
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

impl LegendEntry<'_> {
    fn width(&self, ui: &Ui) -> f32 {
        text_width(ui, &self.text, LEGEND_SIZE) + SWATCH_WIDTH + 4.0 * GAP
    }
}

fn text_width(ui: &Ui, text: &str, size: f32) -> f32 {
    let font = egui::FontId::proportional(size);
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE).size().x
}

/// Returns the named curves with their names, and with their values at the cursor if there is one. The curves of the design stand before
/// the dotted ones of others.
fn legend_entries(chart: &Chart, cursor: Option<f64>) -> Vec<LegendEntry<'_>> {
    let text = |curve: &ChartCurve| match cursor.and_then(|x| curve.points.value_at(x)) {
        Some(value) => format!("{} {}", curve.name, format_short(value)),
        None => curve.name.clone(),
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
fn show_entries(ui: &mut Ui, entries: &[LegendEntry], theme: &WindowTheme) {
    ui.spacing_mut().item_spacing.x = GAP;
    let fits_all = legend_width(ui, entries) <= ui.available_width() + GAP;
    let mut room = ui.available_width() - if fits_all { -GAP } else { REST_WIDTH };
    let fits = |entry: &&LegendEntry| {
        room -= entry.width(ui);
        room >= 0.0
    };
    let shown = entries.iter().take_while(fits).count();
    for LegendEntry { curve, text } in &entries[..shown] {
        draw_swatch(ui, curve);
        ui.label(egui::RichText::new(text).small().color(theme.weak));
        ui.add_space(GAP);
    }
    if shown < entries.len() {
        let names: Vec<&str> = entries[shown..].iter().map(|entry| entry.text.as_str()).collect();
        let rest = egui::RichText::new(format!("+ {}", names.len())).small().color(theme.weak);
        ui.label(rest).on_hover_text(names.join("\n"));
    }
}

fn draw_swatch(ui: &mut Ui, curve: &ChartCurve) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(SWATCH_WIDTH, 10.0), egui::Sense::hover());
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
