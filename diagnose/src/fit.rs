//! Output-error fit: Levenberg and Marquardt's method on the simulator's residuals.

use counterpoise_linalg::{Mat, inverse, solve};
use counterpoise_models::Parameters;

use crate::bench::{Bench, Judged, Pool, Span, map};
use crate::library::{Effect, Knob, Mapping};
use crate::tolerance::{
    FIT_ITERATIONS, FIT_STEP, FIT_TOLERANCE, FITTED_SHARE, RESTART_WORTH, RESTARTS, SEARCH_ITERATIONS,
    STRETCH, STRETCHES_TOGETHER, SYSTEMATIC, TRIAL_ITERATIONS, TRIAL_RESTARTS,
};

/// Which recordings a fit may see.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Recordings.
    pub recordings: Vec<usize>,
    /// How much of each.
    pub span: Span,
    /// Iterations at the most.
    pub iterations: usize,
    /// Times at the most that the recordings' starts are sought anew at what was found.
    pub restarts: usize,
}

impl Selection {
    /// Every recording, whole, to the end.
    pub fn all(count: usize) -> Self {
        Self { span: Span::Whole, ..Self::heads((0..count).collect()) }
    }

    /// The first part of some recordings, to the end.
    pub fn heads(recordings: Vec<usize>) -> Self {
        Self { recordings, span: Span::Head, iterations: FIT_ITERATIONS, restarts: RESTARTS }
    }

    /// The first part of some recordings, for a comparison of candidates.
    pub fn searching(recordings: Vec<usize>) -> Self {
        Self { iterations: SEARCH_ITERATIONS, ..Self::heads(recordings) }
    }

    /// The first part of some recordings, for a first impression.
    pub fn trying(recordings: Vec<usize>) -> Self {
        Self { iterations: TRIAL_ITERATIONS, restarts: TRIAL_RESTARTS, ..Self::heads(recordings) }
    }
}

/// A fitted set of effects.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The effects, in the order in which they were found.
    pub effects: Vec<&'static Effect>,
    /// Their knobs' values, effect after effect.
    pub values: Vec<f64>,
    /// The mechanism with the effects.
    pub parameters: Parameters,
    /// Mean square of the residual over what the fit saw.
    pub cost: f64,
    /// Curvature of the cost in the fit's own variables, for intervals.
    pub information: Mat,
    /// Scatter of the cost's gradient, stretch of time by stretch: what the noise, coloured as it is, does to it.
    pub scatter: Mat,
    /// Whether the iteration limit was reached before the cost settled.
    pub limit_reached: bool,
    /// The recordings that it saw, and how each stands to it, without the residuals.
    pub stances: Vec<(usize, Judged)>,
}

