//! Which effects, together, explain the recordings: stepwise, with swaps, judged on what was not fitted.

use std::sync::atomic::{AtomicUsize, Ordering};

use counterpoise_models::Parameters;

use crate::bench::{Bench, Judged, Pool, Span, map};
use crate::fit::{Fit, Problem, Selection, knobs};
use crate::library::{Effect, refinement};
use crate::look::{Look, Scene, first_look, is_ripple, pairs};
use crate::score::{Part, Score, judge, judge_near, score};
use crate::tolerance::{
    EFFECT_PRICE, EFFECTS_AT_MOST, EXPLAINED, FITTED_SHARE, GAIN_NEEDED, JOINT_KNOBS, NOTHING_LEFT, PAIRS,
    PARAMETER_PRICE, PRUNE_SHARE, RIVALS, SEARCH_ITERATIONS, SHARE_NEEDED, SHORTLIST, SWAP_NEEDED,
};

/// A candidate that was fitted and judged.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// All effects of the model, fitted together; the new one is the last.
    pub fit: Fit,
    /// Fit of every recording, whole.
    pub whole: Score,
    /// Fit of what the candidate was not fitted to.
    pub held_out: Score,
    /// Fit of the model before, on the same data.
    pub held_out_before: Score,
    /// What the candidate was not fitted to.
    pub held_out_parts: Vec<Part>,
    /// How the recordings stand to it, without their residuals.
    pub stances: Vec<Judged>,
}

impl Candidate {
    /// The effect that the candidate adds.
    pub fn newest(&self) -> Option<&'static Effect> {
        self.fit.effects.last().copied()
    }

    /// Puts the newest effect at `index` of the list.
    fn move_last_to(&mut self, index: usize) {
        let Some(newest) = self.fit.effects.pop() else { return };
        let first = knobs(&self.fit.effects[..index]).len();
        let tail = self.fit.values.split_off(self.fit.values.len() - newest.knobs.len());
        self.fit.values.splice(first..first, tail);
        self.fit.effects.insert(index, newest);
    }

    /// Distance from the floor, with a price for each effect and for each parameter beyond the second.
    pub fn ranking(&self) -> f64 {
        let parameters = self.fit.values.len().saturating_sub(2) as f64;
        self.whole.distance() + PARAMETER_PRICE * parameters + EFFECT_PRICE * self.fit.effects.len() as f64
    }

    /// Whether nothing is left that a further effect could explain.
    fn explains(&self) -> bool {
        self.whole.worst() < EXPLAINED && self.whole.distance() < NOTHING_LEFT
    }

    fn has_same_effects(&self, other: &Self) -> bool {
        let all = |c: &Self| {
            let mut labels: Vec<*const Effect> =
                c.fit.effects.iter().map(|e| std::ptr::from_ref(*e)).collect();
            labels.sort_unstable();
            labels
        };
        all(self) == all(other)
    }
}

/// One stage: the candidates that were judged, best first, and what the first look said.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Candidates, best first.
    pub candidates: Vec<Candidate>,
    /// First look, best first.
    pub looks: Vec<Look>,
}

impl Stage {
    /// Whether a candidate of this stage added the effect that is all of a model.
    fn contains(&self, model: &Candidate) -> bool {
        let effect = model.newest();
        let same = |c: &Candidate| c.newest().zip(effect).is_some_and(|(a, b)| std::ptr::eq(a, b));
        self.candidates.iter().any(|c| c.fit.effects.len() == 1 && same(c))
    }

    /// The candidates of one effect alone.
    fn singles(&self) -> Vec<Candidate> {
        self.adding_one(0)
    }

    /// The candidates that add one effect to a number of present ones.
    fn adding_one(&self, present: usize) -> Vec<Candidate> {
        self.candidates.iter().filter(|c| c.fit.effects.len() == present + 1).cloned().collect()
    }
}

/// The outcome of the search.
#[derive(Debug, Clone)]
pub struct Search {
    /// The accepted effects, fitted to all recordings; none where the model as it is was kept.
    pub accepted: Option<Candidate>,
    /// Fit of the model as it was.
    pub before: Score,
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
}

