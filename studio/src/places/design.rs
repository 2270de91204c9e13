//! Design: weights in the hand, consequences at once.

use std::sync::Arc;

use counterpoise_pipeline::studies::trade_off::EffortPoint;
use counterpoise_project::Project;
use counterpoise_synth::{FeedforwardWeights, Weight};
use counterpoise_verify::{Arrangement, Source};
use egui::{Color32, RichText, Ui};

use super::consequences::{
    control_chart, effort_chart, loop_chart, motion, motion_chart, sensitivity_chart, step_chart,
};
use super::{kept, parts};
use crate::chart::{Chart, Dash, Scale, Shown};
use crate::command::{Command, Slot};
use crate::knobs::{self, Knob};
use crate::live::Live;
use crate::results::{Age, Of};
use crate::studio::Studio;
use crate::theme::{Theme, space};
use crate::view::{GainUnit, Part, View};

/// A weight of the part that is shown.
struct Shape<'a> {
    path: String,
    name: &'static str,
    weight: &'a Weight,
    colour: Color32,
    dash: Dash,
}

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let Some(project) = opened.session.project().cloned() else {
        let errors: Vec<String> = opened.session.errors().iter().map(ToString::to_string).collect();
        return parts::reasons(ui, &studio.view.theme, "The project file has errors", &errors);
    };
    let why = studio.results.why_not(revision).map(<[String]>::to_vec);
    let design = studio.results.design(revision).map(|(live, age)| (Arc::clone(live), age));
    let effort = studio.results.effort.clone();
    let view = &mut studio.view;
    view.dragging = false;
    let live = design.as_ref().map(|(live, _)| Arc::clone(live));
    parts::side("weights", &view.theme, 326.0).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| side(ui, view, queue, &project, live.as_ref()));
    });
    if let Some(why) = &why {
        parts::reasons(
            ui,
            &view.theme,
            "No controller for these weights; the last good design stays below",
            why,
        );
    }
    let Some((live, age)) = design else {
        return parts::empty(ui, &studio.view.theme, "Designing", "the first design appears in a moment");
    };
    if age == Age::Stale && why.is_some() {
        ui.multiply_opacity(0.55);
    }
    plots(ui, view, queue, &project, (&live, effort.as_ref()));
}

fn shapes<'a>(project: &'a Project, part: Part, theme: &Theme) -> Vec<Shape<'a>> {
    let Some(synth) = &project.synth else { return Vec::new() };
    let s = &synth.specification;
    let shape = |section: &str, name, weight, k: usize| Shape {
        path: format!("synth.{section}.{name}"),
        name,
        weight,
        colour: theme.curves[k],
        dash: [Dash::Solid, Dash::Dashed, Dash::Dotted][k],
    };
    let forward = |section: &'static str, w: &'a Option<FeedforwardWeights>| match w {
        Some(w) => vec![
            shape(section, "error", &w.error, 0),
            shape(section, "control", &w.control, 1),
            shape(section, "generator", &w.generator, 2),
        ],
        None => Vec::new(),
    };
    match part {
        Part::Feedback => {
            vec![
                shape("feedback", "error", &s.feedback.error, 0),
                shape("feedback", "control", &s.feedback.control, 1),
            ]
        }
        Part::Heave => forward("heave", &s.heave),
        Part::Pitch => forward("pitch", &s.pitch),
    }
}

fn side(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, project: &Project, live: Option<&Arc<Live>>) {
    let theme = view.theme;
    ui.horizontal(|ui| {
        for (part, name) in [(Part::Feedback, "Feedback"), (Part::Heave, "Heave"), (Part::Pitch, "Pitch")] {
            if ui.selectable_label(view.part == part, name).clicked() {
                view.part = part;
            }
        }
    });
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        let all = shapes(project, view.part, &theme);
        if all.is_empty() {
            ui.label(
                RichText::new("This project has no such part; add its section to the file.")
                    .color(theme.weak),
            );
        }
        for shape in &all {
            weight(ui, view, queue, shape);
        }
        if view.part == Part::Feedback {
            parts::heading(ui, "noise");
            noises(ui, view, queue, project);
        }
    });
    ui.add_space(space::SMALL);
    if let Some(live) = live {
        balance(ui, view, queue, live);
        ui.add_space(space::SMALL);
        figures(ui, view, queue, live);
    }
}

