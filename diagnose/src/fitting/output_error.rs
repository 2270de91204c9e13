//! Output-error fit: Levenberg and Marquardt's method on the simulator's residuals.

use counterpoise_linalg::{Mat, inverse};
use counterpoise_models::{Parameters, RegimeVariable};
use counterpoise_recordings::Channel;
use counterpoise_simulate::ensemble::SIDE_BY_SIDE;
use counterpoise_simulate::replay::{START_FREEDOMS, start_has};

use crate::fitting::initial_states::StartColumns;
use crate::fitting::normal_equations::{LinearisedCost, damped_step, long_run, stretch_sums};
use crate::library::{Effect, EffectParameter, ParameterMapping, learned_element, value_rows};
use crate::recording::series::dot;
use crate::simulator_access::{
    Assessment, ChannelResidual, MechanismVariant, PlacedVariant, SimulatorAccess, Span, StartShift,
};
use crate::tolerance::fitting::{INDISTINCT_SHARE, LEAST_DAMPING};
use crate::tolerance::{
    FIT_ITERATIONS, FIT_STEP, FIT_TOLERANCE, FITTED_SHARE, RESTART_WORTH, RESTARTS, SEARCH_ITERATIONS,
    STARTS_KEPT, STRETCH, STRETCHES_TOGETHER, SYSTEMATIC, TRIAL_ITERATIONS, TRIAL_RESTARTS,
};
use counterpoise_pool::{Pool, map};

/// Place of the hub angle among the freedoms of an initial state, as [`start_has`] lists them.
const START_ANGLE: usize = 0;

/// A variant of the machine in one recording of the selection.
struct SelectedVariant {
    /// Place of the recording in the selection.
    place: usize,
    variant: MechanismVariant,
}

/// Recordings that a fit may use.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSelection {
    /// Recordings.
    pub recordings: Vec<usize>,
    /// Part of each recording.
    pub span: Span,
    /// Largest number of iterations.
    pub iterations: usize,
    /// Largest number of times that the recordings' initial states are estimated anew.
    pub restarts: usize,
}

impl FitSelection {
    /// Selects every recording, whole, for a fit until it settles.
    pub fn all(count: usize) -> Self {
        Self { span: Span::Whole, ..Self::first_parts((0..count).collect()) }
    }

    /// Selects the first part of some recordings, for a fit until it settles.
    pub fn first_parts(recordings: Vec<usize>) -> Self {
        Self { recordings, span: Span::Head, iterations: FIT_ITERATIONS, restarts: RESTARTS }
    }

    /// Selects the first part of some recordings, for a comparison of candidates.
    pub fn search_parts(recordings: Vec<usize>) -> Self {
        Self { iterations: SEARCH_ITERATIONS, ..Self::first_parts(recordings) }
    }

    /// Selects the first part of some recordings, for a first ranking.
    pub fn first_parts_for_ranking(recordings: Vec<usize>) -> Self {
        Self { iterations: TRIAL_ITERATIONS, restarts: TRIAL_RESTARTS, ..Self::first_parts(recordings) }
    }
}

/// A fitted set of effects.
#[derive(Debug, Clone)]
pub struct EffectFit {
    /// The effects, in the order in which they were found.
    pub effects: Vec<&'static Effect>,
    /// The values of their parameters, effect after effect.
    pub values: Vec<f64>,
    /// The mechanism with the effects.
    pub parameters: Parameters,
    /// Mean square of the residual over what the fit saw.
    pub cost: f64,
    /// Curvature of the cost in the fit's own variables, for intervals.
    pub information: Mat,
    /// Scatter of the cost's gradient, stretch of time by stretch: what the noise, coloured as it is, does to it.
    pub scatter: Mat,
    /// `true` if the iteration limit was reached before the cost settled.
    pub limit_reached: bool,
    /// The recordings that were fitted, each with its assessment without residuals.
    pub assessments: Vec<(usize, Assessment)>,
}

impl EffectFit {
    /// Returns the assessment of a recording that was fitted, from the initial state that was found with it.
    pub fn assessment(&self, recording: usize) -> Option<&Assessment> {
        self.assessments.iter().find(|(index, _)| *index == recording).map(|(_, near)| near)
    }
}

