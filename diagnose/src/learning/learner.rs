//! The fit of free functions in the simulator: ranked by what they promise, compared by what they predict, the best one fitted as smooth
//! as held-out stretches ask for.

use counterpoise_linalg::inverse;
use counterpoise_models::{LearnedElement, LearnedPlace, Parameters, RegimeVariable};

use crate::findings::channel_fits::{PooledFits, fits_by_channel};
use crate::fitting::output_error::{
    EffectFit, FitSelection, Preference, Problem, parameters_of, value_half_widths,
};
use crate::fitting::score::{RecordingPart, Score, score_parts};
use crate::learning::held_out_stretches::{HeldOutEquations, flat_preferences, preferences};
use crate::learning::reading::{CurveReading, read_curve};
use crate::learning::templates::{Template, TemplateContext, is_at};
use crate::learning::visited_ranges::{Reach, VisitedRanges};
use crate::library::{Component, Effect, has_free_points, learned_element, learned_values_in};
use crate::localisation::error_map::MapCell;
use crate::recording::series::correlation_time;
use crate::selection::candidate::{FittedCandidate, whole_parts};
use crate::selection::searcher::Searcher;
use crate::simulator_access::{Assessment, Span};
use crate::tolerance::learning::{
    COMPARED_ITERATIONS, EVEN_SHARE, FINAL_ITERATIONS, FINE_POINTS, FITTED_CANDIDATES, FITTED_POINTS,
    FUNCTIONS_AT_MOST, LEAST_PART, LEAST_POWER, LEAST_PROMISE, PROMISE_OF_BEST, ROUGHNESS, SCREENED_POINTS,
    USUAL_ROUGHNESS,
};
use crate::tolerance::{EXPLAINED, FITTED_SHARE, RIVAL_DECAY};

/// Recordings and model to which free functions are fitted.
pub struct LearningTask<'a> {
    /// Simulator, processors and sizes.
    pub searcher: &'a Searcher<'a>,
    /// The mechanism: as the project has it, or with the effects that were named.
    pub base: &'a Parameters,
    /// The assessments of the recordings for it, with residuals.
    pub before: &'a [Assessment],
    /// The localisation.
    pub map: &'a [MapCell],
    /// The components that may contain what the model lacks.
    pub components: &'a [Component],
    /// Values that the recordings visit.
    pub visited: &'a VisitedRanges,
}

/// A model without a name: free functions that were fitted in the simulator.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedModel {
    /// The functions, the one that explains most first.
    pub parts: Vec<LearnedPart>,
    /// Largest RMS error over its noise floor on held-out data, before and after.
    pub worst_held_out: [f64; 2],
    /// Share of the power of the residual that is left on held-out data, mean over recordings and channels.
    pub power_left: f64,
    /// Probability that the first function acts at its place, of the places at which one was tried: by what each predicts of held-out data.
    pub place_probability: f64,
    /// All data, with the functions.
    pub after: PooledFits,
    /// Held-out data, the model before.
    pub held_out_before: PooledFits,
    /// Held-out data, the functions fitted to the rest.
    pub held_out_after: PooledFits,
}

/// One free function.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedPart {
    /// The function, with its band and the recordings' coverage.
    pub element: LearnedElement,
    /// Log-likelihood that it gains on held-out data.
    pub log_likelihood_gain: f64,
    /// Simple form of its curve; `None` if there is none.
    pub reading: Option<CurveReading>,
}

/// A function that was fitted, with the model that has it.
#[derive(Clone)]
pub(crate) struct FunctionFit {
    pub candidate: FittedCandidate,
    /// For each function, how rough it may be and the cost's curvature by its values.
    smoothness: Vec<Smoothness>,
    /// The places at which the first function was tried, with what it gains there.
    tried: Vec<TriedPlace>,
}

/// A place at which a function was tried in the simulator.
#[derive(Debug, Clone, Copy)]
struct TriedPlace {
    place: LearnedPlace,
    /// Log-likelihood that the best function there gains on held-out data.
    log_likelihood_gain: f64,
}

