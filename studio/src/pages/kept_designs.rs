//! Designs that are kept for comparison, and restored.

use egui::{RichText, Ui};

use crate::command::{Command, DesignSlot};
use crate::view::StudioView;

/// Shows a slot: a free one keeps the current design, an occupied one opens what can be done with it.
pub fn show_slot(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>, slot: DesignSlot) {
    let name = slot.name();
    if !view.kept.contains_key(&slot) {
        let free = ui.selectable_label(false, name).on_hover_text("keep this design for comparison");
        let text = format!("keep this design as {name}");
        free.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text.clone()));
        if free.clicked() {
            queue.push(Command::Keep { slot });
        }
        return;
    }
    let letter = RichText::new(name).strong().color(view.theme.kept_colour(slot));
    let button = egui::Button::selectable(true, letter);
    let (shown, _) = egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        for (text, command) in [
            (format!("Go back to {name}"), Command::Return { slot }),
            (format!("Keep the current design as {name}"), Command::Keep { slot }),
            (format!("Clear {name}"), Command::Forget { slot }),
        ] {
            if ui.button(text).clicked() {
                queue.push(command);
                ui.close();
            }
        }
    });
    let text = format!("kept design {name}");
    shown.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text.clone()));
    shown.on_hover_text("kept; click to go back to it, to keep another, or to clear it");
}
