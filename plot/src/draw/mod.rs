//! Draws a figure on any backend of plotters: title, legend, panels or cells.
//!
//! Lengths here are pixels of the figure; a [`Sheet`] turns them into units of the backend.

mod heat;
mod legend;
mod panels;

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{Circle, PathElement, Polygon, Rectangle};
use plotters_backend::DrawingBackend;
use plotters_backend::text_anchor::{HPos, Pos, VPos};

use crate::figure::{Content, Figure, Point};
use crate::ink::Ink;

/// Width of every figure.
const WIDTH: f64 = 640.0;
/// Height of a title.
const TITLE: f64 = 26.0;
/// Space at the left and the right of titles, legends and scales.
const MARGIN: f64 = 12.0;

/// The place of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Setting {
    /// On a page that has a ground of its own and writes the title itself.
    Page,
    /// Alone: with a ground and its title.
    Alone,
}

/// The result of drawing on a backend.
type DrawingResult<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// Width and height, pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Size {
    pub width: f64,
    pub height: f64,
}

/// Returns width and height of a figure.
pub(crate) fn size(figure: &Figure, setting: Setting) -> Size {
    let content = match &figure.content {
        Content::Panels(panels) => panels::height(panels),
        Content::HeatMap(map) => heat::height(map),
    };
    Size { width: WIDTH, height: top_margin(setting) + content }
}

/// Draws a figure on an area that has `unit` of its units in a pixel.
pub(crate) fn draw<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    unit: f64,
    figure: &Figure,
    setting: Setting,
) -> DrawingResult<DB> {
    let sheet = Sheet { area, unit };
    if setting == Setting::Alone {
        let Size { width, height } = size(figure, setting);
        sheet.rectangle(Ink::Paper, (0.0, 0.0), (width, height))?;
        sheet.text(Ink::Title, (MARGIN, 0.6 * TITLE), LEFT, &figure.title)?;
    }
    match &figure.content {
        Content::Panels(panels) => panels::draw(&sheet, panels, top_margin(setting)),
        Content::HeatMap(map) => heat::draw(&sheet, map, top_margin(setting)),
    }
}

fn top_margin(setting: Setting) -> f64 {
    if setting == Setting::Alone { TITLE } else { 0.0 }
}

/// Text to the right of its point, at half its height.
const LEFT: Pos = Pos { h_pos: HPos::Left, v_pos: VPos::Center };
/// Text about its point.
const CENTRE: Pos = Pos { h_pos: HPos::Center, v_pos: VPos::Center };
/// Text to the left of its point, at half its height.
const RIGHT: Pos = Pos { h_pos: HPos::Right, v_pos: VPos::Center };

/// A drawing area measured in pixels; its points count from the upper left corner.
struct Sheet<'a, DB: DrawingBackend> {
    area: &'a DrawingArea<DB, Shift>,
    unit: f64,
}

impl<DB: DrawingBackend> Sheet<'_, DB> {
    /// Returns a length in units of the backend.
    fn units(&self, pixels: f64) -> i32 {
        (pixels * self.unit).round() as i32
    }

    fn point(&self, at: impl Into<Point>) -> (i32, i32) {
        let at = at.into();
        (self.units(at.x), self.units(at.y))
    }

    /// Returns the part of the area from a corner on.
    fn part(&self, corner: impl Into<Point>, size: Size) -> DrawingArea<DB, Shift> {
        self.area.clone().shrink(self.point(corner), (self.units(size.width), self.units(size.height)))
    }

    fn line(&self, ink: Ink, from: impl Into<Point>, to: impl Into<Point>) -> DrawingResult<DB> {
        self.area.draw(&PathElement::new(vec![self.point(from), self.point(to)], ink.style()))
    }

    fn rectangle(&self, ink: Ink, from: impl Into<Point>, to: impl Into<Point>) -> DrawingResult<DB> {
        self.area.draw(&Rectangle::new([self.point(from), self.point(to)], ink.style()))
    }

    fn polygon(&self, ink: Ink, corners: &[Point]) -> DrawingResult<DB> {
        let corners: Vec<(i32, i32)> = corners.iter().map(|at| self.point(*at)).collect();
        self.area.draw(&Polygon::new(corners, ink.style()))
    }

    fn ring(&self, ink: Ink, centre: impl Into<Point>, radius: f64) -> DrawingResult<DB> {
        self.area.draw(&Circle::new(self.point(centre), self.units(radius), ink.style()))
    }

    fn cross(&self, ink: Ink, centre: Point, radius: f64) -> DrawingResult<DB> {
        let Point { x, y } = centre;
        self.line(ink, (x - radius, y - radius), (x + radius, y + radius))?;
        self.line(ink, (x - radius, y + radius), (x + radius, y - radius))
    }

    fn text(&self, ink: Ink, at: impl Into<Point>, pos: Pos, text: &str) -> DrawingResult<DB> {
        self.area.draw_text(text, &ink.text(self.unit, pos), self.point(at))
    }
}
