//! What a figure is made of.

/// Panels over one shared x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// One line that says what is seen.
    pub title: String,
    /// What the reader should take from it; may be empty.
    pub caption: String,
    /// The command that makes this figure again; may be empty.
    pub command: String,
    /// The shared x axis.
    pub x: Axis,
    /// From top to bottom.
    pub panels: Vec<Panel>,
    /// Coloured cells, drawn in place of axes and panels.
    pub heat: Option<Heat>,
}

/// Rows x columns of shares, each a coloured cell with its number.
#[derive(Debug, Clone, PartialEq)]
pub struct Heat {
    /// What the colour means, with its unit.
    pub meaning: String,
    /// What a ring means.
    pub ring: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows in groups.
    pub groups: Vec<HeatGroup>,
}

/// Rows of a [`Heat`] under one heading.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatGroup {
    /// The heading.
    pub heading: String,
    /// The rows, from top to bottom.
    pub rows: Vec<HeatRow>,
}

/// One row of a [`Heat`].
#[derive(Debug, Clone, PartialEq)]
pub struct HeatRow {
    /// Its name.
    pub name: String,
    /// Shares from 0 to 1, none where nothing is known; a row without shares is grey: nothing sees it.
    pub shares: Vec<Option<f64>>,
    /// Places of the cells with a ring.
    pub ringed: Vec<usize>,
}

/// One pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// The y axis.
    pub y: Axis,
    /// Curves, drawn in order.
    pub series: Vec<Series>,
    /// Shaded bands, drawn below the curves.
    pub bands: Vec<Band>,
    /// Lines and points that mark something.
    pub marks: Vec<Mark>,
    /// Height of the plotting area in pixels.
    pub height: f64,
}

/// An axis with its quantity and unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The quantity.
    pub label: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Linear, logarithmic, or angles.
    pub scale: Scale,
    /// From and to; from the data where there is none.
    pub range: Option<(f64, f64)>,
}

/// How values are laid along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly, with ticks at 1, 2 or 5 times a power of ten.
    Linear,
    /// By the logarithm; values that are not positive are left out.
    Logarithmic,
    /// Evenly, with ticks at parts of a turn.
    Degrees,
}

/// A curve. Points that are not finite break it.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// (x, y) in the order in which they are joined; x may go back (a loop) in series short enough not to be thinned
    /// ([`MOST_POINTS`](crate::thin::MOST_POINTS)).
    pub points: Vec<(f64, f64)>,
    /// Its colour.
    pub colour: Colour,
    /// Its dash.
    pub dash: Dash,
}

/// A shaded region between two curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// (x, lower, upper).
    pub points: Vec<(f64, f64, f64)>,
    /// Its colour.
    pub colour: Colour,
}

/// Something that is pointed out; its text stands in the legend.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A ring about a point.
    Point {
        /// Where along x.
        x: f64,
        /// Where along y.
        y: f64,
        /// What it is.
        text: String,
        /// Its colour.
        colour: Colour,
    },
    /// A thin line across the panel at a height.
    Level {
        /// Where along y.
        y: f64,
        /// What it is; empty for none.
        text: String,
    },
    /// A thin line down the panel.
    Instant {
        /// Where along x.
        x: f64,
        /// What it is; empty for none.
        text: String,
    },
}

/// A colour of the theme. Numbered ones are told apart by people with any colour vision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Blue: the result.
    First,
    /// Vermilion: what it is compared with.
    Second,
    /// Green.
    Third,
    /// Purple.
    Fourth,
    /// Orange.
    Fifth,
    /// Sky blue.
    Sixth,
    /// Grey: background, without control.
    Muted,
}

/// How a curve is dashed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
}

impl Colour {
    /// The numbered colours in order, for families of curves.
    pub const CYCLE: [Colour; 6] =
        [Colour::First, Colour::Second, Colour::Third, Colour::Fourth, Colour::Fifth, Colour::Sixth];
}

impl Axis {
    /// A linear axis ranged by its data.
    pub fn linear(label: &str, unit: &str) -> Self {
        Self { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis ranged by its data.
    pub fn logarithmic(label: &str, unit: &str) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label, unit) }
    }

    /// An axis of angles in degrees.
    pub fn degrees(label: &str) -> Self {
        Self { scale: Scale::Degrees, ..Self::linear(label, "deg") }
    }

    /// The same axis over a given range.
    pub fn over(self, from: f64, to: f64) -> Self {
        Self { range: Some((from, to)), ..self }
    }

    /// `label [unit]`.
    pub fn text(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} [{}]", self.label, self.unit) }
    }
}

impl Series {
    /// An unbroken curve.
    pub fn solid(name: &str, colour: Colour, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.to_owned(), points, colour, dash: Dash::Solid }
    }

    /// A dashed curve.
    pub fn dashed(name: &str, colour: Colour, points: Vec<(f64, f64)>) -> Self {
        Self { dash: Dash::Dashed, ..Self::solid(name, colour, points) }
    }

    /// A dotted curve.
    pub fn dotted(name: &str, colour: Colour, points: Vec<(f64, f64)>) -> Self {
        Self { dash: Dash::Dotted, ..Self::solid(name, colour, points) }
    }
}

impl Panel {
    /// A panel of curves, without bands and marks.
    pub fn of(y: Axis, series: Vec<Series>) -> Self {
        Self { y, series, bands: Vec::new(), marks: Vec::new(), height: 200.0 }
    }

    /// The same panel with marks.
    pub fn marked(self, marks: Vec<Mark>) -> Self {
        Self { marks, ..self }
    }

    /// The same panel, so many pixels high.
    pub fn high(self, height: f64) -> Self {
        Self { height, ..self }
    }
}

impl Figure {
    /// A figure without caption and command.
    pub fn new(title: &str, x: Axis, panels: Vec<Panel>) -> Self {
        let (title, caption, command) = (title.to_owned(), String::new(), String::new());
        Self { title, caption, command, x, panels, heat: None }
    }

    /// A figure of coloured cells.
    pub fn cells(title: &str, heat: Heat) -> Self {
        Self { heat: Some(heat), ..Self::new(title, Axis::linear("", ""), Vec::new()) }
    }

    /// The same figure with a caption.
    pub fn captioned(self, caption: &str) -> Self {
        Self { caption: caption.to_owned(), ..self }
    }
}
