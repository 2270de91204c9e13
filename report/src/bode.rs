//! Bode diagrams: magnitude and phase over frequency.

use crate::tolerance::DEPTH_DB;
use counterpoise_pipeline::design_views::FrequencyResponse;
use counterpoise_plot::{Axis, Colour, Dash, Figure, Mark, Panel, Series};
use ndarray::Array2;

/// A frequency response for a Bode diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct BodeCurve {
    /// Its name in the legend.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Its dash.
    pub dash: Dash,
    /// The response.
    pub response: FrequencyResponse,
}

/// The place of the phase in a diagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhasePanel {
    /// In a panel of its own under the magnitude.
    Shown,
    /// Not at all.
    Hidden,
}

/// Returns a response from its points: frequency in Hz, real part and imaginary part, by rising frequency.
pub fn response_of(name: &str, points: impl IntoIterator<Item = [f64; 3]>) -> FrequencyResponse {
    let points: Vec<[f64; 3]> = points.into_iter().collect();
    FrequencyResponse { name: name.to_owned(), points: Array2::from(points) }
}

/// The range shown below the lowest mark, dB.
const BELOW_MARK_DB: f64 = 20.0;

impl BodeCurve {
    /// Returns an unbroken curve with the name of its response.
    pub fn new(response: FrequencyResponse, colour: Colour) -> Self {
        Self { name: response.name.clone(), colour, dash: Dash::Solid, response }
    }

    /// Returns the same curve, dashed.
    pub fn with_dashes(self) -> Self {
        Self { dash: Dash::Dashed, ..self }
    }

    fn series(&self, points: &[[f64; 2]]) -> Series {
        Series::new(&self.name, self.colour, self.dash, points.iter().map(|[hz, value]| (*hz, *value)))
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
    let magnitudes: Vec<Series> =
        curves.iter().map(|curve| curve.series(&curve.response.magnitude_db())).collect();
    let levels = || magnitudes.iter().flat_map(|s| s.points.column(1).to_vec()).filter(|y| y.is_finite());
    let (lowest, highest) = (levels().fold(f64::MAX, f64::min), levels().fold(f64::MIN, f64::max));
    let axis = Axis::linear("magnitude", &label);
    let [from, to] = window_db(highest, &marks);
    let axis = if highest - lowest > DEPTH_DB { axis.with_range(from, to) } else { axis };
    let mut panels = vec![Panel::new(axis, magnitudes).with_marks(marks)];
    if phase == PhasePanel::Shown {
        let phases = curves.iter().map(|curve| curve.series(&curve.response.phase_deg())).collect();
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
}
