//! A report in the window: what the page of the command line says, with its figures as plots.

use std::borrow::Cow;

use counterpoise_plot::{Axis, Colour, Content, Dash, Figure, Mark, Panel, Scale, Series};
use counterpoise_report::page::{FigureTile, Headline, OutcomeTone, ReportSection, ReportTable};
use counterpoise_report::{Report, ReportCell, ReportColumn};
use egui::{Color32, RichText, Ui, vec2};

use super::widgets;
use crate::charts::chart::{AxisScale, Chart, LabelledPoint, LineDash, PlotAxis};
use crate::command::Command;
use crate::theme::{WindowTheme, space};
use crate::view::StudioView;

/// Height of a panel of a figure, points.
const PANEL_HEIGHT: f32 = 290.0;
/// Figures of the first screen side by side at most.
const MOST_COLUMNS: usize = 2;
/// Width of a column of a table at which its text is broken, points.
const TEXT_WIDTH: f32 = 420.0;

/// A click in a figure of the report's first screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureClick {
    /// Place of the figure.
    pub figure: usize,
    /// Coordinates of the click.
    pub at: [f64; 2],
    /// Width and height of the plot in the same coordinates; logarithmic axes are in decades.
    pub extent: [f64; 2],
    /// The scales of the axes.
    pub scales: [AxisScale; 2],
}

impl FigureClick {
    /// Returns the distance of a point from the click, in parts of the plot.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        let along = |axis: usize| {
            let coordinate = |value: f64| match self.scales[axis] {
                AxisScale::Log => value.max(f64::MIN_POSITIVE).log10(),
                AxisScale::Linear => value,
            };
            (coordinate(point[axis]) - coordinate(self.at[axis]))
                / self.extent[axis].abs().max(f64::MIN_POSITIVE)
        };
        along(0).hypot(along(1))
    }
}

/// Shows a report; returns where a figure of its first screen was clicked. `before_sections` draws beneath that screen.
pub fn show(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    report: &Report,
    before_sections: impl FnOnce(&mut Ui, &mut Vec<Command>),
) -> Option<FigureClick> {
    let theme = view.theme;
    let mut clicked = None;
    egui::ScrollArea::vertical().id_salt(&report.title).auto_shrink([false; 2]).show(ui, |ui| {
        show_headline(ui, &theme, &report.headline);
        show_tiles(ui, &theme, &report.tiles);
        clicked = show_figures(ui, view, queue, &report.glance);
        before_sections(ui, queue);
        show_table(ui, &theme, &report.verdicts, "verdicts");
        for (k, section) in report.sections.iter().enumerate() {
            show_section(ui, view, queue, section, k);
        }
    });
    clicked
}

fn tone_colour(theme: &WindowTheme, tone: OutcomeTone) -> Color32 {
    match tone {
        OutcomeTone::Good => theme.good,
        OutcomeTone::Bad => theme.bad,
        OutcomeTone::Neutral => theme.text,
    }
}

fn show_headline(ui: &mut Ui, theme: &WindowTheme, headline: &Headline) {
    ui.label(RichText::new(plain_text(&headline.text)).heading().color(tone_colour(theme, headline.tone)));
    if !headline.detail.is_empty() {
        ui.label(RichText::new(plain_text(&headline.detail)).color(theme.weak));
    }
    ui.add_space(space::SMALL);
}

fn show_tiles(ui: &mut Ui, theme: &WindowTheme, tiles: &[FigureTile]) {
    ui.horizontal_wrapped(|ui| {
        for tile in tiles {
            theme.card().show(ui, |ui| {
                ui.vertical(|ui| {
                    ui.label(RichText::new(plain_text(&tile.label)).small().color(theme.weak));
                    let value = format!("{} {}", tile.value, tile.unit);
                    ui.label(
                        RichText::new(plain_text(value.trim())).strong().color(tone_colour(theme, tile.tone)),
                    );
                    if !tile.note.is_empty() {
                        ui.label(RichText::new(plain_text(&tile.note)).small().color(theme.weak));
                    }
                });
            });
        }
    });
    ui.add_space(space::SMALL);
}

fn show_section(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    section: &ReportSection,
    index: usize,
) {
    let theme = view.theme;
    let is_empty = section.text.is_empty() && section.figures.is_empty() && section.tables.is_empty();
    if is_empty {
        return;
    }
    let header = RichText::new(plain_text(&section.heading)).strong();
    egui::CollapsingHeader::new(header).id_salt((&section.heading, index)).default_open(true).show(
        ui,
        |ui| {
            for text in &section.text {
                ui.add(egui::Label::new(plain_text(text)).wrap());
            }
            show_figures(ui, view, queue, &section.figures);
            for (k, table) in section.tables.iter().enumerate() {
                show_table(ui, &theme, table, &format!("{} {index} {k}", section.heading));
            }
        },
    );
}