/// Returns all parameters of a list of effects.
pub fn parameters_of(effects: &[&'static Effect]) -> Vec<&'static EffectParameter> {
    effects.iter().flat_map(|effect| effect.parameters.iter()).collect()
}

/// Returns the mechanism with the parameters of several effects set.
pub fn apply_effects(base: &Parameters, effects: &[&'static Effect], values: &[f64]) -> Parameters {
    let mut changed = base.clone();
    for (parameter, &value) in parameters_of(effects).iter().zip(values) {
        parameter.write(&mut changed, value);
    }
    changed
}

pub(crate) fn to_variable(parameter: &EffectParameter, value: f64) -> f64 {
    match parameter.mapping {
        ParameterMapping::Log => value.max(f64::MIN_POSITIVE).ln() / parameter.size,
        ParameterMapping::Linear | ParameterMapping::Whole => value / parameter.size,
    }
}

pub(crate) fn from_variable(parameter: &EffectParameter, variable: f64) -> f64 {
    let value = match parameter.mapping {
        ParameterMapping::Log => (variable * parameter.size).exp(),
        ParameterMapping::Linear => variable * parameter.size,
        ParameterMapping::Whole => (variable * parameter.size).round(),
    };
    value.clamp(parameter.bounds[0], parameter.bounds[1])
}

/// The problem that a fit solves: everything but the values of the parameters.
pub struct Problem<'a> {
    /// Simulator and recordings.
    pub simulator: &'a dyn SimulatorAccess,
    /// Processors.
    pub pool: &'a dyn Pool,
    /// Recordings that the fit may use.
    pub selection: &'a FitSelection,
    /// The mechanism without the effects.
    pub base: &'a Parameters,
    /// The effects to fit.
    pub effects: Vec<&'static Effect>,
    /// The assessments of the recordings for a similar mechanism; empty if there are none.
    pub assessments: &'a [Assessment],
    /// Prior preferences for the parameters; empty if there are none.
    pub preferences: &'a [Preference],
}

/// A preference: a linear combination of the parameters that should be a value. Its square counts as one residual does.
#[derive(Debug, Clone, PartialEq)]
pub struct Preference {
    /// Weight of each parameter's value, with the parameter's place.
    pub weights: Vec<(usize, f64)>,
    /// Preferred value of the combination.
    pub target: f64,
}

impl Preference {
    /// Returns by how much parameter values miss it.
    pub(crate) fn shortfall(&self, values: &[f64]) -> f64 {
        self.weights.iter().map(|(place, weight)| weight * values[*place]).sum::<f64>() - self.target
    }
}

/// The residuals of a fit and what each parameter changes of them, recording by recording, without what the initial states could do.
#[derive(Debug, Clone)]
pub(crate) struct Slopes {
    /// Residuals.
    pub residual: Vec<Vec<f64>>,
    /// Changes per unit of each parameter's value: parameter by parameter, recording by recording.
    pub columns: Vec<Vec<Vec<f64>>>,
}

impl Problem<'_> {
    /// Fits from the given parameter values, together with the recordings' initial states. The fit is repeated with the initial
    /// states estimated anew at what was found, because one that is far off is not found from nearby; it ends when that changes
    /// nothing.
    pub fn fit(&self, start: &[f64]) -> Option<EffectFit> {
        let near = |index: usize| self.assessments.get(index);
        let mut best = self.descend(start, self.selection.iterations, self.assess_near(start, &near)?)?;
        for _ in 0..self.selection.restarts {
            let Some(next) = self
                .assess_near(&best.values, &|_| None)
                .and_then(|near| self.descend(&best.values, self.selection.iterations.div_ceil(2), near))
            else {
                break;
            };
            let settled = next.cost > best.cost * (1.0 - RESTART_WORTH);
            if next.cost < best.cost || !runs_alike(&next, &best) {
                best = next;
            }
            if settled {
                break;
            }
        }
        Some(best)
    }

    /// Returns the residuals and slopes at given parameter values, from known assessments of the recordings.
    pub(crate) fn slopes(&self, values: &[f64], near: &[Assessment]) -> Option<Slopes> {
        let free = parameters_of(&self.effects);
        let x: Vec<f64> = free.iter().zip(values).map(|(k, &v)| to_variable(k, v)).collect();
        let shifts = vec![StartShift::default(); near.len()];
        let residual = self.at(&x, near, &shifts)?;
        let now = FitState { cost: mean_square(&residual), x, shifts, residual };
        let starts = self.start_columns(&now, near);
        let left = |own: &Vec<Vec<f64>>| -> Vec<Vec<f64>> {
            own.iter()
                .zip(&starts)
                .map(|(own, starts)| starts.subtract_shift(own, &starts.fit_shift(own)))
                .collect()
        };
        let per_value = |(column, parameter): (&Vec<Vec<f64>>, &&EffectParameter)| {
            let mut left = left(column);
            left.iter_mut().flatten().for_each(|entry| *entry /= parameter.size);
            left
        };
        let columns = self.columns(&now, near);
        Some(Slopes {
            residual: left(&now.residual),
            columns: columns.iter().zip(&free).map(per_value).collect(),
        })
    }

    fn descend(&self, start: &[f64], iterations: usize, near: Vec<Assessment>) -> Option<EffectFit> {
        let free = parameters_of(&self.effects);
        let x: Vec<f64> = free.iter().zip(start).map(|(k, &v)| to_variable(k, v)).collect();
        let shifts = vec![StartShift::default(); near.len()];
        let residual = self.at(&x, &near, &shifts)?;
        let mut now = FitState { cost: mean_square(&residual), x, shifts, residual };
        let mut damping = 1e-2;
        let (mut information, mut scatter) = (Mat::zeros(start.len(), start.len()), Mat::zeros(0, 0));
        let mut columns = Vec::new();
        let mut limit_reached = true;
        for iteration in 0..iterations {
            if self.pool.is_cancelled() {
                break;
            }
            if iteration % STARTS_KEPT == 0 {
                columns = self.start_columns(&now, &near);
            }
            let slopes = self.linearise_cost(&now, &near, &columns);
            let next = self.improve(&now, &slopes, &mut damping, &near);
            (information, scatter) = (slopes.normal, slopes.scatter);
            let settled = next.as_ref().is_none_or(|next| now.cost - next.cost < FIT_TOLERANCE * now.cost);
            now = next.unwrap_or(now);
            if settled {
                limit_reached = false;
                break;
            }
        }
        let values: Vec<f64> = free.iter().zip(&now.x).map(|(k, &v)| from_variable(k, v)).collect();
        let parameters = apply_effects(self.base, &self.effects, &values);
        let effects = self.effects.clone();
        let assessments = self.assessments_at(&parameters, &now, &near);
        Some(EffectFit {
            effects,
            values,
            parameters,
            cost: now.cost,
            information,
            scatter,
            limit_reached,
            assessments,
        })
    }

    /// Assesses the recordings for the mechanism at given parameter values, from what is known of a similar mechanism.
    fn assess_near<'n>(
        &self,
        values: &[f64],
        known: &(dyn Fn(usize) -> Option<&'n Assessment> + Sync),
    ) -> Option<Vec<Assessment>> {
        let parameters = apply_effects(self.base, &self.effects, values);
        let recordings = &self.selection.recordings;
        let one = |index: usize| match known(index) {
            Some(near) => self.simulator.assess_near(&parameters, index, near),
            None => self.simulator.assess(&parameters, index),
        };
        let judged = map(self.pool, recordings.len(), |k| one(recordings[k]));
        judged.into_iter().collect()
    }

    /// Returns the weighted residuals of the fit, recording by recording.
    fn at(&self, x: &[f64], near: &[Assessment], shifts: &[StartShift]) -> Option<Vec<Vec<f64>>> {
        let values: Vec<f64> =
            parameters_of(&self.effects).iter().zip(x).map(|(k, &v)| from_variable(k, v)).collect();
        let parameters = apply_effects(self.base, &self.effects, &values);
        let selected = shifts.iter().enumerate().map(|(place, shift)| SelectedVariant {
            place,
            variant: MechanismVariant { parameters: parameters.clone(), shift: *shift },
        });
        let found = self.residuals_of(&selected.collect::<Vec<_>>(), near);
        let mut all = found.into_iter().collect::<Option<Vec<_>>>()?;
        if !self.preferences.is_empty() {
            all.push(self.preferences.iter().map(|preference| preference.shortfall(&values)).collect());
        }
        Some(all)
    }

    /// Returns the weighted residuals of variants, each in one recording of the selection, side by side; `None` for those that cannot be
    /// simulated, and for all from the first that was not tried because the user asked to stop.
    fn of_variants(&self, variants: &[SelectedVariant], near: &[Assessment]) -> Vec<Option<Vec<f64>>> {
        let together: Vec<&[SelectedVariant]> = variants.chunks(SIDE_BY_SIDE).collect();
        let done = map(self.pool, together.len(), |k| self.residuals_of(together[k], near));
        let mut all: Vec<Option<Vec<f64>>> = done.into_iter().flatten().collect();
        all.resize(variants.len(), None);
        all
    }

    /// Returns the weighted residuals of a few variants.
    fn residuals_of(&self, few: &[SelectedVariant], near: &[Assessment]) -> Vec<Option<Vec<f64>>> {
        let placed = few.iter().map(|one| PlacedVariant {
            variant: one.variant.clone(),
            index: self.selection.recordings[one.place],
            near: &near[one.place],
        });
        let placed: Vec<PlacedVariant> = placed.collect();
        let found = self.simulator.residuals_of_each(&placed, self.selection.span);
        found.into_iter().zip(&placed).map(|(channels, one)| weight_residuals(&channels?, one.near)).collect()
    }

    /// Returns whether the angle at the start of a recording stays where it is: nothing measures it, and a free function of the angle could
    /// move along with it.
    fn keeps_angle(&self, near: &Assessment) -> bool {
        let over_angle = |e: &'static Effect| {
            learned_element(e).is_some_and(|element| element.variable == RegimeVariable::Angle)
        };
        let measured = self.base.sensors.measured.is_position()
            || near.channels.iter().any(|channel| channel.channel == Channel::HubPosition);
        !measured && self.effects.iter().any(|e| over_angle(e))
    }

    /// Returns what each degree of freedom of each recording's initial state does to its residuals.
    fn start_columns(&self, now: &FitState, near: &[Assessment]) -> Vec<StartColumns> {
        let parameters = self.mechanism_at(&now.x);
        let is_free = |&(place, freedom): &(usize, usize)| {
            start_has(&parameters, freedom) && !(freedom == START_ANGLE && self.keeps_angle(&near[place]))
        };
        let places =
            (0..near.len()).flat_map(|place| (0..START_FREEDOMS).map(move |freedom| (place, freedom)));
        let mut wanted: Vec<(usize, usize)> = places.filter(is_free).collect();
        let mut columns = vec![vec![None; START_FREEDOMS]; near.len()];
        for by in [1.0, -1.0] {
            let moved = |&(place, freedom): &(usize, usize)| {
                let mut shift = now.shifts[place];
                shift[freedom] += by;
                SelectedVariant { place, variant: MechanismVariant { parameters: parameters.clone(), shift } }
            };
            let moved: Vec<SelectedVariant> = wanted.iter().map(moved).collect();
            for ((place, freedom), there) in wanted.iter().zip(self.of_variants(&moved, near)) {
                let pairs = there.iter().flatten().zip(&now.residual[*place]);
                let change: Vec<f64> = pairs.map(|(a, b)| (a - b) / by).collect();
                columns[*place][*freedom] = change.iter().any(|c| *c != 0.0).then_some(change);
            }
            wanted.retain(|(place, freedom)| columns[*place][*freedom].is_none());
        }
        columns.into_iter().map(StartColumns::new).collect()
    }

    /// Returns the assessments of the recordings for what was found, without residuals, each with the initial state that was found
    /// with it.
    fn assessments_at(
        &self,
        parameters: &Parameters,
        now: &FitState,
        near: &[Assessment],
    ) -> Vec<(usize, Assessment)> {
        let one = |place: usize| {
            let (index, shift) = (self.selection.recordings[place], &now.shifts[place]);
            let stance = near[place].without_residuals();
            let nudged = self.simulator.residuals_from_shifted_start(
                parameters,
                index,
                Span::Head,
                &near[place],
                shift,
            );
            let stance = match nudged.filter(|_| shift.iter().any(|s| *s != 0.0)) {
                Some((_, start)) => Assessment { start: Some(start), ..stance },
                None => stance,
            };
            (index, stance)
        };
        map(self.pool, near.len(), one)
    }

    /// Returns the mechanism at a point of the fit.
    pub(super) fn mechanism_at(&self, x: &[f64]) -> Parameters {
        let free = parameters_of(&self.effects);
        let values: Vec<f64> = free.iter().zip(x).map(|(k, &v)| from_variable(k, v)).collect();
        apply_effects(self.base, &self.effects, &values)
    }

    /// Returns what each variable changes of the residuals: variable by variable, recording by recording; exact where the simulator knows
    /// the derivatives, else by one-sided differences.
    fn columns(&self, now: &FitState, near: &[Assessment]) -> Vec<Vec<Vec<f64>>> {
        self.exact_columns(now, near).unwrap_or_else(|| self.difference_columns(now, near))
    }

    /// Returns what each variable changes of the residuals, by one-sided differences.
    fn difference_columns(&self, now: &FitState, near: &[Assessment]) -> Vec<Vec<Vec<f64>>> {
        let free = parameters_of(&self.effects);
        let steps: Vec<f64> = free.iter().zip(&now.x).map(|(free, x)| difference_step(free, *x)).collect();
        let values = |j: usize| -> Vec<f64> {
            let moved = |k: usize| if k == j { now.x[k] + steps[k] } else { now.x[k] };
            free.iter().enumerate().map(|(k, free)| from_variable(free, moved(k))).collect()
        };
        let moved: Vec<Parameters> =
            (0..free.len()).map(|j| apply_effects(self.base, &self.effects, &values(j))).collect();
        let places =
            (0..near.len()).flat_map(|place| moved.iter().map(move |parameters| (place, parameters)));
        let variants: Vec<SelectedVariant> = places
            .map(|(place, parameters)| {
                let variant = MechanismVariant { parameters: parameters.clone(), shift: now.shifts[place] };
                SelectedVariant { place, variant }
            })
            .collect();
        let there = self.of_variants(&variants, near);
        (0..free.len())
            .map(|j| {
                let own = (0..near.len()).map(|place| there[place * free.len() + j].clone());
                let mut own: Option<Vec<Vec<f64>>> = own.collect();
                if let Some(own) = own.as_mut().filter(|_| !self.preferences.is_empty()) {
                    let values = values(j);
                    own.push(
                        self.preferences.iter().map(|preference| preference.shortfall(&values)).collect(),
                    );
                }
                let change = |(a, b): (&Vec<f64>, &Vec<f64>)| {
                    a.iter().zip(b).map(|(a, b)| (a - b) / steps[j]).collect()
                };
                own.map_or_else(
                    || now.residual.iter().map(|r| vec![0.0; r.len()]).collect(),
                    |own| own.iter().zip(&now.residual).map(change).collect(),
                )
            })
            .collect()
    }

    /// Returns `J'J / N`, `J'r / N` and the scatter of the latter; what the initial states could do in
    /// place of a parameter is removed from its column.
    fn linearise_cost(&self, now: &FitState, near: &[Assessment], starts: &[StartColumns]) -> LinearisedCost {
        let columns = self.columns(now, near);
        let place = |column: &Vec<Vec<f64>>| -> (Vec<StartShift>, Vec<f64>) {
            let absorbed: Vec<StartShift> =
                starts.iter().zip(column).map(|(starts, own)| starts.fit_shift(own)).collect();
            let left = column.iter().enumerate().flat_map(|(r, own)| match starts.get(r) {
                Some(starts) => starts.subtract_shift(own, &absorbed[r]),
                None => own.clone(),
            });
            let left = left.collect();
            (absorbed, left)
        };
        let (absorbed, columns): (Vec<Vec<StartShift>>, Vec<Vec<f64>>) = columns.iter().map(place).unzip();
        let residual: Vec<f64> = now.residual.iter().flatten().copied().collect();
        let count = residual.len().max(1) as f64;
        let size = columns.len();
        let normal = Mat::from_fn(size, size, |i, j| dot(&columns[i], &columns[j]) / count);
        let gradient = columns.iter().map(|c| dot(c, &residual) / count).collect();
        let places = self.stretches(near, residual.len());
        let sums: Vec<Vec<f64>> = columns.iter().map(|c| stretch_sums(c, &residual, &places)).collect();
        let scatter = Mat::from_fn(size, size, |i, j| long_run(&sums[i], &sums[j]) / (count * count));
        let alone = starts.iter().zip(&now.residual).map(|(s, own)| s.fit_shift(own)).collect();
        LinearisedCost { normal, gradient, scatter, absorbed, alone }
    }

    /// Returns the stretch of time to which each residual belongs; all channels of a recording share it.
    fn stretches(&self, near: &[Assessment], count: usize) -> Vec<usize> {
        let mut places = Vec::with_capacity(count);
        let mut first = 0;
        for judged in near {
            let whole = judged.channels.first().map_or(0, |m| m.residual.len());
            let share = if self.selection.span == Span::Whole { 1.0 } else { FITTED_SHARE };
            let samples = (whole as f64 * share) as usize;
            for _ in &judged.channels {
                places.extend((0..samples).map(|k| first + k / STRETCH));
            }
            first += samples / STRETCH + 1 + STRETCHES_TOGETHER;
        }
        places.resize(count, first);
        places
    }

    /// Returns the first damped step of parameters and initial states that lowers the cost; `None` if no step does.
    fn improve(
        &self,
        now: &FitState,
        slope: &LinearisedCost,
        damping: &mut f64,
        near: &[Assessment],
    ) -> Option<FitState> {
        for _ in 0..7 {
            let step = damped_step(&slope.normal, &slope.gradient, *damping)?;
            let x: Vec<f64> = now.x.iter().zip(&step).map(|(a, b)| a - b).collect();
            let shifts = slope.moved_starts(&now.shifts, &step, 1.0 / (1.0 + *damping));
            let there = self.at(&x, near, &shifts).map(|r| (mean_square(&r), r));
            if let Some((cost, residual)) = there.filter(|c| c.0 < now.cost) {
                *damping = (*damping * 0.1).max(LEAST_DAMPING);
                return Some(FitState { x, shifts, residual, cost });
            }
            *damping *= 10.0;
        }
        None
    }
}

