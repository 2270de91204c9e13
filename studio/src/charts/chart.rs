//! A plot as data.

use egui::Color32;

use super::curve_points::CurvePoints;

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartCurve {
    /// Name; a curve without one is not in the legend.
    pub name: String,
    /// Points, in the units of the axes.
    pub points: CurvePoints,
    /// Colour.
    pub colour: Color32,
    /// Dash pattern.
    pub dash: LineDash,
}

/// Dash pattern of a curve, so that it can be read without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineDash {
    /// Unbroken.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// The scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AxisScale {
    /// Linear.
    Linear,
    /// Logarithmic.
    Log,
}

/// The two axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlotAxis {
    /// Horizontal.
    X,
    /// Vertical.
    Y,
}

impl PlotAxis {
    /// Returns the other axis.
    pub fn other(self) -> Self {
        match self {
            Self::X => Self::Y,
            Self::Y => Self::X,
        }
    }

    /// Returns the axis' place in pairs: 0 for x, 1 for y.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
        }
    }
}

/// A vertical line with a label.
#[derive(Debug, Clone, PartialEq)]
pub struct VerticalMark {
    /// Position on the x axis.
    pub x: f64,
    /// Label.
    pub label: String,
}

/// A point with a label.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledPoint {
    /// Coordinates.
    pub at: [f64; 2],
    /// Label; it may be empty.
    pub label: String,
    /// Colour; `None` for the accent of the theme.
    pub colour: Option<Color32>,
}

impl LabelledPoint {
    /// Returns a point in the accent of the theme.
    pub fn new(at: [f64; 2], label: impl Into<String>) -> Self {
        Self { at, label: label.into(), colour: None }
    }
}

/// The side of a limit on which the curve must not be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForbiddenSide {
    /// Above the limit, or to the right of it.
    Larger,
    /// Below the limit, or to the left of it.
    Smaller,
}

/// The meaning of a shaded region.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoundTone {
    /// The wrong side of a limit that holds.
    Kept,
    /// The wrong side of a limit that is broken.
    Broken,
    /// Outside a window that was chosen.
    Outside,
}

/// A limit with the region on its wrong side.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartBound {
    /// What is limited, with the limit.
    pub label: String,
    /// The axis on which the limit lies.
    pub axis: PlotAxis,
    /// The limit, in the unit of this axis.
    pub at: f64,
    /// The wrong side.
    pub side: ForbiddenSide,
    /// The part of the other axis to which the limit applies, in its unit; `None` for all of it.
    pub span: Option<[f64; 2]>,
    /// The meaning of the region.
    pub tone: BoundTone,
    /// `true` if the requirement is selected.
    pub is_selected: bool,
}

/// A plot as data.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Title of the plot; also its name for copies and screen readers.
    pub title: String,
    /// The labels of the axes, with units.
    pub labels: [String; 2],
    /// The scales of the axes.
    pub scales: [AxisScale; 2],
    /// The curves.
    pub curves: Vec<ChartCurve>,
    /// Vertical lines with labels.
    pub marks: Vec<VerticalMark>,
    /// Points with labels.
    pub spots: Vec<LabelledPoint>,
    /// Horizontal lines.
    pub levels: Vec<f64>,
    /// Limits with the regions on their wrong sides.
    pub bounds: Vec<ChartBound>,
    /// The range of each axis before the user zooms; `None` fits the content.
    pub range: [Option<(f64, f64)>; 2],
    /// Charts of one group share their x axis and their cursor.
    pub group: Option<&'static str>,
}

impl Chart {
    /// Returns a chart without curves on linear axes.
    pub fn new(title: &str, x_label: &str, y_label: &str) -> Self {
        Self {
            title: title.to_owned(),
            labels: [x_label.to_owned(), y_label.to_owned()],
            scales: [AxisScale::Linear; 2],
            curves: Vec::new(),
            marks: Vec::new(),
            spots: Vec::new(),
            levels: Vec::new(),
            bounds: Vec::new(),
            range: [None, None],
            group: None,
        }
    }

    /// Adds a curve of a few thousand points at most.
    #[must_use]
    pub fn with_curve(self, name: &str, colour: Color32, dash: LineDash, points: Vec<[f64; 2]>) -> Self {
        self.with_any_curve(ChartCurve {
            name: name.to_owned(),
            points: CurvePoints::Few(points),
            colour,
            dash,
        })
    }

    /// Adds a path that may turn back, such as a curve in the complex plane; a point without numbers breaks it.
    #[must_use]
    pub fn with_path(self, name: &str, colour: Color32, dash: LineDash, points: Vec<[f64; 2]>) -> Self {
        self.with_any_curve(ChartCurve {
            name: name.to_owned(),
            points: CurvePoints::Path(points),
            colour,
            dash,
        })
    }

    /// Adds a curve of any length.
    #[must_use]
    pub fn with_any_curve(mut self, curve: ChartCurve) -> Self {
        self.curves.push(curve);
        self
    }

    /// Puts the chart into a group of charts that are zoomed and read together.
    #[must_use]
    pub fn with_group(mut self, group: &'static str) -> Self {
        self.group = Some(group);
        self
    }

    /// Adds a vertical line with a label.
    pub fn add_mark(&mut self, x: f64, label: impl Into<String>) {
        self.marks.push(VerticalMark { x, label: label.into() });
    }

    /// Returns a value in plot coordinates: a logarithmic axis is in decades.
    pub fn plot_coordinate(&self, axis: PlotAxis, value: f64) -> f64 {
        match self.scales[axis.index()] {
            AxisScale::Log => value.max(f64::MIN_POSITIVE).log10(),
            AxisScale::Linear => value,
        }
    }

    /// Returns the value at a plot coordinate.
    pub fn value_at(&self, axis: PlotAxis, coordinate: f64) -> f64 {
        match self.scales[axis.index()] {
            AxisScale::Log => 10f64.powf(coordinate),
            AxisScale::Linear => coordinate,
        }
    }

    /// Returns the chart's range of an axis in plot coordinates.
    pub fn plot_range(&self, axis: PlotAxis) -> Option<(f64, f64)> {
        self.range[axis.index()]
            .map(|(low, high)| (self.plot_coordinate(axis, low), self.plot_coordinate(axis, high)))
    }
}
