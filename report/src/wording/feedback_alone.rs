//! The loop with feedback alone in words: the lines about it in the header of the exported code.

use counterpoise_pipeline::PipelineError;
use counterpoise_verify::{Limit, PerformanceFigure, Verdict, Verification};

use super::errors::describe_pipeline_error;
use super::figures::{describe_figure, format_figure};

/// Describes why the loop could not be verified.
pub(crate) fn describe_uncertified(why: &PipelineError) -> String {
    format!("not certified: {}", describe_pipeline_error(why))
}

/// Describes the loop that was verified: its stability, its loop figures and its linear requirements, one a line.
pub(crate) fn describe_feedback_alone(found: &Verification) -> Vec<String> {
    let stable = found.evidence.margins.closed_loop_stable;
    let mut lines =
        vec![if stable { "the linear loop is stable" } else { "the linear loop is UNSTABLE" }.to_owned()];
    let of = found.controlled_quantity();
    let loops = found.figures.iter().map(|measured| measured.figure);
    let loops = loops.filter(|figure| matches!(figure, PerformanceFigure::Loop(_)));
    let said = loops.filter_map(|figure| Some((figure, found.value(figure)?)));
    lines.extend(said.map(|(figure, value)| {
        format!("{}: {} {}", describe_figure(figure, of), format_figure(value), figure.unit(of))
    }));
    lines.extend(found.verdicts.iter().filter_map(|(requirement, verdict)| {
        let asked = |limit: &Limit| match limit {
            Limit::AtLeast(value) => format!("at least {value}"),
            Limit::AtMost(value) => format!("at most {value}"),
        };
        let (figure, unit) = (describe_figure(requirement.figure, of), requirement.figure.unit(of));
        let said = |value: f64, limit: &Limit, word: &str| {
            format!("requirement {figure}: {} {unit} ({}): {word}", format_figure(value), asked(limit))
        };
        match verdict {
            Verdict::Holds { value, limit, .. } => Some(said(*value, limit, "holds")),
            Verdict::Fails { value, limit, .. } => Some(said(*value, limit, "FAILS")),
            Verdict::NotApplicable { .. } => None,
        }
    }));
    lines
}
