//! Screening: which effects, by their linearised signature in every channel, could explain the residual.
//!
//! Each effect is tried at a small size in the simulator; the change that it makes to the residuals is its
//! signature. The share of the residual that a combination of an effect's signatures explains ranks the effects,
//! and the coefficients of the combination are where its fit starts.

use crate::fitting::output_error::from_variable;
use crate::fitting::score::{RecordingPart, score_parts};
use crate::library::Effect;
use crate::selection::parameter_scan::{scan_parameter, scan_ripple_orders};
use crate::selection::perturbations::{Combination, Perturbation, apply_perturbation, perturbations_of};
use crate::selection::signature::{
    EffectSignature, ScreeningContext, ScreeningDepth, SignatureData, is_close, measure_signatures,
    weight_residuals,
};
use crate::simulator_access::{Assessment, Span};
use crate::tolerance::selection::STARTS_VISITED;
use counterpoise_pool::map_with_progress;

/// Screens every effect of the library but those already in the model; returns signatures, best first.
pub fn screen_effects(scene: &ScreeningContext, effects: &[&'static Effect]) -> Vec<EffectSignature> {
    let (repeating, plain): (Vec<&'static Effect>, Vec<&'static Effect>) =
        effects.iter().partition(|e| e.is_ripple() && e.starts.is_empty());
    let mut perturbations: Vec<Perturbation> =
        plain.iter().flat_map(|effect| perturbations_of(effect, scene.base, scene.sizes)).collect();
    let scans = repeating.len() + effects.len();
    for (k, effect) in repeating.into_iter().enumerate() {
        scene.pool.progress("scanning", k, scans);
        perturbations.extend(scan_ripple_orders(scene, effect));
    }
    for (k, effect) in effects.iter().enumerate() {
        scene.pool.progress("scanning", scans - effects.len() + k, scans);
        perturbations.extend(scan_parameter(scene, effect));
    }
    let here = weight_residuals(scene.judged);
    let all: Vec<usize> = (0..scene.judged.len()).collect();
    let span = if scene.reach == ScreeningDepth::Full { Span::Whole } else { Span::Head };
    let data = SignatureData { here: &here, recordings: &all, span };
    let count = perturbations.len();
    let progress = |done: usize| scene.pool.progress("screening", done, count);
    progress(0);
    let found = measure_signatures(scene, data, &perturbations, &progress).into_iter().enumerate();
    let mut found: Vec<MeasuredPerturbation> = found
        .filter_map(|(perturbation, found)| {
            found.map(|signature| MeasuredPerturbation { perturbation, signature })
        })
        .collect();
    found.sort_by(|a, b| b.signature.explained.total_cmp(&a.signature.explained));
    let mut signatures = visit_signatures(scene, &perturbations, found);
    signatures.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    signatures
}

/// The number of a perturbation, and the signature that it was found to have.
struct MeasuredPerturbation {
    perturbation: usize,
    signature: EffectSignature,
}

/// Returns the signatures; if the model is far from the recordings, the best starts of effects that are not small are evaluated at
/// full size.
fn visit_signatures(
    scene: &ScreeningContext,
    perturbations: &[Perturbation],
    found: Vec<MeasuredPerturbation>,
) -> Vec<EffectSignature> {
    let thorough = scene.reach == ScreeningDepth::Full && !is_close(scene.judged);
    let of_effect = |k: usize| {
        let same = |other: &&MeasuredPerturbation| {
            std::ptr::eq(other.signature.effect, found[k].signature.effect)
                && perturbations[other.perturbation].combine == Combination::Towards
        };
        found[..k].iter().filter(same).count()
    };
    let goes = |k: usize| {
        thorough
            && perturbations[found[k].perturbation].combine == Combination::Towards
            && of_effect(k) < STARTS_VISITED
    };
    map_with_progress(scene.pool, "sizing", found.len(), |k| {
        let MeasuredPerturbation { perturbation, signature } = &found[k];
        if goes(k) {
            gone_there(scene, &perturbations[*perturbation], signature.clone())
        } else {
            signature.clone()
        }
    })
}

/// Evaluates an effect at the full size of its start: what that does to the fit counts as well, because a signature that is not
/// proportional to the size of its effect is not reliable. It ends as soon as the recordings evaluated so far are so far off that the others,
/// even at the noise floor, could not make it explain more than its signature does.
fn gone_there(
    scene: &ScreeningContext,
    perturbation: &Perturbation,
    mut seen: EffectSignature,
) -> EffectSignature {
    let parameters = apply_perturbation(scene.base, perturbation, &perturbation.directions[0]);
    let Some(here) = distance(scene.judged).map(|here| here.max(f64::MIN_POSITIVE)) else { return seen };
    let cells: usize = scene.judged.iter().map(|judged| judged.channels.len()).sum();
    let mut judged: Vec<Option<Assessment>> = vec![None; scene.judged.len()];
    let mut off = 0.0;
    for r in farthest_first(scene.judged) {
        let Some(there) = scene.simulator.assess_from(&parameters, r, &scene.judged[r]) else { return seen };
        off +=
            distance(std::slice::from_ref(&there)).map_or(f64::INFINITY, |d| d * there.channels.len() as f64);
        if 1.0 - off / cells as f64 / here < seen.explained {
            return seen;
        }
        judged[r] = Some(there);
    }
    let Some(there) = judged.into_iter().collect::<Option<Vec<_>>>().and_then(|j| distance(&j)) else {
        return seen;
    };
    let gained = 1.0 - there / here;
    if gained > seen.explained {
        let x = perturbation.origin.iter().zip(&perturbation.directions[0]).map(|(a, b)| a + b);
        seen.start = perturbation.effect.parameters.iter().zip(x).map(|(k, x)| from_variable(k, x)).collect();
        seen.explained = gained;
    }
    seen
}

/// Returns the indices of assessed recordings, those farthest from the noise floor first.
fn farthest_first(judged: &[Assessment]) -> Vec<usize> {
    let far: Vec<f64> =
        judged.iter().map(|j| distance(std::slice::from_ref(j)).unwrap_or(f64::INFINITY)).collect();
    let mut order: Vec<usize> = (0..judged.len()).collect();
    order.sort_by(|&a, &b| far[b].total_cmp(&far[a]));
    order
}

/// Returns the distance of assessed recordings from the noise floor.
fn distance(judged: &[Assessment]) -> Option<f64> {
    let part = |r| RecordingPart { recording: r, from: 0.0, to: 1.0 };
    let parts: Vec<RecordingPart> = (0..judged.len()).map(part).collect();
    score_parts(judged, &parts).map(|score| score.distance())
}
