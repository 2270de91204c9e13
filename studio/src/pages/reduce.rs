//! The page Reduce: the order of the model for the design, by Hankel singular values and by the responses of both plants.

use crate::tolerance::SMALLEST_VALUE;
use counterpoise_pipeline::preview::PlantPreview;
use counterpoise_pipeline::reduction_views::ReductionComparison;
use counterpoise_project::ReductionMethod;
use counterpoise_report::wording::reduction::describe_reduction_warning;
use egui::{RichText, Ui};

use super::frequency_charts::frequency_chart;
use super::widgets;
use crate::charts::chart::{AxisScale, Chart, LabelledPoint, LineDash};
use crate::command::Command;
use crate::number_format::format_short;
use crate::studio::Studio;
use crate::theme::space;
use crate::view::StudioView;

/// Methods with their names in the project file and what they do.
const METHODS: [(&str, ReductionMethod, &str); 4] = [
    ("none", ReductionMethod::None, "the plant as it is"),
    ("minimal", ReductionMethod::Minimal, "removes states that are not controllable or not observable"),
    (
        "balanced",
        ReductionMethod::Balanced,
        "removes states of small Hankel singular value; the error has a bound",
    ),
    ("modal", ReductionMethod::Modal, "removes fast modes"),
];

/// Width of the panel with methods and orders, points.
const SIDE_WIDTH: f32 = 312.0;

/// A plant with its comparison, as the page shows it.
struct ShownReduction<'a> {
    plant: &'a PlantPreview,
    comparison: Option<&'a ReductionComparison>,
    method: ReductionMethod,
}

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let why = studio.results.plant_errors(revision).map(<[String]>::to_vec);
    let plant = studio.results.plant.as_ref().map(|of| of.value.clone());
    let method = opened.session.project().map(|p| p.reduce.method);
    let picture = studio.results.reduction.clone();
    let view = &mut studio.view;
    let (Some(plant), Some(method)) = (plant, method) else {
        if let Some(why) = &why {
            return widgets::show_error_list(ui, &view.theme, "The project file has errors", why);
        }
        let text = "its orders appear in a moment";
        return widgets::show_placeholder(ui, &view.theme, "Modelling the plant", text);
    };
    let comparison = picture.as_ref().map(|picture| &picture.comparison);
    let shown = ShownReduction { plant: &plant, comparison, method };
    widgets::side_panel("orders", &view.theme, SIDE_WIDTH).show(ui, |ui| show_side(ui, view, queue, &shown));
    if let Some(why) = &why {
        let title = "This reduction cannot be made; the page shows the last one that could";
        widgets::show_error_list(ui, &view.theme, title, why);
    }
    let Some(comparison) = comparison else {
        let text = "Hankel singular values and responses follow";
        return widgets::show_placeholder(ui, &view.theme, "Computing", text);
    };
    if picture.as_ref().is_some_and(|picture| !picture.belongs_to(&plant)) {
        ui.multiply_opacity(0.55);
    }
    show_charts(ui, view, queue, &shown, comparison);
}

fn show_charts(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    shown: &ShownReduction,
    comparison: &ReductionComparison,
) {
    let area = widgets::take_remaining_area(ui);
    let cells = widgets::grid_cells(area, 4, 2);
    let hankel = hankel_chart(view, shown.plant, comparison);
    let response = widgets::show_chart(ui, view, queue, cells[0], &hankel);
    if let (true, Some(at)) = (response.response.clicked(), response.response.interact_pointer_pos()) {
        let state = response.transform.value_from_position(at).x.round();
        let most = (shown.plant.reduced.order_before() - 1).max(1) as f64;
        choose_order(queue, shown.method, state.clamp(1.0, most) as usize);
    }
    let hub = hub_motion(shown.plant);
    let charts = [
        response_chart(view, comparison, &comparison.control_moduli, &format!("Control to {hub}")),
        error_chart(view, shown.plant, comparison),
        response_chart(view, comparison, &comparison.heave_moduli, &format!("Heave to {hub}")),
    ];
    for (cell, chart) in cells[1..].iter().zip(&charts) {
        widgets::show_chart(ui, view, queue, *cell, chart);
    }
}

/// Asks for an order; a method that has none is replaced by balanced truncation.
fn choose_order(queue: &mut Vec<Command>, method: ReductionMethod, order: usize) {
    if !matches!(method, ReductionMethod::Balanced | ReductionMethod::Modal) {
        queue.push(Command::SetText { path: "reduce.method".to_owned(), value: "balanced".to_owned() });
    }
    queue.push(Command::SetWhole { path: "reduce.order".to_owned(), value: order as i64 });
}

fn show_side(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, shown: &ShownReduction) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        widgets::show_heading(ui, "Method");
        for (name, method, meaning) in METHODS {
            if ui.selectable_label(shown.method == method, name).on_hover_text(meaning).clicked() {
                queue.push(Command::SetText { path: "reduce.method".to_owned(), value: name.to_owned() });
            }
        }
    });
    ui.add_space(space::SMALL);
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        show_orders(ui, view, queue, shown);
    });
    ui.add_space(space::SMALL);
    let Some(comparison) = shown.comparison else { return };
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        show_modes(ui, view, queue, comparison, shown.method);
    });
}

