//! The problems that prevent a check.

/// A problem that prevents a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CheckProblem {
    /// The plant cannot be built.
    NoPlant {
        /// Why, in the words of the error.
        cause: String,
    },
    /// Assumptions are not ranked, because there is no design.
    NoDesign {
        /// Why, in the words of the error.
        cause: String,
    },
}
