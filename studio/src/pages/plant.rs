//! The page Plant: the mechanism drawn to scale, its parameters, its modes and its friction.

use counterpoise_models::{ControlledQuantity, Parameters};
use counterpoise_pipeline::check::RankedAssumptions;
use counterpoise_pipeline::preview::{DesignPreview, PlantPreview};
use counterpoise_pipeline::reduction_views::{FrictionPlace, ReductionComparison, steady_friction_at_hub};
use counterpoise_report::check::{describe_effect, describe_no_effect, has_effect};
use counterpoise_report::wording::learned::{LearnedFunctionText, describe_elements};
use egui::{Rect, RichText, Ui, vec2};

use super::frequency_charts::{frequency_chart, magnitude_points};
use super::{beam_drawing, number_groups, schematic, widgets};
use crate::charts::chart::{Chart, LineDash};
use crate::command::Command;
use crate::jobs::plant_pictures::BeamModes;
use crate::number_format::format_short;
use crate::studio::Studio;
use crate::theme::space;
use crate::view::StudioView;

/// Names and paths of the sections of the project file that are edited here.
const SECTIONS: [(&str, &str); 9] = [
    ("structure", "plant.lumped"),
    ("beam", "plant.beam"),
    ("gearbox", "plant.gearbox"),
    ("motor", "plant.motor"),
    ("amplifier", "plant.amplifier"),
    ("motor friction", "plant.friction.motor"),
    ("pivot friction", "plant.friction.pivot"),
    ("sensors", "plant.sensors"),
    ("interface", "plant.interface"),
];

/// Width of the panel with the parameters, points.
const SIDE_WIDTH: f32 = 312.0;
/// Share of the height that the mechanism has.
const MECHANISM_SHARE: f32 = 0.42;

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let text = opened.session.text().to_owned();
    let why = studio.results.plant_errors(revision).map(<[String]>::to_vec);
    let project = opened.session.project().cloned();
    let results = &studio.results;
    let plant = results.plant.as_ref().map(|of| of.value.clone());
    let design = results.design.as_ref().map(|of| std::sync::Arc::clone(&of.value));
    let (reduction, modes) = (results.reduction.clone(), results.beam_modes.clone());
    let ranking = results.ranking.as_ref().map(|of| of.value.clone());
    let comparison = reduction.as_ref().map(|picture| &picture.comparison);
    let view = &mut studio.view;
    widgets::side_panel("parameters", &view.theme, SIDE_WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            show_parameters(ui, view, queue, &text);
            ui.add_space(space::SMALL);
            if let Some(plant) = &plant {
                show_operating_point(ui, view, plant, comparison);
            }
            if let Some(ranking) = &ranking {
                ui.add_space(space::SMALL);
                show_assumptions(ui, view, ranking);
            }
        });
    });
    if let Some(why) = &why {
        let rest = if plant.is_some() { "; the page shows the last valid mechanism" } else { "" };
        let title = format!("The project file has errors{rest}");
        widgets::show_error_list(ui, &view.theme, &title, why);
    }
    let Some(project) = project else { return };
    let area = widgets::take_remaining_area(ui);
    let (top, below) = area.split_top_bottom_at_y(area.top() + MECHANISM_SHARE * area.height());
    show_mechanism(ui, view, &project.plant, modes.as_deref(), top);
    let below = below.with_min_y(below.min.y + space::MEDIUM);
    let mut charts = vec![friction_chart(view, &project.plant)];
    charts.extend(match (&design, comparison) {
        (Some(design), _) => Some(sampled_response_chart(view, design)),
        (None, Some(comparison)) => Some(response_chart(view, &project.plant, comparison)),
        (None, None) => None,
    });
    if let Some(plant) = &plant {
        let functions = describe_elements(&plant.learned);
        charts.extend(functions.iter().take(1).flat_map(|f| learned_charts(view, f)));
    }
    for (cell, chart) in widgets::grid_cells(below, 2, 2).iter().zip(&charts) {
        widgets::show_chart(ui, view, queue, *cell, chart);
    }
}

