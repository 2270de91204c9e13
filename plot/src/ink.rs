//! The appearance of what is drawn: each kind of line, area and text has one appearance.
//!
//! Plotters knows colours, not classes. A drawing therefore names its inks by colours that are numbers of [`Ink`]s, and the
//! backends look them up: as CSS classes, as attributes, or as colours of a theme.

use plotters::style::{Color, FontDesc, FontFamily, FontStyle, RGBAColor, ShapeStyle, TextStyle};
use plotters_backend::BackendColor;
use plotters_backend::text_anchor::Pos;

use crate::figure::{Colour, Dash};
use crate::theme::{Role, Theme};

/// A kind of line, area or text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ink {
    /// Behind everything.
    Paper,
    /// Text.
    Text,
    /// The title of a picture that stands alone.
    Title,
    /// Numbers of axes, headings.
    SoftText,
    /// A heading that rises to the right.
    RisingText,
    /// Text on a strong colour.
    InverseText,
    /// Grid lines at ticks with text.
    Grid,
    /// Grid lines at ticks without text.
    MinorGrid,
    /// The frame of a panel.
    Frame,
    /// A line that marks a value.
    Guide,
    /// A cell of a heat map; its strength is the opacity.
    Cell,
    /// The area that covers the cells of a row.
    Cover,
    /// The frame of a cell that is pointed out.
    CellFrame,
    /// A curve.
    Curve(Colour, Dash),
    /// A ring about a point.
    Ring(Colour),
    /// A shaded band.
    Band(Colour),
}

/// The appearance of an ink. Lengths are pixels of the figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Appearance {
    /// The colour of lines, if there are any.
    pub stroke: Option<Role>,
    /// The colour of areas and text, if there are any.
    pub fill: Option<Role>,
    /// Width of lines.
    pub width: f64,
    /// From 0, invisible, to 1.
    pub opacity: f64,
    /// Lengths of dashes and gaps in turn; empty for an unbroken line.
    pub dashes: &'static [f64],
    /// Size of text.
    pub font_px: f64,
    /// Angle by which text rises, in degrees.
    pub rise_deg: f64,
}

const COLOURS: [Colour; 7] = [
    Colour::First,
    Colour::Second,
    Colour::Third,
    Colour::Fourth,
    Colour::Fifth,
    Colour::Sixth,
    Colour::Muted,
];
const DASHES: [Dash; 3] = [Dash::Solid, Dash::Dashed, Dash::Dotted];
const PLAIN: [Ink; 13] = [
    Ink::Paper,
    Ink::Text,
    Ink::Title,
    Ink::SoftText,
    Ink::RisingText,
    Ink::InverseText,
    Ink::Grid,
    Ink::MinorGrid,
    Ink::Frame,
    Ink::Guide,
    Ink::Cell,
    Ink::Cover,
    Ink::CellFrame,
];

/// Size of text, pixels.
pub(crate) const FONT_PX: f64 = 12.0;

impl Ink {
    /// Returns every ink; the place in this order is its number.
    pub fn all() -> impl Iterator<Item = Ink> {
        let curves = COLOURS.into_iter().flat_map(|c| DASHES.map(|dash| Ink::Curve(c, dash)));
        let rings = COLOURS.into_iter().map(Ink::Ring);
        PLAIN.into_iter().chain(curves).chain(rings).chain(COLOURS.into_iter().map(Ink::Band))
    }

    /// Returns the ink that a colour of a drawing stands for.
    pub fn from_colour(colour: BackendColor) -> Ink {
        Ink::all().nth(usize::from(colour.rgb.0)).unwrap_or(Ink::Text)
    }

    /// Returns the colour that stands for the ink, at a strength from 0 to 1.
    fn number(self, strength: f64) -> RGBAColor {
        let number = Ink::all().position(|ink| ink == self).unwrap_or(0);
        RGBAColor(number as u8, 0, 0, strength)
    }

    /// Returns the style of lines and areas in this ink.
    pub fn style(self) -> ShapeStyle {
        self.with_strength(1.0)
    }

    /// Returns the style of an area in this ink at a strength from 0 to 1.
    pub fn with_strength(self, strength: f64) -> ShapeStyle {
        ShapeStyle { color: self.number(strength), filled: self.appearance().fill.is_some(), stroke_width: 1 }
    }

