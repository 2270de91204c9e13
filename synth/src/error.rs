//! The errors of a request to this crate, and how a caller separates a problem without a solution from bad input.

use crate::best_loop::problem::BestLoopProblem;
use crate::finding::DesignFinding;
use crate::refusal::Refusal;

/// Every way in which a request to this crate can fail: bad input, or a well-posed problem without a solution
/// ([`Error::Refused`]).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The problem is well posed but has no solution.
    #[error("the problem has no solution, for {} reasons: see `findings`", .0.findings.len())]
    Refused(Refusal),
    /// A system could not be built or evaluated.
    #[error(transparent)]
    Lti(#[from] counterpoise_lti::Error),
    /// A matrix equation was put wrongly.
    #[error(transparent)]
    Linalg(#[from] counterpoise_linalg::Error),
    /// The discrete controller could not be built.
    #[error(transparent)]
    Controller(#[from] counterpoise_controller::Error),
    /// A number outside what is allowed.
    #[error("{what} = {value} must be {allowed}")]
    Range {
        /// The number.
        what: &'static str,
        /// The value that was given.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// An index that names no input or output of the plant.
    #[error("{what} is number {index}, but the plant has {count}")]
    Index {
        /// The name of what is indexed.
        what: &'static str,
        /// The index that was given, from 0.
        index: usize,
        /// Number that there is.
        count: usize,
    },
    /// A weight that has no realisation of the kind that is asked for.
    #[error("weight {weight}: {problem}")]
    Weight {
        /// The weight as a formula.
        weight: String,
        /// The obstacle.
        problem: &'static str,
    },
    /// There is no best linear feedback.
    #[error("best linear feedback: {0}")]
    BestLoop(BestLoopProblem),
    /// A system whose kind does not fit its place.
    #[error("{what}: {problem}")]
    System {
        /// The system.
        what: &'static str,
        /// Description of the error.
        problem: &'static str,
    },
}

impl Error {
    /// Returns the refusal with these findings.
    pub(crate) fn refusal(findings: Vec<DesignFinding>) -> Self {
        Error::Refused(Refusal { findings })
    }

    /// Returns the findings of a refusal; no finding for any other error.
    pub fn findings(&self) -> &[DesignFinding] {
        match self {
            Error::Refused(refusal) => &refusal.findings,
            _ => &[],
        }
    }
}

/// Returns the solution or, if the problem has none, the refusal.
///
/// # Errors
/// Every error that is not a refusal.
pub fn attempt<T>(answer: Result<T, Error>) -> Result<Result<T, Refusal>, Error> {
    match answer {
        Ok(solution) => Ok(Ok(solution)),
        Err(Error::Refused(refusal)) => Ok(Err(refusal)),
        Err(other) => Err(other),
    }
}
