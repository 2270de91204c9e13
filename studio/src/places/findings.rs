//! What a diagnosis says: the findings, the fit, where and when, and what was tried.

use counterpoise_diagnose::findings::answer::Verdict;
use counterpoise_diagnose::findings::localisation_chart::ChartRow;
use counterpoise_diagnose::localisation::error_hypotheses::Regime;
use counterpoise_recordings::Channel;
use counterpoise_report::wording::answer::{AnswerText, FindingText, component_list, unit_suffix};
use egui::{RichText, Ui};

use super::parts;
use crate::command::Command;
use crate::theme::{Theme, space};
use crate::view::View;

/// The verdict in a sentence.
pub fn sentence(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Consistent => "The model explains the recordings",
        Verdict::Named => "With this, the model explains the recordings",
        Verdict::Ambiguous => "One of several that these recordings cannot tell apart",
        Verdict::Incomplete => "This is part of it; something is left over",
        Verdict::Unknown => "Something was left out that is none of the known effects",
    }
}

/// The findings with their evidence.
pub fn answer(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, answer: &AnswerText) {
    let theme = &view.theme;
    card(ui, theme, |ui| {
        ui.label(RichText::new(sentence(answer.verdict)).heading());
        answer.findings.iter().for_each(|f| finding(ui, theme, f));
        if !answer.findings.is_empty() && ui.button("Accept these into the project").clicked() {
            queue.push(Command::Accept);
        }
    });
    card(ui, theme, |ui| fit(ui, view, answer));
    card(ui, theme, |ui| evidence(ui, theme, answer));
}

fn card(ui: &mut Ui, theme: &Theme, content: impl FnOnce(&mut Ui)) {
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        content(ui);
    });
    ui.add_space(space::MEDIUM);
}

fn finding(ui: &mut Ui, theme: &Theme, finding: &FindingText) {
    let name = format!("{} {}", finding.component, finding.effect).replace('_', " ");
    parts::heading(ui, &format!("{name}   {:.0} %", 100.0 * finding.probability));
    ui.label(format!("{} It shows {}.", finding.explanation, finding.when));
    for p in finding.parameters.iter().take(14) {
        let [low, high] = p.ci95;
        let text = format!(
            "{} = {}{}   [{}, {}]   was {}",
            p.name,
            parts::short(p.value),
            unit_suffix(p),
            parts::short(low),
            parts::short(high),
            parts::short(p.before)
        );
        ui.label(RichText::new(text).monospace());
    }
    for other in &finding.alternatives {
        ui.label(
            RichText::new(format!("cannot be told from {} {}", other.component, other.effect))
                .color(theme.warn),
        );
    }
}

fn fit(ui: &mut Ui, view: &View, answer: &AnswerText) {
    let theme = &view.theme;
    parts::heading(ui, "RMS error by channel");
    egui::Grid::new("fit").num_columns(4).striped(true).spacing([28.0, 4.0]).show(ui, |ui| {
        for head in ["channel", "noise floor", "before", "after", "held out, after"] {
            ui.label(RichText::new(head).small().color(theme.weak));
        }
        ui.end_row();
        for (channel, before) in &answer.fit.before {
            let known = Channel::ALL.into_iter().find(|c| c.name() == *channel);
            let (unit, factor) = known.map_or((String::new(), 1.0), |c| view.shown_unit(c.unit()));
            let name = format!("{}, {unit}", channel.replace('_', " "));
            ui.label(name.trim_end_matches(", "));
            ui.label(parts::short(factor * before.floor));
            ui.label(parts::short(factor * before.rms_error));
            for table in [&answer.fit.after, &answer.fit.held_out_after] {
                ui.label(parts::short(table.get(channel).map_or(f64::NAN, |c| factor * c.rms_error)));
            }
            ui.end_row();
        }
    });
}

fn evidence(ui: &mut Ui, theme: &Theme, answer: &AnswerText) {
    parts::heading(ui, "Balances that these sensors allow");
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
                parts::short(size),
                one.unit
            ),
            None => format!("{name}: these recordings would not show it"),
        };
        ui.label(RichText::new(text).small().color(theme.weak));
    }
    if let Some(next) = &answer.next_experiment {
        ui.label(format!("Next experiment: {}; it {}", next.what, next.why));
    }
    for remark in answer.qualification.iter().chain(&answer.warnings) {
        ui.label(RichText::new(remark).small().color(theme.weak));
    }
}

