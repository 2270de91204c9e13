//! Verify: verdicts on the full plant, and the figure behind each, one click away; then export.

use std::sync::Arc;

use counterpoise_project::verify::{
    Arrangement, Experiment, Figure, History, Limit, Model, Requirement, Source, Verdict, VerifiedController,
};
use egui::{RichText, Ui};

use super::{design::bode, parts};
use crate::chart::{Chart, Dash};
use crate::command::Command;
use crate::results::Age;
use crate::studio::Studio;
use crate::theme::{Theme, space};
use crate::view::View;

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let found =
        studio.results.verified.as_ref().map(|of| (Arc::clone(&of.value), Age::of(of.revision, revision)));
    let why = studio.results.no_verification.as_ref().map(|of| of.value.clone());
    let verifying = studio.results.verifying;
    let view = &mut studio.view;
    if let Some(why) = &why {
        parts::reasons(ui, &view.theme, "The design could not be verified", why);
    }
    let Some((verified, age)) = found else {
        return parts::empty(
            ui,
            &view.theme,
            if verifying { "Verifying" } else { "Not verified yet" },
            "F5 runs the design on the full plant",
        );
    };
    parts::side("verdicts", &view.theme, 430.0).show(ui, |ui| {
        ui.horizontal(|ui| {
            if ui.button("Verify").on_hover_text("F5").clicked() {
                queue.push(Command::Verify);
            }
            if ui
                .add_enabled(age == Age::Fresh, egui::Button::new("Export code"))
                .on_hover_text("Ctrl+E: into the folder out beside the project")
                .clicked()
            {
                queue.push(Command::Export);
            }
            if age == Age::Stale {
                ui.label(RichText::new("of an older design").color(view.theme.warn));
            }
        });
        ui.add_space(space::SMALL);
        egui::ScrollArea::vertical().show(ui, |ui| table(ui, view, &verified));
    });
    if age == Age::Stale {
        ui.multiply_opacity(0.55);
    }
    plots(ui, view, queue, &verified);
}

fn table(ui: &mut Ui, view: &mut View, verified: &VerifiedController) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        for (k, (requirement, verdict)) in verified.verification().verdicts.iter().enumerate() {
            if row(ui, &theme, (requirement, verdict), view.verdict == k) {
                view.verdict = k;
            }
        }
    });
}

/// One requirement; says whether it was clicked.
fn row(ui: &mut Ui, theme: &Theme, (requirement, verdict): (&Requirement, &Verdict), chosen: bool) -> bool {
    let (mark, colour, value) = match verdict {
        Verdict::Holds { value, .. } => ("holds", theme.good, parts::short(*value)),
        Verdict::Fails { value, .. } => ("FAILS", theme.bad, parts::short(*value)),
        Verdict::NotApplicable { .. } => ("open", theme.warn, "-".to_owned()),
    };
    let sign = match requirement.limit {
        Limit::AtLeast(_) => "\u{2265}",
        Limit::AtMost(_) => "\u{2264}",
    };
    let figure = requirement.figure.unit();
    let limit = format!("{value} {sign} {} {figure}", parts::short(requirement.limit.value()));
    let width = ui.available_width();
    let text = format!("{mark}  {}", requirement.figure.name());
    let button = egui::Button::selectable(chosen, RichText::new(text).color(colour))
        .right_text(RichText::new(limit).small().color(theme.text))
        .truncate()
        .min_size(egui::vec2(width, 24.0));
    ui.add(button).on_hover_text(requirement.figure.name()).clicked()
}

fn plots(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, verified: &VerifiedController) {
    let verdicts = &verified.verification().verdicts;
    let chosen = verdicts.get(view.verdict.min(verdicts.len().saturating_sub(1)));
    let behind = chosen.map_or(Experiment::Step, |(requirement, _)| experiment(requirement.figure));
    let mut charts = vec![behind_chart(view, verified, behind)];
    charts.push(time_chart(view, verified, behind, "Control", "V", |h| &h.control_v));
    charts.push(rejection(view, verified, Source::Heave));
    charts.push(rejection(view, verified, Source::Pitch));
    let room = parts::room(ui);
    for (cell, chart) in parts::grid(room, 4, 2).iter().zip(&charts) {
        parts::chart(ui, view, queue, *cell, chart);
    }
}

