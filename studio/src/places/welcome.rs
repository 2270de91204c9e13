//! Before a project is open: open one by its path, make one, or go on with one that was open before.

use std::path::{Path, PathBuf};

use egui::{RichText, Ui};

use crate::command::Command;
use crate::files::{self, PROJECT_FILE};
use crate::studio::Studio;
use crate::theme::{Theme, space};

/// Width of the card, points.
const WIDTH: f32 = 560.0;
/// Folders and files that are offered at most.
const OFFERED: usize = 9;

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.add_space(ui.available_height() * 0.10);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new("Counterpoise").size(30.0).strong());
        ui.label(RichText::new("from geometry and drive data to a verified controller").color(theme.weak));
        ui.add_space(space::LARGE);
        ui.set_max_width(WIDTH);
        theme.card().show(ui, |ui| {
            ui.set_width(WIDTH - 20.0);
            ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
                chooser(&mut studio.view.path, ui, &theme, queue);
                if let Some(why) = &studio.refused {
                    ui.add_space(space::SMALL);
                    ui.label(RichText::new(why).color(theme.bad));
                }
            });
        });
        ui.add_space(space::MEDIUM);
        recent(&files::recent(&studio.state), ui, &theme, queue);
    });
}

/// The path of a project, with what stands there.
fn chooser(typed: &mut String, ui: &mut Ui, theme: &Theme, queue: &mut Vec<Command>) {
    ui.label(RichText::new("Open or make a project").strong());
    let label = ui.label(
        RichText::new("Type a path, or drop a project's folder onto this window.").small().color(theme.weak),
    );
    let field =
        egui::TextEdit::singleline(typed).hint_text("folder of a project").desired_width(f32::INFINITY);
    let field = ui.add(field).labelled_by(label.id);
    let entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    if ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    let path = PathBuf::from(typed.trim());
    let there = !typed.trim().is_empty() && files::project_file(&path).is_file();
    let free = !typed.trim().is_empty() && !path.join(PROJECT_FILE).exists() && !path.is_file();
    ui.horizontal(|ui| {
        let open = ui.add_enabled(there, egui::Button::new("Open"));
        if open.clicked() || (entered && there) {
            queue.push(Command::Open { path: path.clone() });
        }
        let make = ui.add_enabled(free, egui::Button::new("New project here"));
        if make.on_hover_text("a folder with a complete machine to start from").clicked() {
            queue.push(Command::New { folder: path.clone() });
        }
    });
    for offered in beside(&path, typed.ends_with(std::path::MAIN_SEPARATOR)) {
        let project = files::project_file(&offered).is_file();
        let name = offered.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let text = if project { format!("{name}   project") } else { format!("{name}/") };
        let colour = if project { theme.text } else { theme.weak };
        if ui.link(RichText::new(text).color(colour)).clicked() {
            if project {
                queue.push(Command::Open { path: offered });
            } else {
                *typed = format!("{}{}", offered.display(), std::path::MAIN_SEPARATOR);
            }
        }
    }
}

/// Folders and project files that begin like the path, projects first.
fn beside(path: &Path, is_folder: bool) -> Vec<PathBuf> {
    let (folder, start) = if is_folder || path.as_os_str().is_empty() {
        (path.to_owned(), String::new())
    } else {
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        (path.parent().map_or_else(PathBuf::new, Path::to_owned), name)
    };
    let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
    let Ok(entries) = std::fs::read_dir(&folder) else { return Vec::new() };
    let fits = |p: &PathBuf| {
        let name = p.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let kind = p.is_dir() || (p.extension().is_some_and(|e| e == "toml") && is_project(p));
        kind && name.starts_with(&start) && !name.starts_with('.')
    };
    let mut found: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(fits).collect();
    found.sort_by_key(|p| (!files::project_file(p).is_file(), p.clone()));
    found.truncate(OFFERED);
    found
}

/// Whether a TOML file has a plant.
fn is_project(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|text| text.contains("[plant"))
}

fn recent(paths: &[PathBuf], ui: &mut Ui, theme: &Theme, queue: &mut Vec<Command>) {
    if paths.is_empty() {
        return;
    }
    theme.card().show(ui, |ui| {
        ui.set_width(WIDTH - 20.0);
        ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.label(RichText::new("Recent projects").strong());
            for path in paths {
                if ui.link(path.display().to_string()).clicked() {
                    queue.push(Command::Open { path: path.clone() });
                }
            }
        });
    });
}
