//! The page Commission: the rounds of design, experiment and redesign on a machine as a time line, and one button for the next round.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::commission::story::{FindingSummary, RequirementSummary};
use counterpoise_pipeline::commission::{RoundSummary, StopReason};
use counterpoise_report::commission::{describe_round, describe_stop, equivalents_text};
use counterpoise_report::wording::capitalise_first;
use egui::{RichText, Ui};

use super::{round_charts, widgets};
use crate::command::Command;
use crate::jobs::BackgroundJobs;
use crate::jobs::commissioning::CommissioningView;
use crate::number_format::format_short;
use crate::studio::Studio;
use crate::theme::{WindowTheme, space};
use crate::view::StudioView;

/// Width of the panel with the inputs, points.
const SIDE_WIDTH: f32 = 330.0;
/// Width of the card of a round, points.
const CARD_WIDTH: f32 = 300.0;
/// Height of the time line, points.
const LINE_HEIGHT: f32 = 270.0;

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let (jobs, view) = (&studio.jobs, &mut studio.view);
    let theme = view.theme;
    widgets::side_panel("commissioning", &theme, SIDE_WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            theme.card().show(ui, |ui| {
                ui.set_width(ui.available_width());
                show_inputs(ui, view, queue);
                ui.add_space(space::SMALL);
                show_buttons(ui, view, queue, jobs);
            });
        });
    });
    match &jobs.commissioning {
        Some(Err(why)) => {
            widgets::show_error_list(
                ui,
                &theme,
                "The round did not come to its end",
                std::slice::from_ref(why),
            );
        }
        Some(Ok(found)) if !found.rounds.is_empty() => {
            let project = studio.opened.as_ref().and_then(|opened| opened.session.project());
            let controlled = project.map_or(ControlledQuantity::RATE, |p| p.plant.controlled_quantity());
            show_rounds(ui, view, queue, &ShownRounds { found, controlled });
        }
        _ => widgets::show_placeholder(
            ui,
            &theme,
            "No round yet",
            "a round designs for every model that is still plausible, runs experiments on the machine, and updates the model by what it recorded",
        ),
    }
}

fn show_inputs(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>) {
    let theme = view.theme;
    let mut inputs = view.commissioning.clone();
    widgets::show_heading(ui, "Machine");
    let program = ui.label(RichText::new("program").color(theme.weak));
    let hint = "the command that runs an experiment on the machine; it is started with the folder of the experiment as its last argument";
    let field = egui::TextEdit::singleline(&mut inputs.machine).hint_text("python3 machine.py");
    ui.add(field.desired_width(f32::INFINITY)).labelled_by(program.id).on_hover_text(hint);
    let folder = ui.label(RichText::new("folder of the rounds").color(theme.weak));
    let field = egui::TextEdit::singleline(&mut inputs.folder).desired_width(f32::INFINITY);
    ui.add(field).labelled_by(folder.id).on_hover_text("in the folder of the project");
    widgets::show_heading(ui, "The machine must not pass");
    egui::Grid::new("limits").num_columns(3).show(ui, |ui| {
        widgets::limit_field(ui, &theme, "angle from the start", "rad", &mut inputs.angle_rad);
        widgets::limit_field(ui, &theme, "rate", "rad/s", &mut inputs.rate_rad_s);
        widgets::limit_field(ui, &theme, "current (0: no limit)", "A", &mut inputs.current_a);
        widgets::limit_field(ui, &theme, "duration of an experiment", "s", &mut inputs.duration_s);
    });
    if inputs != view.commissioning {
        queue.push(Command::SetCommissioning { inputs });
    }
}