fn show_table(ui: &mut Ui, theme: &WindowTheme, table: &ReportTable, id: &str) {
    if table.rows.is_empty() {
        return;
    }
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        if !table.caption.is_empty() {
            ui.label(RichText::new(plain_text(&table.caption)).strong());
        }
        egui::ScrollArea::horizontal().id_salt((id, "scroll")).show(ui, |ui| {
            let grid = egui::Grid::new((id, "table")).num_columns(table.columns.len()).striped(true);
            grid.spacing([14.0, 3.0]).show(ui, |ui| {
                for column in &table.columns {
                    let (ReportColumn::Text(name) | ReportColumn::Number(name)) = column;
                    ui.label(RichText::new(plain_text(name)).small().color(theme.weak));
                }
                ui.end_row();
                for row in &table.rows {
                    for (column, cell) in table.columns.iter().zip(row) {
                        show_cell(ui, theme, *column, cell);
                    }
                    ui.end_row();
                }
            });
        });
    });
    ui.add_space(space::SMALL);
}

fn show_cell(ui: &mut Ui, theme: &WindowTheme, column: ReportColumn, cell: &ReportCell) {
    let (text, colour) = match cell {
        ReportCell::Text(text) => (text, theme.text),
        ReportCell::Verdict(tone, text) | ReportCell::Room(tone, _, text) => {
            (text, tone_colour(theme, *tone))
        }
    };
    let label = RichText::new(plain_text(text)).color(colour);
    match column {
        ReportColumn::Number(_) => {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(label));
        }
        ReportColumn::Text(_) => {
            ui.scope(|ui| {
                ui.set_max_width(TEXT_WIDTH);
                ui.label(label);
            });
        }
    }
}

/// Shows figures in columns, a plot for each panel; returns where one was clicked.
fn show_figures(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    figures: &[Figure],
) -> Option<FigureClick> {
    let charts: Vec<(usize, Chart)> = figures
        .iter()
        .enumerate()
        .flat_map(|(k, figure)| figure_charts(&view.theme, figure).into_iter().map(move |chart| (k, chart)))
        .collect();
    if charts.is_empty() {
        return None;
    }
    let columns = charts.len().min(MOST_COLUMNS);
    let rows = charts.len().div_ceil(columns);
    let height = rows as f32 * (PANEL_HEIGHT + space::MEDIUM) - space::MEDIUM;
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), egui::Sense::hover());
    let mut clicked = None;
    for ((figure, chart), cell) in charts.iter().zip(widgets::cells_of(area, charts.len(), columns)) {
        let shown = widgets::show_chart(ui, view, queue, cell, chart);
        // a click with Shift sets the second cursor
        let is_click = shown.response.clicked() && !ui.input(|input| input.modifiers.shift);
        if let Some(at) = shown.response.interact_pointer_pos().filter(|_| is_click) {
            let value = |position| {
                let point = shown.transform.value_from_position(position);
                [chart.value_at(PlotAxis::X, point.x), chart.value_at(PlotAxis::Y, point.y)]
            };
            let frame = shown.transform.frame();
            let corner = |position| shown.transform.value_from_position(position);
            let (low, high) = (corner(frame.left_bottom()), corner(frame.right_top()));
            clicked = Some(FigureClick {
                figure: *figure,
                at: value(at),
                extent: [high.x - low.x, high.y - low.y],
                scales: chart.scales,
            });
        }
    }
    ui.add_space(space::MEDIUM + space::SMALL);
    clicked
}

/// Returns the panels of a figure as plots; none of a heat map, which only the page of the report has.
fn figure_charts(theme: &WindowTheme, figure: &Figure) -> Vec<Chart> {
    let Content::Panels(panels) = &figure.content else { return Vec::new() };
    let one = |(k, panel): (usize, &Panel)| {
        let title = match panels.panels.len() {
            1 => figure.title.clone(),
            _ => format!(
                "{}: {}",
                figure.title,
                if panel.y.label.is_empty() { (k + 1).to_string() } else { panel.y.label.clone() }
            ),
        };
        panel_chart(theme, &title, &panels.x, panel)
    };
    panels.panels.iter().enumerate().map(one).collect()
}

