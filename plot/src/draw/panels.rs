//! Panels over one x axis, each a chart of plotters.

use ndarray::Axis as Dimension;
use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian2d;
use plotters::element::{Circle, EmptyElement, PathElement, Polygon};
use plotters_backend::DrawingBackend;
use plotters_backend::text_anchor::Pos;

use super::legend::{Legend, RING};
use super::{DrawingResult, Sheet, Size, WIDTH};
use crate::clip;
use crate::figure::{Aspect, Band, BandPoint, Mark, Panel, Panels, Point, Series};
use crate::font;
use crate::ink::{FONT_PX, Ink};
use crate::ruler::{Margin, Ruler};
use crate::thinning::{MOST_POINTS, thin_points};

/// Space at the right of panels, and below each.
const RIGHT: f64 = 18.0;
const GAP: f64 = 14.0;
/// Height of the numbers and the label below the last panel.
const FOOT: f64 = 36.0;
/// Space below the label of the x axis.
const BOTTOM: f64 = 6.0;
/// Width of the label at the left, and where it starts.
const LABEL: f64 = 31.0;
const LABEL_EDGE: f64 = 3.0;
/// Length of the marks at the numbers of an axis; plotters leaves twice as much between the axis and the numbers.
const TICK: f64 = 3.5;
/// Limits of a panel's height: below, its numbers lie on each other; above, the figure takes more than a page.
const HEIGHTS: (f64, f64) = (40.0, 2000.0);
/// Half the length of the dash that stands for a single point of a curve.
const DOT: f64 = 1.0;

type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<Ruler, Ruler>>;

/// Returns the height of the panels with their legend.
pub(super) fn height(all: &Panels) -> f64 {
    let panels: f64 = all.panels.iter().map(|panel| height_of(panel) + GAP).sum();
    Legend::new(&all.panels).height() + panels - GAP + FOOT + BOTTOM
}

fn height_of(panel: &Panel) -> f64 {
    let height = if panel.height.is_finite() { panel.height } else { 200.0 };
    height.clamp(HEIGHTS.0, HEIGHTS.1).round()
}

/// Draws the panels with their legend.
pub(super) fn draw<DB: DrawingBackend>(sheet: &Sheet<'_, DB>, all: &Panels, top: f64) -> DrawingResult<DB> {
    let legend = Legend::new(&all.panels);
    legend.draw(sheet, top)?;
    let x = Ruler::new(&all.x, abscissae(all), Margin::Tight);
    let rulers: Vec<Ruler> =
        all.panels.iter().map(|panel| Ruler::new(&panel.y, ordinates(panel), Margin::Padded)).collect();
    let left = left_margin(&rulers);
    let (x, rulers) = match all.aspect {
        Aspect::Free => (x, rulers),
        Aspect::Equal => with_equal_units(x, rulers, &all.panels, WIDTH - left - RIGHT),
    };
    let mut y0 = top + legend.height();
    for (k, (panel, y)) in all.panels.iter().zip(&rulers).enumerate() {
        let is_last = k + 1 == all.panels.len();
        let frame = Frame { top: y0, left, x: &x, y, foot: is_last.then(|| all.x.text()) };
        draw_panel(sheet, panel, &frame)?;
        y0 += height_of(panel) + GAP;
    }
    Ok(())
}

/// Widens x until the tallest range fits its panel, and then each y to its panel.
fn with_equal_units(x: Ruler, rulers: Vec<Ruler>, panels: &[Panel], width: f64) -> (Ruler, Vec<Ruler>) {
    let span = |ruler: &Ruler| ruler.ends().1 - ruler.ends().0;
    let units = |(ruler, panel): (&Ruler, &Panel)| span(ruler) / height_of(panel);
    let unit = rulers.iter().zip(panels).map(units).fold(span(&x) / width, f64::max);
    let wide = x.widen(unit * width / span(&x));
    let high = |(ruler, panel): (&Ruler, &Panel)| ruler.widen(unit * height_of(panel) / span(ruler));
    (wide, rulers.iter().zip(panels).map(high).collect())
}

fn abscissae(all: &Panels) -> impl Iterator<Item = f64> + '_ {
    all.panels.iter().flat_map(|panel| {
        let series = panel.series.iter().flat_map(|s| s.points.index_axis(Dimension(1), 0).to_vec());
        series.chain(panel.bands.iter().flat_map(|b| b.points.index_axis(Dimension(1), 0).to_vec()))
    })
}

