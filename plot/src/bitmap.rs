//! Figures as bitmaps, drawn by plotters' bitmap backend in the colours of a theme.

use std::cell::RefCell;
use std::rc::Rc;

use plotters::backend::BitMapBackend;
use plotters::drawing::DrawingArea;
use plotters_backend::text_anchor::HPos;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};

use crate::dashes::cut_dashes;
use crate::draw::{Setting, Size, draw, size};
use crate::error::PlotError;
use crate::figure::{Dash, Figure};
use crate::font::{self, Placement, TextLayout};
use crate::ink::{Appearance, Ink};
use crate::theme::{Role, Theme};

/// Points drawn along each side of a pixel. Plotters draws lines wider than one point with hard edges; averaged over 3 x 3 points
/// they are smooth.
const OVERSAMPLING: usize = 3;
/// Limits of the scale: below, text cannot be read; above, a figure takes more than a gigabyte while it is drawn.
const SCALES: (f64, f64) = (0.5, 6.0);
/// Additional width of the stems of bold letters, as a part of the font's size.
const BOLD: f64 = 0.05;

/// A picture in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bitmap {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row by row from the top left.
    pub rgb: Vec<u8>,
}

/// Returns the figure with its title as a bitmap of `scale` pixels for each pixel of the figure (1 for a screen, 2 to 4 for print),
/// limited to 0.5 .. 6. The same figure gives the same bytes.
///
/// # Errors
/// Returns [`PlotError::Drawing`] if plotters refuses the drawing.
pub fn bitmap(figure: &Figure, theme: Theme, scale: f64) -> Result<Bitmap, PlotError> {
    let scale = if scale.is_finite() { scale.clamp(SCALES.0, SCALES.1) } else { 1.0 };
    let Size { width, height } = size(figure, Setting::Alone);
    let (width, height) = ((scale * width).ceil() as usize, (scale * height).ceil() as usize);
    let (wide, high) = (width * OVERSAMPLING, height * OVERSAMPLING);
    let mut points = vec![0; 3 * wide * high];
    {
        let inner = BitMapBackend::with_buffer_and_format(&mut points, (wide as u32, high as u32))
            .map_err(|error| PlotError::Drawing(error.to_string()))?;
        let unit = scale * OVERSAMPLING as f64;
        let backend = Rc::new(RefCell::new(Brush { inner, theme, unit }));
        draw(&DrawingArea::from(&backend), unit, figure, Setting::Alone)
            .map_err(|error| PlotError::Drawing(error.to_string()))?;
    }
    Ok(Bitmap { width, height, rgb: average_points(&points, width, height) })
}

/// Returns the figure with its title as a PNG file; see [`bitmap`] for `scale`.
///
/// # Errors
/// Returns [`PlotError::Drawing`] if plotters refuses the drawing and [`PlotError::Encoding`] if it cannot be packed.
pub fn png(figure: &Figure, theme: Theme, scale: f64) -> Result<Vec<u8>, PlotError> {
    let bitmap = bitmap(figure, theme, scale)?;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, bitmap.width as u32, bitmap.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(&bitmap.rgb)?;
    Ok(file)
}

/// Means of squares of points.
fn average_points(points: &[u8], width: usize, height: usize) -> Vec<u8> {
    let row = 3 * width * OVERSAMPLING;
    let mut rgb = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let first = y * OVERSAMPLING * row + 3 * x * OVERSAMPLING + channel;
                let square = (0..OVERSAMPLING)
                    .flat_map(|down| (0..OVERSAMPLING).map(move |right| first + down * row + 3 * right));
                let sum: usize = square.map(|k| usize::from(points[k])).sum();
                rgb.push(((sum + OVERSAMPLING * OVERSAMPLING / 2) / (OVERSAMPLING * OVERSAMPLING)) as u8);
            }
        }
    }
    rgb
}

/// Plotters' bitmap backend with inks in place of colours, dashes, round joints, and text from the embedded font.
struct Brush<'a> {
    inner: BitMapBackend<'a>,
    theme: Theme,
    /// Points for each pixel of the figure.
    unit: f64,
}

/// A line's colour and width in points.
struct Stroke {
    colour: BackendColor,
    width: u32,
}

impl BackendStyle for Stroke {
    fn color(&self) -> BackendColor {
        self.colour
    }

    fn stroke_width(&self) -> u32 {
        self.width
    }
}

type Failure<'a> = DrawingErrorKind<<BitMapBackend<'a> as DrawingBackend>::ErrorType>;

impl<'a> Brush<'a> {
    fn colour(&self, role: Role, opacity: f64) -> BackendColor {
        BackendColor { alpha: opacity, rgb: self.theme.colour(role) }
    }

    fn stroke(&self, look: &Appearance) -> Option<Stroke> {
        let width = (look.width * self.unit).round().max(1.0) as u32;
        look.stroke.map(|role| Stroke { colour: self.colour(role, look.opacity), width })
    }

