//! Why a job has no result, one reason a line.

use counterpoise_pipeline::PipelineError;
use counterpoise_report::wording::design_findings::describe_design_finding;
use counterpoise_report::wording::errors::describe_pipeline_error;

/// Reasons why there is no result, one a line.
pub type ErrorLines = Vec<String>;

/// Returns every reason in an error, one a line.
pub fn error_lines(error: &PipelineError) -> ErrorLines {
    match error {
        PipelineError::NoController(findings) => findings.iter().map(describe_design_finding).collect(),
        other => vec![describe_pipeline_error(other)],
    }
}
