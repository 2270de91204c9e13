//! The page before a project is open: it opens a project, makes one, continues with a recent one, or begins with an example.

use std::path::PathBuf;

use egui::{RichText, Ui};

use super::file_browser;
use crate::command::Command;
use crate::examples::EXAMPLES;
use crate::studio::Studio;
use crate::theme::{WindowTheme, space};

/// Width of the card with the examples, points.
const EXAMPLES_WIDTH: f32 = 300.0;
/// Margin of a card, points.
const MARGIN: f32 = 14.0;

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.add_space(ui.available_height() * 0.08);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new("Counterpoise").size(30.0).strong());
        ui.label(RichText::new("from geometry and drive data to a verified controller").color(theme.weak));
        ui.add_space(space::LARGE);
    });
    let width = file_browser::WIDTH + EXAMPLES_WIDTH + 4.0 * MARGIN + space::MEDIUM;
    let is_wide = ui.available_width() > width;
    let shown = if is_wide { width } else { file_browser::WIDTH + 2.0 * MARGIN };
    let left = (0.5 * (ui.available_width() - shown)).max(0.0);
    egui::ScrollArea::vertical().id_salt("welcome").show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.add_space(left);
            ui.vertical(|ui| {
                show_projects(studio, ui, queue, &theme);
                if !is_wide {
                    ui.add_space(space::MEDIUM);
                    show_examples(ui, queue, &theme, copy_folder(studio));
                }
            });
            if is_wide {
                show_examples(ui, queue, &theme, copy_folder(studio));
            }
        });
    });
}

/// Returns the folder into which a copy of an example is written.
fn copy_folder(studio: &Studio) -> Option<PathBuf> {
    studio.view.browser.as_ref().map(|browser| browser.folder())
}

fn show_projects(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>, theme: &WindowTheme) {
    theme.card().inner_margin(egui::Margin::same(MARGIN as i8)).show(ui, |ui| {
        ui.set_width(file_browser::WIDTH);
        ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.label(RichText::new("Open or make a project").heading());
            let hint = "Type or click a path, or drop a project's folder onto this window.";
            ui.label(RichText::new(hint).small().color(theme.weak));
            ui.add_space(space::MEDIUM);
            file_browser::show_content(studio, ui, queue);
        });
    });
}

fn show_examples(ui: &mut Ui, queue: &mut Vec<Command>, theme: &WindowTheme, folder: Option<PathBuf>) {
    let Some(folder) = folder else { return };
    theme.card().inner_margin(egui::Margin::same(MARGIN as i8)).show(ui, |ui| {
        ui.set_width(EXAMPLES_WIDTH);
        ui.vertical(|ui| {
            ui.label(RichText::new("Begin with an example").heading());
            let hint = format!("A copy is written into {}.", folder.display());
            ui.label(RichText::new(hint).small().color(theme.weak));
            ui.add_space(space::SMALL);
            for example in EXAMPLES {
                let button = egui::Button::new(example_layout(example.title, example.summary, theme))
                    .frame_when_inactive(false)
                    .wrap()
                    .min_size(egui::vec2(EXAMPLES_WIDTH, 34.0));
                if ui.add(button).clicked() {
                    let example = example.name.to_owned();
                    queue.push(Command::CopyExample { example, folder: folder.clone() });
                }
            }
        });
    });
}

/// Lays out the title of an example over what it shows.
fn example_layout(title: &str, summary: &str, theme: &WindowTheme) -> egui::text::LayoutJob {
    let format = |size, colour| egui::TextFormat::simple(egui::FontId::proportional(size), colour);
    let mut job = egui::text::LayoutJob::default();
    job.append(title, 0.0, format(13.0, theme.accent));
    job.append(&format!("\n{summary}"), 0.0, format(11.0, theme.weak));
    job
}
