//! The evidence of a verification as charts: time histories and responses over frequency.

use counterpoise_report::wording::capitalise_first;
use counterpoise_verify::linear_loop::Curves;
use counterpoise_verify::{
    Arrangement, Experiment, History, HistoryColumn, Model, Requirement, Source, Verification,
};
use egui::{Rect, Ui};

use super::design_charts::with_overlays;
use super::frequency_charts::{frequency_chart, magnitude_points, mark_margins};
use super::mechanism_chart::{MechanismDrawing, mechanism_chart};
use super::plot_tiles::{self, TileRequest};
use super::requirement_bounds::{BoundContext, BoundPlot, BoundedChart, ChartPlace, plot_bounds};
use super::requirement_values::Requirements;
use super::widgets;
use crate::charts::chart::{Chart, LineDash};
use crate::charts::chart_view::{ChartResponse, cursor_position};
use crate::command::Command;
use crate::tile_layout::TilePlace;
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

/// A verification with the requirements of the project as it stands.
#[derive(Clone, Copy)]
pub struct ShownVerification<'a> {
    /// The verification.
    pub found: &'a Verification,
    /// The requirements, whose limits are drawn.
    pub requirements: &'a Requirements,
    /// Elevation of the beam at which it was verified, rad.
    pub elevation_rad: f64,
}

impl ShownVerification<'_> {
    /// Returns a chart with the limits that concern it; `shown` are the runs that it shows.
    fn bound_chart(
        &self,
        view: &StudioView,
        chart: Chart,
        plot: BoundPlot,
        shown: &[Experiment],
    ) -> BoundedChart {
        let context = BoundContext {
            margins: &self.found.evidence.margins,
            step: self.found.history(Model::Linear, Experiment::Step),
            control_origin_v: 0.0,
            controlled: self.found.controlled_quantity(),
            shown,
        };
        BoundedChart::new(chart, plot_bounds(plot, view, &self.requirements.values, &context))
    }

    fn show_tile(
        &self,
        ui: &mut Ui,
        view: &mut StudioView,
        queue: &mut Vec<Command>,
        shown: TileChart,
    ) -> ChartResponse {
        let place = ChartPlace { cell: shown.cell, paths: &self.requirements.paths };
        shown.chart.show(ui, view, queue, place)
    }
}

/// A chart with its place.
struct TileChart {
    chart: BoundedChart,
    cell: Rect,
}

/// Shows the run behind the selected verdict: four of its signals under one cursor.
pub fn show_histories(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, of: ShownVerification) {
    show_time(ui, view, of);
    let draw = &mut |ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, tile: TileRequest| {
        if tile.key == MECHANISM_KEY {
            let chart = shown_mechanism(ui, view, of)?;
            return Some(widgets::show_chart(ui, view, queue, tile.cell, &chart));
        }
        let chart = signal_chart(view, of, tile.key)?;
        Some(of.show_tile(ui, view, queue, TileChart { chart, cell: tile.cell }))
    };
    plot_tiles::show(ui, view, queue, TilePlace::Histories, draw);
}

/// Key of the tile with the mechanism.
const MECHANISM_KEY: &str = "mechanism";

/// Returns the run behind the selected verdict on the full plant, or on the linear one if there is no other.
fn selected_run<'a>(view: &StudioView, found: &'a Verification) -> Option<&'a History> {
    let requirement = selected_requirement(view, found);
    let experiment = requirement.map_or(Experiment::Step, |r| Experiment::from_figure(r.figure));
    found.history(Model::Nonlinear, experiment).or_else(|| found.history(Model::Linear, experiment))
}