/// All knobs of a list of effects.
pub fn knobs(effects: &[&'static Effect]) -> Vec<&'static Knob> {
    effects.iter().flat_map(|effect| effect.knobs.iter()).collect()
}

/// The mechanism with several effects' knobs set.
pub fn applied(base: &Parameters, effects: &[&'static Effect], values: &[f64]) -> Parameters {
    let mut changed = base.clone();
    for (knob, &value) in knobs(effects).iter().zip(values) {
        (knob.set)(&mut changed, value);
    }
    changed
}

pub(crate) fn to_variable(knob: &Knob, value: f64) -> f64 {
    match knob.mapping {
        Mapping::Log => value.max(f64::MIN_POSITIVE).ln() / knob.size,
        Mapping::Linear | Mapping::Whole => value / knob.size,
    }
}

pub(crate) fn from_variable(knob: &Knob, variable: f64) -> f64 {
    let value = match knob.mapping {
        Mapping::Log => (variable * knob.size).exp(),
        Mapping::Linear => variable * knob.size,
        Mapping::Whole => (variable * knob.size).round(),
    };
    value.clamp(knob.bounds[0], knob.bounds[1])
}

/// The problem that a fit solves: fixed but for the knobs.
pub struct Problem<'a> {
    /// Simulator and recordings.
    pub bench: &'a dyn Bench,
    /// Processors.
    pub pool: &'a dyn Pool,
    /// What the fit may see.
    pub selection: &'a Selection,
    /// The mechanism without the effects.
    pub base: &'a Parameters,
    /// The effects to fit.
    pub effects: Vec<&'static Effect>,
    /// How every recording stands to a mechanism nearby; empty where none was judged.
    pub stances: &'a [Judged],
}

impl Problem<'_> {
    /// Fits from the given knob values, with the recordings' starts as they are there; again with those at what was found,
    /// sought anew (from nearby they would stay where the wrong values had put them), until that changes nothing any more.
    pub fn fit(&self, start: &[f64]) -> Option<Fit> {
        let near = |index: usize| self.stances.get(index);
        let mut best = self.descend(start, self.selection.iterations, self.near(start, &near)?)?;
        for _ in 0..self.selection.restarts {
            let Some(next) = self
                .near(&best.values, &|_| None)
                .and_then(|near| self.descend(&best.values, self.selection.iterations.div_ceil(2), near))
            else {
                break;
            };
            let settled = next.cost > best.cost * (1.0 - RESTART_WORTH);
            best = next;
            if settled {
                break;
            }
        }
        Some(best)
    }

    fn descend(&self, start: &[f64], iterations: usize, near: Vec<Judged>) -> Option<Fit> {
        let knobs = knobs(&self.effects);
        let mut x: Vec<f64> = knobs.iter().zip(start).map(|(k, &v)| to_variable(k, v)).collect();
        let mut residual = self.at(&x, &near)?;
        let mut cost = mean_square(&residual);
        let mut damping = 1e-2;
        let mut information = Mat::zeros(x.len(), x.len());
        let mut scatter = information.clone();
        let mut limit_reached = true;
        for _ in 0..iterations {
            if self.pool.cancelled() {
                break;
            }
            let slopes = self.linearised(&x, &residual, &near);
            (information, scatter) = (slopes.normal, slopes.scatter);
            let gradient = slopes.gradient;
            let slope = Slope { normal: &information, gradient: &gradient };
            let Some(step) = self.improve(&x, cost, &slope, &mut damping, &near) else {
                limit_reached = false;
                break;
            };
            let settled = cost - step.cost < FIT_TOLERANCE * cost;
            (x, residual, cost) = (step.x, step.residual, step.cost);
            if settled {
                limit_reached = false;
                break;
            }
        }
        let values: Vec<f64> = knobs.iter().zip(&x).map(|(k, &v)| from_variable(k, v)).collect();
        let parameters = applied(self.base, &self.effects, &values);
        let effects = self.effects.clone();
        let stances =
            self.selection.recordings.iter().copied().zip(near.iter().map(Judged::stance)).collect();
        Some(Fit { effects, values, parameters, cost, information, scatter, limit_reached, stances })
    }

    /// How the recordings stand to the mechanism at given knob values, from what is known of a mechanism nearby.
    fn near<'n>(
        &self,
        values: &[f64],
        known: &(dyn Fn(usize) -> Option<&'n Judged> + Sync),
    ) -> Option<Vec<Judged>> {
        let parameters = applied(self.base, &self.effects, values);
        let recordings = &self.selection.recordings;
        let one = |index: usize| match known(index) {
            Some(near) => self.bench.judge_near(&parameters, index, near),
            None => self.bench.judge(&parameters, index),
        };
        let judged = map(self.pool, recordings.len(), |k| one(recordings[k]));
        judged.into_iter().collect()
    }

    /// The weighted residuals that the fit sees, one recording after the other.
    fn at(&self, x: &[f64], near: &[Judged]) -> Option<Vec<f64>> {
        let values: Vec<f64> =
            knobs(&self.effects).iter().zip(x).map(|(k, &v)| from_variable(k, v)).collect();
        let parameters = applied(self.base, &self.effects, &values);
        let mut out = Vec::new();
        for (&index, near) in self.selection.recordings.iter().zip(near) {
            let misfits = self.bench.misfit(&parameters, index, self.selection.span, near)?;
            for (c, misfit) in misfits.iter().enumerate() {
                let weight = near.weight(c);
                out.extend(misfit.residual.iter().map(|r| weight * r));
            }
        }
        out.iter().all(|r| r.is_finite()).then_some(out)
    }

    /// `J'J / N`, `J'r / N` and the scatter of the latter, by one-sided differences.
    fn linearised(&self, x: &[f64], residual: &[f64], near: &[Judged]) -> Linearised {
        let knobs = knobs(&self.effects);
        let columns = map(self.pool, x.len(), |j| {
            let step = difference_step(knobs[j], x[j]);
            let mut moved = x.to_vec();
            moved[j] += step;
            let there = self.at(&moved, near)?;
            Some(there.iter().zip(residual).map(|(a, b)| (a - b) / step).collect::<Vec<f64>>())
        });
        let count = residual.len().max(1) as f64;
        let column = |j: usize| columns.get(j).and_then(|c| c.as_deref()).unwrap_or(&[]);
        let normal = Mat::from_fn(x.len(), x.len(), |i, j| dot(column(i), column(j)) / count);
        let gradient = (0..x.len()).map(|j| dot(column(j), residual) / count).collect();
        let places = self.stretches(near, residual.len());
        let sums: Vec<Vec<f64>> = (0..x.len()).map(|j| stretch_sums(column(j), residual, &places)).collect();
        let scatter = Mat::from_fn(x.len(), x.len(), |i, j| long_run(&sums[i], &sums[j]) / (count * count));
        Linearised { normal, gradient, scatter }
    }

    /// The stretch of time that each residual belongs to, all channels of a recording alike.
    fn stretches(&self, near: &[Judged], count: usize) -> Vec<usize> {
        let mut places = Vec::with_capacity(count);
        let mut first = 0;
        for judged in near {
            let whole = judged.misfits.first().map_or(0, |m| m.residual.len());
            let share = if self.selection.span == Span::Whole { 1.0 } else { FITTED_SHARE };
            let samples = (whole as f64 * share) as usize;
            for _ in &judged.misfits {
                places.extend((0..samples).map(|k| first + k / STRETCH));
            }
            first += samples / STRETCH + 1 + STRETCHES_TOGETHER;
        }
        places.resize(count, first);
        places
    }

    /// The first damped step that lowers the cost; none where no step does.
    fn improve(
        &self,
        x: &[f64],
        cost: f64,
        slope: &Slope,
        damping: &mut f64,
        near: &[Judged],
    ) -> Option<Step> {
        for _ in 0..7 {
            let step = damped_step(slope.normal, slope.gradient, *damping)?;
            let moved: Vec<f64> = x.iter().zip(&step).map(|(a, b)| a - b).collect();
            let candidate = self.at(&moved, near).map(|r| (mean_square(&r), r));
            if let Some((lower, residual)) = candidate.filter(|c| c.0 < cost) {
                *damping = (*damping * 0.1).max(1e-9);
                return Some(Step { x: moved, residual, cost: lower });
            }
            *damping *= 10.0;
        }
        None
    }
}

/// Sums of slope x residual, stretch by stretch.
fn stretch_sums(slope: &[f64], residual: &[f64], places: &[usize]) -> Vec<f64> {
    let mut sums = vec![0.0; places.iter().max().map_or(0, |last| last + 1)];
    for ((j, r), &place) in slope.iter().zip(residual).zip(places) {
        sums[place] += j * r;
    }
    sums
}

/// Sum of the products of two series over all lags up to [`STRETCHES_TOGETHER`], with Bartlett's weights (Newey and
/// West 1987): never negative for a series with itself.
fn long_run(a: &[f64], b: &[f64]) -> f64 {
    let lagged = |lag: usize| dot(a.get(lag..).unwrap_or(&[]), b) + dot(a, b.get(lag..).unwrap_or(&[]));
    let weight = |lag: usize| 1.0 - lag as f64 / (STRETCHES_TOGETHER + 1) as f64;
    dot(a, b) + (1..=STRETCHES_TOGETHER).map(|lag| weight(lag) * lagged(lag)).sum::<f64>()
}

/// Curvature and gradient of the cost, and the gradient's scatter.
struct Linearised {
    normal: Mat,
    gradient: Vec<f64>,
    scatter: Mat,
}

/// Curvature and gradient of the cost.
struct Slope<'a> {
    normal: &'a Mat,
    gradient: &'a [f64],
}

