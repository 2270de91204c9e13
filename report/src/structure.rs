//! The report of a structure's diagnosis: measured frequencies beside those of every model that was tried.

use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_pipeline::recordings::measured_modes::StructureAnswer;

use crate::wording::structure::{describe_fitted, describe_hypothesis, describe_structure};
use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};
use counterpoise_plot::{Axis, Colour, Figure, Panel, Series};

/// Hypotheses whose errors are drawn.
const DRAWN: usize = 2;

/// Returns the report.
pub fn structure_report(machine: &str, command: &str, answer: &StructureAnswer) -> Report {
    Report {
        title: format!("Structure of {machine}"),
        subtitle: "natural frequencies, measured and modelled".to_owned(),
        headline: Headline {
            tone: if answer.verdict == DiagnosisVerdict::Unknown {
                OutcomeTone::Bad
            } else {
                OutcomeTone::Neutral
            },
            text: describe_structure(answer),
            detail: answer
                .alternatives
                .iter()
                .map(|a| format!("Cannot be distinguished from {}. ", describe_hypothesis(*a)))
                .collect(),
        },
        tiles: answer.tried.iter().take(1 + DRAWN).map(tile).collect(),
        verdicts: frequencies(answer),
        glance: vec![errors(answer, command)],
        sections: vec![
            ReportSection::new("What was tried").with_text(EXPLAINED).with_table(hypothesis_table(answer)),
        ],
        provenance: vec![
            ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION")),
            ProvenanceEntry::new("command", command),
        ],
    }
}

const EXPLAINED: &str = "Each was fitted to all modes but one and judged on that one, mode after mode; the last column is the RMS of those errors.";

fn tile(tried: &counterpoise_pipeline::recordings::structure_hypotheses::TriedStructure) -> FigureTile {
    FigureTile::plain(&describe_hypothesis(tried.hypothesis), format!("{:.2}", tried.left_out_percent), "%")
        .with_note("RMS error of held-out modes")
}

fn errors(answer: &StructureAnswer, command: &str) -> Figure {
    let points = |errors: &[f64]| -> Vec<(f64, f64)> {
        errors.iter().enumerate().map(|(k, off)| (k as f64 + 1.0, *off)).collect()
    };
    let colours = [Colour::Second, Colour::First, Colour::Muted];
    let series = answer.tried.iter().take(1 + DRAWN).zip(colours);
    let series = series
        .map(|(t, colour)| {
            Series::solid_line(&describe_hypothesis(t.hypothesis), colour, points(&t.errors_percent))
        })
        .collect();
    let panel = Panel::new(Axis::linear("error of the frequency", "%"), series).with_height(260.0);
    let figure = Figure::new("Error by mode", Axis::linear("mode", ""), vec![panel]);
    Figure { command: command.to_owned(), ..figure }
}

fn frequencies(answer: &StructureAnswer) -> ReportTable {
    let columns = [
        ReportColumn::Number("mode"),
        ReportColumn::Number("measured [Hz]"),
        ReportColumn::Number("model [Hz]"),
        ReportColumn::Number("error [%]"),
        ReportColumn::Number("improved [Hz]"),
        ReportColumn::Number("error [%]"),
    ];
    let mut table = ReportTable::new("Natural frequencies", &columns);
    let best = answer.tried.get(1).unwrap_or(&answer.tried[0]);
    let errors = [&answer.model_errors_percent, &best.errors_percent];
    for (k, measured) in answer.measured_hz.iter().enumerate() {
        let (model, improved) = (answer.model_hz[k], best.modes_hz[k]);
        let error = |errors: &[f64]| ReportCell::text(format!("{:+.2}", errors[k]));
        table.rows.push(vec![
            ReportCell::text((k + 1).to_string()),
            ReportCell::number(*measured),
            ReportCell::number(model),
            error(errors[0]),
            ReportCell::number(improved),
            error(errors[1]),
        ]);
    }
    table
}

fn hypothesis_table(answer: &StructureAnswer) -> ReportTable {
    let columns = [
        ReportColumn::Text("hypothesis"),
        ReportColumn::Text("fitted"),
        ReportColumn::Number("RMS error [%]"),
        ReportColumn::Number("held out [%]"),
    ];
    let mut table = ReportTable::new("Hypotheses, best first below the model as it is", &columns);
    for t in &answer.tried {
        let numbers: Vec<String> = t.parameters.iter().map(describe_fitted).collect();
        table.rows.push(vec![
            ReportCell::text(describe_hypothesis(t.hypothesis)),
            ReportCell::text(numbers.join(", ")),
            ReportCell::text(format!("{:.2}", t.rms_percent)),
            ReportCell::text(format!("{:.2}", t.left_out_percent)),
        ]);
    }
    table
}
