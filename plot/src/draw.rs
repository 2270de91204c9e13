//! Draws a figure as SVG.

use crate::element::{Anchor, Svg, escape, px, width_of};
use crate::heat;
use crate::theme::{FIGURE_CSS, dash_class, fill_class, stroke_class};
use crate::thin::thin;
use crate::ticks::{Ruler, Tightness};
use crate::{Band, Figure, Mark, Panel, Series};

pub(super) const WIDTH: f64 = 640.0;
pub(super) const FONT: f64 = 12.0;
const RIGHT: f64 = 18.0;
const GAP: f64 = 14.0;
const LEGEND_ROW: f64 = 20.0;
const SAMPLE: f64 = 26.0;
/// Curves may leave the panel by this many panel heights before they are cut; the viewer clips the rest.
const FARTHEST: f64 = 20.0;

/// The figure as an `<svg>` element for a page that carries [`FIGURE_CSS`]. Deterministic.
pub fn inline_svg(figure: &Figure) -> String {
    drawn(figure, "")
}

/// The figure as an SVG document that stands alone.
pub fn standalone_svg(figure: &Figure) -> String {
    drawn(
        figure,
        &format!(
            "<style>{FIGURE_CSS}</style><rect width=\"100%\" height=\"100%\" style=\"fill:var(--panel)\"/>\n"
        ),
    )
}

fn drawn(figure: &Figure, prologue: &str) -> String {
    if let Some(cells) = &figure.heat {
        return heat::svg(&figure.title, cells, prologue);
    }
    let legend = Legend::of(figure);
    let top = legend.height() + 8.0;
    let heights: f64 = figure.panels.iter().map(|p| p.height + GAP).sum();
    let total = top + heights + 34.0;
    let mut svg = Svg::default();
    svg.raw(&format!(
        "<svg class=\"fig\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{prologue}",
        px(WIDTH),
        px(total),
        escape(&figure.title)
    ));
    legend.draw(&mut svg);
    let x = Ruler::new(&figure.x, abscissae(figure), Tightness::Tight);
    let rulers: Vec<Ruler> =
        figure.panels.iter().map(|p| Ruler::new(&p.y, ordinates(p), Tightness::Padded)).collect();
    let left = left_margin(&rulers);
    let mut y0 = top;
    for (panel, ruler) in figure.panels.iter().zip(&rulers) {
        let frame =
            Frame { left, top: y0, width: WIDTH - left - RIGHT, height: panel.height, x: &x, y: ruler };
        draw_panel(&mut svg, panel, &frame);
        y0 += panel.height + GAP;
    }
    label_x(&mut svg, figure, &x, left, y0 - GAP);
    svg.raw("</svg>\n");
    svg.finish()
}

fn abscissae(figure: &Figure) -> impl Iterator<Item = f64> + '_ {
    let series =
        figure.panels.iter().flat_map(|p| p.series.iter().flat_map(|s| s.points.iter().map(|q| q.0)));
    series.chain(figure.panels.iter().flat_map(|p| p.bands.iter().flat_map(|b| b.points.iter().map(|q| q.0))))
}

fn ordinates(panel: &Panel) -> impl Iterator<Item = f64> + '_ {
    let series = panel.series.iter().flat_map(|s| s.points.iter().map(|q| q.1));
    let bands = panel.bands.iter().flat_map(|b| b.points.iter().flat_map(|q| [q.1, q.2]));
    let marks = panel.marks.iter().filter_map(|m| match m {
        Mark::Point { y, .. } | Mark::Level { y, .. } => Some(*y),
        Mark::Instant { .. } => None,
    });
    series.chain(bands).chain(marks)
}

fn left_margin(rulers: &[Ruler]) -> f64 {
    let ticks = rulers.iter().flat_map(Ruler::major);
    ticks.map(|t| width_of(&t.text, FONT)).fold(20.0, f64::max) + 34.0
}

/// A panel's place on the page and its rulers.
struct Frame<'a> {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: &'a Ruler,
    y: &'a Ruler,
}

impl Frame<'_> {
    /// A point relative to the panel's corner; `None` where it cannot be drawn.
    fn point(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let across = self.x.place(x)?;
        let up = self.y.place(y)?.clamp(-FARTHEST, FARTHEST);
        Some((across * self.width, (1.0 - up) * self.height))
    }

    fn at_x(&self, x: f64) -> Option<f64> {
        self.x.place(x).map(|p| p * self.width)
    }

    fn at_y(&self, y: f64) -> Option<f64> {
        self.y.place(y).map(|p| (1.0 - p) * self.height)
    }
}

