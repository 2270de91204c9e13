//! A free function that is held to a simple form: its few coefficients are fitted in the simulator, and it goes on beyond what the recordings visit.
//!
//! Many free values that are fitted far from a good model stop early, and are flat where the recordings do not go. A form has no more
//! coefficients than a textbook gives it, so its fit comes to rest; it takes the curve's place if it predicts held-out data as well.

use std::f64::consts::TAU;

use counterpoise_linalg::inverse;
use counterpoise_models::{Interpolation, LearnedElement, RegimeVariable};

use crate::fitting::output_error::{EffectFit, FitSelection};
use crate::learning::learner::{DataSplit, FittedFunctions, LearningTask};
use crate::learning::reading::{CurveForm, FittedForm, nearest_forms, nearest_of_form};
use crate::learning::templates::{add_corners, place_points};
use crate::library::{Effect, has_free_points, learned_element, learned_values_in, make_form_effect};
use crate::selection::candidate::FittedCandidate;
use crate::tolerance::identification::NORMAL_95;
use crate::tolerance::learning::{FACTOR_BOUNDS, FORM_CONTINUATION, FORM_POINTS, FORM_ROUNDS, FORMS_FITTED};
use crate::tolerance::{AMBIGUOUS, FIT_STEP, PARAMETER_PRICE, SEARCH_ITERATIONS};

/// A form as an effect with values from which its fit starts.
struct FormStart {
    effect: &'static Effect,
    values: Vec<f64>,
}

impl LearningTask<'_> {
    /// Returns the model with its only function held to the simple form that predicts held-out data best, if one predicts them as well as the
    /// free curve does; else as it was.
    pub(crate) fn with_simple_form(&self, found: FittedFunctions) -> FittedFunctions {
        self.simple_form(&found).unwrap_or(found)
    }

    fn simple_form(&self, found: &FittedFunctions) -> Option<FittedFunctions> {
        let candidate = &found.learned.candidate;
        let [effect] = candidate.fit.effects.as_slice() else { return None };
        if !has_free_points(effect) {
            return None; // it has a form already
        }
        let curve = self.curve_with_band(effect, &candidate.fit)?;
        let split = self.split(&candidate.fit.effects)?;
        let mut best: Option<FittedCandidate> = None;
        for form in
            nearest_forms(&curve).into_iter().filter(|f| f.form != CurveForm::Constant).take(FORMS_FITTED)
        {
            if self.searcher.pool.is_cancelled() {
                return None;
            }
            let Some(tried) = self.fit_simple_form(form, &curve, effect, candidate, &split) else { continue };
            let ahead = best.as_ref().is_none_or(|best| {
                let spared = best.fit.values.len() as f64 - tried.fit.values.len() as f64;
                tried.held_out.loss_against(&best.held_out) < 0.5 * PARAMETER_PRICE * spared
            });
            if ahead {
                best = Some(tried);
            }
        }
        let best = best?;
        let spared = self.effective_parameters(&found.learned) - best.fit.values.len() as f64;
        let allowed = AMBIGUOUS.max(0.5 * PARAMETER_PRICE * spared);
        if best.held_out.loss_against(&candidate.held_out) > allowed || best.is_harmful() {
            return None;
        }
        Some(self.with_candidate(found, best))
    }

    /// Returns a fitted curve with its coverage, and with the band that the fit's information gives it.
    fn curve_with_band(&self, effect: &'static Effect, fit: &EffectFit) -> Option<LearnedElement> {
        let known = learned_element(effect)?;
        let covariance = inverse(&fit.information).ok();
        let half = |k: usize| {
            let variance = covariance.as_ref().map_or(0.0, |c| c[(k, k)].max(0.0));
            NORMAL_95 * effect.parameters[k].size * (fit.cost.max(1.0) * variance).sqrt()
        };
        Some(LearnedElement {
            values: fit.values.clone(),
            half_width: (0..known.points.len()).map(half).collect(),
            coverage: self.visited.coverage(known),
            ..known.clone()
        })
    }

    /// Fits a form to the first part of every recording; parameters that do not enter linearly are found by steps along their slopes.
    pub(crate) fn fit_simple_form(
        &self,
        form: FittedForm,
        curve: &LearnedElement,
        free: &'static Effect,
        near: &FittedCandidate,
        split: &DataSplit,
    ) -> Option<FittedCandidate> {
        let selection =
            FitSelection { iterations: SEARCH_ITERATIONS, restarts: 1, ..split.selection.clone() };
        let step = free.parameters.first()?.size * FIT_STEP;
        let rounds = if form.inner.is_empty() { 1 } else { FORM_ROUNDS };
        let (kind, mut form) = (form.form, form);
        let mut best: Option<FittedCandidate> = None;
        for _ in 0..rounds {
            let table = form_table(curve, &form);
            let start = form_start(&form, &table, step)?;
            let element = learned_element(start.effect)?;
            let near = best.as_ref().unwrap_or(near);
            let fit = self.searcher.fit(vec![start.effect], &start.values, &selection, &near.assessments)?;
            let values = learned_values_in(&fit.parameters, element);
            form = nearest_of_form(&LearnedElement { values, ..table }, kind)?;
            let tried = self.assess_fit(fit, split.parts.clone())?;
            let better = best.as_ref().is_none_or(|b| tried.held_out.loss_against(&b.held_out) < 0.0);
            if !better {
                break;
            }
            best = Some(tried);
        }
        best.filter(makes_sense)
    }

    /// Returns the model with another fit of its first function, fitted to all recordings.
    fn with_candidate(&self, found: &FittedFunctions, candidate: FittedCandidate) -> FittedFunctions {
        let gains = vec![candidate.gain()];
        let learned = found.learned.with_candidate(candidate);
        FittedFunctions { learned: self.fitted_to_all(learned), gains }
    }
}

