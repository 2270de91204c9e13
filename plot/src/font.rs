//! The embedded font: how wide text is, and its outlines for a bitmap.
//!
//! A subset of DejaVu Sans (Latin, Greek, raised digits, the signs of mathematics) without hints. Its licence, which stands beside
//! it, allows it to be embedded and distributed.

use ab_glyph::{Font, FontRef, Outline, OutlineCurve, Point, point};
use ab_glyph_rasterizer::Rasterizer;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendTextStyle, FontTransform};

use crate::ink::Ink;

const BYTES: &[u8] = include_bytes!("../fonts/DejaVuSans.subset.ttf");
/// Units of the font in the height of its letters' square.
const UNITS: f32 = 2048.0;
/// Heights to which letters reach above and below the base line, as parts of the font's size.
const ASCENT: f64 = 0.8;
const DESCENT: f64 = 0.22;
/// Height of the middle of digits and capital letters above the base line, as a part of the font's size.
const MIDDLE: f64 = 0.36;

/// Position of a line of text on a picture: the start of its base line, its size, and its direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    /// Start of the base line.
    pub at: (f64, f64),
    /// Height of the letters' square.
    pub size: f64,
    /// Cosine and sine of the angle by which the text rises.
    pub direction: (f64, f64),
}

/// Position of the text of a style about its anchor.
#[derive(Clone, Copy)]
pub(crate) struct TextLayout {
    /// Ink of the text.
    pub ink: Ink,
    /// Angle by which it rises, degrees.
    pub rise_deg: f64,
    /// Distance of its base line below the anchor, pixels of the figure.
    pub below_anchor_px: f64,
    /// Point of the text that lies at the anchor.
    pub anchor: HPos,
}

impl TextLayout {
    /// Returns the layout of a style of plotters.
    pub(crate) fn of<T: BackendTextStyle>(style: &T) -> Self {
        let ink = Ink::from_colour(style.color());
        Self {
            ink,
            rise_deg: rise_deg(ink, style.transform()),
            below_anchor_px: below_anchor(ink, style.anchor().v_pos),
            anchor: style.anchor().h_pos,
        }
    }
}

/// Returns the width of a text, in the unit of `size`. A sign that the font lacks has the width of its replacement.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let Ok(font) = FontRef::try_from_slice(BYTES) else { return 0.0 };
    let advances = text.chars().map(|c| f64::from(font.h_advance_unscaled(font.glyph_id(c))));
    advances.sum::<f64>() * size / f64::from(UNITS)
}

/// Returns how far the base line of a text lies below its anchor, in pixels of the figure.
fn below_anchor(ink: Ink, anchor: VPos) -> f64 {
    let part = match anchor {
        VPos::Top => ASCENT,
        VPos::Center => MIDDLE,
        VPos::Bottom => -DESCENT,
    };
    part * ink.appearance().font_px
}

/// Returns the angle by which a text rises, in degrees.
fn rise_deg(ink: Ink, transform: FontTransform) -> f64 {
    let turned = match transform {
        FontTransform::None => 0.0,
        FontTransform::Rotate90 => -90.0,
        FontTransform::Rotate180 => 180.0,
        FontTransform::Rotate270 => 90.0,
    };
    turned + ink.appearance().rise_deg
}

/// Returns the width and height of the box around a text, in the unit of the style's size.
pub(crate) fn box_of<T: BackendTextStyle>(text: &str, style: &T) -> (u32, u32) {
    let size = style.size();
    let (width, height) = (width(text, size).ceil() as u32, ((ASCENT + DESCENT) * size).ceil() as u32);
    match style.transform() {
        FontTransform::None | FontTransform::Rotate180 => (width, height),
        FontTransform::Rotate90 | FontTransform::Rotate270 => (height, width),
    }
}

/// Calls `pixel` with place and coverage (0 to 1) of each pixel that a text covers.
pub(crate) fn draw<E>(
    text: &str,
    placement: Placement,
    mut pixel: impl FnMut((i32, i32), f64) -> Result<(), E>,
) -> Result<(), E> {
    let Ok(font) = FontRef::try_from_slice(BYTES) else { return Ok(()) };
    let mut pen = 0.0;
    for c in text.chars() {
        let glyph = font.glyph_id(c);
        if let Some(outline) = font.outline(glyph) {
            draw_outline(&outline, placement, pen, &mut pixel)?;
        }
        pen += font.h_advance_unscaled(glyph);
    }
    Ok(())
}

