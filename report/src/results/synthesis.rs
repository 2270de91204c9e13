//! What is read of a project, its reduced plant and its controller, as a result file has them.

use counterpoise_pipeline::check::CheckResult;
use counterpoise_pipeline::exchange::SCHEMA;
use counterpoise_pipeline::results::{CostResult, ReduceResult, SynthFigures, SynthResult, SynthSystems};
use serde::Serialize;

use crate::wording::certificates::describe_costed_part;
use crate::wording::check::describe_check_problem;
use crate::wording::demanded_rate::describe_demanded_rate;
use crate::wording::design_findings::describe_design_finding;
use crate::wording::reduction::describe_reduction_warning;

/// Describes what is in the way of a check.
pub fn describe_check(found: CheckResult) -> CheckResult<String> {
    found.map_problems(describe_check_problem)
}

/// Describes what a user should know about a reduction.
pub fn describe_reduction(found: ReduceResult) -> ReduceResult<String> {
    found.map_warnings(describe_reduction_warning)
}

/// The design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SynthText {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Its figures.
    #[serde(flatten)]
    pub figures: SynthFigures,
    /// The costs of the parts.
    pub costs: Vec<CostResult<String>>,
    /// The largest rate that a loop of position demands, and why; absent for a loop of rate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub demanded_rate: Option<String>,
    /// The notes for the designer.
    pub warnings: Vec<String>,
    /// Its systems.
    #[serde(flatten)]
    pub systems: SynthSystems,
}

impl From<SynthResult> for SynthText {
    fn from(found: SynthResult) -> Self {
        let cost = |cost: &CostResult| CostResult {
            part: describe_costed_part(cost.part),
            predicted: cost.predicted,
            achieved: cost.achieved,
        };
        Self {
            schema: SCHEMA,
            figures: found.figures,
            costs: found.costs.iter().map(cost).collect(),
            demanded_rate: found.demanded_rate.as_ref().map(describe_demanded_rate),
            warnings: found.warnings.iter().map(describe_design_finding).collect(),
            systems: found.systems,
        }
    }
}