fn show_parameters(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, text: &str) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        let table = text.parse::<toml::Table>().unwrap_or_default();
        let sections: Vec<usize> =
            (0..SECTIONS.len()).filter(|k| number_groups::has_section(&table, SECTIONS[*k].1)).collect();
        if let Some(first) = sections.first().filter(|_| !sections.contains(&view.section)) {
            view.section = *first;
        }
        ui.horizontal_wrapped(|ui| {
            for k in &sections {
                if ui.selectable_label(view.section == *k, SECTIONS[*k].0).clicked() {
                    view.section = *k;
                }
            }
        });
        ui.separator();
        let section = SECTIONS[view.section.min(SECTIONS.len() - 1)].1;
        for group in number_groups::number_groups(&table, section) {
            if let Some(heading) = &group.heading {
                widgets::show_heading(ui, heading);
            }
            egui::Grid::new(&group.path).num_columns(3).spacing([8.0, 3.0]).show(ui, |ui| {
                for (key, value) in &group.numbers {
                    widgets::number_field(ui, view, queue, &format!("{}.{key}", group.path), *value);
                }
            });
        }
    });
}

/// Shows the operating point and the poles.
fn show_operating_point(
    ui: &mut Ui,
    view: &StudioView,
    plant: &PlantPreview,
    comparison: Option<&ReductionComparison>,
) {
    let weak = view.theme.weak;
    view.theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        widgets::show_heading(ui, "Operating point");
        let control_v = plant.modelled.linear.equilibrium.control_v;
        let moment = plant.modelled.plant.body().out_of_balance_kg_m;
        ui.label(format!("held by {} V", format_short(control_v)));
        ui.label(format!("out-of-balance {} kg m", format_short(moment)));
        widgets::show_heading(ui, "Poles");
        egui::Grid::new("plant poles").num_columns(2).spacing([24.0, 2.0]).show(ui, |ui| {
            ui.label(RichText::new(view.units.frequency_label()).small().color(weak));
            ui.label(RichText::new("damping").small().color(weak));
            ui.end_row();
            for pole in comparison.iter().flat_map(|c| &c.poles) {
                ui.label(format_short(view.units.display_frequency(pole.modulus_rad_s)));
                ui.label(format_short(pole.damping_ratio));
                ui.end_row();
            }
        });
    });
}

/// Shows what the file leaves open: what matters most first, with what it may cost the loop, then how many more there are.
fn show_assumptions(ui: &mut Ui, view: &StudioView, ranked: &RankedAssumptions) {
    if ranked.assumptions.is_empty() {
        return;
    }
    view.theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        widgets::show_heading(ui, "Assumed values: measure this next");
        for effect in ranked.effects.iter().filter(|effect| has_effect(effect)) {
            ui.label(RichText::new(describe_effect(effect)).small());
        }
        if let Some(line) = describe_no_effect(&ranked.effects) {
            ui.label(RichText::new(line).small().color(view.theme.weak));
        }
        let is_ranked = |key: &str| ranked.effects.iter().any(|effect| effect.key == key);
        for assumption in ranked.assumptions.iter().filter(|a| !is_ranked(&a.key)) {
            let text = format!("{} = {} {}", assumption.key, format_short(assumption.value), assumption.unit);
            ui.label(RichText::new(text.trim_end()).small().color(view.theme.weak))
                .on_hover_text(assumption.rule);
        }
    });
}

/// Number of modes that can be animated.
const MODES: usize = 3;

fn show_mechanism(
    ui: &mut Ui,
    view: &mut StudioView,
    plant: &Parameters,
    modes: Option<&BeamModes>,
    area: Rect,
) {
    let theme = view.theme;
    let mut inside = ui.new_child(egui::UiBuilder::new().max_rect(area));
    theme.card().show(&mut inside, |ui| {
        ui.set_min_size(area.size() - vec2(18.0, 18.0));
        ui.horizontal(|ui| {
            let title = if plant.beam.is_some() { "The mechanism, to scale" } else { "The mechanism" };
            ui.label(RichText::new(title).strong());
            ui.add_space(space::LARGE);
            let count = match (&plant.beam, &plant.lumped) {
                (Some(_), _) => MODES,
                (None, Some(_)) => 1,
                (None, None) => 0,
            };
            view.mode = view.mode.min(count);
            for k in 0..=count {
                let name = if k == 0 { "at rest".to_owned() } else { format!("mode {k}") };
                if count > 0 && ui.selectable_label(view.mode == k, name).clicked() {
                    view.mode = k;
                }
            }
        });
        let canvas = ui.available_rect_before_wrap();
        match (&plant.beam, &plant.lumped) {
            (Some(beam), _) => beam_drawing::draw_beam(ui, view, beam, modes, canvas),
            (None, Some(lumped)) => schematic::draw_chain(ui, view, plant, lumped, canvas),
            (None, None) => widgets::show_placeholder(
                ui,
                &theme,
                "A structure from matrices",
                "it has no shape to draw; its poles are in the panel on the left",
            ),
        }
    });
}

