//! A design beside its alternatives, as a result file has it.

use counterpoise_pipeline::studies::comparison::{
    BalanceBasis, DesignComparison, LoweredRow, MethodRow, MotionRow, Spillover, TotalCostResult,
};
use counterpoise_pipeline::studies::tuned_pi::TunedPiRow;
use counterpoise_pipeline::synth::schedule::BalanceRow;
use serde::Serialize;

use crate::wording::certificates::describe_cost_source;
use crate::wording::design_findings::describe_design_findings;
use crate::wording::schedule::{describe_conditions, describe_law};

/// A design compared with its alternatives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonText {
    /// The feedback as built, and further methods.
    pub methods: Vec<MethodRow<String>>,
    /// Cost of a lower order of the feedback.
    pub lowered: Option<LoweredRow>,
    /// Hub and tip under each expected disturbance.
    pub motions: Vec<MotionRow>,
    /// States of balance.
    pub balance: Vec<BalanceRow<String, String>>,
    /// Data from which they are computed, row by row.
    pub balance_basis: Vec<BalanceBasis>,
    /// The loop on the structure with the modes that the design does not know.
    pub spillover: Option<Spillover>,
    /// Cost of the assembled loop, all parts acting together; absent if another method made the feedback.
    pub total_cost: Option<TotalCostResult<String>>,
    /// A PI with a lag, tuned under the design's own limits; absent if the weights were chosen or tuned.
    pub tuned_pi: Option<TunedPiRow>,
}

impl From<&DesignComparison> for ComparisonText {
    fn from(found: &DesignComparison) -> Self {
        let method = |row: &MethodRow| row.map_reason(describe_design_findings);
        let balance = |row: &BalanceRow| {
            row.with_sentences(describe_conditions(&row.conditions), describe_law(&row.law))
        };
        Self {
            methods: found.methods.iter().map(method).collect(),
            lowered: found.lowered.clone(),
            motions: found.motions.clone(),
            balance: found.balance.iter().map(balance).collect(),
            balance_basis: found.balance_basis.clone(),
            spillover: found.spillover.clone(),
            tuned_pi: found.tuned_pi.clone(),
            total_cost: found.total_cost.as_ref().map(|cost| cost.name_parts(describe_cost_source)),
        }
    }
}
