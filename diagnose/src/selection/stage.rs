//! One stage of the search: every effect screened on top of a model, the best fitted, the best of those fitted again.

use crate::fitting::output_error::FitSelection;
use crate::fitting::score::assess_recordings;
use crate::library::Effect;
use crate::selection::baseline::{Baseline, log_excess};
use crate::selection::candidate::{FittedCandidate, rank_candidates};
use crate::selection::hose_spring::spring_in_place_of_hose;
use crate::selection::pairs::rank_pairs;
use crate::selection::parameter_scan::{scan_backlash, scan_current_limit};
use crate::selection::screening::screen_effects;
use crate::selection::searcher::Searcher;
use crate::selection::signature::{EffectSignature, ScreeningContext, ScreeningDepth, is_close};
use crate::simulator_access::Assessment;
use crate::tolerance::{
    EFFECTS_AT_MOST, FINAL_REACH, FINALISTS, GAIN_NEEDED, JOINT_PARAMETERS, PAIRS, PROMISE_SHARE, RIVALS,
    SHORTLIST, THROWN_OFF,
};
use counterpoise_pool::map_with_progress;

/// One stage: the candidates, best first, and the screening.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Candidates, best first.
    pub candidates: Vec<FittedCandidate>,
    /// The screening, best first.
    pub signatures: Vec<EffectSignature>,
}

impl Stage {
    /// Returns whether a candidate of this stage consists of the only effect of a model.
    pub(crate) fn contains(&self, model: &FittedCandidate) -> bool {
        let effect = model.newest_effect();
        let same =
            |c: &FittedCandidate| c.newest_effect().zip(effect).is_some_and(|(a, b)| std::ptr::eq(a, b));
        self.candidates.iter().any(|c| c.fit.effects.len() == 1 && same(c))
    }

    /// Returns the candidates of one effect alone.
    pub(crate) fn single_candidates(&self) -> Vec<FittedCandidate> {
        self.adding_one(0)
    }

    /// Returns the candidates that have all effects of a smaller model and one more.
    pub(crate) fn extend_candidate(&self, smaller: &FittedCandidate) -> Vec<FittedCandidate> {
        let has = |c: &FittedCandidate, e: &Effect| c.fit.effects.iter().any(|f| std::ptr::eq(*f, e));
        let all = |c: &&FittedCandidate| {
            c.fit.effects.len() == smaller.fit.effects.len() + 1
                && smaller.fit.effects.iter().all(|e| has(c, e))
        };
        self.candidates.iter().filter(all).cloned().collect()
    }

    /// Returns the candidates that add one effect to a number of present ones.
    pub(crate) fn adding_one(&self, present: usize) -> Vec<FittedCandidate> {
        self.candidates.iter().filter(|c| c.fit.effects.len() == present + 1).cloned().collect()
    }
}

/// The extent of a stage's search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StageBreadth {
    /// For the next effect.
    Full,
    /// For one effect alone: what could stand in the place of one that was found, or what is left of a model that explains everything.
    Narrow,
}

/// The assessments of every recording for the present model.
#[derive(Clone, Copy)]
struct StageAssessments<'a> {
    /// From the initial states at which effects are screened.
    screened_from: &'a [Assessment],
    /// From the initial states against which candidates are compared.
    judged_against: &'a [Assessment],
}

/// Returns whether a share of the residual's power could gain what an effect must if all residuals were independent. If the model
/// is far from the recordings, a signature is not reliable enough to leave an effect out.
fn is_worth_fitting(explained: f64, judged: &[Assessment]) -> bool {
    let samples: usize = judged.iter().flat_map(|j| &j.channels).map(|m| m.residual.len()).sum();
    !is_close(judged) || 0.5 * samples as f64 * explained > PROMISE_SHARE * GAIN_NEEDED
}

