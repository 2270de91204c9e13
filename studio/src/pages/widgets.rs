//! The widgets of the pages: cells, plots that can be copied, numbers with units, messages.

use counterpoise_report::wording::capitalise_first;
use egui::{Rect, RichText, Ui, Vec2, vec2};

use crate::charts::chart::Chart;
use crate::charts::chart_view::{self, ChartResponse, ChartStyle};
use crate::charts::second_cursor::toggle_second_cursor;
use crate::command::{BrowsePurpose, Command};
use crate::editing::key_reference::find_key;
use crate::editing::weight_handles::round_to_three_digits;
use crate::help::plot_texts::plot_help;
use crate::help::topics::HelpTopic;
use crate::number_format::format_short;
use crate::theme::{WindowTheme, space};
use crate::view::StudioView;

/// Width from which a grid has one more column, points: there four columns are as wide as three on a usual screen.
const WIDE: f32 = 1500.0;

/// Returns the cells of a grid that fills an area; a wide area has one more column if that saves a row.
pub fn grid_cells(area: Rect, count: usize, columns: usize) -> Vec<Rect> {
    let saves_row = count.div_ceil(columns + 1) < count.div_ceil(columns);
    let columns = if area.width() > WIDE && saves_row { columns + 1 } else { columns };
    cells_of(area, count, columns.min(count.max(1)))
}

/// Returns the cells of a grid with so many columns.
pub fn cells_of(area: Rect, count: usize, columns: usize) -> Vec<Rect> {
    let rows = count.div_ceil(columns);
    let gap = space::MEDIUM;
    let size = vec2(
        (area.width() - gap * (columns - 1) as f32) / columns as f32,
        (area.height() - gap * (rows - 1) as f32) / rows as f32,
    );
    let cell = |k: usize| {
        let corner =
            area.min + vec2((size.x + gap) * (k % columns) as f32, (size.y + gap) * (k / columns) as f32);
        Rect::from_min_size(corner, size)
    };
    (0..count).map(cell).collect()
}

/// Shows a chart in a cell. It can be copied from its menu, and by command while the pointer is on it.
pub fn show_chart(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    cell: Rect,
    chart: &Chart,
) -> ChartResponse {
    let theme = view.theme;
    let mut inside = ui.new_child(egui::UiBuilder::new().id_salt(&chart.title).max_rect(cell));
    let corner = view.tiles.corner;
    let style = ChartStyle { theme: &theme, scope: &view.limits_scope, corner };
    let shown = chart_view::show_chart(&mut inside, chart, style, cell.size());
    if shown.response.hovered() || view.chart.is_none() {
        view.chart = Some(chart.clone());
    }
    if let (true, Some(x)) = (shown.response.hovered(), chart_view::cursor_position(ui, chart))
        && std::mem::take(&mut view.is_second_cursor_asked)
    {
        toggle_second_cursor(ui.ctx(), chart, x);
    }
    if shown.response.hovered() {
        view.help.note(&chart.title, plot_help(&chart.title));
    }
    if view.fit_request.take_if(|title| *title == chart.title).is_some() {
        shown.limits.reset(ui);
    }
    shown.response.context_menu(|ui| {
        view.chart = Some(chart.clone());
        for (name, command) in [
            ("Fit the plot", Command::FitPlot),
            ("Copy as CSV", Command::CopyCsv),
            ("Copy as SVG", Command::CopySvg),
            ("Copy as PNG", Command::CopyPng),
            ("Save as a file\u{2026}", Command::Browse { purpose: BrowsePurpose::PlotFile }),
        ] {
            if ui.button(name).clicked() {
                queue.push(command);
                ui.close();
            }
        }
        if let Some(action) = corner {
            show_tile_menu(ui, queue, action);
        }
        let hint =
            "the wheel zooms, a drag pans, a double click fits, a click with Shift measures from there";
        ui.label(RichText::new(hint).small().color(theme.weak));
    });
    shown
}

/// Shows what can be done with a plot that is a tile.
fn show_tile_menu(ui: &mut Ui, queue: &mut Vec<Command>, action: &str) {
    ui.separator();
    for (name, command) in [
        (capitalise_first(action), Command::MaximisePlot),
        ("Hide this plot".to_owned(), Command::HidePlot),
        ("Usual layout of the plots".to_owned(), Command::ResetPlots),
    ] {
        if ui.button(name).clicked() {
            queue.push(command);
            ui.close();
        }
    }
}

/// Shows a number of the project that is dragged or typed, with its unit; meaning and range appear on hover.
pub fn number_field(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, path: &str, value: f64) {
    let theme = view.theme;
    let name = key_in_words(path.rsplit('.').next().unwrap_or(path));
    let key = find_key(path);
    let hint = key.map_or_else(String::new, |k| format!("{}\nallowed: {}\n{path}", k.meaning, k.allowed));
    let label = ui.label(RichText::new(&name).color(theme.weak)).on_hover_text(&hint);
    let edited = edit_number(ui, value, label.id, &hint);
    ui.label(RichText::new(key.map_or("", |k| k.unit.as_str())).small().color(theme.weak));
    if edited.response.drag_started() {
        view.gesture += 1;
    }
    if let Some(changed) = edited.changed {
        let gesture = edited.response.dragged().then_some(view.gesture);
        let value = if gesture.is_some() { round_to_three_digits(changed) } else { changed };
        queue.push(Command::Set { path: path.to_owned(), value, gesture });
    }
    view.dragging |= edited.response.dragged();
    if label.hovered() || edited.response.hovered() || edited.response.has_focus() {
        view.help.pointed = Some(HelpTopic::of_key(path));
    }
    ui.end_row();
}