fn weight(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, shape: &Shape) {
    let theme = view.theme;
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("{} weight", shape.name)).strong().color(shape.colour));
        ui.label(RichText::new(knobs::form(shape.weight)).small().color(theme.weak));
    });
    egui::Grid::new(&shape.path).num_columns(3).spacing([8.0, 2.0]).show(ui, |ui| {
        for (key, value) in knobs::numbers(shape.weight) {
            parts::number(ui, view, queue, &format!("{}.{key}", shape.path), value);
        }
    });
}

fn noises(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, project: &Project) {
    let Some(synth) = &project.synth else { return };
    let f = &synth.specification.feedback;
    egui::Grid::new("noises").num_columns(3).spacing([8.0, 2.0]).show(ui, |ui| {
        parts::number(ui, view, queue, "synth.feedback.measurement_noise", f.measurement_noise);
        parts::number(ui, view, queue, "synth.feedback.loop_recovery", f.loop_recovery);
    });
}

/// Smaller moves of the slider are none, kg m.
const SMALLEST_TRIAL_KG_M: f64 = 0.05;

/// The slider that tries another out-of-balance.
fn balance(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, live: &Live) {
    let theme = view.theme;
    let moment = live.modelled.plant.body().out_of_balance_kg_m;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            ui.label(RichText::new("Out-of-balance").strong());
            if live.tried_kg_m.is_some() {
                ui.label(RichText::new("tried, not in the project").small().color(theme.warn));
                if ui.small_button("end").clicked() {
                    queue.push(Command::Try { out_of_balance_kg_m: None });
                }
            }
        });
        let mut tried = view.tried_kg_m.unwrap_or(moment);
        ui.spacing_mut().slider_width = 168.0;
        let slider = egui::Slider::new(&mut tried, 0.0..=400.0)
            .suffix(" kg m")
            .custom_formatter(|v, _| parts::short(v));
        let response = ui
            .add(slider)
            .on_hover_text("the design at another first moment of mass: watch the heave feedforward");
        let now = view.tried_kg_m.unwrap_or(moment);
        if response.changed() && (tried - now).abs() > SMALLEST_TRIAL_KG_M {
            queue.push(Command::Try { out_of_balance_kg_m: Some(tried) });
        }
        view.dragging |= response.dragged();
    });
}

type Figure = (&'static str, &'static str, fn(&Live) -> f64);
/// In place of a unit: the figure is a rate in rad/s, shown in the unit that was chosen.
const RATE: &str = "rate";

const FIGURES: [Figure; 9] = [
    ("gain margin", "dB", |d| d.margins.gain_margin_db()),
    ("phase margin", "deg", |d| d.margins.phase_margin().map_or(f64::INFINITY, |p| p.deg)),
    ("max sensitivity", "", |d| d.margins.ms.value),
    ("delay margin", "ms", |d| 1e3 * d.margins.delay_s),
    ("crossover", "Hz", |d| {
        d.margins.phase.iter().map(|p| p.rate_rad_s).fold(0.0, f64::max) / std::f64::consts::TAU
    }),
    ("step overshoot", "%", overshoot),
    ("heave left", RATE, |d| peak(d, Source::Heave)),
    ("pitch left", RATE, |d| peak(d, Source::Pitch)),
    ("step control", "V", |d| swing(&d.step.control_v)),
];

fn overshoot(live: &Live) -> f64 {
    let demand = live.step.demand_rad_s.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let top = live.step.hub_rate_rad_s.iter().copied().fold(0.0, f64::max);
    (100.0 * (top / demand - 1.0)).max(0.0)
}