/// Returns whether both fits ran every recording in the same way, so that their costs can be compared.
fn runs_alike(a: &EffectFit, b: &EffectFit) -> bool {
    a.assessments.iter().zip(&b.assessments).all(|(a, b)| a.1.source == b.1.source)
}

/// Returns the residuals of all channels with their weights; `None` if one is not finite.
pub(super) fn weight_residuals(channels: &[ChannelResidual], near: &Assessment) -> Option<Vec<f64>> {
    let weighted = channels.iter().enumerate().flat_map(|(c, channel)| {
        let weight = near.weight(c);
        channel.residual.iter().map(move |r| weight * r)
    });
    let out: Vec<f64> = weighted.collect();
    out.iter().all(|r| r.is_finite()).then_some(out)
}

/// The present point of a fit.
pub(super) struct FitState {
    pub x: Vec<f64>,
    /// The shift of each recording's initial state.
    pub shifts: Vec<StartShift>,
    pub residual: Vec<Vec<f64>>,
    cost: f64,
}

fn difference_step(parameter: &EffectParameter, x: f64) -> f64 {
    let step = if parameter.mapping == ParameterMapping::Whole { 1.0 } else { FIT_STEP };
    let upper = to_variable(parameter, parameter.bounds[1]);
    if x + step > upper { -step } else { step }
}

