//! The first look: which effects, by their linearised signature in every channel, could explain the misfit.
//!
//! Each effect is tried at a small size in the simulator; the change that it makes to the residuals is its
//! signature. The share of the residual that a combination of an effect's signatures explains ranks the effects,
//! and the coefficients of the combination are where its fit starts.

use counterpoise_linalg::{Mat, solve};
use counterpoise_models::Parameters;

use crate::bench::{Bench, Judged, Misfit, Pool, Span, map, rms};
use crate::fit::{from_variable, to_variable};
use crate::library::{Effect, Knob};
use crate::scan::{best_orders, scanned};
use crate::score::{Part, score};
use crate::tolerance::{EXPLAINED, GAIN_NEEDED, TEXTBOOK_GAIN_NEEDED};
use crate::trials::{Combine, Trial, first_change, limits, moved, start_values, trials};

/// How well an effect's signature explains the misfit, and where its fit should start.
#[derive(Debug, Clone)]
pub struct Look {
    /// The effect.
    pub effect: &'static Effect,
    /// Knob values from which to fit.
    pub start: Vec<f64>,
    /// Share of the weighted residual that the signature explains, 0 to 1.
    pub explained: f64,
    /// Size of the signature per recording, for a typical size of the effect, in units of the floor (RMS).
    pub signature: Vec<f64>,
    /// Sum of squares of the signature at a typical size, in units of the floor: what decides detectability.
    pub information: f64,
    /// That size: the change of the first knob.
    pub change: f64,
    /// The fitted part of the weighted residual, thinned, for finding effects that act together.
    pub(crate) trace: Vec<f64>,
}

impl Look {
    /// A look at an effect whose values are known from elsewhere: it is fitted whatever its signature.
    pub fn seeded(effect: &'static Effect, start: Vec<f64>, recordings: usize) -> Self {
        Self {
            effect,
            start,
            explained: 0.0,
            signature: vec![1.0; recordings],
            information: f64::INFINITY,
            change: 0.0,
            trace: Vec::new(),
        }
    }
}

impl Look {
    /// Whether its values are known from elsewhere.
    pub fn is_seeded(&self) -> bool {
        self.information.is_infinite()
    }

    /// The look with its change taken `share` times: all knobs of a plain effect, the first of one with a shape. A ripple
    /// that is taken the other way round stays as it is.
    pub(crate) fn scaled(&self, share: f64, base: &Parameters) -> Self {
        let ripple = is_ripple(self.effect);
        let moves = |j: usize| j == 0 || (self.effect.starts.is_empty() && !ripple);
        let share = if ripple { share.abs() } else { share };
        let value = |(j, knob): (usize, &Knob)| {
            if !moves(j) {
                return self.start[j];
            }
            let from = to_variable(knob, knob.read(base));
            from_variable(knob, from + share * (to_variable(knob, self.start[j]) - from))
        };
        let start = self.effect.knobs.iter().enumerate().map(value).collect();
        Self { start, ..self.clone() }
    }
}

/// What is known of a machine's sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Whether the library's typical sizes are typical of the machine: one like the reference rig.
    pub typical: bool,
    /// Turns of the motor, as the model counts them, per turn of the machine's own motor.
    pub motor_turns: f64,
}

impl Sizes {
    /// Those of a machine like the reference rig.
    pub const TYPICAL: Self = Self { typical: true, motor_turns: 1.0 };

    /// Log-likelihood that an effect must gain on data that it was not fitted to, in nats.
    pub fn gain_needed(&self) -> f64 {
        if self.typical { GAIN_NEEDED } else { TEXTBOOK_GAIN_NEEDED }
    }
}

/// One list of residuals a recording, all channels one after the other.
pub(crate) type Residuals = Vec<Vec<f64>>;

/// What a look's combination of signatures takes off the weighted residual, thinned.
fn trace(here: &Weighted, signatures: &[Residuals], coefficients: &[f64]) -> Vec<f64> {
    let of = |s: &Residuals, r: usize, k: usize| s[r].get(k).copied().unwrap_or(0.0);
    let taken = |r: usize, k: usize| signatures.iter().zip(coefficients).map(|(s, c)| -c * of(s, r, k)).sum();
    let series = thinned(here, taken);
    let size = dot(&series, &series).sqrt();
    if size > 0.0 {
        return series;
    }
    thinned(here, |r, k| of(&signatures[0], r, k))
}

pub(crate) fn thinned(here: &Weighted, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let of = |r: usize| (0..here.residuals[r].len()).step_by(TRACE_STRIDE).map(move |k| (r, k));
    (0..here.residuals.len()).flat_map(of).map(|(r, k)| here.weights[r][k] * value(r, k)).collect()
}

