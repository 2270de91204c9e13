//! The refinement of accepted effects: they are fitted to everything, refined, exchanged for better ones, and dropped if the others
//! explain as much without them.

use crate::fitting::output_error::{EffectFit, FitSelection, apply_effects, parameters_of};
use crate::library::{Effect, find_refinement};
use crate::selection::candidate::FittedCandidate;
use crate::selection::outcome::SearchOutcome;
use crate::selection::searcher::Searcher;
use crate::selection::stage::StageBreadth;
use crate::simulator_access::Assessment;
use crate::tolerance::{AMBIGUOUS, RIVALS, SEARCH_ITERATIONS, SWAP_NEEDED};

impl Searcher<'_> {
    /// Returns the accepted effects with those in a coarse form refined, if that explains more.
    pub(crate) fn refine_effects(&self, candidate: FittedCandidate) -> FittedCandidate {
        let finer = |effect: &&'static Effect| find_refinement(effect).unwrap_or(effect);
        let effects: Vec<&'static Effect> = candidate.fit.effects.iter().map(finer).collect();
        if effects.iter().zip(&candidate.fit.effects).all(|(a, b)| std::ptr::eq(*a, *b)) {
            return candidate;
        }
        let start: Vec<f64> = effects.iter().flat_map(|e| e.values(&candidate.fit.parameters)).collect();
        let selection =
            FitSelection { iterations: SEARCH_ITERATIONS, ..FitSelection::all(self.simulator.count()) };
        let fit = self.fit(effects, &start, &selection, &candidate.assessments);
        match fit.and_then(|fit| self.replace_fit(&candidate, fit)) {
            Some(finer) if finer.log_likelihood_deficit(&candidate) < 0.0 => finer,
            _ => candidate,
        }
    }

    /// Fits the accepted effects once more, to all recordings.
    pub(crate) fn refit_candidate(&self, candidate: FittedCandidate) -> FittedCandidate {
        let selection =
            FitSelection { iterations: SEARCH_ITERATIONS, ..FitSelection::all(self.simulator.count()) };
        let (effects, assessments) = (candidate.fit.effects.clone(), &candidate.assessments);
        let again = self.fit(effects, &candidate.fit.values, &selection, assessments);
        match again.and_then(|fit| self.replace_fit(&candidate, fit)) {
            Some(again) if again.whole.level() <= candidate.whole.level() + 0.01 => again,
            _ => candidate,
        }
    }

    /// Replaces an effect if another explains more beside the rest, and drops one that the others make idle.
    pub(crate) fn swap_and_prune(&self, search: &mut SearchOutcome) {
        let Some(mut best) = search.accepted.take() else { return };
        self.prune_effects(&mut best, search);
        if let Some(simpler) = self.merge_effects(&best, search) {
            best = simpler;
        }
        if best.fit.effects.len() > 1 {
            let before = best.fit.effects.clone();
            let rivals = self.swap_effects(&mut best, search);
            search.rivals = rivals.into_iter().map(|rivals| self.refit_rivals(rivals, &best)).collect();
            let same = best.fit.effects.iter().zip(&before).all(|(a, b)| std::ptr::eq(*a, *b));
            let dropped = if same { Vec::new() } else { self.prune_effects(&mut best, search) };
            for index in dropped {
                search.rivals.remove(index);
            }
        }
        if let (1, Some(stage)) = (best.fit.effects.len(), search.stages.iter().find(|s| s.contains(&best))) {
            let singles = stage.single_candidates();
            let gains_little = |c: &FittedCandidate| c.has_same_effects(&best) && c.gain() < c.least_gain;
            if singles.iter().any(gains_little) && !self.gains_alone(&best, &search.baseline.fitted) {
                return;
            }
            search.rivals = vec![self.refit_rivals(singles, &best)];
        }
        search.accepted = Some(best);
    }

    /// Returns whether what is left of a larger model gains enough on the last part of every recording, fitted from its own values to the
    /// first parts. The first fit of its only effect may not have come so far from the values of the model as it was.
    fn gains_alone(&self, best: &FittedCandidate, before: &[Assessment]) -> bool {
        let all: Vec<usize> = (0..self.simulator.count()).collect();
        let selection = FitSelection::search_parts(all.clone());
        let fit = self.fit(best.fit.effects.clone(), &best.fit.values, &selection, &best.assessments);
        let judged = fit.and_then(|fit| {
            let judged = self.assess_model(&fit.parameters, &|r| fit.assessment(r))?;
            self.build_candidate(fit, &judged, &all, before)
        });
        judged.is_some_and(|judged| judged.is_acceptable())
    }

    /// Returns the rivals of an effect, best first: the effect itself as the model is fitted now, and those that were level with
    /// its first fit or ahead of it, fitted as thoroughly. Otherwise an effect could pass for equivalent because the other's first
    /// fit did not converge.
    fn refit_rivals(&self, rivals: Vec<FittedCandidate>, best: &FittedCandidate) -> Vec<FittedCandidate> {
        let Some(first) = rivals.iter().find(|c| c.has_same_effects(best)).cloned() else { return rivals };
        let again = |rival: FittedCandidate| {
            if rival.has_same_effects(best) {
                FittedCandidate { whole: best.whole.clone(), ..rival }
            } else if rival.log_likelihood_deficit(&first) < AMBIGUOUS
                && rival.log_likelihood_deficit(best) >= AMBIGUOUS
            {
                self.refit_candidate(rival)
            } else {
                rival
            }
        };
        let mut heard: Vec<FittedCandidate> = rivals.into_iter().map(again).collect();
        heard.sort_by(|a, b| a.log_likelihood_deficit(best).total_cmp(&b.log_likelihood_deficit(best)));
        heard
    }

    /// Replaces effects if another explains more beside the rest; returns the candidates in the place of each.
    fn swap_effects(&self, best: &mut FittedCandidate, search: &SearchOutcome) -> Vec<Vec<FittedCandidate>> {
        let mut all = Vec::new();
        for index in 0..best.fit.effects.len() {
            let Some(without) = self.remove_effect(best, index).filter(|_| !self.pool.is_cancelled()) else {
                all.push(Vec::new());
                continue;
            };
            let rivals = self.find_rivals(search, &without);
            let better =
                rivals.iter().find(|c| c.is_acceptable() && c.log_likelihood_deficit(best) < -SWAP_NEEDED);
            if let Some(better) = better {
                *best = self.refit_candidate(better.clone());
                best.move_last_to(index);
            }
            all.push(rivals);
        }
        all
    }

    /// Returns what else could be in the place of an effect: from the stage that tried it, or from a new screening.
    fn find_rivals(&self, search: &SearchOutcome, without: &FittedCandidate) -> Vec<FittedCandidate> {
        let tried = search.stages.iter().map(|stage| stage.extend_candidate(without)).max_by_key(Vec::len);
        match tried.filter(|tried| tried.len() >= RIVALS) {
            Some(tried) => tried,
            None => self.run_stage(without, StageBreadth::Narrow).adding_one(without.fit.effects.len()),
        }
    }

    /// Drops effects without which the rest explains the recordings equally well; returns their indices, one after the other.
    fn prune_effects(&self, best: &mut FittedCandidate, search: &SearchOutcome) -> Vec<usize> {
        let mut dropped = Vec::new();
        let mut index = 0;
        while best.fit.effects.len() > 1 && index < best.fit.effects.len() && !self.pool.is_cancelled() {
            let Some(without) = self.remove_effect(best, index) else { break };
            let needed = best.is_worth_more_than(&without.whole, &search.baseline.score)
                && (index + 1 < best.fit.effects.len() || self.exceeds_null_gain(best, &without.whole));
            if needed {
                index += 1;
            } else {
                *best = without;
                dropped.push(index);
            }
        }
        dropped
    }

    /// Returns a candidate without one of its effects: the others fitted anew, or with their values if that is better.
    fn remove_effect(&self, candidate: &FittedCandidate, index: usize) -> Option<FittedCandidate> {
        let mut effects = candidate.fit.effects.clone();
        let first = parameters_of(&effects[..index]).len();
        let mut start = candidate.fit.values.clone();
        start.drain(first..first + effects[index].parameters.len());
        effects.remove(index);
        let recordings = (0..self.simulator.count()).collect();
        let selection = FitSelection::search_parts(recordings);
        let kept = apply_effects(self.base, &effects, &start);
        let fit = self.fit(effects, &start, &selection, &[])?;
        let (again, as_it_is) = (self.replace_fit(candidate, fit)?, self.score_model(&kept)?);
        if as_it_is.level() < again.whole.level() {
            let fit = EffectFit { values: start, parameters: kept, ..again.fit };
            return Some(FittedCandidate { fit, whole: as_it_is, ..candidate.clone() });
        }
        Some(again)
    }
}