fn swing(control_v: &[f64]) -> f64 {
    let first = control_v.first().copied().unwrap_or_default();
    control_v.iter().map(|v| (v - first).abs()).fold(0.0, f64::max)
}

/// Largest hub rate in the second half of a motion with the whole controller, rad/s.
fn peak(live: &Live, source: Source) -> f64 {
    let hub = motion(live, source, Arrangement::Compensated).map_or(&[][..], |h| &h.hub_rate_rad_s[..]);
    hub.iter().skip(hub.len() / 2).map(|v| v.abs()).fold(0.0, f64::max)
}

/// The figures of the design, beside those that were kept.
fn figures(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, live: &Live) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        egui::Grid::new("figures").num_columns(5).min_col_width(28.0).spacing([9.0, 3.0]).show(ui, |ui| {
            ui.label("");
            ui.label(RichText::new("now").small().color(theme.weak));
            for slot in Slot::ALL {
                kept::keeper(ui, view, queue, slot);
            }
            ui.end_row();
            for (name, unit, of) in FIGURES {
                let is_rate = unit == RATE;
                let (unit, factor) =
                    if is_rate { (view.angular_rate_unit(), view.angular()) } else { (unit, 1.0) };
                let shown = |live: &Live| parts::short(factor * of(live));
                let label = if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") };
                ui.label(RichText::new(label).color(theme.weak));
                ui.label(RichText::new(shown(live)).strong());
                for slot in Slot::ALL {
                    let text = view.kept.get(slot.name()).map_or(String::new(), |kept| shown(kept));
                    ui.label(RichText::new(text).color(theme.weak));
                }
                ui.end_row();
            }
        });
    });
}

fn plots(
    ui: &mut Ui,
    view: &mut View,
    queue: &mut Vec<Command>,
    project: &Project,
    (live, effort): (&Live, Option<&Of<Vec<EffortPoint>>>),
) {
    let room = parts::room(ui);
    let cells = parts::mosaic(room);
    weights_plot(ui, view, queue, project, cells[0]);
    let charts = [
        loop_chart(view, live),
        sensitivity_chart(view, live),
        step_chart(view, live),
        control_chart(view, live),
        motion_chart(view, live, Source::Heave),
        motion_chart(view, live, Source::Pitch),
        effort_chart(view, effort),
    ];
    for (cell, chart) in cells[1..].iter().zip(&charts) {
        parts::chart(ui, view, queue, *cell, chart);
    }
}

/// An empty chart over frequency.
pub fn bode(view: &View, title: &str, label: &str) -> Chart {
    let unit = if view.gain == GainUnit::Decibel { ", dB" } else { "" };
    let mut chart = Chart::new(title, view.rate_label(), &format!("{label}{unit}"));
    chart.scales = [Scale::Log, if view.gain == GainUnit::Decibel { Scale::Linear } else { Scale::Log }];
    chart
}

/// Bounds of the weights' plot: frequencies in rad/s and moduli.
const WEIGHT_RATES: (f64, f64) = (0.1, 5000.0);

fn weights_plot(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, project: &Project, cell: egui::Rect) {
    let theme = view.theme;
    let all = shapes(project, view.part, &theme);
    let mut chart = bode(view, "Weights", "modulus");
    let (low, high) = WEIGHT_RATES;
    let rate = |k: usize| low * (high / low).powf(k as f64 / 240.0);
    for shape in &all {
        let point = |k| [view.rate(rate(k)), view.level(shape.weight.magnitude(rate(k)).clamp(1e-6, 1e8))];
        chart = chart.curve(shape.name, shape.colour, shape.dash, (0..=240).map(point).collect());
    }
    chart.range[0] = Some((view.rate(low), view.rate(high)));
    let shown = parts::chart(ui, view, queue, cell, &chart);
    for shape in &all {
        for (k, knob) in knobs::knobs(shape.weight).iter().enumerate() {
            handle(ui, view, queue, &Handle { shape, knob, index: k, chart: &chart, shown: &shown });
        }
    }
}