/// Shows the orders to choose from, and the error of the current one.
fn show_orders(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, shown: &ShownReduction) {
    let (theme, reduced) = (view.theme, &shown.plant.reduced);
    let before = reduced.order_before();
    widgets::show_heading(ui, "Order");
    let has_order = matches!(shown.method, ReductionMethod::Balanced | ReductionMethod::Modal);
    ui.add_enabled_ui(has_order, |ui| {
        ui.horizontal_wrapped(|ui| {
            for order in 1..before {
                if ui.selectable_label(reduced.system.order() == order, order.to_string()).clicked() {
                    choose_order(queue, shown.method, order);
                }
            }
        });
    });
    ui.label(format!("{before} states, {} kept", reduced.system.order()));
    let show_figure = |ui: &mut Ui, name: &str, value: Option<String>| {
        let text = format!("{name}: {}", value.unwrap_or_else(|| "-".to_owned()));
        ui.label(RichText::new(text).color(theme.weak));
    };
    show_figure(ui, "bound on the error", reduced.bound.map(format_short));
    show_figure(ui, "largest error", reduced.error.map(|(error, rate)| error_in_words(view, error, rate)));
    reduced.warnings.iter().for_each(|warning| {
        ui.label(RichText::new(describe_reduction_warning(warning)).small().color(theme.warn));
    });
}

/// Returns an error with the frequency at which it is largest, in words.
fn error_in_words(view: &StudioView, error: f64, rate_rad_s: f64) -> String {
    let unit = view.units.frequency_label().trim_start_matches("frequency, ");
    let frequency = format_short(view.units.display_frequency(rate_rad_s));
    format!("{} at {frequency} {unit}", format_short(error))
}

/// Shows the poles of the full plant, slow ones first; a click keeps the states up to this one.
fn show_modes(
    ui: &mut Ui,
    view: &StudioView,
    queue: &mut Vec<Command>,
    comparison: &ReductionComparison,
    method: ReductionMethod,
) {
    widgets::show_heading(ui, "Modes of the full plant");
    let hint = "a click keeps the states up to this one";
    ui.label(RichText::new(hint).small().color(view.theme.weak));
    egui::Grid::new("poles").num_columns(3).spacing([20.0, 2.0]).show(ui, |ui| {
        for head in ["states", view.units.frequency_label(), "damping"] {
            ui.label(RichText::new(head).small().color(view.theme.weak));
        }
        ui.end_row();
        let (mut states, [whole, kept]) = (0, comparison.states);
        for pole in &comparison.poles {
            states += pole.states;
            let hint = format!("keep {states} of {whole} states");
            let label = ui.selectable_label(states <= kept, states.to_string()).on_hover_text(hint);
            if label.clicked() && states < whole {
                choose_order(queue, method, states);
            }
            ui.label(format_short(view.units.display_frequency(pole.modulus_rad_s)));
            ui.label(format_short(pole.damping_ratio));
            ui.end_row();
        }
    });
}

fn hankel_chart(view: &StudioView, plant: &PlantPreview, comparison: &ReductionComparison) -> Chart {
    let title = if comparison.hankel.is_empty() {
        "Hankel values: none, the plant is not stable"
    } else {
        "Hankel values: click the order to keep"
    };
    let mut chart = Chart::new(title, "state", "value");
    chart.scales[1] = AxisScale::Log;
    let values = comparison.hankel.iter().enumerate();
    let points: Vec<[f64; 2]> = values.map(|(k, v)| [(k + 1) as f64, v.max(SMALLEST_VALUE)]).collect();
    chart.spots = points.iter().map(|p| LabelledPoint::new(*p, "")).collect();
    chart.range[0] = Some((0.5, points.len().max(1) as f64 + 0.5));
    chart = chart.with_curve("", view.theme.curves[0], LineDash::Solid, points);
    chart.add_mark(plant.reduced.system.order() as f64 + 0.5, "kept to here");
    chart
}

/// Returns a curve over the frequencies of the comparison as it is shown.
fn curve_points(view: &StudioView, comparison: &ReductionComparison, moduli: &[f64]) -> Vec<[f64; 2]> {
    let point = |(w, v): (&f64, &f64)| [view.units.display_frequency(*w), view.units.display_gain(*v)];
    comparison.frequencies_rad_s.iter().zip(moduli).map(point).collect()
}

fn response_chart(
    view: &StudioView,
    comparison: &ReductionComparison,
    [full, reduced]: &[Vec<f64>; 2],
    title: &str,
) -> Chart {
    frequency_chart(view, title, "modulus")
        .with_curve("full", view.theme.curves[1], LineDash::Dashed, curve_points(view, comparison, full))
        .with_curve("reduced", view.theme.curves[0], LineDash::Solid, curve_points(view, comparison, reduced))
        .with_group("reduction")
}

/// Returns what hub and tip of a plant move by, for example "hub rate".
fn hub_motion(plant: &PlantPreview) -> &'static str {
    plant.modelled.parameters.controlled_quantity().motion().name()
}

fn error_chart(view: &StudioView, plant: &PlantPreview, comparison: &ReductionComparison) -> Chart {
    let mut chart = frequency_chart(view, &format!("Error, control to {}", hub_motion(plant)), "modulus");
    if let Some(bound) = plant.reduced.bound.filter(|bound| *bound > 0.0) {
        chart.levels.push(view.units.display_gain(bound));
    }
    let points = curve_points(view, comparison, &comparison.error);
    chart.with_curve("error", view.theme.curves[3], LineDash::Solid, points).with_group("reduction")
}
