//! A well-put problem has a solution, or reasons why it has none.

use crate::Error;
use crate::finding::Finding;

/// The answer to a problem that is well put.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome<T> {
    /// The solution.
    Solved(T),
    /// Why there is none: at least one refusal.
    Infeasible(Vec<Finding>),
}

impl<T> Outcome<T> {
    /// The solution, where there is one.
    pub fn solved(self) -> Option<T> {
        match self {
            Outcome::Solved(solution) => Some(solution),
            Outcome::Infeasible(_) => None,
        }
    }

    /// The findings that say why there is no solution; empty where there is one.
    pub fn findings(&self) -> &[Finding] {
        match self {
            Outcome::Solved(_) => &[],
            Outcome::Infeasible(findings) => findings,
        }
    }

    /// The outcome with `change` applied to the solution.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn try_map<U>(self, change: impl FnOnce(T) -> Result<U, Error>) -> Result<Outcome<U>, Error> {
        Ok(match self {
            Outcome::Solved(solution) => Outcome::Solved(change(solution)?),
            Outcome::Infeasible(findings) => Outcome::Infeasible(findings),
        })
    }
}