/// Shows the time at which the mechanism is drawn while the pointer is on no plot, and a button that lets it run.
fn show_time(ui: &mut Ui, view: &mut StudioView, of: ShownVerification) {
    let Some(run) = selected_run(view, of.found) else { return };
    let end = run.signals.column(HistoryColumn::Time).last().copied().unwrap_or(0.0);
    let motion = &mut view.motion;
    if motion.is_running {
        motion.time_s += f64::from(ui.input(|input| input.stable_dt));
        motion.is_running = motion.time_s < end;
        ui.ctx().request_repaint();
    }
    motion.time_s = motion.time_s.clamp(0.0, end);
    ui.horizontal(|ui| {
        let label = ui.label("time of the mechanism");
        let slider = egui::Slider::new(&mut motion.time_s, 0.0..=end).suffix(" s").fixed_decimals(2);
        ui.add(slider).labelled_by(label.id).on_hover_text("the pointer on a plot over time moves it, too");
        let name = if motion.is_running { "Pause" } else { "Run" };
        if ui.button(name).on_hover_text("at the pace of the run").clicked() {
            motion.is_running = !motion.is_running;
            if motion.time_s >= end {
                motion.time_s = 0.0;
            }
        }
    });
}

/// Returns the mechanism at the cursor of the plots over time, or at the time of the slider; `None` if there is no run.
fn shown_mechanism(ui: &Ui, view: &StudioView, of: ShownVerification) -> Option<Chart> {
    let run = selected_run(view, of.found)?;
    let time_s = cursor_position(ui, &Chart::new("", "", "").with_group(TIME_GROUP));
    let drawing = MechanismDrawing {
        run,
        time_s: time_s.unwrap_or(view.motion.time_s),
        elevation_rad: of.elevation_rad,
        is_slide: of.found.controlled_quantity().travel_unit() == "m",
    };
    Some(mechanism_chart(&view.theme, &drawing))
}

/// Returns a signal of the run behind the selected verdict, by the key of its tile.
fn signal_chart(view: &StudioView, of: ShownVerification, key: &str) -> Option<BoundedChart> {
    let found = of.found;
    let experiment =
        selected_requirement(view, found).map_or(Experiment::Step, |r| Experiment::from_figure(r.figure));
    let controlled = found.controlled_quantity();
    let signal = |name: &str, unit: &str, factor, column| {
        let chart = history_chart(view, found, experiment, &ShownSignal { name, unit, factor, column });
        of.bound_chart(view, chart, BoundPlot::History(column), &[experiment])
    };
    Some(match key {
        "hub" => {
            let hub = hub_chart(view, found, experiment);
            let runs = hub_runs(experiment);
            of.bound_chart(view, hub, BoundPlot::History(HistoryColumn::HubRate), &runs)
        }
        "control" => signal("Control", "V", 1.0, HistoryColumn::Control),
        "drive" => {
            let name = capitalise_first(controlled.drive_name());
            signal(&name, controlled.drive_unit(), 1.0, HistoryColumn::Current)
        }
        "tip" => {
            let (name, tip) =
                (capitalise_first(&controlled.tip_name()), view.units.display_unit(controlled.tip_unit()));
            signal(&name, &tip.name, tip.factor, HistoryColumn::TipRate)
        }
        _ => return None,
    })
}

/// Returns the runs that the chart of the hub shows.
fn hub_runs(experiment: Experiment) -> Vec<Experiment> {
    match experiment {
        Experiment::Disturbance(source, _) => {
            vec![experiment, Experiment::Disturbance(source, Arrangement::Feedback)]
        }
        _ => vec![experiment],
    }
}

/// Returns the selected requirement.
fn selected_requirement<'a>(view: &StudioView, found: &'a Verification) -> Option<&'a Requirement> {
    let last = found.verdicts.len().saturating_sub(1);
    found.verdicts.get(view.requirement.min(last)).map(|(requirement, _)| requirement)
}

/// Shows what the loop does over frequency.
pub fn show_responses(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, of: ShownVerification) {
    let draw = &mut |ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, tile: TileRequest| {
        let found = of.found;
        let (chart, plot) = match tile.key {
            "heave" => (rejection_chart(view, found, Source::Heave), BoundPlot::Rejection(Source::Heave)),
            "pitch" => (rejection_chart(view, found, Source::Pitch), BoundPlot::Rejection(Source::Pitch)),
            "loop-gain" => (verified_loop_chart(view, found), BoundPlot::LoopGain),
            "sensitivity" => (verified_sensitivity_chart(view, found), BoundPlot::Sensitivity),
            _ => return None,
        };
        let chart = of.bound_chart(view, chart.with_group(FREQUENCY_GROUP), plot, &[]);
        Some(of.show_tile(ui, view, queue, TileChart { chart, cell: tile.cell }))
    };
    plot_tiles::show(ui, view, queue, TilePlace::Rejection, draw);
}

