//! The status bar: what is running or stale, and the last message.

use egui::{Color32, RichText, Ui};

use crate::command::Command;
use crate::studio::Studio;
use crate::theme::WindowTheme;
use crate::versioned_results::Freshness;
use crate::view::NoticeKind;

/// The state of the studio in words, with the colour of its dot.
struct Status {
    text: String,
    colour: Color32,
}

fn status(text: impl Into<String>, colour: Color32) -> Status {
    Status { text: text.into(), colour }
}

/// Shows the status bar.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.horizontal(|ui| {
        ui.set_height(20.0);
        let status = current_status(studio, &theme);
        let (dot, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 4.0, status.colour);
        let label = ui.label(RichText::new(status.text).small());
        if studio.results.design.is_some() {
            let took = studio.results.design_time.as_secs_f64() * 1e3;
            label.on_hover_text(format!("the design shown and its responses took {took:.1} ms"));
        }
        if studio.can_stop() && ui.small_button("Stop").on_hover_text("Esc").clicked() {
            queue.push(Command::Cancel);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if let Some(notice) = studio.view.notice.clone() {
                let colour = if notice.severity == NoticeKind::Error { theme.bad } else { theme.weak };
                if ui.small_button("x").on_hover_text("close this message").clicked() {
                    studio.view.notice = None;
                }
                ui.add(egui::Label::new(RichText::new(&notice.text).small().color(colour)).truncate())
                    .on_hover_text(&notice.text);
            } else if studio.view.shows_hint && studio.opened.is_some() {
                show_hint(ui, &theme, queue);
            }
        });
    });
}

/// Shows what can be dragged, until it was read once.
fn show_hint(ui: &mut Ui, theme: &WindowTheme, queue: &mut Vec<Command>) {
    if ui.small_button("Understood").clicked() {
        queue.push(Command::CloseHint);
    }
    let text = "Round handles of weights, grips of limits, titles of plots and every number can be dragged; F1 explains what is under the pointer.";
    ui.add(egui::Label::new(RichText::new(text).small().color(theme.accent)).truncate());
}

fn current_status(studio: &Studio, theme: &WindowTheme) -> Status {
    if let Some(path) = studio.file_queue.path_being_opened() {
        return status(format!("opening {}", path.display()), theme.accent);
    }
    let Some(opened) = &studio.opened else { return status("no project", theme.weak) };
    let (revision, jobs) = (opened.session.revision(), studio.jobs());
    if jobs.diagnose.is_busy() {
        return status(format!("diagnosing {}", jobs.diagnosis_progress()), theme.accent);
    }
    if jobs.export.is_busy() {
        return status("writing the code", theme.accent);
    }
    if jobs.report.is_busy() {
        return status("writing the report", theme.accent);
    }
    if jobs.measure.is_busy() {
        return status(format!("measuring {}", jobs.measurement_progress()), theme.accent);
    }
    if jobs.study.is_busy() {
        return status(
            format!("{} {}", jobs.asked_study.name().to_lowercase(), jobs.study_progress()),
            theme.accent,
        );
    }
    if jobs.replay.is_busy() {
        return status("replaying the recordings", theme.accent);
    }
    let has_errors = !opened.session.errors().is_empty();
    if opened.session.project().is_some_and(|p| p.synth.is_none()) && !has_errors {
        return status("a model without a controller", theme.weak);
    }
    if studio.results.design_errors(revision).is_some() {
        let what = if has_errors { "the project file has errors" } else { "no controller for this project" };
        let rest =
            if studio.results.design.is_some() { "; the last design that succeeded is shown" } else { "" };
        return status(format!("{what}{rest}"), theme.bad);
    }
    if studio.results.verifying {
        return status("verifying on the full plant", theme.accent);
    }
    match &studio.results.verified {
        Some(of) if of.freshness(revision) == Freshness::Current => {
            let (holds, fails, open) = of.value.verification().counts();
            let colour = if fails == 0 { theme.good } else { theme.bad };
            let rest = if open > 0 { format!(", {open} not applicable") } else { String::new() };
            status(format!("verified: {holds} requirements hold, {fails} fail{rest}"), colour)
        }
        _ => status("not verified yet", theme.warn),
    }
}