fn ordinates(panel: &Panel) -> impl Iterator<Item = f64> + '_ {
    let series = panel.series.iter().flat_map(|s| s.points.index_axis(Dimension(1), 1).to_vec());
    let bands = panel.bands.iter().flat_map(|b| b.points.rows().into_iter().flat_map(|row| [row[1], row[2]]));
    let marks = panel.marks.iter().filter_map(|mark| match mark {
        Mark::Point { y, .. } | Mark::Cross { y, .. } | Mark::Level { y, .. } => Some(*y),
        Mark::Instant { .. } => None,
    });
    series.chain(bands).chain(marks)
}

fn left_margin(rulers: &[Ruler]) -> f64 {
    let ticks = rulers.iter().flat_map(Ruler::major);
    ticks.map(|tick| font::width(&tick.text, FONT_PX)).fold(20.0, f64::max) + LABEL
}

/// The place of a panel, its axes, and the label of the x axis if it has one.
struct Frame<'a> {
    top: f64,
    left: f64,
    x: &'a Ruler,
    y: &'a Ruler,
    foot: Option<String>,
}

impl Frame<'_> {
    /// Returns the place of a point on both axes; `None` if it cannot be drawn.
    fn place(&self, x: f64, y: f64) -> Option<Point> {
        Some(Point::new(self.x.place(x)?, self.y.place(y)?))
    }

    /// Returns the values at places on both axes.
    fn values(&self, places: &[Point]) -> Vec<(f64, f64)> {
        places.iter().map(|at| (self.x.value_at(at.x), self.y.value_at(at.y))).collect()
    }
}

fn draw_panel<DB: DrawingBackend>(
    sheet: &Sheet<'_, DB>,
    panel: &Panel,
    frame: &Frame<'_>,
) -> DrawingResult<DB> {
    let chart = draw_axes(sheet, panel, frame)?;
    for band in &panel.bands {
        draw_band(&chart, band, frame)?;
    }
    for mark in &panel.marks {
        draw_guide(&chart, mark, frame)?;
    }
    let dot = DOT / (WIDTH - frame.left - RIGHT);
    for series in &panel.series {
        draw_series(&chart, series, frame, dot)?;
    }
    for mark in &panel.marks {
        draw_symbol(&chart, mark, frame, sheet.units(RING))?;
    }
    let (x, y) = (frame.x.ends(), frame.y.ends());
    let corners = [(x.0, y.0), (x.0, y.1), (x.1, y.1), (x.1, y.0), (x.0, y.0)];
    chart.plotting_area().draw(&PathElement::new(corners.to_vec(), Ink::Frame.style()))
}

/// Draws grid, numbers and labels.
fn draw_axes<'a, DB: DrawingBackend>(
    sheet: &Sheet<'_, DB>,
    panel: &Panel,
    frame: &Frame<'_>,
) -> Result<Chart<'a, DB>, plotters::drawing::DrawingAreaErrorKind<DB::ErrorType>> {
    let foot = if frame.foot.is_some() { FOOT } else { 0.0 };
    let size = Size { width: WIDTH - LABEL_EDGE - RIGHT, height: height_of(panel) + foot };
    let area = sheet.part((LABEL_EDGE, frame.top), size);
    let mut chart = ChartBuilder::on(&area)
        .x_label_area_size(sheet.units(foot))
        .y_label_area_size(sheet.units(frame.left - LABEL_EDGE))
        .build_cartesian_2d(frame.x.clone(), frame.y.clone())?;
    let anywhere = Pos::default();
    let mut mesh = chart.configure_mesh();
    mesh.bold_line_style(Ink::Grid.style())
        .light_line_style(Ink::MinorGrid.style())
        .axis_style(Ink::Frame.style())
        .label_style(Ink::SoftText.text(sheet.unit, anywhere))
        .axis_desc_style(Ink::Text.text(sheet.unit, anywhere))
        .set_all_tick_mark_size(sheet.units(TICK))
        .y_desc(panel.y.text());
    if let Some(text) = &frame.foot {
        mesh.x_desc(text.as_str());
    }
    mesh.draw()?;
    drop(mesh);
    Ok(chart)
}

