//! The page Text: the project file as text with its errors in place, so that a broken file is corrected in the window.
//!
//! What is typed is an edit like every other: it goes to the journal, is undone, and the design follows.

use counterpoise_project::Diagnostic;
use egui::text::{CCursor, CCursorRange};
use egui::{
    Align, Color32, FontId, Galley, Id, Margin, Pos2, Rect, RichText, Stroke, TextBuffer, TextEdit, Ui, pos2,
    vec2,
};

use super::text_colours::{LETTER_SIZE, LINE_HEIGHT, coloured_text};
use super::widgets;
use crate::command::Command;
use crate::editing::key_path::key_path_at;
use crate::editing::key_reference::find_key;
use crate::editing::session::Session;
use crate::editing::text_change::TextChange;
use crate::studio::{OpenProject, Studio};
use crate::theme::{WindowTheme, space};
use crate::tolerance::TYPING_PAUSE_S;
use crate::view::{StudioView, TextPlace, TypedPlace};

/// Width of the panel with errors, search and the key at the cursor, points.
const SIDE_WIDTH: f32 = 330.0;
/// Width of the column with the numbers of the lines, points.
const GUTTER: f32 = 46.0;
/// Space to the right of the longest line, points: a message about it begins there.
const RIGHT_SPACE: f32 = 360.0;

fn editor_id() -> Id {
    Id::unique("text of the project")
}

/// Shows the page.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let view = &mut studio.view;
    let session = &opened.session;
    follow_changes(view, session);
    let cursor = cursor_byte(ui, session.text());
    if std::mem::take(&mut view.text.goes_to_error) {
        view.text.go_to = next_error(session, cursor);
        view.text.focuses_editor = true;
    }
    widgets::side_panel("text", &view.theme, SIDE_WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            show_errors(ui, &view.theme, queue, session);
            ui.add_space(space::SMALL);
            show_search(ui, view, session.text(), cursor);
            ui.add_space(space::SMALL);
            show_key(ui, &view.theme, session.text(), cursor);
        });
    });
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_min_size(ui.available_size());
        egui::ScrollArea::both().auto_shrink(false).show(ui, |ui| show_editor(ui, view, queue, opened));
    });
}

/// Shows the place of a change that was not typed here: undo, redo, a weight that was dragged, a file that was read again.
fn follow_changes(view: &mut StudioView, session: &Session) {
    if view.text.shown == session.text() {
        return;
    }
    if !view.text.shown.is_empty()
        && let Some(change) = TextChange::from_texts(&view.text.shown, session.text())
    {
        view.text.go_to.get_or_insert(place_of_byte(session.text(), change.replaced.start));
    }
    view.text.shown = session.text().to_owned();
}

/// Returns the byte at which the cursor stands.
fn cursor_byte(ui: &Ui, text: &str) -> usize {
    let state = TextEdit::load_state(ui.ctx(), editor_id());
    let index = state.and_then(|s| s.cursor.char_range()).map_or(0, |range| range.primary.index.0);
    text.char_indices().nth(index).map_or(text.len(), |(byte, _)| byte)
}

/// Returns the place of a byte.
fn place_of_byte(text: &str, byte: usize) -> TextPlace {
    let before = text.get(..byte).unwrap_or(text);
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    TextPlace { line: before.matches('\n').count() + 1, column: before[start..].chars().count() + 1 }
}

/// Returns the cursor at a place, or at the end of its line if that is shorter.
fn cursor_of_place(text: &str, place: TextPlace) -> CCursor {
    let before: usize = text.split_inclusive('\n').take(place.line - 1).map(|l| l.chars().count()).sum();
    let line = text.lines().nth(place.line - 1).map_or(0, |line| line.chars().count());
    CCursor::new(before + line.min(place.column - 1))
}

/// Returns the errors of the project file's own text, from its top.
fn own_errors(session: &Session) -> Vec<&Diagnostic> {
    let own = |error: &&Diagnostic| error.file == session.document().name();
    let mut errors: Vec<&Diagnostic> = session.errors().iter().filter(own).collect();
    errors.sort_by_key(|error| (error.line, error.column));
    errors
}