/// Returns whether a factor stays within its bounds over the whole table.
fn makes_sense(found: &FittedCandidate) -> bool {
    let Some(element) = found.fit.effects.first().and_then(|effect| learned_element(effect)) else {
        return false;
    };
    let values = learned_values_in(&found.fit.parameters, element);
    let [low, high] = FACTOR_BOUNDS;
    !element.quantity.is_factor() || values.iter().all(|value| (low..=high).contains(value))
}

/// Returns the table of a form: over the turn, or over what the recordings visit and half as much again at either end, of time at the later one;
/// with points at the corners of the form if it goes in straight lines from point to point.
fn form_table(curve: &LearnedElement, form: &FittedForm) -> LearnedElement {
    let (first, last) = (curve.points[0], curve.points[curve.points.len() - 1]);
    let (low, high) = match curve.variable {
        RegimeVariable::Turn => (0.0, TAU * (1.0 - 1.0 / FORM_POINTS as f64)),
        RegimeVariable::Time => (first, last + FORM_CONTINUATION * (last - first)),
        _ => (first - FORM_CONTINUATION * (last - first), last + FORM_CONTINUATION * (last - first)),
    };
    let mut points = place_points(curve.variable, [low, high], FORM_POINTS);
    if curve.interpolation == Interpolation::Linear {
        add_corners(&mut points, &form.corners());
    }
    let values = vec![curve.quantity.neutral(); points.len()];
    LearnedElement { values, half_width: Vec::new(), coverage: Vec::new(), points, ..curve.clone() }
}

/// Returns the effect of a form over a table, and the coefficients at which it is what it is.
fn form_start(form: &FittedForm, table: &LearnedElement, step: f64) -> Option<FormStart> {
    let inner = (0..form.inner.len()).map(|place| form.inner_slope(place, &table.points));
    let rows: Vec<Vec<f64>> = form.term_rows(&table.points).into_iter().chain(inner).collect();
    let effect = make_form_effect(table, &rows, step)?;
    // the first term of every form is its level
    let own = form.linear.iter().enumerate();
    let terms = own.map(|(k, value)| if k == 0 { value - table.quantity.neutral() } else { *value });
    let mut values: Vec<f64> = terms.chain(vec![0.0; form.inner.len()]).collect();
    for (value, parameter) in values.iter_mut().zip(effect.parameters) {
        *value = value.clamp(parameter.bounds[0], parameter.bounds[1]);
    }
    Some(FormStart { effect, values })
}
