//! Validation: recordings of another kind, each predicted from the others.

use crate::fitting::null_gain::mean_null_gain;
use crate::fitting::output_error::{Fit, FitSelection};
use crate::fitting::score::{Score, score};
use crate::selection::baseline::log_excess;
use crate::selection::candidate::{Candidate, whole_parts};
use crate::selection::searcher::Searcher;
use crate::simulator_access::{Assessment, map_with_progress};
use crate::tolerance::{
    FITTED_SHARE, GAIN_BEYOND_NULL, GAIN_NEEDED, JOINT_PARAMETERS, NULL_GAIN_MULTIPLE, SOLE_EVIDENCE_SHARE,
};

impl Searcher<'_> {
    /// Validates a candidate on recordings of another kind than those fitted: each in turn is left out of the fit and predicted. If
    /// a recording alone shows the newest effect, its last part is predicted from its first. A single recording keeps its
    /// assessment.
    pub(crate) fn validate_candidate(
        &self,
        candidate: Candidate,
        smaller: &Score,
        plain: &[Assessment],
    ) -> Option<Candidate> {
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
        let judged: Vec<Assessment> = predicted.into_iter().collect::<Option<_>>()?;
        if judged.len() < count {
            return None;
        }
        let mut parts = whole_parts(count);
        let own: Vec<usize> = (0..count).filter(|r| alone(*r)).collect();
        own.iter().for_each(|&r| parts[r].from = FITTED_SHARE);
        Some(Candidate {
            held_out: score(&judged, &parts)?,
            held_out_before: score(plain, &parts)?,
            held_out_parts: parts,
            needed: own,
            ..candidate
        })
    }

    /// Returns whether a candidate gains more than its newest effect would gain on the noise in the loop alone.
    pub(crate) fn exceeds_null_gain(&self, candidate: &Candidate, smaller: &Score) -> bool {
        let gain = candidate.whole.energy_over(smaller) - GAIN_NEEDED;
        gain > GAIN_BEYOND_NULL
            || gain
                > NULL_GAIN_MULTIPLE
                    * mean_null_gain(self.simulator, self.pool, &candidate.fit, &candidate.assessments)
    }

    /// Predicts a recording by the candidate fitted to the others.
    fn predict_recording(&self, candidate: &Candidate, left_out: usize) -> Option<Assessment> {
        let recordings = (0..self.simulator.count()).filter(|r| *r != left_out).collect();
        let fit = self.refit_to(candidate, recordings)?;
        let near = candidate.assessments.get(left_out)?;
        let sought = self.simulator.assess_near(&fit.parameters, left_out, near)?;
        let given = self.simulator.assess_from(&fit.parameters, left_out, near)?;
        Some(if log_excess(&given) < log_excess(&sought) { given } else { sought })
    }

    /// Predicts the rest of a recording by the candidate fitted to its first part and to that of the others.
    fn continue_recording(&self, candidate: &Candidate, recording: usize) -> Option<Assessment> {
        let fit = self.refit_to(candidate, (0..self.simulator.count()).collect())?;
        let near = fit.assessment(recording).or_else(|| candidate.assessments.get(recording))?;
        self.simulator.assess_from(&fit.parameters, recording, near)
    }

    /// Fits the candidate to the first part of some recordings.
    fn refit_to(&self, candidate: &Candidate, recordings: Vec<usize>) -> Option<Fit> {
        if candidate.fit.values.len() > JOINT_PARAMETERS {
            return Some(candidate.fit.clone());
        }
        let selection = FitSelection::first_parts_for_ranking(recordings);
        self.fit(candidate.fit.effects.clone(), &candidate.fit.values, &selection, &candidate.assessments)
    }
}
