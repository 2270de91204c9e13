//! The tolerances that recordings leave: the most probable values within them, and how far these may be off.
//!
//! Each value that is known within a tolerance becomes a factor on it. The residuals of the recordings, replayed in the simulator and divided by their noise
//! floors, and the tolerances as a prior, give a least-squares problem that Gauss-Newton steps solve; their matrix gives the covariance
//! (D. Bates and D. Watts, Nonlinear Regression Analysis, 1988, chapter 2). Residuals of a model that lacks something are larger than the floors and keep their sign
//! for many samples: both widen what is left. Where the model does not explain the recordings, a tolerance shrinks to no less than half, and to no less than the
//! value has moved: least squares say nothing of what the model lacks.
//!
//! Effects beside the model can be fitted with the values: a missing spring must not be made up for by a wrong inertia.

use counterpoise_diagnose::library::{Effect, EffectParameter};
use counterpoise_linalg::{Mat, inverse};
use counterpoise_models::Parameters;
use counterpoise_pool::{Pool, Serial, map};
use counterpoise_project::{KeyTolerance, Project, VariedTolerance};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::{Replay, ReplayLoop};

use crate::PipelineError;
use crate::configuration::apply_configuration;
use crate::recordings::read::ReadRecording;
use crate::recordings::replay::PreparedRecording;
use crate::tolerance::{
    EXPLAINED_FLOORS, FIRST_DAMPING, LEAST_TOLERANCE, ORDER_REACH, PHASE_REACH, PLACE_REACH,
    POSTERIOR_DAMPINGS, POSTERIOR_DIFFERENCE, POSTERIOR_SETTLED, POSTERIOR_STEPS,
};

/// The tolerances of a project that recordings leave.
#[derive(Debug, Clone)]
pub struct Posterior {
    /// The project with the fitted values and what is left of their tolerances.
    pub project: Project,
    /// The values, in the order of the file.
    pub values: Vec<FittedValue>,
    /// The effects beside the model, with their fitted values.
    pub effects: Vec<ValuedEffect>,
    /// Largest residual of a channel over its noise floor before the fit.
    pub residual_before: f64,
    /// The same after it.
    pub residual_after: f64,
    /// Mean square of all residuals over their noise floors after it.
    pub power_after: f64,
    /// Factors on the values, in the order of `values`.
    pub(super) factors: Vec<f64>,
}

/// A value with a tolerance, before and after recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedValue {
    /// Path of the key.
    pub key: String,
    /// Unit of the key; empty for a pure number.
    pub unit: &'static str,
    /// The value before.
    pub value_before: f64,
    /// Its tolerance before, as a half-width.
    pub half_width_before: f64,
    /// The value after.
    pub value: f64,
    /// The rest of the tolerance: two standard deviations, and no more than before.
    pub half_width: f64,
}

/// The recordings of one controller, ready for replays on one model after another.
pub struct RecordedRuns<'a> {
    recordings: Vec<PreparedRecording<'a>>,
}

impl<'a> RecordedRuns<'a> {
    /// Prepares recordings that were made in one loop.
    ///
    /// # Errors
    /// [`PipelineError::CannotReplay`] if a recording cannot be replayed on any model.
    pub fn prepare(
        project: &Project,
        read: &'a [ReadRecording],
        control: &'a ReplayLoop,
    ) -> Result<Self, PipelineError> {
        let one = |item| PreparedRecording::new(&project.plant, item, control);
        Ok(Self { recordings: read.iter().map(one).collect::<Result<_, _>>()? })
    }

    /// Returns the recordings.
    pub(super) fn iter(&self) -> impl Iterator<Item = &'a Recording> + '_ {
        self.recordings.iter().map(PreparedRecording::recording)
    }

    /// Returns whether every recording shows the angle at its start.
    fn shows_starts(&self) -> bool {
        self.iter().all(|recording| recording.samples(Channel::HubPosition).is_some())
    }
}

/// An effect with a value for each of its parameters.
#[derive(Debug, Clone)]
pub struct ValuedEffect {
    /// The effect.
    pub effect: &'static Effect,
    /// The values, in the order and the units of its parameters.
    pub values: Vec<f64>,
    /// Other effects that explain the recordings as well in its place.
    pub equivalents: Vec<ValuedEffect>,
}

