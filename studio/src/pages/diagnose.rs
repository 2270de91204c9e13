//! The page Diagnose: recordings against the model, the diagnosis, and the improved mechanism.

use egui::{RichText, Ui};

use super::recording_charts::{density_chart, residual_chart, signal_chart};
use super::{findings, recording_cross_plot, recording_mapping, widgets};
use crate::command::{BrowsePurpose, Command, DiagnosisTab};
use crate::jobs::BackgroundJobs;
use crate::jobs::recording_views::{ChannelView, RecordingView};
use crate::studio::Studio;
use crate::theme::space;
use crate::versioned_results::VersionedResult;
use crate::view::StudioView;

/// Width of the panel with recordings and channels, points.
const SIDE_WIDTH: f32 = 330.0;

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let (jobs, view) = (&studio.jobs, &mut studio.view);
    let theme = view.theme;
    widgets::side_panel("recordings", &theme, SIDE_WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            theme.card().show(ui, |ui| {
                ui.set_width(ui.available_width());
                show_recordings(ui, view, queue, jobs);
            });
            ui.add_space(space::SMALL);
            let selected = selected_recording(view, jobs.recording_views.as_ref());
            if let (Some(recording), Some(project)) = (selected, opened.session.project()) {
                recording_mapping::show(ui, view, queue, recording, project);
            }
        });
    });
    if jobs.recordings.is_empty() {
        return widgets::show_placeholder(
            ui,
            &theme,
            "No recordings yet",
            "recordings show what the model lacks: friction, backlash, out-of-balance, sensor errors, delay",
        );
    }
    show_tabs(ui, view, queue, jobs);
    match (view.diagnosis_tab, &jobs.diagnosis) {
        (DiagnosisTab::Signals | DiagnosisTab::Errors | DiagnosisTab::Spectra, _) => {
            show_channels(ui, view, queue, jobs)
        }
        (DiagnosisTab::CrossPlot, _) => show_cross_plot(ui, view, queue, jobs),
        (_, Some(Err(why))) => {
            widgets::show_error_list(ui, &theme, "The recordings could not be diagnosed", why);
        }
        (tab, Some(Ok(found))) => {
            egui::ScrollArea::vertical().show(ui, |ui| match tab {
                DiagnosisTab::Map => findings::show_localisation(ui, &theme, &found.answer),
                DiagnosisTab::Tried => findings::show_hypotheses(ui, &theme, &found.answer),
                _ => findings::show_answer(ui, view, queue, &found.answer),
            });
        }
        (_, None) if jobs.diagnose.is_busy() => {
            widgets::show_placeholder(ui, &theme, "Diagnosing", &jobs.diagnosis_progress());
        }
        (_, None) => widgets::show_placeholder(
            ui,
            &theme,
            "No diagnosis yet",
            "F6 fits every effect of the library to part of the data and compares them on the rest",
        ),
    }
}

fn show_tabs(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, jobs: &BackgroundJobs) {
    ui.horizontal(|ui| {
        for tab in DiagnosisTab::ALL {
            if ui.selectable_label(view.diagnosis_tab == tab, tab.name()).clicked() {
                queue.push(Command::ShowDiagnosis { tab });
            }
        }
        if let (Some(Ok(found)), true) = (&jobs.diagnosis, view.diagnosis_tab != DiagnosisTab::Findings) {
            ui.add_space(space::LARGE);
            let sentence = findings::verdict_sentence(found.answer.verdict);
            ui.label(RichText::new(sentence).color(view.theme.weak));
        }
    });
}

/// Shows the recordings, and what can be done with them.
fn show_recordings(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, jobs: &BackgroundJobs) {
    let theme = view.theme;
    widgets::show_heading(ui, "Recordings");
    let views = jobs.recording_views.as_ref().map(|of| of.value.as_slice()).unwrap_or_default();
    for (k, one) in views.iter().enumerate() {
        let colour = if one.errors.is_empty() { theme.text } else { theme.bad };
        let label = ui.selectable_label(view.recording == k, RichText::new(&one.name).color(colour));
        if label.on_hover_text(one.path.display().to_string()).clicked() {
            view.recording = k;
        }
    }
    if views.is_empty() {
        for path in &jobs.recordings {
            ui.label(path.file_name().unwrap_or_default().to_string_lossy());
        }
    }
    show_add_buttons(ui, view, queue, jobs);
    ui.add_space(space::SMALL);
    let is_busy = jobs.diagnose.is_busy();
    ui.horizontal(|ui| {
        let is_ready = !is_busy && !jobs.recordings.is_empty();
        if ui.add_enabled(is_ready, egui::Button::new("Diagnose")).on_hover_text("F6").clicked() {
            queue.push(Command::Diagnose);
        }
        let has_findings = matches!(&jobs.diagnosis, Some(Ok(found)) if !found.answer.findings.is_empty());
        let accept = ui.add_enabled(has_findings && !is_busy, egui::Button::new("Accept into the project"));
        if accept.on_hover_text("one step that can be undone; design and verification follow").clicked() {
            queue.push(Command::Accept);
        }
        if is_busy && ui.button("Stop").on_hover_text("Esc").clicked() {
            queue.push(Command::Cancel);
        }
    });
    if is_busy {
        ui.label(RichText::new(jobs.diagnosis_progress()).small().color(theme.accent));
    }
}

