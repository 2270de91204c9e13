//! The command palette: all commands, found by the words that are typed.

use std::path::PathBuf;

use egui::{Key, RichText, Ui};

use crate::command::{Command, CommandEntry, list_commands};
use crate::studio::Studio;
use crate::theme::space;
use counterpoise_host::recent_files::RecentList;

/// Returns the commands and recent projects that contain every typed word.
pub fn matching_entries(typed: &str, recent: &[PathBuf]) -> Vec<CommandEntry> {
    let words: Vec<String> = typed.to_lowercase().split_whitespace().map(str::to_owned).collect();
    let matches = |e: &CommandEntry| words.iter().all(|w| e.name.to_lowercase().contains(w));
    let open = |path: &PathBuf| CommandEntry {
        name: format!("Open {}", path.display()).into(),
        shortcut: "",
        command: Command::Open { path: path.clone() },
    };
    list_commands().into_iter().chain(recent.iter().map(open)).filter(matches).collect()
}

/// Shows the command palette while it is open.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    if studio.view.palette.is_none() {
        return;
    }
    let recent = studio.recent_files.paths(RecentList::Projects);
    let Some(state) = &mut studio.view.palette else { return };
    let mut chosen = None;
    let is_closed = ui.input(|i| i.key_pressed(Key::Escape));
    egui::Window::new("All commands")
        .title_bar(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_TOP, [0.0, 70.0])
        .fixed_size([460.0, 420.0])
        .show(ui.ctx(), |ui| {
            let edit = egui::TextEdit::singleline(&mut state.typed)
                .hint_text("type a command")
                .desired_width(f32::INFINITY);
            ui.add(edit).request_focus();
            let entries = matching_entries(&state.typed, &recent);
            let (up, down, enter) = ui.input(|i| {
                (i.key_pressed(Key::ArrowUp), i.key_pressed(Key::ArrowDown), i.key_pressed(Key::Enter))
            });
            state.selected = (state.selected + usize::from(down))
                .saturating_sub(usize::from(up))
                .min(entries.len().saturating_sub(1));
            ui.add_space(space::SMALL);
            egui::ScrollArea::vertical().max_height(360.0).show(ui, |ui| {
                for (k, entry) in entries.iter().enumerate() {
                    let is_selected = k == state.selected;
                    let row = egui::Button::selectable(is_selected, entry.name.as_ref())
                        .truncate()
                        .right_text(RichText::new(entry.shortcut).small().color(theme.weak))
                        .min_size(egui::vec2(ui.available_width(), 24.0));
                    if ui.add(row).clicked() || (enter && is_selected) {
                        chosen = Some(entry.command.clone());
                    }
                }
            });
        });
    if chosen.is_some() || is_closed {
        studio.view.palette = None;
    }
    queue.extend(chosen.filter(|command| *command != Command::Palette));
}
