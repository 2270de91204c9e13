//! The legend: rows of samples with their names above the panels, never on the data.

use plotters_backend::DrawingBackend;

use super::{DrawingResult, LEFT, MARGIN, Sheet, WIDTH};
use crate::figure::{Band, Mark, Panel, Point, Series};
use crate::font;
use crate::ink::{FONT_PX, Ink};

/// Height of a row.
const ROW: f64 = 20.0;
/// Start of the first sample, and its length.
const LEFT_EDGE: f64 = 20.0;
const SAMPLE: f64 = 26.0;
/// Space between a sample and its name, and after the name.
const SPACES: (f64, f64) = (8.0, 18.0);
/// Radius of rings, here and in panels.
pub(super) const RING: f64 = 4.5;

/// Entries of the legend, each with its place.
pub(super) struct Legend<'a> {
    entries: Vec<(Point, Entry<'a>)>,
    rows: usize,
}

/// A curve, a band, or a mark.
#[derive(Clone, Copy)]
enum Entry<'a> {
    Curve(&'a Series),
    Region(&'a Band),
    Marked(&'a Mark),
}

impl<'a> Legend<'a> {
    /// Lays the entries of all panels in rows; an entry that repeats an earlier name is left out.
    pub fn new(panels: &'a [Panel]) -> Self {
        let mut found: Vec<Entry<'a>> = Vec::new();
        for entry in panels.iter().flat_map(entries) {
            if !entry.name().is_empty() && found.iter().all(|other| other.name() != entry.name()) {
                found.push(entry);
            }
        }
        let (mut x, mut row, mut placed) = (0.0, 0usize, Vec::new());
        for entry in found {
            let width = SAMPLE + SPACES.0 + font::width(entry.name(), FONT_PX) + SPACES.1;
            if x > 0.0 && LEFT_EDGE + x + width - SPACES.1 > WIDTH - MARGIN {
                (x, row) = (0.0, row + 1);
            }
            placed.push((Point::new(LEFT_EDGE + x, 10.0 + row as f64 * ROW), entry));
            x += width;
        }
        let rows = if placed.is_empty() { 0 } else { row + 1 };
        Self { entries: placed, rows }
    }

    pub fn height(&self) -> f64 {
        self.rows as f64 * ROW + 12.0
    }

    pub fn draw<DB: DrawingBackend>(&self, sheet: &Sheet<'_, DB>, top: f64) -> DrawingResult<DB> {
        for (at, entry) in &self.entries {
            let (from, to) = (Point::new(at.x, top + at.y), Point::new(at.x + SAMPLE, top + at.y));
            entry.draw_sample(sheet, from, to)?;
            sheet.text(Ink::Text, (to.x + SPACES.0, to.y), LEFT, entry.name())?;
        }
        Ok(())
    }
}

impl Entry<'_> {
    fn name(&self) -> &str {
        match self {
            Entry::Curve(series) => &series.name,
            Entry::Region(band) => &band.name,
            Entry::Marked(
                Mark::Point { text, .. }
                | Mark::Cross { text, .. }
                | Mark::Level { text, .. }
                | Mark::Instant { text, .. },
            ) => text,
        }
    }

    fn draw_sample<DB: DrawingBackend>(
        &self,
        sheet: &Sheet<'_, DB>,
        from: Point,
        to: Point,
    ) -> DrawingResult<DB> {
        match self {
            Entry::Curve(series) => sheet.line(Ink::Curve(series.colour, series.dash), from, to),
            Entry::Region(band) => {
                let corners =
                    [(from.x, from.y - 5.0), (to.x, to.y - 5.0), (to.x, to.y + 5.0), (from.x, from.y + 5.0)];
                sheet.polygon(Ink::Band(band.colour), &corners.map(Point::from))
            }
            Entry::Marked(Mark::Point { colour, .. }) => {
                sheet.ring(Ink::Ring(*colour), (0.5 * (from.x + to.x), from.y), RING)
            }
            Entry::Marked(Mark::Cross { colour, .. }) => {
                let middle = Point::new(0.5 * (from.x + to.x), from.y);
                sheet.cross(Ink::Ring(*colour), middle, RING)
            }
            Entry::Marked(_) => sheet.line(Ink::Guide, from, to),
        }
    }
}

fn entries(panel: &Panel) -> impl Iterator<Item = Entry<'_>> {
    let curves = panel.series.iter().map(Entry::Curve);
    curves.chain(panel.bands.iter().map(Entry::Region)).chain(panel.marks.iter().map(Entry::Marked))
}