/// Draws one letter whose origin lies `pen` units of the font after the start of the text.
fn draw_outline<E>(
    outline: &Outline,
    placement: Placement,
    pen: f32,
    pixel: &mut impl FnMut((i32, i32), f64) -> Result<(), E>,
) -> Result<(), E> {
    let scale = placement.size / f64::from(UNITS);
    let (cosine, sine) = placement.direction;
    let place = |p: &Point| {
        let (along, up) = (f64::from(p.x + pen) * scale, f64::from(p.y) * scale);
        let x = placement.at.0 + along * cosine - up * sine;
        let y = placement.at.1 - along * sine - up * cosine;
        point(x as f32, y as f32)
    };
    let corners: Vec<Point> = outline.curves.iter().flat_map(points).map(|p| place(&p)).collect();
    let low = |of: fn(&Point) -> f32| corners.iter().map(of).fold(f32::INFINITY, f32::min).floor();
    let high = |of: fn(&Point) -> f32| corners.iter().map(of).fold(f32::NEG_INFINITY, f32::max).ceil();
    let corner = point(low(|p| p.x), low(|p| p.y));
    let (width, height) = (high(|p| p.x) - corner.x + 1.0, high(|p| p.y) - corner.y + 1.0);
    if !(width.is_finite() && height.is_finite()) {
        return Ok(());
    }
    let mut raster = Rasterizer::new(width as usize, height as usize);
    let local = |p: &Point| place(p) - corner;
    for curve in &outline.curves {
        match curve {
            OutlineCurve::Line(a, b) => raster.draw_line(local(a), local(b)),
            OutlineCurve::Quad(a, b, c) => raster.draw_quad(local(a), local(b), local(c)),
            OutlineCurve::Cubic(a, b, c, d) => raster.draw_cubic(local(a), local(b), local(c), local(d)),
        }
    }
    let mut result = Ok(());
    raster.for_each_pixel_2d(|x, y, coverage| {
        if result.is_ok() && coverage > 0.0 {
            let place = (corner.x as i32 + x as i32, corner.y as i32 + y as i32);
            result = pixel(place, f64::from(coverage.min(1.0)));
        }
    });
    result
}

fn points(curve: &OutlineCurve) -> Vec<Point> {
    match curve {
        OutlineCurve::Line(a, b) => vec![*a, *b],
        OutlineCurve::Quad(a, b, c) => vec![*a, *b, *c],
        OutlineCurve::Cubic(a, b, c, d) => vec![*a, *b, *c, *d],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_that_ticks_and_units_need_has_a_glyph() {
        let signs = "0123456789.,\u{2212}\u{207B}\u{2070}\u{B9}\u{B2}\u{B3}\u{2074}\u{2079}\u{D7}\u{221E}\u{2013}\u{221A}\u{B1}\u{B0}\
                     \u{2264}\u{2265}\u{3BC}\u{394}\u{2192}\u{2011}\u{A0}";
        let font = FontRef::try_from_slice(BYTES);
        assert!(font.is_ok_and(|font| signs.chars().all(|c| font.glyph_id(c).0 != 0)));
    }

    #[test]
    fn widths_are_those_of_the_letters() {
        assert!(width("iii", 12.0) < 0.5 * width("mmm", 12.0));
        assert!((width("0000", 12.0) - 4.0 * width("0", 12.0)).abs() < 1e-9);
        assert_eq!(width("", 12.0), 0.0);
    }

    #[test]
    fn rising_text_covers_as_much_as_level_text() {
        let ink = |angle: f64| {
            let direction = (angle.cos(), angle.sin());
            let mut sum = 0.0;
            let placement = Placement { at: (100.0, 100.0), size: 40.0, direction };
            let drawn = draw("Hub", placement, |_, coverage| {
                sum += coverage;
                Ok::<(), std::convert::Infallible>(())
            });
            assert!(drawn.is_ok());
            sum
        };
        assert!((ink(0.0) / ink(0.6) - 1.0).abs() < 0.01, "{} {}", ink(0.0), ink(0.6));
    }
}
