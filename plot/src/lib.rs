//! Figures as plain data, drawn as SVG text.
//!
//! In comes a [`Figure`]: panels stacked over one shared x axis, each with curves, bands and marks; out goes an SVG that follows the
//! theme of the page it stands in (light or dark, by CSS variables) and can be read without colour (dashes, marker shapes).
//! The legend stands above the panels, never on the data; long series are thinned to what a screen can show.
//!
//! A small layer of its own rather than a plotting crate: colours must be CSS classes (a crate that writes colours into the picture
//! cannot follow the viewer's theme), and text must be placed without a font file, by the viewer's own font.
//!
//! *Invariant*: data in, text out; no file, no number that depends on the machine.
//!
//! Modules in reading order: [`figure`], [`ticks`], [`thin`], [`theme`], [`element`], [`draw`], [`heat`], [`bode`].

pub mod bode;
pub mod draw;
pub mod element;
pub mod figure;
pub mod heat;
pub mod theme;
pub mod thin;
pub mod ticks;

pub use draw::{inline_svg, standalone_svg};
pub use figure::{Axis, Band, Colour, Dash, Figure, Heat, HeatGroup, HeatRow, Mark, Panel, Scale, Series};
