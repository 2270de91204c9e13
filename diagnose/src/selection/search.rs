//! The search: which effects, together, explain the recordings; stepwise, with swaps, assessed on held-out data.
//!
//! At every stage the effects with the best signatures are fitted to the recordings in which they show most, and the best of those
//! to the first part of every recording. The winner must gain on the rest, and must not make a recording of another kind worse than
//! those that it was fitted to: each recording in turn is left out of the fit and predicted.

use crate::fitting::score::Score;
use crate::selection::candidate::FittedCandidate;
use crate::selection::outcome::SearchOutcome;
use crate::selection::searcher::Searcher;
use crate::selection::stage::{Stage, StageBreadth};
use crate::tolerance::{EFFECTS_AT_MOST, RIVALS, SWAP_NEEDED, TEXTBOOK_SHARE_TO_NAME};

impl Searcher<'_> {
    /// Searches for up to three effects; returns `None` if the model as it is cannot be simulated.
    pub fn search(&self) -> Option<SearchOutcome> {
        let mut search = SearchOutcome::of(self.fit_baseline()?);
        loop {
            let present = search.accepted.as_ref();
            let found = present.map_or(0, |c| c.fit.effects.len());
            self.pool.progress("naming", found, EFFECTS_AT_MOST);
            // beside values of a textbook, two effects that cancel each other gain a little even where nothing is left to explain
            let complete = !self.sizes.typical && present.is_some_and(FittedCandidate::explains);
            if found >= EFFECTS_AT_MOST || complete {
                break;
            }
            let stage = match present {
                Some(present) => self.run_stage(present, StageBreadth::Full),
                None => self.run_first_stage(&search.baseline),
            };
            let smaller = present.map_or(&search.baseline.score, |c| &c.whole);
            let needed = present.map_or(&[][..], |c| &c.needed);
            let best = self.choose_candidate(&stage, smaller, needed, &search);
            search.stages.push(stage);
            let Some(best) = best else { break };
            search.accepted = Some(self.refine_effects(self.refit_candidate(best)));
            if self.pool.is_cancelled() {
                search.cancelled = true;
                break;
            }
        }
        self.swap_and_prune(&mut search);
        self.drop_undetermined(&mut search);
        search.accepted = search.accepted.map(|best| self.place_curve_knots(best));
        Some(search)
    }

    /// Returns the best candidate of a stage, validated on recordings of another kind; `None` if none is worth having.
    fn choose_candidate(
        &self,
        stage: &Stage,
        smaller: &Score,
        needed: &[usize],
        search: &SearchOutcome,
    ) -> Option<FittedCandidate> {
        let least_share = if !self.sizes.typical && smaller.is_complete() {
            TEXTBOOK_SHARE_TO_NAME
        } else {
            f64::NEG_INFINITY
        };
        let worth = |c: &&FittedCandidate| {
            c.is_acceptable()
                && c.is_worth_more_than(smaller, &search.baseline.score)
                && c.power_share(smaller) > least_share
        };
        let beyond = |c: &&FittedCandidate| self.exceeds_null_gain(c, smaller);
        let mut worthy: Vec<&FittedCandidate> = stage.candidates.iter().filter(worth).take(RIVALS).collect();
        if !self.sizes.typical {
            // what a model with textbook values leaves is far above the floor: held-out data decides, with one more effect at its
            // price
            let worth = |c: &FittedCandidate| c.gain() - SWAP_NEEDED * c.fit.effects.len() as f64;
            worthy.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        }
        let best = worthy.into_iter().find(beyond)?;
        let best = FittedCandidate { needed: needed.to_vec(), ..best.clone() };
        let validated = self.validate_candidate(best, smaller, &search.baseline.fitted)?;
        (!validated.is_harmful() && validated.gain() > validated.least_gain).then_some(validated)
    }
}
