//! Figures as SVG: for a page, in classes that follow its theme, or alone, in the colours of one theme.

use std::cell::RefCell;
use std::convert::Infallible;
use std::fmt::Write as _;
use std::rc::Rc;

use plotters::drawing::DrawingArea;
use plotters_backend::text_anchor::HPos;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};

use crate::draw::{Setting, Size, draw, size};
use crate::figure::Figure;
use crate::font::{self, TextLayout};
use crate::ink::{FONT_PX, Ink};
use crate::theme::{FONTS, Theme};

/// Plotters counts in whole numbers: the drawing's unit is a tenth of a pixel, finer than the eye.
const UNIT: f64 = 10.0;

/// Returns the figure as an `<svg>` element for a page that carries [`style_sheet`](crate::css::style_sheet). The same figure gives the same bytes.
pub fn inline_svg(figure: &Figure) -> String {
    write_figure(figure, Setting::Page, Paint::Classes)
}

/// Returns the figure with its title as an SVG document that stands alone, in the colours of a theme. Every colour is an attribute,
/// because programs that are not browsers read no variables of CSS. The same figure gives the same bytes.
pub fn standalone_svg(figure: &Figure, theme: Theme) -> String {
    write_figure(figure, Setting::Alone, Paint::Attributes(theme))
}

