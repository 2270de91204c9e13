//! Charts over frequency, which several pages share.

use std::f64::consts::TAU;

use counterpoise_lti::Margins;
use counterpoise_verify::linear_loop::ResponseCurve as Response;

use crate::charts::chart::{AxisScale, Chart};
use crate::units::GainUnit;
use crate::view::StudioView;

/// Returns an empty chart over frequency, its gains in the chosen unit.
pub fn frequency_chart(view: &StudioView, title: &str, label: &str) -> Chart {
    let (unit, scale) = match view.units.gain {
        GainUnit::Decibel => (", dB", AxisScale::Linear),
        GainUnit::Absolute => ("", AxisScale::Log),
    };
    let mut chart = Chart::new(title, view.units.frequency_label(), &format!("{label}{unit}"));
    chart.scales = [AxisScale::Log, scale];
    chart
}

/// Returns the moduli of a response in the chosen units.
pub fn magnitude_points(view: &StudioView, frequencies_hz: &[f64], response: &Response) -> Vec<[f64; 2]> {
    let point = |(f, h): (&f64, &counterpoise_linalg::C64)| {
        [view.units.display_frequency(f * TAU), view.units.display_gain(h.norm())]
    };
    frequencies_hz.iter().zip(&response.response).map(point).collect()
}

/// Marks the phase margin and the gain margin in a chart of the loop gain.
pub fn mark_margins(view: &StudioView, margins: &Margins, chart: &mut Chart) {
    if let Some(crossing) = margins.phase_margin() {
        let x = view.units.display_frequency(crossing.rate_rad_s);
        chart.add_mark(x, format!("{:.0}\u{b0}", crossing.deg));
    }
    if let Some(gain) = margins.gain_increase() {
        chart.add_mark(view.units.display_frequency(gain.rate_rad_s), format!("{:.1} dB", gain.db));
    }
}
