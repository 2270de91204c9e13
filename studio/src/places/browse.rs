//! Files and folders in the window: a path, what stands there, and where one was before. Everything by keyboard, too.

use std::path::{Path, PathBuf};

use egui::text::{CCursor, CCursorRange};
use egui::{Key, Modifiers, RichText, Ui};

use crate::browser::{Browser, Item, Kind};
use crate::command::{Command, Purpose};
use crate::noted::List;
use crate::studio::Studio;
use crate::theme::{Theme, space};
use counterpoise_host::files;

/// Width of the window's part that lists where one was before, points.
const PLACES: f32 = 190.0;
/// Width and height of the list, points.
const LIST: [f32; 2] = [530.0, 300.0];
/// Whole width of a browser, points.
pub const WIDTH: f32 = PLACES + LIST[0] + space::MEDIUM;

/// What a browser is shown with.
struct About<'a> {
    theme: Theme,
    refused: Option<&'a str>,
    places: Vec<(String, PathBuf)>,
    present: &'a [PathBuf],
}

/// Shows the browser over the window, where one is open over a project.
pub fn over(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let (Some(browser), true) = (&studio.view.browser, studio.opened.is_some()) else { return };
    let (title, theme) = (title(browser.purpose), studio.view.theme);
    let frame = theme.card().inner_margin(egui::Margin::same(14));
    let shown = egui::Modal::new(egui::Id::unique("browser")).frame(frame).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.label(RichText::new(title).heading());
        ui.add_space(space::MEDIUM);
        inside(studio, ui, queue);
    });
    if shown.should_close() {
        studio.view.browser = None;
    }
}

/// What the browser is open for, in words.
fn title(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Project => "Open or make a project",
        Purpose::SaveAs => "Save the project as",
        Purpose::Recordings => "Add recordings",
        Purpose::Export => "Export the code into a folder",
    }
}

/// Shows the browser where it stands.
pub fn inside(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(mut browser) = studio.view.browser.take() else { return };
    let about = About {
        theme: studio.view.theme,
        refused: studio.refused.as_deref(),
        places: places(studio, browser.purpose),
        present: &studio.jobs.recordings,
    };
    ui.horizontal_top(|ui| {
        ui.vertical(|ui| {
            ui.set_width(PLACES);
            before(ui, &mut browser, queue, &about);
        });
        ui.vertical(|ui| {
            ui.set_width(LIST[0]);
            field(ui, &mut browser, queue, &about);
            ui.add_space(space::SMALL);
            list(ui, &mut browser, queue, &about);
        });
    });
    ui.add_space(space::MEDIUM);
    let stays = buttons(ui, &mut browser, queue, (&about, studio.opened.is_some()));
    studio.view.browser = stays.then_some(browser);
}

/// Where one was before: projects to open, or folders to go to.
fn places(studio: &Studio, purpose: Purpose) -> Vec<(String, PathBuf)> {
    let recent = studio.noted.list(List::Projects);
    let named = |path: &Path| {
        path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
    };
    if purpose == Purpose::Project {
        let name = |path: &PathBuf| match path.parent() {
            Some(folder) if path.ends_with(files::PROJECT_FILE) => named(folder),
            _ => named(path),
        };
        return recent.iter().map(|path| (name(path), path.clone())).collect();
    }
    let mut all = studio.noted.list(List::Folders);
    all.extend(recent.iter().filter_map(|path| path.parent().map(Path::to_owned)));
    all.extend(std::env::var_os("HOME").map(PathBuf::from));
    let mut once: Vec<PathBuf> = Vec::new();
    all.into_iter().for_each(|path| {
        if !once.contains(&path) {
            once.push(path)
        }
    });
    once.into_iter().map(|path| (named(&path), path)).collect()
}

fn before(ui: &mut Ui, browser: &mut Browser, queue: &mut Vec<Command>, about: &About<'_>) {
    let projects = browser.purpose == Purpose::Project;
    let heading = if projects { "Recent projects" } else { "Recent folders" };
    ui.label(RichText::new(heading).small().color(about.theme.weak));
    if about.places.is_empty() {
        ui.label(RichText::new("none yet").small().color(about.theme.weak));
    }
    egui::ScrollArea::vertical().id_salt("places").max_height(LIST[1]).show(ui, |ui| {
        for (name, path) in &about.places {
            let button = egui::Button::selectable(false, placed(name, path, &about.theme))
                .wrap_mode(egui::TextWrapMode::Extend)
                .min_size(egui::vec2(PLACES - space::SMALL, 22.0));
            let shown = ui.add(button);
            shown.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, path.display().to_string())
            });
            if shown.on_hover_text(path.display().to_string()).clicked() {
                match projects {
                    true => queue.push(Command::Open { path: path.clone() }),
                    false => browser.go(path),
                }
            }
        }
    });
}