impl Searcher<'_> {
    /// Searches for up to three effects; none where the model as it is cannot be simulated.
    pub fn search(&self) -> Option<Search> {
        let before = self.whole_score(self.base)?;
        let mut search =
            Search { accepted: None, before, rivals: Vec::new(), stages: Vec::new(), cancelled: false };
        loop {
            let present = search.accepted.as_ref();
            let found = present.map_or(0, |c| c.fit.effects.len());
            self.pool.progress("naming", found, EFFECTS_AT_MOST);
            let explained = present.is_some_and(Candidate::explains);
            if found >= EFFECTS_AT_MOST || explained {
                break;
            }
            let stage = self.stage(present, Effort::Full);
            let best = stage.candidates.iter().find(|c| self.acceptable(c)).cloned();
            search.stages.push(stage);
            let Some(best) = best else { break };
            search.accepted = Some(self.refined(self.refitted(best)));
            if self.pool.cancelled() {
                search.cancelled = true;
                break;
            }
        }
        self.swap_and_prune(&mut search);
        Some(search)
    }

    /// Looks at every effect on top of the present model, fits the shortlist and judges it.
    fn stage(&self, present: Option<&Candidate>, effort: Effort) -> Stage {
        let model = present.map_or(self.base, |c| &c.fit.parameters);
        let Some(judged) = judge(self.bench, self.pool, model) else {
            return Stage { candidates: Vec::new(), looks: Vec::new() };
        };
        let taken: Vec<&Effect> = present.map_or(Vec::new(), |c| c.fit.effects.clone());
        let free: Vec<&'static Effect> =
            self.effects.iter().copied().filter(|e| !taken.iter().any(|t| std::ptr::eq(*t, *e))).collect();
        let scene = Scene { bench: self.bench, pool: self.pool, base: model, judged: &judged };
        let looks = first_look(&scene, &free);
        let seeded = |(effect, start): &(&'static Effect, Vec<f64>)| {
            Look::seeded(effect, start.clone(), self.bench.count())
        };
        let seeds: Vec<Look> = self.seeds.iter().filter(|_| taken.is_empty()).map(seeded).collect();
        let count = if effort == Effort::Full { SHORTLIST } else { RIVALS };
        let mut singles: Vec<Vec<&Look>> =
            shortlist(&looks, count).into_iter().map(|look| vec![look]).collect();
        singles.extend(seeds.iter().map(|look| vec![look]));
        let mut candidates = self.candidates(present, &singles, &judged);
        let alone = candidates.iter().any(|c| c.explains() && self.acceptable(c));
        if effort == Effort::Full && taken.len() + 2 <= EFFECTS_AT_MOST && !alone {
            let found = pairs(&judged, &looks, PAIRS);
            let both: Vec<Vec<&Look>> = found.iter().map(|p| p.members.map(|i| &looks[i]).to_vec()).collect();
            candidates.extend(self.candidates(present, &both, &judged));
        }
        candidates.sort_by(|a, b| a.ranking().total_cmp(&b.ranking()));
        let mut kept: Vec<Candidate> = Vec::new();
        for candidate in candidates {
            if !kept.iter().any(|k| k.has_same_effects(&candidate)) {
                kept.push(candidate);
            }
        }
        Stage { candidates: kept, looks }
    }

    /// Fits and judges every trial.
    fn candidates(
        &self,
        present: Option<&Candidate>,
        trials: &[Vec<&Look>],
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

    /// Fits the present effects and one or two more to part of the data, and judges the result on the rest.
    fn candidate(
        &self,
        present: Option<&Candidate>,
        looks: &[&Look],
        before: &[Judged],
    ) -> Option<Candidate> {
        let free = present.filter(|c| c.fit.values.len() <= JOINT_KNOBS);
        let mut effects = free.map_or(Vec::new(), |c| c.fit.effects.clone());
        let mut start = free.map_or(Vec::new(), |c| c.fit.values.clone());
        for look in looks {
            effects.push(look.effect);
            start.extend(&look.start);
        }
        let signature = |r: usize| looks.iter().map(|look| look.signature[r]).fold(0.0, f64::max);
        let fitted = fitted_recordings(&(0..self.bench.count()).map(signature).collect::<Vec<f64>>());
        let parts = held_out_parts(self.bench.count(), &fitted);
        let selection = Selection { recordings: fitted, span: Span::Head, iterations: SEARCH_ITERATIONS };
        let fit = match (present, free) {
            (Some(fixed), None) => self.fit_on_top(fixed, effects, &start, &selection)?,
            _ => self.fit(effects, &start, &selection, before)?,
        };
        let judged = judge_near(self.bench, self.pool, &fit.parameters, before)?;
        Some(Candidate {
            whole: score(&judged, &whole_parts(self.bench.count()))?,
            held_out: score(&judged, &parts)?,
            held_out_before: score(before, &parts)?,
            held_out_parts: parts,
            stances: judged.iter().map(Judged::stance).collect(),
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

    fn fit(
        &self,
        effects: Vec<&'static Effect>,
        start: &[f64],
        selection: &Selection,
        stances: &[Judged],
    ) -> Option<Fit> {
        let (bench, pool, base) = (self.bench, self.pool, self.base);
        let problem = Problem { bench, pool, selection, base, effects, stances };
        let fit = problem.fit(start)?;
        Some(self.snapped(&problem, fit))
    }

    /// A ripple's order that came out close to a whole number is that whole number: gears and poles are counted.
    fn snapped(&self, problem: &Problem, fit: Fit) -> Fit {
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

    fn whole_score(&self, parameters: &Parameters) -> Option<Score> {
        score(&judge(self.bench, self.pool, parameters)?, &whole_parts(self.bench.count()))
    }

    /// Whether a candidate gains enough, on data that it was not fitted to, harms no channel and keeps its bounds.
    fn acceptable(&self, candidate: &Candidate) -> bool {
        let gain = candidate.held_out.gain_over(&candidate.held_out_before);
        let before = candidate.held_out_before.distance();
        let share = (before - candidate.held_out.distance()) / before.max(0.02);
        gain > GAIN_NEEDED && share > SHARE_NEEDED && !harmful(candidate) && within_bounds(&candidate.fit)
    }

    /// The accepted effects with those in a coarse form refined, where that explains more.
    fn refined(&self, candidate: Candidate) -> Candidate {
        let finer = |effect: &&'static Effect| refinement(effect).unwrap_or(effect);
        let effects: Vec<&'static Effect> = candidate.fit.effects.iter().map(finer).collect();
        if effects.iter().zip(&candidate.fit.effects).all(|(a, b)| std::ptr::eq(*a, *b)) {
            return candidate;
        }
        let start: Vec<f64> = effects.iter().flat_map(|e| e.values(&candidate.fit.parameters)).collect();
        let selection = Selection { iterations: SEARCH_ITERATIONS, ..Selection::all(self.bench.count()) };
        let fit = self.fit(effects, &start, &selection, &candidate.stances);
        let judged = fit.and_then(|fit| Some((self.whole_score(&fit.parameters)?, fit)));
        match judged {
            Some((whole, fit)) if whole.distance() < candidate.whole.distance() => {
                Candidate { fit, whole, ..candidate }
            }
            _ => candidate,
        }
    }

    /// The accepted effects fitted once more, to everything.
    fn refitted(&self, candidate: Candidate) -> Candidate {
        let selection = Selection { iterations: SEARCH_ITERATIONS, ..Selection::all(self.bench.count()) };
        let (effects, stances) = (candidate.fit.effects.clone(), &candidate.stances);
        let again = self.fit(effects, &candidate.fit.values, &selection, stances);
        let judged = again.and_then(|fit| Some((self.whole_score(&fit.parameters)?, fit)));
        match judged {
            Some((whole, fit)) if whole.distance() <= candidate.whole.distance() + 0.01 => {
                Candidate { fit, whole, ..candidate }
            }
            _ => candidate,
        }
    }

    /// Replaces an effect where another explains more beside the rest, and drops one that the others make idle.
    fn swap_and_prune(&self, search: &mut Search) {
        let Some(mut best) = search.accepted.take() else { return };
        self.prune(&mut best, search.before.distance());
        if let (1, Some(stage)) = (best.fit.effects.len(), search.stages.iter().find(|s| s.contains(&best))) {
            search.rivals = vec![stage.singles()];
            search.accepted = Some(best);
            return;
        }
        for index in 0..best.fit.effects.len() {
            let Some(without) = self.without(&best, index).filter(|_| !self.pool.cancelled()) else {
                search.rivals.push(Vec::new());
                continue;
            };
            let rivals = self.stage(Some(&without), Effort::Rivals).adding_one(without.fit.effects.len());
            let better =
                rivals.iter().find(|c| self.acceptable(c) && c.ranking() < best.ranking() - SWAP_NEEDED);
            if let Some(better) = better {
                let mut swapped = self.refitted(better.clone());
                swapped.move_last_to(index);
                best = swapped;
            }
            search.rivals.push(rivals);
        }
        search.accepted = Some(best);
    }

    /// Drops effects without which the rest explains the recordings as well.
    fn prune(&self, best: &mut Candidate, before: f64) {
        let mut index = 0;
        while best.fit.effects.len() > 1 && index < best.fit.effects.len() && !self.pool.cancelled() {
            let Some(without) = self.without(best, index) else { return };
            let lost = without.whole.distance() - best.whole.distance();
            if lost < PRUNE_SHARE * before {
                *best = without;
            } else {
                index += 1;
            }
        }
    }

    fn without(&self, candidate: &Candidate, index: usize) -> Option<Candidate> {
        let mut effects = candidate.fit.effects.clone();
        let first = knobs(&effects[..index]).len();
        let mut start = candidate.fit.values.clone();
        start.drain(first..first + effects[index].knobs.len());
        effects.remove(index);
        let all = (0..self.bench.count()).collect();
        let selection = Selection { recordings: all, span: Span::Head, iterations: SEARCH_ITERATIONS };
        let fit = self.fit(effects, &start, &selection, &candidate.stances)?;
        let whole = self.whole_score(&fit.parameters)?;
        Some(Candidate { fit, whole, ..candidate.clone() })
    }
}

/// How widely a stage looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effort {
    /// For the next effect.
    Full,
    /// For what could stand in the place of an effect that was found.
    Rivals,
}

/// The best looks: so many effects, the best two of them from two starts.
fn shortlist(looks: &[Look], count: usize) -> Vec<&Look> {
    let mut picked: Vec<&Look> = Vec::new();
    let mut effects = 0;
    for look in looks {
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

/// The half of the recordings in which the effect shows most: those are fitted.
fn fitted_recordings(signature: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..signature.len()).collect();
    order.sort_by(|&a, &b| signature[b].total_cmp(&signature[a]));
    order.truncate(signature.len().div_ceil(2));
    order.sort_unstable();
    order
}

/// The other recordings whole, and the end of the fitted ones.
fn held_out_parts(count: usize, fitted: &[usize]) -> Vec<Part> {
    let part = |r| Part { recording: r, from: if fitted.contains(&r) { FITTED_SHARE } else { 0.0 }, to: 1.0 };
    (0..count).map(part).collect()
}

fn whole_parts(count: usize) -> Vec<Part> {
    (0..count).map(|r| Part { recording: r, from: 0.0, to: 1.0 }).collect()
}

/// Whether a channel that was not fitted gets clearly worse.
fn harmful(candidate: &Candidate) -> bool {
    let cells = candidate.held_out.cells.iter().zip(&candidate.held_out_before.cells);
    cells.into_iter().any(|(after, before)| after.excess > 1.15 * before.excess.max(1.0))
}

/// Whether every knob stayed off the bounds of physical sense.
fn within_bounds(fit: &Fit) -> bool {
    knobs(&fit.effects).iter().zip(&fit.values).all(|(knob, &value)| {
        let [low, high] = knob.bounds;
        let margin = 1e-3 * (high - low).abs().min(value.abs());
        (value > low + margin || low == 0.0) && value < high - margin
    })
}
