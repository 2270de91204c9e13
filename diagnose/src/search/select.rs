//! Which effects, together, explain the recordings: stepwise, with swaps, judged on what was not fitted.
//!
//! At every stage the best looks are fitted to the recordings in which they show most; the best of those to the first part
//! of every recording. The winner must gain on the rest, and must not harm a recording of another kind than those that it
//! was fitted to: each recording in turn is left out of the fit and predicted.

use std::sync::atomic::{AtomicUsize, Ordering};

use counterpoise_models::Parameters;

use crate::bench::{Bench, Judged, Pool, map};
use crate::chance::by_chance;
use crate::fit::{Fit, Problem, Selection};
use crate::library::Effect;
use crate::look::{Look, Reach, Scene, Sizes, first_look, is_close, is_ripple};
use crate::scan::{judged_gap, repeats};
use crate::score::{Score, judge, score};
pub use crate::search::candidate::{Candidate, Stage};
use crate::search::candidate::{
    finalists, held_out_parts, ranked, shortlist, telling_recordings, whole_parts,
};
use crate::search::pairs::pairs;
use crate::search::plain::Plain;
use crate::search::simpler::spring_for_hose;
use crate::tolerance::{
    BEYOND_CHANCE, EFFECTS_AT_MOST, GAIN_NEEDED, JOINT_KNOBS, NO_CHANCE, PAIRS, PROMISE_SHARE, RIVALS,
    SHORTLIST, SWAP_NEEDED,
};

/// The outcome of the search.
#[derive(Debug, Clone)]
pub struct Search {
    /// The accepted effects, fitted to all recordings; none where the model as it is was kept.
    pub accepted: Option<Candidate>,
    /// Fit of the model as it was, from the starts that suit it best.
    pub before: Score,
    /// How the recordings stand to it.
    pub plain: Vec<Judged>,
    /// For each accepted effect, what was judged in its place beside the others, best first.
    pub rivals: Vec<Vec<Candidate>>,
    /// Every stage.
    pub stages: Vec<Stage>,
    /// Whether the user stopped the search.
    pub cancelled: bool,
}

/// What the search works on.
pub struct Searcher<'a> {
    /// Simulator and recordings.
    pub bench: &'a dyn Bench,
    /// Processors, progress and cancel.
    pub pool: &'a dyn Pool,
    /// The mechanism as the project file has it.
    pub base: &'a Parameters,
    /// The effects that may be named.
    pub effects: Vec<&'static Effect>,
    /// Effects with values found by other means, to be fitted from there at the first stage.
    pub seeds: Vec<(&'static Effect, Vec<f64>)>,
    /// What is known of the machine's sizes.
    pub sizes: Sizes,
}

