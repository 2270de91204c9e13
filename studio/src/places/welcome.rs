//! Before a project is open: what to do, and the projects that were open before.

use egui::{RichText, Ui};

use crate::command::Command;
use crate::files;
use crate::studio::Studio;
use crate::theme::space;

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.add_space(ui.available_height() * 0.22);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new("Counterpoise").size(30.0).strong());
        ui.label(
            RichText::new(
                "Drop a project file or its folder here, or start with: counterpoise studio PROJECT",
            )
            .color(theme.weak),
        );
        if let Some(why) = &studio.refused {
            ui.add_space(space::MEDIUM);
            ui.label(RichText::new(why).color(theme.bad));
        }
        ui.add_space(space::LARGE);
        let recent = files::recent(&studio.state);
        if !recent.is_empty() {
            ui.label(RichText::new("Recent projects").strong());
        }
        for path in recent {
            if ui.link(path.display().to_string()).clicked() {
                queue.push(Command::Open { path });
            }
        }
    });
}
