//! The problem that prevents a check, in words.

use counterpoise_pipeline::check_problem::CheckProblem;

use super::errors::describe_pipeline_error;

/// Describes what is in the way of a check.
pub fn describe_check_problem(problem: &CheckProblem) -> String {
    match problem {
        CheckProblem::NoPlant { cause } => {
            format!("the plant cannot be built: {}", describe_pipeline_error(cause))
        }
        CheckProblem::NoDesign { cause } => {
            let cause = describe_pipeline_error(cause);
            format!("there is no design, so that assumptions are not ranked: {cause}")
        }
    }
}
