//! The figures of a report as tables: what is drawn, point by point.

use counterpoise_plot::{Content, Figure, HeatMap, Mark, Panel, Panels};

use crate::page::Report;

/// The numbers of a panel or of a heat map.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureTable {
    /// Title of the figure; with several panels followed by the label of the panel's axis.
    pub title: String,
    /// Names of the columns: `curve`, then the labels of the axes with their units.
    pub columns: Vec<String>,
    /// The points.
    pub rows: Vec<FigureRow>,
}

/// A row of a [`FigureTable`].
#[derive(Debug, Clone, PartialEq)]
pub struct FigureRow {
    /// Name of the curve, edge or mark; that of the row in a heat map.
    pub curve: String,
    /// Values of the other columns; one that is not finite breaks the curve.
    pub values: Vec<f64>,
}

/// Returns the tables of every figure of a report, in reading order.
pub fn figure_tables(report: &Report) -> Vec<FigureTable> {
    let evidence = report.sections.iter().flat_map(|section| &section.figures);
    report.glance.iter().chain(evidence).flat_map(tables_of).collect()
}

fn tables_of(figure: &Figure) -> Vec<FigureTable> {
    match &figure.content {
        Content::Panels(panels) => {
            panels.panels.iter().map(|panel| panel_table(&figure.title, panels, panel)).collect()
        }
        Content::HeatMap(map) => vec![heat_table(&figure.title, map)],
    }
}

fn panel_table(title: &str, panels: &Panels, panel: &Panel) -> FigureTable {
    let row = |curve: &str, x: f64, y: f64| FigureRow { curve: curve.to_owned(), values: vec![x, y] };
    let mut rows = Vec::new();
    for series in &panel.series {
        rows.extend(series.points.outer_iter().map(|point| row(&series.name, point[0], point[1])));
    }
    for band in &panel.bands {
        for (edge, column) in [("lower edge", 1), ("upper edge", 2)] {
            let name = if band.name.is_empty() { edge.to_owned() } else { format!("{}, {edge}", band.name) };
            rows.extend(band.points.outer_iter().map(|point| row(&name, point[0], point[column])));
        }
    }
    for mark in &panel.marks {
        rows.push(match mark {
            Mark::Point { x, y, text, .. } | Mark::Cross { x, y, text, .. } => row(text, *x, *y),
            Mark::Level { y, text } => row(text, f64::NAN, *y),
            Mark::Instant { x, text } => row(text, *x, f64::NAN),
        });
    }
    let title =
        if panels.panels.len() == 1 { title.to_owned() } else { format!("{title} {}", panel.y.label) };
    FigureTable { title, columns: vec!["curve".to_owned(), panels.x.text(), panel.y.text()], rows }
}

fn heat_table(title: &str, map: &HeatMap) -> FigureTable {
    let row =
        |(k, name): (usize, &String)| FigureRow { curve: name.clone(), values: map.shares.row(k).to_vec() };
    let names: Vec<String> = map.rows.iter().map(|row| row.name.clone()).collect();
    FigureTable {
        title: title.to_owned(),
        columns: std::iter::once(map.heading.clone()).chain(map.columns.iter().cloned()).collect(),
        rows: names.iter().enumerate().map(row).collect(),
    }
}
