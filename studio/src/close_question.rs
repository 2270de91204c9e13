//! The question about unsaved edits when a project or the window is closed.

use egui::{RichText, Ui};

use crate::command::Command;
use crate::studio::{Studio, WindowClosing};
use crate::theme::space;
use crate::view::CloseTarget;

/// Shows the question while it is asked.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(target) = studio.view.close_question else { return };
    let theme = studio.view.theme;
    let name = studio.opened.as_ref().map(|opened| opened.path.display().to_string()).unwrap_or_default();
    let frame = theme.card().inner_margin(egui::Margin::same(14));
    let mut answer: Option<Vec<Command>> = None;
    let shown = egui::Modal::new(egui::Id::unique("close question")).frame(frame).show(ui.ctx(), |ui| {
        ui.set_width(460.0);
        ui.label(RichText::new("There are unsaved edits").heading());
        ui.label(RichText::new(name).small().color(theme.weak));
        ui.add_space(space::MEDIUM);
        ui.horizontal(|ui| {
            if ui.button("Save").clicked() {
                answer = Some(vec![Command::Save, Command::Close]);
            }
            let keep = ui.button("Keep for later");
            if keep.on_hover_text("the edits are restored when the project is opened again").clicked() {
                answer = Some(vec![Command::Close]);
            }
            if ui.button("Discard").on_hover_text("the edits are lost").clicked() {
                answer = Some(vec![Command::DiscardAndClose]);
            }
            if ui.button("Cancel").on_hover_text("Esc").clicked() {
                answer = Some(Vec::new());
            }
        });
    });
    let is_cancelled = shown.should_close() || answer.as_ref().is_some_and(Vec::is_empty);
    if is_cancelled || answer.is_some() {
        studio.view.close_question = None;
    }
    if is_cancelled {
        studio.window_closing = WindowClosing::No;
    } else if let Some(commands) = answer {
        if target == CloseTarget::Window {
            studio.window_closing = WindowClosing::WhenProjectIsClosed;
        }
        queue.extend(commands);
    }
}