impl Searcher<'_> {
    /// Searches for up to three effects; none where the model as it is cannot be simulated.
    pub fn search(&self) -> Option<Search> {
        let plain = self.plain()?;
        let before = score(&plain.fitted, &whole_parts(self.bench.count()))?;
        let (rivals, stages) = (Vec::new(), Vec::new());
        let mut search =
            Search { accepted: None, before, plain: plain.fitted.clone(), rivals, stages, cancelled: false };
        loop {
            let present = search.accepted.as_ref();
            let found = present.map_or(0, |c| c.fit.effects.len());
            self.pool.progress("naming", found, EFFECTS_AT_MOST);
            if found >= EFFECTS_AT_MOST {
                break;
            }
            let stage = match present {
                Some(present) => self.stage(present, Effort::Full),
                None => self.first_stage(&plain),
            };
            let smaller = present.map_or(&search.before, |c| &c.whole);
            let needed = present.map_or(&[][..], |c| &c.needed);
            let best = self.best(&stage, (smaller, needed), &search);
            search.stages.push(stage);
            let Some(best) = best else { break };
            search.accepted = Some(self.refined(self.refitted(best)));
            if self.pool.cancelled() {
                search.cancelled = true;
                break;
            }
        }
        self.swap_and_prune(&mut search);
        search.accepted = search.accepted.map(|best| self.sharpened(best));
        Some(search)
    }

    /// The best candidate of a stage, validated on recordings of another kind; none where none is worth having.
    fn best(
        &self,
        stage: &Stage,
        (smaller, needed): (&Score, &[usize]),
        search: &Search,
    ) -> Option<Candidate> {
        let worth = |c: &&Candidate| c.is_acceptable() && c.is_worth_more_than(smaller, &search.before);
        let beyond = |c: &&Candidate| self.is_beyond_chance(c, smaller);
        let mut worthy: Vec<&Candidate> = stage.candidates.iter().filter(worth).take(RIVALS).collect();
        if !self.sizes.typical {
            // what a textbook's model leaves is far above the floor: data that was not fitted decides, one more effect at its price
            let worth = |c: &Candidate| c.gain() - SWAP_NEEDED * c.fit.effects.len() as f64;
            worthy.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        }
        let best = worthy.into_iter().find(beyond)?;
        let best = Candidate { needed: needed.to_vec(), ..best.clone() };
        let validated = self.validated(best, smaller, &search.plain)?;
        (!validated.is_harmful() && validated.gain() > validated.least_gain).then_some(validated)
    }

    /// Whether a candidate gains more than its newest effect would gain on the noise in the loop alone.
    pub(crate) fn is_beyond_chance(&self, candidate: &Candidate, smaller: &Score) -> bool {
        let gain = candidate.whole.energy_over(smaller) - GAIN_NEEDED;
        gain > NO_CHANCE
            || gain > BEYOND_CHANCE * by_chance(self.bench, self.pool, &candidate.fit, &candidate.stances)
    }

    /// The first stage: the looks are taken from the starts that suit the model as it is where it is close to the recordings, from
    /// those that were sought where it is far, for there they make up for what is missing.
    fn first_stage(&self, plain: &Plain) -> Stage {
        let from = if is_close(&plain.fitted) { &plain.fitted } else { &plain.sought };
        self.looked(None, (from, &plain.fitted), Effort::Full)
    }

    /// A stage on top of a model.
    pub(crate) fn stage(&self, present: &Candidate, effort: Effort) -> Stage {
        let judged = self.standing(&present.fit.parameters, &|r| present.stances.get(r));
        match judged.or_else(|| judge(self.bench, self.pool, &present.fit.parameters)) {
            Some(judged) => self.looked(Some(present), (&judged, &judged), effort),
            None => Stage { candidates: Vec::new(), looks: Vec::new() },
        }
    }

    /// Looks at every effect on top of the present model, fits the shortlist and judges it: how the recordings stand to that model
    /// where the looks are taken, and against what the candidates are judged.
    fn looked(
        &self,
        present: Option<&Candidate>,
        (from, judged): (&[Judged], &[Judged]),
        effort: Effort,
    ) -> Stage {
        let model = present.map_or(self.base, |c| &c.fit.parameters);
        let taken: Vec<&Effect> = present.map_or(Vec::new(), |c| c.fit.effects.clone());
        let free: Vec<&'static Effect> =
            self.effects.iter().copied().filter(|e| !taken.iter().any(|t| std::ptr::eq(*t, *e))).collect();
        let reach = if present.is_none() { Reach::Whole } else { Reach::Signature };
        let (bench, pool, sizes) = (self.bench, self.pool, self.sizes);
        let scene = Scene { bench, pool, base: model, judged: from, reach, sizes };
        let looks = first_look(&scene, &free);
        let mut trials = self.trials(&looks, judged, effort);
        if taken.is_empty() {
            trials.extend(self.seeded(&scene).into_iter().map(|look| vec![look]));
        }
        let mut candidates = self.candidates(present, &trials, judged);
        let alone = candidates.iter().any(|c| c.explains() && c.is_acceptable());
        if effort == Effort::Full && taken.len() + 2 <= EFFECTS_AT_MOST && !alone {
            let found = pairs(from, &looks, PAIRS);
            let promising = found.iter().filter(|pair| is_worth_fitting(pair.explained, judged));
            let both: Vec<Vec<Look>> = promising.map(|pair| pair.looks(&looks, model).to_vec()).collect();
            candidates.extend(self.candidates(present, &both, judged));
        }
        if effort == Effort::Full && !alone {
            let spring = spring_for_hose(&candidates, taken.len(), self.bench.count());
            candidates.extend(self.candidates(present, &spring.into_iter().collect::<Vec<_>>(), judged));
        }
        let (candidates, others) = finalists(ranked(candidates));
        let finalists = self.finalists(present, candidates, judged);
        Stage { candidates: ranked(finalists.into_iter().chain(others).collect()), looks }
    }

    /// The looks that are fitted.
    fn trials(&self, looks: &[Look], judged: &[Judged], effort: Effort) -> Vec<Vec<Look>> {
        let count = if effort == Effort::Full { SHORTLIST } else { RIVALS };
        let promising = |look: &&Look| is_worth_fitting(look.explained, judged);
        shortlist(looks, count).into_iter().filter(promising).map(|look| vec![look.clone()]).collect()
    }

    /// Effects whose values are known from elsewhere.
    fn seeded(&self, scene: &Scene) -> Vec<Look> {
        let one = |(effect, start): &(&'static Effect, Vec<f64>)| {
            Look::seeded(effect, start.clone(), self.bench.count())
        };
        self.seeds.iter().map(one).chain(judged_gap(scene)).collect()
    }

    /// Fits and judges every trial.
    fn candidates(
        &self,
        present: Option<&Candidate>,
        trials: &[Vec<Look>],
        judged: &[Judged],
    ) -> Vec<Candidate> {
        let done = AtomicUsize::new(0);
        let fitted = map(self.pool, trials.len(), |t| {
            let candidate = self.candidate(present, &trials[t], judged);
            self.pool.progress("fitting", done.fetch_add(1, Ordering::Relaxed), trials.len());
            candidate
        });
        fitted.into_iter().flatten().collect()
    }

    /// Fits the present effects and one or two more to the recordings in which they show most.
    fn candidate(&self, present: Option<&Candidate>, looks: &[Look], before: &[Judged]) -> Option<Candidate> {
        let free = present.filter(|c| c.fit.values.len() <= JOINT_KNOBS);
        let mut effects = free.map_or(Vec::new(), |c| c.fit.effects.clone());
        let mut start = free.map_or(Vec::new(), |c| c.fit.values.clone());
        for look in looks {
            effects.push(look.effect);
            start.extend(&look.start);
        }
        let signature = |r: usize| looks.iter().map(|look| look.signature[r]).fold(0.0, f64::max);
        let mut recordings =
            telling_recordings(&(0..self.bench.count()).map(signature).collect::<Vec<f64>>());
        recordings.extend(present.iter().flat_map(|c| &c.needed));
        recordings.sort_unstable();
        recordings.dedup();
        let selection = Selection::trying(recordings);
        // a start that is known from elsewhere may be far from where the recordings stand to the model
        let near = if looks.iter().any(Look::is_seeded) { &[] } else { before };
        let fit = match (present, free) {
            (Some(fixed), None) => self.fit_on_top(fixed, effects, &start, &selection)?,
            _ => self.fit(effects, &start, &selection, near)?,
        };
        self.judged(fit, &selection.recordings, before)
    }

    /// The best candidates fitted to the first part of every recording.
    fn finalists(
        &self,
        present: Option<&Candidate>,
        candidates: Vec<Candidate>,
        before: &[Judged],
    ) -> Vec<Candidate> {
        let recordings: Vec<usize> = (0..self.bench.count()).collect();
        let selection = Selection::searching(recordings);
        let again = map(self.pool, candidates.len(), |c| {
            let candidate = &candidates[c];
            let fixed = present.filter(|p| p.fit.values.len() > JOINT_KNOBS);
            let effects = candidate.fit.effects[fixed.map_or(0, |f| f.fit.effects.len())..].to_vec();
            let start = &candidate.fit.values[fixed.map_or(0, |f| f.fit.values.len())..];
            let fit = match fixed {
                Some(fixed) => self.fit_on_top(fixed, effects, start, &selection),
                None => self.fit(effects, start, &selection, &[]),
            };
            let fit = fit?;
            let judged = self.standing(&fit.parameters, &|r| fit.stance(r))?;
            self.weighed(fit, &judged, &selection.recordings, before)
        });
        if again.len() < candidates.len() {
            return candidates;
        }
        let better = |(now, was): (Option<Candidate>, Candidate)| match now {
            Some(now) if now.whole.level() < was.whole.level() => now,
            _ => was,
        };
        again.into_iter().zip(candidates).map(better).collect()
    }

    /// A fit judged on everything, and on what it was not fitted to.
    fn judged(&self, fit: Fit, fitted: &[usize], before: &[Judged]) -> Option<Candidate> {
        let one = |r: usize| match fit.stance(r) {
            Some(own) => self.bench.glance(&fit.parameters, r, own),
            None => self.bench.judge_near(&fit.parameters, r, &before[r].stance()),
        };
        let judged: Vec<Judged> =
            map(self.pool, before.len(), one).into_iter().collect::<Option<Vec<Judged>>>()?;
        if judged.len() < before.len() {
            return None;
        }
        self.weighed(fit, &judged, fitted, before)
    }

    /// How every recording stands to a mechanism, from the start that was fitted with it where there is one.
    pub(crate) fn standing<'n>(
        &self,
        parameters: &Parameters,
        known: &(dyn Fn(usize) -> Option<&'n Judged> + Sync),
    ) -> Option<Vec<Judged>> {
        let one = |r: usize| match known(r) {
            Some(own) => self.bench.glance(parameters, r, own),
            None => self.bench.judge(parameters, r),
        };
        let judged = map(self.pool, self.bench.count(), one);
        (judged.len() == self.bench.count()).then(|| judged.into_iter().collect::<Option<_>>()).flatten()
    }

    /// A fit with how every recording stands to it, as a candidate; none of a ripple that does not repeat.
    fn weighed(&self, fit: Fit, judged: &[Judged], fitted: &[usize], before: &[Judged]) -> Option<Candidate> {
        if !repeats(self.bench, &fit) {
            return None;
        }
        let parts = held_out_parts(self.bench.count(), fitted);
        Some(Candidate {
            whole: score(judged, &whole_parts(self.bench.count()))?,
            held_out: score(judged, &parts)?,
            held_out_before: score(before, &parts)?,
            held_out_parts: parts,
            stances: judged.iter().map(Judged::stance).collect(),
            needed: Vec::new(),
            least_gain: self.sizes.gain_needed(),
            fit,
        })
    }

    /// Fits new effects while those of a model with many parameters stay as they are.
    fn fit_on_top(
        &self,
        fixed: &Candidate,
        effects: Vec<&'static Effect>,
        start: &[f64],
        selection: &Selection,
    ) -> Option<Fit> {
        let base = &fixed.fit.parameters;
        let stances = &fixed.stances;
        let problem = Problem { bench: self.bench, pool: self.pool, selection, base, effects, stances };
        let mut fit = problem.fit(start)?;
        fit.effects.splice(0..0, fixed.fit.effects.iter().copied());
        fit.values.splice(0..0, fixed.fit.values.iter().copied());
        Some(fit)
    }

    pub(crate) fn fit(
        &self,
        effects: Vec<&'static Effect>,
        start: &[f64],
        selection: &Selection,
        stances: &[Judged],
    ) -> Option<Fit> {
        let (bench, pool, base) = (self.bench, self.pool, self.base);
        let problem = Problem { bench, pool, selection, base, effects, stances };
        let fit = problem.fit(start)?;
        Some(snapped(&problem, fit))
    }

    pub(crate) fn whole_score(&self, parameters: &Parameters) -> Option<Score> {
        score(&judge(self.bench, self.pool, parameters)?, &whole_parts(self.bench.count()))
    }
}

