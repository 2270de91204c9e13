//! Keyboard shortcuts.

use egui::{Key, KeyboardShortcut, Modifiers, Ui};

use crate::command::{Command, Page, list_commands};
use crate::studio::Studio;

/// Returns a shortcut from its written form, as `Ctrl+Z`; `None` if there is no such key.
pub fn parse_shortcut(written: &str) -> Option<KeyboardShortcut> {
    let mut modifiers = Modifiers::NONE;
    let mut key = None;
    for part in written.split('+') {
        match part {
            "Ctrl" => modifiers |= Modifiers::COMMAND,
            "Shift" => modifiers |= Modifiers::SHIFT,
            "Esc" => key = Some(Key::Escape),
            name => key = Key::from_name(name),
        }
    }
    key.map(|key| KeyboardShortcut::new(modifiers, key))
}

/// Returns the commands whose shortcuts were pressed. While a dialog or list lies over the window, its keys are its own; Esc cancels
/// work only if it does not close a popup or end the editing of a text.
pub fn pressed_commands(studio: &Studio, ui: &Ui) -> Vec<Command> {
    let has_dialog =
        studio.view.close_question.is_some() || (studio.opened.is_some() && studio.view.browser.is_some());
    if has_dialog {
        return Vec::new();
    }
    let mut all: Vec<(KeyboardShortcut, Command)> =
        list_commands().into_iter().filter_map(|e| Some((parse_shortcut(e.shortcut)?, e.command))).collect();
    all.extend(parse_shortcut("Ctrl+Shift+P").map(|s| (s, Command::Palette)));
    all.extend(parse_shortcut("Ctrl+Shift+Z").map(|s| (s, Command::Redo)));
    all.sort_by_key(|(s, _)| !s.modifiers.shift);
    // the page Text has no plot, and there everyone looks for a word with this key
    let fits_text = studio.view.page == Page::Text && studio.opened.is_some();
    if let Some((_, fit)) = all.iter_mut().find(|(_, command)| fits_text && *command == Command::FitPlot) {
        *fit = Command::FindText;
    }
    let has_palette = studio.view.palette.is_some();
    // the toolkit removes the focus before this frame, so that of the last frame decides to whom Esc belongs
    let is_escape_taken = has_palette
        || studio.view.help.shown.is_some()
        || egui::Popup::is_any_open(ui.ctx())
        || studio.view.had_keyboard_focus;
    all.retain(|(_, command)| match command {
        Command::Palette => true,
        Command::Cancel => !is_escape_taken && studio.can_stop(),
        _ => !has_palette,
    });
    ui.input_mut(|input| {
        let pressed = all.into_iter().filter(|(shortcut, _)| consume(input, shortcut));
        pressed.map(|(_, command)| command).collect()
    })
}

/// Takes a shortcut from the input; returns whether it was pressed. A digit counts by its physical key as well, because with Shift
/// most layouts type another character.
fn consume(input: &mut egui::InputState, shortcut: &KeyboardShortcut) -> bool {
    if input.consume_shortcut(shortcut) {
        return true;
    }
    let is_digit = shortcut.logical_key.name().chars().all(|c| c.is_ascii_digit());
    let is_pressed = |event: &egui::Event| match event {
        egui::Event::Key { physical_key, pressed: true, modifiers, .. } => {
            *physical_key == Some(shortcut.logical_key) && modifiers.matches_exact(shortcut.modifiers)
        }
        _ => false,
    };
    let found = is_digit && input.events.iter().any(is_pressed);
    if found {
        input.events.retain(|event| !is_pressed(event));
    }
    found
}
