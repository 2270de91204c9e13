//! What is done to the effects that were accepted: fitted to everything, refined, swapped for better ones, dropped where
//! the others do without them.

use crate::bench::Judged;
use crate::fit::{Fit, Selection, applied, knobs};
use crate::library::{Effect, refinement};
use crate::scan::repeats;
use crate::score::score;
use crate::search::candidate::whole_parts;
use crate::search::select::{Candidate, Effort, Search, Searcher};
use crate::tolerance::{AMBIGUOUS, RIVALS, SEARCH_ITERATIONS, SWAP_NEEDED};

impl Searcher<'_> {
    /// The accepted effects with those in a coarse form refined, where that explains more.
    pub(crate) fn refined(&self, candidate: Candidate) -> Candidate {
        let finer = |effect: &&'static Effect| refinement(effect).unwrap_or(effect);
        let effects: Vec<&'static Effect> = candidate.fit.effects.iter().map(finer).collect();
        if effects.iter().zip(&candidate.fit.effects).all(|(a, b)| std::ptr::eq(*a, *b)) {
            return candidate;
        }
        let start: Vec<f64> = effects.iter().flat_map(|e| e.values(&candidate.fit.parameters)).collect();
        let selection = Selection { iterations: SEARCH_ITERATIONS, ..Selection::all(self.bench.count()) };
        let fit = self.fit(effects, &start, &selection, &candidate.stances);
        match fit.and_then(|fit| self.with_fit(&candidate, fit)) {
            Some(finer) if finer.behind(&candidate) < 0.0 => finer,
            _ => candidate,
        }
    }

    /// The accepted effects fitted once more, to everything.
    pub(crate) fn refitted(&self, candidate: Candidate) -> Candidate {
        let selection = Selection { iterations: SEARCH_ITERATIONS, ..Selection::all(self.bench.count()) };
        let (effects, stances) = (candidate.fit.effects.clone(), &candidate.stances);
        let again = self.fit(effects, &candidate.fit.values, &selection, stances);
        match again.and_then(|fit| self.with_fit(&candidate, fit)) {
            Some(again) if again.whole.level() <= candidate.whole.level() + 0.01 => again,
            _ => candidate,
        }
    }

    /// A candidate with another fit of its effects to all recordings, judged from the starts that were found with it.
    pub(crate) fn with_fit(&self, candidate: &Candidate, fit: Fit) -> Option<Candidate> {
        if !repeats(self.bench, &fit) {
            return None;
        }
        let judged = self.standing(&fit.parameters, &|r| fit.stance(r))?;
        let whole = score(&judged, &whole_parts(judged.len()))?;
        let stances = judged.iter().map(Judged::stance).collect();
        Some(Candidate { fit, whole, stances, ..candidate.clone() })
    }

    /// Replaces an effect where another explains more beside the rest, and drops one that the others make idle.
    pub(crate) fn swap_and_prune(&self, search: &mut Search) {
        let Some(mut best) = search.accepted.take() else { return };
        self.prune(&mut best, search);
        if let Some(simpler) = self.merged(&best, search) {
            best = simpler;
        }
        if best.fit.effects.len() > 1 {
            let before = best.fit.effects.clone();
            let rivals = self.swapped(&mut best, search);
            search.rivals = rivals.into_iter().map(|rivals| self.heard_again(rivals, &best)).collect();
            let same = best.fit.effects.iter().zip(&before).all(|(a, b)| std::ptr::eq(*a, *b));
            let dropped = if same { Vec::new() } else { self.prune(&mut best, search) };
            for index in dropped {
                search.rivals.remove(index);
            }
        }
        if let (1, Some(stage)) = (best.fit.effects.len(), search.stages.iter().find(|s| s.contains(&best))) {
            let singles = stage.singles();
            if singles.iter().any(|c| c.has_same_effects(&best) && c.gain() < c.least_gain) {
                return;
            }
            search.rivals = vec![self.heard_again(singles, &best)];
        }
        search.accepted = Some(best);
    }

    /// The rivals of an effect, best first: itself as the model is fitted now, and what was level with its first fit or ahead of it
    /// fitted as thoroughly, so that no effect passes for indistinguishable because the other one's first fit went astray.
    fn heard_again(&self, rivals: Vec<Candidate>, best: &Candidate) -> Vec<Candidate> {
        let Some(first) = rivals.iter().find(|c| c.has_same_effects(best)).cloned() else { return rivals };
        let again = |rival: Candidate| {
            if rival.has_same_effects(best) {
                Candidate { whole: best.whole.clone(), ..rival }
            } else if rival.behind(&first) < AMBIGUOUS && rival.behind(best) >= AMBIGUOUS {
                self.refitted(rival)
            } else {
                rival
            }
        };
        let mut heard: Vec<Candidate> = rivals.into_iter().map(again).collect();
        heard.sort_by(|a, b| a.behind(best).total_cmp(&b.behind(best)));
        heard
    }

    /// Replaces effects where another explains more beside the rest; gives what was judged in the place of each.
    fn swapped(&self, best: &mut Candidate, search: &Search) -> Vec<Vec<Candidate>> {
        let mut all = Vec::new();
        for index in 0..best.fit.effects.len() {
            let Some(without) = self.without(best, index).filter(|_| !self.pool.cancelled()) else {
                all.push(Vec::new());
                continue;
            };
            let rivals = self.rivals(search, &without);
            let better = rivals.iter().find(|c| c.is_acceptable() && c.behind(best) < -SWAP_NEEDED);
            if let Some(better) = better {
                *best = self.refitted(better.clone());
                best.move_last_to(index);
            }
            all.push(rivals);
        }
        all
    }

    /// What else could stand beside the effects of a model: from the stage that tried it, or looked for now.
    fn rivals(&self, search: &Search, without: &Candidate) -> Vec<Candidate> {
        let tried = search.stages.iter().map(|stage| stage.beside(without)).max_by_key(Vec::len);
        match tried.filter(|tried| tried.len() >= RIVALS) {
            Some(tried) => tried,
            None => self.stage(without, Effort::Rivals).adding_one(without.fit.effects.len()),
        }
    }

    /// Drops effects without which the rest explains the recordings as well; gives their places, one after the other.
    fn prune(&self, best: &mut Candidate, search: &Search) -> Vec<usize> {
        let mut dropped = Vec::new();
        let mut index = 0;
        while best.fit.effects.len() > 1 && index < best.fit.effects.len() && !self.pool.cancelled() {
            let Some(without) = self.without(best, index) else { break };
            let needed = best.is_worth_more_than(&without.whole, &search.before)
                && (index + 1 < best.fit.effects.len() || self.is_beyond_chance(best, &without.whole));
            if needed {
                index += 1;
            } else {
                *best = without;
                dropped.push(index);
            }
        }
        dropped
    }

    /// A candidate without one of its effects: the others fitted anew, or as they are where that is no better, as it is where
    /// the effect was idle.
    fn without(&self, candidate: &Candidate, index: usize) -> Option<Candidate> {
        let mut effects = candidate.fit.effects.clone();
        let first = knobs(&effects[..index]).len();
        let mut start = candidate.fit.values.clone();
        start.drain(first..first + effects[index].knobs.len());
        effects.remove(index);
        let recordings = (0..self.bench.count()).collect();
        let selection = Selection::searching(recordings);
        let kept = applied(self.base, &effects, &start);
        let fit = self.fit(effects, &start, &selection, &[])?;
        let (again, as_it_is) = (self.with_fit(candidate, fit)?, self.whole_score(&kept)?);
        if as_it_is.level() < again.whole.level() {
            let fit = Fit { values: start, parameters: kept, ..again.fit };
            return Some(Candidate { fit, whole: as_it_is, ..candidate.clone() });
        }
        Some(again)
    }
}
