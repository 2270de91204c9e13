//! A chart as an SVG drawing of its own: for papers and mails.

use std::fmt::Write;

use crate::chart::{Chart, Dash, Scale};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 400.0;
/// Left, top, right, bottom.
const MARGIN: [f64; 4] = [70.0, 44.0, 20.0, 50.0];
/// Colours on white, told apart without red and green.
const COLOURS: [&str; 4] = ["#0b6bcb", "#c7660a", "#128a6b", "#7a4fc4"];

/// The drawing.
pub fn drawing(chart: &Chart) -> String {
    let (x, y) = (range(chart, 0), range(chart, 1));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n"
    );
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"18\" font-weight=\"bold\">{}</text>",
        MARGIN[0],
        escaped(&chart.title)
    );
    axes(&mut out, chart, x, y);
    for (k, curve) in chart.curves.iter().enumerate() {
        let seen = (chart.unplace(0, x.0), chart.unplace(0, x.1));
        let shown = curve.points.shown(seen, WIDTH as usize);
        let points: Vec<String> = shown
            .iter()
            .map(|p| [chart.place(0, p[0]), chart.place(1, p[1])])
            .filter(|p| p[0].is_finite() && p[1].is_finite() && (x.0..=x.1).contains(&p[0]))
            .map(|p| format!("{:.1},{:.1}", across(p[0], x), down(p[1].clamp(y.0, y.1), y)))
            .collect();
        let dash = match curve.dash {
            Dash::Solid => "",
            Dash::Dashed => " stroke-dasharray=\"7 4\"",
            Dash::Dotted => " stroke-dasharray=\"2 3\"",
        };
        let colour = COLOURS[k % COLOURS.len()];
        let _ = writeln!(
            out,
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"{dash} points=\"{}\"/>",
            points.join(" ")
        );
        let at = MARGIN[0] + 130.0 * k as f64;
        let _ = writeln!(
            out,
            "<line x1=\"{at}\" x2=\"{}\" y1=\"32\" y2=\"32\" stroke=\"{colour}\" stroke-width=\"2\"{dash}/><text x=\"{}\" y=\"36\">{}</text>",
            at + 18.0,
            at + 23.0,
            escaped(&curve.name)
        );
    }
    out.push_str("</svg>\n");
    out
}

fn axes(out: &mut String, chart: &Chart, x: (f64, f64), y: (f64, f64)) {
    let (right, bottom) = (WIDTH - MARGIN[2], HEIGHT - MARGIN[3]);
    for value in ticks(x) {
        let at = across(value, x);
        let text = label(value, chart.scales[0]);
        let _ = writeln!(
            out,
            "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{}\" y2=\"{bottom}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
            MARGIN[1],
            bottom + 16.0
        );
    }
    for value in ticks(y) {
        let at = down(value, y);
        let text = label(value, chart.scales[1]);
        let _ = writeln!(
            out,
            "<line x1=\"{}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            MARGIN[0],
            MARGIN[0] - 6.0,
            at + 4.0
        );
    }
    let middle = 0.5 * (MARGIN[1] + bottom);
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
        0.5 * (MARGIN[0] + right),
        HEIGHT - 12.0,
        escaped(&chart.labels[0])
    );
    let _ = writeln!(
        out,
        "<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escaped(&chart.labels[1])
    );
}

fn range(chart: &Chart, axis: usize) -> (f64, f64) {
    if let Some((low, high)) = chart.range[axis] {
        return (chart.place(axis, low), chart.place(axis, high));
    }
    let values = chart
        .curves
        .iter()
        .flat_map(|c| c.points.all().into_owned())
        .map(|p| chart.place(axis, p[axis]))
        .filter(|v| v.is_finite());
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low < high { (low, high) } else { (-1.0, 1.0) }
}

fn across(value: f64, (low, high): (f64, f64)) -> f64 {
    MARGIN[0] + (value - low) / (high - low) * (WIDTH - MARGIN[0] - MARGIN[2])
}

fn down(value: f64, (low, high): (f64, f64)) -> f64 {
    HEIGHT - MARGIN[3] - (value - low) / (high - low) * (HEIGHT - MARGIN[1] - MARGIN[3])
}

/// Round numbers, about six of them.
fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let raw = (high - low) / 6.0;
    let decade = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * decade).find(|s| *s >= raw).unwrap_or(raw);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

fn label(value: f64, scale: Scale) -> String {
    if scale == Scale::Log {
        let power = 10f64.powf(value);
        return if (1e-3..1e5).contains(&power) {
            format!("{power:.3}").trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            format!("{power:.0e}")
        };
    }
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