/// Returns text that is safe inside markup and attributes; control characters, which XML forbids, are left out.
pub fn escape_xml(text: &str) -> String {
    let allowed: String = text.chars().filter(|c| !c.is_control() || c.is_whitespace()).collect();
    allowed.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn write_figure(figure: &Figure, setting: Setting, paint: Paint) -> String {
    let Size { width, height } = size(figure, setting);
    let size = ((UNIT * width).round() as u32, (UNIT * height).round() as u32);
    let backend = Rc::new(RefCell::new(Svg { text: String::new(), size, paint, path: None }));
    let result = draw(&DrawingArea::from(&backend), UNIT, figure, setting);
    let mut text = opening_tag(figure, size.0, size.1, paint);
    let mut backend = backend.borrow_mut();
    backend.end_path();
    text.push_str(&backend.text);
    if let Err(error) = result {
        // nothing in the backend fails; should plotters ever refuse a layout, the page says so where the figure would be
        let message = escape_xml(&error.to_string());
        let _ = writeln!(text, "<text x=\"20\" y=\"20\">This figure cannot be drawn: {message}</text>");
    }
    text.push_str("</svg>\n");
    text
}

fn opening_tag(figure: &Figure, width: u32, height: u32, paint: Paint) -> String {
    let (width, height) = (tenths(width as i32), tenths(height as i32));
    let dress = match paint {
        Paint::Classes => "class=\"fig\"".to_owned(),
        Paint::Attributes(_) => {
            format!("width=\"{width}\" height=\"{height}\" font-family=\"{FONTS}\" font-size=\"{FONT_PX}px\"")
        }
    };
    format!(
        "<svg {dress} xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">\n",
        escape_xml(&figure.title)
    )
}

/// The way in which an element gets its colours.
#[derive(Debug, Clone, Copy)]
enum Paint {
    /// From the classes of the page's style.
    Classes,
    /// From attributes of its own.
    Attributes(Theme),
}

/// A backend of plotters that writes SVG.
struct Svg {
    text: String,
    size: (u32, u32),
    paint: Paint,
    /// A path that the next line of the same ink continues, so that a grid is one element.
    path: Option<(Ink, String)>,
}

type DrawingResult = Result<(), DrawingErrorKind<Infallible>>;

impl Svg {
    /// Writes an element with the colours of an ink and more attributes.
    fn element(&mut self, name: &str, ink: Ink, attributes: std::fmt::Arguments<'_>) {
        self.end_path();
        self.element_now(name, ink, attributes);
    }

    fn element_now(&mut self, name: &str, ink: Ink, attributes: std::fmt::Arguments<'_>) {
        let paint = self.paint_of(ink);
        // writing to a string cannot fail
        let _ = writeln!(self.text, "<{name} {paint} {attributes}/>");
    }

    fn paint_of(&self, ink: Ink) -> String {
        match self.paint {
            Paint::Classes => format!("class=\"{}\"", ink.class()),
            Paint::Attributes(theme) => ink.attributes(theme),
        }
    }

    /// Adds to the path of an ink.
    fn extend_path(&mut self, ink: Ink, steps: &str) {
        match &mut self.path {
            Some((last, path)) if *last == ink => path.push_str(steps),
            _ => {
                self.end_path();
                self.path = Some((ink, steps.to_owned()));
            }
        }
    }

    fn end_path(&mut self) {
        if let Some((ink, path)) = self.path.take() {
            self.element_now("path", ink, format_args!("d=\"{path}\""));
        }
    }
}

impl DrawingBackend for Svg {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> DrawingResult {
        Ok(())
    }

    fn present(&mut self) -> DrawingResult {
        self.end_path();
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> DrawingResult {
        self.draw_rect((x, y), (x + 1, y + 1), &colour, true)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> DrawingResult {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
        _fill: bool,
    ) -> DrawingResult {
        let opacity = match style.color().alpha {
            1.0 => String::new(),
            alpha => format!(" fill-opacity=\"{alpha:.2}\""),
        };
        let (x, y, width, height) =
            (tenths(from.0), tenths(from.1), tenths(to.0 - from.0), tenths(to.1 - from.1));
        self.element(
            "rect",
            Ink::from_colour(style.color()),
            format_args!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{opacity}"),
        );
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> DrawingResult {
        let mut steps = String::new();
        for (k, (x, y)) in path.into_iter().enumerate() {
            let letter = if k == 0 { 'M' } else { 'L' };
            let _ = write!(steps, "{letter}{} {}", tenths(x), tenths(y));
        }
        self.extend_path(Ink::from_colour(style.color()), &steps);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        _fill: bool,
    ) -> DrawingResult {
        let (x, y, radius) = (tenths(centre.0), tenths(centre.1), tenths(radius as i32));
        self.element(
            "circle",
            Ink::from_colour(style.color()),
            format_args!("cx=\"{x}\" cy=\"{y}\" r=\"{radius}\""),
        );
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> DrawingResult {
        let corners: Vec<String> =
            corners.into_iter().map(|(x, y)| format!("{},{}", tenths(x), tenths(y))).collect();
        self.element(
            "polygon",
            Ink::from_colour(style.color()),
            format_args!("points=\"{}\"", corners.join(" ")),
        );
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, at: BackendCoord) -> DrawingResult {
        self.end_path();
        let TextLayout { ink, rise_deg: rise, below_anchor_px: down, anchor } = TextLayout::of(style);
        let (x, y) = (f64::from(at.0) / UNIT, f64::from(at.1) / UNIT);
        let place = if rise == 0.0 {
            format!("x=\"{}\" y=\"{}\"", pixels(x), pixels(y + down))
        } else {
            format!(
                "transform=\"translate({} {}) rotate({})\" y=\"{}\"",
                pixels(x),
                pixels(y),
                -rise,
                pixels(down)
            )
        };
        let anchor = match anchor {
            HPos::Left => "",
            HPos::Center => " text-anchor=\"middle\"",
            HPos::Right => " text-anchor=\"end\"",
        };
        let paint = self.paint_of(ink);
        let _ = writeln!(self.text, "<text {paint} {place}{anchor}>{}</text>", escape_xml(text));
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        Ok(font::box_of(text, style))
    }

    fn blit_bitmap(&mut self, _: BackendCoord, _: (u32, u32), _: &[u8]) -> DrawingResult {
        // figures hold no bitmaps
        Ok(())
    }
}

/// Returns a length in units as pixels, without trailing zeros.
fn tenths(units: i32) -> String {
    pixels(f64::from(units) / UNIT)
}

/// Returns a length in pixels to a tenth, without trailing zeros.
fn pixels(value: f64) -> String {
    let rounded = (value * UNIT).round() / UNIT;
    // adding 0 takes the sign from a zero
    (rounded + 0.0).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_safe_in_markup() {
        assert_eq!(escape_xml("a < b & \"c\" > d\u{1}"), "a &lt; b &amp; &quot;c&quot; &gt; d");
    }

    #[test]
    fn lengths_are_short() {
        assert_eq!([0, -4, 10, 6400, 15].map(tenths), ["0", "-0.4", "1", "640", "1.5"]);
        assert_eq!(pixels(-0.01), "0");
    }
}
