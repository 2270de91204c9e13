//! Recent projects and folders in the file browser.

use std::path::{Path, PathBuf};

use counterpoise_host::files;
use egui::{RichText, Ui};

use crate::browser::Browser;
use crate::command::{BrowsePurpose, Command};
use crate::studio::Studio;
use crate::theme::{WindowTheme, space};
use counterpoise_host::recent_files::RecentList;

/// Width of the list of recent places, points.
pub(super) const WIDTH: f32 = 190.0;
/// Largest height of the list, points.
const HEIGHT: f32 = 300.0;

/// A project or folder that was used before.
pub(super) struct RecentPlace {
    name: String,
    path: PathBuf,
}

/// Returns recent projects to open, or recent folders to go to.
pub(super) fn list_recent_places(studio: &Studio, purpose: BrowsePurpose) -> Vec<RecentPlace> {
    let recent = studio.recent_files.paths(RecentList::Projects);
    let named = |path: &Path| {
        path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
    };
    if purpose == BrowsePurpose::Project {
        let name = |path: &PathBuf| match path.parent() {
            Some(folder) if path.ends_with(files::PROJECT_FILE) => named(folder),
            _ => named(path),
        };
        return recent.iter().map(|path| RecentPlace { name: name(path), path: path.clone() }).collect();
    }
    let mut all = studio.recent_files.paths(RecentList::Folders);
    all.extend(recent.iter().filter_map(|path| path.parent().map(Path::to_owned)));
    all.extend(std::env::var_os("HOME").map(PathBuf::from));
    let mut once: Vec<PathBuf> = Vec::new();
    all.into_iter().for_each(|path| {
        if !once.contains(&path) {
            once.push(path)
        }
    });
    once.into_iter().map(|path| RecentPlace { name: named(&path), path }).collect()
}

/// Shows the recent places of the browser.
pub(super) fn show_recent_places(
    ui: &mut Ui,
    browser: &mut Browser,
    queue: &mut Vec<Command>,
    theme: &WindowTheme,
    places: &[RecentPlace],
) {
    let projects = browser.purpose == BrowsePurpose::Project;
    let heading = if projects { "Recent projects" } else { "Recent folders" };
    ui.label(RichText::new(heading).small().color(theme.weak));
    if places.is_empty() {
        ui.label(RichText::new("none yet").small().color(theme.weak));
    }
    egui::ScrollArea::vertical().id_salt("places").max_height(HEIGHT).show(ui, |ui| {
        for RecentPlace { name, path } in places {
            let button = egui::Button::selectable(false, place_layout(name, path, theme))
                .wrap_mode(egui::TextWrapMode::Extend)
                .min_size(egui::vec2(WIDTH - space::SMALL, 22.0));
            let shown = ui.add(button);
            shown.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, path.display().to_string())
            });
            if shown.on_hover_text(path.display().to_string()).clicked() {
                match projects {
                    true => queue.push(Command::Open { path: path.clone() }),
                    false => browser.set_path(path),
                }
            }
        }
    });
}

/// Number of letters of a path that fit below its name.
const PATH_LETTERS: usize = 30;

/// Lays out a name over the end of its path.
fn place_layout(name: &str, path: &Path, theme: &WindowTheme) -> egui::text::LayoutJob {
    let whole = path.parent().unwrap_or(path).display().to_string();
    let most: Vec<char> = whole.chars().collect();
    let end: String = most[most.len().saturating_sub(PATH_LETTERS)..].iter().collect();
    let below = if end.len() < whole.len() { format!("\u{2026}{end}") } else { whole };
    let format = |size, colour| egui::TextFormat::simple(egui::FontId::proportional(size), colour);
    let mut job = egui::text::LayoutJob::default();
    job.append(name, 0.0, format(13.0, theme.text));
    job.append(&format!("\n{below}"), 0.0, format(10.0, theme.weak));
    job
}
