//! Recorded and simulated channels as charts.

use std::f64::consts::TAU;
use std::sync::Arc;

use counterpoise_pipeline::recordings::amplitude_density::AmplitudeDensity;
use counterpoise_recordings::Channel;

use crate::charts::chart::{AxisScale, Chart, ChartCurve, LineDash};
use crate::charts::curve_points::CurvePoints;
use crate::charts::min_max_pyramid::MinMaxPyramid;
use crate::jobs::recording_views::{ChannelView, SimulatedView};
use crate::units::DisplayUnit;
use crate::view::StudioView;

/// Returns an empty chart of a channel, whose title says how well the model fits.
fn channel_chart(view: &StudioView, channel: &ChannelView) -> (Chart, DisplayUnit) {
    let name = channel_words(channel.channel);
    let mut title = name.clone();
    if let Some(ratio) = channel.model.as_ref().and_then(|model| model.residual_over_floor) {
        title = format!("{name}: residual {ratio:.2} x its noise floor");
        if let Some(ratio) = channel.improved.as_ref().and_then(|improved| improved.residual_over_floor) {
            title = format!("{title}, {ratio:.2} with the diagnosis");
        }
    }
    let unit = view.units.display_unit(channel.channel.unit());
    let label = format!("{name}, {}", unit.name);
    (Chart::new(&title, "time, s", &label).with_group("recording"), unit)
}

fn long_curve(
    view: &StudioView,
    name: &str,
    colour: usize,
    points: &Arc<MinMaxPyramid>,
    unit: &DisplayUnit,
) -> ChartCurve {
    let points = CurvePoints::Many(Arc::clone(points), unit.factor);
    ChartCurve { name: name.to_owned(), points, colour: view.theme.curves[colour], dash: LineDash::Solid }
}

/// Returns a channel as measured, as the model simulates it, and as the diagnosed model does.
pub fn signal_chart(view: &StudioView, channel: &ChannelView) -> Chart {
    let (mut chart, unit) = channel_chart(view, channel);
    chart = chart.with_any_curve(long_curve(view, "measured", 1, &channel.measured, &unit));
    if let Some(model) = &channel.model {
        chart = chart.with_any_curve(long_curve(view, "model", 0, &model.signal, &unit));
    }
    if let Some(improved) = &channel.improved {
        chart = chart.with_any_curve(long_curve(view, "with the diagnosis", 2, &improved.signal, &unit));
    }
    chart
}

/// Returns the residuals of the model and of the diagnosed model.
pub fn residual_chart(view: &StudioView, channel: &ChannelView) -> Chart {
    let (mut chart, unit) = channel_chart(view, channel);
    if let Some(model) = &channel.model {
        chart = chart.with_any_curve(long_curve(view, "model", 0, &model.residual, &unit));
    }
    if let Some(improved) = &channel.improved {
        chart = chart.with_any_curve(long_curve(view, "with the diagnosis", 2, &improved.residual, &unit));
    }
    chart
}

/// Returns the amplitude spectral densities of a channel as measured, and of what the model and the diagnosed model leave of it.
pub fn density_chart(view: &StudioView, channel: &ChannelView) -> Chart {
    let (titled, unit) = channel_chart(view, channel);
    let name = channel_words(channel.channel);
    let label = format!("{name}, {}/root Hz", unit.name);
    let mut chart = Chart::new(&titled.title, view.units.frequency_label(), &label).with_group("spectra");
    chart.scales = [AxisScale::Log; 2];
    fn residual(simulated: Option<&SimulatedView>) -> Option<&AmplitudeDensity> {
        simulated?.residual_density.as_ref()
    }
    let curves = [
        ("measured", 1, channel.density.as_ref()),
        ("residual of the model", 0, residual(channel.model.as_ref())),
        ("residual with the diagnosis", 2, residual(channel.improved.as_ref())),
    ];
    for (name, colour, density) in curves {
        let Some(AmplitudeDensity { frequency_hz, density }) = density else { continue };
        let shown = |(hz, value): (&f64, &f64)| [view.units.display_frequency(TAU * hz), unit.factor * value];
        let points = frequency_hz.iter().zip(density).filter(|(_, value)| **value > 0.0).map(shown).collect();
        chart = chart.with_curve(name, view.theme.curves[colour], LineDash::Solid, points);
    }
    chart
}

/// Returns a channel's name in words.
pub fn channel_words(channel: Channel) -> String {
    channel.name().replace('_', " ")
}
