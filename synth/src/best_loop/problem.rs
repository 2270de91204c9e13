//! Why there is no best linear feedback.

/// Why there is no best linear feedback.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BestLoopProblem {
    /// The bound is one over stable feedbacks of a stable plant.
    #[error("the plant is not stable without feedback, and the bound needs a stable one")]
    UnstablePlant,
    /// The convex program is not well formed.
    #[error("the program could not be set up")]
    Malformed,
    /// The limits contradict each other.
    #[error("no linear feedback keeps these limits")]
    Infeasible,
    /// The solver did not converge.
    #[error("the solver gave up")]
    NotConverged,
    /// There was no round of the grid's refinement.
    #[error("no program was solved")]
    NothingSolved,
}