/// A number that can be dragged or typed, as it is after a frame.
pub struct EditedNumber {
    /// The widget.
    pub response: egui::Response,
    /// The new value, if there is one.
    pub changed: Option<f64>,
}

/// Shows a number that is dragged or typed, with a label; Esc takes back what was typed.
pub fn edit_number(ui: &mut Ui, value: f64, label: egui::Id, hint: &str) -> EditedNumber {
    let mut edited = value;
    let speed = if value == 0.0 { 1e-3 } else { value.abs() * 5e-3 };
    let widget = egui::DragValue::new(&mut edited)
        .speed(speed)
        .custom_formatter(|v, _| format_short(v))
        .custom_parser(|text| text.trim().replace(',', ".").parse().ok())
        .update_while_editing(false);
    let response = ui.add_sized(vec2(78.0, 20.0), widget).labelled_by(label).on_hover_text(hint);
    note_revert(ui, &response);
    let is_changed = response.changed() && edited != value && !is_reverted(ui, &response);
    EditedNumber { response, changed: is_changed.then_some(edited) }
}

/// Notes that Esc has ended the editing of a number.
fn note_revert(ui: &Ui, response: &egui::Response) {
    if ui.input(|i| i.key_pressed(egui::Key::Escape)) && (response.has_focus() || response.lost_focus()) {
        let frame = ui.ctx().cumulative_frame_nr();
        ui.data_mut(|data| data.insert_temp(response.id.with("reverted"), frame));
    }
}

/// Returns whether Esc has ended the editing of a number in this frame or the last one: what was typed is then not taken. The toolkit
/// takes a typed number in both frames after the focus was lost, and looks for Esc in the first one only.
fn is_reverted(ui: &Ui, response: &egui::Response) -> bool {
    let (id, frame) = (response.id.with("reverted"), ui.ctx().cumulative_frame_nr());
    ui.data(|data| data.get_temp::<u64>(id)).is_some_and(|reverted| frame <= reverted + 1)
}

/// Returns a key in words; items of a list are counted from 1.
fn key_in_words(key: &str) -> String {
    let words = key.replace('_', " ");
    match words
        .split_once('[')
        .and_then(|(name, rest)| Some((name, rest.trim_end_matches(']').parse::<usize>().ok()?)))
    {
        Some((name, index)) => format!("{name} {}", index + 1),
        None => words.clone(),
    }
}

/// Lays out the name of a figure; if it has several parts, the first stands over the others.
pub fn figure_name_layout(figure: &str, theme: &WindowTheme) -> egui::text::LayoutJob {
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

/// Shows a row of a grid with a limit that may be edited: its name, its value, which is not negative, and its unit.
pub fn limit_field(ui: &mut Ui, theme: &WindowTheme, name: &str, unit: &str, value: &mut f64) {
    let label = ui.label(RichText::new(name).color(theme.weak));
    let edited = edit_number(ui, *value, label.id, name);
    *value = edited.changed.map_or(*value, |changed| changed.max(0.0));
    ui.label(RichText::new(unit).small().color(theme.weak));
    ui.end_row();
}

/// Shows what to do while there is nothing to show.
pub fn show_placeholder(ui: &mut Ui, theme: &WindowTheme, title: &str, text: &str) {
    ui.add_space(ui.available_height() * 0.3);
    ui.vertical_centered(|ui| {
        ui.label(RichText::new(title).heading());
        ui.add_space(space::SMALL);
        ui.label(RichText::new(text).color(theme.weak));
    });
}

/// Most reasons that are shown at once; the first ones are those to correct first.
const MOST_REASONS: usize = 6;

/// Shows why there is no result.
pub fn show_error_list(ui: &mut Ui, theme: &WindowTheme, title: &str, reasons: &[String]) {
    theme.card().stroke(egui::Stroke::new(1.0, theme.bad)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new(title).strong().color(theme.bad));
        for reason in reasons.iter().take(MOST_REASONS) {
            ui.label(RichText::new(reason).small());
        }
    });
}

/// Shows the heading of a group in a side panel.
pub fn show_heading(ui: &mut Ui, text: &str) {
    ui.add_space(space::SMALL);
    ui.label(RichText::new(text).strong());
}

/// Takes the remaining area of a page.
pub fn take_remaining_area(ui: &mut Ui) -> Rect {
    let size = ui.available_size().max(Vec2::splat(200.0));
    ui.allocate_exact_size(size, egui::Sense::hover()).0
}

/// Returns a side panel in the style of the studio.
pub fn side_panel(id: &'static str, theme: &WindowTheme, width: f32) -> egui::Panel {
    let frame = egui::Frame::new().fill(theme.ground).inner_margin(egui::Margin {
        left: 0,
        right: 8,
        top: 0,
        bottom: 0,
    });
    egui::Panel::left(id).exact_size(width).resizable(false).show_separator_line(false).frame(frame)
}