fn draw_series<DB: DrawingBackend>(
    chart: &Chart<'_, DB>,
    series: &Series,
    frame: &Frame<'_>,
    dot: f64,
) -> DrawingResult<DB> {
    let style = Ink::Curve(series.colour, series.dash).style();
    let x = series.points.index_axis(Dimension(1), 0);
    let turns_back = x.iter().zip(x.iter().skip(1)).any(|(now, next)| next < now);
    let kept: Vec<usize> =
        if turns_back { (0..x.len()).collect() } else { thin_points(series.points.view(), MOST_POINTS / 4) };
    let places = kept.into_iter().map(|k| frame.place(series.points[[k, 0]], series.points[[k, 1]]));
    for run in runs(places) {
        for mut part in clip::polyline(&run) {
            if let [Point { x, y }] = part[..] {
                part = vec![Point::new(x - dot, y), Point::new(x + dot, y)];
            }
            chart.plotting_area().draw(&PathElement::new(frame.values(&part), style))?;
        }
    }
    Ok(())
}

/// Stretches of neighbours that can be drawn.
fn runs<T: Copy>(places: impl Iterator<Item = Option<T>>) -> Vec<Vec<T>> {
    let mut runs = vec![Vec::new()];
    for place in places {
        match place {
            Some(place) => runs.last_mut().into_iter().for_each(|run| run.push(place)),
            None => runs.push(Vec::new()),
        }
    }
    runs.retain(|run| !run.is_empty());
    runs
}

fn draw_band<DB: DrawingBackend>(chart: &Chart<'_, DB>, band: &Band, frame: &Frame<'_>) -> DrawingResult<DB> {
    let edges = band.points.rows().into_iter().map(|row| {
        let Point { x, y: upper } = frame.place(row[0], row[2])?;
        // on a logarithmic axis a lower edge at or below zero lies below the panel
        let lower = if row[1].is_nan() { None } else { Some(frame.y.place(row[1]).unwrap_or(-1.0)) };
        Some(BandPoint { x, lower: lower?, upper })
    });
    for run in runs(edges) {
        let above = run.iter().map(|at| Point::new(at.x, at.upper));
        let below = run.iter().rev().map(|at| Point::new(at.x, at.lower));
        let outline = clip::polygon(&above.chain(below).collect::<Vec<_>>());
        if outline.len() > 2 {
            let shape = Polygon::new(frame.values(&outline), Ink::Band(band.colour).style());
            chart.plotting_area().draw(&shape)?;
        }
    }
    Ok(())
}

fn draw_guide<DB: DrawingBackend>(
    chart: &Chart<'_, DB>,
    mark: &Mark,
    frame: &Frame<'_>,
) -> DrawingResult<DB> {
    let line = match mark {
        Mark::Level { y, .. } => frame.y.place(*y).map(|y| [Point::new(0.0, y), Point::new(1.0, y)]),
        Mark::Instant { x, .. } => frame.x.place(*x).map(|x| [Point::new(x, 0.0), Point::new(x, 1.0)]),
        Mark::Point { .. } | Mark::Cross { .. } => None,
    };
    for part in line.into_iter().flat_map(|line| clip::polyline(&line)) {
        chart.plotting_area().draw(&PathElement::new(frame.values(&part), Ink::Guide.style()))?;
    }
    Ok(())
}

fn draw_symbol<DB: DrawingBackend>(
    chart: &Chart<'_, DB>,
    mark: &Mark,
    frame: &Frame<'_>,
    radius: i32,
) -> DrawingResult<DB> {
    let (Mark::Point { x, y, colour, .. } | Mark::Cross { x, y, colour, .. }) = mark else { return Ok(()) };
    let seen = frame.place(*x, *y).map(|place| clip::polyline(&[place])).unwrap_or_default();
    if seen.is_empty() {
        return Ok(());
    }
    let style = Ink::Ring(*colour).style();
    if matches!(mark, Mark::Point { .. }) {
        return chart.plotting_area().draw(&Circle::new((*x, *y), radius, style));
    }
    let falling = vec![(-radius, -radius), (radius, radius)];
    let rising = vec![(-radius, radius), (radius, -radius)];
    let cross =
        EmptyElement::at((*x, *y)) + PathElement::new(falling, style) + PathElement::new(rising, style);
    chart.plotting_area().draw(&cross)
}
