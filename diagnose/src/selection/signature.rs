//! The signature of an effect: what it changes in the residuals at a small size, linearised.
//!
//! The share of the residual that a combination of an effect's signatures explains ranks the effects, and the coefficients of the
//! combination are where its fit starts.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::tolerance::selection::{PERTURBATIONS_TOGETHER, TRACE_STRIDE};
use counterpoise_linalg::{Mat, solve};
use counterpoise_models::Parameters;

use crate::fitting::output_error::{from_variable, to_variable};
use crate::library::{Effect, EffectParameter};
use crate::recording::series::{dot, rms};
use crate::selection::perturbations::{
    Perturbation, apply_perturbation, first_change, start_values, step_limits,
};
use crate::selection::sizes::Sizes;
use crate::simulator_access::{
    Assessment, ChannelResidual, MechanismVariant, PlacedVariant, SimulatorAccess, Span, StartShift,
};
use crate::tolerance::EXPLAINED;
use crate::tolerance::fitting::GRAM_RIDGE;
use counterpoise_pool::{Pool, map};

/// The signature of an effect: what it explains of the residual, and where its fit should start.
#[derive(Debug, Clone)]
pub struct EffectSignature {
    /// The effect.
    pub effect: &'static Effect,
    /// Parameter values from which to fit.
    pub start: Vec<f64>,
    /// Share of the weighted residual that the signature explains, 0 to 1.
    pub explained: f64,
    /// Size of the signature per recording, for a typical size of the effect, in units of the floor (RMS).
    pub signature: Vec<f64>,
    /// Sum of squares of the signature at a typical size, in units of the floor: what decides detectability.
    pub information: f64,
    /// Size of the effect: the change of its first parameter.
    pub change: f64,
    /// The fitted part of the weighted residual, thinned, for finding effects that act together.
    pub(crate) trace: Vec<f64>,
}

impl EffectSignature {
    /// Returns a signature for an effect whose values are known from elsewhere: it is fitted whatever it explains.
    pub fn from_start(effect: &'static Effect, start: Vec<f64>, recordings: usize) -> Self {
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

impl EffectSignature {
    /// Returns whether its values are known from elsewhere.
    pub fn is_seeded(&self) -> bool {
        self.information.is_infinite()
    }

    /// Returns the signature with its change scaled by `share`: all parameters of a plain effect, only the first of one with a
    /// shape. A ripple keeps its phase if the share is negative.
    pub(crate) fn scale_change(&self, share: f64, base: &Parameters) -> Self {
        let ripple = self.effect.is_ripple();
        let moves = |j: usize| j == 0 || (self.effect.starts.is_empty() && !ripple);
        let share = if ripple { share.abs() } else { share };
        let value = |(j, parameter): (usize, &EffectParameter)| {
            if !moves(j) {
                return self.start[j];
            }
            let from = to_variable(parameter, parameter.read(base));
            from_variable(parameter, from + share * (to_variable(parameter, self.start[j]) - from))
        };
        let start = self.effect.parameters.iter().enumerate().map(value).collect();
        Self { start, ..self.clone() }
    }
}

/// Model and recordings for which signatures are computed.
pub struct ScreeningContext<'a> {
    /// Simulator and recordings.
    pub simulator: &'a dyn SimulatorAccess,
    /// Processors.
    pub pool: &'a dyn Pool,
    /// The mechanism.
    pub base: &'a Parameters,
    /// The assessment of every recording.
    pub judged: &'a [Assessment],
    /// Depth of the computation of a signature.
    pub reach: ScreeningDepth,
    /// Known sizes of the machine.
    pub sizes: Sizes,
}

/// Depth of the computation of a signature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScreeningDepth {
    /// The signature over the first part of the recordings.
    FirstPart,
    /// The signature over all recordings and, if the model is far from them, what the whole change does.
    Full,
}

/// Returns whether every channel is so close to its floor that changes of the mechanism act on it in proportion.
pub fn is_close(judged: &[Assessment]) -> bool {
    judged.iter().all(|j| (0..j.channels.len()).all(|c| j.excess(c) < EXPLAINED))
}

/// One list of residuals a recording, all channels one after the other.
pub(crate) type Residuals = Vec<Vec<f64>>;

/// Returns what a combination of signatures explains of the weighted residual, thinned.
fn trace(here: &WeightedResiduals, signatures: &[Residuals], coefficients: &[f64]) -> Vec<f64> {
    let of = |s: &Residuals, r: usize, k: usize| s[r].get(k).copied().unwrap_or(0.0);
    let taken = |r: usize, k: usize| signatures.iter().zip(coefficients).map(|(s, c)| -c * of(s, r, k)).sum();
    let series = thin_weighted(here, taken);
    let size = dot(&series, &series).sqrt();
    if size > 0.0 {
        return series;
    }
    thin_weighted(here, |r, k| of(&signatures[0], r, k))
}

pub(crate) fn thin_weighted(here: &WeightedResiduals, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let of = |r: usize| (0..here.residuals[r].len()).step_by(TRACE_STRIDE).map(move |k| (r, k));
    (0..here.residuals.len()).flat_map(of).map(|(r, k)| here.weights[r][k] * value(r, k)).collect()
}

/// Residuals with the weights that make every channel of every recording count equally.
#[derive(Debug)]
pub(crate) struct WeightedResiduals {
    pub residuals: Residuals,
    pub weights: Residuals,
}

