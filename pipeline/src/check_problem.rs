//! The problems that prevent a check.

use crate::PipelineError;

/// A problem that prevents a check.
#[derive(Debug)]
pub enum CheckProblem {
    /// The plant cannot be built.
    NoPlant {
        /// Why.
        cause: PipelineError,
    },
    /// Assumptions are not ranked, because there is no design.
    NoDesign {
        /// Why.
        cause: PipelineError,
    },
}