/// Values of a sensor's error that other sensors show.
struct ShownStart {
    values: Vec<f64>,
    /// Share of the residual's power that they remove.
    share: f64,
}

/// Free functions that were fitted, with what each gains.
pub(crate) struct FittedFunctions {
    pub learned: FunctionFit,
    pub gains: Vec<f64>,
}

/// The data that functions are fitted to, and those that they are judged by.
pub(crate) struct DataSplit {
    pub selection: FitSelection,
    pub parts: Vec<RecordingPart>,
}

/// The roughness that a function may have.
#[derive(Debug, Clone, Copy)]
struct Smoothness {
    roughness: f64,
    curvature: f64,
}

impl FunctionFit {
    /// Returns the same functions with another fit of them.
    pub(crate) fn with_candidate(&self, candidate: FittedCandidate) -> Self {
        Self { candidate, ..self.clone() }
    }
}

/// Fits free functions; returns the model and the mechanism with them, or `None` if none explains enough.
pub fn learn_functions(task: &LearningTask) -> Option<(LearnedModel, Parameters)> {
    let first = task.with_simple_form(task.one_function()?);
    task.with_more(first).model(task)
}

impl FittedFunctions {
    /// Returns the model and the mechanism with it.
    pub fn model(&self, task: &LearningTask) -> Option<(LearnedModel, Parameters)> {
        let candidate = &self.learned.candidate;
        let model = task.model(candidate, &self.gains)?;
        let place_probability = self.place_probability();
        let mut improved = candidate.fit.parameters.clone();
        let fitted = improved.learned.len().saturating_sub(model.parts.len());
        for (element, part) in improved.learned[fitted..].iter_mut().zip(&model.parts) {
            element.clone_from(&part.element);
        }
        Some((LearnedModel { place_probability, ..model }, improved))
    }

    /// Returns the probability of the first function's place among those that were tried.
    fn place_probability(&self) -> f64 {
        let effect = self.learned.candidate.fit.effects.first();
        let Some(own) = effect.and_then(|e| learned_element(e)).map(|element| element.place) else {
            return 0.0;
        };
        let best = |place: LearnedPlace| {
            let here = self.learned.tried.iter().filter(|tried| tried.place == place);
            here.map(|tried| tried.log_likelihood_gain).fold(f64::NEG_INFINITY, f64::max)
        };
        let weight = |place: LearnedPlace| (RIVAL_DECAY * (best(place) - best(own)).min(0.0)).exp();
        let rivals: f64 = LearnedPlace::ALL.into_iter().filter(|place| *place != own).map(weight).sum();
        1.0 / (1.0 + rivals)
    }

    /// Returns whether nothing is left that a further function could explain.
    fn explains(&self) -> bool {
        self.learned.candidate.whole.largest_excess() < EXPLAINED
    }
}

