//! The rejection ratio from time histories, as a section.

use counterpoise_models::ControlledQuantity;
use counterpoise_verify::rejection_spectra::{CONFIDENCE, HubRateSpectra};
use counterpoise_verify::{Arrangement, Source};

use crate::ReportSection;
use counterpoise_plot::{Axis, Band, Colour, Figure, Panel, Series};

/// Frequencies that are drawn, Hz: a vehicle has little above.
const BAND_HZ: (f64, f64) = (0.3, 12.0);

/// Returns the hub rate over pitch and over heave on the road, with confidence and coherence; nothing without
/// a road.
pub fn spectra_section(all: &[HubRateSpectra], controlled: ControlledQuantity) -> Option<ReportSection> {
    if all.is_empty() {
        return None;
    }
    let (name, unit) = (controlled.name(), controlled.unit());
    let base = controlled.base_rate_unit();
    let over_pitch = format!("dB of {unit} per {base}");
    let of = |source| all.iter().filter(move |one| one.source == source).collect::<Vec<_>>();
    let text = format!(
        "Read from the time histories on the road, nonlinear plant, by averaged spectra; the band is the {:.0} % confidence interval. \
         Where the coherence is low, the hub moves for another reason: the other motion of the platform, friction, noise.",
        100.0 * CONFIDENCE
    );
    Some(ReportSection::new("Disturbance rejection from the road").with_text(text).with_figures([
        figure(
            &format!("DRR on the road: |Pxy / Pxx|, {} to {name}", controlled.base_rate_name()),
            if unit == base { "dB" } else { &over_pitch },
            &of(Source::Pitch),
        ),
        figure(
            &format!("DRR on the road: |Pxy / Pxx|, heave to {name}"),
            &format!("dB of {unit} per m/s\u{B2}"),
            &of(Source::Heave),
        ),
    ]))
}

fn figure(title: &str, unit: &str, all: &[&HubRateSpectra]) -> Figure {
    let ratio = all.iter().map(|one| line(one, &one.spectra.ratio_db)).collect();
    let bands = all.iter().filter(|one| one.arrangement != Arrangement::Uncontrolled).map(|one| band(one));
    let coherence = all.iter().map(|one| line(one, &one.spectra.coherence)).collect();
    let first = Panel::new(Axis::linear("ratio", unit), ratio).with_height(220.0).with_bands(bands.collect());
    let second = Panel::new(Axis::linear("coherence", "").with_range(0.0, 1.0), coherence).with_height(110.0);
    Figure::new(title, Axis::logarithmic("frequency", "Hz"), vec![first, second])
}

fn dress(arrangement: Arrangement) -> (&'static str, Colour) {
    match arrangement {
        Arrangement::Uncontrolled => ("without control", Colour::Muted),
        Arrangement::Feedback => ("feedback", Colour::Second),
        Arrangement::Compensated => ("feedback + feedforward", Colour::First),
    }
}

fn is_drawn(hz: f64) -> bool {
    (BAND_HZ.0..=BAND_HZ.1).contains(&hz)
}

fn line(one: &HubRateSpectra, values: &[f64]) -> Series {
    let (name, colour) = dress(one.arrangement);
    let pairs = one.spectra.frequency_hz.iter().copied().zip(values.iter().copied());
    Series::solid_line(name, colour, pairs.filter(|(hz, value)| is_drawn(*hz) && value.is_finite()))
}

fn band(one: &HubRateSpectra) -> Band {
    let (_, colour) = dress(one.arrangement);
    let edges = one.spectra.frequency_hz.iter().copied().zip(&one.spectra.interval_db);
    let points = edges.map(|(hz, [low, high])| (hz, *low, *high));
    let sound = points.filter(|(hz, low, high)| is_drawn(*hz) && low.is_finite() && high.is_finite());
    Band::new("", colour, sound)
}
