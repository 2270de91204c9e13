//! The outcome of a search.

use crate::selection::baseline::Baseline;
use crate::selection::candidate::FittedCandidate;
use crate::selection::stage::Stage;

/// The outcome of the search.
#[derive(Debug, Clone)]
pub struct SearchOutcome {
    /// The accepted effects, fitted to all recordings; `None` if the model as it is was kept.
    pub accepted: Option<FittedCandidate>,
    /// The model as it was.
    pub baseline: Baseline,
    /// For each accepted effect, the candidates in its place beside the others, best first.
    pub rivals: Vec<Vec<FittedCandidate>>,
    /// Every stage.
    pub stages: Vec<Stage>,
    /// `true` if the user stopped the search.
    pub cancelled: bool,
}

impl SearchOutcome {
    /// A search that has found nothing yet.
    pub(crate) fn of(baseline: Baseline) -> Self {
        Self { accepted: None, baseline, rivals: Vec::new(), stages: Vec::new(), cancelled: false }
    }
}