/// Where and when: what an error at each component explains that follows one variable, and the balances that say so.
pub fn map(ui: &mut Ui, theme: &Theme, answer: &AnswerText) {
    card(ui, theme, |ui| {
        legend(ui, theme, answer);
        egui::Grid::new("where and when").spacing([2.0, 2.0]).show(ui, |ui| {
            ui.label("");
            Regime::ALL.iter().for_each(|regime| {
                ui.label(RichText::new(regime.name()).small().color(theme.weak));
            });
            ui.end_row();
            answer.chart.rows.iter().for_each(|one| row(ui, theme, one));
        });
        shapes(ui, theme, answer);
    });
    card(ui, theme, |ui| evidence(ui, theme, answer));
}

/// What the picture says, and what the colours mean.
fn legend(ui: &mut Ui, theme: &Theme, answer: &AnswerText) {
    parts::heading(ui, "What an error at each component explains, along one variable");
    ui.label(&answer.chart_summary);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for k in 0..=10 {
            let (place, _) = ui.allocate_exact_size(egui::vec2(20.0, 12.0), egui::Sense::hover());
            ui.painter().rect_filled(place, 0.0, warm(theme, 0.1 * f64::from(k)));
        }
        let scale = "  0 to 100 % of what the best cell gains on data not used to find it";
        ui.label(RichText::new(scale).small().color(theme.weak));
    });
    if answer.chart.rows.iter().any(|row| !row.found.is_empty()) {
        let ring = "Ringed: where the effect belongs that the search then named; the picture is a first look, before it";
        ui.label(RichText::new(ring).small().color(theme.weak));
    }
    ui.add_space(space::SMALL);
}

/// The row of a component; a weak name alone where no balance sees it.
fn row(ui: &mut Ui, theme: &Theme, one: &ChartRow) {
    let name = one.component.name().replace('_', " ");
    if one.seen {
        ui.label(name);
        for (regime, share) in Regime::ALL.iter().zip(&one.shares) {
            let ring = if one.found.contains(regime) { (2.0, theme.warn) } else { (1.0, theme.line) };
            cell(ui, theme, *share, ring.into());
        }
    } else {
        ui.label(RichText::new(name).color(theme.weak));
        ui.label(RichText::new("not seen").small().color(theme.weak));
    }
    ui.end_row();
}

/// One cell, the warmer the more is carried; a dash where no such error is thought of.
fn cell(ui: &mut Ui, theme: &Theme, share: Option<f64>, ring: egui::Stroke) {
    let frame = egui::Frame::new().fill(warm(theme, share.unwrap_or(0.0))).stroke(ring).inner_margin(3);
    frame.show(ui, |ui| {
        ui.set_min_size(egui::vec2(62.0, 16.0));
        let text = share.map_or_else(|| "\u{2013}".to_owned(), |s| format!("{:.0}", 100.0 * s));
        ui.vertical_centered(|ui| ui.label(RichText::new(text).small()));
    });
}

fn warm(theme: &Theme, share: f64) -> egui::Color32 {
    theme.accent.gamma_multiply(0.75 * share.clamp(0.0, 1.0) as f32)
}

/// What the mismatch looks like along the variables that carry it.
fn shapes(ui: &mut Ui, theme: &Theme, answer: &AnswerText) {
    for found in answer.map.iter().filter(|cell| !cell.shape.is_empty()) {
        let text =
            format!("{} along {}: {}", found.component.name().replace('_', " "), found.regime, found.shape);
        ui.label(RichText::new(text).small().color(theme.weak));
    }
}

/// Everything that was tried.
pub fn tried(ui: &mut Ui, theme: &Theme, answer: &AnswerText) {
    card(ui, theme, |ui| {
        parts::heading(ui, "Hypotheses, fitted to part of the data and judged on the rest");
        egui::Grid::new("tried").num_columns(5).striped(true).spacing([22.0, 3.0]).show(ui, |ui| {
            for head in ["stage", "effect", "gain on data not fitted, nats", "worst error over floor", ""] {
                ui.label(RichText::new(head).small().color(theme.weak));
            }
            ui.end_row();
            for one in &answer.hypotheses {
                let colour = if one.accepted { theme.good } else { theme.text };
                ui.label(one.stage.to_string());
                let name = format!("{} {}", one.component, one.effect).replace('_', " ");
                ui.label(RichText::new(name).color(colour));
                ui.label(parts::short(one.gain_nats));
                ui.label(parts::short(one.worst));
                ui.label(RichText::new(if one.accepted { "accepted" } else { "" }).color(colour));
                ui.end_row();
            }
        });
    });
}