fn mean_square(residuals: &[Vec<f64>]) -> f64 {
    let count: usize = residuals.iter().map(Vec::len).sum();
    residuals.iter().map(|r| dot(r, r)).sum::<f64>() / count.max(1) as f64
}

/// Returns the inverse of an information matrix. If two parameters only act together, that of the matrix with the least addition that tells
/// them apart: their own variances are then huge, and those of the others are as they would be.
fn covariance_of(information: &Mat) -> Option<Mat> {
    let found = inverse(information).ok().filter(Mat::is_finite);
    found.or_else(|| {
        let mut ridged = information.clone();
        for j in 0..ridged.nrows() {
            ridged[(j, j)] *= 1.0 + INDISTINCT_SHARE;
        }
        inverse(&ridged).ok().filter(Mat::is_finite)
    })
}

/// A variable of a fit in a sum of some.
struct Term {
    variable: usize,
    weight: f64,
}

/// The spread of a fit's values, in the fit's own variables.
struct FitSpread {
    covariance: Option<Mat>,
    sandwich: Option<Mat>,
    scale: f64,
}

impl FitSpread {
    fn of(fit: &EffectFit, samples: usize, inflation: f64) -> Self {
        let covariance = covariance_of(&fit.information);
        let sandwich = covariance.as_ref().map(|c| &(c * &fit.scatter) * c);
        Self { covariance, sandwich, scale: fit.cost.max(1.0) * inflation / samples.max(1) as f64 }
    }

