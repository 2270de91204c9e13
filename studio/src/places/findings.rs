//! What a diagnosis says: the findings, the fit, where and when, and what was tried.

use counterpoise_project::diagnose::answer::{Answer, Finding, Verdict};
use counterpoise_project::recording::Channel;
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
pub fn answer(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, answer: &Answer) {
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

fn finding(ui: &mut Ui, theme: &Theme, finding: &Finding) {
    let name = format!("{} {}", finding.component, finding.effect).replace('_', " ");
    parts::heading(ui, &format!("{name}   {:.0} %", 100.0 * finding.probability));
    ui.label(format!("{} It shows {}.", finding.explanation, finding.when));
    for p in finding.parameters.iter().take(14) {
        let [low, high] = p.ci95;
        let text = format!(
            "{} = {}{}   [{}, {}]   was {}",
            p.name,
            parts::short(p.value),
            p.suffix(),
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

fn fit(ui: &mut Ui, view: &View, answer: &Answer) {
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

fn evidence(ui: &mut Ui, theme: &Theme, answer: &Answer) {
    parts::heading(ui, "Balances that these sensors allow");
    for row in &answer.isolability {
        let sees = row.sees.join(", ");
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

/// Where and when: which balance departs, and how much of that follows one variable.
pub fn map(ui: &mut Ui, theme: &Theme, answer: &Answer) {
    card(ui, theme, |ui| {
        parts::heading(
            ui,
            "Share of each balance's residual that follows one variable, on data not used to find it",
        );
        let mut components: Vec<&str> = Vec::new();
        let mut regimes: Vec<&str> = Vec::new();
        for cell in &answer.map {
            if !components.contains(&cell.component) {
                components.push(cell.component);
            }
            if !regimes.contains(&cell.regime) {
                regimes.push(cell.regime);
            }
        }
        egui::Grid::new("where and when").spacing([4.0, 4.0]).show(ui, |ui| {
            ui.label("");
            components.iter().for_each(|name| {
                ui.label(RichText::new(format!("{name} balance")).small().color(theme.weak));
            });
            ui.end_row();
            for regime in regimes {
                ui.label(regime.replace('_', " "));
                for component in &components {
                    let found = answer.map.iter().find(|c| c.component == *component && c.regime == regime);
                    cell(ui, theme, found.map_or((0.0, ""), |c| (c.explained, c.shape.as_str())));
                }
                ui.end_row();
            }
        });
    });
    card(ui, theme, |ui| evidence(ui, theme, answer));
}

/// One cell of the map, the warmer the more is explained.
fn cell(ui: &mut Ui, theme: &Theme, (explained, shape): (f64, &str)) {
    let share = explained.clamp(0.0, 1.0);
    let fill = theme.accent.gamma_multiply(0.75 * share as f32);
    let frame = egui::Frame::new().fill(fill).stroke(egui::Stroke::new(1.0, theme.line)).inner_margin(4);
    frame.show(ui, |ui| {
        ui.set_min_size(egui::vec2(150.0, 18.0));
        let text = if shape.is_empty() { String::new() } else { format!("  {shape}") };
        ui.label(RichText::new(format!("{:.0} %{text}", 100.0 * share)).small());
    });
}

/// Everything that was tried.
pub fn tried(ui: &mut Ui, theme: &Theme, answer: &Answer) {
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
