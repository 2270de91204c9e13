//! Screening: which effects of the library, each beside the values within their tolerances, could explain what a fit leaves.
//!
//! Each effect is tried at a small size, or at one of the library's starts, in the simulator. What it changes in the residuals is its signature; the part of it that no value
//! within its tolerance can make is what counts. The share of the residual that a combination of an effect's signatures explains ranks the effects, and the coefficients
//! are where its fit starts (a score test: C. Rao, Proc. Cambridge Philosophical Society 44 (1948), 50).

use counterpoise_diagnose::can_have;
use counterpoise_diagnose::findings::similarity::SimilarityScale;
use counterpoise_diagnose::library::{Component, Effect, ParameterMapping, list_effects};
use counterpoise_models::Parameters;
use counterpoise_pool::map;
use counterpoise_recordings::Recording;

use super::posterior::{Posterior, Problem, ValuedEffect};
use crate::PipelineError;
use crate::tolerance::{DEPENDENT, SCREENED_MULTIPLE, SCREENED_ORDERS, SCREENED_SHARE};

/// An effect with directions along which it is tried, each a set of values beside an origin.
struct Trial {
    effect: &'static Effect,
    origin: Vec<f64>,
    ends: Vec<Vec<f64>>,
    form: TrialForm,
}

/// Combination of the directions of a trial.
#[derive(Clone, Copy, PartialEq)]
enum TrialForm {
    /// Any multiple of each.
    Free,
    /// From the model as it is towards a start.
    Towards,
    /// Sine and cosine of a ripple.
    Ripple,
}

/// A machine in its own units and in those of the library.
struct ScaledMachine {
    scale: Option<SimilarityScale>,
    base: Parameters,
}

impl ScaledMachine {
    fn of(own: &Parameters, recordings: &[Recording]) -> Self {
        let scale = SimilarityScale::of(own, recordings);
        Self { scale, base: scale.map_or_else(|| own.clone(), |scale| scale.apply_to(own)) }
    }

    /// Returns the machine with an effect, in its own units.
    fn with(&self, effect: &Effect, values: &[f64]) -> Parameters {
        let changed = effect.apply_to(&self.base, values);
        self.scale.map_or_else(|| changed.clone(), |scale| scale.inverse().apply_to(&changed))
    }
}

/// Returns the effects that explain most of what a fit leaves, the best first, with the values from which to fit them.
///
/// # Errors
/// [`PipelineError::CannotReplay`] if the model as it was fitted cannot replay a recording.
pub(super) fn screen_effects(
    problem: &Problem<'_>,
    fitted: &Posterior,
) -> Result<Vec<ValuedEffect>, PipelineError> {
    let factors = problem.factors_of(fitted);
    let own = problem.plant_at(&factors)?;
    let here = problem.quick_residuals(&own)?;
    let recordings: Vec<Recording> = problem.recorded.iter().cloned().collect();
    let machine = ScaledMachine::of(&own, &recordings);
    let nuisances = orthonormal(problem.derivatives(&factors, &here).unwrap_or_default());
    let left = without(&nuisances, &here.values);
    let trials = list_trials(&machine, fitted);
    let found = map(problem.pool, trials.len(), |k| {
        judge_trial(problem, &machine, &trials[k], &here.values, &nuisances, &left)
    });
    let mut found: Vec<Explanation> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut best: Vec<ValuedEffect> = Vec::new();
    for one in found.into_iter().filter(|one| one.share >= SCREENED_SHARE) {
        if !best.iter().any(|known| known.has_effect_of(&one.valued)) {
            best.push(one.valued);
        }
    }
    Ok(best)
}

/// An effect with the share of the residual that it explains.
struct Explanation {
    valued: ValuedEffect,
    share: f64,
}

/// Returns the trials of every effect that a machine can have and the fit does not hold yet.
fn list_trials(machine: &ScaledMachine, fitted: &Posterior) -> Vec<Trial> {
    let is_new = |effect: &&'static Effect| {
        can_have(&machine.base, effect) && !fitted.effects.iter().any(|one| std::ptr::eq(one.effect, *effect))
    };
    list_effects().into_iter().filter(is_new).flat_map(|effect| trials_of(effect, machine)).collect()
}

fn trials_of(effect: &'static Effect, machine: &ScaledMachine) -> Vec<Trial> {
    let origin = effect.values(&machine.base);
    if effect.is_ripple() && effect.starts.is_empty() {
        // A turn of the scaled machine's motor is another share of a turn of its own.
        let turns = machine.scale.map_or(1.0, |scale| scale.ratio);
        let per_turn = if effect.component == Component::Pivot { 1.0 } else { 1.0 / turns };
        let ripple = |order: &f64| {
            let order = order * per_turn;
            let at = |phase: f64| vec![effect.parameters[0].size, order, phase];
            let ends = vec![at(0.0), at(std::f64::consts::FRAC_PI_2)];
            Trial { effect, origin: vec![0.0, order, 0.0], ends, form: TrialForm::Ripple }
        };
        return SCREENED_ORDERS.iter().map(ripple).collect();
    }
    if !effect.starts.is_empty() {
        let towards = |start: &&[f64]| {
            // The shape takes the start's values, the first value moves towards it.
            let mut from = start.to_vec();
            from[0] = origin[0];
            Trial { effect, origin: from, ends: vec![start.to_vec()], form: TrialForm::Towards }
        };
        let moves = |trial: &Trial| trial.origin[0] != trial.ends[0][0];
        return effect.starts.iter().map(towards).filter(moves).collect();
    }
    let moved = |k: usize| {
        let mut values = origin.clone();
        values[k] = match effect.parameters[k].mapping {
            ParameterMapping::Linear => values[k] + effect.parameters[k].size,
            ParameterMapping::Log => values[k] * effect.parameters[k].size.exp(),
            ParameterMapping::Whole => values[k] + 1.0,
        };
        values
    };
    let ends: Vec<Vec<f64>> = (0..origin.len()).map(moved).collect();
    let is_whole = effect.parameters.iter().any(|parameter| parameter.mapping == ParameterMapping::Whole);
    let form = if is_whole { TrialForm::Towards } else { TrialForm::Free };
    vec![Trial { effect, origin, ends, form }]
}

