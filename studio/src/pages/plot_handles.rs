//! Handles on plots: they are gripped and dragged, or have the keyboard's focus and are moved by its arrow keys.

use egui::{Pos2, Response, Ui, Vec2};

/// Distance that an arrow key moves a handle, points.
const ARROW_STEP: f32 = 2.0;

/// Returns where a handle at a place is moved to in this frame, by the pointer or by the arrow keys; `None` if it is not moved.
pub fn moved_position(ui: &Ui, response: &Response, at: Pos2) -> Option<Pos2> {
    if response.dragged() { dragged_position(ui, response, at) } else { arrow_key_position(ui, response, at) }
}

/// Returns where a handle is dragged to: it stays under the pointer at the point where it was gripped.
fn dragged_position(ui: &Ui, response: &Response, at: Pos2) -> Option<Pos2> {
    let id = response.id.with("grip");
    if response.drag_started() {
        let origin = ui.input(|i| i.pointer.press_origin()).unwrap_or(at);
        ui.data_mut(|d| d.insert_temp(id, at - origin));
    }
    let grip: Vec2 = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    response.interact_pointer_pos().map(|pointer| pointer + grip)
}

/// Returns where the arrow keys move a handle that has the focus.
fn arrow_key_position(ui: &Ui, response: &Response, at: Pos2) -> Option<Pos2> {
    if !response.has_focus() {
        return None;
    }
    let keys = [
        (egui::Key::ArrowLeft, egui::vec2(-ARROW_STEP, 0.0)),
        (egui::Key::ArrowRight, egui::vec2(ARROW_STEP, 0.0)),
        (egui::Key::ArrowUp, egui::vec2(0.0, -ARROW_STEP)),
        (egui::Key::ArrowDown, egui::vec2(0.0, ARROW_STEP)),
    ];
    let step =
        ui.input(|i| keys.iter().filter(|(k, _)| i.key_pressed(*k)).fold(Vec2::ZERO, |sum, (_, v)| sum + *v));
    (step != Vec2::ZERO).then_some(at + step)
}