/// Returns the place of the first error below a byte, or of the first one; `None` if there is none.
fn next_error(session: &Session, byte: usize) -> Option<TextPlace> {
    let here = place_of_byte(session.text(), byte);
    let errors = own_errors(session);
    let below = errors.iter().find(|e| (e.line, e.column) > (here.line, here.column));
    let error = below.or(errors.first())?;
    Some(TextPlace { line: error.line, column: error.column })
}

/// Returns an error without the place, which is shown beside it.
fn error_message(error: &Diagnostic) -> String {
    let whole = error.to_string();
    let place = format!("{}:{}:{}: {}: ", error.file, error.line, error.column, error.severity);
    whole.strip_prefix(&place).map_or(whole.clone(), str::to_owned)
}

/// Shows all errors, those to correct first at the top; a click leads to the place.
fn show_errors(ui: &mut Ui, theme: &WindowTheme, queue: &mut Vec<Command>, session: &Session) {
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        let errors = session.errors();
        let title = match errors.len() {
            0 => "No errors".to_owned(),
            1 => "1 error".to_owned(),
            count => format!("{count} errors"),
        };
        let colour = if errors.is_empty() { theme.good } else { theme.bad };
        ui.label(RichText::new(title).strong().color(colour));
        if errors.is_empty() {
            let text = "The text is a project. What is typed is designed and verified at once; Ctrl+Z undoes it.";
            ui.label(RichText::new(text).small().color(theme.weak));
        } else {
            let text = "A click or Shift+F8 leads to the place. Until all are corrected, the pages show the last project that had none.";
            ui.label(RichText::new(text).small().color(theme.weak));
        }
        for error in errors {
            if error.file == session.document().name() {
                show_own_error(ui, queue, error);
            } else {
                show_part_error(ui, theme, error);
            }
        }
    });
}

/// Shows an error of a file that the project includes, which other projects may share.
fn show_part_error(ui: &mut Ui, theme: &WindowTheme, error: &Diagnostic) {
    let place = format!("{}, line {}: {}", error.file, error.line, error_message(error));
    ui.label(RichText::new(place).small());
    let text = "This file is included: correct it in an editor, then read the project again.";
    ui.label(RichText::new(text).small().color(theme.weak));
}

fn show_own_error(ui: &mut Ui, queue: &mut Vec<Command>, error: &Diagnostic) {
    let text = RichText::new(format!("line {}: {}", error.line, error_message(error))).small();
    let button =
        egui::Button::new(text).wrap().fill(Color32::TRANSPARENT).min_size(vec2(ui.available_width(), 0.0));
    if ui.add(button).clicked() {
        queue.push(Command::ShowLine { line: error.line, column: error.column });
    }
}

/// Shows the field for a word that is looked for; Enter leads from place to place.
fn show_search(ui: &mut Ui, view: &mut StudioView, text: &str, cursor: usize) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        let label = ui.label(RichText::new("Find").strong());
        let field =
            TextEdit::singleline(&mut view.text.find).hint_text("Ctrl+F").desired_width(f32::INFINITY);
        let response = ui.add(field).labelled_by(label.id);
        if std::mem::take(&mut view.text.focuses_find) {
            response.request_focus();
        }
        if view.text.find.is_empty() {
            return;
        }
        let places = find_places(text, &view.text.find);
        let count = match places.len() {
            0 => "not in the text".to_owned(),
            1 => "1 place".to_owned(),
            count => format!("{count} places; Enter leads to the next"),
        };
        ui.label(RichText::new(count).small().color(theme.weak));
        if response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) {
            let next = places.iter().find(|byte| **byte > cursor).or(places.first());
            view.text.go_to = next.map(|byte| place_of_byte(text, *byte));
            response.request_focus();
        }
    });
}

/// Returns the bytes at which a word stands, in small or large letters.
fn find_places(text: &str, word: &str) -> Vec<usize> {
    let (text, word) = (text.to_ascii_lowercase(), word.to_ascii_lowercase());
    text.match_indices(&word).map(|(byte, _)| byte).collect()
}

/// Shows unit, allowed range and meaning of the key at the cursor.
fn show_key(ui: &mut Ui, theme: &WindowTheme, text: &str, cursor: usize) {
    let Some(path) = key_path_at(text, cursor) else { return };
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new("At the cursor").strong());
        ui.label(RichText::new(&path).small().monospace());
        let Some(key) = find_key(&path) else { return };
        let unit = if key.unit.is_empty() { String::new() } else { format!(" {}", key.unit) };
        ui.label(&key.meaning);
        ui.label(RichText::new(format!("allowed: {}{unit}", key.allowed)).small().color(theme.weak));
    });
}

