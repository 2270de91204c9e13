//! A candidate model, fitted and assessed, and the ranking of several.

use crate::fitting::output_error::{EffectFit, parameters_of};
use crate::fitting::score::{RecordingPart, Score};
use crate::library::Effect;
use crate::simulator_access::Assessment;
use crate::tolerance::{EFFECT_PRICE, FITTED_SHARE, HARM, PARAMETER_PRICE, SYSTEMATIC_GAIN};

/// A candidate that was fitted and assessed.
#[derive(Debug, Clone)]
pub struct FittedCandidate {
    /// All effects of the model, fitted together; the new one is the last.
    pub fit: EffectFit,
    /// Fit of every recording, whole.
    pub whole: Score,
    /// Fit of what the candidate was not fitted to.
    pub held_out: Score,
    /// Fit of the model before, on the same data.
    pub held_out_before: Score,
    /// Data that the candidate was not fitted to.
    pub held_out_parts: Vec<RecordingPart>,
    /// The assessments of the recordings, without residuals.
    pub assessments: Vec<Assessment>,
    /// The recordings without which the size of one of its effects could not be determined.
    pub needed: Vec<usize>,
    /// Log-likelihood that an effect must gain.
    pub least_gain: f64,
}

impl FittedCandidate {
    /// Returns the effect that the candidate adds.
    pub fn newest_effect(&self) -> Option<&'static Effect> {
        self.fit.effects.last().copied()
    }

    /// Returns the log-likelihood gained on held-out data.
    pub fn gain(&self) -> f64 {
        self.held_out.gain_over(&self.held_out_before)
    }

    /// Returns the log-likelihood by which the candidate is behind another on all data, with each effect and each
    /// parameter at its price.
    pub fn log_likelihood_deficit(&self, other: &Self) -> f64 {
        self.whole.loss_against(&other.whole) + self.price() - other.price()
    }

    /// Returns what its effects and parameters must be worth.
    fn price(&self) -> f64 {
        EFFECT_PRICE * self.fit.effects.len() as f64 + PARAMETER_PRICE * self.fit.values.len() as f64
    }

    /// Returns whether it gains enough on held-out data, makes no channel worse there and keeps within its bounds.
    pub fn is_acceptable(&self) -> bool {
        self.gain() > self.least_gain && !self.is_harmful() && self.is_within_bounds()
    }

    /// Returns whether a held-out channel gets clearly worse.
    pub fn is_harmful(&self) -> bool {
        let cells = self.held_out.cells.iter().zip(&self.held_out_before.cells);
        cells.into_iter().any(|(after, before)| after.excess > HARM * before.excess.max(1.0))
    }

    /// Returns the share of the power of a smaller model's residual that it explains, mean over recordings and channels.
    pub fn power_share(&self, smaller: &Score) -> f64 {
        let cells = self.whole.cells.iter().zip(&smaller.cells);
        let left: f64 = cells.map(|(after, before)| (after.rms_error / before.rms_error).powi(2)).sum();
        1.0 - left / self.whole.cells.len().max(1) as f64
    }

    /// Returns the share of the power of the residual that it leaves on held-out data, mean over recordings and channels.
    pub fn held_out_power_share(&self) -> f64 {
        let cells = self.held_out.cells.iter().zip(&self.held_out_before.cells);
        let left: f64 = cells.map(|(after, before)| (after.rms_error / before.rms_error).powi(2)).sum();
        left / self.held_out.cells.len().max(1) as f64
    }

    /// Returns whether every parameter stayed off the bounds of physical sense.
    pub(crate) fn is_within_bounds(&self) -> bool {
        parameters_of(&self.fit.effects).iter().zip(&self.fit.values).all(|(parameter, &value)| {
            let [low, high] = parameter.bounds;
            let margin = 1e-3 * (high - low).abs().min(value.abs());
            (value > low + margin || low == 0.0) && value < high - margin
        })
    }

    /// Returns whether its last effect is worth having beside those of a smaller model: it must gain more than noise, and more than
    /// two careful simulators of one mechanism differ by, which grows with all that was explained.
    pub fn is_worth_more_than(&self, smaller: &Score, nothing: &Score) -> bool {
        let gain = self.whole.gain_over(smaller);
        gain > self.least_gain && gain > SYSTEMATIC_GAIN * self.whole.gain_over(nothing)
    }

    /// Returns whether nothing is left that a further effect could explain.
    pub fn explains(&self) -> bool {
        self.whole.is_complete()
    }

    pub(crate) fn has_same_effects(&self, other: &Self) -> bool {
        let all = |c: &Self| {
            let mut labels: Vec<*const Effect> =
                c.fit.effects.iter().map(|e| std::ptr::from_ref(*e)).collect();
            labels.sort_unstable();
            labels
        };
        all(self) == all(other)
    }

    /// Moves the newest effect to `index` of the list.
    pub(crate) fn move_last_to(&mut self, index: usize) {
        let Some(newest) = self.fit.effects.pop() else { return };
        let first = parameters_of(&self.fit.effects[..index]).len();
        let tail = self.fit.values.split_off(self.fit.values.len() - newest.parameters.len());
        self.fit.values.splice(first..first, tail);
        self.fit.effects.insert(index, newest);
    }
}

/// Ranks candidates, best first, with each set of effects once: by the likelihood of all data, every channel weighted by its worth
/// to the one that is nearest to the floor.
pub(crate) fn rank_candidates(mut candidates: Vec<FittedCandidate>) -> Vec<FittedCandidate> {
    candidates.sort_by(|a, b| a.whole.level().total_cmp(&b.whole.level()));
    if let Some(nearest) = candidates.first().cloned() {
        candidates.sort_by(|a, b| {
            a.log_likelihood_deficit(&nearest).total_cmp(&b.log_likelihood_deficit(&nearest))
        });
    }
    let mut kept: Vec<FittedCandidate> = Vec::new();
    for candidate in candidates {
        if !kept.iter().any(|k| k.has_same_effects(&candidate)) {
            kept.push(candidate);
        }
    }
    kept
}

/// Returns the end of every fitted recording, and the others whole.
pub(crate) fn held_out_parts(count: usize, fitted: &[usize]) -> Vec<RecordingPart> {
    let part = |r| RecordingPart {
        recording: r,
        from: if fitted.contains(&r) { FITTED_SHARE } else { 0.0 },
        to: 1.0,
    };
    (0..count).map(part).collect()
}

/// Returns all recordings, whole.
pub(crate) fn whole_parts(count: usize) -> Vec<RecordingPart> {
    (0..count).map(|recording| RecordingPart { recording, from: 0.0, to: 1.0 }).collect()
}
