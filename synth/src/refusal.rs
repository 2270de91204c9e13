//! Why a well-posed problem has no solution, and how a caller separates that from bad input.

use std::fmt;

use crate::Error;
use crate::finding::Finding;

/// The reasons why a well-posed problem has no solution: at least one finding that refuses it.
///
/// It travels as [`Error::Refused`], so that `?` passes it on; [`attempt`] separates it from the other errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Every finding, refusals first.
    pub findings: Vec<Finding>,
}

/// Returns the solution or, if the problem has none, the refusal.
///
/// # Errors
/// Every error that is not a refusal.
pub fn attempt<T>(answer: Result<T, Error>) -> Result<Result<T, Refusal>, Error> {
    match answer {
        Ok(solution) => Ok(Ok(solution)),
        Err(Error::Refused(refusal)) => Ok(Err(refusal)),
        Err(other) => Err(other),
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.findings.iter().map(ToString::to_string).collect();
        f.write_str(&lines.join("; "))
    }
}
