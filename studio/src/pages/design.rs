//! The page Design: weights with handles, and all their consequences at once.

use crate::tolerance::{LARGEST_TRIAL_KG_M, SMALLEST_TRIAL_KG_M};
use std::sync::Arc;

use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_pipeline::studies::trade_off::EffortPoint;
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis::WeightSource;
use counterpoise_synth::LightModes;
use counterpoise_synth::weight::handles::{WeightNumber, form_name, weight_numbers};
use counterpoise_verify::{Arrangement, Experiment, HistoryColumn, Source};
use egui::{RichText, Ui};

use super::design_charts::{
    control_chart, effort_chart, loop_chart, motion_chart, sensitivity_chart, step_chart,
};
use super::design_history::CurrentDesign;
use super::loop_charts::LoopCharts;
use super::plot_tiles::TileRequest;
use super::requirement_bounds::{BoundContext, BoundPlot, BoundedChart, ChartPlace, plot_bounds};
use super::requirement_values::{Requirements, ValueSources};
use super::weight_plot::{PlottedWeight, plotted_weights, show_weight_plot};
use super::{
    design_figures, design_history, loop_charts, no_controller, plot_tiles, requirement_strip, widgets,
};
use crate::command::{Command, DesignTab};
use crate::editing::key_reference::find_key;
use crate::editing::weight_text::design_sections;
use crate::number_format::format_short;
use crate::studio::Studio;
use crate::theme::space;
use crate::tile_layout::TilePlace;
use crate::versioned_results::{Freshness, VersionedResult};
use crate::view::{ControllerPart, StudioView};

/// Width of the panel with weights and figures, points.
const SIDE_WIDTH: f32 = 348.0;

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let Some(project) = opened.session.project().cloned() else {
        let errors: Vec<String> = opened.session.errors().iter().map(ToString::to_string).collect();
        let title = "The project file has errors";
        return widgets::show_error_list(ui, &studio.view.theme, title, &errors);
    };
    if project.synth.is_none() {
        return no_controller::show(ui, &studio.view.theme, queue, "design");
    }
    let why = studio.results.design_errors(revision).map(<[String]>::to_vec);
    let design = studio.results.design_at(revision).map(|(design, age)| (Arc::clone(design), age));
    let effort = studio.results.effort.clone();
    let shape = studio.results.loop_view.clone().filter(|shape| shape.revision == revision);
    let requirements =
        Requirements::new(&opened.session, &project, ValueSources::of_results(&studio.results, revision));
    let is_shown = studio.view.design_tab == DesignTab::History;
    let weights = if is_shown { design_sections(opened.session.text()) } else { String::new() };
    let view = &mut studio.view;
    let preview = design.as_ref().map(|(design, _)| Arc::clone(design));
    if let Some((design, _)) = &design {
        requirement_strip::show(ui, view, &requirements.values, design.synthesised.controlled);
    }
    widgets::side_panel("weights", &view.theme, SIDE_WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| show_side(ui, view, queue, &project, preview.as_ref()));
    });
    if let Some(why) = &why {
        let rest = if design.is_some() { "; the plots show the last design that succeeded" } else { "" };
        let title = format!("No controller for these weights{rest}");
        widgets::show_error_list(ui, &view.theme, &title, why);
    }
    show_tabs(ui, view, queue);
    if view.design_tab == DesignTab::History {
        // without a design, too: a kept one is the way back from weights that give none
        let (design, values) = (preview.as_deref(), requirements.values.as_slice());
        return design_history::show(ui, view, queue, &CurrentDesign { design, values, weights: &weights });
    }
    let Some((design, age)) = design else {
        if why.is_none() {
            let text = "the first design appears in a moment";
            widgets::show_placeholder(ui, &studio.view.theme, "Designing", text);
        }
        return;
    };
    if age == Freshness::Stale && why.is_some() {
        ui.multiply_opacity(0.55);
    }
    let (design, requirements) = (design.as_ref(), &requirements);
    if view.design_tab == DesignTab::Loop {
        let loop_view = shape.as_ref().map(|of| &of.value);
        return loop_charts::show(ui, view, queue, LoopCharts { design, loop_view, requirements });
    }
    let shown = ShownDesign { project: &project, design, requirements };
    show_plots(ui, view, queue, &shown, effort.as_ref());
}

