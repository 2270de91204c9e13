//! The complete result of a design: with both axes together, the error budget, and what the assumptions matter.

use super::{DesignResult, TwoAxesResult};
use crate::CompletedDesign;
use crate::studies::advice::KeptDesigns;

impl DesignResult {
    /// Returns everything that is stated about a design: the result of the design itself, both axes together, the error budget, the
    /// assumptions, and how much each of them matters.
    pub fn complete(designed: &CompletedDesign) -> Self {
        let mut result = Self::from(designed);
        result.verify = result.verify.with_two_axes(designed.two_axes.as_ref().map(TwoAxesResult::from));
        match designed.kept {
            KeptDesigns::Histories => {
                result.verify.studies.error_budget.clone_from(&designed.error_budget);
            }
            KeptDesigns::Systems => result.leave_histories_out(),
        }
        let ranked = &designed.assumption_effects;
        result.model.assumptions.clone_from(&designed.assumptions);
        result.model.assumption_effects.clone_from(&ranked.effects);
        result.model.assumed_loop.clone_from(&ranked.assumed_loop);
        result
    }
}
