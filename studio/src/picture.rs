//! A chart as a picture of its own, for papers and mails: drawn by the same crate as the figures of reports, on white.

use counterpoise_plot::{
    Axis, Bitmap, Colour, Dash as Dashes, Figure, Mark, Panel, PlotError, Series, Theme, bitmap, svg,
};
use egui::Color32;

use crate::chart::{Chart, Curve, Dash, Scale};
use crate::theme::{DARK, LIGHT};

/// Height of the plotting area, pixels.
const HEIGHT: f64 = 330.0;
/// Pixels of a copied bitmap for each pixel of the picture: enough to be printed.
const SCALE: f64 = 2.0;

/// Returns the chart as an SVG document.
pub fn drawing(chart: &Chart) -> String {
    svg::standalone(&figure(chart), Theme::Light)
}

/// Returns the chart as pixels.
///
/// # Errors
/// Returns [`PlotError`] if the picture cannot be drawn.
pub fn pixels(chart: &Chart) -> Result<Bitmap, PlotError> {
    bitmap(&figure(chart), Theme::Light, SCALE)
}

/// Returns the chart as a figure.
pub fn figure(chart: &Chart) -> Figure {
    let series = chart.curves.iter().map(series).collect();
    let levels = chart.levels.iter().map(|y| Mark::Level { y: *y, text: String::new() });
    let instants = chart.marks.iter().map(|(x, text)| Mark::Instant { x: *x, text: text.clone() });
    let spots = chart.spots.iter().map(|([x, y], text)| Mark::Point {
        x: *x,
        y: *y,
        text: text.clone(),
        colour: Colour::First,
    });
    let marks = levels.chain(instants).chain(spots).collect();
    let panel = Panel::new(axis(chart, 1), series).with_height(HEIGHT).with_marks(marks);
    Figure::new(&chart.title, axis(chart, 0), vec![panel])
}

fn series(curve: &Curve) -> Series {
    let dash = match curve.dash {
        Dash::Solid => Dashes::Solid,
        Dash::Dashed => Dashes::Dashed,
        Dash::Dotted => Dashes::Dotted,
    };
    Series::new(&curve.name, (colour(curve.colour), dash), curve.points.all().iter().map(|p| (p[0], p[1])))
}

/// The colour of a picture that stands for one of the window's: curves keep their order, everything else stands back.
fn colour(of: Color32) -> Colour {
    let curves = [DARK, LIGHT].into_iter().find_map(|theme| theme.curves.iter().position(|c| *c == of));
    curves.and_then(|k| Colour::CYCLE.get(k).copied()).unwrap_or(Colour::Muted)
}

fn axis(chart: &Chart, axis: usize) -> Axis {
    let label = chart.labels[axis].as_str();
    let drawn = match chart.scales[axis] {
        Scale::Linear => Axis::linear(label, ""),
        Scale::Log => Axis::logarithmic(label, ""),
    };
    Axis { range: chart.range[axis], ..drawn }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_is_drawn_with_its_labels_curves_and_marks() {
        let points: Vec<[f64; 2]> = (1..500).map(|k| [f64::from(k), f64::from(k).recip()]).collect();
        let mut chart = Chart::new("Loop <gain>", "frequency, Hz", "modulus, dB")
            .curve("L", DARK.curves[0], Dash::Solid, points.clone())
            .curve("kept", DARK.weak, Dash::Dotted, points);
        chart.scales = [Scale::Log; 2];
        chart.marks.push((10.0, "first mode".to_owned()));
        chart.spots.push(([100.0, 0.01], "peak".to_owned()));
        let text = drawing(&chart);
        let words =
            ["Loop &lt;gain&gt;", "frequency, Hz", "modulus, dB", ">L<", ">kept<", ">first mode<", ">peak<"];
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
        assert!(text.starts_with("<svg") && !text.contains("class="));
        assert_eq!((colour(LIGHT.curves[3]), colour(LIGHT.text)), (Colour::Fourth, Colour::Muted));
        assert!(pixels(&chart).is_ok_and(|picture| picture.width == 1280));
    }
}