fn show_tabs(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        for tab in DesignTab::ALL {
            if ui.selectable_label(view.design_tab == tab, tab.name()).clicked() {
                queue.push(Command::ShowDesign { tab });
            }
        }
        plot_tiles::show_menu(ui, view, queue);
    });
}

fn show_side(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    project: &Project,
    design: Option<&Arc<DesignPreview>>,
) {
    let theme = view.theme;
    ui.horizontal(|ui| {
        for (part, name) in [
            (ControllerPart::Feedback, "Feedback"),
            (ControllerPart::Heave, "Heave"),
            (ControllerPart::Pitch, "Pitch"),
        ] {
            if ui.selectable_label(view.part == part, name).clicked() {
                view.part = part;
            }
        }
    });
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        let weights = plotted_weights(project, view.part, &theme);
        if weights.is_empty() {
            let is_chosen = project.synth.as_ref().is_some_and(|synth| synth.weights == WeightSource::Chosen);
            let text = match view.part {
                ControllerPart::Feedback if is_chosen => {
                    "The weights are chosen for the highest bandwidth; `counterpoise synth --save` writes them into the file."
                }
                _ => "This project has no such part; add its section to the file.",
            };
            ui.label(RichText::new(text).color(theme.weak));
        }
        for weight in &weights {
            show_weight(ui, view, queue, weight);
        }
        if view.part == ControllerPart::Feedback && !weights.is_empty() {
            widgets::show_heading(ui, "noise");
            show_noise(ui, view, queue, project);
        }
    });
    ui.add_space(space::SMALL);
    if let Some(design) = design {
        show_trial(ui, view, queue, design);
        ui.add_space(space::SMALL);
        design_figures::show(ui, view, queue, design);
    }
}

fn show_weight(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, weight: &PlottedWeight) {
    let theme = view.theme;
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("{} weight", weight.name)).strong().color(weight.colour));
        ui.label(RichText::new(form_name(weight.weight)).small().color(theme.weak));
    });
    egui::Grid::new(&weight.path).num_columns(3).spacing([8.0, 2.0]).show(ui, |ui| {
        for WeightNumber { key, value } in weight_numbers(weight.weight) {
            widgets::number_field(ui, view, queue, &format!("{}.{key}", weight.path), value);
        }
    });
}

fn show_noise(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, project: &Project) {
    let Some(synth) = &project.synth else { return };
    let f = &synth.specification.feedback;
    egui::Grid::new("noises").num_columns(3).spacing([8.0, 2.0]).show(ui, |ui| {
        widgets::number_field(ui, view, queue, "synth.feedback.measurement_noise", f.measurement_noise);
        widgets::number_field(ui, view, queue, "synth.feedback.loop_recovery", f.loop_recovery);
        show_modes_choice(ui, view, queue, f.modes);
    });
}

/// Shows in which way the plant of the feedback has its lightly damped modes.
fn show_modes_choice(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, modes: LightModes) {
    const KEY: &str = "synth.feedback.modes";
    const NAMES: [(LightModes, &str); 2] = [(LightModes::Kept, "kept"), (LightModes::Stiffened, "stiffened")];
    let meaning = find_key(KEY).map_or_else(String::new, |key| format!("{}\n{KEY}", key.meaning));
    ui.label(RichText::new("modes").color(view.theme.weak)).on_hover_text(&meaning);
    let shown = NAMES.iter().find(|(choice, _)| *choice == modes).map_or("", |(_, name)| name);
    let combo = egui::ComboBox::from_id_salt(KEY).selected_text(shown).width(78.0);
    let response = combo.show_ui(ui, |ui| {
        for (choice, name) in NAMES {
            if ui.selectable_label(modes == choice, name).clicked() && modes != choice {
                queue.push(Command::SetText { path: KEY.to_owned(), value: name.to_owned() });
            }
        }
    });
    response.response.on_hover_text(meaning).widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "light modes in the plant of the feedback")
    });
    ui.end_row();
}

