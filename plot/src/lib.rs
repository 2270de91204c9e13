//! Figures as plain data, drawn as SVG or PNG in one theme.
//!
//! In comes a [`Figure`]: panels with curves, bands and marks over one shared x axis, or a heat map. Out goes an SVG element that
//! follows the light or dark theme of the page in which it stands, an SVG document, or a PNG file. Figures can be read without
//! colour (by dashes and the shapes of marks), the legend stands above the panels and never on the data, and long series are thinned
//! to what a screen can show.
//!
//! The figures are drawn on the coordinate system of plotters. SVG is written by a backend of our own, because colours must be
//! classes of CSS for a page to change its theme; PNG is written by plotters' bitmap backend with text from an embedded font.
//!
//! *Invariant*: data in, bytes out; no file, no clock, no number that depends on the machine, and no knowledge of what a figure means.
//!
//! Modules in reading order: [`figure`], [`heat_map`], [`number`], [`ticks`], [`ruler`], [`thinning`], [`theme`], `ink`, [`css`], `font`, `clip`,
//! `draw`, [`svg`], `dashes`, [`bitmap`](mod@bitmap), [`error`].
//!
//! ```
//! use counterpoise_plot::{Axis, Colour, Figure, Panel, Series, Theme, png, svg};
//! let curve = Series::solid_line("hub", Colour::First, [(0.0, 0.0), (1.0, 0.8), (2.0, 1.0)]);
//! let panel = Panel::new(Axis::linear("rate", "rad/s"), vec![curve]);
//! let figure = Figure::new("Step response", Axis::linear("time", "s"), vec![panel]);
//! assert!(svg::inline_svg(&figure).starts_with("<svg class=\"fig\""));
//! let file = png(&figure, Theme::Light, 1.0)?;
//! assert_eq!(&file[1..4], b"PNG");
//! # Ok::<(), counterpoise_plot::PlotError>(())
//! ```

pub mod bitmap;
mod clip;
pub mod css;
mod dashes;
mod draw;
pub mod error;
pub mod figure;
mod font;
pub mod heat_map;
mod ink;
pub mod number;
pub mod ruler;
pub mod svg;
pub mod theme;
pub mod thinning;
pub mod ticks;
mod tolerance;

pub use bitmap::{Bitmap, bitmap, png};
pub use error::PlotError;
pub use figure::{
    Aspect, Axis, Band, BandPoint, Colour, Content, Dash, Figure, Mark, Panel, Panels, Point, Scale, Series,
};
pub use heat_map::{HeatMap, HeatRow};
pub use theme::Theme;