    /// Returns the variance of a sum of variables, each with its weight: the larger of both estimates; infinite if the fit determines none.
    fn variance(&self, terms: &[Term]) -> f64 {
        let of = |matrix: &Mat| {
            let product = |a: &Term, b: &Term| a.weight * matrix[(a.variable, b.variable)] * b.weight;
            let row = |a: &Term| terms.iter().map(|b| product(a, b)).sum::<f64>();
            terms.iter().map(row).sum::<f64>().max(0.0)
        };
        let fisher = self.covariance.as_ref().map_or(f64::INFINITY, |c| of(c) * self.scale);
        fisher.max(self.sandwich.as_ref().map_or(0.0, of))
    }
}

/// Returns half the width of the 95 % band of each free function of a fit at its points, effect after effect, empty for other effects; the band is
/// that of [`confidence_intervals`], carried from the parameters to the values, and empty if the fit determines none.
pub fn value_half_widths(fit: &EffectFit, samples: usize, inflation: f64) -> Vec<Vec<f64>> {
    let spread = FitSpread::of(fit, samples, inflation);
    let mut first = 0;
    let band = |effect: &&'static Effect| {
        let own = first;
        first += effect.parameters.len();
        let rows = value_rows(effect);
        let half = |k: usize| {
            let sized = rows.iter().zip(effect.parameters).enumerate();
            let terms: Vec<Term> = sized
                .map(|(j, (row, parameter))| Term { variable: own + j, weight: row[k] * parameter.size })
                .collect();
            let value: f64 = rows.iter().zip(&fit.values[own..]).map(|(row, value)| row[k] * value).sum();
            1.96 * spread.variance(&terms).sqrt().hypot(SYSTEMATIC * value)
        };
        let band: Vec<f64> = (0..rows.first().map_or(0, Vec::len)).map(half).collect();
        if band.iter().all(|half| half.is_finite()) { band } else { Vec::new() }
    };
    fit.effects.iter().map(band).collect()
}