    fn disc(&mut self, centre: BackendCoord, radius: f64, colour: BackendColor) -> Result<(), Failure<'a>> {
        self.inner.draw_circle(centre, radius.round().max(0.0) as u32, &colour, true)
    }

    /// A line through points, with round joints and, where `caps` says so, round ends.
    fn polyline(&mut self, points: &[BackendCoord], stroke: &Stroke, caps: Caps) -> Result<(), Failure<'a>> {
        for pair in points.windows(2) {
            self.inner.draw_line(pair[0], pair[1], stroke)?;
        }
        let inner = if caps == Caps::Round { 0..points.len() } else { 1..points.len().max(2) - 1 };
        if stroke.width > 2 {
            for point in &points[inner] {
                self.disc(*point, 0.5 * f64::from(stroke.width), stroke.colour)?;
            }
        }
        Ok(())
    }
}

/// The ends of lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Caps {
    Flat,
    Round,
}

impl<'a> DrawingBackend for Brush<'a> {
    type ErrorType = <BitMapBackend<'a> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.inner.get_size()
    }

    fn ensure_prepared(&mut self) -> Result<(), Failure<'a>> {
        self.inner.ensure_prepared()
    }

    fn present(&mut self) -> Result<(), Failure<'a>> {
        self.inner.present()
    }

    fn draw_pixel(&mut self, at: BackendCoord, colour: BackendColor) -> Result<(), Failure<'a>> {
        let role = Ink::from_colour(colour).appearance().fill.unwrap_or(Role::Ink);
        self.inner.draw_pixel(at, self.colour(role, colour.alpha))
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Result<(), Failure<'a>> {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
        _fill: bool,
    ) -> Result<(), Failure<'a>> {
        let look = Ink::from_colour(style.color()).appearance();
        if let Some(role) = look.fill {
            let colour = self.colour(role, look.opacity * style.color().alpha);
            self.inner.draw_rect(from, to, &colour, true)?;
        }
        match self.stroke(&look) {
            // two more points than corners: the last joint is drawn like the others
            Some(stroke) => {
                let corners = [from, (to.0, from.1), to, (from.0, to.1), from, (to.0, from.1)];
                self.polyline(&corners, &stroke, Caps::Flat)
            }
            None => Ok(()),
        }
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Result<(), Failure<'a>> {
        let ink = Ink::from_colour(style.color());
        let look = ink.appearance();
        let Some(stroke) = self.stroke(&look) else { return Ok(()) };
        let is_round = matches!(ink, Ink::Curve(_, Dash::Solid | Dash::Dotted));
        let caps = if is_round { Caps::Round } else { Caps::Flat };
        let points: Vec<BackendCoord> = path.into_iter().collect();
        let lengths: Vec<f64> = look.dashes.iter().map(|length| length * self.unit).collect();
        for part in cut_dashes(&points, &lengths) {
            self.polyline(&part, &stroke, caps)?;
        }
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        _fill: bool,
    ) -> Result<(), Failure<'a>> {
        let look = Ink::from_colour(style.color()).appearance();
        let half = if look.stroke.is_some() { 0.5 * look.width * self.unit } else { 0.0 };
        let rings = [(look.stroke, f64::from(radius) + half), (look.fill, f64::from(radius) - half)];
        for (role, radius) in rings {
            if let Some(role) = role {
                self.disc(centre, radius, self.colour(role, look.opacity))?;
            }
        }
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Result<(), Failure<'a>> {
        let look = Ink::from_colour(style.color()).appearance();
        match look.fill {
            Some(role) => self.inner.fill_polygon(corners, &self.colour(role, look.opacity)),
            None => Ok(()),
        }
    }

    fn draw_text<T: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &T,
        at: BackendCoord,
    ) -> Result<(), Failure<'a>> {
        let TextLayout { ink, rise_deg, below_anchor_px, anchor } = TextLayout::of(style);
        let look = ink.appearance();
        let colour = self.colour(look.fill.unwrap_or(Role::Ink), look.opacity);
        let angle = rise_deg.to_radians();
        let direction = (angle.cos(), angle.sin());
        let part = match anchor {
            HPos::Left => 0.0,
            HPos::Center => 0.5,
            HPos::Right => 1.0,
        };
        let back = part * font::width(text, style.size());
        let down = self.unit * below_anchor_px;
        let at = (
            f64::from(at.0) - back * direction.0 + down * direction.1,
            f64::from(at.1) + back * direction.1 + down * direction.0,
        );
        // the font has no bold letters: a title's are drawn twice, a little apart
        let shifts = if ink == Ink::Title { &[0.0, BOLD][..] } else { &[0.0] };
        for shift in shifts {
            let at = (at.0 + shift * style.size(), at.1);
            let placement = Placement { at, size: style.size(), direction };
            font::draw(text, placement, |at, coverage| self.inner.draw_pixel(at, colour.mix(coverage)))?;
        }
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), Failure<'a>> {
        Ok(font::box_of(text, style))
    }
}
