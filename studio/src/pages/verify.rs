//! The page Verify: verdicts on the full plant while the runs come in, and the evidence behind each one; then export.

use counterpoise_report::error_budget;
use counterpoise_report::wording::acceptance::AcceptanceSource;
use counterpoise_report::wording::figures::describe_figure;
use counterpoise_verify::{Limit, PerformanceFigure, Verdict, Verification};
use egui::{RichText, Ui};

use super::measurements::{self, ShownMeasurements};
use super::requirement_values::{Requirements, ValueSources};
use super::{no_controller, plot_tiles, verify_charts, widgets};
use crate::command::{BrowsePurpose, Command, VerificationTab};
use crate::number_format::format_short;
use crate::results::VerificationState;
use crate::studio::Studio;
use crate::theme::space;
use crate::view::StudioView;

/// Width of the panel with the verdicts, points.
const SIDE_WIDTH: f32 = 440.0;

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    if opened.session.project().is_some_and(|p| p.synth.is_none()) {
        return no_controller::show(ui, &studio.view.theme, queue, "verify");
    }
    let why = studio.results.verification_failure.as_ref().map(|of| of.value.as_slice());
    let shown = ShownMeasurements {
        measurements: &studio.results.measurements,
        revision,
        progress: studio.jobs().measure.is_busy().then(|| studio.jobs().measurement_progress()),
    };
    let has_overlay_runs = studio.jobs().overlay_runs.is_busy();
    let runs = if has_overlay_runs { RunState::Running } else { RunState::Resting };
    let no_design = studio.results.design_errors(revision).map(<[String]>::to_vec);
    let (results, view) = (&studio.results, &mut studio.view);
    if let Some(why) = why {
        widgets::show_error_list(ui, &view.theme, "The design could not be verified", why);
    }
    let Some((found, state)) = results.verification(revision) else {
        let is_running = results.verifying || results.designing;
        return show_missing(
            ui,
            view,
            no_design.as_deref(),
            if is_running { RunState::Running } else { RunState::Resting },
        );
    };
    let project = opened.session.project();
    let requirements = project.map_or_else(Requirements::default, |project| {
        Requirements::new(&opened.session, project, ValueSources::of_results(results, revision))
    });
    let elevation_rad = project.map_or(0.0, |project| project.model.operating_point.hub_angle_rad);
    let verification = verify_charts::ShownVerification { found, requirements: &requirements, elevation_rad };
    widgets::side_panel("verdicts", &view.theme, SIDE_WIDTH).show(ui, |ui| {
        show_actions(ui, view, queue, state);
        ui.add_space(space::SMALL);
        egui::ScrollArea::vertical().show(ui, |ui| {
            show_verdicts(ui, view, queue, found);
            show_line_of_sight(ui, view, found);
        });
    });
    show_tabs(ui, view, queue, runs);
    let is_measurement = matches!(view.verification_tab, VerificationTab::Map | VerificationTab::Robustness);
    if state == VerificationState::Stale && !is_measurement {
        ui.multiply_opacity(0.55);
    }
    match view.verification_tab {
        VerificationTab::Histories => verify_charts::show_histories(ui, view, queue, verification),
        VerificationTab::Rejection => verify_charts::show_responses(ui, view, queue, verification),
        VerificationTab::Map => measurements::show_map(ui, view, queue, &shown),
        VerificationTab::Robustness => measurements::show_campaign(ui, view, queue, &shown),
    }
}

fn show_tabs(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, runs: RunState) {
    ui.horizontal(|ui| {
        for tab in VerificationTab::ALL {
            if ui.selectable_label(view.verification_tab == tab, tab.name()).clicked() {
                queue.push(Command::ShowVerification { tab });
            }
        }
        plot_tiles::show_menu(ui, view, queue);
        if runs == RunState::Running {
            let text = "the designs that are drawn beside it run on the full plant";
            ui.label(RichText::new(text).small().color(view.theme.accent));
        }
    });
}

/// Whether something is being computed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum RunState {
    Running,
    Resting,
}

/// Shows why there is no verification.
fn show_missing(ui: &mut Ui, view: &StudioView, no_design: Option<&[String]>, state: RunState) {
    if let Some(reasons) = no_design {
        return widgets::show_error_list(ui, &view.theme, "There is no controller to verify", reasons);
    }
    let (title, text) = match state {
        RunState::Running => ("Verifying", "the first runs appear in a moment"),
        RunState::Resting => ("Not verified yet", "F5 runs the design on the full plant"),
    };
    widgets::show_placeholder(ui, &view.theme, title, text);
}