fn draw_panel(svg: &mut Svg, panel: &Panel, frame: &Frame<'_>) {
    label_y(svg, panel, frame);
    svg.raw(&format!(
        "<svg x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\">\n",
        px(frame.left),
        px(frame.top),
        px(frame.width),
        px(frame.height)
    ));
    draw_grid(svg, frame);
    for band in &panel.bands {
        draw_band(svg, band, frame);
    }
    for mark in &panel.marks {
        draw_guide(svg, mark, frame);
    }
    for series in &panel.series {
        draw_series(svg, series, frame);
    }
    for mark in &panel.marks {
        draw_ring(svg, mark, frame);
    }
    svg.raw("</svg>\n");
    svg.frame("frame", (frame.left, frame.top), (frame.width, frame.height));
}

fn draw_grid(svg: &mut Svg, frame: &Frame<'_>) {
    for x in frame.x.minor().into_iter().filter_map(|v| frame.at_x(v)) {
        svg.line("minor", (x, 0.0), (x, frame.height));
    }
    for x in frame.x.major().iter().filter_map(|t| frame.at_x(t.value)) {
        svg.line("grid", (x, 0.0), (x, frame.height));
    }
    for y in frame.y.major().iter().filter_map(|t| frame.at_y(t.value)) {
        svg.line("grid", (0.0, y), (frame.width, y));
    }
}

fn draw_series(svg: &mut Svg, series: &Series, frame: &Frame<'_>) {
    let points = thin(&series.points);
    let mut runs = vec![Vec::new()];
    for point in points {
        match frame.point(point) {
            Some(placed) => runs.last_mut().into_iter().for_each(|run| run.push(placed)),
            None => runs.push(Vec::new()),
        }
    }
    svg.runs(&format!("line {}{}", stroke_class(series.colour), dash_class(series.dash)), &runs);
}

fn draw_band(svg: &mut Svg, band: &Band, frame: &Frame<'_>) {
    let upper = band.points.iter().filter_map(|p| frame.point((p.0, p.2)));
    let floor = frame.height * 2.0;
    let lower = band
        .points
        .iter()
        .rev()
        .filter_map(|p| frame.at_x(p.0).map(|x| (x, frame.at_y(p.1).unwrap_or(floor))));
    let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
    svg.polygon(&format!("band {}", fill_class(band.colour)), &outline);
}

fn draw_guide(svg: &mut Svg, mark: &Mark, frame: &Frame<'_>) {
    match mark {
        Mark::Level { y, .. } => {
            frame.at_y(*y).into_iter().for_each(|y| svg.line("guide", (0.0, y), (frame.width, y)));
        }
        Mark::Instant { x, .. } => {
            frame.at_x(*x).into_iter().for_each(|x| svg.line("guide", (x, 0.0), (x, frame.height)));
        }
        Mark::Point { .. } => {}
    }
}

fn draw_ring(svg: &mut Svg, mark: &Mark, frame: &Frame<'_>) {
    if let Mark::Point { x, y, colour, .. } = mark
        && let Some(at) = frame.point((*x, *y))
    {
        svg.ring(&format!("ring {}", stroke_class(*colour)), at, 4.5);
    }
}

fn label_y(svg: &mut Svg, panel: &Panel, frame: &Frame<'_>) {
    for tick in frame.y.major() {
        if let Some(y) = frame.at_y(tick.value) {
            svg.text("axis", (frame.left - 7.0, frame.top + y + 4.0), Anchor::End, &tick.text);
        }
    }
    svg.upright("", (13.0, frame.top + 0.5 * frame.height), &panel.y.text());
}

fn label_x(svg: &mut Svg, figure: &Figure, ruler: &Ruler, left: f64, bottom: f64) {
    let width = WIDTH - left - RIGHT;
    for tick in ruler.major() {
        if let Some(place) = ruler.place(tick.value) {
            svg.text("axis", (left + place * width, bottom + 16.0), Anchor::Middle, &tick.text);
        }
    }
    svg.text("", (left + 0.5 * width, bottom + 34.0), Anchor::Middle, &figure.x.text());
}

/// Entries of the legend, each with its place.
struct Legend<'a> {
    entries: Vec<(f64, f64, Entry<'a>)>,
    rows: usize,
}

/// A curve, a band, or a mark, with its text.
#[derive(Clone, Copy)]
enum Entry<'a> {
    Curve(&'a Series),
    Region(&'a Band),
    Pointed(&'a Mark, &'a str),
}

impl Entry<'_> {
    fn text(&self) -> &str {
        match self {
            Entry::Curve(series) => &series.name,
            Entry::Region(band) => &band.name,
            Entry::Pointed(_, text) => text,
        }
    }
}

