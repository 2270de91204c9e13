//! Errors of the pipeline with what was found beside them, in words.

use std::error::Error;

use counterpoise_pipeline::PipelineError;
use counterpoise_synth::DesignFinding;

use super::design_findings::describe_design_finding;

/// Describes an error of the pipeline: its text, and every finding because of which there is no controller.
pub fn describe_pipeline_error(error: &PipelineError) -> String {
    match error {
        PipelineError::NoController(findings) => format!("{error}:\n{}", list_findings(findings)),
        PipelineError::ControllerUnstable { findings, .. } => format!(
            "{error}:\n{}\n  its input is the error, demand less reading, in the unit of what the loop controls (rad/s, rad, m/s, m, N m, N or A); its \
             output is in V, of which 10 command the drive's limit: look at its sign, its units and its sample time",
            list_findings(findings)
        ),
        _ => error.to_string(),
    }
}

/// Describes an error, or one of its causes; one of the pipeline with its findings.
pub fn describe_error(error: &(dyn Error + 'static)) -> String {
    error.downcast_ref::<PipelineError>().map_or_else(|| error.to_string(), describe_pipeline_error)
}

fn list_findings(findings: &[DesignFinding]) -> String {
    let lines: Vec<String> =
        findings.iter().map(|finding| format!("  - {}", describe_design_finding(finding))).collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_synth::{Cause, Part, SpecificationCause};

    fn findings() -> Vec<DesignFinding> {
        let cause = Cause::Specification(SpecificationCause::NothingDisturbs);
        vec![DesignFinding::refusal(Part::Feedback, cause)]
    }

    #[test]
    fn every_finding_stands_below_the_error() {
        let text = describe_error(&PipelineError::NoController(findings()));
        let (error, finding) = text.split_once('\n').unwrap_or_default();
        assert_eq!(error, "there is no controller for these weights:");
        assert!(finding.starts_with("  - feedback: nothing disturbs the loop"), "{text}");
    }

    #[test]
    fn a_controller_that_does_not_hold_the_loop_comes_with_what_to_look_at() {
        let error = PipelineError::ControllerUnstable { file: "pid.json".to_owned(), findings: findings() };
        let text = describe_pipeline_error(&error);
        assert!(
            text.starts_with("the controller in \"pid.json\" does not hold the loop:\n  - feedback"),
            "{text}"
        );
        assert!(text.ends_with("look at its sign, its units and its sample time"), "{text}");
    }
}
