//! Plant: the mechanism drawn to scale, its parameters, its modes and its friction.

use std::sync::Arc;

use counterpoise_models::Parameters;
use counterpoise_models::friction::FrictionModel;
use counterpoise_models::parameters::{Beam, PointMass, SectionShape};
use counterpoise_models::plant::LinearPlant;
use egui::{Color32, Pos2, Rect, RichText, Stroke, Ui, pos2, vec2};

use super::{design::bode, fields, parts, schematic};
use crate::chart::{Chart, Dash};
use crate::command::Command;
use crate::live::Live;
use crate::portrait::{Portrait, Swinging};
use crate::studio::Studio;
use crate::theme::{Theme, space};
use crate::view::View;

/// Sections of the project file that are edited here.
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

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let revision = opened.session.revision();
    let text = opened.session.text().to_owned();
    let why = studio.results.why_not(revision).map(<[String]>::to_vec);
    let project = opened.session.project().cloned();
    let design = studio.results.design(revision).map(|(live, _)| Arc::clone(live));
    let (portrait, swinging) = (studio.results.portrait.clone(), studio.results.swinging.clone());
    let view = &mut studio.view;
    view.dragging = false;
    parts::side("parameters", &view.theme, 312.0).show(ui, |ui| {
        egui::ScrollArea::vertical()
            .show(ui, |ui| side(ui, view, queue, &text, (design.as_deref(), portrait.as_deref())));
    });
    if let Some(why) = &why {
        parts::reasons(
            ui,
            &view.theme,
            "The project cannot be used as it stands; the last good one stays below",
            why,
        );
    }
    let Some(project) = project else { return };
    let room = parts::room(ui);
    let (top, below) = room.split_top_bottom_at_y(room.top() + 0.42 * room.height());
    mechanism(ui, view, (&project.plant, swinging.as_deref()), top);
    let below = below.with_min_y(below.min.y + space::MEDIUM);
    let mut charts = vec![friction(view, &project.plant)];
    charts.extend(design.as_deref().map(|live| response(view, live)));
    for (cell, chart) in parts::grid(below, 2, 2).iter().zip(&charts) {
        parts::chart(ui, view, queue, *cell, chart);
    }
}

fn side(
    ui: &mut Ui,
    view: &mut View,
    queue: &mut Vec<Command>,
    text: &str,
    (live, portrait): (Option<&Live>, Option<&Portrait>),
) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        let table = text.parse::<toml::Table>().unwrap_or_default();
        let there: Vec<usize> = (0..SECTIONS.len()).filter(|k| fields::has(&table, SECTIONS[*k].1)).collect();
        ui.horizontal_wrapped(|ui| {
            for k in &there {
                if ui.selectable_label(view.section == *k, SECTIONS[*k].0).clicked() {
                    view.section = *k;
                }
            }
        });
        ui.separator();
        let section = SECTIONS[view.section.min(SECTIONS.len() - 1)].1;
        for group in fields::groups(&table, section) {
            if let Some(heading) = &group.heading {
                parts::heading(ui, heading);
            }
            egui::Grid::new(&group.path).num_columns(3).spacing([8.0, 3.0]).show(ui, |ui| {
                for (key, value) in &group.numbers {
                    parts::number(ui, view, queue, &format!("{}.{key}", group.path), *value);
                }
            });
        }
    });
    ui.add_space(space::SMALL);
    let Some(live) = live else { return };
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        point(ui, view, live, portrait);
    });
}

/// The operating point and the poles.
fn point(ui: &mut Ui, view: &View, live: &Live, portrait: Option<&Portrait>) {
    let weak = view.theme.weak;
    parts::heading(ui, "Operating point");
    let equilibrium = &live.modelled.linear.equilibrium;
    ui.label(format!("held by {} V", parts::short(equilibrium.control_v)));
    ui.label(format!("out-of-balance {} kg m", parts::short(live.modelled.plant.body().out_of_balance_kg_m)));
    parts::heading(ui, "Poles");
    egui::Grid::new("plant poles").num_columns(2).spacing([24.0, 2.0]).show(ui, |ui| {
        ui.label(RichText::new(view.rate_label()).small().color(weak));
        ui.label(RichText::new("damping").small().color(weak));
        ui.end_row();
        for pole in portrait.iter().flat_map(|p| &p.poles) {
            ui.label(parts::short(view.rate(pole.norm())));
            ui.label(parts::short(-pole.re / pole.norm().max(f64::MIN_POSITIVE)));
            ui.end_row();
        }
    });
}

/// Modes that can be shown.
const MODES: usize = 3;