    /// Returns the style of text in this ink; `unit` is the number of the drawing's units in a pixel.
    pub fn text(self, unit: f64, pos: Pos) -> TextStyle<'static> {
        let size = self.appearance().font_px * unit;
        let font = FontDesc::new(FontFamily::SansSerif, size, FontStyle::Normal);
        TextStyle { font, color: self.number(1.0).to_backend_color(), pos }
    }

    /// Returns how the ink looks.
    pub fn appearance(self) -> Appearance {
        let none = Appearance {
            stroke: None,
            fill: None,
            width: 1.0,
            opacity: 1.0,
            dashes: &[],
            font_px: FONT_PX,
            rise_deg: 0.0,
        };
        let filled = |role| Appearance { fill: Some(role), ..none };
        let line = |role, width| Appearance { stroke: Some(role), width, ..none };
        match self {
            Ink::Paper => filled(Role::Panel),
            Ink::Text => filled(Role::Ink),
            Ink::Title => Appearance { font_px: 13.0, ..filled(Role::Ink) },
            Ink::SoftText => filled(Role::Soft),
            Ink::RisingText => Appearance { rise_deg: 38.0, ..filled(Role::Soft) },
            Ink::InverseText => filled(Role::Panel),
            Ink::Grid => line(Role::Grid, 1.0),
            Ink::MinorGrid => Appearance { opacity: 0.8, ..line(Role::Grid, 0.5) },
            Ink::Frame => line(Role::Frame, 1.0),
            Ink::Guide => Appearance { dashes: &[2.0, 3.0], ..line(Role::Soft, 1.1) },
            Ink::Cell => Appearance { fill: Some(Role::Curve(Colour::First)), ..line(Role::Grid, 1.0) },
            Ink::Cover => filled(Role::Grid),
            Ink::CellFrame => line(Role::Curve(Colour::Second), 2.5),
            Ink::Curve(colour, dash) => {
                Appearance { dashes: lengths(dash), ..line(Role::Curve(colour), 1.7) }
            }
            Ink::Ring(colour) => Appearance { fill: Some(Role::Panel), ..line(Role::Curve(colour), 2.0) },
            Ink::Band(colour) => Appearance { opacity: 0.22, ..filled(Role::Curve(colour)) },
        }
    }

    /// Returns the ink's class in CSS.
    pub fn class(self) -> String {
        let number = |colour| 1 + COLOURS.into_iter().position(|c| c == colour).unwrap_or(0);
        match self {
            Ink::Curve(colour, Dash::Solid) => format!("curve{}", number(colour)),
            Ink::Curve(colour, Dash::Dashed) => format!("curve{}-dashed", number(colour)),
            Ink::Curve(colour, Dash::Dotted) => format!("curve{}-dotted", number(colour)),
            Ink::Ring(colour) => format!("ring{}", number(colour)),
            Ink::Band(colour) => format!("band{}", number(colour)),
            Ink::Paper => "paper".to_owned(),
            Ink::Text => "text".to_owned(),
            Ink::Title => "title".to_owned(),
            Ink::SoftText => "soft-text".to_owned(),
            Ink::RisingText => "rising-text".to_owned(),
            Ink::InverseText => "inverse-text".to_owned(),
            Ink::Grid => "grid".to_owned(),
            Ink::MinorGrid => "minor-grid".to_owned(),
            Ink::Frame => "frame".to_owned(),
            Ink::Guide => "guide".to_owned(),
            Ink::Cell => "cell".to_owned(),
            Ink::Cover => "cover".to_owned(),
            Ink::CellFrame => "cell-frame".to_owned(),
        }
    }

    /// Returns the ink's properties as declarations of CSS, in colours of the page's theme.
    pub fn declarations(self) -> String {
        self.properties(Role::variable).map(|(name, value)| format!("{name}:{value}")).join(";")
    }

    /// Returns the ink's properties as attributes of SVG, in colours of one theme.
    pub fn attributes(self, theme: Theme) -> String {
        let colour = |role| theme.hex(role);
        self.properties(colour).map(|(name, value)| format!("{name}=\"{value}\"")).join(" ")
    }

    /// Returns names and values of the properties that SVG and CSS share.
    fn properties(self, colour: impl Fn(Role) -> String) -> Properties {
        let look = self.appearance();
        let paint = |role: Option<Role>| role.map_or("none".to_owned(), &colour);
        let mut all = vec![("fill", paint(look.fill))];
        if look.stroke.is_some() {
            all.extend([("stroke", paint(look.stroke)), ("stroke-width", look.width.to_string())]);
        }
        if !look.dashes.is_empty() {
            let lengths: Vec<String> = look.dashes.iter().map(f64::to_string).collect();
            all.push(("stroke-dasharray", lengths.join(" ")));
        }
        if matches!(self, Ink::Curve(..)) {
            all.push(("stroke-linejoin", "round".to_owned()));
        }
        if matches!(self, Ink::Curve(_, Dash::Solid | Dash::Dotted)) {
            all.push(("stroke-linecap", "round".to_owned()));
        }
        if look.opacity < 1.0 {
            all.push(("opacity", look.opacity.to_string()));
        }
        if look.font_px != FONT_PX {
            all.extend([("font-size", format!("{}px", look.font_px)), ("font-weight", "600".to_owned())]);
        }
        Properties(all)
    }
}

/// Names and values of properties.
struct Properties(Vec<(&'static str, String)>);

impl Properties {
    /// Returns each property as text.
    fn map(self, text: impl Fn((&'static str, String)) -> String) -> Vec<String> {
        self.0.into_iter().map(text).collect()
    }
}

/// Returns lengths of dashes and gaps, pixels.
fn lengths(dash: Dash) -> &'static [f64] {
    match dash {
        Dash::Solid => &[],
        Dash::Dashed => &[7.0, 4.0],
        // round caps lengthen each dot, and shorten each gap, by the width of the line
        Dash::Dotted => &[1.6, 3.4],
    }
}
