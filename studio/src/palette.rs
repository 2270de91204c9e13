//! The list of all commands, found by what is typed.

use egui::{Key, RichText, Ui};

use crate::command::{Command, Entry, entries};
use crate::noted::List;
use crate::studio::Studio;
use crate::theme::{Theme, space};

/// The entries that a typed text finds, of all commands and the projects that were open before: every word of it must appear.
pub fn found(typed: &str, recent: &[std::path::PathBuf]) -> Vec<Entry> {
    let words: Vec<String> = typed.to_lowercase().split_whitespace().map(str::to_owned).collect();
    let fits = |e: &Entry| words.iter().all(|w| e.name.to_lowercase().contains(w));
    let open = |path: &std::path::PathBuf| Entry {
        name: format!("Open {}", path.display()).into(),
        shortcut: "",
        command: Command::Open { path: path.clone() },
    };
    entries().into_iter().chain(recent.iter().map(open)).filter(fits).collect()
}

/// Shows the list where it is open.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    if studio.view.palette.is_none() {
        return;
    }
    let recent = studio.noted.list(List::Projects);
    let Some((typed, chosen)) = &mut studio.view.palette else { return };
    let mut done = None;
    let close = ui.input(|i| i.key_pressed(Key::Escape));
    egui::Window::new("All commands")
        .title_bar(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_TOP, [0.0, 70.0])
        .fixed_size([460.0, 420.0])
        .show(ui.ctx(), |ui| {
            let edit =
                egui::TextEdit::singleline(typed).hint_text("type a command").desired_width(f32::INFINITY);
            ui.add(edit).request_focus();
            let list = found(typed, &recent);
            let (up, down, enter) = ui.input(|i| {
                (i.key_pressed(Key::ArrowUp), i.key_pressed(Key::ArrowDown), i.key_pressed(Key::Enter))
            });
            *chosen = (*chosen + usize::from(down))
                .saturating_sub(usize::from(up))
                .min(list.len().saturating_sub(1));
            ui.add_space(space::SMALL);
            egui::ScrollArea::vertical().max_height(360.0).show(ui, |ui| {
                for (k, entry) in list.iter().enumerate() {
                    if row(ui, entry, k == *chosen, &theme) || (enter && k == *chosen) {
                        done = Some(entry.command.clone());
                    }
                }
            });
        });
    if done.is_some() || close {
        studio.view.palette = None;
    }
    queue.extend(done.filter(|command| *command != Command::Palette));
}

fn row(ui: &mut Ui, entry: &Entry, chosen: bool, theme: &Theme) -> bool {
    let text = egui::Button::selectable(chosen, entry.name.as_ref())
        .truncate()
        .right_text(RichText::new(entry.shortcut).small().color(theme.weak))
        .min_size(egui::vec2(ui.available_width(), 24.0));
    ui.add(text).clicked()
}
