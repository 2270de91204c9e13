//! A simpler model in place of what a stepwise search finds: one effect for two of one component.

use crate::fitting::output_error::{FitSelection, apply_effects, parameters_of};
use crate::library::Effect;
use crate::selection::candidate::FittedCandidate;
use crate::selection::outcome::SearchOutcome;
use crate::selection::screening::screen_effects;
use crate::selection::searcher::Searcher;
use crate::selection::signature::{EffectSignature, ScreeningContext, ScreeningDepth};
use crate::tolerance::{MERGES, SEARCH_ITERATIONS};
use counterpoise_pool::map;

impl Searcher<'_> {
    /// Returns a candidate with one effect in place of two of the same component, if it explains as much: another out-of-balance in
    /// place of an accelerometer's bias and scale together. The other effects keep their values during the screening, because
    /// without the two no fit of them converges.
    pub(crate) fn merge_effects(
        &self,
        best: &FittedCandidate,
        search: &SearchOutcome,
    ) -> Option<FittedCandidate> {
        let effects = &best.fit.effects;
        let of_one = |i: &usize, j: &usize| effects[*i].component == effects[*j].component;
        let pairs = (0..effects.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let mut pairs = pairs.filter(|[i, j]| of_one(i, j) && !self.pool.is_cancelled());
        pairs.find_map(|pair| self.merge_pair(best, pair, search))
    }

    fn merge_pair(
        &self,
        best: &FittedCandidate,
        pair: [usize; 2],
        search: &SearchOutcome,
    ) -> Option<FittedCandidate> {
        let kept = effects_except(best, pair);
        let model = apply_effects(self.base, &kept.effects, &kept.values);
        let judged = self.assess_model(&model, &|r| best.assessments.get(r))?;
        let (simulator, pool, sizes) = (self.simulator, self.pool, self.sizes);
        let scene = ScreeningContext {
            simulator,
            pool,
            base: &model,
            judged: &judged,
            reach: ScreeningDepth::Full,
            sizes,
        };
        let taken = |e: &Effect| best.fit.effects.iter().any(|t| std::ptr::eq(*t, e));
        let free: Vec<&'static Effect> = self.effects.iter().copied().filter(|e| !taken(e)).collect();
        let mut signatures: Vec<EffectSignature> = Vec::new();
        for look in screen_effects(&scene, &free) {
            if signatures.len() < MERGES && !signatures.iter().any(|l| std::ptr::eq(l.effect, look.effect)) {
                signatures.push(look);
            }
        }
        let simpler =
            map(self.pool, signatures.len(), |k| self.fit_with_one_more(best, &kept, &signatures[k]));
        let simpler = simpler
            .into_iter()
            .flatten()
            .filter(|c| c.is_within_bounds() && c.log_likelihood_deficit(best) < 0.0);
        let simplest = simpler
            .min_by(|a, b| a.log_likelihood_deficit(best).total_cmp(&b.log_likelihood_deficit(best)))?;
        self.validate_candidate(simplest, &search.baseline.score, &search.baseline.fitted)
            .filter(FittedCandidate::is_acceptable)
    }

    /// Fits the kept effects and one more to all recordings, from their present values.
    fn fit_with_one_more(
        &self,
        best: &FittedCandidate,
        kept: &KeptEffects,
        look: &EffectSignature,
    ) -> Option<FittedCandidate> {
        let effects = kept.effects.iter().copied().chain([look.effect]).collect();
        let start: Vec<f64> = kept.values.iter().chain(&look.start).copied().collect();
        let selection =
            FitSelection { iterations: SEARCH_ITERATIONS, ..FitSelection::all(self.simulator.count()) };
        let fit = self.fit(effects, &start, &selection, &best.assessments)?;
        self.replace_fit(best, fit)
    }
}

/// Effects of a candidate that are kept, with their values.
struct KeptEffects {
    effects: Vec<&'static Effect>,
    values: Vec<f64>,
}

/// Returns the effects of a candidate but two.
fn effects_except(best: &FittedCandidate, pair: [usize; 2]) -> KeptEffects {
    let mut kept = KeptEffects { effects: Vec::new(), values: Vec::new() };
    for (i, effect) in best.fit.effects.iter().enumerate().filter(|(i, _)| !pair.contains(i)) {
        let first = parameters_of(&best.fit.effects[..i]).len();
        kept.effects.push(*effect);
        kept.values.extend(&best.fit.values[first..first + effect.parameters.len()]);
    }
    kept
}