fn verified_loop_chart(view: &StudioView, found: &Verification) -> Chart {
    let curves = &found.evidence.curves;
    let chart = with_overlays(view, frequency_chart(view, "Loop gain", "modulus"), |design| {
        magnitude_points(view, &design.curves.frequency_hz, &design.curves.broken)
    });
    let points = magnitude_points(view, &curves.frequency_hz, &curves.broken);
    let mut chart = chart.with_curve("L", view.theme.curves[0], LineDash::Solid, points);
    chart.levels.push(view.units.display_gain(1.0));
    mark_margins(view, &found.evidence.margins, &mut chart);
    chart.range[1] = Some((view.units.display_gain(1e-4), view.units.display_gain(1e4)));
    chart
}

fn verified_sensitivity_chart(view: &StudioView, found: &Verification) -> Chart {
    let curves = &found.evidence.curves;
    let mut chart = with_overlays(view, frequency_chart(view, "Sensitivity", "modulus"), |design| {
        magnitude_points(view, &design.curves.frequency_hz, &design.curves.sensitivities[0])
    });
    for (k, (one, name)) in curves.sensitivities.iter().zip(["S", "T"]).enumerate() {
        let dash = [LineDash::Solid, LineDash::Dashed][k % 2];
        let points = magnitude_points(view, &curves.frequency_hz, one);
        chart = chart.with_curve(name, view.theme.curves[k], dash, points);
    }
    chart.range[1] = Some((view.units.display_gain(1e-3), view.units.display_gain(4.0)));
    chart
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
    chart = with_runs(
        view,
        chart,
        experiment,
        &ShownSignal { name: "", unit: "", factor, column: HistoryColumn::HubRate },
    );
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
    let chart = with_runs(view, chart, experiment, shown);
    match found.history(Model::Nonlinear, experiment) {
        Some(h) => {
            let points = history_points(h, shown.column, shown.factor);
            chart.with_curve("full plant", view.theme.curves[0], LineDash::Solid, points)
        }
        None => chart,
    }
}

/// Adds the run of each design that is drawn over the current one, if it was made.
fn with_runs(view: &StudioView, mut chart: Chart, experiment: Experiment, shown: &ShownSignal<'_>) -> Chart {
    for overlaid in view.overlaid_designs() {
        let found = view.history.runs_of(&overlaid);
        let run = found.and_then(|found| found.history(Model::Nonlinear, experiment));
        if let Some(run) = run {
            let points = history_points(run, shown.column, shown.factor);
            chart = chart.with_curve(&overlaid.name.label(), overlaid.colour, LineDash::Dotted, points);
        }
    }
    chart
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
    let points = |curves: &Curves, response: &[counterpoise_linalg::C64]| {
        let point = |(f, h): (&f64, &counterpoise_linalg::C64)| {
            let rate = view.units.display_frequency(f * std::f64::consts::TAU);
            [rate, view.units.display_gain(h.norm())]
        };
        curves.frequency_hz.iter().zip(response).map(point).collect::<Vec<_>>()
    };
    let mut chart = with_overlays(view, frequency_chart(view, title, &label), |design| {
        let mut rejections = design.curves.rejection.iter();
        let whole =
            rejections.find(|one| one.source == source && one.arrangement == Arrangement::Compensated);
        whole.map_or_else(Vec::new, |one| points(&design.curves, &one.response))
    });
    for one in curves.rejection.iter().filter(|r| r.source == source) {
        let (name, k, dash) = match one.arrangement {
            Arrangement::Uncontrolled => ("none", 3, LineDash::Dotted),
            Arrangement::Feedback => ("feedback", 1, LineDash::Dashed),
            Arrangement::Compensated => ("with feedforward", 0, LineDash::Solid),
        };
        chart = chart.with_curve(name, view.theme.curves[k], dash, points(curves, &one.response));
    }
    chart
}
