//! The baseline: the model as it is, with the recordings' initial states fitted to all that was recorded.
//!
//! An initial state estimated from the first moments does not reflect what shows only later: without a resolver the hub's angle is
//! known from its weight alone, and a level hub's weight hardly depends on it. The initial states of a candidate are fitted
//! together with its parameters; if those of the model as it is were not, every effect would gain what the initial states give.

use crate::fitting::output_error::FitSelection;
use crate::fitting::score::{Score, assess_recordings, score_parts};
use crate::selection::candidate::whole_parts;
use crate::selection::searcher::Searcher;
use crate::simulator_access::Assessment;
use crate::tolerance::SEARCH_ITERATIONS;

/// The assessments of the recordings for the model as it is.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// From the initial states that their first moments show.
    pub sought: Vec<Assessment>,
    /// From the initial states that explain most of each recording.
    pub fitted: Vec<Assessment>,
    /// Fit of every recording, whole, from these.
    pub score: Score,
}

impl Searcher<'_> {
    /// Assesses the model as it is; returns `None` if it cannot be simulated.
    pub(crate) fn fit_baseline(&self) -> Option<Baseline> {
        let sought = assess_recordings(self.simulator, self.pool, self.base)?;
        let selection =
            FitSelection { iterations: SEARCH_ITERATIONS, ..FitSelection::all(self.simulator.count()) };
        let fit = self.fit(Vec::new(), &[], &selection, &sought);
        let again = fit.and_then(|fit| self.assess_model(self.base, &|r| fit.assessment(r)));
        let better = |(was, now): (&Assessment, Assessment)| {
            if log_excess(&now) < log_excess(was) { now } else { was.clone() }
        };
        let fitted = again.map_or_else(|| sought.clone(), |a| sought.iter().zip(a).map(better).collect());
        let score = score_parts(&fitted, &whole_parts(self.simulator.count()))?;
        Some(Baseline { sought, fitted, score })
    }
}

/// Returns the sum of ln(excess) over a recording's channels.
pub(crate) fn log_excess(judged: &Assessment) -> f64 {
    (0..judged.channels.len()).map(|c| judged.excess(c).max(f64::MIN_POSITIVE).ln()).sum()
}
