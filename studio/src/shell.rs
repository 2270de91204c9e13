//! The window around the places: the bar, the messages, the list of commands, shortcuts, files that are dropped.

use egui::{Key, KeyboardShortcut, Modifiers, RichText, Ui};

use crate::command::{Command, Place, Purpose, entries};
use crate::jobs::Copy;
use crate::results::Age;
use crate::studio::Studio;
use crate::theme::{Theme, space};
use crate::view::{AngleUnit, FrequencyUnit, GainUnit, Tone};
use crate::{palette, places};

/// Shows the studio and carries out what was asked of it in this frame.
pub fn show(studio: &mut Studio, ui: &mut Ui) {
    let theme = studio.view.theme;
    let mut queue = shortcuts(studio, ui);
    queue.extend(dropped(ui));
    egui::Panel::top("bar")
        .frame(egui::Frame::new().fill(theme.card).inner_margin(egui::Margin::symmetric(12, 7)))
        .show(ui, |ui| bar(studio, ui, &mut queue));
    egui::Panel::bottom("foot")
        .frame(egui::Frame::new().fill(theme.card).inner_margin(egui::Margin::symmetric(12, 4)))
        .show(ui, |ui| foot(studio, ui, &mut queue));
    let ground = egui::Frame::new().fill(theme.ground).inner_margin(egui::Margin::same(space::MEDIUM as i8));
    egui::CentralPanel::default().frame(ground).show(ui, |ui| {
        if let (None, Some(path)) = (&studio.opened, studio.filing.opening()) {
            let path = path.display().to_string();
            return places::parts::empty(ui, &theme, "Opening", &path);
        }
        if studio.opened.is_none() {
            places::welcome::show(studio, ui, &mut queue);
            return;
        }
        outside(studio, ui, &mut queue);
        match studio.view.place {
            Place::Plant => places::plant::show(studio, ui, &mut queue),
            Place::Reduce => places::reduce::show(studio, ui, &mut queue),
            Place::Design => places::design::show(studio, ui, &mut queue),
            Place::Verify => places::verify::show(studio, ui, &mut queue),
            Place::Diagnose => places::diagnose::show(studio, ui, &mut queue),
        }
    });
    places::browse::over(studio, ui, &mut queue);
    palette::show(studio, ui, &mut queue);
    match studio.copied.take() {
        Some(Copy::Text(text)) => ui.ctx().copy_text(text),
        Some(Copy::Pixels(image)) => ui.ctx().copy_image(egui::ColorImage::clone(&image)),
        None => {}
    }
    for command in queue {
        resize(ui, &command);
        studio.run(&command);
    }
}

fn bar(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Counterpoise").strong().size(15.0));
        ui.add_space(space::SMALL);
        menu(ui, studio.opened.is_some(), queue);
        ui.add_space(space::SMALL);
        for place in Place::ALL {
            let chosen = studio.view.place == place;
            let text = RichText::new(place.name()).color(if chosen { theme.accent } else { theme.text });
            if ui.selectable_label(chosen, text).clicked() {
                queue.push(Command::Go { place });
            }
        }
        ui.add_space(space::LARGE);
        if let Some(opened) = &studio.opened {
            let name = opened.session.project().map_or("project", |p| p.plant.name.as_str());
            ui.label(RichText::new(name).color(theme.weak));
            configurations(ui, opened, queue);
            standing(studio, ui, opened);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| tools(studio, ui, queue));
    });
}

/// Whether everything is saved, and kept against a crash.
fn standing(studio: &Studio, ui: &mut Ui, opened: &crate::studio::Opened) {
    let theme = studio.view.theme;
    if studio.filing.is_saving() {
        ui.label(RichText::new("saving\u{2026}").small().color(theme.accent));
    } else if opened.session.is_changed() {
        ui.label(RichText::new("edited").small().color(theme.warn)).on_hover_text("Ctrl+S saves");
    }
    if let Some(why) = &studio.troubled {
        ui.label(RichText::new("no journal").small().color(theme.bad))
            .on_hover_text(format!("edits are not kept against a crash: {why}"));
    }
}