/// Shows ways to add recordings beside dropping them.
fn show_add_buttons(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, jobs: &BackgroundJobs) {
    if jobs.recordings.is_empty() {
        ui.label(RichText::new("Drop files or a folder onto the window, or").small().color(view.theme.weak));
    }
    ui.horizontal(|ui| {
        if ui.button("Add\u{2026}").on_hover_text("look for recordings (Ctrl+R)").clicked() {
            queue.push(Command::Browse { purpose: BrowsePurpose::Recordings });
        }
        let text = format!("Add the {} of the project's folder", jobs.nearby_recordings.len());
        if !jobs.recordings.is_empty() {
            if ui.button("Remove all").clicked() {
                queue.push(Command::Recordings { paths: Vec::new() });
            }
        } else if !jobs.nearby_recordings.is_empty() && ui.button(text).clicked() {
            queue.push(Command::Recordings { paths: jobs.nearby_recordings.clone() });
        }
    });
}

fn selected_recording<'a>(
    view: &StudioView,
    views: Option<&'a VersionedResult<Vec<RecordingView>>>,
) -> Option<&'a RecordingView> {
    let all = &views?.value;
    all.get(view.recording.min(all.len().saturating_sub(1)))
}

/// Shows one channel of the selected recording against another.
fn show_cross_plot(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, jobs: &BackgroundJobs) {
    let views = jobs.recording_views.as_ref();
    match (selected_recording(view, views), views) {
        (Some(recording), Some(of)) => recording_cross_plot::show(ui, view, queue, recording, of.revision),
        _ => {
            let text = "the recordings are read and replayed on the model";
            widgets::show_placeholder(ui, &view.theme, "Reading", text);
        }
    }
}

/// Most remarks of a recording that are shown at once.
const MOST_REMARKS: usize = 4;
/// Number of plots from which they stand in two columns.
const TWO_COLUMNS_FROM: usize = 5;

/// Shows the channels of the selected recording under one cursor.
fn show_channels(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, jobs: &BackgroundJobs) {
    let theme = view.theme;
    let Some(recording) = selected_recording(view, jobs.recording_views.as_ref()) else {
        let text = "the recordings are read and replayed on the model";
        return widgets::show_placeholder(ui, &theme, "Reading", text);
    };
    if !recording.errors.is_empty() {
        let is_unmapped = recording.channels.is_empty() && !recording.columns.is_empty();
        let advice = if is_unmapped {
            "choose its columns on the left"
        } else {
            "correct it, or choose its columns on the left"
        };
        widgets::show_error_list(ui, &theme, &format!("{}: {advice}", recording.name), &recording.errors);
    }
    if !recording.remarks.is_empty() {
        theme.card().show(ui, |ui| {
            ui.set_width(ui.available_width());
            for remark in recording.remarks.iter().take(MOST_REMARKS) {
                ui.label(RichText::new(remark).small().color(theme.warn));
            }
        });
    }
    let shows_residuals = view.diagnosis_tab == DiagnosisTab::Errors;
    let is_shown = |channel: &&ChannelView| channel.model.is_some() || !shows_residuals;
    let shown: Vec<&ChannelView> = recording.channels.iter().filter(is_shown).collect();
    if shown.is_empty() {
        return;
    }
    let area = widgets::take_remaining_area(ui);
    let columns = if shown.len() >= TWO_COLUMNS_FROM { 2 } else { 1 };
    for (cell, channel) in widgets::grid_cells(area, shown.len(), columns).iter().zip(shown) {
        let chart = match view.diagnosis_tab {
            DiagnosisTab::Errors => residual_chart(view, channel),
            DiagnosisTab::Spectra => density_chart(view, channel),
            _ => signal_chart(view, channel),
        };
        widgets::show_chart(ui, view, queue, *cell, &chart);
    }
}
