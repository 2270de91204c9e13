//! Charts over frequency, which several pages share.

use std::f64::consts::TAU;

use counterpoise_lti::Margins;
use counterpoise_verify::linear_loop::ResponseCurve as Response;

use crate::charts::chart::{AxisScale, Chart};
use crate::number_format::format_short;
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

/// Returns a frequency with two digits and its unit, short enough to stand beside a line.
fn frequency_words(view: &StudioView, frequency: f64) -> String {
    let number = match frequency {
        f if f >= 10.0 => format!("{f:.0}"),
        f if f >= 1.0 => format!("{f:.1}"),
        f => format_short(f),
    };
    format!("{number} {}", view.units.frequency_unit())
}

/// Marks the phase margin and the gain margin in a chart of the loop gain.
pub fn mark_margins(view: &StudioView, margins: &Margins, chart: &mut Chart) {
    if let Some(crossing) = margins.phase_margin() {
        let x = view.units.display_frequency(crossing.rate_rad_s);
        chart.add_mark(x, format!("PM {:.0}\u{b0} at {}", crossing.deg, frequency_words(view, x)));
    }
    if let Some(gain) = margins.gain_increase() {
        let x = view.units.display_frequency(gain.rate_rad_s);
        chart.add_mark(x, format!("GM {:.1} dB at {}", gain.db, frequency_words(view, x)));
    }
}
