//! Effects whose size the recordings do not tell from none: no name rests on them.

use crate::fitting::output_error::{FitSelection, confidence_intervals, parameters_of};
use crate::selection::candidate::FittedCandidate;
use crate::selection::outcome::SearchOutcome;
use crate::selection::searcher::Searcher;
use crate::tolerance::{AMBIGUOUS, EXPLAINED, SEARCH_ITERATIONS};

impl Searcher<'_> {
    /// Drops effects from the accepted model as long as the 95 % interval of one's size contains the model's own value and the others alone
    /// still explain the recordings, or lose less than decides between two candidates. An only one goes if the model as it was explains them.
    pub(crate) fn drop_undetermined(&self, search: &mut SearchOutcome) {
        while let Some(best) = &search.accepted {
            let count = best.fit.effects.len();
            if count == 1
                && search.baseline.score.largest_excess() < EXPLAINED
                && self.is_undetermined(best, 0)
            {
                (search.accepted, search.rivals) = (None, Vec::new());
                return;
            }
            // the latest first: two effects that only cancel each other leave no interval of the others either
            let undetermined = (0..count).rev().filter(|i| count > 1 && self.is_undetermined(best, *i));
            let mut spared = undetermined.filter_map(|index| {
                let simpler = self.without_effect(best, index, search)?;
                let explains = simpler.whole.largest_excess() < EXPLAINED;
                (explains || simpler.whole.loss_against(&best.whole) <= AMBIGUOUS).then_some((index, simpler))
            });
            let Some((index, simpler)) = spared.next() else { return };
            if index < search.rivals.len() {
                search.rivals.remove(index);
            }
            search.accepted = Some(simpler);
        }
    }

    /// Returns whether the interval of an effect's size, its first parameter, contains the value of the model as it was.
    fn is_undetermined(&self, model: &FittedCandidate, index: usize) -> bool {
        let samples: f64 = model.whole.cells.iter().map(|cell| cell.samples).sum();
        let independent: f64 = model.whole.cells.iter().map(|cell| cell.worth).sum();
        let bounds = confidence_intervals(&model.fit, samples as usize, samples / independent.max(1.0));
        let first = parameters_of(&model.fit.effects[..index]).len();
        let Some([low, high]) = bounds.get(first).copied() else { return false };
        let before = model.fit.effects[index].parameters[0].read(self.base);
        (low..=high).contains(&before)
    }

    /// Returns the model without one of its effects, fitted to all recordings and validated.
    fn without_effect(
        &self,
        best: &FittedCandidate,
        index: usize,
        search: &SearchOutcome,
    ) -> Option<FittedCandidate> {
        let (mut effects, mut start) = (best.fit.effects.clone(), best.fit.values.clone());
        let first = parameters_of(&effects[..index]).len();
        let dropped = effects.remove(index);
        start.drain(first..first + dropped.parameters.len());
        let selection =
            FitSelection { iterations: SEARCH_ITERATIONS, ..FitSelection::all(self.simulator.count()) };
        let fit = self.fit(effects, &start, &selection, &best.assessments)?;
        let simpler = self.replace_fit(best, fit)?;
        self.validate_candidate(simpler, &search.baseline.score, &search.baseline.fitted)
    }
}
