//! The toolbar: files, pages, the open project, and units.

use egui::{RichText, Ui};

use crate::command::{BrowsePurpose, Command, Page, list_commands};
use crate::studio::{OpenProject, Studio};
use crate::theme::space;
use crate::units::{AngleUnit, FrequencyUnit, GainUnit};

/// Width from which the toolbar has room for the name of the program, points.
const WIDE: f32 = 1500.0;
/// Width of the choice of a configuration, points.
const CONFIGURATION_WIDTH: f32 = 96.0;

/// Shows the toolbar.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.horizontal(|ui| {
        // in a narrow window the project's name is worth more than that of the program, which is in the window's title
        if ui.available_width() > WIDE {
            ui.label(RichText::new("Counterpoise").strong().size(15.0));
            ui.add_space(space::SMALL);
        }
        show_file_menu(ui, studio, queue);
        ui.add_space(space::SMALL);
        for page in Page::ALL {
            let is_current = studio.view.page == page;
            let colour = if is_current { theme.accent } else { theme.text };
            let text = RichText::new(page.name()).color(colour);
            if ui.selectable_label(is_current, text).clicked() {
                queue.push(Command::Go { page });
            }
        }
        ui.add_space(space::MEDIUM);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            show_tools(studio, ui, queue);
            if let Some(opened) = &studio.opened {
                show_configurations(ui, opened, queue);
                show_save_state(studio, ui, opened);
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let name = opened.session.project().map_or("project", |p| p.plant.name.as_str());
                    ui.add(egui::Label::new(RichText::new(name).color(theme.weak)).truncate())
                        .on_hover_text(format!("{name}\n{}", opened.path.display()));
                });
            }
        });
    });
}

/// Shows whether everything is saved, and kept against a crash.
fn show_save_state(studio: &Studio, ui: &mut Ui, opened: &OpenProject) {
    let theme = studio.view.theme;
    if studio.file_queue.is_saving() {
        ui.label(RichText::new("saving\u{2026}").small().color(theme.accent));
    } else if opened.is_read_only() {
        ui.label(RichText::new("read-only").small().color(theme.warn));
    } else if opened.session.is_changed() {
        ui.label(RichText::new("edited").small().color(theme.warn)).on_hover_text("Ctrl+S saves");
    }
    if let Some(why) = &studio.journal_error {
        ui.label(RichText::new("no journal").small().color(theme.bad))
            .on_hover_text(format!("edits are not kept against a crash: {why}"));
    }
}

/// Shows the menu of commands that concern files, with their shortcuts.
fn show_file_menu(ui: &mut Ui, studio: &Studio, queue: &mut Vec<Command>) {
    let browse = |purpose| Command::Browse { purpose };
    let groups = [
        vec![browse(BrowsePurpose::Project), Command::Save, browse(BrowsePurpose::SaveAs), Command::Reload],
        vec![
            browse(BrowsePurpose::Recordings),
            Command::Export,
            browse(BrowsePurpose::Export),
            browse(BrowsePurpose::Report),
            browse(BrowsePurpose::PlotFile),
        ],
        vec![Command::AskClose],
    ];
    let all = list_commands();
    let file = egui::Button::new("File").frame_when_inactive(false);
    egui::containers::menu::MenuButton::from_button(file).ui(ui, |ui| {
        ui.set_min_width(380.0);
        for (k, group) in groups.iter().enumerate() {
            if k > 0 {
                ui.separator();
            }
            for entry in group.iter().filter_map(|command| all.iter().find(|e| e.command == *command)) {
                let shortcut = RichText::new(entry.shortcut).small().weak();
                let button = egui::Button::new(entry.name.as_ref()).right_text(shortcut);
                let is_enabled = studio.opened.is_some() || entry.command == groups[0][0];
                if ui.add_enabled(is_enabled, button).clicked() {
                    queue.push(entry.command.clone());
                    ui.close();
                }
            }
        }
    });
}

/// Shows for which configuration of the mechanism the controller is designed, if there are several.
fn show_configurations(ui: &mut Ui, opened: &OpenProject, queue: &mut Vec<Command>) {
    const KEY: &str = "model.configuration";
    let Some(project) = opened.session.project().filter(|p| !p.plant.configurations.is_empty()) else {
        return;
    };
    let now = project.model.configuration.clone();
    let shown = now.clone().unwrap_or_else(|| "as written".to_owned());
    let combo = egui::ComboBox::from_id_salt("configuration").selected_text(shown).width(CONFIGURATION_WIDTH);
    let shown = combo.show_ui(ui, |ui| {
        if ui.selectable_label(now.is_none(), "as written").clicked() && now.is_some() {
            queue.push(Command::Remove { path: KEY.to_owned() });
        }
        for one in &project.plant.configurations {
            if ui.selectable_label(now.as_deref() == Some(one.name.as_str()), &one.name).clicked() {
                queue.push(Command::SetText { path: KEY.to_owned(), value: one.name.clone() });
            }
        }
    });
    shown.response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "configuration of the mechanism")
    });
}

/// A button of the toolbar.
struct Tool {
    text: &'static str,
    hint: &'static str,
    command: Command,
    is_enabled: bool,
}

/// Shows undo and redo, units, theme and the command palette, from the right to the left.
fn show_tools(studio: &Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let units = &studio.view.units;
    let available =
        studio.opened.as_ref().map(|opened| opened.session.undo_availability()).unwrap_or_default();
    let tool = |text, hint, command| Tool { text, hint, command, is_enabled: true };
    let frequency = if units.frequency == FrequencyUnit::Hertz { "Hz" } else { "rad/s" };
    let gain = if units.gain == GainUnit::Decibel { "dB" } else { "abs" };
    let angle = if units.angle == AngleUnit::Milliradian { "mrad" } else { "deg" };
    let settings = [
        tool("?", "Help: what is under the pointer, terms, and what can be done here (F1)", Command::Help),
        tool("Commands", "Every command, by name (Ctrl+K)", Command::Palette),
        tool("Theme", "Light or dark (Ctrl+T)", Command::ToggleTheme),
        tool(angle, "Angles in mrad or degrees (Ctrl+G)", Command::ToggleAngle),
        tool(gain, "Gains in dB or absolute (Ctrl+B)", Command::ToggleGain),
        tool(frequency, "Frequencies in Hz or rad/s (Ctrl+H)", Command::ToggleFrequency),
    ];
    let history = [
        Tool { is_enabled: available.redo, ..tool("Redo", "Ctrl+Y", Command::Redo) },
        Tool { is_enabled: available.undo, ..tool("Undo", "Ctrl+Z", Command::Undo) },
    ];
    let mut show_tool = |ui: &mut Ui, tool: Tool| {
        let widget = egui::Button::new(tool.text).frame_when_inactive(false);
        if ui.add_enabled(tool.is_enabled, widget).on_hover_text(tool.hint).clicked() {
            queue.push(tool.command);
        }
    };
    settings.into_iter().for_each(|tool| show_tool(ui, tool));
    ui.separator();
    history.into_iter().for_each(|tool| show_tool(ui, tool));
}
