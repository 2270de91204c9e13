//! The file browser: a path, what stands there, and recent places; everything can be done by keyboard.

use std::path::{Path, PathBuf};

use counterpoise_project::starters::StarterKind;
use egui::text::{CCursor, CCursorRange};
use egui::{Key, Modifiers, RichText, Ui};

use super::recent_places::{self, RecentPlace, list_recent_places, show_recent_places};
use crate::browser::{Browser, BrowserAction};
use crate::command::{BrowsePurpose, Command};
use crate::examples::EXAMPLES;
use crate::studio::Studio;
use crate::theme::{WindowTheme, space};
use counterpoise_host::folders::{FolderItem, ItemKind};

/// Width and height of the list, points.
const LIST: [f32; 2] = [530.0, 300.0];
/// Whole width of a browser, points.
pub const WIDTH: f32 = recent_places::WIDTH + LIST[0] + space::MEDIUM;

/// The context that the browser is shown in.
struct BrowserContext<'a> {
    theme: WindowTheme,
    open_error: Option<&'a str>,
    places: Vec<RecentPlace>,
    added_recordings: &'a [PathBuf],
    can_close: bool,
}

/// Shows the browser over the window if one is open over a project.
pub fn show_over_page(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let (Some(browser), true) = (&studio.view.browser, studio.opened.is_some()) else { return };
    let (title, theme) = (title(browser.purpose), studio.view.theme);
    let frame = theme.card().inner_margin(egui::Margin::same(14));
    let shown = egui::Modal::new(egui::Id::unique("browser")).frame(frame).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.label(RichText::new(title).heading());
        ui.add_space(space::MEDIUM);
        show_content(studio, ui, queue);
    });
    if shown.should_close() {
        studio.view.browser = None;
    }
}

/// Returns what the browser is open for, in words.
fn title(purpose: BrowsePurpose) -> &'static str {
    match purpose {
        BrowsePurpose::Project => "Open or make a project",
        BrowsePurpose::SaveAs => "Save the project as",
        BrowsePurpose::Recordings => "Add recordings",
        BrowsePurpose::Export => "Export the code into a folder",
        BrowsePurpose::PlotFile => "Save the plot as SVG, PNG or CSV",
        BrowsePurpose::Report => "Write the report as HTML",
    }
}

/// Shows the content of the browser.
pub fn show_content(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(mut browser) = studio.view.browser.take() else { return };
    let about = BrowserContext {
        theme: studio.view.theme,
        open_error: studio.open_error.as_deref(),
        places: list_recent_places(studio, browser.purpose),
        added_recordings: &studio.jobs.recordings,
        can_close: studio.opened.is_some(),
    };
    ui.horizontal_top(|ui| {
        ui.vertical(|ui| {
            ui.set_width(recent_places::WIDTH);
            show_recent_places(ui, &mut browser, queue, &about.theme, &about.places);
        });
        ui.vertical(|ui| {
            ui.set_width(LIST[0]);
            show_path_field(ui, &mut browser, queue, &about);
            ui.add_space(space::SMALL);
            show_list(ui, &mut browser, queue, &about);
        });
    });
    ui.add_space(space::MEDIUM);
    let choice = show_buttons(ui, &browser, queue, &about);
    studio.view.browser = (choice == BrowserChoice::Stay).then_some(browser);
}

/// Shows the path: up and down select, Enter activates, and a button goes to the folder above.
fn show_path_field(ui: &mut Ui, browser: &mut Browser, queue: &mut Vec<Command>, about: &BrowserContext<'_>) {
    let id = egui::Id::unique("path of the browser");
    let keys = if ui.memory(|m| m.has_focus(id)) { ListKeys::take(ui) } else { ListKeys::default() };
    browser.move_selection(keys.rows);
    ui.horizontal(|ui| {
        if ui.button("Up").on_hover_text("the folder above (Alt+Up)").clicked() || keys.above {
            browser.go_up();
        }
        let edit = egui::TextEdit::singleline(&mut browser.typed)
            .id(id)
            .hint_text("path of a file or folder")
            .desired_width(f32::INFINITY);
        let field = ui.add(edit);
        let name = title(browser.purpose);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, format!("path: {name}")));
        if field.changed() {
            browser.selected = None;
        }
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        if entered {
            queue.extend(command_of_enter(browser, about));
        }
        let free = ui.memory(|m| m.focused().is_none());
        if std::mem::take(&mut browser.is_text_replaced) || entered || free {
            move_cursor_to_end(ui, id, &browser.typed);
            field.request_focus();
        }
    });
}