/// Every how many samples one is kept of a trace.
const TRACE_STRIDE: usize = 7;

/// Looks at every effect of the library but those already taken; best first.
pub fn first_look(scene: &Scene, effects: &[&'static Effect]) -> Vec<Look> {
    let (repeating, plain): (Vec<&'static Effect>, Vec<&'static Effect>) =
        effects.iter().partition(|e| is_ripple(e) && e.starts.is_empty());
    let mut trials: Vec<Trial> = plain.iter().flat_map(|effect| trials(effect, scene)).collect();
    for effect in repeating {
        trials.extend(best_orders(scene, effect));
    }
    trials.extend(effects.iter().filter_map(|effect| scanned(scene, effect)));
    let here = weighted(scene.judged);
    let all: Vec<usize> = (0..scene.judged.len()).collect();
    let span = if scene.reach == Reach::Whole { Span::Whole } else { Span::Head };
    let found =
        map(scene.pool, trials.len(), |t| look(scene, &here, &trials[t], &all, span).map(|look| (t, look)));
    let mut found: Vec<(usize, Look)> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.1.explained.total_cmp(&a.1.explained));
    let mut looks = visited(scene, &trials, found);
    looks.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    looks
}

/// Whether every channel is so close to its floor that changes of the mechanism act on it in proportion.
pub fn is_close(judged: &[Judged]) -> bool {
    judged.iter().all(|j| (0..j.misfits.len()).all(|c| j.excess(c) < EXPLAINED))
}

/// What a look is taken at.
pub struct Scene<'a> {
    /// Simulator and recordings.
    pub bench: &'a dyn Bench,
    /// Processors.
    pub pool: &'a dyn Pool,
    /// The mechanism.
    pub base: &'a Parameters,
    /// How every recording stands to it.
    pub judged: &'a [Judged],
    /// How much is asked of a look.
    pub reach: Reach,
    /// What is known of the machine's sizes.
    pub sizes: Sizes,
}

/// How much is asked of a look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// The signature over the first part of the recordings.
    Signature,
    /// The signature over all of them and, where the model is far from them, what the whole change does.
    Whole,
}

/// The looks, those at the best starts of effects that are not small taken all the way, where the model is far from the
/// recordings.
fn visited(scene: &Scene, trials: &[Trial], found: Vec<(usize, Look)>) -> Vec<Look> {
    let thorough = scene.reach == Reach::Whole && !is_close(scene.judged);
    let of_effect = |k: usize| {
        let same = |(t, l): &&(usize, Look)| {
            std::ptr::eq(l.effect, found[k].1.effect) && trials[*t].combine == Combine::Towards
        };
        found[..k].iter().filter(same).count()
    };
    let goes = |k: usize| {
        thorough && trials[found[k].0].combine == Combine::Towards && of_effect(k) < STARTS_VISITED
    };
    map(scene.pool, found.len(), |k| {
        let (t, look) = &found[k];
        if goes(k) { gone_there(scene, &trials[*t], look.clone()) } else { look.clone() }
    })
}

/// Starts of an effect that are taken all the way.
const STARTS_VISITED: usize = 3;

/// A look at an effect that is not small: what going all the way to its start does to the fit counts, too, for a
/// signature that is not proportional to the size of its effect says little.
fn gone_there(scene: &Scene, trial: &Trial, mut seen: Look) -> Look {
    let parameters = moved(scene.base, trial, &trial.directions[0]);
    let judged: Option<Vec<Judged>> =
        (0..scene.judged.len()).map(|r| scene.bench.glance(&parameters, r, &scene.judged[r])).collect();
    let (Some(there), Some(here)) = (judged.and_then(|j| distance(&j)), distance(scene.judged)) else {
        return seen;
    };
    let gained = 1.0 - there / here.max(f64::MIN_POSITIVE);
    if gained > seen.explained {
        let x = trial.origin.iter().zip(&trial.directions[0]).map(|(a, b)| a + b);
        seen.start = trial.effect.knobs.iter().zip(x).map(|(k, x)| from_variable(k, x)).collect();
        seen.explained = gained;
    }
    seen
}

/// Distance of judged recordings from the floor.
fn distance(judged: &[Judged]) -> Option<f64> {
    let part = |r| Part { recording: r, from: 0.0, to: 1.0 };
    let parts: Vec<Part> = (0..judged.len()).map(part).collect();
    score(judged, &parts).map(|score| score.distance())
}

