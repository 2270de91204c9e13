//! Banners above a page: another program has changed the file, another window has the project open, or its text has errors.

use egui::{RichText, Ui};

use crate::command::{BrowsePurpose, Command, Page};
use crate::studio::Studio;
use crate::text_difference::{DifferenceLine, line_differences};
use crate::theme::{WindowTheme, space};

/// Largest height of the shown difference, points.
const DIFFERENCE_HEIGHT: f32 = 220.0;

/// Shows the banners of the open project.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    let Some(opened) = &studio.opened else { return };
    if opened.is_read_only() {
        show_read_only_banner(ui, &theme, queue, &opened.path);
    }
    if !opened.session.errors().is_empty() && studio.view.page != Page::Text {
        show_error_banner(ui, &theme, queue, opened.session.errors().len());
    }
    let Some(disk) = &opened.disk_text else { return };
    let (mine, theirs) = (opened.session.text(), disk.text.as_str());
    let mut shows_difference = studio.view.shows_difference;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            let text = "The project file was changed by another program.";
            ui.label(RichText::new(text).color(theme.warn));
            ui.toggle_value(&mut shows_difference, "Difference");
            let keep = ui.button("Keep mine").on_hover_text("writes this project over the file");
            if keep.clicked() {
                queue.push(Command::Overwrite);
            }
            let take = ui.button("Take theirs");
            if take.on_hover_text("reads the file again; one step of undo restores your edits").clicked() {
                queue.push(Command::Reload);
            }
            if ui.button("Save as\u{2026}").on_hover_text("keeps both").clicked() {
                queue.push(Command::Browse { purpose: BrowsePurpose::SaveAs });
            }
        });
        if shows_difference {
            show_difference(ui, &theme, theirs, mine);
        }
    });
    ui.add_space(space::SMALL);
    studio.view.shows_difference = shows_difference;
}

fn show_read_only_banner(ui: &mut Ui, theme: &WindowTheme, queue: &mut Vec<Command>, path: &std::path::Path) {
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            let text = "This project is open in another window; here it can only be read.";
            ui.label(RichText::new(text).color(theme.warn));
            if ui.button("Save a copy\u{2026}").on_hover_text("Ctrl+Shift+S").clicked() {
                queue.push(Command::Browse { purpose: BrowsePurpose::SaveAs });
            }
            let again = ui.button("Open it again");
            if again.on_hover_text("after the other window was closed").clicked() {
                queue.push(Command::Open { path: path.to_owned() });
            }
        });
    });
    ui.add_space(space::SMALL);
}

/// Shows that the project's text has errors, and leads to the page on which they are corrected.
fn show_error_banner(ui: &mut Ui, theme: &WindowTheme, queue: &mut Vec<Command>, count: usize) {
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            let errors = if count == 1 { "an error".to_owned() } else { format!("{count} errors") };
            let text = format!("The project's text has {errors}; this page shows the last one without.");
            ui.label(RichText::new(text).color(theme.bad));
            if ui.button("Correct the text").on_hover_text("Shift+F8").clicked() {
                queue.push(Command::NextError);
            }
        });
    });
    ui.add_space(space::SMALL);
}

/// Shows which lines differ between the file and the project.
fn show_difference(ui: &mut Ui, theme: &WindowTheme, theirs: &str, mine: &str) {
    let lines = line_differences(theirs, mine);
    ui.label(RichText::new("- in the file     + here").small().monospace().color(theme.weak));
    egui::ScrollArea::vertical().id_salt("difference").max_height(DIFFERENCE_HEIGHT).show(ui, |ui| {
        ui.set_width(ui.available_width());
        if lines.is_empty() {
            ui.label(RichText::new("the two are the same").small().color(theme.weak));
        }
        for line in &lines {
            let (text, colour) = match line {
                DifferenceLine::Removed(text) => (format!("- {text}"), theme.bad),
                DifferenceLine::Added(text) => (format!("+ {text}"), theme.good),
                DifferenceLine::Gap(count) => (format!("  \u{2026} {count} equal lines"), theme.weak),
            };
            ui.label(RichText::new(text).small().monospace().color(colour));
        }
    });
}