/// The action of the keys on the list.
#[derive(Default)]
struct ListKeys {
    rows: isize,
    above: bool,
}

impl ListKeys {
    /// Takes the keys that a field of one line has no use for.
    fn take(ui: &Ui) -> Self {
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

/// Moves the field's cursor behind its text.
fn move_cursor_to_end(ui: &Ui, id: egui::Id, text: &str) {
    let mut state = egui::text_edit::TextEditState::load(ui.ctx(), id).unwrap_or_default();
    let end = CCursor::new(text.chars().count());
    state.cursor.set_char_range(Some(CCursorRange::one(end)));
    state.store(ui.ctx(), id);
}

/// Returns what Enter does: it activates the selected item, or presses the button, or activates the only item in the list.
fn command_of_enter(browser: &mut Browser, about: &BrowserContext<'_>) -> Option<Command> {
    let shown: Vec<FolderItem> = browser.visible_items().into_iter().cloned().collect();
    if let Some(item) = browser.selected.and_then(|k| shown.get(k)) {
        return browser.activate(item);
    }
    match (browser.action(), shown.as_slice()) {
        (Ok(action), _) if action.is_replacement() => None,
        (Ok(action), _) => Some(with_added_recordings(action.command, about)),
        (Err(_), [only]) => browser.activate(only),
        (Err(_), _) => None,
    }
}

/// Adds recordings to those that are already in the list; any other command stays as it is.
fn with_added_recordings(command: Command, about: &BrowserContext<'_>) -> Command {
    let Command::Recordings { paths } = command else { return command };
    let mut all = about.added_recordings.to_vec();
    paths.into_iter().for_each(|path| {
        if !all.contains(&path) {
            all.push(path)
        }
    });
    Command::Recordings { paths: all }
}

fn show_list(ui: &mut Ui, browser: &mut Browser, queue: &mut Vec<Command>, about: &BrowserContext<'_>) {
    let shown: Vec<FolderItem> = browser.visible_items().into_iter().cloned().collect();
    let frame = egui::Frame::new().fill(about.theme.ground).corner_radius(4).inner_margin(4);
    frame.show(ui, |ui| {
        let area = egui::ScrollArea::vertical().id_salt("list").auto_shrink(false);
        area.max_height(LIST[1] - 34.0).min_scrolled_height(120.0).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            if let Some(why) = browser.error() {
                ui.label(RichText::new(why).small().color(about.theme.warn));
            } else if shown.is_empty() {
                let text = if browser.listing.is_some() { "nothing here that fits" } else { "reading" };
                ui.label(RichText::new(text).small().color(about.theme.weak));
            }
            for (k, item) in shown.iter().enumerate() {
                if show_item(ui, browser, item, k, &about.theme).clicked() {
                    queue.extend(browser.activate(item));
                }
            }
        });
    });
}

/// Shows one item as a button.
fn show_item(
    ui: &mut Ui,
    browser: &Browser,
    item: &FolderItem,
    row: usize,
    theme: &WindowTheme,
) -> egui::Response {
    let is_selected = browser.selected == Some(row);
    let is_ticked = browser.picked.contains(&item.path);
    let (text, colour, right) = match item.kind {
        ItemKind::Project => (format!("{}/", item.name), theme.text, "project".to_owned()),
        ItemKind::Folder => (format!("{}/", item.name), theme.weak, String::new()),
        ItemKind::File => (item.name.clone(), theme.text, size_in_words(item.bytes)),
    };
    let right = if is_ticked { format!("{right}   chosen") } else { right };
    let colour = if is_ticked { theme.accent } else { colour };
    let button = egui::Button::selectable(is_selected || is_ticked, RichText::new(text).color(colour))
        .right_text(RichText::new(right).small().color(theme.weak))
        .truncate()
        .min_size(egui::vec2(ui.available_width(), 22.0));
    let response = ui.add(button);
    if is_selected {
        response.scroll_to_me(None);
    }
    response
}

