//! A mechanism of two inertias as a chain: amplifier, motor, gear, hub, spring, beam with its out-of-balance.

use counterpoise_models::Parameters;
use counterpoise_models::parameters::LumpedStructure;
use egui::{Align2, FontId, Pos2, Rect, Stroke, Ui, pos2, vec2};

use crate::number_format::format_short;
use crate::theme::WindowTheme;
use crate::view::StudioView;

/// Angle through which the lighter side swings on the screen, rad: clearly visible.
const SWING: f64 = 0.35;

/// Radius of the pinion over the beam's.
const PINION: f32 = 0.26;
/// Radius of the wheel over the beam's.
const WHEEL: f32 = 0.62;

/// Angles of motor, hub and beam at a moment, rad.
type Angles = [f64; 3];

/// Draws the chain; in a mode, hub and beam swing against each other as they would with a rigid gear mesh.
pub fn draw_chain(ui: &Ui, view: &StudioView, plant: &Parameters, lumped: &LumpedStructure, room: Rect) {
    let theme = &view.theme;
    let angles = if view.mode > 0 { mode_angles(ui, plant, lumped) } else { [0.0; 3] };
    let unit = (room.height() * 0.21).clamp(26.0, 58.0);
    let (pinion, wheel) = (PINION * unit, WHEEL * unit);
    let low = room.center().y - 14.0;
    let at = |share: f32, y: f32| pos2(room.left() + share * room.width(), y);
    let [amplifier, motor, gear] = [0.09, 0.27, 0.45].map(|share| at(share, low - pinion - wheel));
    let [slow, hub, beam] = [0.45, 0.63, 0.85].map(|share| at(share, low));
    for (from, to) in [(amplifier, motor), (motor, gear), (slow, hub)] {
        ui.painter().line_segment([from, to], Stroke::new(2.0, theme.line));
    }
    draw_spring(ui, theme, hub + vec2(unit, 0.0), beam - vec2(unit, 0.0));
    let body = Rect::from_center_size(amplifier, vec2(1.5 * unit, 1.1 * unit));
    ui.painter().rect(body, 4.0, theme.field, Stroke::new(1.5, theme.accent), egui::StrokeKind::Middle);
    draw_disc(ui, theme, Disc { centre: motor, radius: 0.55 * unit }, angles[0]);
    for (centre, radius) in [(gear, pinion), (slow, wheel)] {
        ui.painter().circle(centre, radius, theme.card, Stroke::new(1.5, theme.accent));
        ui.painter().circle_filled(centre, 3.0, theme.accent);
    }
    draw_disc(ui, theme, Disc { centre: hub, radius: 0.9 * unit }, angles[1]);
    let load = Disc { centre: beam, radius: unit };
    draw_disc(ui, theme, load, angles[2]);
    draw_weight(ui, theme, load, angles[2], lumped.out_of_balance_kg_m);
    write_captions(ui, view, plant, lumped, [amplifier, motor, slow, hub, beam], low + 1.35 * unit);
}

/// Returns the angles of hub (with the motor behind the gear) and beam, which swing against each other.
fn mode_angles(ui: &Ui, plant: &Parameters, lumped: &LumpedStructure) -> Angles {
    let ratio = plant.gearbox.ratio;
    let near = lumped.hub_inertia_kg_m2 + ratio * ratio * plant.motor.inertia_kg_m2;
    let far = lumped.beam_inertia_kg_m2;
    let moment = (std::f64::consts::TAU * 0.7 * ui.input(|i| i.time)).sin();
    let largest = near.max(far).max(f64::MIN_POSITIVE);
    ui.ctx().request_repaint();
    let hub = SWING * moment * far / largest;
    [-hub * ratio, hub, -SWING * moment * near / largest]
}

/// A round body in the drawing.
#[derive(Clone, Copy)]
struct Disc {
    centre: Pos2,
    radius: f32,
}