/// Returns 95 % intervals of a fit's values: the larger of Fisher's information, inflated by the residual's own size and colour,
/// and the sandwich `H^-1 S H^-1` of the gradient's scatter (White 1982), which holds where the residual's colour meets that of
/// the slopes; to it comes what two simulators of the same mechanism differ by.
///
/// `samples` is the number of residuals that the fit saw, `inflation` how many of them carry the information of one.
pub fn confidence_intervals(fit: &EffectFit, samples: usize, inflation: f64) -> Vec<[f64; 2]> {
    let spread = FitSpread::of(fit, samples, inflation);
    let bound = |(j, (parameter, &value)): (usize, (&&'static EffectParameter, &f64))| {
        let systematic = match parameter.mapping {
            ParameterMapping::Log => SYSTEMATIC / parameter.size,
            ParameterMapping::Linear | ParameterMapping::Whole => SYSTEMATIC * value.abs() / parameter.size,
        };
        let deviation = spread.variance(&[Term { variable: j, weight: 1.0 }]).sqrt().hypot(systematic);
        let x = to_variable(parameter, value);
        let [low, high] = [x - 1.96 * deviation, x + 1.96 * deviation];
        [from_variable(parameter, low), from_variable(parameter, high)]
    };
    parameters_of(&fit.effects).iter().zip(&fit.values).enumerate().map(bound).collect()
}