fn size_in_words(bytes: u64) -> String {
    match bytes {
        0..1000 => format!("{bytes} B"),
        1000..1_000_000 => format!("{:.0} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// The state of the browser: it stays open or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BrowserChoice {
    Stay,
    Cancel,
}

/// Shows what can be done with the path.
fn show_buttons(
    ui: &mut Ui,
    browser: &Browser,
    queue: &mut Vec<Command>,
    about: &BrowserContext<'_>,
) -> BrowserChoice {
    let (action, new_folder) = (browser.action(), browser.new_project_folder());
    let mut choice = BrowserChoice::Stay;
    let row = egui::vec2(ui.available_width(), 26.0);
    ui.allocate_ui_with_layout(row, egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let label = action.as_ref().map_or_else(|_| button_word(browser.purpose), |a| a.label.as_str());
        let main = ui.add_enabled(action.is_ok(), egui::Button::new(label));
        let is_confirmed = ui.input(|i| i.modifiers.command && i.key_pressed(Key::Enter));
        if let (true, Ok(action)) = (main.clicked() || is_confirmed, &action) {
            queue.push(with_added_recordings(action.command.clone(), about));
        }
        if browser.purpose == BrowsePurpose::Project {
            let make = ui.add_enabled(new_folder.is_some(), egui::Button::new("New project here"));
            let make = make.on_hover_text("a folder with a complete machine to start from");
            if let (true, Some(folder)) = (make.clicked(), &new_folder) {
                queue.push(Command::New { folder: folder.clone(), like: None });
            }
            queue.extend(new_of_a_kind(ui, new_folder.as_ref()));
            queue.extend(copy_of_example(ui, &browser.folder()));
        }
        if about.can_close && ui.button("Cancel").on_hover_text("Esc").clicked() {
            choice = BrowserChoice::Cancel;
        }
        let (text, colour) = path_remark(browser, &action, about);
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            let label = egui::Label::new(RichText::new(text).small().color(colour)).truncate();
            ui.add(label).on_hover_text(text);
        });
    });
    choice
}

/// Offers every kind of machine, each a file of a few values that leaves the weights to the first design; returns the command of a chosen
/// one.
fn new_of_a_kind(ui: &mut Ui, folder: Option<&PathBuf>) -> Option<Command> {
    let mut chosen = None;
    ui.add_enabled_ui(folder.is_some(), |ui| {
        ui.menu_button("New, like ...", |ui| {
            for kind in StarterKind::ALL {
                if ui.button(kind.name()).clicked() {
                    chosen = Some(kind.name().to_owned());
                    ui.close();
                }
            }
        });
    });
    Some(Command::New { folder: folder?.clone(), like: Some(chosen?) })
}

/// Offers the examples, of which a copy is written into a folder; returns the command of a chosen one.
fn copy_of_example(ui: &mut Ui, folder: &Path) -> Option<Command> {
    let mut chosen = None;
    ui.menu_button("Example ...", |ui| {
        for example in EXAMPLES {
            if ui.button(example.title).on_hover_text(example.summary).clicked() {
                chosen = Some(example.name.to_owned());
                ui.close();
            }
        }
    });
    Some(Command::CopyExample { example: chosen?, folder: folder.to_owned() })
}

/// Returns what is to be said about the path, with its colour.
fn path_remark<'a>(
    browser: &Browser,
    action: &Result<BrowserAction, &'a str>,
    about: &BrowserContext<'a>,
) -> (&'a str, egui::Color32) {
    let theme = &about.theme;
    match (about.open_error, action) {
        (Some(why), _) => (why, theme.bad),
        (None, Ok(action)) if action.is_replacement() && browser.purpose == BrowsePurpose::SaveAs => {
            ("a project is there already; it would be replaced", theme.warn)
        }
        (None, Ok(action)) if action.is_replacement() => {
            ("a file is there already; it would be replaced", theme.warn)
        }
        (None, Ok(_)) => ("", theme.weak),
        (None, Err(_)) if browser.new_project_folder().is_some() && !browser.search_text().is_empty() => {
            ("nothing is there yet; a new project can be made", theme.weak)
        }
        (None, Err(why)) => (why, theme.weak),
    }
}

/// Returns the word on the button while it can do nothing.
fn button_word(purpose: BrowsePurpose) -> &'static str {
    match purpose {
        BrowsePurpose::Project => "Open",
        BrowsePurpose::SaveAs => "Save",
        BrowsePurpose::Recordings => "Add",
        BrowsePurpose::Export => "Export here",
        BrowsePurpose::PlotFile | BrowsePurpose::Report => "Save",
    }
}
