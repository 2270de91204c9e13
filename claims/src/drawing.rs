//! Figures of a row from its curves: the colour of each curve follows from its place, few points are marked one by one.

use counterpoise_lti::{Response, StateSpace};
use counterpoise_plot::{Axis, Colour, Dash, Figure, Mark, Panel, Point, Series};
use counterpoise_report::wording::capitalise_first;
use counterpoise_verify::History;

use counterpoise_pipeline::PipelineError;

/// A curve before its place in a panel decides its colour.
#[derive(Debug, Clone, PartialEq)]
pub struct ClaimCurve {
    /// Name in the legend.
    pub name: String,
    /// In the order in which they are joined.
    pub points: Vec<Point>,
    /// Style of the curve.
    pub style: CurveStyle,
}

/// Style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveStyle {
    /// An unbroken line.
    Line,
    /// A dashed line: what the others are compared with.
    Reference,
    /// A dashed line in the colour of the curve before it: the same quantity from another source.
    Pair,
    /// Few points, each marked, joined.
    Points,
    /// A line in the background.
    Faint,
}

/// Height of the panels of a figure, pixels: lower if there are more than two.
const HEIGHTS: (f64, f64) = (190.0, 150.0);

/// Returns a figure of panels over one x axis.
pub fn make_figure(title: impl AsRef<str>, x: Axis, panels: Vec<Panel>) -> Figure {
    let height = if panels.len() > 2 { HEIGHTS.1 } else { HEIGHTS.0 };
    Figure::new(title.as_ref(), x, panels.into_iter().map(|panel| panel.with_height(height)).collect())
}

/// Returns a panel of curves.
pub fn make_panel(y: Axis, curves: Vec<ClaimCurve>) -> Panel {
    let (mut series, mut marks, mut at) = (Vec::new(), Vec::new(), 0);
    for curve in curves {
        let (colour, dash) = dress(curve.style, &mut at);
        if curve.style == CurveStyle::Points {
            let ring = |point: &Point| Mark::Point { x: point.x, y: point.y, text: String::new(), colour };
            marks.extend(curve.points.iter().map(ring));
        }
        series.push(Series::new(&capitalise_first(&curve.name), colour, dash, curve.points));
    }
    Panel::new(y, series).with_marks(marks)
}

/// Colours in turn, a pair in one colour.
fn dress(style: CurveStyle, at: &mut usize) -> (Colour, Dash) {
    let of = |turn: usize| Colour::CYCLE[turn % Colour::CYCLE.len()];
    match style {
        CurveStyle::Faint => (Colour::Muted, Dash::Solid),
        CurveStyle::Pair => (of(at.saturating_sub(1)), Dash::Dashed),
        CurveStyle::Line | CurveStyle::Reference | CurveStyle::Points => {
            *at += 1;
            (of(*at - 1), if style == CurveStyle::Reference { Dash::Dashed } else { Dash::Solid })
        }
    }
}

/// Returns the axis of time in seconds.
pub fn time_axis() -> Axis {
    Axis::linear("time", "s")
}

/// Returns the axis of frequency in Hz.
pub fn frequency_axis() -> Axis {
    Axis::logarithmic("frequency", "Hz")
}

/// Returns the axis of a parameter's factor.
pub fn factor_axis(quantity: &str) -> Axis {
    Axis::logarithmic(quantity, "times the normal")
}

impl ClaimCurve {
    /// Returns a curve of a style.
    pub fn new(name: impl Into<String>, style: CurveStyle, points: Vec<Point>) -> Self {
        Self { name: name.into(), points, style }
    }

    /// Returns an unbroken line.
    pub fn line(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::new(name, CurveStyle::Line, points)
    }

    /// Returns a dashed line.
    pub fn reference(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::new(name, CurveStyle::Reference, points)
    }

    /// Returns marked points.
    pub fn points(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::new(name, CurveStyle::Points, points)
    }

    /// Returns a line in the background.
    pub fn faint_line(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::new(name, CurveStyle::Faint, points)
    }
}

/// Returns two columns as points, the second times `scale`.
pub fn points_of(x: &[f64], y: &[f64], scale: f64) -> Vec<Point> {
    x.iter().zip(y).map(|(x, y)| Point::new(*x, scale * y)).collect()
}

/// Returns the hub rate in mrad/s over time.
pub fn hub_rates(history: &History) -> Vec<Point> {
    points_of(history.time_s(), history.hub_rate_rad_s(), 1e3)
}

/// Returns the hub rate in mrad/s over time, from a time on.
pub fn hub_from(history: &History, time_s: f64) -> Vec<Point> {
    hub_rates(history).split_off(history.index_at(time_s))
}

/// Returns a panel of hub rates in mrad/s.
pub fn hub_panel(curves: Vec<ClaimCurve>) -> Panel {
    make_panel(Axis::linear("hub rate", "mrad/s"), curves)
}

/// Returns the gain in dB over Hz of the frequency response of a system's first output over one input.
///
/// # Errors
/// A response that does not exist.
pub fn gain_db(system: &StateSpace, input: usize, rates_rad_s: &[f64]) -> Result<Vec<Point>, PipelineError> {
    let values = Response::of(system)?.at_all(rates_rad_s)?;
    let db = |k: usize| 20.0 * values[k][(0, input)].norm().log10();
    Ok(rates_rad_s
        .iter()
        .enumerate()
        .map(|(k, rate)| Point::new(rate / std::f64::consts::TAU, db(k)))
        .collect())
}

/// Returns the phase in degrees over Hz of the same, without jumps of a whole turn.
///
/// # Errors
/// A response that does not exist.
pub fn phase_deg(
    system: &StateSpace,
    input: usize,
    rates_rad_s: &[f64],
) -> Result<Vec<Point>, PipelineError> {
    let values = Response::of(system)?.at_all(rates_rad_s)?;
    let mut before: Option<f64> = None;
    let mut unwrapped = |raw: f64| {
        let phase = before.map_or(raw, |last| raw + 360.0 * ((last - raw) / 360.0).round());
        before = Some(phase);
        phase
    };
    let degrees = |k: usize| values[k][(0, input)].arg().to_degrees();
    let both = rates_rad_s.iter().enumerate();
    Ok(both.map(|(k, rate)| Point::new(rate / std::f64::consts::TAU, unwrapped(degrees(k)))).collect())
}
