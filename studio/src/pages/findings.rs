//! The result of a diagnosis: findings, fit, localisation and hypotheses.

use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_diagnose::findings::localisation_chart::ChartRow;
use counterpoise_diagnose::localisation::error_hypotheses::Regime;
use counterpoise_report::wording::answer::{
    AnswerText, FindingText, component_list, describe_verdict, describe_warning, unit_suffix,
};
use counterpoise_report::wording::capitalise_first;
use egui::{RichText, Ui};

use super::widgets;
use crate::command::Command;
use crate::number_format::format_short;
use crate::theme::{WindowTheme, space};
use crate::units::DisplayUnit;
use crate::view::StudioView;

/// Returns the verdict as a sentence that begins with a capital.
pub fn verdict_sentence(verdict: DiagnosisVerdict) -> String {
    capitalise_first(describe_verdict(verdict).sentence)
}

/// Shows the findings with their evidence.
pub fn show_answer(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, answer: &AnswerText) {
    let theme = &view.theme;
    show_in_card(ui, theme, |ui| {
        ui.label(RichText::new(verdict_sentence(answer.verdict)).heading());
        answer.findings.iter().for_each(|f| show_finding(ui, theme, f));
        if !answer.findings.is_empty() && ui.button("Accept these into the project").clicked() {
            queue.push(Command::Accept);
        }
    });
    show_in_card(ui, theme, |ui| show_fit(ui, view, answer));
    show_in_card(ui, theme, |ui| show_evidence(ui, theme, answer));
}

fn show_in_card(ui: &mut Ui, theme: &WindowTheme, content: impl FnOnce(&mut Ui)) {
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        content(ui);
    });
    ui.add_space(space::MEDIUM);
}

fn show_finding(ui: &mut Ui, theme: &WindowTheme, finding: &FindingText) {
    let name = format!("{} {}", finding.component, finding.effect).replace('_', " ");
    widgets::show_heading(ui, &format!("{name}   {:.0} %", 100.0 * finding.probability));
    ui.label(format!("{} It shows {}.", finding.explanation, finding.when));
    for p in finding.parameters.iter().take(14) {
        let [low, high] = p.ci95;
        let text = format!(
            "{} = {}{}   [{}, {}]   was {}",
            p.name,
            format_short(p.value),
            unit_suffix(p),
            format_short(low),
            format_short(high),
            format_short(p.before)
        );
        ui.label(RichText::new(text).monospace());
    }
    for other in &finding.alternatives {
        ui.label(
            RichText::new(format!("cannot be distinguished from {} {}", other.component, other.effect))
                .color(theme.warn),
        );
    }
}

fn show_fit(ui: &mut Ui, view: &StudioView, answer: &AnswerText) {
    let theme = &view.theme;
    widgets::show_heading(ui, "RMS residual by channel");
    egui::Grid::new("fit").num_columns(4).striped(true).spacing([28.0, 4.0]).show(ui, |ui| {
        for head in ["channel", "noise floor", "before", "after", "held out, after"] {
            ui.label(RichText::new(head).small().color(theme.weak));
        }
        ui.end_row();
        for (channel, before) in answer.fit.before.iter() {
            let DisplayUnit { name: unit, factor } = view.units.display_unit(channel.unit());
            let name = format!("{}, {unit}", channel.name().replace('_', " "));
            ui.label(name.trim_end_matches(", "));
            ui.label(format_short(factor * before.floor));
            ui.label(format_short(factor * before.rms_error));
            for table in [&answer.fit.after, &answer.fit.held_out_after] {
                ui.label(format_short(table.get(channel).map_or(f64::NAN, |c| factor * c.rms_error)));
            }
            ui.end_row();
        }
    });
}

/// Shows what the sensors allow to be told, folded until it is asked for.
fn show_evidence(ui: &mut Ui, theme: &WindowTheme, answer: &AnswerText) {
    let title = "Equations of torque and motion that these sensors allow";
    egui::CollapsingHeader::new(title).show(ui, |ui| show_equations(ui, theme, answer));
}

fn show_equations(ui: &mut Ui, theme: &WindowTheme, answer: &AnswerText) {
    for row in &answer.isolability {
        let sees = component_list(&row.sees).replace('_', " ");
        let colour = if row.available { theme.text } else { theme.weak };
        ui.label(RichText::new(format!("{}: {sees}", row.balance)).color(colour));
    }
    for one in &answer.not_excited {
        let name = format!("{} {}", one.component, one.effect).replace('_', " ");
        let text = match one.smallest_detectable {
            Some(size) => format!(
                "{name}: these recordings would show a {} from {} {}",
                one.parameter.replace('_', " "),
                format_short(size),
                one.unit
            ),
            None => format!("{name}: these recordings would not show it"),
        };
        ui.label(RichText::new(text).small().color(theme.weak));
    }
    if let Some(next) = &answer.next_experiment {
        ui.label(format!("Next experiment: {}; it {}", next.what, next.why));
    }
    let warnings = answer.warnings.iter().map(|warning| -> &str { describe_warning(*warning) });
    for remark in answer.qualification.iter().map(String::as_str).chain(warnings) {
        ui.label(RichText::new(remark).small().color(theme.weak));
    }
}

