//! Designs that are kept for comparison, and gone back to.

use egui::Ui;

use crate::command::{Command, Slot};
use crate::view::View;

/// Keeps the present design in a free slot; one that is taken opens what can be done with it.
pub fn keeper(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, slot: Slot) {
    let name = slot.name();
    if !view.kept.contains_key(name) {
        let free = ui.selectable_label(false, name).on_hover_text("keep this design for comparison");
        let said = format!("keep this design as {name}");
        free.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, said.clone()));
        if free.clicked() {
            queue.push(Command::Keep { slot });
        }
        return;
    }
    let button = egui::Button::selectable(true, name);
    let (shown, _) = egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        for (text, command) in [
            (format!("Go back to {name}"), Command::Return { slot }),
            (format!("Keep the present design as {name}"), Command::Keep { slot }),
            (format!("Forget {name}"), Command::Forget { slot }),
        ] {
            if ui.button(text).clicked() {
                queue.push(command);
                ui.close();
            }
        }
    });
    let said = format!("kept design {name}");
    shown.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, said.clone()));
    shown.on_hover_text("kept; click to go back to it, to keep another, or to forget it");
}