impl ValuedEffect {
    /// Returns an effect with its values.
    pub fn new(effect: &'static Effect, values: Vec<f64>) -> Self {
        Self { effect, values, equivalents: Vec::new() }
    }

    /// Returns whether it is the same effect, whatever its values.
    pub fn has_effect_of(&self, other: &Self) -> bool {
        std::ptr::eq(self.effect, other.effect)
    }

    /// Returns how far each value may move in one fit: by itself, but a phase, an order of a ripple and a place by a share of what they range over.
    fn reaches(&self) -> Vec<f64> {
        let reach = |(parameter, value): (&EffectParameter, &f64)| match parameter.name {
            "phase" => PHASE_REACH,
            "order" => ORDER_REACH * value.abs(),
            "centre" => value.abs().max(PLACE_REACH),
            _ => value.abs(),
        };
        self.effect.parameters.iter().zip(&self.values).map(reach).collect()
    }
}

/// Fits the values that are known within tolerances to recordings, and with them those of effects beside the model.
///
/// # Errors
/// A configuration that does not exist; [`PipelineError::CannotReplay`] if the model as it is cannot replay a recording.
pub fn fit_tolerances(
    project: &Project,
    recorded: &RecordedRuns<'_>,
    effects: &[ValuedEffect],
    pool: &dyn Pool,
) -> Result<Posterior, PipelineError> {
    let problem = Problem::new(project, recorded, effects, pool);
    problem.fit(vec![1.0; problem.count()], None)
}

/// Fits what [`fit_tolerances`] does, from the values of an earlier fit on and in a number of steps at most; what it says of the model before a fit is that of the earlier one.
///
/// # Errors
/// As [`fit_tolerances`].
pub(super) fn fit_from(
    earlier: &Posterior,
    project: &Project,
    recorded: &RecordedRuns<'_>,
    effects: &[ValuedEffect],
    steps: usize,
    pool: &dyn Pool,
) -> Result<Posterior, PipelineError> {
    let problem = Problem { steps, ..Problem::new(project, recorded, effects, pool) };
    problem.fit(problem.factors_of(earlier), Some(earlier.residual_before))
}

/// Residuals over floors, of all channels of all recordings one after the other.
#[derive(Clone)]
pub(super) struct Residuals {
    pub(super) values: Vec<f64>,
    /// Largest RMS of a channel of a recording.
    largest: f64,
}

/// Factors on the values, with the residuals and the covariance that belong to them.
struct FactorFit {
    factors: Vec<f64>,
    residuals: Residuals,
    covariance: Mat,
}

/// The matrix of the normal equations, and the gradient.
struct NormalEquations {
    matrix: Mat,
    gradient: Mat,
}

/// Factors after a step, with their residuals and the damping of the step.
struct DampedStep {
    factors: Vec<f64>,
    residuals: Residuals,
    damping: f64,
}