/// Letters of a path that fit below its name.
const LETTERS: usize = 30;

/// A name over the end of its path.
fn placed(name: &str, path: &Path, theme: &Theme) -> egui::text::LayoutJob {
    let whole = path.parent().unwrap_or(path).display().to_string();
    let most: Vec<char> = whole.chars().collect();
    let end: String = most[most.len().saturating_sub(LETTERS)..].iter().collect();
    let below = if end.len() < whole.len() { format!("\u{2026}{end}") } else { whole };
    let format = |size, colour| egui::TextFormat::simple(egui::FontId::proportional(size), colour);
    let mut job = egui::text::LayoutJob::default();
    job.append(name, 0.0, format(13.0, theme.text));
    job.append(&format!("\n{below}"), 0.0, format(10.0, theme.weak));
    job
}

/// The path, with its keys: up and down choose, Enter takes, and a button goes to the folder above.
fn field(ui: &mut Ui, browser: &mut Browser, queue: &mut Vec<Command>, about: &About<'_>) {
    let id = egui::Id::unique("path of the browser");
    let keys = if ui.memory(|m| m.has_focus(id)) { Keys::taken(ui) } else { Keys::default() };
    browser.step_if(keys.rows);
    ui.horizontal(|ui| {
        if ui.button("Up").on_hover_text("the folder above (Alt+Up)").clicked() || keys.above {
            browser.up();
        }
        let edit = egui::TextEdit::singleline(&mut browser.typed)
            .id(id)
            .hint_text("path of a file or folder")
            .desired_width(f32::INFINITY);
        let field = ui.add(edit);
        let name = title(browser.purpose);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, format!("path: {name}")));
        if field.changed() {
            browser.chosen = None;
        }
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        if entered {
            queue.extend(enter(browser, about));
        }
        let free = ui.memory(|m| m.focused().is_none());
        if std::mem::take(&mut browser.moved) || entered || free {
            to_the_end(ui, id, &browser.typed);
            field.request_focus();
        }
    });
}

/// What the keys ask of the list.
#[derive(Default)]
struct Keys {
    rows: isize,
    above: bool,
}

impl Keys {
    /// Takes the keys that a field of one line has no use for.
    fn taken(ui: &Ui) -> Self {
        ui.input_mut(|i| {
            let mut pressed = |modifiers, key| i.count_and_consume_key(modifiers, key) as isize;
            let above = pressed(Modifiers::ALT, Key::ArrowUp) > 0;
            let (none, page) = (Modifiers::NONE, 10);
            let rows = pressed(none, Key::ArrowDown) - pressed(none, Key::ArrowUp);
            let pages = pressed(none, Key::PageDown) - pressed(none, Key::PageUp);
            Self { rows: rows + page * pages, above }
        })
    }
}

/// Puts the field's cursor behind its text.
fn to_the_end(ui: &Ui, id: egui::Id, text: &str) {
    let mut state = egui::text_edit::TextEditState::load(ui.ctx(), id).unwrap_or_default();
    let end = CCursor::new(text.chars().count());
    state.cursor.set_char_range(Some(CCursorRange::one(end)));
    state.store(ui.ctx(), id);
}

/// Enter: the chosen item; else what stands ready; else the only item that is left.
fn enter(browser: &mut Browser, about: &About<'_>) -> Option<Command> {
    let shown: Vec<Item> = browser.shown().into_iter().cloned().collect();
    if let Some(item) = browser.chosen.and_then(|k| shown.get(k)) {
        return browser.take(item);
    }
    match (browser.ready(), shown.as_slice()) {
        (Ok((words, _)), _) if words == "Replace" => None,
        (Ok((_, command)), _) => Some(with_present(command, about)),
        (Err(_), [only]) => browser.take(only),
        (Err(_), _) => None,
    }
}

/// Recordings are added to those that are there.
fn with_present(command: Command, about: &About<'_>) -> Command {
    let Command::Recordings { paths } = command else { return command };
    let mut all = about.present.to_vec();
    paths.into_iter().for_each(|path| {
        if !all.contains(&path) {
            all.push(path)
        }
    });
    Command::Recordings { paths: all }
}