fn mechanism(ui: &mut Ui, view: &mut View, (plant, swinging): (&Parameters, Option<&Swinging>), room: Rect) {
    let theme = view.theme;
    let mut inside = ui.new_child(egui::UiBuilder::new().max_rect(room));
    theme.card().show(&mut inside, |ui| {
        ui.set_min_size(room.size() - vec2(18.0, 18.0));
        ui.horizontal(|ui| {
            let title = if plant.beam.is_some() { "The mechanism, to scale" } else { "The mechanism" };
            ui.label(RichText::new(title).strong());
            ui.add_space(space::LARGE);
            let modes = if plant.beam.is_some() { MODES } else { 1 };
            view.mode = view.mode.min(modes);
            for k in 0..=modes {
                let name = if k == 0 { "at rest".to_owned() } else { format!("mode {k}") };
                if ui.selectable_label(view.mode == k, name).clicked() {
                    view.mode = k;
                }
            }
        });
        let canvas = ui.available_rect_before_wrap();
        match (&plant.beam, &plant.lumped) {
            (Some(beam), _) => drawing(ui, view, (beam, swinging), canvas),
            (None, Some(lumped)) => schematic::draw(ui, view, plant, lumped, canvas),
            (None, None) => parts::empty(
                ui,
                &theme,
                "A structure from matrices",
                "it has no shape to draw; its poles are beside",
            ),
        }
    });
}

/// Maps metres to the screen: x along the beam, y up.
struct Frame {
    left: f32,
    middle: f32,
    scale: f32,
    from_m: f64,
}

impl Frame {
    fn at(&self, x_m: f64, y_m: f64) -> Pos2 {
        pos2(self.left + self.scale * (x_m - self.from_m) as f32, self.middle - self.scale * y_m as f32)
    }
}

fn drawing(ui: &mut Ui, view: &View, (beam, swinging): (&Beam, Option<&Swinging>), canvas: Rect) {
    let (Some(first), Some(last)) = (beam.sections.first(), beam.sections.last()) else { return };
    let length = (last.to_m - first.from_m).max(1e-3);
    let scale = (0.92 * canvas.width() / length as f32).min(260.0);
    let left = canvas.center().x - 0.5 * scale * length as f32;
    let frame = Frame { left, middle: canvas.center().y - 4.0, scale, from_m: first.from_m };
    let shape = shape(ui, view, swinging);
    let theme = view.theme;
    for section in &beam.sections {
        outline(ui, &theme, &frame, section.from_m, section.to_m, half_heights(&section.shape), &shape);
    }
    for (k, mass) in beam.masses.iter().enumerate() {
        let near = |other: &&PointMass| (other.position_m - mass.position_m).abs() < 0.3;
        let below = beam.masses[..k].iter().filter(near).count() as f32;
        let at = frame.at(mass.position_m, shape(mass.position_m));
        let radius = (2.2 * mass.mass_kg.max(1.0).sqrt() as f32).clamp(4.0, 20.0);
        ui.painter().circle(
            at,
            radius,
            theme.curves[1].gamma_multiply(0.25),
            Stroke::new(1.5, theme.curves[1]),
        );
        text(
            ui,
            at + vec2(0.0, -32.0 - 14.0 * below),
            &format!("{}: {} kg", mass.name, parts::short(mass.mass_kg)),
            theme.weak,
        );
    }
    pivot(ui, &theme, frame.at(beam.pivot_m, 0.0), scale);
    ruler(ui, &theme, &frame, (first.from_m, last.to_m), canvas.bottom() - 18.0);
}

fn half_heights(shape: &SectionShape) -> [f64; 2] {
    match shape {
        SectionShape::Tube { outer_diameter_m, .. } => outer_diameter_m.map(|d| 0.5 * d),
        SectionShape::Rectangle { height_m, .. } => height_m.map(|h| 0.5 * h),
        SectionShape::Given { area_m2, .. } => area_m2.map(|a| 0.5 * a.max(0.0).sqrt()),
    }
}

fn outline(
    ui: &Ui,
    theme: &Theme,
    frame: &Frame,
    from: f64,
    to: f64,
    half: [f64; 2],
    shape: &dyn Fn(f64) -> f64,
) {
    const PIECES: usize = 12;
    let x = |k: usize| from + (to - from) * k as f64 / PIECES as f64;
    let thick = |k: usize| half[0] + (half[1] - half[0]) * k as f64 / PIECES as f64;
    for k in 0..PIECES {
        let corner = |j: usize, sign: f64| frame.at(x(j), shape(x(j)) + sign * thick(j));
        let quad = vec![corner(k, 1.0), corner(k + 1, 1.0), corner(k + 1, -1.0), corner(k, -1.0)];
        ui.painter().add(egui::Shape::convex_polygon(quad, theme.field, Stroke::NONE));
        for sign in [1.0, -1.0] {
            ui.painter().line_segment([corner(k, sign), corner(k + 1, sign)], Stroke::new(1.2, theme.text));
        }
    }
    for (k, sign) in [(0, 1.0), (PIECES, 1.0)] {
        let end = |s: f64| frame.at(x(k), shape(x(k)) + s * thick(k));
        ui.painter().line_segment([end(sign), end(-sign)], Stroke::new(1.0, theme.weak));
    }
}

