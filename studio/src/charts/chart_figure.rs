//! A chart as a picture of its own, on white, drawn by the same crate as the figures of reports.

use counterpoise_plot::{
    Axis, Bitmap, Colour, Dash, Figure, Mark, Panel, PlotError, Series, Theme, bitmap, png, svg,
};
use egui::Color32;

use super::chart::{AxisScale, Chart, ChartCurve, LineDash, PlotAxis};
use crate::theme::{DARK, LIGHT};

/// Height of the plotting area, pixels.
const HEIGHT: f64 = 330.0;
/// Pixels of a bitmap for each pixel of the picture: enough to be printed.
const SCALE: f64 = 2.0;

/// Returns the chart as an SVG document.
pub fn chart_svg(chart: &Chart) -> String {
    svg::standalone_svg(&chart_to_figure(chart), Theme::Light)
}

/// Returns the chart as pixels.
///
/// # Errors
/// Returns [`PlotError`] if the picture cannot be drawn.
pub fn chart_bitmap(chart: &Chart) -> Result<Bitmap, PlotError> {
    bitmap(&chart_to_figure(chart), Theme::Light, SCALE)
}

/// Returns the chart as a PNG file.
///
/// # Errors
/// Returns [`PlotError`] if the picture cannot be drawn.
pub fn chart_png(chart: &Chart) -> Result<Vec<u8>, PlotError> {
    png(&chart_to_figure(chart), Theme::Light, SCALE)
}

/// Returns the chart as a figure.
pub fn chart_to_figure(chart: &Chart) -> Figure {
    let series = chart.curves.iter().map(series).collect();
    let levels = chart.levels.iter().map(|y| Mark::Level { y: *y, text: String::new() });
    let instants = chart.marks.iter().map(|mark| Mark::Instant { x: mark.x, text: mark.label.clone() });
    let bounds = chart.bounds.iter().map(|bound| match bound.axis {
        PlotAxis::X => Mark::Instant { x: bound.at, text: bound.label.clone() },
        PlotAxis::Y => Mark::Level { y: bound.at, text: bound.label.clone() },
    });
    let spots = chart.spots.iter().map(|spot| Mark::Point {
        x: spot.at[0],
        y: spot.at[1],
        text: spot.label.clone(),
        colour: spot.colour.map_or(Colour::First, colour),
    });
    let marks = levels.chain(instants).chain(bounds).chain(spots).collect();
    let panel = Panel::new(axis(chart, PlotAxis::Y), series).with_height(HEIGHT).with_marks(marks);
    Figure::new(&chart.title, axis(chart, PlotAxis::X), vec![panel])
}

fn series(curve: &ChartCurve) -> Series {
    let dash = match curve.dash {
        LineDash::Solid => Dash::Solid,
        LineDash::Dashed => Dash::Dashed,
        LineDash::Dotted => Dash::Dotted,
    };
    let points = curve.points.all().iter().map(|p| (p[0], p[1])).collect::<Vec<_>>();
    Series::new(&curve.name, colour(curve.colour), dash, points)
}

/// Returns the colour of the picture for one of the window: curves keep their order, everything else is muted.
fn colour(of: Color32) -> Colour {
    let curves = [DARK, LIGHT].into_iter().find_map(|theme| theme.curves.iter().position(|c| *c == of));
    curves.and_then(|k| Colour::CYCLE.get(k).copied()).unwrap_or(Colour::Muted)
}

fn axis(chart: &Chart, axis: PlotAxis) -> Axis {
    let label = chart.labels[axis.index()].as_str();
    let drawn = match chart.scales[axis.index()] {
        AxisScale::Linear => Axis::linear(label, ""),
        AxisScale::Log => Axis::logarithmic(label, ""),
    };
    Axis { range: chart.range[axis.index()], ..drawn }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_is_drawn_with_its_labels_curves_and_marks() {
        let points: Vec<[f64; 2]> = (1..500).map(|k| [f64::from(k), f64::from(k).recip()]).collect();
        let mut chart = Chart::new("Loop <gain>", "frequency, Hz", "modulus, dB")
            .with_curve("L", DARK.curves[0], LineDash::Solid, points.clone())
            .with_curve("kept", DARK.weak, LineDash::Dotted, points);
        chart.scales = [AxisScale::Log; 2];
        chart.add_mark(10.0, "first mode");
        chart.spots.push(super::super::chart::LabelledPoint::new([100.0, 0.01], "peak"));
        let text = chart_svg(&chart);
        let words =
            ["Loop &lt;gain&gt;", "frequency, Hz", "modulus, dB", ">L<", ">kept<", ">first mode<", ">peak<"];
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
        assert!(text.starts_with("<svg") && !text.contains("class="));
        assert_eq!((colour(LIGHT.curves[3]), colour(LIGHT.text)), (Colour::Fourth, Colour::Muted));
        assert!(chart_bitmap(&chart).is_ok_and(|picture| picture.width == 1280));
    }
}
