//! The mechanism from the side, at a time of a run: platform and beam with their motion magnified until it is seen.

use std::f64::consts::FRAC_PI_2;

use counterpoise_verify::{History, HistoryColumn};
use egui::Color32;

use crate::charts::chart::{Chart, LabelledPoint, LineDash};
use crate::theme::WindowTheme;
use crate::tolerance::SEEN_ANGLE_RAD;

/// Title of the plot.
pub const MECHANISM: &str = "Mechanism";
/// Half of the length of the platform, and the length of the beam, in the units of the drawing.
const PLATFORM: f64 = 0.55;
const BEAM: f64 = 1.0;
/// Height of the pivot above the platform.
const POST: f64 = 0.25;
/// Half of the width and of the height of a slide.
const SLIDE: [f64; 2] = [0.18, 0.1];

/// How the mechanism of a run is drawn.
#[derive(Debug, Clone, Copy)]
pub struct MechanismDrawing<'a> {
    /// The run.
    pub run: &'a History,
    /// Time, s.
    pub time_s: f64,
    /// Elevation of the beam at the start, rad.
    pub elevation_rad: f64,
    /// `true` for a slide in place of a beam.
    pub is_slide: bool,
}

/// Returns the mechanism at a time of a run.
pub fn mechanism_chart(theme: &WindowTheme, drawing: &MechanismDrawing<'_>) -> Chart {
    let times = drawing.run.signals.column(HistoryColumn::Time);
    let travel = drawing.run.signals.column(HistoryColumn::Travel);
    let pitch = drawing.run.platform_angles_rad();
    let place = times.partition_point(|time| *time < drawing.time_s).min(times.len().saturating_sub(1));
    let at = |series: &[f64]| series.get(place).copied().unwrap_or(0.0);
    let largest = travel.iter().chain(&pitch).fold(0.0_f64, |most, value| most.max(value.abs()));
    let times_as_large = magnification(largest);
    let (tilt, moved) = (times_as_large * at(&pitch), times_as_large * at(travel));
    let mut chart = Chart::new(MECHANISM, "along the platform", "height");
    chart.range = [Some((-0.8, 1.3)), Some((-0.75, 0.95))];
    let turned = |angle: f64, length: f64| [length * angle.cos(), length * angle.sin()];
    let (left, right) = (turned(tilt, -PLATFORM), turned(tilt, PLATFORM));
    let pivot = turned(tilt + FRAC_PI_2, POST);
    chart = chart.with_path("", theme.curves[1], LineDash::Solid, vec![left, right]);
    chart = chart.with_path("", theme.curves[1], LineDash::Solid, vec![[0.0, 0.0], pivot]);
    chart = match drawing.is_slide {
        true => add_slide(chart, theme.curves[0], tilt, moved),
        false => {
            let angle = drawing.elevation_rad + tilt + moved;
            let tip = turned(angle, BEAM);
            let beam = vec![pivot, [pivot[0] + tip[0], pivot[1] + tip[1]]];
            chart.spots.push(LabelledPoint::new(pivot, ""));
            chart.with_path("", theme.curves[0], LineDash::Solid, beam)
        }
    };
    let text = format!("{:.2} s, motion x {times_as_large}", at(times));
    // the legend has the room for it, and nothing else stands there
    chart.with_path(&text, theme.weak, LineDash::Dotted, vec![[-0.6, -0.7], [-0.6, -0.7]])
}

/// Draws a slide on the platform.
fn add_slide(chart: Chart, colour: Color32, tilt: f64, moved: f64) -> Chart {
    let [width, height] = SLIDE;
    let corners = [[-width, 0.0], [width, 0.0], [width, 2.0 * height], [-width, 2.0 * height], [-width, 0.0]];
    let place = |[x, y]: [f64; 2]| {
        let (x, y) = (x + moved, y + 0.02);
        [x * tilt.cos() - y * tilt.sin(), x * tilt.sin() + y * tilt.cos()]
    };
    chart.with_path("", colour, LineDash::Solid, corners.map(place).to_vec())
}

/// Returns a round number by which the largest motion is multiplied so that it is seen; 1 if it is seen as it is, or if nothing moves.
fn magnification(largest: f64) -> f64 {
    let wanted = if largest > 0.0 { (SEEN_ANGLE_RAD / largest).min(1e6) } else { 1.0 };
    if wanted <= 1.0 {
        return 1.0;
    }
    let decade = 10f64.powf(wanted.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|part| part * decade).find(|round| *round <= wanted).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_is_magnified_by_round_numbers_until_it_is_seen() {
        for (largest, expected) in
            [(0.0, 1.0), (1.0, 1.0), (0.1, 2.0), (0.01, 20.0), (4e-3, 50.0), (1e-3, 200.0)]
        {
            assert_eq!(magnification(largest), expected, "{largest}");
        }
    }
}