fn panel_chart(theme: &WindowTheme, title: &str, x: &Axis, panel: &Panel) -> Chart {
    let mut chart = Chart::new(&plain_text(title), &plain_text(&x.text()), &plain_text(&panel.y.text()));
    chart.scales = [scale_of(x), scale_of(&panel.y)];
    chart.range = [x.range, panel.y.range];
    for series in &panel.series {
        chart = add_series(chart, theme, series);
    }
    for mark in &panel.marks {
        match mark {
            Mark::Point { x, y, text, colour } | Mark::Cross { x, y, text, colour } => {
                let colour = Some(window_colour(theme, *colour));
                chart.spots.push(LabelledPoint {
                    at: [*x, *y],
                    label: plain_text(text).into_owned(),
                    colour,
                });
            }
            Mark::Level { y, .. } => chart.levels.push(*y),
            Mark::Instant { x, text } => chart.add_mark(*x, plain_text(text)),
        }
    }
    chart
}

fn scale_of(axis: &Axis) -> AxisScale {
    match axis.scale {
        Scale::Logarithmic => AxisScale::Log,
        Scale::Linear | Scale::Degrees => AxisScale::Linear,
    }
}

fn add_series(chart: Chart, theme: &WindowTheme, series: &Series) -> Chart {
    let colour = window_colour(theme, series.colour);
    let dash = match series.dash {
        Dash::Solid => LineDash::Solid,
        Dash::Dashed => LineDash::Dashed,
        Dash::Dotted => LineDash::Dotted,
    };
    let points: Vec<[f64; 2]> = series.points.rows().into_iter().map(|row| [row[0], row[1]]).collect();
    match points.windows(2).all(|pair| pair[0][0] <= pair[1][0]) {
        true => chart.with_curve(&plain_text(&series.name), colour, dash, points),
        false => chart.with_path(&plain_text(&series.name), colour, dash, points),
    }
}

/// Returns a report's text in the letters of the window's font: exponents of ten stand behind a circumflex.
fn plain_text(text: &str) -> Cow<'_, str> {
    if !text.contains(|letter| plain_superscript(letter).is_some()) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len() + 1);
    let mut is_raised = false;
    for letter in text.chars() {
        let raised = plain_superscript(letter);
        if raised.is_some() && !is_raised {
            plain.push('^');
        }
        is_raised = raised.is_some();
        plain.push(raised.unwrap_or(letter));
    }
    Cow::Owned(plain)
}

/// Returns the plain form of a raised digit or sign; `None` for another letter.
fn plain_superscript(letter: char) -> Option<char> {
    const RAISED: &str = "\u{2070}\u{b9}\u{b2}\u{b3}\u{2074}\u{2075}\u{2076}\u{2077}\u{2078}\u{2079}\u{207b}";
    RAISED.chars().position(|one| one == letter).and_then(|place| "0123456789-".chars().nth(place))
}

/// Returns the window's colour for one of a report.
fn window_colour(theme: &WindowTheme, colour: Colour) -> Color32 {
    let place = Colour::CYCLE.iter().position(|one| *one == colour);
    place.map_or(theme.weak, |place| match theme.curves.get(place) {
        Some(colour) => *colour,
        None => theme.overlays[place % theme.overlays.len()],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theme::DARK;

    #[test]
    fn every_panel_becomes_a_plot_with_its_curves_and_marks() {
        let axis = || Axis::logarithmic("effort", "V");
        let series = vec![Series::dashed_line("own", Colour::Second, [(1.0, 2.0), (3.0, 4.0)])];
        let mark = Mark::Cross { x: 1.0, y: 2.0, text: "design 1".to_owned(), colour: Colour::First };
        let panel = Panel::new(Axis::linear("residual", "mrad/s"), series).with_marks(vec![mark]);
        let figure = Figure::new("Residual against effort", axis(), vec![panel.clone(), panel]);
        let charts = figure_charts(&DARK, &figure);
        assert_eq!(charts.len(), 2);
        let chart = &charts[0];
        assert_eq!(chart.title, "Residual against effort: residual");
        assert_eq!(chart.scales, [AxisScale::Log, AxisScale::Linear]);
        assert_eq!((chart.curves[0].colour, chart.curves[0].dash), (DARK.curves[1], LineDash::Dashed));
        assert_eq!(chart.spots[0].at, [1.0, 2.0]);
    }

    #[test]
    fn exponents_stand_behind_a_circumflex() {
        assert_eq!(plain_text("3.2\u{b7}10\u{207b}\u{2075} rad"), "3.2\u{b7}10^-5 rad");
        assert_eq!(plain_text("m/s"), "m/s");
    }

    #[test]
    fn distances_are_parts_of_the_plot() {
        let scales = [AxisScale::Log, AxisScale::Linear];
        let click = FigureClick { figure: 0, at: [10.0, 1.0], extent: [2.0, 4.0], scales };
        assert!((click.distance([100.0, 1.0]) - 0.5).abs() < 1e-12);
        assert!((click.distance([10.0, 3.0]) - 0.5).abs() < 1e-12);
    }
}
