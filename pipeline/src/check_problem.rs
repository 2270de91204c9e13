//! What can be in the way of a check.

/// What is in the way of a check.
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
