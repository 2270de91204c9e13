//! The help window: what was under the pointer when F1 was pressed, its terms, and what can be done on the page.

use egui::{Key, RichText, Ui};

use crate::command::{Page, list_commands};
use crate::help::glossary::{GlossaryTerm, find_terms, glossary_terms};
use crate::help::page_texts::page_help;
use crate::studio::Studio;
use crate::theme::{WindowTheme, space};

/// Size of the window, points.
const SIZE: [f32; 2] = [400.0, 520.0];
/// Terms that a search shows.
const TERM_COUNT: usize = 8;

/// Shows the help window while it is open.
pub fn show(studio: &mut Studio, ui: &mut Ui) {
    let (theme, page) = (studio.view.theme, studio.view.page);
    let Some(topic) = studio.view.help.shown.clone() else { return };
    let is_closed = ui.input(|i| i.key_pressed(Key::Escape)) && !studio.view.had_keyboard_focus;
    let mut is_open = true;
    egui::Window::new("Help")
        .open(&mut is_open)
        .collapsible(false)
        .fade_in(false)
        .fade_out(false)
        .anchor(egui::Align2::RIGHT_TOP, [-space::LARGE, 56.0])
        .default_size(SIZE)
        .show(ui.ctx(), |ui| {
            egui::ScrollArea::vertical().max_height(SIZE[1]).show(ui, |ui| {
                ui.label(RichText::new(&topic.title).heading());
                ui.label(&topic.text);
                for term in find_terms(&format!("{} {}", topic.title, topic.text)) {
                    show_term(ui, &theme, term);
                }
                show_gestures(ui, &theme, page);
                show_search(ui, &theme, &mut studio.view.help.search);
            });
        });
    if is_closed || !is_open {
        studio.view.help.shown = None;
    }
}

fn show_term(ui: &mut Ui, theme: &WindowTheme, term: &GlossaryTerm) {
    ui.add_space(space::SMALL);
    ui.label(RichText::new(&term.term).strong().color(theme.accent));
    ui.label(RichText::new(&term.meaning).color(theme.weak));
}

/// Shows what can be done on the page, and the keys of its work.
fn show_gestures(ui: &mut Ui, theme: &WindowTheme, page: Page) {
    ui.add_space(space::MEDIUM);
    ui.label(RichText::new(format!("On the page {}", page.name())).strong());
    for gesture in page_help(page).gestures {
        ui.label(RichText::new(format!("\u{2022} {gesture}")).small());
    }
    let keys = ["F5", "F6", "F7", "F8", "F9", "F10", "Ctrl+K", "Ctrl+Z", "Ctrl+S"];
    let commands = list_commands();
    for entry in commands.iter().filter(|entry| keys.contains(&entry.shortcut)) {
        ui.label(RichText::new(format!("{}: {}", entry.shortcut, entry.name)).small().color(theme.weak));
    }
}

/// Shows the field for a term of the glossary.
fn show_search(ui: &mut Ui, theme: &WindowTheme, search: &mut String) {
    ui.add_space(space::MEDIUM);
    let label = ui.label(RichText::new("Look up a term").strong());
    let field = egui::TextEdit::singleline(search).hint_text("backlash").desired_width(f32::INFINITY);
    ui.add(field).labelled_by(label.id);
    let word = search.trim().to_lowercase();
    if word.is_empty() {
        return;
    }
    let matches = |term: &&GlossaryTerm| term.names.iter().any(|name| name.contains(&word));
    let found: Vec<&GlossaryTerm> = glossary_terms().iter().filter(matches).take(TERM_COUNT).collect();
    if found.is_empty() {
        ui.label(RichText::new("The glossary has no such term.").color(theme.weak));
    }
    found.into_iter().for_each(|term| show_term(ui, theme, term));
}