impl Searcher<'_> {
    /// Runs the first stage. If the model as it is is close to the recordings, effects are screened at the initial states that suit
    /// it; if it is far, at those estimated from the first moments, because fitted ones compensate for what is missing. A position loop with
    /// textbook values may be thrown off so far by an estimate that its decay hides everything else: fitted ones serve then.
    pub(crate) fn run_first_stage(&self, plain: &Baseline) -> Stage {
        let thrown_off = |(sought, fitted): (&Assessment, &Assessment)| {
            log_excess(sought) > log_excess(fitted) + THROWN_OFF * sought.channels.len() as f64
        };
        let hides = !self.sizes.typical && plain.sought.iter().zip(&plain.fitted).any(thrown_off);
        let from = if hides || is_close(&plain.fitted) { &plain.fitted } else { &plain.sought };
        let against = StageAssessments { screened_from: from, judged_against: &plain.fitted };
        // where values of a textbook leave nothing to explain, one effect alone may be below the noise, and a pair follows it
        let complete = !self.sizes.typical && plain.score.is_complete();
        let breadth = if complete { StageBreadth::Narrow } else { StageBreadth::Full };
        self.screen_and_fit(None, against, breadth)
    }

    /// Runs a stage on top of a model.
    pub(crate) fn run_stage(&self, present: &FittedCandidate, breadth: StageBreadth) -> Stage {
        let judged = self.assess_model(&present.fit.parameters, &|r| present.assessments.get(r));
        match judged.or_else(|| assess_recordings(self.simulator, self.pool, &present.fit.parameters)) {
            Some(judged) => {
                let against = StageAssessments { screened_from: &judged, judged_against: &judged };
                self.screen_and_fit(Some(present), against, breadth)
            }
            None => Stage { candidates: Vec::new(), signatures: Vec::new() },
        }
    }

    /// Screens every effect on top of the present model, fits the shortlist and compares the candidates.
    fn screen_and_fit(
        &self,
        present: Option<&FittedCandidate>,
        against: StageAssessments,
        breadth: StageBreadth,
    ) -> Stage {
        let StageAssessments { screened_from: from, judged_against: judged } = against;
        let model = present.map_or(self.base, |c| &c.fit.parameters);
        let taken: Vec<&Effect> = present.map_or(Vec::new(), |c| c.fit.effects.clone());
        let free: Vec<&'static Effect> =
            self.effects.iter().copied().filter(|e| !taken.iter().any(|t| std::ptr::eq(*t, *e))).collect();
        let reach = if present.is_none() { ScreeningDepth::Full } else { ScreeningDepth::FirstPart };
        let (simulator, pool, sizes) = (self.simulator, self.pool, self.sizes);
        let scene = ScreeningContext { simulator, pool, base: model, judged: from, reach, sizes };
        let signatures = screen_effects(&scene, &free);
        let mut proposals = self.shortlist_signatures(&signatures, judged, breadth);
        if taken.is_empty() {
            proposals.extend(self.seed_signatures(&scene).into_iter().map(|look| vec![look]));
        }
        let mut candidates = self.fit_candidates(present, &proposals, judged);
        let alone = candidates.iter().any(|c| c.explains() && c.is_acceptable());
        if breadth == StageBreadth::Full && taken.len() + 2 <= EFFECTS_AT_MOST && !alone {
            let found = rank_pairs(from, &signatures, PAIRS);
            let promising = found.iter().filter(|pair| is_worth_fitting(pair.explained, judged));
            let both: Vec<Vec<EffectSignature>> =
                promising.map(|pair| pair.signatures(&signatures, model).to_vec()).collect();
            candidates.extend(self.fit_candidates(present, &both, judged));
        }
        if breadth == StageBreadth::Full && !alone {
            let spring =
                spring_in_place_of_hose(&candidates, taken.len(), self.simulator.count(), &self.effects);
            candidates.extend(self.fit_candidates(present, &spring.into_iter().collect::<Vec<_>>(), judged));
        }
        let (candidates, others) = split_finalists(rank_candidates(candidates));
        let finalists = self.refit_finalists(present, candidates, judged);
        Stage { candidates: rank_candidates(finalists.into_iter().chain(others).collect()), signatures }
    }

    /// Returns the effects that are fitted.
    fn shortlist_signatures(
        &self,
        signatures: &[EffectSignature],
        judged: &[Assessment],
        breadth: StageBreadth,
    ) -> Vec<Vec<EffectSignature>> {
        let count = if breadth == StageBreadth::Full { SHORTLIST } else { RIVALS };
        let promising = |look: &&EffectSignature| is_worth_fitting(look.explained, judged);
        shortlist(signatures, count).into_iter().filter(promising).map(|look| vec![look.clone()]).collect()
    }

    /// Returns the effects whose values are known from elsewhere.
    fn seed_signatures(&self, scene: &ScreeningContext) -> Vec<EffectSignature> {
        let one = |(effect, start): &(&'static Effect, Vec<f64>)| {
            EffectSignature::from_start(effect, start.clone(), self.simulator.count())
        };
        let scanned = scan_backlash(scene).into_iter().chain(scan_current_limit(scene, &self.effects));
        self.seeds.iter().map(one).chain(scanned).collect()
    }

    /// Fits and assesses every proposal.
    fn fit_candidates(
        &self,
        present: Option<&FittedCandidate>,
        proposals: &[Vec<EffectSignature>],
        judged: &[Assessment],
    ) -> Vec<FittedCandidate> {
        let one = |t: usize| self.fit_candidate(present, &proposals[t], judged);
        let fitted = map_with_progress(self.pool, "fitting", proposals.len(), one);
        fitted.into_iter().flatten().collect()
    }

    /// Fits the present effects and one or two more to the recordings in which they show most.
    fn fit_candidate(
        &self,
        present: Option<&FittedCandidate>,
        signatures: &[EffectSignature],
        before: &[Assessment],
    ) -> Option<FittedCandidate> {
        let free = present.filter(|c| c.fit.values.len() <= JOINT_PARAMETERS);
        let mut effects = free.map_or(Vec::new(), |c| c.fit.effects.clone());
        let mut start = free.map_or(Vec::new(), |c| c.fit.values.clone());
        for look in signatures {
            effects.push(look.effect);
            start.extend(&look.start);
        }
        let signature = |r: usize| signatures.iter().map(|look| look.signature[r]).fold(0.0, f64::max);
        let mut recordings =
            most_sensitive_recordings(&(0..self.simulator.count()).map(signature).collect::<Vec<f64>>());
        recordings.extend(present.iter().flat_map(|c| &c.needed));
        recordings.sort_unstable();
        recordings.dedup();
        let selection = FitSelection::first_parts_for_ranking(recordings);
        // a start that is known from elsewhere may be far from the present model
        let near = if signatures.iter().any(EffectSignature::is_seeded) { &[] } else { before };
        let fit = match (present, free) {
            (Some(fixed), None) => self.fit_on_top(fixed, effects, &start, &selection)?,
            _ => self.fit(effects, &start, &selection, near)?,
        };
        self.assess_fit(fit, &selection.recordings, before)
    }

    /// Fits the best candidates to the first part of every recording.
    fn refit_finalists(
        &self,
        present: Option<&FittedCandidate>,
        candidates: Vec<FittedCandidate>,
        before: &[Assessment],
    ) -> Vec<FittedCandidate> {
        let recordings: Vec<usize> = (0..self.simulator.count()).collect();
        let selection = FitSelection::search_parts(recordings);
        let again = map_with_progress(self.pool, "comparing", candidates.len(), |c| {
            let candidate = &candidates[c];
            let fixed = present.filter(|p| p.fit.values.len() > JOINT_PARAMETERS);
            let effects = candidate.fit.effects[fixed.map_or(0, |f| f.fit.effects.len())..].to_vec();
            let start = &candidate.fit.values[fixed.map_or(0, |f| f.fit.values.len())..];
            let fit = match fixed {
                Some(fixed) => self.fit_on_top(fixed, effects, start, &selection),
                None => self.fit(effects, start, &selection, &[]),
            };
            let fit = fit?;
            let judged = self.assess_model(&fit.parameters, &|r| fit.assessment(r))?;
            self.build_candidate(fit, &judged, &selection.recordings, before)
        });
        if again.len() < candidates.len() {
            return candidates;
        }
        let better = |(now, was): (Option<FittedCandidate>, FittedCandidate)| match now {
            Some(now) if now.whole.level() < was.whole.level() => now,
            _ => was,
        };
        again.into_iter().zip(candidates).map(better).collect()
    }
}