fn draw_disc(ui: &Ui, theme: &WindowTheme, Disc { centre, radius }: Disc, angle: f64) {
    ui.painter().circle(centre, radius, theme.field, Stroke::new(1.5, theme.text));
    let spoke = vec2(angle.cos() as f32, -(angle.sin()) as f32) * radius;
    ui.painter().line_segment([centre - spoke, centre + spoke], Stroke::new(1.0, theme.weak));
    ui.painter().circle_filled(centre, 3.0, theme.accent);
}

fn draw_spring(ui: &Ui, theme: &WindowTheme, from: Pos2, to: Pos2) {
    const TURNS: usize = 7;
    let (stroke, along) = (Stroke::new(1.5, theme.text), to - from);
    let mut points = vec![from];
    for k in 0..=2 * TURNS {
        let side = if k == 0 || k == 2 * TURNS {
            0.0
        } else if k % 2 == 0 {
            8.0
        } else {
            -8.0
        };
        let share = 0.15 + 0.7 * k as f32 / (2 * TURNS) as f32;
        points.push(from + share * along + vec2(0.0, side));
    }
    points.push(to);
    ui.painter().add(egui::Shape::line(points, stroke));
}

/// Draws the out-of-balance as a weight on the beam's rim, on its side.
fn draw_weight(ui: &Ui, theme: &WindowTheme, Disc { centre, radius }: Disc, angle: f64, moment: f64) {
    let side = if moment < 0.0 { -1.0 } else { 1.0 };
    let arm = vec2(angle.cos() as f32, -(angle.sin()) as f32) * (side * radius);
    let fill = theme.curves[1].gamma_multiply(0.35);
    ui.painter().circle(centre + arm, 9.0, fill, Stroke::new(1.5, theme.curves[1]));
}

fn write_captions(
    ui: &Ui,
    view: &StudioView,
    plant: &Parameters,
    lumped: &LumpedStructure,
    at: [Pos2; 5],
    below: f32,
) {
    let (theme, angle) = (&view.theme, view.units.display_unit("rad"));
    let gear = &plant.gearbox;
    let texts: [(&str, [String; 2]); 5] = [
        (
            "amplifier",
            [
                format!("gain {}", format_short(plant.amplifier.gain)),
                format!("to {} V", format_short(plant.amplifier.bus_voltage_v)),
            ],
        ),
        (
            "motor",
            [
                format!("{} kg m\u{b2}", format_short(plant.motor.inertia_kg_m2)),
                format!("{} N m/A", format_short(plant.motor.torque_constant_nm_a)),
            ],
        ),
        (
            "gear",
            [
                format!("ratio {}", format_short(gear.ratio)),
                format!("backlash {} {}", format_short(angle.factor * gear.backlash_rad), angle.name),
            ],
        ),
        ("hub", [format!("{} kg m\u{b2}", format_short(lumped.hub_inertia_kg_m2)), String::new()]),
        (
            "beam",
            [
                format!("{} kg m\u{b2}", format_short(lumped.beam_inertia_kg_m2)),
                format!("out-of-balance {} kg m", format_short(lumped.out_of_balance_kg_m)),
            ],
        ),
    ];
    for (centre, (name, lines)) in at.iter().zip(&texts) {
        write_text(ui, pos2(centre.x, below), name, 13.0, theme.text);
        for (k, line) in lines.iter().enumerate() {
            write_text(ui, pos2(centre.x, below + 17.0 + 14.0 * k as f32), line, 11.0, theme.weak);
        }
    }
    let middle = pos2(0.5 * (at[3].x + at[4].x), at[3].y - 24.0);
    write_text(ui, middle, &format!("{} N m/rad", format_short(lumped.stiffness_nm_rad)), 11.0, theme.weak);
}

fn write_text(ui: &Ui, at: Pos2, text: &str, size: f32, colour: egui::Color32) {
    ui.painter().text(at, Align2::CENTER_CENTER, text, FontId::proportional(size), colour);
}
