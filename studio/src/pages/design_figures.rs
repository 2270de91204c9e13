//! The figures of a design beside those of the kept designs.

use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_verify::Source;
use egui::{RichText, Ui};

use super::kept_designs;
use crate::command::{Command, DesignSlot};
use crate::help::glossary::describe_terms;
use crate::number_format::format_short;
use crate::theme::WindowTheme;
use crate::view::StudioView;

/// The unit of a figure.
#[derive(Clone, Copy)]
enum FigureUnit {
    /// A unit that is always the same; empty for a pure number.
    Fixed(&'static str),
    /// That of what the loop controls, shown in the chosen unit.
    Controlled,
}

struct FigureRow {
    name: &'static str,
    unit: FigureUnit,
    value: fn(&DesignPreview) -> f64,
}

const fn row(name: &'static str, unit: FigureUnit, value: fn(&DesignPreview) -> f64) -> FigureRow {
    FigureRow { name, unit, value }
}

const ROWS: [FigureRow; 9] = [
    row("gain margin", FigureUnit::Fixed("dB"), |d| d.margins.gain_margin_db()),
    row("phase margin", FigureUnit::Fixed("deg"), |d| {
        d.margins.phase_margin().map_or(f64::INFINITY, |p| p.deg)
    }),
    row("max sensitivity", FigureUnit::Fixed(""), |d| d.margins.ms.value),
    row("delay margin", FigureUnit::Fixed("ms"), |d| 1e3 * d.margins.delay_s),
    row("crossover", FigureUnit::Fixed("Hz"), DesignPreview::crossover_hz),
    row("overshoot", FigureUnit::Fixed("%"), DesignPreview::overshoot_percent),
    row("heave resid.", FigureUnit::Controlled, |d| d.residual_hub_rate_rad_s(Source::Heave)),
    row("pitch resid.", FigureUnit::Controlled, |d| d.residual_hub_rate_rad_s(Source::Pitch)),
    row("step control", FigureUnit::Fixed("V"), DesignPreview::step_control_v),
];

/// Shows the figures of the design and of the kept designs; numbers are aligned to the right.
pub fn show(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, design: &DesignPreview) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        egui::Grid::new("figures").num_columns(5).min_col_width(34.0).spacing([6.0, 3.0]).show(ui, |ui| {
            ui.label(RichText::new("linear loop").small().color(theme.weak));
            right_aligned(ui, |ui| drop(ui.label(RichText::new("now").small().color(theme.weak))));
            for slot in DesignSlot::ALL {
                right_aligned(ui, |ui| kept_designs::show_slot(ui, view, queue, slot));
            }
            ui.end_row();
            for row in ROWS {
                show_row(ui, view, design, &row);
                ui.end_row();
            }
        });
    });
}

fn show_row(ui: &mut Ui, view: &StudioView, design: &DesignPreview, row: &FigureRow) {
    let theme: &WindowTheme = &view.theme;
    let controlled = view.units.display_unit(design.synthesised.controlled.unit());
    let (unit, factor) = match row.unit {
        FigureUnit::Fixed(unit) => (unit, 1.0),
        FigureUnit::Controlled => (controlled.name.as_str(), controlled.factor),
    };
    let text = |design: &DesignPreview| format_short(factor * (row.value)(design));
    let label = if unit.is_empty() { row.name.to_owned() } else { format!("{}, {unit}", row.name) };
    let name = ui.label(RichText::new(label).color(theme.weak));
    if name.hovered()
        && let Some(terms) = describe_terms(row.name)
    {
        name.on_hover_text(terms);
    }
    right_aligned(ui, |ui| drop(ui.label(RichText::new(text(design)).strong())));
    for slot in DesignSlot::ALL {
        let value = view.kept.get(&slot).map_or(String::new(), |kept| text(kept));
        let colour = theme.kept_colour(slot);
        right_aligned(ui, |ui| drop(ui.label(RichText::new(value).small().color(colour))));
    }
}

/// Width of a column of numbers, points: seven digits.
const NUMBER_WIDTH: f32 = 45.0;

fn right_aligned(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let size = egui::vec2(NUMBER_WIDTH, 18.0);
    ui.allocate_ui_with_layout(size, egui::Layout::right_to_left(egui::Align::Center), |ui| {
        ui.set_min_size(size);
        content(ui);
    });
}
