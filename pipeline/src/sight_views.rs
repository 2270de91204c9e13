//! The spectrum of the line of sight ready to be drawn: power, cumulative RMS, and the shares of its sources, at each place.

use counterpoise_verify::sight_spectrum::SightSpectrum;
use counterpoise_verify::{ErrorBudget, Verification};

/// Points of a chart: frequency in Hz, and a value.
pub type SpectrumPoints = Vec<[f64; 2]>;

/// The spectrum of the line of sight at one place.
#[derive(Debug, Clone, PartialEq)]
pub struct SightView {
    /// `hub`, `tip`, or `tip against the hub`.
    pub place: &'static str,
    /// Power density of all sources, urad^2/Hz.
    pub density: SpectrumPoints,
    /// RMS of all sources up to each frequency, urad.
    pub cumulative_rms: SpectrumPoints,
    /// RMS of the linear loop up to each frequency, urad.
    pub linear_cumulative_rms: SpectrumPoints,
    /// The sources that move the place, by the size of their share, the largest first.
    pub sources: Vec<SourceView>,
}

/// The effect of one source on the line of sight at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceView {
    /// Name of the source.
    pub name: &'static str,
    /// Power density of its share, urad^2/Hz.
    pub density: SpectrumPoints,
    /// Power density in the linear loop, urad^2/Hz; `None` if the source has no place there.
    pub linear_density: Option<SpectrumPoints>,
    /// Its share in the mean square of the whole run up to each frequency, percent.
    pub cumulative_share: SpectrumPoints,
}

/// Microradians in a radian.
const MICRO: f64 = 1e6;

/// A place at which the line of sight is observed.
#[derive(Debug, Clone, Copy)]
struct Place {
    name: &'static str,
    of: fn(&SightSpectrum) -> &Vec<f64>,
}

const PLACES: [Place; 3] = [
    Place { name: "hub", of: |spectrum| &spectrum.hub_rad2 },
    Place { name: "tip", of: |spectrum| &spectrum.tip_rad2 },
    Place { name: "tip against the hub", of: |spectrum| &spectrum.bending_rad2 },
];

/// Returns the spectrum at the hub and at the tip, and that of the tip against the hub; a place where nothing moves is left out. There is
/// none if the verification did not ask for the line of sight.
pub fn view_sight(found: &Verification) -> Vec<SightView> {
    found.error_budget.as_ref().map(view_error_budget).unwrap_or_default()
}

fn view_error_budget(budget: &ErrorBudget) -> Vec<SightView> {
    let moves = |place: &Place| (place.of)(&budget.total).iter().sum::<f64>() > 0.0;
    PLACES.into_iter().filter(moves).map(|place| view_place(budget, place)).collect()
}

fn view_place(budget: &ErrorBudget, place: Place) -> SightView {
    let total = (place.of)(&budget.total);
    let linear = budget.linear_spectrum();
    SightView {
        place: place.name,
        density: density(budget, total),
        cumulative_rms: cumulative_rms(budget, total),
        linear_cumulative_rms: cumulative_rms(budget, (place.of)(&linear)),
        sources: view_sources(budget, place),
    }
}

fn view_sources(budget: &ErrorBudget, place: Place) -> Vec<SourceView> {
    let mut all: Vec<(f64, SourceView)> = Vec::new();
    for one in &budget.contributions {
        let share = (place.of)(&one.share);
        let size = share.iter().sum::<f64>().abs();
        if size > 0.0 {
            let linear = one.linear.as_ref();
            let view = SourceView {
                name: one.source.name(),
                density: density(budget, share),
                linear_density: linear.map(|linear| density(budget, (place.of)(&linear.spectrum))),
                cumulative_share: cumulative_share(budget, share, (place.of)(&budget.total)),
            };
            all.push((size, view));
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, view)| view).collect()
}

fn density(budget: &ErrorBudget, bands: &[f64]) -> SpectrumPoints {
    budget.densities(bands).into_iter().map(|[hz, density]| [hz, MICRO * MICRO * density]).collect()
}

fn cumulative_rms(budget: &ErrorBudget, bands: &[f64]) -> SpectrumPoints {
    budget.cumulative_rms(bands).into_iter().map(|[hz, rms]| [hz, MICRO * rms]).collect()
}

fn cumulative_share(budget: &ErrorBudget, share: &[f64], total: &[f64]) -> SpectrumPoints {
    budget.cumulative_share(share, total).into_iter().map(|[hz, share]| [hz, 100.0 * share]).collect()
}
