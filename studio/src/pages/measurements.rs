//! The longer measurements of the page Verify: the analyser's map, and the requirements over many mechanisms.

use crate::tolerance::HELD_BY_ALL_SHARE;
use counterpoise_pipeline::studies::fra::ResponseMap;
use counterpoise_pipeline::studies::sweep::{RequirementSpread, StrongestParameter};
use counterpoise_report::wording::figures::describe_figure;
use counterpoise_verify::Limit;
use counterpoise_verify::robustness::Sense;
use egui::{RichText, Ui};
use ndarray::ArrayView1;

use super::frequency_charts::frequency_chart;
use super::widgets;
use crate::charts::chart::{Chart, LineDash};
use crate::command::Command;
use crate::jobs::measurements::{CampaignView, Measurements};
use crate::number_format::format_short;
use crate::theme::{WindowTheme, space};
use crate::versioned_results::Freshness;
use crate::view::StudioView;

/// Results of measurements, and the progress of a running one.
pub struct ShownMeasurements<'a> {
    /// The last measurements.
    pub measurements: &'a Measurements,
    /// The revision of the project.
    pub revision: u64,
    /// Progress of a running measurement, in words; `None` if none runs.
    pub progress: Option<String>,
}

/// A button that starts a measurement.
struct StartButton {
    text: &'static str,
    hint: &'static str,
    command: Command,
}

/// Shows the button that starts a measurement, how far it is, and whether the last one belongs to an older design.
fn show_start(
    ui: &mut Ui,
    theme: &WindowTheme,
    queue: &mut Vec<Command>,
    button: StartButton,
    progress: Option<&str>,
    freshness: Freshness,
) {
    ui.horizontal(|ui| {
        let widget = egui::Button::new(button.text);
        if ui.add_enabled(progress.is_none(), widget).on_hover_text(button.hint).clicked() {
            queue.push(button.command);
        }
        if let Some(progress) = progress {
            if ui.button("Stop").on_hover_text("Esc").clicked() {
                queue.push(Command::Cancel);
            }
            ui.label(RichText::new(format!("measuring {progress}")).color(theme.accent));
        }
        if freshness == Freshness::Stale {
            ui.label(RichText::new("of an older design").color(theme.warn));
        }
    });
    ui.add_space(space::SMALL);
}

/// Shows the analyser's map: platform rate to hub rate at several amplitudes.
pub fn show_map(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, shown: &ShownMeasurements) {
    let theme = view.theme;
    let map = shown.measurements.map.as_ref();
    let freshness = map.map_or(Freshness::Current, |of| of.freshness(shown.revision));
    let button = StartButton {
        text: "Measure",
        hint: "F7: platform rate to hub rate on the full plant, amplitude by amplitude",
        command: Command::Measure,
    };
    show_start(ui, &theme, queue, button, shown.progress.as_deref(), freshness);
    match map.map(|of| &of.value) {
        None if shown.progress.is_some() => {
            widgets::show_placeholder(ui, &theme, "Measuring", "the map appears when it is complete");
        }
        None => widgets::show_placeholder(
            ui,
            &theme,
            "Not measured yet",
            "F7 excites the full plant as an analyser does: curves that differ between amplitudes show friction and backlash",
        ),
        Some(Err(why)) => widgets::show_error_list(ui, &theme, "The map could not be measured", why),
        Some(Ok(map)) => {
            let chart = map_chart(view, map);
            let area = widgets::take_remaining_area(ui);
            widgets::show_chart(ui, view, queue, area, &chart);
        }
    }
}

fn map_chart(view: &StudioView, map: &ResponseMap) -> Chart {
    let theme = &view.theme;
    let mut chart = frequency_chart(view, "Platform rate to hub rate, as an analyser measures it", "modulus");
    let rates = map.points.frequency_rad_s();
    let displayed = |moduli: ArrayView1<'_, f64>| -> Vec<[f64; 2]> {
        let points = rates.iter().zip(moduli);
        points.map(|(rate, h)| [view.units.display_frequency(*rate), view.units.display_gain(*h)]).collect()
    };
    if map.points.amplitudes() > 0 {
        let linear = displayed(map.points.linear_modulus().view());
        chart = chart.with_curve("linear", theme.weak, LineDash::Dashed, linear);
    }
    for (k, measured) in map.points.modulus().columns().into_iter().enumerate() {
        let amplitude = map.points.amplitude.column(k).first().copied().unwrap_or(f64::NAN);
        let amplitude = format_short(view.units.angle_factor() * amplitude);
        let name = format!("{amplitude} {}", view.units.angular_rate_unit());
        let colour = theme.curves[k % theme.curves.len()];
        chart = chart.with_curve(&name, colour, LineDash::Solid, displayed(measured));
    }
    chart
}