/// The run that a figure was read from.
fn experiment(figure: Figure) -> Experiment {
    let key = figure.key();
    let source = if key.contains("road") {
        Source::Road
    } else if key.contains("both") {
        Source::Both
    } else if key.contains("heave") {
        Source::Heave
    } else if key.contains("pitch") {
        Source::Pitch
    } else if key.contains("rest") {
        return Experiment::Rest;
    } else {
        return Experiment::Step;
    };
    Experiment::Disturbance(source, Arrangement::Compensated)
}

fn name(experiment: Experiment) -> &'static str {
    match experiment {
        Experiment::Step => "Step of the demand",
        Experiment::Rest => "At rest",
        Experiment::Disturbance(Source::Heave, _) => "Heave of the platform",
        Experiment::Disturbance(Source::Pitch, _) => "Pitch of the platform",
        Experiment::Disturbance(Source::Both, _) => "Heave and pitch",
        Experiment::Disturbance(Source::Road, _) => "On the road",
    }
}

fn series(history: &History, column: fn(&History) -> &Vec<f64>, factor: f64) -> Vec<[f64; 2]> {
    history.time_s.iter().zip(column(history)).map(|(t, v)| [*t, factor * v]).collect()
}

fn behind_chart(view: &View, verified: &VerifiedController, experiment: Experiment) -> Chart {
    let found = verified.verification();
    let title = format!("{}: hub rate", name(experiment));
    let mut chart = Chart::new(&title, "time, s", "hub rate, mrad/s");
    if let Experiment::Disturbance(source, _) = experiment
        && let Some(h) =
            found.history(Model::Nonlinear, Experiment::Disturbance(source, Arrangement::Feedback))
    {
        let points = series(h, |h| &h.hub_rate_rad_s, 1e3);
        chart = chart.curve("feedback alone", view.theme.curves[1].gamma_multiply(0.7), Dash::Solid, points);
    }
    for (model, label, colour, dash) in [
        (Model::Nonlinear, "full plant", view.theme.curves[0], Dash::Solid),
        (Model::Linear, "linear", view.theme.curves[2], Dash::Dashed),
    ] {
        if let Some(h) = found.history(model, experiment) {
            chart = chart.curve(label, colour, dash, series(h, |h| &h.hub_rate_rad_s, 1e3));
        }
    }
    chart
}

fn time_chart(
    view: &View,
    verified: &VerifiedController,
    experiment: Experiment,
    what: &str,
    unit: &str,
    column: fn(&History) -> &Vec<f64>,
) -> Chart {
    let title = format!("{}: {}", name(experiment), what.to_lowercase());
    let chart = Chart::new(&title, "time, s", &format!("{}, {unit}", what.to_lowercase()));
    match verified.verification().history(Model::Nonlinear, experiment) {
        Some(h) => chart.curve("full plant", view.theme.curves[0], Dash::Solid, series(h, column, 1.0)),
        None => chart,
    }
}

/// What is left of a disturbance over frequency, by how much of the controller acts.
fn rejection(view: &View, verified: &VerifiedController, source: Source) -> Chart {
    let (title, label) = if source == Source::Heave {
        ("Rejection of heave", "rad/s per m/s\u{b2}")
    } else {
        ("Rejection of pitch", "rad/s per rad/s")
    };
    let curves = &verified.verification().evidence.curves;
    let mut chart = bode(view, title, label);
    for one in curves.rejection.iter().filter(|r| r.source == source) {
        let (name, k, dash) = match one.arrangement {
            Arrangement::Uncontrolled => ("none", 3, Dash::Dotted),
            Arrangement::Feedback => ("feedback", 1, Dash::Dashed),
            Arrangement::Compensated => ("with feedforward", 0, Dash::Solid),
        };
        let rate = |f: f64| view.rate(f * std::f64::consts::TAU);
        let points = curves
            .frequency_hz
            .iter()
            .zip(&one.response)
            .map(|(f, h)| [rate(*f), view.level(h.norm())])
            .collect();
        chart = chart.curve(name, view.theme.curves[k], dash, points);
    }
    chart
}
