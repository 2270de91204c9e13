//! The section on free functions: each curve with its band, and the recordings' coverage under it.

use counterpoise_plot::{Axis, Band, Colour, Figure, Panel, Series};

use counterpoise_diagnose::learning::reading::ReadElement;

use crate::wording::learned::{LearnedFunctionText, LearnedText, describe_elements};
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};

/// Returns the section on the free functions that model an unidentified effect.
pub(super) fn learned_section(learned: &LearnedText) -> ReportSection {
    functions_section("A model of the unidentified effect", &learned.functions)
        .with_text(learned.summary.clone())
}

/// Returns the section on the free functions of a plant; `None` if it has none.
pub(super) fn elements_section(elements: &[ReadElement]) -> Option<ReportSection> {
    let functions = describe_elements(elements);
    (!functions.is_empty()).then(|| functions_section("Free functions of the plant", &functions))
}

fn functions_section(title: &str, functions: &[LearnedFunctionText]) -> ReportSection {
    let columns = [
        ReportColumn::Text("place"),
        ReportColumn::Text("quantity"),
        ReportColumn::Text("over"),
        ReportColumn::Text("reading"),
        ReportColumn::Text("range"),
    ];
    let mut table = ReportTable::new("Free functions in place of an unidentified effect", &columns);
    for function in functions {
        let texts =
            [function.place, function.quantity, function.variable, &function.reading, &function.range];
        table.rows.push(texts.iter().map(|text| ReportCell::text(*text)).collect());
    }
    ReportSection::new(title).with_table(table).with_figures(functions.iter().map(curve))
}

/// Returns the curve of a function.
fn curve(function: &LearnedFunctionText) -> Figure {
    let pairs = |list: &[f64]| -> Vec<(f64, f64)> {
        function.points.iter().copied().zip(list.iter().copied()).collect()
    };
    let band: Vec<(f64, f64, f64)> = function
        .points
        .iter()
        .zip(&function.band)
        .filter(|_| !function.half_width.is_empty())
        .map(|(x, [low, high])| (*x, *low, *high))
        .collect();
    let unit = if function.value_unit.is_empty() { "1" } else { function.value_unit };
    let value = Panel::new(
        Axis::linear(function.quantity, unit),
        vec![Series::solid_line("fitted in the simulator", Colour::First, pairs(&function.values))],
    )
    .with_bands(vec![Band::new("95 %", Colour::First, band)])
    .with_height(190.0);
    let coverage = Panel::new(
        Axis::linear("share of samples", "1"),
        vec![Series::solid_line("recorded", Colour::Muted, pairs(&function.coverage))],
    )
    .with_height(80.0);
    let title = format!("{} at the {} over {}", function.quantity, function.place, function.variable);
    Figure::new(&title, Axis::linear(function.variable, function.variable_unit), vec![value, coverage])
}