/// Shows the localisation: how much an error at each component explains along one variable.
pub fn show_localisation(ui: &mut Ui, theme: &WindowTheme, answer: &AnswerText) {
    show_in_card(ui, theme, |ui| {
        show_legend(ui, theme, answer);
        egui::Grid::new("localisation").spacing([2.0, 2.0]).show(ui, |ui| {
            ui.label("");
            Regime::ALL.iter().for_each(|regime| {
                ui.label(RichText::new(regime.name()).small().color(theme.weak));
            });
            ui.end_row();
            answer.chart.rows.iter().for_each(|one| show_row(ui, theme, one));
        });
        show_shapes(ui, theme, answer);
    });
    show_in_card(ui, theme, |ui| show_evidence(ui, theme, answer));
}

/// Shows what the map says, and what the colours mean.
fn show_legend(ui: &mut Ui, theme: &WindowTheme, answer: &AnswerText) {
    widgets::show_heading(ui, "What an error at each component explains, along one variable");
    ui.label(&answer.chart_summary);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for k in 0..=10 {
            let (place, _) = ui.allocate_exact_size(egui::vec2(20.0, 12.0), egui::Sense::hover());
            ui.painter().rect_filled(place, 0.0, intensity_colour(theme, 0.1 * f64::from(k)));
        }
        let scale = "  0 to 100 % of what the best cell gains on held-out data";
        ui.label(RichText::new(scale).small().color(theme.weak));
    });
    if answer.chart.rows.iter().any(|row| !row.found.is_empty()) {
        let ring =
            "Ringed: where the identified effect belongs; the map itself is computed before the search";
        ui.label(RichText::new(ring).small().color(theme.weak));
    }
    ui.add_space(space::SMALL);
}

/// Shows the row of a component; one that no sensor relation covers has its name only.
fn show_row(ui: &mut Ui, theme: &WindowTheme, one: &ChartRow) {
    let name = one.component.name().replace('_', " ");
    if one.seen {
        ui.label(name);
        for (regime, share) in Regime::ALL.iter().zip(&one.shares) {
            let ring = if one.found.contains(regime) { (2.0, theme.warn) } else { (1.0, theme.line) };
            show_cell(ui, theme, *share, ring.into());
        }
    } else {
        ui.label(RichText::new(name).color(theme.weak));
        ui.label(RichText::new("no sensor covers it").small().color(theme.weak));
    }
    ui.end_row();
}

/// Shows one cell, the more intense the more it explains; a dash stands for an error that is not considered.
fn show_cell(ui: &mut Ui, theme: &WindowTheme, share: Option<f64>, ring: egui::Stroke) {
    let frame =
        egui::Frame::new().fill(intensity_colour(theme, share.unwrap_or(0.0))).stroke(ring).inner_margin(3);
    frame.show(ui, |ui| {
        ui.set_min_size(egui::vec2(62.0, 16.0));
        let text = share.map_or_else(|| "\u{2013}".to_owned(), |s| format!("{:.0}", 100.0 * s));
        ui.vertical_centered(|ui| ui.label(RichText::new(text).small()));
    });
}

fn intensity_colour(theme: &WindowTheme, share: f64) -> egui::Color32 {
    theme.accent.gamma_multiply(0.75 * share.clamp(0.0, 1.0) as f32)
}

/// Shows the shape of the residual along the variables that explain it.
fn show_shapes(ui: &mut Ui, theme: &WindowTheme, answer: &AnswerText) {
    for found in answer.map.iter().filter(|cell| !cell.shape.is_empty()) {
        let text =
            format!("{} along {}: {}", found.component.name().replace('_', " "), found.regime, found.shape);
        ui.label(RichText::new(text).small().color(theme.weak));
    }
}

/// Shows all hypotheses that were fitted.
pub fn show_hypotheses(ui: &mut Ui, theme: &WindowTheme, answer: &AnswerText) {
    show_in_card(ui, theme, |ui| {
        widgets::show_heading(ui, "Hypotheses, fitted to part of the data and compared on the rest");
        egui::Grid::new("hypotheses").num_columns(5).striped(true).spacing([22.0, 3.0]).show(ui, |ui| {
            for head in ["stage", "effect", "gain on held-out data", "largest residual, noise floors", ""] {
                ui.label(RichText::new(head).small().color(theme.weak));
            }
            ui.end_row();
            for one in &answer.hypotheses {
                let colour = if one.accepted { theme.good } else { theme.text };
                ui.label(one.stage.to_string());
                let name = format!("{} {}", one.component, one.effect).replace('_', " ");
                ui.label(RichText::new(name).color(colour));
                ui.label(format_short(one.log_likelihood_gain));
                ui.label(format_short(one.worst));
                ui.label(RichText::new(if one.accepted { "accepted" } else { "" }).color(colour));
                ui.end_row();
            }
        });
    });
}
