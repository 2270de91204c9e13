//! The page Studies: searches and comparisons of designs, the test of the adaptation, another project beside this one, identification and the next
//! experiment, each as the command line makes it.

use std::sync::Arc;

use counterpoise_models::ControlledQuantity;
use egui::{RichText, Ui};

use super::{report_view, widgets};
use crate::command::Command;
use crate::jobs::BackgroundJobs;
use crate::jobs::studies::StudyResult;
use crate::studio::Studio;
use crate::study_inputs::{StudyInputs, StudyKind};
use crate::theme::{WindowTheme, space};
use crate::tolerance::CLICK_REACH;
use crate::versioned_results::Freshness;
use crate::view::StudioView;

/// Width of the panel with the studies, points.
const SIDE_WIDTH: f32 = 330.0;

/// The project to which the studies belong.
#[derive(Clone, Copy)]
struct StudiedProject {
    /// Its revision.
    revision: u64,
    /// What its loop controls.
    controlled: ControlledQuantity,
}

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let session = studio.opened.as_ref().map(|opened| &opened.session);
    let project = session.and_then(|session| session.project());
    let studied = StudiedProject {
        revision: session.map_or(0, |session| session.revision()),
        controlled: project.map_or(ControlledQuantity::RATE, |p| p.plant.controlled_quantity()),
    };
    let (jobs, view) = (&studio.jobs, &mut studio.view);
    let theme = view.theme;
    widgets::side_panel("studies", &theme, SIDE_WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            theme.card().show(ui, |ui| {
                ui.set_width(ui.available_width());
                show_list(ui, view, queue, jobs, studied);
            });
            theme.card().show(ui, |ui| {
                ui.set_width(ui.available_width());
                show_chosen(ui, view, queue, jobs, studied);
            });
        });
    });
    let kind = view.study;
    let is_busy = jobs.study.is_busy() && jobs.asked_study == kind;
    match jobs.studies.get(&kind).map(|found| (&found.value, found.freshness(studied.revision))) {
        Some((Ok(found), freshness)) => show_result(ui, view, queue, found, freshness),
        Some((Err(why), _)) => widgets::show_error_list(ui, &theme, "The study has no result", why),
        None if is_busy => {
            widgets::show_placeholder(ui, &theme, "At work", "the result appears when it is complete");
        }
        None => widgets::show_placeholder(
            ui,
            &theme,
            "Not made yet",
            "F10 makes the study of the project as it stands",
        ),
    }
}

/// Shows every study with the state of its result.
fn show_list(
    ui: &mut Ui,
    view: &StudioView,
    queue: &mut Vec<Command>,
    jobs: &BackgroundJobs,
    studied: StudiedProject,
) {
    let theme = &view.theme;
    widgets::show_heading(ui, "Studies");
    for study in StudyKind::ALL {
        let found = jobs.studies.get(&study);
        let state = match found.map(|found| (&found.value, found.freshness(studied.revision))) {
            _ if jobs.study.is_busy() && jobs.asked_study == study => {
                RichText::new("at work").color(theme.accent)
            }
            None => RichText::new(""),
            Some((Err(_), _)) => RichText::new("no result").color(theme.bad),
            Some((Ok(_), Freshness::Stale)) => RichText::new("of an older project").color(theme.warn),
            Some((Ok(_), Freshness::Current)) => RichText::new("made").color(theme.good),
        };
        ui.horizontal(|ui| {
            if ui.selectable_label(view.study == study, study.name()).clicked() {
                queue.push(Command::ShowStudy { study });
            }
            ui.label(state.small());
        });
    }
}

/// Shows the study that is chosen: what it answers, what it needs, and its buttons.
fn show_chosen(
    ui: &mut Ui,
    view: &StudioView,
    queue: &mut Vec<Command>,
    jobs: &BackgroundJobs,
    studied: StudiedProject,
) {
    let (theme, study) = (view.theme, view.study);
    widgets::show_heading(ui, study.name());
    ui.label(RichText::new(study.summary()).small().color(theme.weak));
    ui.add_space(space::SMALL);
    show_inputs(ui, view, queue, jobs, studied.controlled);
    let is_busy = jobs.study.is_busy();
    ui.horizontal(|ui| {
        if ui.add_enabled(!is_busy, egui::Button::new("Run")).on_hover_text("F10").clicked() {
            queue.push(Command::RunStudy { study });
        }
        if is_busy && ui.button("Stop").on_hover_text("Esc").clicked() {
            queue.push(Command::Cancel);
        }
    });
    if is_busy {
        let said = jobs.study_progress();
        let said = if said.is_empty() { "at work".to_owned() } else { said };
        ui.label(RichText::new(said).small().color(theme.accent));
    }
}