fn judge_trial(
    problem: &Problem<'_>,
    machine: &ScaledMachine,
    trial: &Trial,
    here: &[f64],
    nuisances: &[Vec<f64>],
    left: &[f64],
) -> Option<Explanation> {
    let signature = |values: &Vec<f64>| {
        let there = problem.quick_residuals(&machine.with(trial.effect, values)).ok()?;
        let changes = there.values.iter().zip(here).map(|(there, here)| there - here).collect::<Vec<f64>>();
        (changes.len() == left.len()).then(|| without(nuisances, &changes))
    };
    let signatures: Vec<Vec<f64>> = trial.ends.iter().map(signature).collect::<Option<_>>()?;
    let multiples = multiples_of(&signatures, left, trial.form)?;
    let explained = |k: usize| -> f64 {
        left[k]
            + signatures
                .iter()
                .zip(&multiples)
                .map(|(signature, multiple)| multiple * signature[k])
                .sum::<f64>()
    };
    let rest: f64 = (0..left.len()).map(|k| explained(k).powi(2)).sum();
    let values = values_at(trial, &multiples);
    // In the machine's own units, from which the fit starts.
    let changed = machine.with(trial.effect, &values);
    let valued = ValuedEffect::new(trial.effect, trial.effect.values(&changed));
    let is_sound = valued.values.iter().all(|value| value.is_finite());
    is_sound.then(|| Explanation { valued, share: 1.0 - rest / squares(left).max(f64::MIN_POSITIVE) })
}

/// Returns the multiples of signatures that leave least of a residual, within the reach of their form.
fn multiples_of(signatures: &[Vec<f64>], left: &[f64], form: TrialForm) -> Option<Vec<f64>> {
    // Gauss-Seidel on the normal equations: an effect has at most three directions.
    let gram: Vec<Vec<f64>> =
        signatures.iter().map(|a| signatures.iter().map(|b| dot(a, b)).collect()).collect();
    let toward: Vec<f64> = signatures.iter().map(|signature| -dot(signature, left)).collect();
    let [low, high] = match form {
        TrialForm::Towards => [0.0, 2.0],
        TrialForm::Free | TrialForm::Ripple => [-SCREENED_MULTIPLE, SCREENED_MULTIPLE],
    };
    let mut multiples = vec![0.0; signatures.len()];
    for _ in 0..SWEEPS {
        for k in 0..multiples.len() {
            let of_others: f64 =
                (0..multiples.len()).filter(|j| *j != k).map(|j| gram[k][j] * multiples[j]).sum();
            if gram[k][k] > 0.0 {
                multiples[k] = ((toward[k] - of_others) / gram[k][k]).clamp(low, high);
            }
        }
    }
    multiples.iter().any(|multiple| *multiple != 0.0).then_some(multiples)
}

/// Returns the values of an effect at multiples of its trial's directions, within the bounds of its parameters.
fn values_at(trial: &Trial, multiples: &[f64]) -> Vec<f64> {
    let mut values = trial.origin.clone();
    match trial.form {
        TrialForm::Ripple => {
            values[0] = multiples[0].hypot(multiples[1]) * trial.ends[0][0];
            values[2] = multiples[1].atan2(multiples[0]);
        }
        TrialForm::Free | TrialForm::Towards => {
            for (end, multiple) in trial.ends.iter().zip(multiples) {
                for (k, value) in values.iter_mut().enumerate() {
                    let (from, to) = (trial.origin[k], end[k]);
                    match trial.effect.parameters[k].mapping {
                        ParameterMapping::Log if from > 0.0 && to > 0.0 => {
                            *value *= (to / from).powf(*multiple)
                        }
                        ParameterMapping::Whole => *value = (from + multiple * (to - from)).round(),
                        _ => *value += multiple * (to - from),
                    }
                }
            }
        }
    }
    let bounded = values.iter().zip(trial.effect.parameters);
    bounded.map(|(value, parameter)| value.clamp(parameter.bounds[0], parameter.bounds[1])).collect()
}

/// Returns vectors of length 1 at right angles that span what given ones do (modified Gram-Schmidt, twice).
fn orthonormal(vectors: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for vector in vectors {
        let whole = squares(&vector);
        let rest = without(&basis, &without(&basis, &vector));
        let size = squares(&rest);
        if size > DEPENDENT * whole && size > 0.0 {
            basis.push(rest.into_iter().map(|value| value / size.sqrt()).collect());
        }
    }
    basis
}

/// Returns what is left of a vector at right angles to a basis.
fn without(basis: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    let mut rest = vector.to_vec();
    for direction in basis {
        let part = dot(direction, &rest);
        rest.iter_mut().zip(direction).for_each(|(value, along)| *value -= part * along);
    }
    rest
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn squares(values: &[f64]) -> f64 {
    dot(values, values)
}

/// Sweeps of Gauss-Seidel: two directions at 60 degrees are right to 1e-6 after ten.
const SWEEPS: usize = 12;
