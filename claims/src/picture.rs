//! What a row was decided by, as data for pictures: curves with their quantities and units. Nothing is drawn here.

use counterpoise_lti::{Response, StateSpace};
use counterpoise_verify::History;

use counterpoise_pipeline::PipelineError;

/// Panels over one shared x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// One line that says what is seen.
    pub title: String,
    /// What the reader should take from it; may be empty.
    pub caption: String,
    /// The shared x axis.
    pub x: Axis,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

/// A quantity with its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The quantity.
    pub quantity: String,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// How values are laid along the axis.
    pub spacing: Spacing,
}

/// How values are laid along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spacing {
    /// Evenly.
    Even,
    /// By the logarithm.
    Logarithmic,
}

/// One pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// The y axis.
    pub y: Axis,
    /// Curves, drawn in order.
    pub curves: Vec<Curve>,
    /// Lines that mark something: what the thesis says, a limit, an instant.
    pub marks: Vec<Mark>,
}

/// A named series.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in the legend.
    pub name: String,
    /// (x, y) in the order in which they are joined.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub style: Style,
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// An unbroken line.
    Line,
    /// A dashed line: what it is compared with.
    Beside,
    /// A dashed line in the colour of the curve before it: the same quantity by somebody else.
    Pair,
    /// Few points, each marked, joined.
    Points,
    /// A line in the background.
    Faint,
}

/// A thin line across a panel.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// At a height.
    Level(f64, String),
    /// At an abscissa.
    At(f64, String),
}

impl Axis {
    /// Evenly spaced.
    pub fn even(quantity: &str, unit: &'static str) -> Self {
        Self { quantity: quantity.to_owned(), unit, spacing: Spacing::Even }
    }

    /// Logarithmic.
    pub fn logarithmic(quantity: &str, unit: &'static str) -> Self {
        Self { spacing: Spacing::Logarithmic, ..Self::even(quantity, unit) }
    }

    /// Time in seconds.
    pub fn time() -> Self {
        Self::even("time", "s")
    }

    /// Frequency in Hz.
    pub fn frequency() -> Self {
        Self::logarithmic("frequency", "Hz")
    }

    /// A parameter's factor.
    pub fn factor(quantity: &str) -> Self {
        Self::logarithmic(quantity, "times the normal")
    }
}

impl Curve {
    /// A curve of a style.
    pub fn new(name: impl Into<String>, style: Style, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, style }
    }

    /// An unbroken line.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, Style::Line, points)
    }

    /// A dashed line.
    pub fn beside(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, Style::Beside, points)
    }

    /// Marked points.
    pub fn points(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, Style::Points, points)
    }

    /// A line in the background.
    pub fn faint(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, Style::Faint, points)
    }
}

impl Panel {
    /// Curves without marks.
    pub fn of(y: Axis, curves: Vec<Curve>) -> Self {
        Self { y, curves, marks: Vec::new() }
    }

    /// The same panel with a line at a height.
    pub fn level(mut self, y: f64, text: impl Into<String>) -> Self {
        self.marks.push(Mark::Level(y, text.into()));
        self
    }

    /// The same panel with a line at an abscissa.
    pub fn at(mut self, x: f64, text: impl Into<String>) -> Self {
        self.marks.push(Mark::At(x, text.into()));
        self
    }
}

impl Picture {
    /// Panels over one x axis.
    pub fn new(title: impl Into<String>, x: Axis, panels: Vec<Panel>) -> Self {
        Self { title: title.into(), caption: String::new(), x, panels }
    }

    /// The same picture with a caption.
    pub fn captioned(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
    }
}

/// Two columns as points, the second times `scale`.
pub fn paired(x: &[f64], y: &[f64], scale: f64) -> Vec<(f64, f64)> {
    x.iter().zip(y).map(|(x, y)| (*x, scale * y)).collect()
}

/// Hub rate in mrad/s over time.
pub fn hub(history: &History) -> Vec<(f64, f64)> {
    paired(&history.time_s, &history.hub_rate_rad_s, 1e3)
}

/// Hub rate in mrad/s over time, from a time on.
pub fn hub_from(history: &History, time_s: f64) -> Vec<(f64, f64)> {
    hub(history).split_off(history.index_at(time_s))
}

/// A panel of hub rates in mrad/s.
pub fn hub_panel(curves: Vec<Curve>) -> Panel {
    Panel::of(Axis::even("hub rate", "mrad/s"), curves)
}

/// (Hz, dB) of one element of a system's frequency response.
///
/// # Errors
/// A response that does not exist.
pub fn gain_db(
    system: &StateSpace,
    (output, input): (usize, usize),
    rates_rad_s: &[f64],
) -> Result<Vec<(f64, f64)>, PipelineError> {
    let values = Response::of(system)?.at_all(rates_rad_s)?;
    let db = |k: usize| 20.0 * values[k][(output, input)].norm().log10();
    Ok(rates_rad_s.iter().enumerate().map(|(k, rate)| (rate / std::f64::consts::TAU, db(k))).collect())
}

/// (Hz, degrees) of one element, without jumps of a whole turn.
///
/// # Errors
/// A response that does not exist.
pub fn phase_deg(
    system: &StateSpace,
    (output, input): (usize, usize),
    rates_rad_s: &[f64],
) -> Result<Vec<(f64, f64)>, PipelineError> {
    let values = Response::of(system)?.at_all(rates_rad_s)?;
    let mut before: Option<f64> = None;
    let mut unwrapped = |raw: f64| {
        let phase = before.map_or(raw, |last| raw + 360.0 * ((last - raw) / 360.0).round());
        before = Some(phase);
        phase
    };
    let degrees = |k: usize| values[k][(output, input)].arg().to_degrees();
    let both = rates_rad_s.iter().enumerate();
    Ok(both.map(|(k, rate)| (rate / std::f64::consts::TAU, unwrapped(degrees(k)))).collect())
}