impl<'a> Legend<'a> {
    /// Lays the entries of all panels in rows; an entry that repeats an earlier text is left out.
    fn of(figure: &'a Figure) -> Self {
        let mut found: Vec<Entry<'a>> = Vec::new();
        for entry in figure.panels.iter().flat_map(entries_of) {
            if !entry.text().is_empty() && found.iter().all(|other| other.text() != entry.text()) {
                found.push(entry);
            }
        }
        let (mut x, mut row, mut entries) = (0.0, 0usize, Vec::new());
        for entry in found {
            let width = SAMPLE + 8.0 + width_of(entry.text(), FONT) + 16.0;
            if x > 0.0 && x + width > WIDTH - 20.0 {
                (x, row) = (0.0, row + 1);
            }
            entries.push((20.0 + x, 14.0 + row as f64 * LEGEND_ROW, entry));
            x += width;
        }
        let rows = if entries.is_empty() { 0 } else { row + 1 };
        Self { entries, rows }
    }

    fn height(&self) -> f64 {
        self.rows as f64 * LEGEND_ROW + 4.0
    }

    fn draw(&self, svg: &mut Svg) {
        for (x, y, entry) in &self.entries {
            let (from, to) = ((*x, y - 4.0), (x + SAMPLE, y - 4.0));
            match entry {
                Entry::Curve(series) => {
                    svg.line(
                        &format!("line {}{}", stroke_class(series.colour), dash_class(series.dash)),
                        from,
                        to,
                    );
                }
                Entry::Region(band) => {
                    let corners = [(from.0, y - 9.0), (to.0, y - 9.0), (to.0, y + 1.0), (from.0, y + 1.0)];
                    svg.polygon(&format!("band {}", fill_class(band.colour)), &corners);
                }
                Entry::Pointed(Mark::Point { colour, .. }, _) => {
                    svg.ring(&format!("ring {}", stroke_class(*colour)), (x + 0.5 * SAMPLE, y - 4.0), 4.5);
                }
                Entry::Pointed(..) => svg.line("guide", from, to),
            }
            svg.text("", (to.0 + 8.0, *y), Anchor::Start, entry.text());
        }
    }
}

fn entries_of(panel: &Panel) -> impl Iterator<Item = Entry<'_>> {
    let marks = panel.marks.iter().map(|mark| match mark {
        Mark::Point { text, .. } | Mark::Level { text, .. } | Mark::Instant { text, .. } => {
            Entry::Pointed(mark, text)
        }
    });
    panel.series.iter().map(Entry::Curve).chain(panel.bands.iter().map(Entry::Region)).chain(marks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Colour};

    fn figure() -> Figure {
        let time = |k: usize| k as f64 * 1e-3;
        let wave: Vec<(f64, f64)> = (0..20_000).map(|k| (time(k), (3.0 * time(k)).sin())).collect();
        let panel = Panel::of(
            Axis::linear("hub rate", "rad/s"),
            vec![Series::solid("a < b & c", Colour::First, wave)],
        );
        let marks = vec![Mark::Level { y: 0.5, text: "limit".to_owned() }];
        Figure::new("wave", Axis::linear("time", "s"), vec![panel.marked(marks)])
    }

    #[test]
    fn text_is_escaped_and_the_picture_small() {
        let svg = inline_svg(&figure());
        assert!(svg.contains("a &lt; b &amp; c") && !svg.contains("a < b"));
        assert!(svg.len() < 40_000, "{}", svg.len());
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        assert_eq!(inline_svg(&figure()), inline_svg(&figure()));
    }

    #[test]
    fn values_that_cannot_be_drawn_break_the_curve() {
        let points = vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, f64::INFINITY), (3.0, 2.0), (4.0, 1.0)];
        let panel = Panel::of(Axis::logarithmic("y", ""), vec![Series::solid("s", Colour::Second, points)]);
        let svg = standalone_svg(&Figure::new("gaps", Axis::linear("x", ""), vec![panel]));
        let path = svg.lines().find(|line| line.contains("line s2") && line.matches('M').count() == 2);
        assert!(path.is_some(), "{svg}");
    }

    #[test]
    fn an_empty_figure_is_drawn_as_empty_axes() {
        let svg = inline_svg(&Figure::new(
            "nothing",
            Axis::linear("x", ""),
            vec![Panel::of(Axis::linear("y", ""), vec![])],
        ));
        assert!(svg.contains("<rect") && svg.ends_with("</svg>\n"));
    }
}
