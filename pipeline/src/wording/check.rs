//! The problem that prevents a check, in words. The JSON result carries them.

use crate::check_problem::CheckProblem;

/// Describes what is in the way of a check.
pub fn describe_check_problem(problem: &CheckProblem) -> String {
    match problem {
        CheckProblem::NoPlant { cause } => format!("the plant cannot be built: {cause}"),
        CheckProblem::NoDesign { cause } => {
            format!("assumptions are not ranked, because there is no design: {cause}")
        }
    }
}
