//! The spectrum of the line of sight as figures: its power spectral density and its cumulative RMS, with the shares of its sources.

use counterpoise_pipeline::sight_views::{SightView, SpectrumPoints};
use counterpoise_plot::{Axis, Colour, Figure, Panel, Series};

/// Returns the figure of a place, with as many sources as there are colours.
pub fn sight_figure(view: &SightView) -> Figure {
    let mut powers = vec![Series::solid_line("all sources", Colour::Muted, pairs(&view.density))];
    let roots = vec![
        Series::solid_line("all sources", Colour::Muted, pairs(&view.cumulative_rms)),
        Series::dotted_line("linear loop", Colour::Muted, pairs(&view.linear_cumulative_rms)),
    ];
    let mut shares = Vec::new();
    for (one, colour) in view.sources.iter().zip(Colour::CYCLE) {
        powers.push(Series::solid_line(one.name, colour, pairs(&one.density)));
        shares.push(Series::solid_line("", colour, pairs(&one.cumulative_share)));
        if let Some(linear) = &one.linear_density {
            powers.push(Series::dotted_line(&format!("{}, linear loop", one.name), colour, pairs(linear)));
        }
    }
    let panels = vec![
        Panel::new(Axis::logarithmic("power spectrum", "urad\u{B2}/Hz"), powers).with_height(260.0),
        Panel::new(Axis::linear("cumulative RMS", "urad"), roots).with_height(150.0),
        Panel::new(Axis::linear("cumulative share", "%"), shares).with_height(150.0),
    ];
    Figure::new(
        &format!("Spectrum of the line of sight, {}", view.place),
        Axis::logarithmic("frequency", "Hz"),
        panels,
    )
    .with_caption(
        "Shares of the sources that move it most. The cumulative share is that of the mean square of the whole run; it is negative for a source that reduces \
         the error of the others.",
    )
}

fn pairs(points: &SpectrumPoints) -> impl Iterator<Item = (f64, f64)> + '_ {
    points.iter().map(|[hz, value]| (*hz, *value))
}
