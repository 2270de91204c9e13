//! The data that the search works on, with what every step of it needs: fits of effects, and assessments of the recordings.

use counterpoise_models::Parameters;
use counterpoise_simulate::ensemble::SIDE_BY_SIDE;

use crate::fitting::output_error::{EffectFit, FitSelection, Problem};
use crate::fitting::score::{Score, assess_recordings, score_parts};
use crate::library::Effect;
use crate::selection::candidate::{FittedCandidate, held_out_parts, whole_parts};
use crate::selection::parameter_scan::ripples_repeat;
use crate::selection::sizes::Sizes;
use crate::simulator_access::{Assessment, NearRecording, SimulatorAccess};
use crate::tolerance::selection::{ROUNDED_ORDER_COST, WHOLE_ORDER};
use counterpoise_pool::{Pool, map};

/// Data and state of the search for effects.
pub struct Searcher<'a> {
    /// The simulator, with the recordings.
    pub simulator: &'a dyn SimulatorAccess,
    /// Processors, progress and cancellation.
    pub pool: &'a dyn Pool,
    /// The mechanism as the project file has it.
    pub base: &'a Parameters,
    /// The effects that may be found.
    pub effects: Vec<&'static Effect>,
    /// Effects with values found by other means, to be fitted from there at the first stage.
    pub seeds: Vec<(&'static Effect, Vec<f64>)>,
    /// Known sizes of the machine.
    pub sizes: Sizes,
}

impl Searcher<'_> {
    /// Assesses a fit on all recordings, and on what it was not fitted to.
    pub(crate) fn assess_fit(
        &self,
        fit: EffectFit,
        fitted: &[usize],
        before: &[Assessment],
    ) -> Option<FittedCandidate> {
        let judged = self.assess_from_known(&fit.parameters, &|r| fit.assessment(r), &|r| {
            self.simulator.assess_near(&fit.parameters, r, &before[r].without_residuals())
        })?;
        self.build_candidate(fit, &judged, fitted, before)
    }

    /// Assesses every recording for a mechanism, from the initial state that was fitted with it if there is one.
    pub(crate) fn assess_model<'n>(
        &self,
        parameters: &Parameters,
        known: &(dyn Fn(usize) -> Option<&'n Assessment> + Sync),
    ) -> Option<Vec<Assessment>> {
        self.assess_from_known(parameters, known, &|r| self.simulator.assess(parameters, r))
    }

    /// Assesses every recording: those of which an assessment of a similar mechanism is known side by side, and the others one by one.
    fn assess_from_known<'n>(
        &self,
        parameters: &Parameters,
        known: &(dyn Fn(usize) -> Option<&'n Assessment> + Sync),
        unknown: &(dyn Fn(usize) -> Option<Assessment> + Sync),
    ) -> Option<Vec<Assessment>> {
        let count = self.simulator.count();
        let near: Vec<NearRecording> =
            (0..count).filter_map(|index| known(index).map(|near| NearRecording { index, near })).collect();
        let few: Vec<&[NearRecording]> =
            near.chunks(near.len().div_ceil(self.pool.processors()).clamp(1, SIDE_BY_SIDE)).collect();
        let others: Vec<usize> = (0..count).filter(|&index| known(index).is_none()).collect();
        let judged = map(self.pool, few.len() + others.len(), |k| match few.get(k) {
            Some(few) => self.simulator.assess_each_from(parameters, few),
            None => vec![unknown(others[k - few.len()])],
        });
        let places = near.iter().map(|one| one.index).chain(others);
        let mut judged: Vec<(usize, Option<Assessment>)> = places.zip(judged.into_iter().flatten()).collect();
        judged.sort_by_key(|(place, _)| *place);
        (judged.len() == count).then(|| judged.into_iter().map(|(_, one)| one).collect()).flatten()
    }

    /// Builds a candidate from a fit and its assessments; returns `None` for a ripple that does not repeat.
    pub(crate) fn build_candidate(
        &self,
        fit: EffectFit,
        judged: &[Assessment],
        fitted: &[usize],
        before: &[Assessment],
    ) -> Option<FittedCandidate> {
        if !ripples_repeat(self.simulator, &fit) {
            return None;
        }
        let parts = held_out_parts(self.simulator.count(), fitted);
        Some(FittedCandidate {
            whole: score_parts(judged, &whole_parts(self.simulator.count()))?,
            held_out: score_parts(judged, &parts)?,
            held_out_before: score_parts(before, &parts)?,
            held_out_parts: parts,
            assessments: judged.iter().map(Assessment::without_residuals).collect(),
            needed: Vec::new(),
            least_gain: self.sizes.gain_needed(),
            fit,
        })
    }

    /// Fits new effects while those of a model with many parameters are held.
    pub(crate) fn fit_on_top(
        &self,
        fixed: &FittedCandidate,
        effects: Vec<&'static Effect>,
        start: &[f64],
        selection: &FitSelection,
    ) -> Option<EffectFit> {
        let base = &fixed.fit.parameters;
        let assessments = &fixed.assessments;
        let problem = Problem {
            simulator: self.simulator,
            pool: self.pool,
            selection,
            base,
            effects,
            assessments,
            preferences: &[],
        };
        let mut fit = problem.fit(start)?;
        fit.effects.splice(0..0, fixed.fit.effects.iter().copied());
        fit.values.splice(0..0, fixed.fit.values.iter().copied());
        Some(fit)
    }

    pub(crate) fn fit(
        &self,
        effects: Vec<&'static Effect>,
        start: &[f64],
        selection: &FitSelection,
        assessments: &[Assessment],
    ) -> Option<EffectFit> {
        let (simulator, pool, base) = (self.simulator, self.pool, self.base);
        let problem = Problem { simulator, pool, selection, base, effects, assessments, preferences: &[] };
        let fit = problem.fit(start)?;
        Some(round_ripple_orders(&problem, fit))
    }

    /// Returns a candidate with another fit of its effects to all recordings, assessed from the initial states that were found with
    /// it.
    pub(crate) fn replace_fit(&self, candidate: &FittedCandidate, fit: EffectFit) -> Option<FittedCandidate> {
        if !ripples_repeat(self.simulator, &fit) {
            return None;
        }
        let judged = self.assess_model(&fit.parameters, &|r| fit.assessment(r))?;
        let whole = score_parts(&judged, &whole_parts(judged.len()))?;
        let assessments = judged.iter().map(Assessment::without_residuals).collect();
        Some(FittedCandidate { fit, whole, assessments, ..candidate.clone() })
    }

    pub(crate) fn score_model(&self, parameters: &Parameters) -> Option<Score> {
        score_parts(
            &assess_recordings(self.simulator, self.pool, parameters)?,
            &whole_parts(self.simulator.count()),
        )
    }
}

/// Rounds a ripple's order that is close to a whole number, because teeth and poles are counted, and fits again.
fn round_ripple_orders(problem: &Problem, fit: EffectFit) -> EffectFit {
    let mut start = fit.values.clone();
    let mut first = 0;
    let mut moved = false;
    for effect in &fit.effects {
        if effect.is_ripple() && (start[first + 1] / start[first + 1].round() - 1.0).abs() < WHOLE_ORDER {
            start[first + 1] = start[first + 1].round();
            moved = true;
        }
        first += effect.parameters.len();
    }
    if !moved {
        return fit;
    }
    match problem.fit(&start) {
        Some(again) if again.cost < fit.cost * ROUNDED_ORDER_COST => again,
        _ => fit,
    }
}
