//! Reduce: which order the design takes, by Hankel values and the response of the full plant beside the reduced one.

use std::sync::Arc;

use counterpoise_project::ReductionMethod;
use counterpoise_project::lti::{StateSpace, hankel_values, poles, response};
use counterpoise_project::models::plant::LinearPlant;
use egui::{RichText, Ui};

use super::{design::bode, parts};
use crate::chart::{Chart, Dash, Scale};
use crate::command::Command;
use crate::live::Live;
use crate::studio::Studio;
use crate::theme::space;
use crate::view::View;

const METHODS: [(&str, ReductionMethod, &str); 4] = [
    ("none", ReductionMethod::None, "the plant as it is"),
    ("minimal", ReductionMethod::Minimal, "states that are neither controllable nor observable go"),
    ("balanced", ReductionMethod::Balanced, "states of small Hankel value go; the error has a bound"),
    ("modal", ReductionMethod::Modal, "fast modes go"),
];

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let why = studio.results.why_not(revision).map(<[String]>::to_vec);
    let design = studio.results.design(revision).map(|(live, _)| Arc::clone(live));
    let asked = opened.session.project().map(|p| p.reduce);
    let view = &mut studio.view;
    let (Some(live), Some(asked)) = (design, asked) else {
        return parts::empty(
            ui,
            &view.theme,
            "No plant yet",
            "the project file must be free of errors first",
        );
    };
    parts::side("orders", &view.theme, 312.0).show(ui, |ui| {
        side(ui, view, queue, &live, asked.method);
    });
    if let Some(why) = &why {
        parts::reasons(ui, &view.theme, "This reduction has no design; the last good one stays below", why);
    }
    let room = parts::room(ui);
    let cells = parts::grid(room, 4, 2);
    let charts = [
        hankel(view, &live),
        against(view, &live, LinearPlant::CONTROL, "Control to hub rate"),
        error(view, &live),
        against(view, &live, LinearPlant::HEAVE, "Heave to hub rate"),
    ];
    for (cell, chart) in cells.iter().zip(&charts) {
        parts::chart(ui, view, queue, *cell, chart);
    }
}

fn side(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, live: &Live, chosen: ReductionMethod) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        parts::heading(ui, "Method");
        for (name, method, meaning) in METHODS {
            if ui.selectable_label(chosen == method, name).on_hover_text(meaning).clicked() {
                queue.push(Command::SetText { path: "reduce.method".to_owned(), value: name.to_owned() });
            }
        }
    });
    ui.add_space(space::SMALL);
    let before = live.reduced.order_before;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        parts::heading(ui, "Order");
        let ordered = matches!(chosen, ReductionMethod::Balanced | ReductionMethod::Modal);
        ui.add_enabled_ui(ordered, |ui| {
            ui.horizontal_wrapped(|ui| {
                for order in 1..before {
                    if ui.selectable_label(live.reduced.system.order() == order, order.to_string()).clicked()
                    {
                        queue
                            .push(Command::SetWhole { path: "reduce.order".to_owned(), value: order as i64 });
                    }
                }
            });
        });
        ui.label(format!("{before} states, {} kept", live.reduced.system.order()));
        let figure = |ui: &mut Ui, name: &str, value: Option<String>| {
            ui.label(
                RichText::new(format!("{name}: {}", value.unwrap_or_else(|| "-".to_owned())))
                    .color(theme.weak),
            );
        };
        figure(ui, "bound on the error", live.reduced.bound.map(parts::short));
        figure(
            ui,
            "largest error",
            live.reduced.error.map(|(e, w)| format!("{} at {} rad/s", parts::short(e), parts::short(w))),
        );
        live.reduced.warnings.iter().for_each(|w| {
            ui.label(RichText::new(w).small().color(theme.warn));
        });
    });
    ui.add_space(space::SMALL);
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        modes(ui, view, &live.modelled.linear.system);
    });
}

/// The poles of the full plant, slow ones first.
fn modes(ui: &mut Ui, view: &View, plant: &StateSpace) {
    parts::heading(ui, "Poles of the full plant");
    let mut all = poles(plant).unwrap_or_default();
    all.retain(|p| p.im >= 0.0);
    all.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    egui::Grid::new("poles").num_columns(2).spacing([24.0, 2.0]).show(ui, |ui| {
        ui.label(RichText::new(view.rate_label()).small().color(view.theme.weak));
        ui.label(RichText::new("damping").small().color(view.theme.weak));
        ui.end_row();
        for pole in all {
            ui.label(parts::short(view.rate(pole.norm())));
            ui.label(parts::short(-pole.re / pole.norm().max(f64::MIN_POSITIVE)));
            ui.end_row();
        }
    });
}

fn hankel(view: &View, live: &Live) -> Chart {
    let mut chart = Chart::new("Hankel values", "state", "value");
    chart.scales[1] = Scale::Log;
    let values = hankel_values(&live.modelled.linear.system).unwrap_or_default();
    let points = values.iter().enumerate().map(|(k, v)| [(k + 1) as f64, v.max(1e-16)]).collect();
    chart = chart.curve("", view.theme.curves[0], Dash::Solid, points);
    chart.marks.push((live.reduced.system.order() as f64 + 0.5, "kept to here".to_owned()));
    chart
}

const POINTS: usize = 300;

fn rates() -> impl Iterator<Item = f64> {
    (0..POINTS).map(|k| 0.06 * (1e5_f64).powf(k as f64 / (POINTS - 1) as f64))
}

fn curve(view: &View, of: impl Fn(f64) -> Option<f64>) -> Vec<[f64; 2]> {
    rates().filter_map(|w| Some([view.rate(w), view.level(of(w)?)])).collect()
}

fn modulus(system: &StateSpace, input: usize) -> impl Fn(f64) -> Option<f64> {
    move |w| response::response_at(system, w).ok().map(|h| h[(LinearPlant::HUB_RATE, input)].norm())
}

fn against(view: &View, live: &Live, input: usize, title: &str) -> Chart {
    let (full, small) = (&live.modelled.linear.system, &live.reduced.system);
    bode(view, title, "modulus")
        .curve("full", view.theme.curves[1], Dash::Dashed, curve(view, modulus(full, input)))
        .curve("reduced", view.theme.curves[0], Dash::Solid, curve(view, modulus(small, input)))
}

fn error(view: &View, live: &Live) -> Chart {
    let (full, small) = (&live.modelled.linear.system, &live.reduced.system);
    let difference = |w: f64| {
        let (a, b) = (response::response_at(full, w).ok()?, response::response_at(small, w).ok()?);
        let (row, column) = (LinearPlant::HUB_RATE, LinearPlant::CONTROL);
        Some((a[(row, column)] - b[(row, column)]).norm().max(1e-16))
    };
    let mut chart = bode(view, "Error, control to hub rate", "modulus");
    if let Some(bound) = live.reduced.bound.filter(|bound| *bound > 0.0) {
        chart.levels.push(view.level(bound));
    }
    chart.curve("error", view.theme.curves[3], Dash::Solid, curve(view, difference))
}