fn list(ui: &mut Ui, browser: &mut Browser, queue: &mut Vec<Command>, about: &About<'_>) {
    let shown: Vec<Item> = browser.shown().into_iter().cloned().collect();
    let frame = egui::Frame::new().fill(about.theme.ground).corner_radius(4).inner_margin(4);
    frame.show(ui, |ui| {
        let area = egui::ScrollArea::vertical().id_salt("list").auto_shrink(false);
        area.max_height(LIST[1] - 34.0).min_scrolled_height(120.0).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            if let Some(why) = browser.trouble() {
                ui.label(RichText::new(why).small().color(about.theme.warn));
            } else if shown.is_empty() {
                let text = if browser.listing.is_some() { "nothing here that fits" } else { "looking" };
                ui.label(RichText::new(text).small().color(about.theme.weak));
            }
            for (k, item) in shown.iter().enumerate() {
                if row(ui, browser, item, browser.chosen == Some(k), &about.theme) {
                    queue.extend(browser.take(item));
                }
            }
        });
    });
}

/// One item; says whether it was clicked.
fn row(ui: &mut Ui, browser: &Browser, item: &Item, chosen: bool, theme: &Theme) -> bool {
    let ticked = browser.picked.contains(&item.path);
    let (text, colour, right) = match item.kind {
        Kind::Project => (format!("{}/", item.name), theme.text, "project".to_owned()),
        Kind::Folder => (format!("{}/", item.name), theme.weak, String::new()),
        Kind::File => (item.name.clone(), theme.text, size(item.bytes)),
    };
    let right = if ticked { format!("{right}   chosen") } else { right };
    let colour = if ticked { theme.accent } else { colour };
    let button = egui::Button::selectable(chosen || ticked, RichText::new(text).color(colour))
        .right_text(RichText::new(right).small().color(theme.weak))
        .truncate()
        .min_size(egui::vec2(ui.available_width(), 22.0));
    let response = ui.add(button);
    if chosen {
        response.scroll_to_me(None);
    }
    response.clicked()
}

fn size(bytes: u64) -> String {
    match bytes {
        0..1000 => format!("{bytes} B"),
        1000..1_000_000 => format!("{:.0} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// What can be done with the path; says whether the browser stays open.
fn buttons(
    ui: &mut Ui,
    browser: &mut Browser,
    queue: &mut Vec<Command>,
    (about, closes): (&About<'_>, bool),
) -> bool {
    let (ready, free) = (browser.ready(), browser.free());
    let mut stays = true;
    let row = egui::vec2(ui.available_width(), 26.0);
    ui.allocate_ui_with_layout(row, egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let words = ready.as_ref().map_or_else(|_| word(browser.purpose), |(words, _)| words.as_str());
        let main = ui.add_enabled(ready.is_ok(), egui::Button::new(words));
        let all = ui.input(|i| i.modifiers.command && i.key_pressed(Key::Enter));
        if let (true, Ok((_, command))) = (main.clicked() || all, &ready) {
            queue.push(with_present(command.clone(), about));
        }
        if browser.purpose == Purpose::Project {
            let make = ui.add_enabled(free.is_some(), egui::Button::new("New project here"));
            let make = make.on_hover_text("a folder with a complete machine to start from");
            if let (true, Some(folder)) = (make.clicked(), &free) {
                queue.push(Command::New { folder: folder.clone() });
            }
        }
        if closes && ui.button("Cancel").on_hover_text("Esc").clicked() {
            stays = false;
        }
        let (said, colour) = match (about.refused, &ready) {
            (Some(why), _) => (why, about.theme.bad),
            (None, Ok((words, _))) if words == "Replace" => {
                ("a project is there already; it would be replaced", about.theme.warn)
            }
            (None, Ok(_)) => ("", about.theme.weak),
            (None, Err(_)) if free.is_some() && !browser.start().is_empty() => {
                ("nothing is there yet; a new project can be made", about.theme.weak)
            }
            (None, Err(why)) => (*why, about.theme.weak),
        };
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            let label = egui::Label::new(RichText::new(said).small().color(colour)).truncate();
            ui.add(label).on_hover_text(said);
        });
    });
    stays
}

/// The word on the button while nothing stands ready.
fn word(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Project => "Open",
        Purpose::SaveAs => "Save",
        Purpose::Recordings => "Add",
        Purpose::Export => "Export here",
    }
}
