//! Why a well-posed problem has no solution.

use std::fmt;

use crate::finding::DesignFinding;

/// The reasons why a well-posed problem has no solution: at least one finding that refuses it.
///
/// It travels as [`Error::Refused`](crate::Error::Refused), so that `?` passes it on; [`attempt`](crate::attempt) separates it from the other
/// errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Every finding, refusals first.
    pub findings: Vec<DesignFinding>,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.findings.iter().map(ToString::to_string).collect();
        f.write_str(&lines.join("; "))
    }
}
