//! Reduce: which order the design takes, by Hankel values and the response of the full plant beside the reduced one.

use std::sync::Arc;

use counterpoise_project::ReductionMethod;
use egui::{RichText, Ui};

use super::{design::bode, parts};
use crate::chart::{Chart, Dash, Scale};
use crate::command::Command;
use crate::live::Live;
use crate::portrait::Portrait;
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
    let portrait = studio.results.portrait.clone();
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
        side(ui, view, queue, (&live, portrait.as_deref()), asked.method);
    });
    if let Some(why) = &why {
        parts::reasons(ui, &view.theme, "This reduction has no design; the last good one stays below", why);
    }
    let Some(seen) = portrait else {
        return parts::empty(ui, &view.theme, "Looking at the plant", "Hankel values and responses follow");
    };
    if !seen.is_of(&live) {
        ui.multiply_opacity(0.55);
    }
    let room = parts::room(ui);
    let cells = parts::grid(room, 4, 2);
    let values = hankel(view, &live, &seen);
    let shown = parts::chart(ui, view, queue, cells[0], &values);
    if let (true, Some(at)) = (shown.response.clicked(), shown.response.interact_pointer_pos()) {
        let state = shown.transform.value_from_position(at).x.round();
        order(queue, asked.method, state.clamp(1.0, (live.reduced.order_before - 1).max(1) as f64) as usize);
    }
    let charts = [
        against(view, &seen, 0, "Control to hub rate"),
        error(view, &live, &seen),
        against(view, &seen, 1, "Heave to hub rate"),
    ];
    for (cell, chart) in cells[1..].iter().zip(&charts) {
        parts::chart(ui, view, queue, *cell, chart);
    }
}

/// Asks for an order; a method that has none gives way to balancing.
fn order(queue: &mut Vec<Command>, method: ReductionMethod, order: usize) {
    if !matches!(method, ReductionMethod::Balanced | ReductionMethod::Modal) {
        queue.push(Command::SetText { path: "reduce.method".to_owned(), value: "balanced".to_owned() });
    }
    queue.push(Command::SetWhole { path: "reduce.order".to_owned(), value: order as i64 });
}

fn side(
    ui: &mut Ui,
    view: &mut View,
    queue: &mut Vec<Command>,
    (live, seen): (&Live, Option<&Portrait>),
    chosen: ReductionMethod,
) {
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
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        orders(ui, view, queue, (live, chosen));
    });
    ui.add_space(space::SMALL);
    let Some(seen) = seen else { return };
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        modes(ui, view, queue, (seen, chosen));
    });
}

/// Orders to choose from, and what the present one costs.
fn orders(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, (live, chosen): (&Live, ReductionMethod)) {
    let theme = view.theme;
    let before = live.reduced.order_before;
    parts::heading(ui, "Order");
    let ordered = matches!(chosen, ReductionMethod::Balanced | ReductionMethod::Modal);
    ui.add_enabled_ui(ordered, |ui| {
        ui.horizontal_wrapped(|ui| {
            for order in 1..before {
                if ui.selectable_label(live.reduced.system.order() == order, order.to_string()).clicked() {
                    self::order(queue, chosen, order);
                }
            }
        });
    });
    ui.label(format!("{before} states, {} kept", live.reduced.system.order()));
    let figure = |ui: &mut Ui, name: &str, value: Option<String>| {
        ui.label(
            RichText::new(format!("{name}: {}", value.unwrap_or_else(|| "-".to_owned()))).color(theme.weak),
        );
    };
    figure(ui, "bound on the error", live.reduced.bound.map(parts::short));
    figure(ui, "largest error", live.reduced.error.map(|(e, w)| at(view, e, w)));
    live.reduced.warnings.iter().for_each(|w| {
        ui.label(RichText::new(w).small().color(theme.warn));
    });
}

/// An error with the frequency where it stands.
fn at(view: &View, error: f64, rate_rad_s: f64) -> String {
    let unit = view.rate_label().trim_start_matches("frequency, ");
    format!("{} at {} {unit}", parts::short(error), parts::short(view.rate(rate_rad_s)))
}

/// The poles of the full plant, slow ones first; a click keeps the states down to there.
fn modes(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, (seen, chosen): (&Portrait, ReductionMethod)) {
    parts::heading(ui, "Modes of the full plant");
    ui.label(RichText::new("a click keeps the states down to there").small().color(view.theme.weak));
    egui::Grid::new("poles").num_columns(3).spacing([20.0, 2.0]).show(ui, |ui| {
        for head in ["states", view.rate_label(), "damping"] {
            ui.label(RichText::new(head).small().color(view.theme.weak));
        }
        ui.end_row();
        let (mut states, [whole, kept]) = (0, seen.states);
        for pole in &seen.poles {
            states += if pole.im > 0.0 { 2 } else { 1 };
            let hint = format!("keep {states} of {whole} states");
            let label = ui.selectable_label(states <= kept, states.to_string()).on_hover_text(hint);
            if label.clicked() && states < whole {
                order(queue, chosen, states);
            }
            ui.label(parts::short(view.rate(pole.norm())));
            ui.label(parts::short(-pole.re / pole.norm().max(f64::MIN_POSITIVE)));
            ui.end_row();
        }
    });
}

fn hankel(view: &View, live: &Live, seen: &Portrait) -> Chart {
    let title = if seen.hankel.is_empty() {
        "Hankel values: none, the plant is not stable"
    } else {
        "Hankel values: click the order to keep"
    };
    let mut chart = Chart::new(title, "state", "value");
    chart.scales[1] = Scale::Log;
    let points: Vec<[f64; 2]> =
        seen.hankel.iter().enumerate().map(|(k, v)| [(k + 1) as f64, v.max(1e-16)]).collect();
    chart.spots = points.iter().map(|p| (*p, String::new())).collect();
    chart.range[0] = Some((0.5, points.len().max(1) as f64 + 0.5));
    chart = chart.curve("", view.theme.curves[0], Dash::Solid, points);
    chart.marks.push((live.reduced.system.order() as f64 + 0.5, "kept to here".to_owned()));
    chart
}

/// A curve over the portrait's frequencies as it is shown.
fn curve(view: &View, seen: &Portrait, values: &[f64]) -> Vec<[f64; 2]> {
    seen.rates.iter().zip(values).map(|(w, v)| [view.rate(*w), view.level(*v)]).collect()
}

fn against(view: &View, seen: &Portrait, input: usize, title: &str) -> Chart {
    let [full, small] = &seen.moduli[input];
    bode(view, title, "modulus")
        .curve("full", view.theme.curves[1], Dash::Dashed, curve(view, seen, full))
        .curve("reduced", view.theme.curves[0], Dash::Solid, curve(view, seen, small))
        .grouped("reduction")
}

fn error(view: &View, live: &Live, seen: &Portrait) -> Chart {
    let mut chart = bode(view, "Error, control to hub rate", "modulus");
    if let Some(bound) = live.reduced.bound.filter(|bound| *bound > 0.0) {
        chart.levels.push(view.level(bound));
    }
    chart
        .curve("error", view.theme.curves[3], Dash::Solid, curve(view, seen, &seen.error))
        .grouped("reduction")
}
