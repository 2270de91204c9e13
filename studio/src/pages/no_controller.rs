//! The pages of a project without a controller: a model, perhaps with recordings, is an ordinary project.

use egui::{RichText, Ui};

use crate::command::{Command, Page};
use crate::theme::{WindowTheme, space};

/// Shows that the project has no controller, and what can be done with it.
pub fn show(ui: &mut Ui, theme: &WindowTheme, queue: &mut Vec<Command>, task: &str) {
    ui.add_space(ui.available_height() * 0.3);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new("A model without a controller").heading());
        ui.add_space(space::SMALL);
        let text = format!("There is nothing to {task}: the project file has no section [synth]. Add one to design a controller.");
        ui.label(RichText::new(text).color(theme.weak));
        ui.add_space(space::MEDIUM);
        ui.label(RichText::new("The mechanism and recordings of it can be studied as they are:").color(theme.weak));
        ui.add_space(space::SMALL);
        for (text, page) in [("Show the mechanism", Page::Plant), ("Compare it with recordings", Page::Diagnose)] {
            if ui.button(text).clicked() {
                queue.push(Command::Go { page });
            }
        }
    });
}