/// Shows the slider that tries another out-of-balance.
fn show_trial(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, design: &DesignPreview) {
    let theme = view.theme;
    let moment = design.modelled.plant.body().out_of_balance_kg_m;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            ui.label(RichText::new("Out-of-balance").strong());
            if design.trial_moment_kg_m.is_some() {
                ui.label(RichText::new("tried, not in the project").small().color(theme.warn));
                if ui.small_button("end").clicked() {
                    queue.push(Command::Try { out_of_balance_kg_m: None });
                }
            }
        });
        let mut tried = view.trial_moment_kg_m.unwrap_or(moment);
        ui.spacing_mut().slider_width = 168.0;
        let slider = egui::Slider::new(&mut tried, 0.0..=LARGEST_TRIAL_KG_M)
            .suffix(" kg m")
            .custom_formatter(|v, _| format_short(v));
        let hint = "the design at another first moment of mass: watch the heave feedforward";
        let response = ui.add(slider).on_hover_text(hint);
        let now = view.trial_moment_kg_m.unwrap_or(moment);
        if response.changed() && (tried - now).abs() > SMALLEST_TRIAL_KG_M {
            queue.push(Command::Try { out_of_balance_kg_m: Some(tried) });
        }
        view.dragging |= response.dragged();
    });
}

/// A design as the tab Consequences shows it.
struct ShownDesign<'a> {
    project: &'a Project,
    design: &'a DesignPreview,
    requirements: &'a Requirements,
}

fn show_plots(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    shown: &ShownDesign,
    effort: Option<&VersionedResult<Vec<EffortPoint>>>,
) {
    let draw = &mut |ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, tile: TileRequest| {
        if tile.key == "weights" {
            return Some(show_weight_plot(ui, view, queue, shown.project, tile.cell));
        }
        if tile.key == "effort" {
            let effort = effort_chart(view, effort);
            return Some(widgets::show_chart(ui, view, queue, tile.cell, &effort));
        }
        let chart = consequence_chart(view, shown, tile.key)?;
        let place = ChartPlace { cell: tile.cell, paths: &shown.requirements.paths };
        Some(chart.show(ui, view, queue, place))
    };
    plot_tiles::show(ui, view, queue, TilePlace::Consequences, draw);
}

/// Returns a consequence of a design with the limits that concern it, by the key of its tile.
fn consequence_chart(view: &StudioView, shown: &ShownDesign, key: &str) -> Option<BoundedChart> {
    let (design, values) = (shown.design, &shown.requirements.values);
    let motion = |source| Experiment::Disturbance(source, Arrangement::Compensated);
    let context = BoundContext {
        margins: &design.margins,
        step: Some(&design.step),
        control_origin_v: design.modelled.linear.equilibrium.control_v,
        controlled: design.synthesised.controlled,
        shown: &[],
    };
    let bounded = |chart, plot, shown: &[Experiment]| {
        BoundedChart::new(chart, plot_bounds(plot, view, values, &BoundContext { shown, ..context }))
    };
    let hub = BoundPlot::History(HistoryColumn::HubRate);
    let control = BoundPlot::History(HistoryColumn::Control);
    let runs = [Experiment::Step, motion(Source::Heave), motion(Source::Pitch)];
    Some(match key {
        "loop-gain" => bounded(loop_chart(view, design), BoundPlot::LoopGain, &[]),
        "sensitivity" => bounded(sensitivity_chart(view, design), BoundPlot::Sensitivity, &[]),
        "step" => bounded(step_chart(view, design), hub, &[Experiment::Step]),
        "control" => bounded(control_chart(view, design), control, &runs),
        "heave" => bounded(motion_chart(view, design, Source::Heave), hub, &[motion(Source::Heave)]),
        "pitch" => bounded(motion_chart(view, design, Source::Pitch), hub, &[motion(Source::Pitch)]),
        _ => return None,
    })
}
