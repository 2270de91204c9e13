//! Coloured cells: rows and columns of shares with their numbers, under a scale of colours.

use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::DrawingArea;
use plotters::element::{Rectangle, Text};
use plotters_backend::DrawingBackend;

use super::{CENTRE, DrawingResult, LEFT, MARGIN, RIGHT, Sheet, Size, WIDTH};
use crate::font;
use crate::heat_map::{HeatMap, HeatRow};
use crate::ink::{FONT_PX, Ink};

/// Heights of a row, of the heading over the rows, and of the scale of colours.
const ROW: f64 = 26.0;
const HEADING: f64 = 28.0;
const SCALE: f64 = 44.0;
/// Width of a cell of the scale.
const SCALE_CELL: f64 = 22.0;
/// Strength of the colour of a share of 1: the grid around it stays visible.
const FULL: f64 = 0.95;
/// From this share on the cell's colour is so strong that the number is written in the colour of the ground.
const STRONG: f64 = 0.75;
/// Sine and cosine of the angle by which headings rise (38 degrees).
const RISE: (f64, f64) = (0.62, 0.79);

type Cells<DB> = DrawingArea<DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The place of the cells.
struct Layout {
    left: f64,
    top: f64,
    cell_width: f64,
}

impl Layout {
    fn new(map: &HeatMap) -> Self {
        let names = map.rows.iter().map(|row| font::width(&row.name, FONT_PX));
        let left = names.fold(60.0, f64::max) + MARGIN + 8.0;
        let mut widths = map.columns.iter().map(|column| font::width(column, FONT_PX));
        let longest = widths.clone().fold(0.0, f64::max);
        // a heading may lean beyond the last cell
        let room = WIDTH - left - 1.5 * MARGIN - RISE.1 * widths.next_back().unwrap_or(0.0);
        let count = map.columns.len().max(1) as f64;
        // it starts in the middle of its cell, so half a cell of its room is in the table
        let cell_width = (room / (count - 0.5)).min((WIDTH - left - MARGIN) / count);
        Self { left, top: SCALE + RISE.0 * longest + 14.0 + HEADING, cell_width }
    }
}

/// Returns the height of the map with its scale.
pub(super) fn height(map: &HeatMap) -> f64 {
    Layout::new(map).top + ROW * map.rows.len() as f64 + MARGIN
}

/// Draws the map with its scale.
pub(super) fn draw<DB: DrawingBackend>(sheet: &Sheet<'_, DB>, map: &HeatMap, top: f64) -> DrawingResult<DB> {
    draw_scale(sheet, map, top)?;
    let mut layout = Layout::new(map);
    layout.top += top;
    for (k, column) in map.columns.iter().enumerate() {
        let x = layout.left + (k as f64 + 0.5) * layout.cell_width;
        sheet.text(Ink::RisingText, (x, layout.top - HEADING - 6.0), LEFT, column)?;
    }
    sheet.text(Ink::SoftText, (MARGIN, layout.top - 14.0), LEFT, &map.heading)?;
    for (k, row) in map.rows.iter().enumerate() {
        let middle = layout.top + (k as f64 + 0.5) * ROW;
        sheet.text(Ink::Text, (layout.left - 8.0, middle), RIGHT, &row.name)?;
    }
    if map.rows.is_empty() || map.columns.is_empty() {
        return Ok(());
    }
    draw_cells(sheet, map, &layout)
}

/// Returns the scale of colours with what it means.
fn draw_scale<DB: DrawingBackend>(sheet: &Sheet<'_, DB>, map: &HeatMap, top: f64) -> DrawingResult<DB> {
    for k in 0..=10 {
        let x = MARGIN + SCALE_CELL * f64::from(k);
        let corners = [sheet.point((x, top + 8.0)), sheet.point((x + SCALE_CELL, top + 20.0))];
        let style = Ink::Cell.with_strength(FULL * 0.1 * f64::from(k));
        sheet.area.draw(&Rectangle::new(corners, style))?;
        if k % 5 == 0 {
            let middle = (x + 0.5 * SCALE_CELL, top + 30.0);
            sheet.text(Ink::SoftText, middle, CENTRE, &format!("{} %", 10 * k))?;
        }
    }
    let right = MARGIN + 11.0 * SCALE_CELL + 18.0;
    sheet.text(Ink::Text, (right, top + 14.0), LEFT, &map.meaning)?;
    if map.framed.is_empty() {
        return Ok(());
    }
    let (from, to) = ((right + 1.5, top + 26.5), (right + SCALE_CELL - 1.5, top + 35.5));
    sheet.rectangle(Ink::CellFrame, from, to)?;
    sheet.text(Ink::Text, (right + SCALE_CELL + 6.0, top + 31.0), LEFT, &map.frame_meaning)
}

/// Returns the cells, in a system of coordinates whose unit is a cell.
fn draw_cells<DB: DrawingBackend>(
    sheet: &Sheet<'_, DB>,
    map: &HeatMap,
    layout: &Layout,
) -> DrawingResult<DB> {
    let (columns, rows) = (map.columns.len() as f64, map.rows.len() as f64);
    let size = Size { width: columns * layout.cell_width, height: rows * ROW };
    let area = sheet.part((layout.left, layout.top), size);
    let (x, y) = area.get_pixel_range();
    let cells = area.apply_coord_spec(Cartesian2d::<RangedCoordf64, RangedCoordf64>::new(
        0.0..columns,
        0.0..rows,
        (x, y),
    ));
    for (k, row) in map.rows.iter().enumerate() {
        draw_row(sheet, &cells, map, k, row)?;
    }
    let inset = (1.5 / layout.cell_width, 1.5 / ROW);
    for (row, column) in &map.framed {
        let (x, y) = (*column as f64, *row as f64);
        let corners = [(x + inset.0, y + inset.1), (x + 1.0 - inset.0, y + 1.0 - inset.1)];
        cells.draw(&Rectangle::new(corners, Ink::CellFrame.style()))?;
    }
    Ok(())
}

fn draw_row<DB: DrawingBackend>(
    sheet: &Sheet<'_, DB>,
    cells: &Cells<DB>,
    map: &HeatMap,
    k: usize,
    row: &HeatRow,
) -> DrawingResult<DB> {
    let (y, columns) = (k as f64, map.columns.len());
    if let Some(cover) = &row.cover {
        let edge = 1.0 / ROW;
        let corners = [(0.0, y + edge), (columns as f64, y + 1.0 - edge)];
        cells.draw(&Rectangle::new(corners, Ink::Cover.style()))?;
        let middle = (0.5 * columns as f64, y + 0.5);
        return cells.draw(&Text::new(cover.as_str(), middle, Ink::Text.text(sheet.unit, CENTRE)));
    }
    for column in 0..columns {
        let (x, share) = (column as f64, map.share(k, column));
        let strength = share.unwrap_or(0.0);
        let style = Ink::Cell.with_strength(FULL * strength);
        cells.draw(&Rectangle::new([(x, y), (x + 1.0, y + 1.0)], style))?;
        let number = share.map_or_else(|| "\u{2013}".to_owned(), |share| format!("{:.0}", 100.0 * share));
        let ink = if strength > STRONG { Ink::InverseText } else { Ink::Text };
        cells.draw(&Text::new(number, (x + 0.5, y + 0.5), ink.text(sheet.unit, CENTRE)))?;
    }
    Ok(())
}