fn show_buttons(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, jobs: &BackgroundJobs) {
    let theme = view.theme;
    let is_busy = jobs.commission.is_busy();
    let found = jobs.commissioning.as_ref().and_then(|found| found.as_ref().ok());
    let rounds = found.map_or(0, |found| found.rounds.len());
    let is_over = found.and_then(|found| found.rounds.last()).is_some_and(|round| round.stop.is_some());
    ui.horizontal(|ui| {
        let is_ready = !is_busy && !is_over && !view.commissioning.machine.trim().is_empty();
        let button = egui::Button::new(format!("Run round {}", rounds + 1));
        if ui.add_enabled(is_ready, button).on_hover_text("F9: the machine moves").clicked() {
            queue.push(Command::RunRound);
        }
        if is_busy && ui.button("Stop").on_hover_text("Esc: after the experiment that runs").clicked() {
            queue.push(Command::Cancel);
        }
        if !is_busy && ui.button("Read again").on_hover_text("the finished rounds of the folder").clicked() {
            queue.push(Command::ReadRounds);
        }
    });
    let has_model = found.is_some_and(|found| found.model.is_some());
    let accept = egui::Button::new("Take the model into the project");
    if ui.add_enabled(has_model && !is_busy, accept).on_hover_text("one step that can be undone").clicked() {
        queue.push(Command::AcceptRound);
    }
    if is_busy {
        let said = jobs.commissioning_progress();
        let said = if said.is_empty() { "designing, or the machine runs".to_owned() } else { said };
        ui.label(RichText::new(said).small().color(theme.accent));
    }
}

/// The rounds of a folder, and what their loop controls.
#[derive(Clone, Copy)]
struct ShownRounds<'a> {
    found: &'a CommissioningView,
    controlled: ControlledQuantity,
}

/// Shows the time line of rounds, and beneath it predicted against measured and what is left of the tolerances.
fn show_rounds(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, shown: &ShownRounds) {
    let (theme, ShownRounds { found, controlled }) = (view.theme, *shown);
    if let Some(stop) = found.rounds.last().and_then(|round| round.stop.as_ref()) {
        let is_met = matches!(stop, StopReason::RequirementsMet | StopReason::ModelExplains);
        let colour = if is_met { theme.good } else { theme.bad };
        ui.label(RichText::new(capitalise_first(&describe_stop(stop))).strong().color(colour));
    }
    egui::ScrollArea::horizontal().max_height(LINE_HEIGHT).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            for round in &found.rounds {
                show_card(ui, &theme, round, controlled);
            }
        });
    });
    ui.add_space(space::SMALL);
    let charts = round_charts::charts(&theme, &found.rounds, controlled);
    let area = widgets::take_remaining_area(ui);
    let columns = charts.len().clamp(1, 3);
    for (cell, chart) in widgets::grid_cells(area, charts.len(), columns).iter().zip(&charts) {
        widgets::show_chart(ui, view, queue, *cell, chart);
    }
}

fn show_card(ui: &mut Ui, theme: &WindowTheme, round: &RoundSummary, controlled: ControlledQuantity) {
    let card = theme.card().show(ui, |ui| {
        ui.set_width(CARD_WIDTH);
        ui.vertical(|ui| {
            ui.label(RichText::new(format!("Round {}", round.round)).heading());
            ui.label(RichText::new(loop_line(round)).color(theme.weak));
            for one in &round.requirements {
                let colour = if one.holds { theme.good } else { theme.bad };
                ui.label(RichText::new(requirement_line(one, controlled)).color(colour));
            }
            if let (Some(before), Some(after)) = (round.residual_before, round.residual_after) {
                let text =
                    format!("residual {} to {} noise floors", format_short(before), format_short(after));
                ui.label(text);
            }
            for found in &round.findings {
                ui.label(RichText::new(finding_line(found)).color(theme.accent));
            }
            for name in &round.left_out {
                ui.label(RichText::new(format!("{name} left out")).color(theme.warn));
            }
        });
    });
    card.response.on_hover_text(describe_round(round).join("\n"));
}

fn loop_line(round: &RoundSummary) -> String {
    let crossover = round
        .crossover_rad_s
        .map_or_else(String::new, |rate| format!("crossover {} rad/s", format_short(rate)));
    let margin =
        round.gain_margin_db.map_or_else(String::new, |db| format!(", gain margin {} dB", format_short(db)));
    format!("{crossover}{margin}")
}

fn requirement_line(one: &RequirementSummary, controlled: ControlledQuantity) -> String {
    let shown = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), format_short);
    let name = round_charts::figure_name(&one.figure, controlled);
    format!(
        "{name}: {}, predicted {} ({} {})",
        shown(one.measured),
        shown(one.predicted),
        one.side,
        format_short(one.limit)
    )
}

fn finding_line(found: &FindingSummary) -> String {
    let values: Vec<String> =
        found.values.iter().map(|value| format!("{} {}", format_short(value.value), value.unit)).collect();
    format!(
        "added: {} {} {}{}",
        found.component.replace('_', " "),
        found.effect.replace('_', " "),
        values.join(", "),
        equivalents_text(found)
    )
}
