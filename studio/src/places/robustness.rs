//! The longer measurements of Verify: the analyser's map, and the requirements over many mechanisms.

use counterpoise_verify::Limit;
use counterpoise_verify::robust::Sense;
use egui::{RichText, Ui};

use super::{design::bode, parts};
use crate::chart::{Chart, Dash, Scale};
use crate::command::Command;
use crate::measure::{Measured, Robust, RobustRow, curves};
use crate::theme::{Theme, space};
use crate::view::View;

/// What was measured, the revision of the project, and whether a measurement runs.
type Of<'a> = (&'a Measured, u64, bool);

/// A button that starts a measurement, beside what was measured last.
fn start(
    ui: &mut Ui,
    theme: &Theme,
    queue: &mut Vec<Command>,
    (text, hint): (&str, &str),
    state: (bool, bool),
) {
    let (busy, stale) = state;
    ui.horizontal(|ui| {
        let command = if text.starts_with("Measure") { Command::Measure } else { Command::Sweep };
        if ui.add_enabled(!busy, egui::Button::new(text)).on_hover_text(hint).clicked() {
            queue.push(command);
        }
        if busy && ui.button("Stop").on_hover_text("Esc").clicked() {
            queue.push(Command::Cancel);
        }
        if stale {
            ui.label(RichText::new("of an older design").color(theme.warn));
        }
    });
    ui.add_space(space::SMALL);
}

/// The analyser's map: platform to hub at several amplitudes.
pub fn map(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, (measured, revision, busy): Of<'_>) {
    let theme = view.theme;
    let stale = measured.map.as_ref().is_some_and(|of| of.revision != revision);
    let say = ("Measure", "F7: platform rate to hub rate on the full plant, amplitude by amplitude");
    start(ui, &theme, queue, say, (busy, stale));
    match measured.map.as_ref().map(|of| &of.value) {
        None => parts::empty(
            ui,
            &theme,
            "Not measured yet",
            "F7 excites the full plant as an analyser does: what friction and backlash do shows between amplitudes",
        ),
        Some(Err(why)) => parts::reasons(ui, &theme, "The map could not be measured", why),
        Some(Ok(map)) => {
            let mut chart = bode(view, "Platform rate to hub rate, as an analyser measures it", "modulus");
            let placed = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
                points.iter().map(|p| [view.rate(p[0]), view.level(p[1])]).collect()
            };
            for (k, one) in curves(map).iter().enumerate() {
                if k == 0 {
                    chart = chart.curve("linear", theme.weak, Dash::Dashed, placed(&one.linear));
                }
                let name =
                    format!("{} {}", parts::short(view.angular() * one.amplitude), view.angular_rate_unit());
                let colour = theme.curves[k % theme.curves.len()];
                chart = chart.curve(&name, colour, Dash::Solid, placed(&one.measured));
            }
            let room = parts::room(ui);
            parts::chart(ui, view, queue, room, &chart);
        }
    }
}

/// The requirements over many mechanisms.
pub fn campaign(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, (measured, revision, busy): Of<'_>) {
    let theme = view.theme;
    let stale = measured.robust.as_ref().is_some_and(|of| of.revision != revision);
    start(
        ui,
        &theme,
        queue,
        ("Try many mechanisms", "F8: the campaign of the section [sweep]"),
        (busy, stale),
    );
    match measured.robust.as_ref().map(|of| &of.value) {
        None => parts::empty(
            ui,
            &theme,
            "Not tried yet",
            "F8 runs the exported controller on mechanisms that differ as the section [sweep] says",
        ),
        Some(Err(why)) => parts::reasons(ui, &theme, "The campaign could not be run", why),
        Some(Ok(robust)) => {
            egui::ScrollArea::vertical().max_height(0.55 * ui.available_height()).show(ui, |ui| {
                theme.card().show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    rows(ui, view, robust);
                });
            });
            ui.add_space(space::MEDIUM);
            if let Some(row) = robust.rows.get(view.verdict.min(robust.rows.len().saturating_sub(1))) {
                let chart = spread(view, row);
                let room = parts::room(ui);
                parts::chart(ui, view, queue, room, &chart);
            }
        }
    }
}

fn rows(ui: &mut Ui, view: &mut View, robust: &Robust) {
    let theme = view.theme;
    parts::heading(ui, &format!("{} of {} mechanisms", robust.done, robust.of));
    egui::Grid::new("robustness").num_columns(6).striped(true).spacing([12.0, 3.0]).show(ui, |ui| {
        for head in ["requirement", "limit", "holds", "median", "5 to 95 %", "moved most by"] {
            ui.label(RichText::new(head).small().color(theme.weak));
        }
        ui.end_row();
        for (k, row) in robust.rows.iter().enumerate() {
            if line(ui, view, row, view.verdict == k) {
                view.verdict = k;
            }
            ui.end_row();
        }
    });
}

/// One requirement; says whether it was clicked.
fn line(ui: &mut Ui, view: &View, row: &RobustRow, chosen: bool) -> bool {
    let theme = &view.theme;
    let (unit, factor) = view.shown_unit(row.requirement.figure.unit());
    let short = |value: f64| parts::short(factor * value);
    let s = &row.summary;
    let sign = if matches!(row.requirement.limit, Limit::AtLeast(_)) { "\u{2265}" } else { "\u{2264}" };
    let name = row.requirement.figure.name();
    let shown = ui.selectable_label(chosen, parts::figure(&name, theme));
    shown.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, chosen, name.clone()));
    let clicked = shown.on_hover_text(&name).clicked();
    ui.label(format!("{sign} {} {unit}", short(row.requirement.limit.value())));
    let colour = if s.share >= 0.999 { theme.good } else { theme.bad };
    ui.label(RichText::new(format!("{:.0} %", 100.0 * s.share)).color(colour));
    ui.label(short(s.median));
    ui.label(format!("{} to {}", short(s.q05), short(s.q95)));
    ui.label(row.strongest.map_or_else(String::new, strongest));
    clicked
}

/// The parameter that moves a figure most; "either way" where any departure from the design does.
fn strongest((name, by, sense): (&str, f64, Sense)) -> String {
    let either = if sense == Sense::EitherWay { "either way " } else { "" };
    format!("{} ({either}{by:+.2})", name.replace('_', " "))
}

/// The share of the mechanisms below each value.
fn spread(view: &View, row: &RobustRow) -> Chart {
    let (unit, factor) = view.shown_unit(row.requirement.figure.unit());
    let count = row.values.len().max(1) as f64;
    let finite = row.values.iter().enumerate().filter(|(_, v)| v.is_finite());
    let points: Vec<[f64; 2]> = finite.map(|(k, v)| [factor * v, 100.0 * (k as f64 + 0.5) / count]).collect();
    let label = format!("{}, {}", row.requirement.figure.name(), unit);
    let mut chart = Chart::new("Share of mechanisms below a value", label.trim_end_matches(", "), "share, %");
    chart.scales = [Scale::Linear; 2];
    chart.marks.push((factor * row.requirement.limit.value(), "limit".to_owned()));
    chart.curve("", view.theme.curves[0], Dash::Solid, points)
}