/// Shows the requirements over many mechanisms.
pub fn show_campaign(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    shown: &ShownMeasurements,
) {
    let theme = view.theme;
    let campaign = shown.measurements.campaign.as_ref();
    let freshness = campaign.map_or(Freshness::Current, |of| of.freshness(shown.revision));
    let button = StartButton {
        text: "Run the campaign",
        hint: "F8: the mechanisms of the section [sweep]",
        command: Command::Sweep,
    };
    show_start(ui, &theme, queue, button, shown.progress.as_deref(), freshness);
    match campaign.map(|of| &of.value) {
        None if shown.progress.is_some() => {
            widgets::show_placeholder(ui, &theme, "Running", "the first mechanisms appear in a moment");
        }
        None => widgets::show_placeholder(
            ui,
            &theme,
            "No campaign yet",
            "F8 runs the exported controller on mechanisms that differ as the section [sweep] says",
        ),
        Some(Err(why)) => widgets::show_error_list(ui, &theme, "The campaign could not be run", why),
        Some(Ok(result)) => show_campaign_result(ui, view, queue, result),
    }
}

fn show_campaign_result(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, result: &CampaignView) {
    let theme = view.theme;
    egui::ScrollArea::vertical().max_height(0.55 * ui.available_height()).show(ui, |ui| {
        theme.card().show(ui, |ui| {
            ui.set_width(ui.available_width());
            show_rows(ui, view, result);
        });
    });
    ui.add_space(space::MEDIUM);
    let selected = view.requirement.min(result.rows.len().saturating_sub(1));
    if let Some(row) = result.rows.get(selected) {
        let chart = distribution_chart(view, row);
        let area = widgets::take_remaining_area(ui);
        widgets::show_chart(ui, view, queue, area, &chart);
    }
}

fn show_rows(ui: &mut Ui, view: &mut StudioView, result: &CampaignView) {
    let theme = view.theme;
    widgets::show_heading(ui, &format!("{} of {} mechanisms", result.done, result.total));
    egui::Grid::new("robustness").num_columns(6).striped(true).spacing([12.0, 3.0]).show(ui, |ui| {
        for head in ["requirement", "limit", "holds", "median", "5 to 95 %", "moved most by"] {
            ui.label(RichText::new(head).small().color(theme.weak));
        }
        ui.end_row();
        for k in 0..result.rows.len() {
            if show_row(ui, view, result, k).clicked() {
                view.requirement = k;
            }
            ui.end_row();
        }
    });
}

/// Shows the requirement of an index; its name is a button.
fn show_row(ui: &mut Ui, view: &StudioView, result: &CampaignView, index: usize) -> egui::Response {
    let (row, is_selected) = (&result.rows[index], view.requirement == index);
    let theme = &view.theme;
    let unit = view.units.display_unit(row.requirement.figure.unit(row.controlled));
    let written = |value: f64| format_short(unit.factor * value);
    let s = &row.summary;
    let sign = if matches!(row.requirement.limit, Limit::AtLeast(_)) { "\u{2265}" } else { "\u{2264}" };
    let name = describe_figure(row.requirement.figure, row.controlled);
    let shown = ui.selectable_label(is_selected, widgets::figure_name_layout(&name, theme));
    shown.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, name.clone()));
    ui.label(format!("{sign} {} {}", written(row.requirement.limit.value()), unit.name));
    let colour = if s.share >= HELD_BY_ALL_SHARE { theme.good } else { theme.bad };
    ui.label(RichText::new(format!("{:.0} %", 100.0 * s.share)).color(colour));
    ui.label(written(s.median));
    ui.label(format!("{} to {}", written(s.q05), written(s.q95)));
    ui.label(row.strongest.as_ref().map_or_else(String::new, strongest_in_words));
    shown.on_hover_text(&name)
}

/// Returns the parameter that moves a figure most, in words: "either way" if any deviation from the design does.
fn strongest_in_words(strongest: &StrongestParameter) -> String {
    let either = if strongest.sense == Sense::EitherWay { "either way " } else { "" };
    format!("{} ({either}{:+.2})", strongest.key.replace('_', " "), strongest.correlation)
}

/// Returns the share of the mechanisms below each value.
fn distribution_chart(view: &StudioView, row: &RequirementSpread) -> Chart {
    let unit = view.units.display_unit(row.requirement.figure.unit(row.controlled));
    let points = row.distribution().into_iter().map(|[value, share]| [unit.factor * value, share]).collect();
    let label = format!("{}, {}", describe_figure(row.requirement.figure, row.controlled), unit.name);
    let mut chart = Chart::new("Share of mechanisms below a value", label.trim_end_matches(", "), "share, %");
    chart.add_mark(unit.factor * row.requirement.limit.value(), "limit");
    chart.with_curve("", view.theme.curves[0], LineDash::Solid, points)
}
