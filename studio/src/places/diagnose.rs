//! Diagnose: recordings against the model, what was left out, and the improved mechanism taken over.

use counterpoise_project::diagnose::Diagnosis;
use counterpoise_project::diagnose::answer::{Answer, Finding, Verdict};
use egui::{RichText, Ui};

use super::parts;
use crate::command::Command;
use crate::studio::Studio;
use crate::theme::{Theme, space};

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    let jobs = studio.diagnosis();
    let busy = jobs.diagnose.is_busy();
    parts::side("recordings", &theme, 312.0).show(ui, |ui| {
        theme.card().show(ui, |ui| {
            ui.set_width(ui.available_width());
            parts::heading(ui, "Recordings");
            for path in &jobs.recordings {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                ui.label(name).on_hover_text(path.display().to_string());
            }
            if jobs.recordings.is_empty() {
                ui.label(
                    RichText::new("Drop CSV, Parquet or MATLAB files of one machine onto the window.")
                        .color(theme.weak),
                );
            }
            ui.add_space(space::SMALL);
            let ready = !busy && !jobs.recordings.is_empty();
            if ui.add_enabled(ready, egui::Button::new("Diagnose")).on_hover_text("F6").clicked() {
                queue.push(Command::Diagnose);
            }
            if busy {
                ui.label(RichText::new(jobs.progress()).color(theme.accent));
                if ui.button("Stop").clicked() {
                    queue.push(Command::Cancel);
                }
            }
        });
    });
    match &jobs.diagnosed {
        Some(Ok(found)) => {
            egui::ScrollArea::vertical().show(ui, |ui| answer(ui, &theme, queue, found));
        }
        Some(Err(why)) => parts::reasons(ui, &theme, "The recordings could not be diagnosed", why),
        None if busy => parts::empty(ui, &theme, "Diagnosing", &jobs.progress()),
        None => parts::empty(
            ui,
            &theme,
            "No diagnosis yet",
            "recordings tell what the model leaves out: friction, backlash, out-of-balance, sensors, delay",
        ),
    }
}

fn sentence(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Consistent => "The model explains the recordings",
        Verdict::Named => "With this, the model explains the recordings",
        Verdict::Ambiguous => "One of several that these recordings cannot tell apart",
        Verdict::Incomplete => "This is part of it; something is left over",
        Verdict::Unknown => "Something was left out that is none of the known effects",
    }
}

fn answer(ui: &mut Ui, theme: &Theme, queue: &mut Vec<Command>, found: &Diagnosis) {
    let answer = &found.answer;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new(sentence(answer.verdict)).heading());
        answer.findings.iter().for_each(|f| finding(ui, theme, f));
        if !answer.findings.is_empty() && ui.button("Accept into the project").clicked() {
            queue.push(Command::Accept);
        }
    });
    ui.add_space(space::MEDIUM);
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        fit(ui, theme, answer);
    });
    ui.add_space(space::MEDIUM);
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        evidence(ui, theme, answer);
    });
}

fn finding(ui: &mut Ui, theme: &Theme, finding: &Finding) {
    parts::heading(ui, &format!("{} {}", finding.component, finding.effect));
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

fn fit(ui: &mut Ui, theme: &Theme, answer: &Answer) {
    parts::heading(ui, "RMS error by channel");
    egui::Grid::new("fit").num_columns(4).striped(true).spacing([28.0, 4.0]).show(ui, |ui| {
        for head in ["channel", "noise floor", "before", "after", "held out, after"] {
            ui.label(RichText::new(head).small().color(theme.weak));
        }
        ui.end_row();
        for (channel, before) in &answer.fit.before {
            ui.label(channel.to_string());
            ui.label(parts::short(before.floor));
            ui.label(parts::short(before.rms_error));
            for table in [&answer.fit.after, &answer.fit.held_out_after] {
                ui.label(parts::short(table.get(channel).map_or(f64::NAN, |c| c.rms_error)));
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
    if let Some(next) = &answer.next_experiment {
        ui.label(format!("Next experiment: {}; it {}", next.what, next.why));
    }
    for remark in answer.qualification.iter().chain(&answer.warnings) {
        ui.label(RichText::new(remark).small().color(theme.weak));
    }
}