/// Residuals, and the weight that makes every channel of every recording count alike.
pub(crate) struct Weighted {
    pub residuals: Residuals,
    pub weights: Residuals,
}

pub(crate) fn weighted(judged: &[Judged]) -> Weighted {
    let weights = |j: &Judged| -> Vec<f64> {
        let weight = |(c, m): (usize, &Misfit)| {
            let size = m.relative_rms().max(1.0).max(1.0 / j.weight(c));
            vec![1.0 / size; m.residual.len()]
        };
        j.misfits.iter().enumerate().flat_map(weight).collect()
    };
    let residuals = |j: &Judged| j.misfits.iter().flat_map(|m| m.residual.iter().copied()).collect();
    Weighted {
        residuals: judged.iter().map(residuals).collect(),
        weights: judged.iter().map(weights).collect(),
    }
}

/// The look at one trial in some recordings.
pub(crate) fn look(
    scene: &Scene,
    here: &Weighted,
    trial: &Trial,
    recordings: &[usize],
    span: Span,
) -> Option<Look> {
    let signature = |direction: &Vec<f64>| -> Option<Residuals> {
        let parameters = moved(scene.base, trial, direction);
        let mut out = vec![Vec::new(); scene.judged.len()];
        for &r in recordings {
            let there = scene.bench.misfit(&parameters, r, span, &scene.judged[r])?;
            out[r] = changes(&there, &scene.judged[r].misfits);
        }
        out.iter().flatten().all(|d| d.is_finite()).then_some(out)
    };
    let signatures: Vec<Residuals> = trial.directions.iter().map(signature).collect::<Option<_>>()?;
    let limits = limits(trial, scene.sizes);
    let (coefficients, explained) = regress(here, &signatures, &limits)?;
    let start = start_values(trial, &coefficients, limits[0][1]);
    let size = (0..scene.judged.len()).map(|r| rms(&signatures[0][r])).collect();
    let information = signatures[0].iter().flatten().map(|d| d * d).sum();
    let change = first_change(trial);
    let trace = trace(here, &signatures, &coefficients);
    Some(Look { effect: trial.effect, start, explained, signature: size, information, change, trace })
}

/// What a change of the mechanism does to the residuals; where only the first part was run, the rest stays 0.
fn changes(there: &[Misfit], here: &[Misfit]) -> Vec<f64> {
    let channel = |(t, h): (&Misfit, &Misfit)| {
        let mut out = vec![0.0; h.residual.len()];
        for ((o, a), b) in out.iter_mut().zip(&t.residual).zip(&h.residual) {
            *o = a - b;
        }
        out
    };
    there.iter().zip(here).flat_map(channel).collect()
}

/// Weighted least squares of the residual on the signatures: coefficients, and the share explained.
fn regress(here: &Weighted, signatures: &[Residuals], limits: &[[f64; 2]]) -> Option<(Vec<f64>, f64)> {
    let inner = |a: &Residuals, b: &Residuals| -> f64 {
        let recordings = a.iter().zip(b).zip(&here.weights);
        recordings
            .map(|((a, b), w)| a.iter().zip(b).zip(w).map(|((x, y), w)| x * y * w * w).sum::<f64>())
            .sum()
    };
    let count = signatures.len();
    let gram = Mat::from_fn(count, count, |i, j| inner(&signatures[i], &signatures[j]));
    let ridge = 1e-9 * gram.trace().max(f64::MIN_POSITIVE);
    let gram = &gram + &Mat::eye(count).scale(ridge);
    let right: Vec<f64> = signatures.iter().map(|s| -inner(s, &here.residuals)).collect();
    let mut coefficients = solve(&gram, &Mat::col(&right)).ok()?.as_slice().to_vec();
    coefficients.iter_mut().zip(limits).for_each(|(c, limit)| *c = c.clamp(limit[0], limit[1]));
    let total: f64 = (0..here.residuals.len())
        .filter(|&r| !signatures[0][r].is_empty())
        .map(|r| here.residuals[r].iter().zip(&here.weights[r]).map(|(x, w)| x * x * w * w).sum::<f64>())
        .sum();
    let c = Mat::col(&coefficients);
    let left = total - 2.0 * dot(&coefficients, &right) + (&c.t() * &(&gram * &c))[(0, 0)];
    let explained = 1.0 - left / total.max(f64::MIN_POSITIVE);
    explained.is_finite().then_some((coefficients, explained))
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Whether the knobs are amplitude, order and phase.
pub fn is_ripple(effect: &Effect) -> bool {
    effect.knobs.len() == 3 && effect.knobs[1].name == "order"
}