/// What concerns files, with its shortcuts.
fn menu(ui: &mut Ui, is_open: bool, queue: &mut Vec<Command>) {
    let browse = |purpose| Command::Browse { purpose };
    let groups = [
        vec![browse(Purpose::Project), Command::Save, browse(Purpose::SaveAs), Command::Reload],
        vec![browse(Purpose::Recordings), Command::Export, browse(Purpose::Export)],
        vec![Command::Close],
    ];
    let all = entries();
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
                if ui.add_enabled(is_open || entry.command == groups[0][0], button).clicked() {
                    queue.push(entry.command.clone());
                    ui.close();
                }
            }
        }
    });
}

/// Which configuration of the mechanism is designed for, where it has several.
fn configurations(ui: &mut Ui, opened: &crate::studio::Opened, queue: &mut Vec<Command>) {
    const KEY: &str = "model.configuration";
    let Some(project) = opened.session.project().filter(|p| !p.plant.configurations.is_empty()) else {
        return;
    };
    let now = project.model.configuration.clone();
    let shown = now.clone().unwrap_or_else(|| "as written".to_owned());
    let boxed = egui::ComboBox::from_id_salt("configuration").selected_text(shown).width(120.0);
    let shown = boxed.show_ui(ui, |ui| {
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

fn tools(studio: &Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let view = &studio.view;
    let (undo, redo) = studio.opened.as_ref().map_or((false, false), |o| o.session.can());
    let frequency = if view.frequency == FrequencyUnit::Hertz { "Hz" } else { "rad/s" };
    let gain = if view.gain == GainUnit::Decibel { "dB" } else { "abs" };
    let mut button = |ui: &mut Ui, text: &str, hint: &str, enabled, command: Command| {
        let widget = egui::Button::new(text).frame_when_inactive(false);
        if ui.add_enabled(enabled, widget).on_hover_text(hint).clicked() {
            queue.push(command);
        }
    };
    button(ui, "Commands", "Every command, by name (Ctrl+K)", true, Command::Palette);
    button(ui, "Theme", "Light or dark (Ctrl+T)", true, Command::ToggleTheme);
    let angle = if view.angle == AngleUnit::Milliradian { "mrad" } else { "deg" };
    button(ui, angle, "Angles in mrad or degrees (Ctrl+G)", true, Command::ToggleAngle);
    button(ui, gain, "Gains in dB or absolute (Ctrl+B)", true, Command::ToggleGain);
    button(ui, frequency, "Frequencies in Hz or rad/s (Ctrl+H)", true, Command::ToggleFrequency);
    ui.separator();
    button(ui, "Redo", "Ctrl+Y", redo, Command::Redo);
    button(ui, "Undo", "Ctrl+Z", undo, Command::Undo);
}

fn foot(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    ui.horizontal(|ui| {
        ui.set_height(20.0);
        let (text, colour) = state(studio, &theme);
        let (dot, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 4.0, colour);
        let said = ui.label(RichText::new(text).small());
        if let Some(of) = &studio.results.live {
            let took = of.value.took.as_secs_f64() * 1e3;
            said.on_hover_text(format!("the design shown and its responses took {took:.1} ms"));
        }
        if studio.can_stop() && ui.small_button("Stop").on_hover_text("Esc").clicked() {
            queue.push(Command::Cancel);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if let Some(notice) = studio.view.notice.clone() {
                let colour = if notice.tone == Tone::Wrong { theme.bad } else { theme.weak };
                if ui.small_button("x").on_hover_text("close this message").clicked() {
                    studio.view.notice = None;
                }
                ui.add(egui::Label::new(RichText::new(&notice.text).small().color(colour)).truncate())
                    .on_hover_text(&notice.text);
            }
        });
    });
}

/// What is running or stale, in words.
fn state(studio: &Studio, theme: &Theme) -> (String, egui::Color32) {
    if let Some(path) = studio.filing.opening() {
        return (format!("opening {}", path.display()), theme.accent);
    }
    let Some(opened) = &studio.opened else { return ("no project".to_owned(), theme.weak) };
    let revision = opened.session.revision();
    if studio.diagnosis().diagnose.is_busy() {
        return (format!("diagnosing: {}", studio.diagnosis().progress()), theme.accent);
    }
    if opened.session.project().is_some_and(|p| p.synth.is_none()) && opened.session.errors().is_empty() {
        return ("a model without a controller: the project has no section [synth]".to_owned(), theme.weak);
    }
    if studio.results.why_not(revision).is_some() {
        return ("no controller for this project; the last good design is shown".to_owned(), theme.bad);
    }
    let jobs = studio.diagnosis();
    if jobs.export.is_busy() {
        return ("writing the code".to_owned(), theme.accent);
    }
    if jobs.measure.is_busy() {
        return (format!("measuring: {}", jobs.measuring()), theme.accent);
    }
    if studio.results.verifying {
        return ("verifying on the full plant".to_owned(), theme.accent);
    }
    match &studio.results.verified {
        Some(of) if Age::of(of.revision, revision) == Age::Fresh => {
            let (holds, fails, open) = of.value.verification().counts();
            let colour = if fails == 0 { theme.good } else { theme.bad };
            let rest = if open > 0 { format!(", {open} not applicable") } else { String::new() };
            (format!("verified: {holds} requirements hold, {fails} fail{rest}"), colour)
        }
        _ => ("not verified yet".to_owned(), theme.warn),
    }
}

/// A file that somebody else changed.
fn outside(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let theme = studio.view.theme;
    let Some(opened) = studio.opened.as_mut().filter(|o| o.changed_outside) else { return };
    theme.card().show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new("The project file was changed by another program.").color(theme.warn));
            if ui.button("Read it again").clicked() {
                queue.push(Command::Reload);
            }
            if ui.button("Keep what is here").clicked() {
                opened.changed_outside = false;
            }
        });
    });
    ui.add_space(space::SMALL);
}