impl LearningTask<'_> {
    /// Returns the one free function that predicts held-out data best; `None` if none is worth having.
    pub(crate) fn one_function(&self) -> Option<FittedFunctions> {
        let learned = self.next(None)?;
        let gains = vec![learned.candidate.gain()];
        Some(FittedFunctions { learned, gains })
    }

    /// Adds free functions to those that were fitted until they explain the recordings or none is worth having.
    pub(crate) fn with_more(&self, mut found: FittedFunctions) -> FittedFunctions {
        while found.gains.len() < FUNCTIONS_AT_MOST && !found.explains() && !self.searcher.pool.is_cancelled()
        {
            let Some(next) = self.next(Some(&found.learned)) else { break };
            found.gains.push(next.candidate.gain() - found.gains.iter().sum::<f64>());
            found.learned = next;
        }
        found
    }

    /// Returns the effective number of parameters of free functions: the trace of the matrix that maps residuals to fitted values (Hastie,
    /// Tibshirani, Friedman 2009, 5.4.1), which smoothness makes smaller than the number of points.
    pub(crate) fn effective_parameters(&self, learned: &FunctionFit) -> f64 {
        let fit = &learned.candidate.fit;
        let preferences = self.preferences(&fit.effects, &learned.smoothness, Span::Whole);
        let cells = &learned.candidate.whole.cells;
        let residuals = cells.iter().map(|cell| cell.samples).sum::<f64>() + preferences.len() as f64;
        let Ok(covariance) = inverse(&fit.information) else { return fit.values.len() as f64 };
        let sizes: Vec<f64> = parameters_of(&fit.effects).iter().map(|parameter| parameter.size).collect();
        let one = |preference: &Preference| -> f64 {
            let all = preference.weights.iter().map(|(j, weight)| (*j, weight * sizes[*j]));
            let row: Vec<(usize, f64)> = all.collect();
            let pairs = row.iter().flat_map(|(i, a)| row.iter().map(move |(j, b)| (i, j, a * b)));
            pairs.map(|(i, j, product)| product * covariance[(*i, *j)]).sum()
        };
        let held: f64 = preferences.iter().map(one).sum::<f64>() / residuals.max(1.0);
        (fit.values.len() as f64 - held).max(1.0)
    }

    /// Returns the model with one more function; `None` if none is worth having.
    fn next(&self, present: Option<&FunctionFit>) -> Option<FunctionFit> {
        let searcher = self.searcher;
        let now = present.map_or(self.base, |p| &p.candidate.fit.parameters);
        let assessed = match present {
            Some(p) => searcher.assess_model(now, &|r| p.candidate.assessments.get(r))?,
            None => self.before.to_vec(),
        };
        let context = self.context(now);
        let ranked = self.rank_templates(&context, &assessed);
        let mut best: Option<(Template, FunctionFit)> = None;
        let mut places = Vec::new();
        for (template, _) in ranked {
            let Some(tried) = self.try_template(&context, template, present, &assessed) else { continue };
            places.push(TriedPlace { place: template.place, log_likelihood_gain: tried.candidate.gain() });
            if best.as_ref().is_none_or(|(_, b)| self.is_better(&tried, b, template)) {
                best = Some((template, tried));
            }
            if searcher.pool.is_cancelled() {
                return None;
            }
        }
        let (template, coarse) = best?;
        let fine = self.refine_element(&context, template, &coarse, present, &assessed);
        let chosen = fine.filter(|fine| merit(&fine.candidate) > merit(&coarse.candidate)).unwrap_or(coarse);
        let tried = present.map_or(places, |p| p.tried.clone());
        let chosen = FunctionFit { tried, ..chosen };
        let worth = self.worth(&chosen.candidate, present.map(|p| &p.candidate));
        worth.then(|| self.fitted_to_all(chosen))
    }

    fn context<'c>(&'c self, base: &'c Parameters) -> TemplateContext<'c> {
        let motor_turns = self.searcher.sizes.motor_turns;
        TemplateContext {
            base,
            visited: self.visited,
            map: self.map,
            components: self.components,
            motor_turns,
        }
    }

    /// Returns the templates that promise most on held-out stretches.
    fn rank_templates(&self, context: &TemplateContext, assessed: &[Assessment]) -> Vec<(Template, f64)> {
        let templates = context.all();
        let mut all = Vec::new();
        for (k, template) in templates.iter().enumerate() {
            self.searcher.pool.progress("modelling", k, templates.len());
            if self.searcher.pool.is_cancelled() {
                break;
            }
            let promise = self.promise(context, *template, assessed);
            all.extend(
                promise.filter(|promise| *promise > LEAST_PROMISE).map(|promise| (*template, promise)),
            );
        }
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let most = all.first().map_or(0.0, |(_, promise)| *promise);
        all.retain(|(_, promise)| *promise > PROMISE_OF_BEST * most);
        all.truncate(FITTED_CANDIDATES);
        all
    }

    /// Returns the share of the residual's power that a template promises to remove on held-out stretches.
    fn promise(&self, context: &TemplateContext, template: Template, assessed: &[Assessment]) -> Option<f64> {
        let element = context.element(template, SCREENED_POINTS)?;
        let effect = context.effect(&element);
        let selection = FitSelection::all(assessed.len());
        let problem = self.problem(context.base, vec![effect], &selection, assessed, &[]);
        let slopes = problem.slopes(&element.values, assessed)?;
        let held_out = HeldOutEquations::new(&slopes, assessed);
        let shares = ROUGHNESS.iter().map(|rough| held_out.share(&element, &element.values, *rough));
        let shown =
            self.shown_start(context, &element, assessed).map_or(f64::NEG_INFINITY, |shown| shown.share);
        Some(shares.fold(shown, f64::max))
    }

    /// Returns the values that redundant sensors show of an element, and the share of the residual's power that they remove; `None` if no
    /// sensor shows them.
    fn shown_start(
        &self,
        context: &TemplateContext,
        element: &LearnedElement,
        assessed: &[Assessment],
    ) -> Option<ShownStart> {
        let values = context.shown_form(element)?.values(&element.points);
        let mut machine = context.base.clone();
        machine.learned.push(LearnedElement { values: values.clone(), ..element.clone() });
        let simulator = self.searcher.simulator;
        let found = assessed.iter().enumerate();
        let found: Vec<Assessment> = found
            .map(|(r, near)| simulator.assess_near(&machine, r, &near.without_residuals()))
            .collect::<Option<_>>()?;
        let parts = whole_parts(assessed.len());
        let (before, after) = (score_parts(assessed, &parts)?, score_parts(&found, &parts)?);
        let pairs = before.cells.iter().zip(&after.cells);
        // every channel counts by its own size, as on held-out stretches
        let [power, left] = pairs.fold([0.0; 2], |[power, left], (before, after)| {
            let size = before.excess.max(1.0).powi(2);
            [power + before.excess.powi(2) / size, left + after.excess.powi(2) / size]
        });
        Some(ShownStart { values, share: 1.0 - left / power.max(f64::MIN_POSITIVE) })
    }

    /// Fits a template to the first part of every recording.
    fn try_template(
        &self,
        context: &TemplateContext,
        template: Template,
        present: Option<&FunctionFit>,
        assessed: &[Assessment],
    ) -> Option<FunctionFit> {
        let element = context.element(template, FITTED_POINTS)?;
        let shown = self.shown_start(context, &element, assessed).filter(|shown| shown.share > 0.0);
        let values = shown.map_or_else(|| element.values.clone(), |shown| shown.values);
        let element = LearnedElement { values, ..element };
        let free = self.fit_element(context, &element, present, assessed)?;
        Some(match present {
            None => self.with_shown_form(context, free),
            Some(_) => free,
        })
    }

    /// Returns an error of the loop's sensor held to the form that other sensors show of it, if that predicts held-out data better: a corner
    /// beside a point of a free function spoils what is known on its other side.
    fn with_shown_form(&self, context: &TemplateContext, free: FunctionFit) -> FunctionFit {
        let found = free.candidate.fit.effects.first().and_then(|effect| {
            let form = context.shown_form(learned_element(effect)?)?;
            let split = self.split(&free.candidate.fit.effects)?;
            self.fit_simple_form(form, learned_element(effect)?, effect, &free.candidate, &split)
        });
        match found {
            Some(form) if merit(&form) > merit(&free.candidate) => free.with_candidate(form),
            _ => free,
        }
    }

    /// Fits the chosen template with more points.
    fn refine_element(
        &self,
        context: &TemplateContext,
        template: Template,
        coarse: &FunctionFit,
        present: Option<&FunctionFit>,
        assessed: &[Assessment],
    ) -> Option<FunctionFit> {
        let element = context.element(template, FINE_POINTS)?;
        let effect = coarse.candidate.fit.effects.last()?;
        let (known, count) = (learned_element(effect)?, effect.parameters.len());
        if known.points.len() >= element.points.len() {
            return None;
        }
        let values = &coarse.candidate.fit.values;
        let shape = LearnedElement { values: values[values.len() - count..].to_vec(), ..known.clone() };
        let table = counterpoise_models::plant::LearnedTable::new(&shape)?;
        let start = element.points.iter().map(|point| table.at(*point)).collect();
        self.fit_element(context, &LearnedElement { values: start, ..element }, present, assessed)
    }

    /// Fits an element from its values beside those that are present, to the first part of every recording, as rough as held-out
    /// stretches ask for.
    fn fit_element(
        &self,
        context: &TemplateContext,
        element: &LearnedElement,
        present: Option<&FunctionFit>,
        assessed: &[Assessment],
    ) -> Option<FunctionFit> {
        let start = element.values.clone();
        let neutral = LearnedElement {
            values: vec![element.quantity.neutral(); element.points.len()],
            name: format!("learned {}", context.base.learned.len() + 1),
            ..element.clone()
        };
        let effect = context.effect(&neutral);
        let whole = FitSelection::all(assessed.len());
        let problem = self.problem(context.base, vec![effect], &whole, assessed, &[]);
        let slopes = problem.slopes(&neutral.values, assessed)?;
        let curvature = HeldOutEquations::new(&slopes, assessed).curvature;
        let mut smoothness = present.map_or_else(Vec::new, |p| p.smoothness.clone());
        smoothness.push(Smoothness { roughness: USUAL_ROUGHNESS, curvature });
        let mut effects = present.map_or_else(Vec::new, |p| p.candidate.fit.effects.clone());
        effects.push(effect);
        let mut values = present.map_or_else(Vec::new, |p| p.candidate.fit.values.clone());
        values.extend(start);
        let split = self.split(&effects)?;
        let near: Vec<Assessment> = assessed.to_vec();
        let wanted = self.preferences(&effects, &smoothness, split.selection.span);
        let fit = self.problem(self.base, effects.clone(), &split.selection, &near, &wanted).fit(&values)?;
        smoothness[effects.len() - 1].roughness =
            self.best_roughness(&fit, assessed.len()).unwrap_or(USUAL_ROUGHNESS);
        let wanted = self.preferences(&effects, &smoothness, split.selection.span);
        let again = self.problem(self.base, effects, &split.selection, &near, &wanted).fit(&fit.values)?;
        Some(FunctionFit { candidate: self.assess_fit(again, split.parts)?, smoothness, tried: Vec::new() })
    }

    /// Returns what functions are fitted to, and what they then predict: the rest of every recording, as far as it stays in the range of what
    /// was fitted. A function of time is fitted to every other recording, whole, and predicts those between.
    pub(crate) fn split(&self, effects: &[&'static Effect]) -> Option<DataSplit> {
        let count = self.before.len();
        let elements: Vec<&LearnedElement> = effects.iter().filter_map(|e| learned_element(e)).collect();
        let compared = |recordings: Vec<usize>, span: Span| FitSelection {
            iterations: COMPARED_ITERATIONS,
            restarts: 0,
            span,
            ..FitSelection::first_parts(recordings)
        };
        if elements.iter().any(|e| e.variable == RegimeVariable::Time) {
            let selection = compared((0..count).step_by(2).collect(), Span::Whole);
            let parts =
                (1..count).step_by(2).map(|recording| RecordingPart { recording, from: 0.0, to: 1.0 });
            return (count > 1).then(|| DataSplit { selection, parts: parts.collect() });
        }
        let to = |r: usize, reach: Reach| {
            elements.iter().map(|e| self.visited.share_in_range(e, r, reach)).fold(1.0, f64::min)
        };
        let within = |reach: Reach| -> Vec<RecordingPart> {
            let part = |recording| RecordingPart { recording, from: FITTED_SHARE, to: to(recording, reach) };
            (0..count).map(part).filter(|part| part.to > part.from + LEAST_PART).collect()
        };
        // beyond the samples of the first parts a function is flat, and what it predicts there says nothing of it
        let strict = within(Reach::Samples);
        let parts = if strict.is_empty() { within(Reach::Points) } else { strict };
        let selection = compared((0..count).collect(), Span::Head);
        (!parts.is_empty()).then_some(DataSplit { selection, parts })
    }

    /// Assesses a fit on a recording, from the initial state that was fitted with it if there is one.
    pub(crate) fn assessment(&self, fit: &EffectFit, recording: usize) -> Option<Assessment> {
        let simulator = self.searcher.simulator;
        match fit.assessment(recording) {
            Some(own) => simulator.assess_from(&fit.parameters, recording, own),
            None => {
                simulator.assess_near(&fit.parameters, recording, &self.before[recording].without_residuals())
            }
        }
    }

    /// Assesses a fit on all recordings, and on the parts that it was not fitted to.
    pub(crate) fn assess_fit(&self, fit: EffectFit, parts: Vec<RecordingPart>) -> Option<FittedCandidate> {
        let all = 0..self.before.len();
        let judged: Vec<Assessment> = all.map(|r| self.assessment(&fit, r)).collect::<Option<_>>()?;
        Some(FittedCandidate {
            whole: score_parts(&judged, &whole_parts(judged.len()))?,
            held_out: score_parts(&judged, &parts)?,
            held_out_before: score_parts(self.before, &parts)?,
            held_out_parts: parts,
            assessments: judged.iter().map(Assessment::without_residuals).collect(),
            needed: Vec::new(),
            least_gain: self.searcher.sizes.gain_needed(),
            fit,
        })
    }

    /// Returns the preferences of all functions of a model; where the first parts of the recordings do not go, a function is flat if it is
    /// fitted to them alone.
    fn preferences(
        &self,
        effects: &[&'static Effect],
        smoothness: &[Smoothness],
        span: Span,
    ) -> Vec<Preference> {
        let mut first = 0;
        let mut all = Vec::new();
        for (effect, smooth) in effects.iter().zip(smoothness) {
            if let Some(element) = learned_element(effect).filter(|_| has_free_points(effect)) {
                all.extend(preferences(element, first, smooth.roughness, smooth.curvature));
                if span == Span::Head {
                    let known = self.visited.determined_points(element);
                    all.extend(flat_preferences(&known, first, smooth.curvature));
                }
            }
            first += effect.parameters.len();
        }
        all
    }

    /// Returns the roughness of the last function of a fit with which held-out stretches are predicted best.
    fn best_roughness(&self, fit: &EffectFit, count: usize) -> Option<f64> {
        let effect = fit.effects.last()?;
        let element = learned_element(effect)?;
        let values = fit.values[fit.values.len() - effect.parameters.len()..].to_vec();
        let near: Vec<Assessment> = (0..count).map(|r| self.assessment(fit, r)).collect::<Option<_>>()?;
        let whole = FitSelection::all(count);
        let problem = self.problem(&fit.parameters, vec![effect], &whole, &near, &[]);
        let slopes = problem.slopes(&values, &near)?;
        let held_out = HeldOutEquations::new(&slopes, &near);
        let share = |rough: &f64| held_out.share(element, &values, *rough);
        ROUGHNESS.iter().copied().max_by(|a, b| share(a).total_cmp(&share(b)))
    }

    /// Fits all functions of a model to all recordings, whole; the held-out figures stay those of the fit to the first parts.
    pub(crate) fn fitted_to_all(&self, learned: FunctionFit) -> FunctionFit {
        let selection = FitSelection {
            iterations: FINAL_ITERATIONS,
            restarts: 1,
            ..FitSelection::all(self.before.len())
        };
        let (effects, smoothness) = (learned.candidate.fit.effects.clone(), &learned.smoothness);
        let wanted = self.preferences(&effects, smoothness, Span::Whole);
        let near = &learned.candidate.assessments;
        let problem = self.problem(self.base, effects, &selection, near, &wanted);
        let again = problem.fit(&learned.candidate.fit.values);
        match again.and_then(|fit| self.searcher.replace_fit(&learned.candidate, fit)) {
            Some(candidate) => FunctionFit { candidate, ..learned },
            None => learned,
        }
    }

    fn problem<'p>(
        &'p self,
        base: &'p Parameters,
        effects: Vec<&'static Effect>,
        selection: &'p FitSelection,
        assessments: &'p [Assessment],
        preferences: &'p [Preference],
    ) -> Problem<'p> {
        let (simulator, pool) = (self.searcher.simulator, self.searcher.pool);
        Problem { simulator, pool, selection, base, effects, assessments, preferences }
    }

    /// Returns whether a function predicts held-out data better than another; one at a component that was located counts as better among
    /// equals.
    fn is_better(&self, tried: &FunctionFit, best: &FunctionFit, template: Template) -> bool {
        let ahead = merit(&tried.candidate) - merit(&best.candidate);
        let place = |learned: &FunctionFit| {
            learned.candidate.fit.effects.last().and_then(|e| learned_element(e)).map(|e| e.place)
        };
        let located = |place: LearnedPlace| self.components.first().is_some_and(|c| is_at(*c, place));
        let favoured = located(template.place) && !place(best).is_some_and(located);
        let even = EVEN_SHARE * merit(&best.candidate).abs();
        ahead > if favoured { -even } else { 0.0 }
    }

    /// Returns whether a model with one more function is worth having: it gains enough on held-out data, makes no channel worse there, and
    /// removes a good part of the residual's power.
    fn worth(&self, candidate: &FittedCandidate, present: Option<&FittedCandidate>) -> bool {
        let gained = candidate.gain() - present.map_or(0.0, FittedCandidate::gain);
        let power_before = present.map_or(1.0, power_left);
        gained > candidate.least_gain
            && !candidate.is_harmful()
            && power_left(candidate) < (1.0 - LEAST_POWER) * power_before
    }

    /// Returns the model that a candidate is, its functions with bands and coverage.
    fn model(&self, candidate: &FittedCandidate, gains: &[f64]) -> Option<LearnedModel> {
        let fit = &candidate.fit;
        let (samples, inflation) = self.independence(candidate);
        let bands = value_half_widths(fit, samples, inflation);
        let mut parts = Vec::new();
        for (k, effect) in fit.effects.iter().enumerate() {
            let known = learned_element(effect)?;
            let element = LearnedElement {
                values: learned_values_in(&fit.parameters, known),
                half_width: bands.get(k).cloned().unwrap_or_default(),
                coverage: self.visited.coverage(known),
                ..known.clone()
            };
            let reading = read_curve(&element);
            parts.push(LearnedPart {
                element,
                reading,
                log_likelihood_gain: gains.get(k).copied().unwrap_or(0.0),
            });
        }
        Some(LearnedModel {
            parts,
            worst_held_out: [candidate.held_out_before.largest_excess(), candidate.held_out.largest_excess()],
            power_left: power_left(candidate),
            place_probability: 1.0,
            after: fits_by_channel(&candidate.whole),
            held_out_before: fits_by_channel(&candidate.held_out_before),
            held_out_after: fits_by_channel(&candidate.held_out),
        })
    }

    /// Returns the number of residuals, and how many of them carry the information of one.
    fn independence(&self, candidate: &FittedCandidate) -> (usize, f64) {
        let (mut samples, mut independent) = (0, 0.0);
        for (r, near) in candidate.assessments.iter().enumerate() {
            let parameters = &candidate.fit.parameters;
            let channels =
                self.searcher.simulator.residuals(parameters, r, Span::Whole, near).unwrap_or_default();
            for channel in channels {
                samples += channel.residual.len();
                independent += channel.residual.len() as f64 / correlation_time(&channel.residual);
            }
        }
        (samples, samples as f64 / f64::max(independent, 1.0))
    }
}

/// Returns the share of the residual's power that a model leaves on held-out data, mean over recordings and channels.
fn power_left(candidate: &FittedCandidate) -> f64 {
    let cells = candidate.held_out.cells.iter().zip(&candidate.held_out_before.cells);
    // a channel that was at its floor before cannot get better, and does not count
    let far = |score: &Score| score.cells.iter().filter(|c| c.excess > EXPLAINED).count();
    let all = far(&candidate.held_out_before) == 0;
    let counted = cells.filter(|(_, before)| all || before.excess > EXPLAINED);
    let (sum, count) = counted.fold((0.0, 0.0), |(sum, count), (after, before)| {
        (sum + (after.rms_error / before.rms_error).powi(2), count + 1.0)
    });
    sum / f64::max(count, 1.0)
}

/// Returns the log-likelihood that a model gains for each held-out sample: models may be judged on different parts.
fn merit(candidate: &FittedCandidate) -> f64 {
    let samples: f64 = candidate.held_out.cells.iter().map(|cell| cell.samples).sum();
    candidate.gain() / samples.max(1.0)
}
