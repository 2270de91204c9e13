//! The model as it is, as fairly judged as a candidate: the recordings' starts fitted to all that was recorded.
//!
//! A start found from the first moments says little of what shows only later: without a resolver the hub's angle is known
//! from its weight alone, and a level hub's weight hardly depends on it. A candidate's starts are fitted together with its
//! knobs; were those of the model as it is not, every effect that does next to nothing would gain what the starts give.

use crate::bench::Judged;
use crate::fit::Selection;
use crate::score::judge;
use crate::search::select::Searcher;
use crate::tolerance::SEARCH_ITERATIONS;

/// How the recordings stand to the model as it is.
pub(crate) struct Plain {
    /// From the starts that their first moments tell.
    pub sought: Vec<Judged>,
    /// From the starts that explain most of each recording.
    pub fitted: Vec<Judged>,
}

impl Searcher<'_> {
    /// The model as it is; none where it cannot be simulated.
    pub(crate) fn plain(&self) -> Option<Plain> {
        let sought = judge(self.bench, self.pool, self.base)?;
        let selection = Selection { iterations: SEARCH_ITERATIONS, ..Selection::all(self.bench.count()) };
        let fit = self.fit(Vec::new(), &[], &selection, &sought);
        let again = fit.and_then(|fit| self.standing(self.base, &|r| fit.stance(r)));
        let better = |(was, now): (&Judged, Judged)| if level(&now) < level(was) { now } else { was.clone() };
        let fitted = again.map_or_else(|| sought.clone(), |a| sought.iter().zip(a).map(better).collect());
        Some(Plain { sought, fitted })
    }
}

/// Sum of ln(excess) over a recording's channels.
pub(crate) fn level(judged: &Judged) -> f64 {
    (0..judged.misfits.len()).map(|c| judged.excess(c).max(f64::MIN_POSITIVE).ln()).sum()
}
