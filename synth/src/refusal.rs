//! Why a well-posed problem has no solution.

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