const RESPONSE_NAMES: [&str; 3] = ["per V", "per m/s\u{b2} of heave", "per rad/s of pitch"];
const RESPONSE_DASHES: [LineDash; 3] = [LineDash::Solid, LineDash::Dashed, LineDash::Dotted];

fn response_title(hub: ControlledQuantity) -> String {
    format!("Plant: {}", hub.name())
}

/// Returns the responses of the sampled plant as the controller sees it.
fn sampled_response_chart(view: &StudioView, design: &DesignPreview) -> Chart {
    let curves = &design.curves;
    let mut chart = frequency_chart(view, &response_title(design.synthesised.controlled), "modulus");
    for (k, (curve, name)) in curves.plant.iter().zip(RESPONSE_NAMES).enumerate() {
        let points = magnitude_points(view, &curves.frequency_hz, curve);
        chart = chart.with_curve(name, view.theme.curves[k], RESPONSE_DASHES[k], points);
    }
    chart
}

/// Returns the responses of the full plant of a project without a controller.
fn response_chart(view: &StudioView, plant: &Parameters, comparison: &ReductionComparison) -> Chart {
    let mut chart = frequency_chart(view, &response_title(plant.controlled_quantity().motion()), "modulus");
    let moduli = [&comparison.control_moduli, &comparison.heave_moduli, &comparison.pitch_moduli];
    for (k, (full, name)) in moduli.iter().zip(RESPONSE_NAMES).enumerate() {
        let point = |(w, v): (&f64, &f64)| [view.units.display_frequency(*w), view.units.display_gain(*v)];
        let points = comparison.frequencies_rad_s.iter().zip(&full[0]).map(point).collect();
        chart = chart.with_curve(name, view.theme.curves[k], RESPONSE_DASHES[k], points);
    }
    chart
}

/// Returns the curve of a free function with its band, and the recordings' coverage.
fn learned_charts(view: &StudioView, function: &LearnedFunctionText) -> [Chart; 2] {
    let along = format!("{}, {}", function.variable, function.variable_unit);
    let unit = if function.value_unit.is_empty() { "1" } else { function.value_unit };
    let of = |value: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        function.points.iter().enumerate().map(|(k, x)| [*x, value(k)]).collect()
    };
    let band = &function.band;
    let colour = view.theme.curves[0];
    let title = format!("Free function: {} at the {}", function.quantity, function.place);
    let curve = Chart::new(&title, &along, &format!("{}, {unit}", function.quantity))
        .with_curve("fitted", colour, LineDash::Solid, of(&|k| function.values[k]))
        .with_curve("95 % band", colour, LineDash::Dotted, of(&|k| band[k][0]))
        .with_curve("95 % band, upper", colour, LineDash::Dotted, of(&|k| band[k][1]));
    let share = |k: usize| function.coverage.get(k).copied().unwrap_or(0.0);
    let coverage = Chart::new("Coverage by the recordings", &along, "share of samples, 1").with_curve(
        "recorded",
        view.theme.curves[1],
        LineDash::Solid,
        of(&share),
    );
    [curve, coverage]
}

/// Returns steady friction over the hub rate, of the pivot and of the motor through the gear.
fn friction_chart(view: &StudioView, plant: &Parameters) -> Chart {
    let rate = plant.controlled_quantity().rate();
    let unit = view.units.display_unit(rate.unit());
    let label = format!("{}, {}", rate.name(), unit.name);
    let torque = format!("torque, {}", plant.axis.unit("N m"));
    let mut chart = Chart::new("Friction at the hub", &label, &torque);
    let places = [
        ("pivot", FrictionPlace::Pivot, LineDash::Solid),
        ("motor, through the gear", FrictionPlace::Motor, LineDash::Dashed),
    ];
    for (k, (name, place, dash)) in places.into_iter().enumerate() {
        let rates = (-200..=200).map(|j| f64::from(j) * 1e-3);
        let Some(points) = steady_friction_at_hub(plant, place, rates) else { continue };
        let points = points.into_iter().map(|[rate, torque]| [unit.factor * rate, torque]);
        chart = chart.with_curve(name, view.theme.curves[k], dash, points.collect());
    }
    chart
}