fn show_actions(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, state: VerificationState) {
    ui.horizontal(|ui| {
        if ui.button("Verify").on_hover_text("F5").clicked() {
            queue.push(Command::Verify);
        }
        let is_complete = state == VerificationState::Complete;
        let export = ui.add_enabled(is_complete, egui::Button::new("Export code"));
        let hint = "Ctrl+E: into the folder that was chosen last, or out in the project's folder";
        if export.on_hover_text(hint).clicked() {
            queue.push(Command::Export);
        }
        let elsewhere = ui.add_enabled(is_complete, egui::Button::new("Export into\u{2026}"));
        if elsewhere.on_hover_text("Ctrl+Shift+E: into another folder").clicked() {
            queue.push(Command::Browse { purpose: BrowsePurpose::Export });
        }
        let report = ui.add_enabled(is_complete, egui::Button::new("Report\u{2026}"));
        if report
            .on_hover_text("Ctrl+Shift+R: everything that counterpoise design reports, as HTML")
            .clicked()
        {
            queue.push(Command::Browse { purpose: BrowsePurpose::Report });
        }
        match state {
            VerificationState::Complete => {}
            VerificationState::Stale => {
                ui.label(RichText::new("of an older design").color(view.theme.warn));
            }
            VerificationState::Running => {
                ui.label(RichText::new("running").color(view.theme.accent));
                if ui.button("Stop").on_hover_text("Esc").clicked() {
                    queue.push(Command::Cancel);
                }
            }
        }
    });
}

fn show_verdicts(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, found: &Verification) {
    view.theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        if found.verdicts.is_empty() {
            let text = "The project states no requirements; add [[verify.requirement]] to the file.";
            ui.label(RichText::new(text).color(view.theme.weak));
        }
        for (k, (requirement, _)) in found.verdicts.iter().enumerate() {
            if show_verdict(ui, view, found, k).clicked() {
                view.requirement = k;
                let tab = evidence_tab(requirement.figure);
                queue.push(Command::ShowVerification { tab });
            }
        }
    });
}

/// Shows the line of sight and its error budget; nothing if the project does not ask for them.
fn show_line_of_sight(ui: &mut Ui, view: &StudioView, found: &Verification) {
    let lines = error_budget::budget_lines(found);
    if lines.is_empty() {
        return;
    }
    ui.add_space(space::SMALL);
    view.theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new("Line of sight").strong());
        for line in lines {
            ui.label(RichText::new(line).color(view.theme.text));
        }
    });
}

/// Shows the requirement of an index with its verdict as a button.
fn show_verdict(ui: &mut Ui, view: &StudioView, found: &Verification, index: usize) -> egui::Response {
    let ((requirement, verdict), is_selected) = (&found.verdicts[index], view.requirement == index);
    let theme = &view.theme;
    let unit = view.units.display_unit(requirement.figure.unit(found.controlled_quantity()));
    let (word, colour, value) = match verdict {
        Verdict::Holds { value, .. } => ("holds", theme.good, format_short(unit.factor * value)),
        Verdict::Fails { value, .. } => ("FAILS", theme.bad, format_short(unit.factor * value)),
        Verdict::NotApplicable { .. } => ("open", theme.warn, "-".to_owned()),
    };
    let sign = match requirement.limit {
        Limit::AtLeast(_) => "\u{2265}",
        Limit::AtMost(_) => "\u{2264}",
    };
    let figure = describe_figure(requirement.figure, found.controlled_quantity());
    let limit = format_short(unit.factor * requirement.limit.value());
    let limit = format!("{value} {sign} {limit} {}", unit.name);
    let text_colour = if matches!(verdict, Verdict::Holds { .. }) { theme.text } else { colour };
    let sign = egui::IdSalt::new("verdict");
    let atoms =
        (egui::Atom::custom(sign, egui::Vec2::splat(8.0)), widgets::figure_name_layout(&figure, theme));
    let button = egui::Button::selectable(is_selected, atoms)
        .right_text(RichText::new(limit.trim_end()).small().color(text_colour))
        .wrap_mode(egui::TextWrapMode::Extend)
        .min_size(egui::vec2(ui.available_width(), 24.0));
    let shown = button.atom_ui(ui);
    if let Some(at) = shown.rect(sign) {
        draw_verdict_sign(ui, at.center(), verdict, colour);
    }
    let basis = found.acceptance(&requirement.figure).basis;
    let text = format!("{word}: {figure}, {limit}, {basis}");
    shown
        .response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, text.clone()));
    shown.response.on_hover_text(format!("{figure}: {basis}"))
}

/// Draws a verdict as a sign that can be read without colour: a dot, a cross, or a ring.
fn draw_verdict_sign(ui: &Ui, at: egui::Pos2, verdict: &Verdict, colour: egui::Color32) {
    let (painter, stroke) = (ui.painter(), egui::Stroke::new(2.0, colour));
    match verdict {
        Verdict::Holds { .. } => {
            painter.circle_filled(at, 4.0, colour);
        }
        Verdict::Fails { .. } => {
            for side in [egui::vec2(4.0, 4.0), egui::vec2(4.0, -4.0)] {
                painter.line_segment([at - side, at + side], stroke);
            }
        }
        Verdict::NotApplicable { .. } => {
            painter.circle_stroke(at, 3.5, stroke);
        }
    }
}

/// Returns the tab that shows what a figure is read from.
fn evidence_tab(figure: PerformanceFigure) -> VerificationTab {
    if figure.is_over_frequency() { VerificationTab::Rejection } else { VerificationTab::Histories }
}