/// How widely a stage looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Effort {
    /// For the next effect.
    Full,
    /// For what could stand in the place of an effect that was found.
    Rivals,
}

/// Whether a share of the residual's power could gain what an effect must, were all residuals independent; where the
/// model is far from the recordings, a signature says too little to leave an effect out.
fn is_worth_fitting(explained: f64, judged: &[Judged]) -> bool {
    let samples: usize = judged.iter().flat_map(|j| &j.misfits).map(|m| m.residual.len()).sum();
    !is_close(judged) || 0.5 * samples as f64 * explained > PROMISE_SHARE * GAIN_NEEDED
}

/// A ripple's order that came out close to a whole number is that whole number: gears and poles are counted.
fn snapped(problem: &Problem, fit: Fit) -> Fit {
    let mut start = fit.values.clone();
    let mut first = 0;
    let mut moved = false;
    for effect in &fit.effects {
        if is_ripple(effect) && (start[first + 1] / start[first + 1].round() - 1.0).abs() < 0.004 {
            start[first + 1] = start[first + 1].round();
            moved = true;
        }
        first += effect.knobs.len();
    }
    if !moved {
        return fit;
    }
    match problem.fit(&start) {
        Some(again) if again.cost < fit.cost * 1.01 => again,
        _ => fit,
    }
}
