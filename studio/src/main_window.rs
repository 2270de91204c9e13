//! The window around the pages: toolbar, status bar, messages, questions, shortcuts, dropped files.

use egui::Ui;

use crate::command::{Command, Page};
use crate::jobs::plot_copy::ClipboardContent;
use crate::studio::Studio;
use crate::theme::space;
use crate::{banners, close_question, command_palette, help_window, pages, shortcuts, status_bar, toolbar};

/// Shows the studio and carries out what the user asked for in this frame.
pub fn show(studio: &mut Studio, ui: &mut Ui) {
    let theme = studio.view.theme;
    studio.view.dragging = false;
    studio.view.help.pointed = None;
    studio.view.limits_scope = limits_scope(studio);
    let mut queue = shortcuts::pressed_commands(studio, ui);
    queue.extend(dropped_files(ui));
    let bar = |margin| egui::Frame::new().fill(theme.card).inner_margin(egui::Margin::symmetric(12, margin));
    egui::Panel::top("toolbar").frame(bar(7)).show(ui, |ui| toolbar::show(studio, ui, &mut queue));
    egui::Panel::bottom("status").frame(bar(4)).show(ui, |ui| status_bar::show(studio, ui, &mut queue));
    let ground = egui::Frame::new().fill(theme.ground).inner_margin(egui::Margin::same(space::MEDIUM as i8));
    egui::CentralPanel::default().frame(ground).show(ui, |ui| show_page(studio, ui, &mut queue));
    pages::file_browser::show_over_page(studio, ui, &mut queue);
    help_window::show(studio, ui);
    command_palette::show(studio, ui, &mut queue);
    close_question::show(studio, ui, &mut queue);
    match studio.clipboard.take() {
        Some(ClipboardContent::Text(text)) => ui.ctx().copy_text(text),
        Some(ClipboardContent::Pixels(image)) => ui.ctx().copy_image(egui::ColorImage::clone(&image)),
        None => {}
    }
    // asked for where no plot is under the pointer
    studio.view.is_second_cursor_asked = false;
    studio.view.had_keyboard_focus = ui.ctx().egui_wants_keyboard_input();
    for command in queue {
        zoom(ui, &command);
        studio.run(&command);
    }
}

fn show_page(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    if let (None, Some(path)) = (&studio.opened, studio.file_queue.path_being_opened()) {
        let path = path.display().to_string();
        return pages::widgets::show_placeholder(ui, &theme, "Opening", &path);
    }
    if studio.opened.is_none() {
        pages::welcome::show(studio, ui, queue);
        return;
    }
    banners::show(studio, ui, queue);
    match studio.view.page {
        Page::Plant => pages::plant::show(studio, ui, queue),
        Page::Reduce => pages::reduce::show(studio, ui, queue),
        Page::Design => pages::design::show(studio, ui, queue),
        Page::Verify => pages::verify::show(studio, ui, queue),
        Page::Diagnose => pages::diagnose::show(studio, ui, queue),
        Page::Commission => pages::commission::show(studio, ui, queue),
        Page::Studies => pages::studies::show(studio, ui, queue),
        Page::Text => pages::project_text::show(studio, ui, queue),
    }
}

/// Returns what the limits of plots belong to beside their axes: the project, the part of the controller and the recording.
fn limits_scope(studio: &Studio) -> String {
    let path = studio.opened.as_ref().map(|opened| opened.path.display().to_string());
    format!("{} {:?} {}", path.unwrap_or_default(), studio.view.part, studio.view.recording)
}

/// Returns the command for a project or recordings that were dropped on the window.
fn dropped_files(ui: &Ui) -> Vec<Command> {
    let paths: Vec<_> = ui.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_path_buf()).collect());
    let is_project = |p: &std::path::PathBuf| {
        counterpoise_host::files::project_file(p).is_file()
            && (p.is_dir() || p.extension().is_some_and(|e| e == "toml"))
    };
    match paths.iter().find(|p| is_project(p)) {
        Some(path) => vec![Command::Open { path: path.clone() }],
        None if paths.is_empty() => Vec::new(),
        None => vec![Command::Go { page: Page::Diagnose }, Command::Recordings { paths }],
    }
}

/// Makes everything larger or smaller.
fn zoom(ui: &Ui, command: &Command) {
    match command {
        Command::Larger => egui::gui_zoom::zoom_in(ui.ctx()),
        Command::Smaller => egui::gui_zoom::zoom_out(ui.ctx()),
        _ => {}
    }
}
