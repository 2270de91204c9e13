//! Remarks as sentences in result files: the results hold what was found, and its words are written when a result is serialised.

use counterpoise_reduce::Warning;
use counterpoise_synth::DesignFinding;
use serde::Serializer;

use super::check::describe_check_problem;
use super::demanded_rate::describe_demanded_rate;
use super::design_findings::describe_design_finding;
use super::reduction::describe_reduction_warning;
use crate::DemandedRate;
use crate::check_problem::CheckProblem;

/// Writes what a user should know about a reduction.
pub(crate) fn write_reduction_warnings<S: Serializer>(
    warnings: &[Warning],
    to: S,
) -> Result<S::Ok, S::Error> {
    to.collect_seq(warnings.iter().map(describe_reduction_warning))
}

/// Writes what a designer should know.
pub(crate) fn write_design_findings<S: Serializer>(
    findings: &[DesignFinding],
    to: S,
) -> Result<S::Ok, S::Error> {
    to.collect_seq(findings.iter().map(describe_design_finding))
}

/// Writes the largest demanded rate and why it is the largest.
pub(crate) fn write_demanded_rate<S: Serializer>(
    limit: &Option<DemandedRate>,
    to: S,
) -> Result<S::Ok, S::Error> {
    match limit {
        Some(limit) => to.serialize_str(&describe_demanded_rate(limit)),
        None => to.serialize_none(),
    }
}

/// Writes what is in the way of a check.
pub(crate) fn write_check_problems<S: Serializer>(
    problems: &[CheckProblem],
    to: S,
) -> Result<S::Ok, S::Error> {
    to.collect_seq(problems.iter().map(describe_check_problem))
}
