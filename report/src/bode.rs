//! Bode diagrams: magnitude and phase over frequency.

use crate::tolerance::DEPTH_DB;
use counterpoise_pipeline::design_views::FrequencyResponse;
use counterpoise_plot::{Axis, Colour, Dash, Figure, Mark, Panel, Point, Series};

/// A frequency response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponsePoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Real part of the response, in the unit of the diagram.
    pub re: f64,
    /// Its imaginary part.
    pub im: f64,
}

impl ResponsePoint {
    /// Returns the response re + j im at a frequency in Hz.
    pub const fn new(frequency_hz: f64, re: f64, im: f64) -> Self {
        Self { frequency_hz, re, im }
    }
}

/// A frequency response for a Bode diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct BodeCurve {
    /// Its name in the legend.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Its dash.
    pub dash: Dash,
    /// Its points, by increasing frequency.
    pub points: Vec<ResponsePoint>,
}

/// Whether the phase is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhasePanel {
    /// In a panel of its own under the magnitude.
    Shown,
    /// Not at all.
    Hidden,
}

/// Returns the points of a response as a curve of a Bode diagram.
pub fn response_curve(response: &FrequencyResponse, colour: Colour) -> BodeCurve {
    let points =
        response.points.rows().into_iter().map(|row| ResponsePoint::new(row[0], row[1], row[2])).collect();
    BodeCurve::new(&response.name, colour, points)
}

/// What is shown below the lowest mark, dB.
const BELOW_MARK_DB: f64 = 20.0;

impl BodeCurve {
    /// Returns an unbroken curve.
    pub fn new(name: &str, colour: Colour, points: Vec<ResponsePoint>) -> Self {
        Self { name: name.to_owned(), colour, dash: Dash::Solid, points }
    }

    /// Returns the same curve, dashed.
    pub fn with_dashes(self) -> Self {
        Self { dash: Dash::Dashed, ..self }
    }

    /// Returns the magnitude in dB over Hz.
    pub fn magnitude_db(&self) -> Vec<Point> {
        let db = |at: &ResponsePoint| Point::new(at.frequency_hz, 20.0 * at.re.hypot(at.im).log10());
        self.points.iter().map(db).collect()
    }

    /// Returns the phase in degrees over Hz, without jumps of a whole turn; it starts between -270 and 90 degrees.
    pub fn phase_deg(&self) -> Vec<Point> {
        let mut before: Option<f64> = None;
        let mut unwrapped = |re: f64, im: f64| {
            let raw = im.atan2(re).to_degrees();
            let start = if raw > 90.0 { raw - 360.0 } else { raw };
            let phase = before.map_or(start, |last| raw + 360.0 * ((last - raw) / 360.0).round());
            before = Some(phase);
            phase
        };
        self.points.iter().map(|at| Point::new(at.frequency_hz, unwrapped(at.re, at.im))).collect()
    }

    fn series(&self, points: Vec<Point>) -> Series {
        Series::new(&self.name, self.colour, self.dash, points)
    }
}

/// Returns a Bode diagram. `unit` is that of the magnitude's reference, for example `V s/rad`; `marks` stand in the magnitude panel.
pub fn bode_figure(
    title: &str,
    unit: &str,
    curves: &[BodeCurve],
    phase: PhasePanel,
    marks: Vec<Mark>,
) -> Figure {
    let label = if unit.is_empty() { "dB".to_owned() } else { format!("dB re {unit}") };
    let magnitudes: Vec<Series> = curves.iter().map(|curve| curve.series(curve.magnitude_db())).collect();
    let levels = || magnitudes.iter().flat_map(|s| s.points.column(1).to_vec()).filter(|y| y.is_finite());
    let (lowest, highest) = (levels().fold(f64::MAX, f64::min), levels().fold(f64::MIN, f64::max));
    let axis = Axis::linear("magnitude", &label);
    let [from, to] = window_db(highest, &marks);
    let axis = if highest - lowest > DEPTH_DB { axis.with_range(from, to) } else { axis };
    let mut panels = vec![Panel::new(axis, magnitudes).with_marks(marks)];
    if phase == PhasePanel::Shown {
        let phases = curves.iter().map(|curve| curve.series(curve.phase_deg())).collect();
        panels.push(Panel::new(Axis::degrees("phase"), phases).with_height(140.0));
    }
    Figure::new(title, Axis::logarithmic("frequency", "Hz"), panels)
}

/// Returns the part of an axis that is too long: from the top down, or lower where a mark would not be seen.
fn window_db(highest: f64, marks: &[Mark]) -> [f64; 2] {
    let heights = marks.iter().filter_map(|mark| match mark {
        Mark::Point { y, .. } | Mark::Cross { y, .. } | Mark::Level { y, .. } => Some(*y),
        Mark::Instant { .. } => None,
    });
    let from = heights.fold(highest - DEPTH_DB, |from, y| from.min(y - BELOW_MARK_DB));
    [from, (highest + 6.0).min(from + DEPTH_DB + 6.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_of_a_huge_gain_is_shown_where_its_margins_are() {
        let level = |y: f64| Mark::Level { y, text: String::new() };
        assert_eq!(window_db(160.0, &[level(0.0), level(-13.0)]), [-33.0, 93.0]);
        assert_eq!(window_db(10.0, &[level(0.0)]), [-110.0, 16.0]);
        assert_eq!(window_db(10.0, &[]), [-110.0, 16.0]);
    }

    #[test]
    fn three_integrators_end_at_minus_270_degrees_without_a_jump() {
        let lag = |f: f64| {
            // 1 / (1 + jf)^3
            let angle = -3.0 * f.atan();
            let size = (1.0 + f * f).powf(-1.5);
            ResponsePoint::new(f, size * angle.cos(), size * angle.sin())
        };
        let points = (0..200).map(|k| lag(10f64.powf(-2.0 + 0.025 * f64::from(k)))).collect();
        let curve = BodeCurve::new("lag", Colour::First, points);
        let phase = curve.phase_deg();
        assert!(phase.windows(2).all(|pair| (pair[1].y - pair[0].y).abs() < 20.0));
        assert!((phase[199].y + 270.0).abs() < 2.0, "{:?}", phase[199]);
        assert!(curve.magnitude_db()[0].y.abs() < 0.01);
    }
}
