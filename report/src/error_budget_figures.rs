//! The spectrum of the line of sight as figures: its power spectral density and its cumulative RMS, with the shares of its sources.

use counterpoise_plot::{Axis, Colour, Figure, Panel, Series};
use counterpoise_verify::sight_spectrum::SightSpectrum;
use counterpoise_verify::{Contribution, ErrorBudget};

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

/// Returns the spectrum at the hub and at the tip, and that of the tip against the hub; a place where nothing moves is left out.
pub fn error_budget_figures(budget: &ErrorBudget) -> Vec<Figure> {
    let moves = |place: &Place| (place.of)(&budget.total).iter().sum::<f64>() > 0.0;
    PLACES.into_iter().filter(moves).map(|place| figure(budget, place)).collect()
}

fn figure(budget: &ErrorBudget, place: Place) -> Figure {
    let largest = largest(budget, place);
    let linear = budget.linear_spectrum();
    let density = |bands: &[f64]| density(budget, bands);
    let total = (place.of)(&budget.total);
    let mut powers = vec![Series::solid_line("all sources", Colour::Muted, density(total))];
    let mut roots = vec![Series::solid_line("all sources", Colour::Muted, cumulative(budget, total))];
    let mut shares = Vec::new();
    for (one, colour) in largest.iter().zip(Colour::CYCLE) {
        let share = (place.of)(&one.share);
        powers.push(Series::solid_line(one.source.name(), colour, density(share)));
        shares.push(Series::solid_line("", colour, part(budget, share, total)));
        if let Some(linear) = &one.linear {
            let name = format!("{}, linear loop", one.source.name());
            powers.push(Series::dotted_line(&name, colour, density((place.of)(&linear.spectrum))));
        }
    }
    roots.push(Series::dotted_line("linear loop", Colour::Muted, cumulative(budget, (place.of)(&linear))));
    let panels = vec![
        Panel::new(Axis::logarithmic("power spectrum", "urad\u{B2}/Hz"), powers).with_height(260.0),
        Panel::new(Axis::linear("cumulative RMS", "urad"), roots).with_height(150.0),
        Panel::new(Axis::linear("cumulative share", "%"), shares).with_height(150.0),
    ];
    Figure::new(
        &format!("Spectrum of the line of sight, {}", place.name),
        Axis::logarithmic("frequency", "Hz"),
        panels,
    )
    .with_caption(
        "Shares of the sources that move it most. The cumulative share is that of the mean square of the whole run; it is negative for a source that reduces \
         the error of the others.",
    )
}

/// Returns the sources with the largest shares, at most as many as there are colours.
fn largest(budget: &ErrorBudget, place: Place) -> Vec<&Contribution> {
    let size = |one: &Contribution| (place.of)(&one.share).iter().sum::<f64>().abs();
    let mut all: Vec<&Contribution> = budget.contributions.iter().filter(|one| size(one) > 0.0).collect();
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    all.truncate(Colour::CYCLE.len());
    all
}

fn density(budget: &ErrorBudget, bands: &[f64]) -> Vec<(f64, f64)> {
    budget.densities(bands).into_iter().map(|[hz, density]| (hz, MICRO * MICRO * density)).collect()
}

fn cumulative(budget: &ErrorBudget, bands: &[f64]) -> Vec<(f64, f64)> {
    budget.cumulative_rms(bands).into_iter().map(|[hz, rms]| (hz, MICRO * rms)).collect()
}

fn part(budget: &ErrorBudget, share: &[f64], total: &[f64]) -> Vec<(f64, f64)> {
    budget.cumulative_share(share, total).into_iter().map(|[hz, share]| (hz, 100.0 * share)).collect()
}