/// A shortcut as it is written.
pub fn shortcut(written: &str) -> Option<KeyboardShortcut> {
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

/// Shortcuts; while a list lies over the window its keys are its own, and Esc is taken only where there is something to stop.
fn shortcuts(studio: &Studio, ui: &Ui) -> Vec<Command> {
    if studio.opened.is_some() && studio.view.browser.is_some() {
        return Vec::new();
    }
    let mut all: Vec<(KeyboardShortcut, Command)> =
        entries().into_iter().filter_map(|e| Some((shortcut(e.shortcut)?, e.command))).collect();
    all.extend(shortcut("Ctrl+Shift+P").map(|s| (s, Command::Palette)));
    all.extend(shortcut("Ctrl+Shift+Z").map(|s| (s, Command::Redo)));
    all.sort_by_key(|(s, _)| !s.modifiers.shift);
    let is_listing = studio.view.palette.is_some();
    all.retain(|(_, command)| match command {
        Command::Palette => true,
        Command::Cancel => !is_listing && studio.can_stop(),
        _ => !is_listing,
    });
    ui.input_mut(|input| all.into_iter().filter(|(s, _)| input.consume_shortcut(s)).map(|(_, c)| c).collect())
}

/// A project or recordings that were dropped on the window.
fn dropped(ui: &Ui) -> Vec<Command> {
    let paths: Vec<_> = ui.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_path_buf()).collect());
    let is_project = |p: &std::path::PathBuf| {
        counterpoise_host::files::project_file(p).is_file()
            && (p.is_dir() || p.extension().is_some_and(|e| e == "toml"))
    };
    match paths.iter().find(|p| is_project(p)) {
        Some(path) => vec![Command::Open { path: path.clone() }],
        None if paths.is_empty() => Vec::new(),
        None => vec![Command::Go { place: Place::Diagnose }, Command::Recordings { paths }],
    }
}

/// Makes everything larger or smaller.
fn resize(ui: &Ui, command: &Command) {
    match command {
        Command::Larger => egui::gui_zoom::zoom_in(ui.ctx()),
        Command::Smaller => egui::gui_zoom::zoom_out(ui.ctx()),
        _ => {}
    }
}