fn show_inputs(
    ui: &mut Ui,
    view: &StudioView,
    queue: &mut Vec<Command>,
    jobs: &BackgroundJobs,
    controlled: ControlledQuantity,
) {
    let theme = view.theme;
    let mut inputs = view.study_inputs.clone();
    match view.study {
        StudyKind::Against => {
            let hint = "a project file or its folder; a relative path begins in the folder of this project";
            text_field(ui, &theme, "the other project", &mut inputs.against, hint);
        }
        StudyKind::Experiment => show_limits(ui, &theme, &mut inputs, controlled),
        StudyKind::Identify => {
            let text = match jobs.recordings.len() {
                0 => "no recordings yet: Ctrl+R adds them".to_owned(),
                1 => "1 recording".to_owned(),
                count => format!("{count} recordings"),
            };
            ui.label(text);
        }
        StudyKind::Search | StudyKind::Compare | StudyKind::Adapt => {}
    }
    if inputs != view.study_inputs {
        queue.push(Command::SetStudyInputs { inputs });
    }
}

fn text_field(ui: &mut Ui, theme: &WindowTheme, name: &str, value: &mut String, hint: &str) {
    let label = ui.label(RichText::new(name).color(theme.weak));
    let field = egui::TextEdit::singleline(value).desired_width(f32::INFINITY);
    ui.add(field).labelled_by(label.id).on_hover_text(hint);
}

fn show_limits(ui: &mut Ui, theme: &WindowTheme, inputs: &mut StudyInputs, controlled: ControlledQuantity) {
    ui.label(RichText::new("The machine must not pass").strong());
    egui::Grid::new("experiment limits").num_columns(3).show(ui, |ui| {
        let (travel, rate) = (controlled.travel_unit(), controlled.rate().unit());
        widgets::limit_field(ui, theme, "angle from the start", travel, &mut inputs.angle_rad);
        widgets::limit_field(ui, theme, "rate", rate, &mut inputs.rate_rad_s);
        widgets::limit_field(ui, theme, "current (0: no limit)", "A", &mut inputs.current_a);
        widgets::limit_field(ui, theme, "duration", "s", &mut inputs.duration_s);
    });
    text_field(ui, theme, "file for the demand", &mut inputs.demand_file, "in the folder of the project");
}

fn show_result(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    found: &Arc<StudyResult>,
    freshness: Freshness,
) {
    let theme = view.theme;
    if freshness == Freshness::Stale {
        let text = "of an older state of the project: F10 makes the study again";
        ui.label(RichText::new(text).color(theme.warn));
    }
    let is_current = freshness == Freshness::Current;
    let clicked = report_view::show(ui, view, queue, &found.report, |ui, queue| {
        show_proposals(ui, &theme, queue, found, freshness);
    });
    let nearest = clicked.and_then(|click| {
        let places = found.places.get(click.figure)?.iter().map(|place| click.distance(*place));
        let nearest = places.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
        (nearest.1 < CLICK_REACH).then_some(nearest.0 + 1)
    });
    if let Some(number) = nearest.filter(|_| is_current) {
        queue.push(Command::TakeProposal { number });
    }
}

/// Shows what can be taken into the project.
fn show_proposals(
    ui: &mut Ui,
    theme: &WindowTheme,
    queue: &mut Vec<Command>,
    found: &StudyResult,
    freshness: Freshness,
) {
    if found.proposals.is_empty() {
        return;
    }
    let is_current = freshness == Freshness::Current;
    let hint = if found.places.is_empty() { "" } else { ": a click on its point in a plot, or" };
    ui.label(RichText::new(format!("Take into the project{hint}")).color(theme.weak));
    let mut number = 0;
    for group in found.proposals.chunk_by(|a, b| a.group == b.group) {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(&group[0].group).small());
            for proposal in group {
                number += 1;
                let text = proposal.name.trim_start_matches("design ");
                let button = egui::Button::new(text).small();
                let shown = ui.add_enabled(is_current, button);
                let name = format!("take {}, {}", proposal.group, proposal.name);
                shown.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_current, &name));
                if shown.on_hover_text("one step that can be undone").clicked() {
                    queue.push(Command::TakeProposal { number });
                }
            }
        });
    }
    ui.add_space(space::SMALL);
}
