//! The page before a project is open: it opens a project, makes one, or continues with a recent one.

use egui::{RichText, Ui};

use super::file_browser;
use crate::command::Command;
use crate::studio::Studio;
use crate::theme::space;

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.add_space(ui.available_height() * 0.08);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new("Counterpoise").size(30.0).strong());
        ui.label(RichText::new("from geometry and drive data to a verified controller").color(theme.weak));
        ui.add_space(space::LARGE);
        ui.set_max_width(file_browser::WIDTH + 2.0 * space::LARGE);
        theme.card().inner_margin(egui::Margin::same(14)).show(ui, |ui| {
            ui.set_width(file_browser::WIDTH);
            ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.label(RichText::new("Open or make a project").heading());
                let hint = "Type or click a path, or drop a project's folder onto this window.";
                ui.label(RichText::new(hint).small().color(theme.weak));
                ui.add_space(space::MEDIUM);
                file_browser::show_content(studio, ui, queue);
            });
        });
    });
}
