//! The beam drawn to scale, at rest or moving in a mode.

use counterpoise_models::parameters::{Beam, BeamSection, PointMass, SectionShape};
use counterpoise_pipeline::reduction_views::PinnedModes;
use egui::{Color32, Pos2, Rect, Stroke, Ui, pos2, vec2};

use crate::jobs::plant_pictures::BeamModes;
use crate::number_format::format_short;
use crate::theme::WindowTheme;
use crate::view::StudioView;

/// Maps metres to the screen: x along the beam, y up.
struct DrawingScale {
    left: f32,
    middle: f32,
    scale: f32,
    from_m: f64,
}

impl DrawingScale {
    fn at(&self, x_m: f64, y_m: f64) -> Pos2 {
        pos2(self.left + self.scale * (x_m - self.from_m) as f32, self.middle - self.scale * y_m as f32)
    }
}

/// Draws a beam to scale with its masses, the pivot and a ruler; a selected mode moves.
pub fn draw_beam(ui: &Ui, view: &StudioView, beam: &Beam, modes: Option<&BeamModes>, canvas: Rect) {
    let (Some(first), Some(last)) = (beam.sections.first(), beam.sections.last()) else { return };
    let length = (last.to_m - first.from_m).max(1e-3);
    let scale = (0.92 * canvas.width() / length as f32).min(260.0);
    let left = canvas.center().x - 0.5 * scale * length as f32;
    let frame = DrawingScale { left, middle: canvas.center().y - 4.0, scale, from_m: first.from_m };
    let shape = mode_shape(ui, view, modes);
    let theme = view.theme;
    for section in &beam.sections {
        draw_section(ui, &theme, &frame, section, &shape);
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
        draw_text(
            ui,
            at + vec2(0.0, -32.0 - 14.0 * below),
            &format!("{}: {} kg", mass.name, format_short(mass.mass_kg)),
            theme.weak,
        );
    }
    draw_pivot(ui, &theme, frame.at(beam.pivot_m, 0.0), scale);
    draw_ruler(ui, &theme, &frame, first.from_m, last.to_m, canvas.bottom() - 18.0);
}

fn half_heights(shape: &SectionShape) -> [f64; 2] {
    match shape {
        SectionShape::Tube { outer_diameter_m, .. } => outer_diameter_m.map(|d| 0.5 * d),
        SectionShape::Rectangle { height_m, .. } => height_m.map(|h| 0.5 * h),
        SectionShape::Given { area_m2, .. } => area_m2.map(|a| 0.5 * a.max(0.0).sqrt()),
    }
}

fn draw_section(
    ui: &Ui,
    theme: &WindowTheme,
    frame: &DrawingScale,
    section: &BeamSection,
    shape: &dyn Fn(f64) -> f64,
) {
    let (from, to, half) = (section.from_m, section.to_m, half_heights(&section.shape));
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
fn draw_pivot(ui: &Ui, theme: &WindowTheme, at: Pos2, scale: f32) {
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
    draw_text(ui, pinion + vec2(64.0, 0.0), "motor and gear", theme.weak);
}

fn draw_ruler(ui: &Ui, theme: &WindowTheme, frame: &DrawingScale, from: f64, to: f64, y: f32) {
    let stroke = Stroke::new(1.0, theme.weak);
    ui.painter().line_segment([pos2(frame.at(from, 0.0).x, y), pos2(frame.at(to, 0.0).x, y)], stroke);
    let mut metre = from.ceil();
    while metre <= to {
        let x = frame.at(metre, 0.0).x;
        ui.painter().line_segment([pos2(x, y - 4.0), pos2(x, y)], stroke);
        draw_text(ui, pos2(x, y + 9.0), &format!("{} m", metre as i64), theme.weak);
        metre += 1.0;
    }
}

fn draw_text(ui: &Ui, at: Pos2, what: &str, colour: Color32) {
    ui.painter().text(at, egui::Align2::CENTER_CENTER, what, egui::FontId::proportional(12.0), colour);
}

/// Largest deflection of a moving mode, as a share of the beam's length: clearly visible, and small enough to stay in the card.
const SWING: f64 = 0.05;

/// Returns the deflection of the beam in the selected mode at this moment, m.
fn mode_shape(ui: &Ui, view: &StudioView, modes: Option<&BeamModes>) -> impl Fn(f64) -> f64 + use<> {
    let found = modes.filter(|_| view.mode > 0).and_then(|s| s.modes.as_ref());
    let (mut nodes, mut size) = (Vec::new(), 0.0);
    if let Some(PinnedModes { nodes_m, modes }) = found
        && view.mode <= modes.frequencies_rad_s.len().saturating_sub(modes.rigid)
    {
        let phi = modes.flexible_shape(view.mode - 1);
        nodes = nodes_m.iter().enumerate().map(|(k, x)| (*x, phi[2 * k])).collect();
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
