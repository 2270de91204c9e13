//! A candidate judged on what it was not fitted to: recordings of another kind, each predicted from the others.

use crate::bench::{Judged, map};
use crate::fit::{Fit, Selection};
use crate::score::{Score, score};
use crate::search::candidate::{Candidate, whole_parts};
use crate::search::plain::level;
use crate::search::select::Searcher;
use crate::tolerance::{FITTED_SHARE, JOINT_KNOBS, ONLY_THERE};

impl Searcher<'_> {
    /// The candidate judged on recordings of another kind than those fitted: each in turn is left out of the fit and
    /// predicted. A recording that alone shows the newest effect has no other kind: there its last part is predicted from the
    /// first; one recording alone stays as it was judged.
    pub(crate) fn validated(
        &self,
        candidate: Candidate,
        smaller: &Score,
        plain: &[Judged],
    ) -> Option<Candidate> {
        let count = self.bench.count();
        if count < 2 {
            return Some(candidate);
        }
        let all = candidate.whole.gain_over(smaller);
        let alone = |r: usize| {
            candidate.needed.contains(&r) || candidate.whole.gain_in(r, smaller) > ONLY_THERE * all
        };
        let predicted = map(self.pool, count, |r| {
            if alone(r) { self.continued(&candidate, r) } else { self.predicted(&candidate, r) }
        });
        let judged: Vec<Judged> = predicted.into_iter().collect::<Option<_>>()?;
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

    /// A recording as the candidate fitted to the others predicts it.
    fn predicted(&self, candidate: &Candidate, left_out: usize) -> Option<Judged> {
        let recordings = (0..self.bench.count()).filter(|r| *r != left_out).collect();
        let fit = self.fitted_again(candidate, recordings)?;
        let near = candidate.stances.get(left_out)?;
        let sought = self.bench.judge_near(&fit.parameters, left_out, near)?;
        let given = self.bench.glance(&fit.parameters, left_out, near)?;
        Some(if level(&given) < level(&sought) { given } else { sought })
    }

    /// A recording as the candidate fitted to its first part, and to that of the others, continues it.
    fn continued(&self, candidate: &Candidate, recording: usize) -> Option<Judged> {
        let fit = self.fitted_again(candidate, (0..self.bench.count()).collect())?;
        let near = fit.stance(recording).or_else(|| candidate.stances.get(recording))?;
        self.bench.glance(&fit.parameters, recording, near)
    }

    /// The candidate fitted to the first part of some recordings.
    fn fitted_again(&self, candidate: &Candidate, recordings: Vec<usize>) -> Option<Fit> {
        if candidate.fit.values.len() > JOINT_KNOBS {
            return Some(candidate.fit.clone());
        }
        let selection = Selection::trying(recordings);
        self.fit(candidate.fit.effects.clone(), &candidate.fit.values, &selection, &candidate.stances)
    }
}
