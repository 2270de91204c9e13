//! The evidence of a verification as charts: time histories and responses over frequency.

use counterpoise_report::wording::capitalise_first;
use counterpoise_verify::{Arrangement, Experiment, History, HistoryColumn, Model, Source, Verification};
use egui::Ui;

use super::frequency_charts::{frequency_chart, magnitude_points, mark_margins};
use super::limit_marks;
use super::widgets;
use crate::charts::chart::{Chart, LineDash};
use crate::command::Command;
use crate::view::StudioView;

/// The charts over time share their x axis and cursor.
const TIME_GROUP: &str = "verified over time";
/// The charts over frequency share theirs.
const FREQUENCY_GROUP: &str = "verified over frequency";

/// A signal of a history as it is shown.
struct ShownSignal<'a> {
    name: &'a str,
    unit: &'a str,
    factor: f64,
    column: HistoryColumn,
}

/// Shows the run behind the selected verdict: four of its signals under one cursor.
pub fn show_histories(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, found: &Verification) {
    let experiment = limit_marks::selected_requirement(view, found)
        .map_or(Experiment::Step, |requirement| Experiment::from_figure(requirement.figure));
    let tip = view.units.display_unit(found.controlled_quantity().tip_unit());
    let tip_name = capitalise_first(&found.controlled_quantity().tip_name());
    let controlled = found.controlled_quantity();
    let drive_name = capitalise_first(controlled.drive_name());
    let shown = |name, unit, factor, column| ShownSignal { name, unit, factor, column };
    let mut charts = [
        hub_chart(view, found, experiment),
        history_chart(view, found, experiment, &shown("Control", "V", 1.0, HistoryColumn::Control)),
        history_chart(
            view,
            found,
            experiment,
            &shown(&drive_name, controlled.drive_unit(), 1.0, HistoryColumn::Current),
        ),
        history_chart(
            view,
            found,
            experiment,
            &shown(&tip_name, &tip.name, tip.factor, HistoryColumn::TipRate),
        ),
    ];
    let columns =
        [HistoryColumn::HubRate, HistoryColumn::Control, HistoryColumn::Current, HistoryColumn::TipRate];
    for (chart, column) in charts.iter_mut().zip(columns) {
        limit_marks::mark_history_limit(view, found, column, chart);
    }
    let area = widgets::take_remaining_area(ui);
    for (cell, chart) in widgets::grid_cells(area, 4, 2).iter().zip(&charts) {
        widgets::show_chart(ui, view, queue, *cell, chart);
    }
}

/// Shows what the loop does over frequency.
pub fn show_responses(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, found: &Verification) {
    let curves = &found.evidence.curves;
    let of = |response| magnitude_points(view, &curves.frequency_hz, response);
    let c = view.theme.curves;
    let mut loop_gain = frequency_chart(view, "Loop gain", "modulus").with_curve(
        "L",
        c[0],
        LineDash::Solid,
        of(&curves.broken),
    );
    loop_gain.levels.push(view.units.display_gain(1.0));
    mark_margins(view, &found.evidence.margins, &mut loop_gain);
    loop_gain.range[1] = Some((view.units.display_gain(1e-4), view.units.display_gain(1e4)));
    let mut sensitivity = frequency_chart(view, "Sensitivity", "modulus");
    for (k, (one, name)) in curves.sensitivities.iter().zip(["S", "T"]).enumerate() {
        sensitivity = sensitivity.with_curve(name, c[k], [LineDash::Solid, LineDash::Dashed][k % 2], of(one));
    }
    limit_marks::mark_sensitivity_limit(view, found, &mut sensitivity);
    sensitivity.range[1] = Some((view.units.display_gain(1e-3), view.units.display_gain(4.0)));
    let charts = [
        rejection_chart(view, found, Source::Heave),
        rejection_chart(view, found, Source::Pitch),
        loop_gain,
        sensitivity,
    ];
    let area = widgets::take_remaining_area(ui);
    for (cell, chart) in widgets::grid_cells(area, 4, 2).iter().zip(charts) {
        widgets::show_chart(ui, view, queue, *cell, &chart.with_group(FREQUENCY_GROUP));
    }
}

fn experiment_name(experiment: Experiment) -> &'static str {
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

fn history_points(history: &History, column: HistoryColumn, factor: f64) -> Vec<[f64; 2]> {
    history.time_s().iter().zip(history.signals.column(column)).map(|(t, v)| [*t, factor * v]).collect()
}

fn hub_chart(view: &StudioView, found: &Verification, experiment: Experiment) -> Chart {
    let controlled = found.controlled_quantity();
    let unit = view.units.display_unit(controlled.unit());
    let title = format!("{}: {}", experiment_name(experiment), controlled.name());
    let label = format!("{}, {}", controlled.name(), unit.name);
    let mut chart = Chart::new(&title, "time, s", &label).with_group(TIME_GROUP);
    let factor = unit.factor;
    if let Experiment::Disturbance(source, _) = experiment
        && let Some(h) =
            found.history(Model::Nonlinear, Experiment::Disturbance(source, Arrangement::Feedback))
    {
        let points = history_points(h, HistoryColumn::HubRate, factor);
        let colour = view.theme.curves[1].gamma_multiply(0.7);
        chart = chart.with_curve("feedback alone", colour, LineDash::Solid, points);
    }
    for (model, label, colour, dash) in [
        (Model::Nonlinear, "full plant", view.theme.curves[0], LineDash::Solid),
        (Model::Linear, "linear", view.theme.curves[2], LineDash::Dashed),
    ] {
        if let Some(h) = found.history(model, experiment) {
            chart = chart.with_curve(label, colour, dash, history_points(h, HistoryColumn::HubRate, factor));
        }
    }
    chart
}

fn history_chart(
    view: &StudioView,
    found: &Verification,
    experiment: Experiment,
    shown: &ShownSignal<'_>,
) -> Chart {
    let label = format!("{}, {}", shown.name.to_lowercase(), shown.unit);
    let chart = Chart::new(shown.name, "time, s", &label).with_group(TIME_GROUP);
    match found.history(Model::Nonlinear, experiment) {
        Some(h) => {
            let points = history_points(h, shown.column, shown.factor);
            chart.with_curve("full plant", view.theme.curves[0], LineDash::Solid, points)
        }
        None => chart,
    }
}

/// Returns the disturbance rejection over frequency, for each arrangement of the controller.
fn rejection_chart(view: &StudioView, found: &Verification, source: Source) -> Chart {
    let unit = found.controlled_quantity().unit();
    let (title, label) = if source == Source::Heave {
        ("Rejection of heave", format!("{unit} per m/s\u{b2}"))
    } else {
        ("Rejection of pitch", format!("{unit} per rad/s"))
    };
    let curves = &found.evidence.curves;
    let mut chart = frequency_chart(view, title, &label);
    for one in curves.rejection.iter().filter(|r| r.source == source) {
        let (name, k, dash) = match one.arrangement {
            Arrangement::Uncontrolled => ("none", 3, LineDash::Dotted),
            Arrangement::Feedback => ("feedback", 1, LineDash::Dashed),
            Arrangement::Compensated => ("with feedforward", 0, LineDash::Solid),
        };
        let point = |(f, h): (&f64, &counterpoise_linalg::C64)| {
            let rate = view.units.display_frequency(f * std::f64::consts::TAU);
            [rate, view.units.display_gain(h.norm())]
        };
        let points = curves.frequency_hz.iter().zip(&one.response).map(point).collect();
        chart = chart.with_curve(name, view.theme.curves[k], dash, points);
    }
    limit_marks::mark_rejection_limit(view, found, source, &mut chart);
    chart
}