struct Step {
    x: Vec<f64>,
    residual: Vec<f64>,
    cost: f64,
}

fn difference_step(knob: &Knob, x: f64) -> f64 {
    let step = if knob.mapping == Mapping::Whole { 1.0 } else { FIT_STEP };
    let upper = to_variable(knob, knob.bounds[1]);
    if x + step > upper { -step } else { step }
}

fn damped_step(normal: &Mat, gradient: &[f64], damping: f64) -> Option<Vec<f64>> {
    let largest = normal.diagonal().into_iter().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let mut damped = normal.clone();
    for i in 0..gradient.len() {
        damped[(i, i)] += damping * normal[(i, i)].max(1e-9 * largest);
    }
    let step = solve(&damped, &Mat::col(gradient)).ok()?;
    step.is_finite().then(|| step.as_slice().to_vec())
}

fn mean_square(series: &[f64]) -> f64 {
    dot(series, series) / series.len().max(1) as f64
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// 95 % intervals of a fit's values: the larger of Fisher's information, inflated by the residual's own size and colour,
/// and the sandwich `H^-1 S H^-1` of the gradient's scatter (White 1982), which holds where the residual's colour meets
/// that of the slopes; to it comes what two simulators of the same mechanism differ by.
///
/// `samples` is the number of residuals that the fit saw, `inflation` how many of them carry the information of one.
pub fn intervals(fit: &Fit, samples: usize, inflation: f64) -> Vec<[f64; 2]> {
    let covariance = inverse(&fit.information).ok();
    let sandwich = covariance.as_ref().map(|c| &(c * &fit.scatter) * c);
    let scale = fit.cost.max(1.0) * inflation / samples.max(1) as f64;
    let bound = |(j, (knob, &value)): (usize, (&&'static Knob, &f64))| {
        let fisher = covariance.as_ref().map_or(f64::INFINITY, |c| c[(j, j)].max(0.0) * scale);
        let coloured = sandwich.as_ref().map_or(0.0, |s| s[(j, j)].max(0.0));
        let systematic = match knob.mapping {
            Mapping::Log => SYSTEMATIC / knob.size,
            Mapping::Linear | Mapping::Whole => SYSTEMATIC * value.abs() / knob.size,
        };
        let deviation = fisher.max(coloured).sqrt().hypot(systematic);
        let x = to_variable(knob, value);
        let [low, high] = [x - 1.96 * deviation, x + 1.96 * deviation];
        [from_variable(knob, low), from_variable(knob, high)]
    };
    knobs(&fit.effects).iter().zip(&fit.values).enumerate().map(bound).collect()
}
