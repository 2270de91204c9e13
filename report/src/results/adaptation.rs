//! The adaptation put to the test as a result file has it.

use counterpoise_pipeline::studies::adapt::{AdaptRun, AdaptationInterval};
use counterpoise_pipeline::studies::adaptation::AdaptResult;
use counterpoise_pipeline::studies::adaptation_trials::AdaptationTrials;
use serde::Serialize;

use crate::wording::adaptation::describe_run;

/// The adaptation put to the test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdaptText {
    /// The runs (a) to (h).
    pub runs: Vec<AdaptRunText>,
    /// Trials of every method, and the methods that are refused.
    pub trials: AdaptationTrials,
}

/// A run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdaptRunText {
    /// Letter, as in the source thesis' figure 7-18.
    pub letter: char,
    /// Description of the run.
    pub says: &'static str,
    /// `true` if the controller follows the estimate.
    pub adapts: bool,
    /// The parts of the run between changes.
    pub intervals: Vec<AdaptationInterval>,
}

impl From<&AdaptRun> for AdaptRunText {
    fn from(run: &AdaptRun) -> Self {
        let AdaptRun { kind, adapts, ref intervals, .. } = *run;
        Self { letter: kind.letter(), says: describe_run(kind), adapts, intervals: intervals.clone() }
    }
}

impl From<&AdaptResult> for AdaptText {
    fn from(found: &AdaptResult) -> Self {
        Self { runs: found.runs.iter().map(Into::into).collect(), trials: found.trials.clone() }
    }
}
