//! What the places are made of: cells, plots that can be copied, numbers with units, messages.

use egui::{Rect, RichText, Ui, Vec2, vec2};

use crate::chart::{Chart, Shown};
use crate::command::Command;
use crate::keys;
pub use crate::number::short;
use crate::theme::{Theme, space};
use crate::view::View;

/// Cells of a grid that fills a room: `columns` wide; one more column where the room is wide and that saves a row.
pub fn grid(room: Rect, count: usize, columns: usize) -> Vec<Rect> {
    let saves = count.div_ceil(columns + 1) < count.div_ceil(columns);
    let columns = if room.width() > 1500.0 && saves { columns + 1 } else { columns };
    grid_of(room, count, columns.min(count.max(1)))
}

fn grid_of(room: Rect, count: usize, columns: usize) -> Vec<Rect> {
    let rows = count.div_ceil(columns);
    let gap = space::MEDIUM;
    let size = vec2(
        (room.width() - gap * (columns - 1) as f32) / columns as f32,
        (room.height() - gap * (rows - 1) as f32) / rows as f32,
    );
    let at = |k: usize| {
        let corner =
            room.min + vec2((size.x + gap) * (k % columns) as f32, (size.y + gap) * (k / columns) as f32);
        Rect::from_min_size(corner, size)
    };
    (0..count).map(at).collect()
}

/// Nine cells of three columns, the first two of the first row joined into one.
pub fn mosaic(room: Rect) -> Vec<Rect> {
    let mut cells = grid_of(room, 9, 3);
    let second = cells.remove(1);
    cells[0] = cells[0].union(second);
    cells
}

/// Shows a chart in a cell; it can be copied from its menu, and by command while the pointer is on it.
pub fn chart(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, cell: Rect, chart: &Chart) -> Shown {
    let theme = view.theme;
    let mut inside = ui.new_child(egui::UiBuilder::new().id_salt(&chart.title).max_rect(cell));
    let shown = chart.show(&mut inside, &theme, cell.size());
    if shown.response.hovered() || view.chart.is_none() {
        view.chart = Some(chart.clone());
    }
    shown.response.context_menu(|ui| {
        for (name, command) in [
            ("Copy as CSV", Command::CopyCsv),
            ("Copy as SVG", Command::CopySvg),
            ("Copy as PNG", Command::CopyPng),
        ] {
            if ui.button(name).clicked() {
                queue.push(command);
                ui.close();
            }
        }
        ui.label(RichText::new("double-click shows all").small().color(theme.weak));
    });
    shown
}

/// A number of the project: dragged or typed, with its unit; meaning and range on hover.
pub fn number(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, path: &str, value: f64) {
    let theme = view.theme;
    let name = worded(path.rsplit('.').next().unwrap_or(path));
    let known = keys::key(path);
    let hint = known.map_or_else(String::new, |k| format!("{}\nallowed: {}\n{path}", k.meaning, k.allowed));
    let label = ui.label(RichText::new(&name).color(theme.weak)).on_hover_text(&hint);
    let mut edited = value;
    let speed = if value == 0.0 { 1e-3 } else { value.abs() * 5e-3 };
    let widget = egui::DragValue::new(&mut edited)
        .speed(speed)
        .custom_formatter(|v, _| short(v))
        .custom_parser(|text| text.trim().replace(',', ".").parse().ok())
        .update_while_editing(false);
    let response = ui.add_sized(vec2(78.0, 20.0), widget).labelled_by(label.id).on_hover_text(&hint);
    ui.label(RichText::new(known.map_or("", |k| k.unit.as_str())).small().color(theme.weak));
    if response.drag_started() {
        view.gesture += 1;
    }
    if response.changed() && edited != value {
        let gesture = response.dragged().then_some(view.gesture);
        let value = if gesture.is_some() { crate::knobs::significant(edited) } else { edited };
        queue.push(Command::Set { path: path.to_owned(), value, gesture });
    }
    view.dragging |= response.dragged();
    ui.end_row();
}

/// A key in words; items of a list are counted from 1.
fn worded(key: &str) -> String {
    let words = key.replace('_', " ");
    match words
        .split_once('[')
        .and_then(|(name, rest)| Some((name, rest.trim_end_matches(']').parse::<usize>().ok()?)))
    {
        Some((name, index)) => format!("{name} {}", index + 1),
        None => words.clone(),
    }
}

/// The name of a figure; where it has several parts, the first over the others.
pub fn figure(figure: &str, theme: &Theme) -> egui::text::LayoutJob {
    let format = |size, colour| egui::TextFormat::simple(egui::FontId::proportional(size), colour);
    let mut job = egui::text::LayoutJob::default();
    let (head, rest) = figure.split_once(", ").unwrap_or((figure, ""));
    job.append(head, 0.0, format(13.0, theme.text));
    if !rest.is_empty() {
        let rest = rest.replace("feedback + feedforward", "with feedforward");
        job.append(&format!("\n{rest}"), 0.0, format(11.0, theme.weak));
    }
    job
}

/// What to do where there is nothing to show yet.
pub fn empty(ui: &mut Ui, theme: &Theme, title: &str, text: &str) {
    ui.add_space(ui.available_height() * 0.3);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new(title).heading());
        ui.add_space(space::SMALL);
        ui.label(RichText::new(text).color(theme.weak));
    });
}

/// Reasons why there is nothing, in place.
pub fn reasons(ui: &mut Ui, theme: &Theme, title: &str, why: &[String]) {
    theme.card().stroke(egui::Stroke::new(1.0, theme.bad)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new(title).strong().color(theme.bad));
        for reason in why.iter().take(6) {
            ui.label(RichText::new(reason).small());
        }
    });
}

/// A heading of a group in a side panel.
pub fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(space::SMALL);
    ui.label(RichText::new(text).strong());
}

/// The room that is left, with its size.
pub fn room(ui: &mut Ui) -> Rect {
    let size = ui.available_size().max(Vec2::splat(200.0));
    ui.allocate_exact_size(size, egui::Sense::hover()).0
}

/// A side panel in the look of the studio.
pub fn side(id: &'static str, theme: &Theme, width: f32) -> egui::Panel {
    let frame = egui::Frame::new().fill(theme.ground).inner_margin(egui::Margin {
        left: 0,
        right: 8,
        top: 0,
        bottom: 0,
    });
    egui::Panel::left(id).exact_size(width).resizable(false).show_separator_line(false).frame(frame)
}
