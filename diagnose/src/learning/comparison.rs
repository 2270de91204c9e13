//! Effects of the library against one free function, by what both predict of data that neither was fitted to.
//!
//! Several effects of the library, or one with a flexible shape, imitate almost any smooth error. A name is worth something only if it
//! predicts better than a curve without a name does, or as well with fewer parameters.

use crate::fitting::output_error::{FitSelection, confidence_intervals, parameters_of};
use crate::fitting::score::score_parts;
use crate::learning::learner::LearningTask;
use crate::library::{Component, Effect, EffectKind, EffectParameter, ParameterMapping, gain_curve_inputs};
use crate::selection::candidate::FittedCandidate;
use crate::selection::parameter_scan::covers_a_period;
use crate::simulator_access::Assessment;
use crate::tolerance::learning::{
    COMPARED_PARAMETERS_AT_MOST, EVEN_PARAMETERS, UNDETERMINED_LOGARITHM, UNDETERMINED_SHARE,
};
use crate::tolerance::{AMBIGUOUS, SEARCH_ITERATIONS};

/// Result of a comparison on held-out data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Log-likelihood by which the free function predicts held-out data better than the effects of the library.
    pub function_gain_nats: f64,
    /// Effective number of parameters of the free function.
    pub function_parameters: f64,
    /// Parameters of the library's effects, and one for the choice of each effect.
    pub library_parameters: f64,
}

impl Comparison {
    /// Returns whether the free function takes the place of the effects: it predicts clearly better, or as well with fewer parameters.
    pub fn prefers_function(&self) -> bool {
        let fewer = self.function_parameters < self.library_parameters;
        self.function_gain_nats > AMBIGUOUS || (self.function_gain_nats > -AMBIGUOUS && fewer)
    }

    /// Returns whether the recordings cannot tell both apart. A function that needs many more parameters only follows the effects' shape.
    pub fn is_even(&self) -> bool {
        let comparable = self.function_parameters < EVEN_PARAMETERS * self.library_parameters;
        !self.prefers_function() && self.function_gain_nats > -AMBIGUOUS && comparable
    }
}

/// Returns whether effects of the library are flexible enough to imitate an error that is none of them: two or more, or one with a shape
/// that the recordings do not determine.
pub(crate) fn is_flexible(named: &FittedCandidate, travel_rad: f64) -> bool {
    let effects = &named.fit.effects;
    if named.fit.values.len() > COMPARED_PARAMETERS_AT_MOST
        || effects.iter().any(|e| gain_curve_inputs(e).is_some())
    {
        return false;
    }
    let shaped = |e: &&&'static Effect| e.kind == EffectKind::MissingPhysics && e.parameters.len() > 1;
    effects.len() > 1
        || (effects.iter().any(|e| shaped(&e))
            && (is_undetermined(named) || is_piece_of_a_sine(named, travel_rad)))
}

/// Returns whether the interval of a parameter of shape, one beside the first, is wide.
fn is_undetermined(named: &FittedCandidate) -> bool {
    let samples: f64 = named.whole.cells.iter().map(|cell| cell.samples).sum();
    let independent: f64 = named.whole.cells.iter().map(|cell| cell.worth).sum();
    let bounds = confidence_intervals(&named.fit, samples as usize, samples / independent.max(1.0));
    let parameters = parameters_of(&named.fit.effects);
    let all = parameters.iter().zip(&named.fit.values).zip(&bounds).skip(1);
    let wide =
        |((parameter, value), [low, high]): ((&&'static EffectParameter, &f64), &[f64; 2])| match parameter
            .mapping
        {
            ParameterMapping::Log => (high / low).ln() > UNDETERMINED_LOGARITHM,
            // a place or a phase may be zero: then its typical size is the measure
            ParameterMapping::Linear => {
                high - low > UNDETERMINED_SHARE * value.abs().max(parameter.size) && parameter.name != "phase"
            }
            ParameterMapping::Whole => false,
        };
    all.into_iter().any(wide)
}

/// Returns whether a torque or friction that should repeat with the angle at the pivot is seen over less than a period.
fn is_piece_of_a_sine(named: &FittedCandidate, travel_rad: f64) -> bool {
    let mut first = 0;
    named.fit.effects.iter().any(|effect| {
        let order = named.fit.values.get(first + 1).copied();
        first += effect.parameters.len();
        effect.is_ripple()
            && effect.component == Component::Pivot
            && order.is_some_and(|order| !covers_a_period(order, travel_rad))
    })
}

impl LearningTask<'_> {
    /// Compares effects of the library with the free function that explains most in their place: both are fitted to the same parts of the
    /// recordings and predict the same others. Returns `None` if no free function is worth having.
    pub(crate) fn compare(&self, named: &FittedCandidate) -> Option<Comparison> {
        let function = self.one_function()?;
        let candidate = &function.learned.candidate;
        let split = self.split(&candidate.fit.effects)?;
        let selection = FitSelection { iterations: SEARCH_ITERATIONS, ..split.selection };
        let searcher = self.searcher;
        let effects = named.fit.effects.clone();
        let fit = searcher.fit(effects, &named.fit.values, &selection, &named.assessments)?;
        let judged: Vec<Assessment> =
            (0..self.before.len()).map(|r| self.assessment(&fit, r)).collect::<Option<_>>()?;
        let library = score_parts(&judged, &candidate.held_out_parts)?;
        Some(Comparison {
            function_gain_nats: -candidate.held_out.loss_against(&library),
            function_parameters: self.effective_parameters(&function.learned),
            library_parameters: (named.fit.values.len() + named.fit.effects.len()) as f64,
        })
    }
}