/// The hub with its gear wheel, the pinion and the ground they stand on.
fn pivot(ui: &Ui, theme: &Theme, at: Pos2, scale: f32) {
    let painter = ui.painter();
    let wheel = (0.10 * scale).clamp(14.0, 34.0);
    painter.circle(at, wheel, Color32::TRANSPARENT, Stroke::new(1.5, theme.accent));
    painter.circle_filled(at, 4.0, theme.accent);
    let pinion = at + vec2(0.0, wheel + 8.0);
    painter.circle(pinion, 8.0, theme.card, Stroke::new(1.5, theme.accent));
    let foot = pinion + vec2(0.0, 14.0);
    painter.line_segment([foot - vec2(40.0, 0.0), foot + vec2(40.0, 0.0)], Stroke::new(1.5, theme.weak));
    for k in 0..8 {
        let from = foot + vec2(-40.0 + 10.0 * k as f32, 0.0);
        painter.line_segment([from + vec2(6.0, 0.0), from + vec2(0.0, 6.0)], Stroke::new(1.0, theme.weak));
    }
    text(ui, pinion + vec2(64.0, 0.0), "motor and gear", theme.weak);
}

fn ruler(ui: &Ui, theme: &Theme, frame: &Frame, (from, to): (f64, f64), y: f32) {
    let stroke = Stroke::new(1.0, theme.weak);
    ui.painter().line_segment([pos2(frame.at(from, 0.0).x, y), pos2(frame.at(to, 0.0).x, y)], stroke);
    let mut metre = from.ceil();
    while metre <= to {
        let x = frame.at(metre, 0.0).x;
        ui.painter().line_segment([pos2(x, y - 4.0), pos2(x, y)], stroke);
        text(ui, pos2(x, y + 9.0), &format!("{} m", metre as i64), theme.weak);
        metre += 1.0;
    }
}

fn text(ui: &Ui, at: Pos2, what: &str, colour: Color32) {
    ui.painter().text(at, egui::Align2::CENTER_CENTER, what, egui::FontId::proportional(11.0), colour);
}

/// Largest deflection of a mode that moves on the screen, as a share of the beam's length.
const SWING: f64 = 0.05;

/// Deflection of the beam in the chosen mode at this moment, m.
fn shape(ui: &Ui, view: &View, swinging: Option<&Swinging>) -> impl Fn(f64) -> f64 + use<> {
    let found = swinging.filter(|_| view.mode > 0).and_then(|s| s.modes.as_ref());
    let (mut nodes, mut size) = (Vec::new(), 0.0);
    if let Some((x, all)) = found
        && view.mode <= all.frequencies_rad_s.len().saturating_sub(all.rigid)
    {
        let phi = all.flexible_shape(view.mode - 1);
        nodes = x.iter().enumerate().map(|(k, x)| (*x, phi[2 * k])).collect();
        let largest = nodes.iter().map(|(_, w)| w.abs()).fold(f64::MIN_POSITIVE, f64::max);
        let length = nodes.last().map_or(1.0, |l| l.0) - nodes.first().map_or(0.0, |f| f.0);
        size = SWING * length / largest * (std::f64::consts::TAU * 0.7 * ui.input(|i| i.time)).sin();
        ui.ctx().request_repaint();
    }
    move |x| {
        let after = nodes.partition_point(|n| n.0 < x).min(nodes.len().saturating_sub(1));
        let (Some(b), Some(a)) = (nodes.get(after), nodes.get(after.saturating_sub(1))) else { return 0.0 };
        let share = if b.0 > a.0 { ((x - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { 0.0 };
        size * (a.1 + share * (b.1 - a.1))
    }
}

fn response(view: &View, live: &Live) -> Chart {
    let curves = &live.curves;
    let mut chart = bode(view, "Plant: hub rate", "modulus");
    for (k, (curve, name)) in
        curves.plant.iter().zip(["per V", "per m/s\u{b2} of heave", "per rad/s of pitch"]).enumerate()
    {
        let dash = [Dash::Solid, Dash::Dashed, Dash::Dotted][k];
        let rate = |f: f64| view.rate(f * std::f64::consts::TAU);
        let points =
            curves.frequency_hz.iter().zip(&curve.response).map(|(f, h)| [rate(*f), view.level(h.norm())]);
        chart = chart.curve(name, view.theme.curves[k], dash, points.collect());
    }
    debug_assert_eq!(LinearPlant::HUB_RATE, 0);
    chart
}

/// Steady friction over the rate, of the motor (brought to the hub) and of the pivot.
fn friction(view: &View, plant: &Parameters) -> Chart {
    let label = format!("hub rate, {}", view.angular_rate_unit());
    let mut chart = Chart::new("Friction at the hub", &label, "torque, N m");
    let ratio = plant.gearbox.ratio;
    let parts = [
        ("pivot", &plant.pivot_friction, 1.0, Dash::Solid),
        ("motor, through the gear", &plant.motor_friction, ratio, Dash::Dashed),
    ];
    for (k, (name, friction, n, dash)) in parts.into_iter().enumerate() {
        let Ok(model) = FrictionModel::new(friction) else { continue };
        let point = |j: i32| {
            let rate = f64::from(j) * 1e-3;
            [view.angular() * rate, n * model.steady(n * rate)]
        };
        chart = chart.curve(name, view.theme.curves[k], dash, (-200..=200).map(point).collect());
    }
    chart
}