pub(crate) fn weight_residuals(judged: &[Assessment]) -> WeightedResiduals {
    let weights = |j: &Assessment| -> Vec<f64> {
        let weight = |(c, m): (usize, &ChannelResidual)| {
            let size = m.relative_rms().max(1.0).max(1.0 / j.weight(c));
            vec![1.0 / size; m.residual.len()]
        };
        j.channels.iter().enumerate().flat_map(weight).collect()
    };
    let residuals = |j: &Assessment| j.channels.iter().flat_map(|m| m.residual.iter().copied()).collect();
    WeightedResiduals {
        residuals: judged.iter().map(residuals).collect(),
        weights: judged.iter().map(weights).collect(),
    }
}

/// The data from which signatures are computed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SignatureData<'a> {
    /// The residuals of the model as it is.
    pub here: &'a WeightedResiduals,
    /// The recordings that are replayed.
    pub recordings: &'a [usize],
    /// The part of each.
    pub span: Span,
}

/// Computes the signatures of perturbations, whose replays run side by side; `None` for one with which the mechanism cannot be simulated. The
/// perturbations are shared among the processors; `finished` is told how many are done.
pub(crate) fn measure_signatures(
    scene: &ScreeningContext,
    data: SignatureData<'_>,
    perturbations: &[Perturbation],
    finished: &(dyn Fn(usize) + Sync),
) -> Vec<Option<EffectSignature>> {
    let few: Vec<&[Perturbation]> = perturbations.chunks(PERTURBATIONS_TOGETHER).collect();
    let done = AtomicUsize::new(0);
    let found = map(scene.pool, few.len(), |k| {
        let found = measure_few(scene, data, few[k]);
        finished(done.fetch_add(found.len(), Ordering::Relaxed) + found.len());
        found
    });
    found.into_iter().flatten().collect()
}

/// Computes the signatures of a few perturbations.
fn measure_few(
    scene: &ScreeningContext,
    data: SignatureData<'_>,
    perturbations: &[Perturbation],
) -> Vec<Option<EffectSignature>> {
    let moved = perturbations.iter().flat_map(|perturbation| {
        perturbation
            .directions
            .iter()
            .map(|direction| apply_perturbation(scene.base, perturbation, direction))
    });
    let moved: Vec<Parameters> = moved.collect();
    let mut changed = vec![Some(vec![Vec::new(); scene.judged.len()]); moved.len()];
    for &index in data.recordings {
        let near = &scene.judged[index];
        let variant = |parameters: &Parameters| MechanismVariant {
            parameters: parameters.clone(),
            shift: StartShift::default(),
        };
        let placed = moved.iter().map(|one| PlacedVariant { variant: variant(one), index, near });
        let found = scene.simulator.residuals_of_each(&placed.collect::<Vec<_>>(), data.span);
        for (changed, there) in changed.iter_mut().zip(found) {
            match (changed.as_mut(), there) {
                (Some(changed), Some(there)) => changed[index] = changes(&there, &near.channels),
                _ => *changed = None,
            }
        }
    }
    let mut changed = changed.into_iter();
    let of_one = |perturbation: &Perturbation| {
        let signatures: Vec<Option<Residuals>> =
            changed.by_ref().take(perturbation.directions.len()).collect();
        let signatures = signatures.into_iter().collect::<Option<Vec<_>>>()?;
        make_signature(scene, data.here, perturbation, &signatures)
    };
    perturbations.iter().map(of_one).collect()
}

/// Returns the signature of a perturbation from what each of its directions changes; `None` if that is not finite.
fn make_signature(
    scene: &ScreeningContext,
    here: &WeightedResiduals,
    perturbation: &Perturbation,
    signatures: &[Residuals],
) -> Option<EffectSignature> {
    if !signatures.iter().flatten().flatten().all(|d| d.is_finite()) {
        return None;
    }
    let limits = step_limits(perturbation, scene.sizes);
    let (coefficients, explained) = regress(here, signatures, &limits)?;
    let start = start_values(perturbation, &coefficients, limits[0][1]);
    let size = (0..scene.judged.len()).map(|r| rms(&signatures[0][r])).collect();
    let information = signatures[0].iter().flatten().map(|d| d * d).sum();
    let change = first_change(perturbation);
    let trace = trace(here, signatures, &coefficients);
    Some(EffectSignature {
        effect: perturbation.effect,
        start,
        explained,
        signature: size,
        information,
        change,
        trace,
    })
}

/// Returns what a change of the mechanism does to the residuals; 0 beyond the part that was run.
fn changes(there: &[ChannelResidual], here: &[ChannelResidual]) -> Vec<f64> {
    let channel = |(t, h): (&ChannelResidual, &ChannelResidual)| {
        let mut out = vec![0.0; h.residual.len()];
        for ((o, a), b) in out.iter_mut().zip(&t.residual).zip(&h.residual) {
            *o = a - b;
        }
        out
    };
    there.iter().zip(here).flat_map(channel).collect()
}

/// Returns the coefficients of the weighted least squares of the residual on the signatures, and the share explained.
fn regress(
    here: &WeightedResiduals,
    signatures: &[Residuals],
    limits: &[[f64; 2]],
) -> Option<(Vec<f64>, f64)> {
    let inner = |a: &Residuals, b: &Residuals| -> f64 {
        let recordings = a.iter().zip(b).zip(&here.weights);
        recordings
            .map(|((a, b), w)| a.iter().zip(b).zip(w).map(|((x, y), w)| x * y * w * w).sum::<f64>())
            .sum()
    };
    let count = signatures.len();
    let gram = Mat::from_fn(count, count, |i, j| inner(&signatures[i], &signatures[j]));
    let ridge = GRAM_RIDGE * gram.trace().max(f64::MIN_POSITIVE);
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
