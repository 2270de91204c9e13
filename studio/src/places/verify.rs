//! Verify: verdicts on the full plant, the figure behind each one click away, while the runs stream in; then export.

use counterpoise_verify::{
    Arrangement, Experiment, Figure, History, Limit, Model, Requirement, Source, Verdict, Verification,
};
use egui::{RichText, Ui};

use super::{design::bode, limits, limits::Signal, parts, robustness};
use crate::chart::{Chart, Dash};
use crate::command::{Command, Evidence, Purpose};
use crate::results::Standing;
use crate::studio::Studio;
use crate::theme::space;
use crate::view::View;

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let why = studio.results.no_verification.as_ref().map(|of| of.value.as_slice());
    let busy = studio.diagnosis().measure.is_busy();
    let (results, view) = (&studio.results, &mut studio.view);
    if let Some(why) = why {
        parts::reasons(ui, &view.theme, "The design could not be verified", why);
    }
    let Some((found, standing)) = results.verification(revision) else {
        let title = if results.verifying { "Verifying" } else { "Not verified yet" };
        return parts::empty(ui, &view.theme, title, "F5 runs the design on the full plant");
    };
    parts::side("verdicts", &view.theme, 440.0).show(ui, |ui| {
        actions(ui, view, queue, standing);
        ui.add_space(space::SMALL);
        egui::ScrollArea::vertical().show(ui, |ui| table(ui, view, queue, found));
    });
    ui.horizontal(|ui| {
        for evidence in Evidence::ALL {
            if ui.selectable_label(view.evidence == evidence, evidence.name()).clicked() {
                queue.push(Command::Look { evidence });
            }
        }
    });
    if standing == Standing::Stale {
        ui.multiply_opacity(0.55);
    }
    match view.evidence {
        Evidence::Histories => histories(ui, view, queue, found),
        Evidence::Rejection => rejections(ui, view, queue, found),
        Evidence::Map => robustness::map(ui, view, queue, (&results.measured, revision, busy)),
        Evidence::Robustness => robustness::campaign(ui, view, queue, (&results.measured, revision, busy)),
    }
}

fn actions(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, standing: Standing) {
    ui.horizontal(|ui| {
        if ui.button("Verify").on_hover_text("F5").clicked() {
            queue.push(Command::Verify);
        }
        let export = ui.add_enabled(standing == Standing::Whole, egui::Button::new("Export code"));
        if export
            .on_hover_text("Ctrl+E: into the folder that was chosen last, or out beside the project")
            .clicked()
        {
            queue.push(Command::Export);
        }
        let elsewhere = ui.add_enabled(standing == Standing::Whole, egui::Button::new("Export into\u{2026}"));
        if elsewhere.on_hover_text("Ctrl+Shift+E: into another folder").clicked() {
            queue.push(Command::Browse { purpose: Purpose::Export });
        }
        match standing {
            Standing::Whole => {}
            Standing::Stale => {
                ui.label(RichText::new("of an older design").color(view.theme.warn));
            }
            Standing::Running => {
                ui.label(RichText::new("running").color(view.theme.accent));
                if ui.button("Stop").on_hover_text("Esc").clicked() {
                    queue.push(Command::Cancel);
                }
            }
        }
    });
}

fn table(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, found: &Verification) {
    view.theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        for (k, (requirement, verdict)) in found.verdicts.iter().enumerate() {
            if row(ui, view, (requirement, verdict), view.verdict == k) {
                view.verdict = k;
                let evidence = behind(requirement.figure);
                queue.push(Command::Look { evidence });
            }
        }
    });
}

/// One requirement; says whether it was clicked.
fn row(ui: &mut Ui, view: &View, (requirement, verdict): (&Requirement, &Verdict), chosen: bool) -> bool {
    let theme = &view.theme;
    let (unit, factor) = view.shown_unit(requirement.figure.unit());
    let (mark, colour, value) = match verdict {
        Verdict::Holds { value, .. } => ("holds", theme.good, parts::short(factor * value)),
        Verdict::Fails { value, .. } => ("FAILS", theme.bad, parts::short(factor * value)),
        Verdict::NotApplicable { .. } => ("open", theme.warn, "-".to_owned()),
    };
    let sign = match requirement.limit {
        Limit::AtLeast(_) => "\u{2265}",
        Limit::AtMost(_) => "\u{2264}",
    };
    let figure = requirement.figure.name();
    let limit = format!("{value} {sign} {} {unit}", parts::short(factor * requirement.limit.value()));
    let tint = if matches!(verdict, Verdict::Holds { .. }) { theme.text } else { colour };
    let sign = egui::IdSalt::new("verdict");
    let atoms = (egui::Atom::custom(sign, egui::Vec2::splat(8.0)), parts::figure(&figure, theme));
    let button = egui::Button::selectable(chosen, atoms)
        .right_text(RichText::new(limit.trim_end()).small().color(tint))
        .wrap_mode(egui::TextWrapMode::Extend)
        .min_size(egui::vec2(ui.available_width(), 24.0));
    let shown = button.atom_ui(ui);
    if let Some(at) = shown.rect(sign) {
        marked(ui, at.center(), verdict, colour);
    }
    let said = format!("{mark}: {figure}, {limit}");
    shown.response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, chosen, said.clone()));
    shown.response.on_hover_text(figure.as_ref() as &str).clicked()
}