/// Splits ranked candidates into those that are worth a fit to every recording, and the others.
pub(crate) fn split_finalists(
    mut candidates: Vec<FittedCandidate>,
) -> (Vec<FittedCandidate>, Vec<FittedCandidate>) {
    let Some(best) = candidates.first() else { return (candidates, Vec::new()) };
    let limit = best.whole.level() + FINAL_REACH[usize::from(!best.explains())];
    let near = candidates.iter().take(FINALISTS).take_while(|c| c.whole.level() < limit).count();
    let others = candidates.split_off(near.max(1));
    (candidates, others)
}

/// Returns the best signatures: of so many effects, the best two of them from two starts.
pub(crate) fn shortlist(signatures: &[EffectSignature], count: usize) -> Vec<&EffectSignature> {
    let mut picked: Vec<&EffectSignature> = Vec::new();
    let mut effects = 0;
    for look in signatures {
        let same = picked.iter().filter(|p| std::ptr::eq(p.effect, look.effect)).count();
        if same == 0 {
            effects += 1;
        }
        if effects > count {
            break;
        }
        if same == 0 || (same == 1 && effects <= 2) {
            picked.push(look);
        }
    }
    picked
}

/// Returns the half of the recordings in which an effect shows most.
pub(crate) fn most_sensitive_recordings(signature: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..signature.len()).collect();
    order.sort_by(|&a, &b| signature[b].total_cmp(&signature[a]));
    order.truncate(signature.len().div_ceil(2));
    order.sort_unstable();
    order
}
