//! The parts of a figure.

use ndarray::{Array2, ArrayView1};

use crate::heat_map::HeatMap;

/// A figure: one title over panels or over a heat map.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// One line that says what is shown.
    pub title: String,
    /// Conclusion for the reader; may be empty.
    pub caption: String,
    /// The command that produces this figure again; may be empty.
    pub command: String,
    /// Content.
    pub content: Content,
}

/// Content of a figure.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Curves in panels over one shared x axis.
    Panels(Panels),
    /// Coloured cells.
    HeatMap(HeatMap),
}

/// Panels over one shared x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Panels {
    /// The shared x axis.
    pub x: Axis,
    /// From top to bottom.
    pub panels: Vec<Panel>,
    /// The relation of the lengths of the two axes.
    pub aspect: Aspect,
}

/// Relation of the lengths of the two axes of a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aspect {
    /// Each axis fills its side of the panel.
    Free,
    /// A unit is equally long on both linear axes, so that a circle looks like one; the shorter range is widened about its middle.
    Equal,
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
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Scale of the axis.
    pub scale: Scale,
    /// Ends; `None` takes them from the data.
    pub range: Option<(f64, f64)>,
}

/// Scale of an axis.
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
    /// Name in the legend; empty for none.
    pub name: String,
    /// One row a point, columns x and y, in the order in which the points are joined. A series whose x never decreases is thinned
    /// when it is long ([`MOST_POINTS`](crate::thinning::MOST_POINTS)); a path that turns back is drawn whole.
    pub points: Array2<f64>,
    /// Colour.
    pub colour: Colour,
    /// Dash.
    pub dash: Dash,
}

/// A point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Position along x, in the unit of that axis.
    pub x: f64,
    /// Position along y, in the unit of that axis.
    pub y: f64,
}

impl Point {
    /// Returns the point at x and y.
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Self {
        Self { x, y }
    }
}

/// The two edges of a band at a place along x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPoint {
    /// Position along x, in the unit of that axis.
    pub x: f64,
    /// Lower edge, in the unit of the y axis.
    pub lower: f64,
    /// Upper edge, in the unit of the y axis.
    pub upper: f64,
}

impl From<(f64, f64, f64)> for BandPoint {
    fn from((x, lower, upper): (f64, f64, f64)) -> Self {
        Self { x, lower, upper }
    }
}

/// A shaded region between two curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name in the legend; empty for none.
    pub name: String,
    /// One row a point, columns x, lower edge and upper edge.
    pub points: Array2<f64>,
    /// Colour.
    pub colour: Colour,
}

/// Something that is pointed out; its text stands in the legend.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A ring about a point.
    Point {
        /// Place along x.
        x: f64,
        /// Place along y.
        y: f64,
        /// Text in the legend; empty for no entry in the legend.
        text: String,
        /// Colour.
        colour: Colour,
    },
    /// A cross at a point.
    Cross {
        /// Place along x.
        x: f64,
        /// Place along y.
        y: f64,
        /// Text in the legend; empty for no entry in the legend.
        text: String,
        /// Colour.
        colour: Colour,
    },
    /// A thin line across the panel at a height.
    Level {
        /// Place along y.
        y: f64,
        /// Text in the legend; empty for no entry in the legend.
        text: String,
    },
    /// A thin line down the panel.
    Instant {
        /// Place along x.
        x: f64,
        /// Text in the legend; empty for no entry in the legend.
        text: String,
    },
}

/// A colour of the theme. People with any colour vision can tell the numbered ones apart.
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
    /// Grey: background, a reference that stands back.
    Muted,
}

/// Dash pattern of a curve.
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
    /// Returns a linear axis whose range is that of its data.
    pub fn linear(label: &str, unit: &str) -> Self {
        Self { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Linear, range: None }
    }

    /// Returns a logarithmic axis whose range is that of its data.
    pub fn logarithmic(label: &str, unit: &str) -> Self {
        Self { scale: Scale::Logarithmic, ..Self::linear(label, unit) }
    }

    /// Returns an axis of angles in degrees.
    pub fn degrees(label: &str) -> Self {
        Self { scale: Scale::Degrees, ..Self::linear(label, "deg") }
    }

    /// Returns the same axis with fixed ends.
    pub fn with_range(self, from: f64, to: f64) -> Self {
        Self { range: Some((from, to)), ..self }
    }

    /// Returns `label [unit]`.
    pub fn text(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} [{}]", self.label, self.unit) }
    }
}