/// A verdict as a sign that is told without colour: a dot, a cross, or a ring.
fn marked(ui: &Ui, at: egui::Pos2, verdict: &Verdict, colour: egui::Color32) {
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

/// What a figure is read from.
fn behind(figure: Figure) -> Evidence {
    let key = figure.key();
    let over_frequency = ["margin", "sensitivity", "drr"].iter().any(|word| key.contains(word));
    if over_frequency { Evidence::Rejection } else { Evidence::Histories }
}

fn chosen(view: &View, found: &Verification) -> Experiment {
    limits::chosen(view, found).map_or(Experiment::Step, |requirement| experiment(requirement.figure))
}

/// The run behind the chosen verdict, four of its signals under one cursor.
fn histories(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, found: &Verification) {
    let of = chosen(view, found);
    let rate = view.angular();
    let mut charts = [
        hub_chart(view, found, of),
        time_chart(view, found, of, ("Control", "V", 1.0), |h| &h.control_v),
        time_chart(view, found, of, ("Motor current", "A", 1.0), |h| &h.current_a),
        time_chart(view, found, of, ("Tip rate", view.angular_rate_unit(), rate), |h| &h.tip_rate_rad_s),
    ];
    let signals = [Signal::Hub, Signal::Control, Signal::Current, Signal::Tip];
    for (chart, signal) in charts.iter_mut().zip(signals) {
        limits::over_time(view, found, of, signal, chart);
    }
    let room = parts::room(ui);
    for (cell, chart) in parts::grid(room, 4, 2).iter().zip(&charts) {
        parts::chart(ui, view, queue, *cell, chart);
    }
}

/// What the loop does over frequency.
fn rejections(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, found: &Verification) {
    let curves = &found.evidence.curves;
    let of = |response: &counterpoise_verify::linear::Curve| -> Vec<[f64; 2]> {
        let at = |(f, h): (&f64, &counterpoise_lti::C64)| {
            [view.rate(f * std::f64::consts::TAU), view.level(h.norm())]
        };
        curves.frequency_hz.iter().zip(&response.response).map(at).collect()
    };
    let c = view.theme.curves;
    let mut loops = bode(view, "Loop gain", "modulus").curve("L", c[0], Dash::Solid, of(&curves.broken));
    loops.levels.push(view.level(1.0));
    if let Some(crossing) = found.evidence.margins.phase_margin() {
        loops.marks.push((view.rate(crossing.rate_rad_s), format!("{:.0}\u{b0}", crossing.deg)));
    }
    if let Some(gain) = found.evidence.margins.gain_increase() {
        loops.marks.push((view.rate(gain.rate_rad_s), format!("{:.1} dB", gain.db)));
    }
    loops.range[1] = Some((view.level(1e-4), view.level(1e4)));
    let mut sensitivity = bode(view, "Sensitivity", "modulus");
    for (k, (one, name)) in curves.sensitivities.iter().zip(["S", "T"]).enumerate() {
        sensitivity = sensitivity.curve(name, c[k], [Dash::Solid, Dash::Dashed][k % 2], of(one));
    }
    limits::of_sensitivity(view, found, &mut sensitivity);
    sensitivity.range[1] = Some((view.level(1e-3), view.level(4.0)));
    let charts =
        [rejection(view, found, Source::Heave), rejection(view, found, Source::Pitch), loops, sensitivity];
    let room = parts::room(ui);
    for (cell, chart) in parts::grid(room, 4, 2).iter().zip(charts) {
        parts::chart(ui, view, queue, *cell, &chart.grouped("verified over frequency"));
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
    } else if key.contains("triangle") {
        return Experiment::Triangle;
    } else {
        return Experiment::Step;
    };
    Experiment::Disturbance(source, Arrangement::Compensated)
}

fn name(experiment: Experiment) -> &'static str {
    match experiment {
        Experiment::Step => "Step of the demand",
        Experiment::Triangle => "Triangle of the demand",
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

fn hub_chart(view: &View, found: &Verification, experiment: Experiment) -> Chart {
    let title = format!("{}: hub rate", name(experiment));
    let label = format!("hub rate, {}", view.angular_rate_unit());
    let mut chart = Chart::new(&title, "time, s", &label).grouped("verified over time");
    let factor = view.angular();
    if let Experiment::Disturbance(source, _) = experiment
        && let Some(h) =
            found.history(Model::Nonlinear, Experiment::Disturbance(source, Arrangement::Feedback))
    {
        let points = series(h, |h| &h.hub_rate_rad_s, factor);
        chart = chart.curve("feedback alone", view.theme.curves[1].gamma_multiply(0.7), Dash::Solid, points);
    }
    for (model, label, colour, dash) in [
        (Model::Nonlinear, "full plant", view.theme.curves[0], Dash::Solid),
        (Model::Linear, "linear", view.theme.curves[2], Dash::Dashed),
    ] {
        if let Some(h) = found.history(model, experiment) {
            chart = chart.curve(label, colour, dash, series(h, |h| &h.hub_rate_rad_s, factor));
        }
    }
    chart
}

fn time_chart(
    view: &View,
    found: &Verification,
    experiment: Experiment,
    (what, unit, factor): (&str, &str, f64),
    column: fn(&History) -> &Vec<f64>,
) -> Chart {
    let chart = Chart::new(what, "time, s", &format!("{}, {unit}", what.to_lowercase()));
    let chart = chart.grouped("verified over time");
    match found.history(Model::Nonlinear, experiment) {
        Some(h) => chart.curve("full plant", view.theme.curves[0], Dash::Solid, series(h, column, factor)),
        None => chart,
    }
}

/// What is left of a disturbance over frequency, by how much of the controller acts.
fn rejection(view: &View, found: &Verification, source: Source) -> Chart {
    let (title, label) = if source == Source::Heave {
        ("Rejection of heave", "rad/s per m/s\u{b2}")
    } else {
        ("Rejection of pitch", "rad/s per rad/s")
    };
    let curves = &found.evidence.curves;
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
    limits::of_rejection(view, found, source, &mut chart);
    chart
}
