//! The complete result of a design: with both axes together, the error budget, and what the assumptions matter.

use counterpoise_pool::Pool;
use counterpoise_project::{Assumption, Project};

use super::{DesignResult, TwoAxesResult};
use crate::exchange::error_budget_result;
use crate::studies::advice::KeptDesigns;
use crate::studies::assumptions::{LoopSystems, effects_on_design, with_those_of_design};
use crate::{CompletedDesign, PipelineError};

/// Parts of a complete result beside the design.
#[derive(Debug, Clone, Copy)]
pub struct ResultContents<'a> {
    /// The values that the project does not state.
    pub assumptions: &'a [Assumption],
    /// The treatment of the systems from which the effects of the assumptions can be recomputed.
    pub systems: LoopSystems,
    /// The treatment of the time histories, those of the error budget's runs among them.
    pub kept: KeptDesigns,
}

impl DesignResult {
    /// Returns everything that is stated about a design of the project: the result of the design itself, both axes together, the error
    /// budget, the assumptions, and how much each of them matters.
    ///
    /// # Errors
    /// Those of the traverse axis' linear loop, and those of the simulator if the histories are kept.
    pub fn complete(
        project: &Project,
        designed: &CompletedDesign,
        contents: &ResultContents<'_>,
        pool: &dyn Pool,
    ) -> Result<Self, PipelineError> {
        let stages = &designed.stages;
        let mut result = Self::from(designed);
        let both = designed.two_axes.as_ref().map(TwoAxesResult::new).transpose()?;
        result.verify = result.verify.with_two_axes(both);
        match contents.kept {
            KeptDesigns::Histories => {
                let (verified, plant) = (&stages.verified, &stages.modelled.plant);
                let (found, controller) = (verified.verification(), verified.controller());
                result.verify.studies.error_budget =
                    error_budget_result(found, plant, controller, contents.kept)?;
            }
            KeptDesigns::Systems => result.leave_histories_out(),
        }
        let ranked = effects_on_design(project, stages, contents.assumptions, contents.systems, pool);
        result.model.assumptions = with_those_of_design(contents.assumptions, &stages.synthesised);
        (result.model.assumption_effects, result.model.assumed_loop) = (ranked.effects, ranked.assumed_loop);
        Ok(result)
    }
}