/// Shows the text, in which everything is marked that was found about it.
fn show_editor(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, opened: &OpenProject) {
    let (theme, session) = (view.theme, &opened.session);
    let layout = |ui: &Ui, text: &str| ui.fonts_mut(|fonts| fonts.layout_job(coloured_text(text, &theme)));
    let mut layouter = |ui: &Ui, buffer: &dyn TextBuffer, _: f32| layout(ui, buffer.as_str());
    let width = layout(ui, session.text()).size().x + GUTTER + RIGHT_SPACE;
    let (mut edited, mut fixed) = (session.text().to_owned(), session.text());
    let buffer: &mut dyn TextBuffer = if opened.is_read_only() { &mut fixed } else { &mut edited };
    let output = TextEdit::multiline(buffer)
        .id(editor_id())
        .font(FontId::monospace(LETTER_SIZE))
        .frame(egui::Frame::new().inner_margin(Margin { left: GUTTER as i8, right: 0, top: 2, bottom: 2 }))
        .min_size(ui.available_size().max(vec2(width, 0.0)))
        .desired_width(f32::INFINITY)
        .layouter(&mut layouter)
        .show(ui);
    let response = output.response.response;
    response.widget_info(|| {
        let mut info = egui::WidgetInfo::text_edit(true, session.text(), session.text(), "");
        info.label = Some("text of the project".to_owned());
        info
    });
    if response.changed() {
        take_typed(ui, view, queue, session.text(), edited);
        // the galley is that of the new text, whose errors are known in the next frame
        return;
    }
    let shown = ShownText { galley: &output.galley, origin: output.galley_pos, theme: &theme };
    shown.mark_places(ui, session.text(), &view.text.find);
    shown.mark_errors(ui, &own_errors(session));
    shown.number_lines(ui);
    if let Some(place) = view.text.go_to.take() {
        let cursor = cursor_of_place(session.text(), place);
        let mut state = output.state;
        state.cursor.set_char_range(Some(CCursorRange::one(cursor)));
        state.store(ui.ctx(), editor_id());
        let at = output.galley.pos_from_cursor(cursor).translate(output.galley_pos.to_vec2());
        let area = at.expand2(vec2(GUTTER + space::LARGE, LINE_HEIGHT));
        // an animation would draw frames in which the place is not yet in view
        let at_once = egui::style::ScrollAnimation::none();
        ui.scroll_to_rect_animation(area, Some(Align::Center), at_once);
        if std::mem::take(&mut view.text.focuses_editor) {
            response.request_focus();
        }
        ui.ctx().request_repaint();
    }
}

/// Takes what was typed into the project. Letters that follow each other on a line are one step of undo.
fn take_typed(ui: &Ui, view: &mut StudioView, queue: &mut Vec<Command>, before: &str, after: String) {
    let Some(change) = TextChange::from_texts(before, &after) else { return };
    let now =
        TypedPlace { time_s: ui.input(|i| i.time), line: place_of_byte(before, change.replaced.start).line };
    let is_letter = change.inserted.len() <= 1 && change.replaced.len() <= 1 && change.inserted != "\n";
    let continues = is_letter
        && view
            .text
            .typed
            .is_some_and(|last| last.line == now.line && now.time_s - last.time_s < TYPING_PAUSE_S);
    if !continues {
        view.gesture += 1;
    }
    view.text.typed = is_letter.then_some(now);
    view.text.shown = after;
    let TextChange { replaced, inserted } = change;
    queue.push(Command::SpliceText {
        from: replaced.start,
        to: replaced.end,
        inserted,
        gesture: Some(view.gesture),
    });
}

/// The text as it is laid out in the window.
struct ShownText<'a> {
    galley: &'a Galley,
    origin: Pos2,
    theme: &'a WindowTheme,
}

