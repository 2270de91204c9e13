//! Before a project is open: open one by its path, make one, or go on with one that was open before.

use egui::{RichText, Ui};

use super::browse;
use crate::command::Command;
use crate::studio::Studio;
use crate::theme::space;

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.add_space(ui.available_height() * 0.08);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new("Counterpoise").size(30.0).strong());
        ui.label(RichText::new("from geometry and drive data to a verified controller").color(theme.weak));
        ui.add_space(space::LARGE);
        ui.set_max_width(browse::WIDTH + 2.0 * space::LARGE);
        theme.card().inner_margin(egui::Margin::same(14)).show(ui, |ui| {
            ui.set_width(browse::WIDTH);
            ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.label(RichText::new("Open or make a project").heading());
                let hint = "Type or click a path, or drop a project's folder onto this window.";
                ui.label(RichText::new(hint).small().color(theme.weak));
                ui.add_space(space::MEDIUM);
                browse::inside(studio, ui, queue);
            });
        });
    });
}