impl Series {
    /// Returns a curve through points.
    pub fn new(
        name: &str,
        colour: Colour,
        dash: Dash,
        points: impl IntoIterator<Item = impl Into<Point>>,
    ) -> Self {
        let points = rows(points.into_iter().map(Into::into).map(|point: Point| [point.x, point.y]));
        Self { name: name.to_owned(), points, colour, dash }
    }

    /// Returns an unbroken curve through points.
    pub fn solid_line(
        name: &str,
        colour: Colour,
        points: impl IntoIterator<Item = impl Into<Point>>,
    ) -> Self {
        Self::new(name, colour, Dash::Solid, points)
    }

    /// Returns a dashed curve through points.
    pub fn dashed_line(
        name: &str,
        colour: Colour,
        points: impl IntoIterator<Item = impl Into<Point>>,
    ) -> Self {
        Self::new(name, colour, Dash::Dashed, points)
    }

    /// Returns a dotted curve through points.
    pub fn dotted_line(
        name: &str,
        colour: Colour,
        points: impl IntoIterator<Item = impl Into<Point>>,
    ) -> Self {
        Self::new(name, colour, Dash::Dotted, points)
    }

    /// Returns an unbroken curve of one signal over another; the longer one is cut to the length of the shorter.
    pub fn of_signals(name: &str, colour: Colour, x: ArrayView1<f64>, y: ArrayView1<f64>) -> Self {
        Self::solid_line(name, colour, x.iter().copied().zip(y.iter().copied()))
    }
}

impl Band {
    /// Returns a band from its edges.
    pub fn new(name: &str, colour: Colour, points: impl IntoIterator<Item = impl Into<BandPoint>>) -> Self {
        let edges = points.into_iter().map(Into::into);
        let points = rows(edges.map(|point: BandPoint| [point.x, point.lower, point.upper]));
        Self { name: name.to_owned(), points, colour }
    }
}

/// Returns rows of equal length as an array.
fn rows<const N: usize>(points: impl Iterator<Item = [f64; N]>) -> Array2<f64> {
    Array2::from(points.collect::<Vec<[f64; N]>>())
}

impl Panel {
    /// Returns a panel of curves, without bands and marks.
    pub fn new(y: Axis, series: Vec<Series>) -> Self {
        Self { y, series, bands: Vec::new(), marks: Vec::new(), height: 200.0 }
    }

    /// Returns the same panel with bands.
    pub fn with_bands(self, bands: Vec<Band>) -> Self {
        Self { bands, ..self }
    }

    /// Returns the same panel with marks.
    pub fn with_marks(self, marks: Vec<Mark>) -> Self {
        Self { marks, ..self }
    }

    /// Returns the same panel with one more thin line across it at a height.
    pub fn with_level(mut self, y: f64, text: impl Into<String>) -> Self {
        self.marks.push(Mark::Level { y, text: text.into() });
        self
    }

    /// Returns the same panel with one more thin line down it.
    pub fn with_instant(mut self, x: f64, text: impl Into<String>) -> Self {
        self.marks.push(Mark::Instant { x, text: text.into() });
        self
    }

    /// Returns the same panel with another height in pixels.
    pub fn with_height(self, height: f64) -> Self {
        Self { height, ..self }
    }
}

impl Figure {
    /// Returns a figure of panels, without caption and command.
    pub fn new(title: &str, x: Axis, panels: Vec<Panel>) -> Self {
        Self::with_content(title, Content::Panels(Panels { x, panels, aspect: Aspect::Free }))
    }

    /// Returns a figure of coloured cells, without caption and command.
    pub fn heat_map(title: &str, map: HeatMap) -> Self {
        Self::with_content(title, Content::HeatMap(map))
    }

    fn with_content(title: &str, content: Content) -> Self {
        Self { title: title.to_owned(), caption: String::new(), command: String::new(), content }
    }

    /// Returns the same figure with a unit equally long on both axes of each panel.
    pub fn with_equal_scales(mut self) -> Self {
        if let Content::Panels(all) = &mut self.content {
            all.aspect = Aspect::Equal;
        }
        self
    }

    /// Returns the same figure with a caption.
    pub fn with_caption(self, caption: &str) -> Self {
        Self { caption: caption.to_owned(), ..self }
    }

    /// Returns its panels; there are none in a heat map.
    pub fn panels(&self) -> &[Panel] {
        match &self.content {
            Content::Panels(all) => &all.panels,
            Content::HeatMap(_) => &[],
        }
    }

    /// Returns its panels for a change; there are none in a heat map.
    pub fn panels_mut(&mut self) -> &mut [Panel] {
        match &mut self.content {
            Content::Panels(all) => &mut all.panels,
            Content::HeatMap(_) => &mut [],
        }
    }
}