impl ShownText<'_> {
    /// Returns the area of a line, from 1; `None` if there is no such line or it is not in view.
    fn line_area(&self, ui: &Ui, line: usize) -> Option<Rect> {
        let row = self.galley.rows.get(line.checked_sub(1)?)?;
        let area = row.rect().translate(self.origin.to_vec2());
        ui.clip_rect().intersects(area.expand2(vec2(f32::INFINITY, 0.0))).then_some(area)
    }

    fn number_lines(&self, ui: &Ui) {
        // the numbers stay in view when a long line is scrolled
        let right = (self.origin.x - space::MEDIUM).max(ui.clip_rect().left() + GUTTER - space::MEDIUM);
        let cover =
            Rect::from_min_max(ui.clip_rect().min, pos2(right + space::SMALL, ui.clip_rect().bottom()));
        if right > self.origin.x {
            ui.painter().rect_filled(cover, 0.0, self.theme.card);
        }
        for line in 1..=self.galley.rows.len() {
            if let Some(area) = self.line_area(ui, line) {
                let font = FontId::monospace(LETTER_SIZE - 2.0);
                let at = pos2(right, area.center().y);
                ui.painter().text(at, egui::Align2::RIGHT_CENTER, line, font, self.theme.weak);
            }
        }
    }

    /// Marks the places of the word that is looked for.
    fn mark_places(&self, ui: &Ui, text: &str, word: &str) {
        if word.is_empty() {
            return;
        }
        let length = word.chars().count();
        for byte in find_places(text, word) {
            let place = place_of_byte(text, byte);
            if let Some(area) = self.line_area(ui, place.line) {
                let left = self.column_x(place.line, place.column);
                let right = self.column_x(place.line, place.column + length);
                let found = Rect::from_x_y_ranges(left..=right, area.y_range());
                ui.painter().rect_filled(found, 2.0, self.theme.warn.gamma_multiply(0.35));
            }
        }
    }

    /// Marks each error by a coloured line, the underlined word and its message behind the line.
    fn mark_errors(&self, ui: &mut Ui, errors: &[&Diagnostic]) {
        let bad = self.theme.bad;
        for group in errors.chunk_by(|a, b| a.line == b.line) {
            let Some(area) = self.line_area(ui, group[0].line) else { continue };
            let whole = Rect::from_x_y_ranges(ui.clip_rect().x_range(), area.y_range());
            ui.painter().rect_filled(whole, 0.0, bad.gamma_multiply(0.13));
            for error in group {
                self.underline_word(ui, area, error);
            }
            let messages: Vec<String> = group.iter().map(|error| error_message(error)).collect();
            let message = messages.join("; ");
            let font = FontId::proportional(LETTER_SIZE - 1.0);
            let at = pos2(area.right() + space::LARGE, area.center().y);
            let shown = ui.painter().text(at, egui::Align2::LEFT_CENTER, &message, font, bad);
            let id = editor_id().with(group[0].line);
            ui.interact(shown, id, egui::Sense::hover()).on_hover_text(&message);
        }
    }

    /// Underlines the word at the place of an error.
    fn underline_word(&self, ui: &Ui, area: Rect, error: &Diagnostic) {
        let Some(row) = self.galley.rows.get(error.line.saturating_sub(1)) else { return };
        let letters: Vec<char> = row.glyphs.iter().map(|glyph| glyph.chr).collect();
        let start = error.column.saturating_sub(1).min(letters.len());
        let ends = |c: &char| c.is_whitespace() || matches!(c, '#' | ',' | ']' | '}');
        let end =
            letters[start..].iter().position(ends).map_or(letters.len(), |length| start + length.max(1));
        let (left, right) = (self.column_x(error.line, start + 1), self.column_x(error.line, end + 1));
        let range = left..=right.max(left + 8.0);
        ui.painter().hline(range, area.bottom() - 2.0, Stroke::new(2.0, self.theme.bad));
    }

    /// Returns where a column of a line begins.
    fn column_x(&self, line: usize, column: usize) -> f32 {
        let Some(row) = self.galley.rows.get(line - 1) else { return self.origin.x };
        self.origin.x + row.pos.x + row.glyphs.get(column - 1).map_or(row.size.x, |glyph| glyph.pos.x)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn places_and_cursors_of_a_text_agree() {
        let text = "a = 1\n\u{e9}\u{e9} = 2\n\nlast";
        for (byte, _) in text.char_indices() {
            let place = place_of_byte(text, byte);
            assert_eq!(cursor_of_place(text, place).index.0, text[..byte].chars().count(), "{place:?}");
        }
        let beyond = cursor_of_place(text, TextPlace { line: 1, column: 99 });
        assert_eq!(beyond.index.0, 5, "the end of the line");
    }
}