/// A handle on its plot.
struct Handle<'a> {
    shape: &'a Shape<'a>,
    knob: &'a Knob,
    index: usize,
    chart: &'a Chart,
    shown: &'a Shown,
}

impl Handle<'_> {
    /// Where the handle stands on the screen.
    fn position(&self, view: &View) -> egui::Pos2 {
        let x = self.chart.place(0, view.rate(self.knob.rate_rad_s));
        let y = self.chart.place(1, view.level(self.knob.magnitude));
        self.shown.transform.position_from_point(&egui_plot::PlotPoint::new(x, y))
    }

    /// The frequency (rad/s) and modulus at a place of the screen.
    fn value(&self, view: &View, at: egui::Pos2) -> (f64, f64) {
        let point = self.shown.transform.value_from_position(at);
        let plain =
            |axis: usize, v: f64| if self.chart.scales[axis] == Scale::Log { 10f64.powf(v) } else { v };
        (view.rad_s(plain(0, point.x)), view.modulus(plain(1, point.y)))
    }
}

/// Where a handle is dragged to: it stays under the pointer where it was taken.
fn held(ui: &Ui, response: &egui::Response, at: egui::Pos2) -> Option<egui::Pos2> {
    let id = response.id.with("grip");
    if response.drag_started() {
        let origin = ui.input(|i| i.pointer.press_origin()).unwrap_or(at);
        ui.data_mut(|d| d.insert_temp(id, at - origin));
    }
    let grip: egui::Vec2 = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    response.interact_pointer_pos().map(|pointer| pointer + grip)
}

/// Pixels that an arrow key moves a handle.
const NUDGE: f32 = 2.0;

fn handle(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, h: &Handle) {
    let theme = view.theme;
    let at = h.position(view);
    if !h.shown.transform.frame().expand(6.0).contains(at) {
        return;
    }
    let id = ui.scope_id().with((&h.shape.path, h.index));
    let response = ui
        .interact(
            egui::Rect::from_center_size(at, egui::Vec2::splat(22.0)),
            id,
            egui::Sense::click_and_drag(),
        )
        .on_hover_cursor(egui::CursorIcon::Move);
    let name = format!("{} weight: {}", h.shape.name, h.knob.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, name.clone()));
    let lit = response.hovered() || response.dragged() || response.has_focus();
    let radius = if lit { 7.0 } else { 5.5 };
    ui.painter().circle(at, radius, theme.card, egui::Stroke::new(2.5, h.shape.colour));
    if response.drag_started() {
        view.gesture += 1;
    }
    let moved = if response.dragged() { held(ui, &response, at) } else { nudged(ui, &response, at) };
    view.dragging |= response.dragged();
    if let Some(to) = moved {
        let (rate, magnitude) = h.value(view, to);
        for (key, value) in knobs::turned(h.shape.weight, h.knob, rate, magnitude) {
            let path = format!("{}.{key}", h.shape.path);
            queue.push(Command::Set { path, value, gesture: Some(view.gesture) });
        }
    }
    if lit {
        response.on_hover_text(name);
    }
}

/// Where the arrow keys bring a handle that has the focus.
fn nudged(ui: &Ui, response: &egui::Response, at: egui::Pos2) -> Option<egui::Pos2> {
    if !response.has_focus() {
        return None;
    }
    let keys = [
        (egui::Key::ArrowLeft, egui::vec2(-NUDGE, 0.0)),
        (egui::Key::ArrowRight, egui::vec2(NUDGE, 0.0)),
        (egui::Key::ArrowUp, egui::vec2(0.0, -NUDGE)),
        (egui::Key::ArrowDown, egui::vec2(0.0, NUDGE)),
    ];
    let step = ui.input(|i| {
        keys.iter().filter(|(k, _)| i.key_pressed(*k)).fold(egui::Vec2::ZERO, |sum, (_, v)| sum + *v)
    });
    (step != egui::Vec2::ZERO).then_some(at + step)
}
