//! The numbers of a chart as CSV.

use std::fmt::Write;

use super::chart::Chart;

/// Returns the numbers of a chart, one point a line: curve, x, y, under the labels of the axes.
pub fn chart_csv(chart: &Chart) -> String {
    let [x, y] = chart.labels.each_ref().map(|label| csv_cell(label));
    let mut out = format!("curve,{x},{y}\n");
    for curve in &chart.curves {
        let name = csv_cell(if curve.name.is_empty() { &chart.title } else { &curve.name });
        for [x, y] in curve.points.all().iter() {
            let _ = writeln!(out, "{name},{x:e},{y:e}");
        }
    }
    out
}

fn csv_cell(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