pub(super) struct Problem<'a> {
    pub(super) project: &'a Project,
    pub(super) recorded: &'a RecordedRuns<'a>,
    unknowns: Vec<VariedTolerance>,
    effects: &'a [ValuedEffect],
    /// Gauss-Newton steps at most.
    steps: usize,
    pub(super) pool: &'a dyn Pool,
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        project: &'a Project,
        recorded: &'a RecordedRuns<'a>,
        effects: &'a [ValuedEffect],
        pool: &'a dyn Pool,
    ) -> Self {
        let unknowns = project.varied_tolerances();
        Self { project, recorded, unknowns, effects, steps: POSTERIOR_STEPS, pool }
    }

    /// Returns the factors that an earlier fit found, and 1 for each parameter of an effect.
    pub(super) fn factors_of(&self, earlier: &Posterior) -> Vec<f64> {
        let mut factors = earlier.factors.clone();
        factors.resize(self.count(), 1.0);
        factors
    }

    /// Fits from factors whose largest residual is known, or found here.
    fn fit(&self, start: Vec<f64>, known_before: Option<f64>) -> Result<Posterior, PipelineError> {
        let first = self.residuals_of_step(&start)?;
        let before = match known_before {
            Some(before) => before,
            None => self.fit_starts(&start, first.clone())?.largest,
        };
        let FactorFit { factors, residuals, covariance } = self.solve(start, first)?;
        let residuals = self.fit_starts(&factors, residuals)?;
        self.posterior(&FactorFit { factors, residuals, covariance }, before)
    }

    pub(super) fn plant_at(&self, factors: &[f64]) -> Result<Parameters, PipelineError> {
        let mut plant = self.project.plant.clone();
        for (unknown, factor) in self.unknowns.iter().zip(factors) {
            unknown.parameter.scale(&mut plant, *factor)?;
        }
        // In SI units both are one constant of the motor.
        let motor = &self.project.plant.motor;
        if motor.back_emf_v_s_rad == motor.torque_constant_nm_a {
            plant.motor.back_emf_v_s_rad = plant.motor.torque_constant_nm_a;
        }
        for valued in self.effects_at(factors) {
            plant = valued.effect.apply_to(&plant, &valued.values);
        }
        Ok(plant)
    }

    /// Returns the number of factors: of the values within tolerances, then of the parameters of the effects.
    fn count(&self) -> usize {
        self.unknowns.len() + self.effects.iter().map(|valued| valued.values.len()).sum::<usize>()
    }

    fn effects_at(&self, factors: &[f64]) -> Vec<ValuedEffect> {
        let mut left = &factors[self.unknowns.len()..];
        let mut at = |valued: &ValuedEffect| {
            let (own, rest) = left.split_at(valued.values.len());
            left = rest;
            let reaches = valued.reaches();
            let moved = |((value, reach), factor): ((&f64, f64), &f64)| value + reach * (factor - 1.0);
            let values = valued.values.iter().zip(reaches).zip(own).map(moved).collect();
            ValuedEffect { values, ..valued.clone() }
        };
        self.effects.iter().map(&mut at).collect()
    }

    /// Returns the half-width within which a factor lies about 1.
    fn relative(&self, k: usize) -> f64 {
        self.unknowns.get(k).map_or(1.0, |unknown| unknown.relative)
    }

    /// Returns the inverse of the variance of an even distribution over that.
    fn prior_weight(&self, k: usize) -> f64 {
        3.0 / self.relative(k).powi(2)
    }

    /// Returns the residuals of replays whose starts are fitted.
    fn residuals(&self, factors: &[f64]) -> Result<Residuals, PipelineError> {
        self.residuals_by(&self.plant_at(factors)?, self.pool, PreparedRecording::replay_from_fitted_start)
    }

    /// Returns the residuals by which steps are judged: those of fitted starts, unless the recordings show the starts themselves.
    fn residuals_of_step(&self, factors: &[f64]) -> Result<Residuals, PipelineError> {
        match self.recorded.shows_starts() {
            true => self.residuals_by(
                &self.plant_at(factors)?,
                self.pool,
                PreparedRecording::replay_from_given_start,
            ),
            false => self.residuals(factors),
        }
    }

    /// Returns the residuals of replays whose starts are fitted, given those by which a step to the same factors was judged.
    fn fit_starts(&self, factors: &[f64], of_step: Residuals) -> Result<Residuals, PipelineError> {
        if self.recorded.shows_starts() { self.residuals(factors) } else { Ok(of_step) }
    }

    /// Returns the residuals from given starts, given those by which a step to the same factors was judged.
    fn given_start_residuals(
        &self,
        factors: &[f64],
        of_step: &Residuals,
    ) -> Result<Residuals, PipelineError> {
        match self.recorded.shows_starts() {
            true => Ok(of_step.clone()),
            false => self.quick_residuals(&self.plant_at(factors)?),
        }
    }

    /// Returns the residuals of replays from the starts that the recordings give: what a change of the machine makes of them hardly depends on their starts.
    pub(super) fn quick_residuals(&self, plant: &Parameters) -> Result<Residuals, PipelineError> {
        self.residuals_by(plant, &Serial, PreparedRecording::replay_from_given_start)
    }

    fn residuals_by(
        &self,
        plant: &Parameters,
        pool: &dyn Pool,
        replay: impl Fn(&PreparedRecording<'a>, &Parameters) -> Result<Replay, PipelineError> + Sync,
    ) -> Result<Residuals, PipelineError> {
        let plant = apply_configuration(self.project, plant)?;
        let recordings = &self.recorded.recordings;
        let replays = map(pool, recordings.len(), |k| replay(&recordings[k], &plant));
        let mut all = Residuals { values: Vec::new(), largest: 0.0 };
        for (prepared, replay) in recordings.iter().zip(replays) {
            let replay = replay?;
            for fit in replay.channels.iter().filter(|fit| JUDGED.contains(&fit.channel)) {
                let measured = prepared.recording().samples(fit.channel).unwrap_or_default();
                let simulated = replay.simulated.channel(fit.channel);
                all.largest = all.largest.max(fit.residual_over_floor());
                let residual =
                    measured.iter().zip(simulated).map(|(measured, made)| (measured - made) / fit.floor);
                all.values.extend(residual.map(|value| if value.is_finite() { value } else { 0.0 }));
            }
        }
        Ok(all)
    }

    /// Takes damped Gauss-Newton steps until the cost settles (D. Marquardt, J. SIAM 11 (1963), 431).
    fn solve(&self, mut factors: Vec<f64>, mut residuals: Residuals) -> Result<FactorFit, PipelineError> {
        let (mut covariance, mut damping) = (self.prior_covariance(), FIRST_DAMPING);
        for _ in 0..self.steps {
            if factors.is_empty() {
                break;
            }
            let inflation = residuals.inflation();
            let Ok(here) = self.given_start_residuals(&factors, &residuals) else { break };
            let Some(derivatives) = self.derivatives(&factors, &here) else { break };
            let equations = self.normal_equations(&derivatives, &residuals, &factors, inflation);
            let Ok(inverted) = inverse(&equations.matrix) else { break };
            covariance = inverted;
            let cost = self.cost(&residuals, &factors, inflation);
            let Some(taken) = self.damped_step(&equations, &factors, cost, inflation, damping) else { break };
            let gained = cost - self.cost(&taken.residuals, &taken.factors, inflation);
            (factors, residuals, damping) = (taken.factors, taken.residuals, 0.1 * taken.damping);
            if gained < POSTERIOR_SETTLED * cost {
                break;
            }
        }
        Ok(FactorFit { factors, residuals, covariance })
    }

    /// Returns the step of the least damping, from a given one on, that lowers the cost; `None` if none does.
    fn damped_step(
        &self,
        equations: &NormalEquations,
        factors: &[f64],
        cost: f64,
        inflation: f64,
        damping: f64,
    ) -> Option<DampedStep> {
        (0..POSTERIOR_DAMPINGS).find_map(|power| {
            let damping = damping * 10f64.powi(power);
            let n = factors.len();
            let damped = Mat::from_fn(n, n, |i, j| {
                equations.matrix[(i, j)] * if i == j { 1.0 + damping } else { 1.0 }
            });
            let step = &inverse(&damped).ok()? * &equations.gradient;
            let moved = |k: usize| {
                let [low, high] = [1.0 - self.relative(k), 1.0 + self.relative(k)];
                (factors[k] - step[(k, 0)]).clamp(low, high)
            };
            let tried: Vec<f64> = (0..n).map(moved).collect();
            let residuals = self.residuals_of_step(&tried).ok()?;
            let is_lower = self.cost(&residuals, &tried, inflation) < cost;
            is_lower.then_some(DampedStep { factors: tried, residuals, damping })
        })
    }

    fn cost(&self, residuals: &Residuals, factors: &[f64], inflation: f64) -> f64 {
        let squares: f64 = residuals.values.iter().map(|value| value * value).sum();
        let prior =
            factors.iter().enumerate().map(|(k, factor)| self.prior_weight(k) * (factor - 1.0).powi(2));
        squares / inflation + prior.sum::<f64>()
    }

    /// Returns the derivatives of the residuals by each factor, from differences to those from given starts; `None` if a machine beside the model cannot be
    /// simulated.
    pub(super) fn derivatives(&self, factors: &[f64], here: &Residuals) -> Option<Vec<Vec<f64>>> {
        let columns = map(self.pool, factors.len(), |k| {
            // Inside the tolerance, and far larger than the steps of converters make the residuals jump.
            let size = POSTERIOR_DIFFERENCE * self.relative(k);
            let difference = if factors[k] + size > 1.0 + self.relative(k) { -size } else { size };
            let mut beside = factors.to_vec();
            beside[k] += difference;
            let moved = self.quick_residuals(&self.plant_at(&beside).ok()?).ok()?;
            let both = moved.values.iter().zip(&here.values);
            (moved.values.len() == here.values.len())
                .then(|| both.map(|(moved, here)| (moved - here) / difference).collect())
        });
        columns.into_iter().collect()
    }

    fn normal_equations(
        &self,
        derivatives: &[Vec<f64>],
        residuals: &Residuals,
        factors: &[f64],
        inflation: f64,
    ) -> NormalEquations {
        let n = factors.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / inflation;
        let weight = |k: usize| self.prior_weight(k);
        let matrix = Mat::from_fn(n, n, |i, j| {
            dot(&derivatives[i], &derivatives[j]) + if i == j { weight(i) } else { 0.0 }
        });
        let gradient = Mat::from_fn(n, 1, |i, _| {
            dot(&derivatives[i], &residuals.values) + weight(i) * (factors[i] - 1.0)
        });
        NormalEquations { matrix, gradient }
    }

    fn prior_covariance(&self) -> Mat {
        let n = self.count();
        Mat::from_fn(n, n, |i, j| if i == j { 1.0 / self.prior_weight(i) } else { 0.0 })
    }

    fn posterior(&self, fitted: &FactorFit, residual_before: f64) -> Result<Posterior, PipelineError> {
        let mut project = Project { plant: self.plant_at(&fitted.factors)?, ..self.project.clone() };
        let mut values = Vec::new();
        for (k, unknown) in self.unknowns.iter().enumerate() {
            let before = self.project.tolerances[unknown.place].clone();
            let value = before.value * fitted.factors[k];
            let deviations = 2.0 * fitted.covariance[(k, k)].max(0.0).sqrt();
            let least = match fitted.residuals.largest <= EXPLAINED_FLOORS {
                true => LEAST_TOLERANCE,
                false => (0.5 * unknown.relative).max((fitted.factors[k] - 1.0).abs()).max(LEAST_TOLERANCE),
            };
            let relative = deviations.max(least).min(unknown.relative.max(LEAST_TOLERANCE));
            let half_width = relative * value.abs();
            project.tolerances[unknown.place] = KeyTolerance { value, half_width, ..before.clone() };
            values.push(FittedValue {
                key: before.key,
                unit: before.unit,
                value_before: before.value,
                half_width_before: before.half_width,
                value,
                half_width,
            });
        }
        let effects = self.effects_at(&fitted.factors);
        Ok(Posterior {
            project,
            values,
            effects,
            residual_before,
            residual_after: fitted.residuals.largest,
            power_after: fitted.residuals.power(),
            factors: fitted.factors[..self.unknowns.len()].to_vec(),
        })
    }
}

impl Residuals {
    /// Returns the mean square.
    fn power(&self) -> f64 {
        let count = self.values.len().max(1) as f64;
        self.values.iter().map(|value| value * value).sum::<f64>() / count
    }

    /// Returns by how much residuals weigh less than white noise of their floors: by their power, and by the samples over which they keep their sign
    /// over the two of white noise.
    fn inflation(&self) -> f64 {
        let count = self.values.len().max(1) as f64;
        let changes = self.values.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
        let kept = count / (changes.max(1) as f64);
        self.power().max(1.0) * (0.5 * kept).max(1.0)
    }
}

/// Channels that the fit compares.
const JUDGED: [Channel; 4] = [Channel::Control, Channel::HubRate, Channel::MotorRate, Channel::HubPosition];
