//! Validation: recordings of another kind, each predicted from the others.

use counterpoise_models::Parameters;

use crate::fitting::null_gain::mean_null_gain;
use crate::fitting::output_error::{EffectFit, FitSelection};
use crate::fitting::score::{RecordingPart, Score, score_parts};
use crate::selection::baseline::log_excess;
use crate::selection::candidate::{FittedCandidate, whole_parts};
use crate::selection::searcher::Searcher;
use crate::simulator_access::Assessment;
use crate::tolerance::{
    AMBIGUOUS, FITTED_SHARE, GAIN_BEYOND_NULL, GAIN_NEEDED, JOINT_PARAMETERS, NULL_GAIN_MULTIPLE,
    SOLE_EVIDENCE_SHARE,
};
use counterpoise_pool::map_with_progress;

/// A recording, predicted.
struct Prediction {
    assessment: Assessment,
    /// Share of its length at which what was not fitted begins.
    from: f64,
}

impl Searcher<'_> {
    /// Validates a candidate on recordings of another kind than those fitted: each in turn is left out of the fit and predicted. If
    /// a recording alone shows the newest effect, or alone determines its size, its last part is predicted from its first. A single
    /// recording keeps its assessment.
    pub(crate) fn validate_candidate(
        &self,
        candidate: FittedCandidate,
        smaller: &Score,
        plain: &[Assessment],
    ) -> Option<FittedCandidate> {
        let count = self.simulator.count();
        if count < 2 {
            return Some(candidate);
        }
        let all = candidate.whole.gain_over(smaller);
        let alone = |r: usize| {
            candidate.needed.contains(&r) || candidate.whole.gain_in(r, smaller) > SOLE_EVIDENCE_SHARE * all
        };
        let predicted = map_with_progress(self.pool, "validating", count, |r| {
            if alone(r) {
                self.continue_recording(&candidate, r)
            } else {
                self.predict_recording(&candidate, r)
            }
        });
        let predicted: Vec<Prediction> = predicted.into_iter().collect::<Option<_>>()?;
        if predicted.len() < count {
            return None;
        }
        let mut parts = whole_parts(count);
        parts.iter_mut().zip(&predicted).for_each(|(part, prediction)| part.from = prediction.from);
        let own: Vec<usize> = (0..count).filter(|&r| predicted[r].from > 0.0).collect();
        let judged: Vec<Assessment> = predicted.into_iter().map(|prediction| prediction.assessment).collect();
        Some(FittedCandidate {
            held_out: score_parts(&judged, &parts)?,
            held_out_before: score_parts(plain, &parts)?,
            held_out_parts: parts,
            needed: own,
            ..candidate
        })
    }

    /// Returns whether a candidate gains more than its newest effect would gain on the noise in the loop alone.
    pub(crate) fn exceeds_null_gain(&self, candidate: &FittedCandidate, smaller: &Score) -> bool {
        let gain = candidate.whole.energy_over(smaller) - GAIN_NEEDED;
        gain > GAIN_BEYOND_NULL
            || gain
                > NULL_GAIN_MULTIPLE
                    * mean_null_gain(self.simulator, self.pool, &candidate.fit, &candidate.assessments)
    }

    /// Predicts a recording by the candidate fitted to the others, or the rest of the recording from its first part if the others leave open
    /// what it shows: a motor that sticks in all of them tells only that its friction is no less, for example.
    fn predict_recording(&self, candidate: &FittedCandidate, left_out: usize) -> Option<Prediction> {
        let others: Vec<usize> = (0..self.simulator.count()).filter(|r| *r != left_out).collect();
        let fit = self.refit_to(candidate, others.clone())?;
        let near = candidate.assessments.get(left_out)?;
        let sought = self.simulator.assess_near(&fit.parameters, left_out, near)?;
        let given = self.simulator.assess_from(&fit.parameters, left_out, near)?;
        let assessment = if log_excess(&given) < log_excess(&sought) { given } else { sought };
        if predicts_less(&assessment, candidate, left_out) && self.leave_values_open(candidate, &fit, &others)
        {
            return self.continue_recording(candidate, left_out);
        }
        Some(Prediction { assessment, from: 0.0 })
    }

    /// Returns whether recordings to which a candidate was fitted again do not tell the new values from the candidate's own.
    fn leave_values_open(&self, candidate: &FittedCandidate, fit: &EffectFit, recordings: &[usize]) -> bool {
        let head = RecordingPart { recording: 0, from: 0.0, to: FITTED_SHARE };
        let score_of = |parameters: &Parameters, r: usize, near: Option<&Assessment>| {
            score_parts(&[self.simulator.assess_from(parameters, r, near?)?], &[head])
        };
        let loss = |&r: &usize| {
            let own = score_of(&candidate.fit.parameters, r, candidate.assessments.get(r))?;
            Some(own.loss_against(&score_of(&fit.parameters, r, fit.assessment(r))?))
        };
        let lost: Option<f64> = recordings.iter().map(loss).sum();
        lost.is_some_and(|lost| lost < AMBIGUOUS)
    }

    /// Predicts the rest of a recording by the candidate fitted to its first part and to that of the others.
    fn continue_recording(&self, candidate: &FittedCandidate, recording: usize) -> Option<Prediction> {
        let fit = self.refit_to(candidate, (0..self.simulator.count()).collect())?;
        let near = fit.assessment(recording).or_else(|| candidate.assessments.get(recording))?;
        let assessment = self.simulator.assess_from(&fit.parameters, recording, near)?;
        Some(Prediction { assessment, from: FITTED_SHARE })
    }

    /// Fits the candidate to the first part of some recordings.
    fn refit_to(&self, candidate: &FittedCandidate, recordings: Vec<usize>) -> Option<EffectFit> {
        if candidate.fit.values.len() > JOINT_PARAMETERS {
            return Some(candidate.fit.clone());
        }
        let selection = FitSelection::first_parts_for_ranking(recordings);
        self.fit(candidate.fit.effects.clone(), &candidate.fit.values, &selection, &candidate.assessments)
    }
}

/// Returns whether a prediction of a recording is worse than the candidate's own fit of it by more than two models differ that cannot be told
/// apart.
fn predicts_less(predicted: &Assessment, candidate: &FittedCandidate, recording: usize) -> bool {
    let whole = RecordingPart { recording: 0, from: 0.0, to: 1.0 };
    score_parts(std::slice::from_ref(predicted), &[whole])
        .is_some_and(|predicted| predicted.loss_against(&candidate.whole.of_recording(recording)) > AMBIGUOUS)
}
