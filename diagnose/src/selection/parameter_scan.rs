//! Parameter scans: values of an effect tried one after the other, if its response is so far from proportional that a signature at
//! the model as it is does not describe it.

use crate::tolerance::selection::{
    ASSESSED_SCAN_POINTS, CURRENT_LIMIT_SHARES, ORDERS_KEPT, PERTURBATIONS_TOGETHER, SCAN_POINTS,
    SCAN_REFINEMENT_POINTS, SCAN_REFINEMENT_SHARE, SCANNED_ORDERS,
};
use counterpoise_models::Parameters;

use crate::fitting::output_error::EffectFit;
use crate::library::{Component, Effect, EffectName, ParameterMapping, find_effects, find_scan_range};
use crate::selection::order_spectrum::{BalanceOverAngle, OrderRange};
use crate::selection::perturbations::{
    Perturbation, perturbation_towards, ripple_perturbation, stall_current_a,
};
use crate::selection::signature::{
    EffectSignature, ScreeningContext, SignatureData, is_close, measure_signatures, weight_residuals,
};
use crate::simulator_access::{
    Assessment, ChannelResidual, ControlSource, MechanismVariant, PlacedVariant, SimulatorAccess, Span,
    StartShift,
};
use crate::tolerance::{PERIOD_SEEN, PERIODS_SAMPLED};
use counterpoise_pool::map;

/// Scans the value of an effect's only parameter on the first part of the most active recording, played back, because a playback
/// repeats even if the loop hunts; returns the perturbation towards the best value.
pub(crate) fn scan_parameter(scene: &ScreeningContext, effect: &'static Effect) -> Option<Perturbation> {
    let range = find_scan_range(effect)?;
    let parameter = &effect.parameters[0];
    let index = scene.simulator.most_active_recording();
    let near = Assessment { source: ControlSource::Playback, ..scene.judged[index].clone() };
    let costs_of = |values: &[f64]| -> Vec<f64> {
        let placed = values.iter().map(|value| PlacedVariant {
            variant: MechanismVariant {
                parameters: effect.apply_to(scene.base, &[*value]),
                shift: StartShift::default(),
            },
            index,
            near: &near,
        });
        let found = scene.simulator.residuals_of_each(&placed.collect::<Vec<_>>(), Span::Head);
        let cost = |channels: Option<Vec<ChannelResidual>>| {
            channels.map_or(f64::INFINITY, |channels| log_excess(&channels))
        };
        found.into_iter().map(cost).collect()
    };
    let (mut low, mut high) = (range[0], range[1]);
    let mut best = low;
    for count in [SCAN_POINTS, SCAN_REFINEMENT_POINTS, SCAN_REFINEMENT_POINTS] {
        let value = |k: usize| low * (high / low).powf(k as f64 / (count - 1) as f64);
        let values: Vec<f64> = (0..count).map(value).collect();
        let few: Vec<&[f64]> = values.chunks(PERTURBATIONS_TOGETHER).collect();
        let costs = map(scene.pool, few.len(), |k| costs_of(few[k])).concat();
        let lowest = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]))?;
        best = value(lowest);
        (low, high) = (value(lowest.saturating_sub(1)), value((lowest + 1).min(count - 1)));
    }
    let best = if parameter.mapping == ParameterMapping::Whole { best.round() } else { best };
    let perturbation = perturbation_towards(effect, scene.base, &[best]);
    (perturbation.directions[0][0] != 0.0).then_some(perturbation)
}

/// Scans the backlash on the first part of the most active recording, played back, each value from its own initial state, because
/// the response to a wide gap is not found from the initial state of a narrow one. Returns `None` if no value is worth refining.
pub(crate) fn scan_backlash(scene: &ScreeningContext) -> Option<EffectSignature> {
    let effect =
        find_effects(Component::Gearbox, EffectName::Backlash).next().filter(|_| !is_close(scene.judged))?;
    let index = scene.simulator.most_active_recording();
    let played = |parameters: &Parameters, judged: &Assessment| {
        let near = Assessment { source: ControlSource::Playback, ..judged.clone() };
        scene.simulator.residuals(parameters, index, Span::Head, &near).map(|channels| log_excess(&channels))
    };
    let here = played(scene.base, &scene.judged[index])?;
    let cost = |value: f64| {
        let parameters = effect.apply_to(scene.base, &[value]);
        let judged = scene.simulator.assess(&parameters, index);
        judged.and_then(|j| played(&parameters, &j)).unwrap_or(f64::INFINITY)
    };
    let best = scan_range(scene, find_scan_range(effect)?, here, &cost)?;
    Some(EffectSignature::from_start(effect, vec![best], scene.judged.len()))
}

/// Scans the limit of the current on the recording that is farthest from the model, as it is in the loop: a limit that is never reached changes
/// nothing, so no slope leads to one, and beside a much tighter one than the recordings have almost everything else seems to explain more. Returns
/// `None` on a machine like the reference rig, and if no value is worth refining.
pub(crate) fn scan_current_limit(
    scene: &ScreeningContext,
    effects: &[&'static Effect],
) -> Option<EffectSignature> {
    let effect = effects.iter().copied().find(|effect| effect.effect == EffectName::CurrentLimit)?;
    let most = stall_current_a(scene.base).filter(|_| !scene.sizes.typical && !is_close(scene.judged))?;
    let far = |judged: &Assessment| log_excess(&judged.channels);
    let index =
        (0..scene.judged.len()).max_by(|&a, &b| far(&scene.judged[a]).total_cmp(&far(&scene.judged[b])))?;
    let cost = |value: f64| {
        let parameters = effect.apply_to(scene.base, &[value]);
        let judged = scene.simulator.assess(&parameters, index);
        judged.map_or(f64::INFINITY, |judged| far(&judged))
    };
    let range = CURRENT_LIMIT_SHARES.map(|share| share * most);
    let best = scan_range(scene, range, far(&scene.judged[index]), &cost)?;
    Some(EffectSignature::from_start(effect, vec![best], scene.judged.len()))
}

/// Returns the sum of the logarithms of the channels' residuals over their noise floors, of which those below count as at it.
fn log_excess(channels: &[ChannelResidual]) -> f64 {
    channels.iter().map(|channel| channel.relative_rms().max(1.0).ln()).sum()
}

/// Returns the value in a range at which a cost is least, by points on a logarithmic grid that is refined; `None` if it is not worth refining beside the
/// cost of the model as it is.
fn scan_range(
    scene: &ScreeningContext,
    [mut low, mut high]: [f64; 2],
    here: f64,
    cost: &(dyn Fn(f64) -> f64 + Sync),
) -> Option<f64> {
    let (mut best, mut least) = (low, here);
    for count in ASSESSED_SCAN_POINTS {
        let value = |k: usize| low * (high / low).powf(k as f64 / (count - 1) as f64);
        let costs = map(scene.pool, count, |k| cost(value(k)));
        let lowest = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]))?;
        if costs[lowest] > (1.0 - SCAN_REFINEMENT_SHARE) * here {
            return None;
        }
        if costs[lowest] < least {
            (best, least) = (value(lowest), costs[lowest]);
        }
        (low, high) = (value(lowest.saturating_sub(1)), value((lowest + 1).min(count - 1)));
    }
    Some(best)
}

/// Returns the orders of a repeating torque that explain most of the first part of the most active recording.
pub(crate) fn scan_ripple_orders(scene: &ScreeningContext, effect: &'static Effect) -> Vec<Perturbation> {
    let here = weight_residuals(scene.judged);
    let one = [scene.simulator.most_active_recording()];
    let ratio = scene.base.gearbox.ratio;
    let at_pivot = effect.component == Component::Pivot;
    let first = if at_pivot { SCANNED_ORDERS[0] } else { SCANNED_ORDERS[0] / scene.sizes.motor_turns };
    let per_motor_turn = SCANNED_ORDERS.iter().map(|order| order * first);
    let per_hub_turn = SCANNED_ORDERS.iter().map(|order| order / ratio);
    let lowest = if effect.component == Component::Motor { first } else { effect.parameters[1].bounds[0] };
    let is_seen = |order: &f64| covers_a_period(*order, scene.simulator.travel_rad() * ratio);
    let is_sampled = |order: &f64| *order * ratio * scene.simulator.turns_per_sample() < PERIODS_SAMPLED;
    let orders = per_motor_turn
        .chain(per_hub_turn.filter(|order| *order >= lowest && *order < first))
        .filter(|order| at_pivot || (is_seen(order) && is_sampled(order)))
        .chain(read_orders(scene, effect));
    let scan: Vec<Perturbation> = orders.map(|order| ripple_perturbation(effect, order)).collect();
    let data = SignatureData { here: &here, recordings: &one, span: Span::Head };
    let signatures = measure_signatures(scene, data, &scan, &|_| ());
    let share = |l: &Option<EffectSignature>| l.as_ref().map_or(f64::NEG_INFINITY, |l| l.explained);
    let mut ranked: Vec<(f64, Perturbation)> = signatures.iter().map(share).zip(scan).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked.into_iter().take(ORDERS_KEPT).map(|(_, perturbation)| perturbation).collect()
}

/// Returns the orders that the balance of the drive shows in the most active recording, if the effect repeats with the motor's angle.
fn read_orders(scene: &ScreeningContext, effect: &'static Effect) -> Vec<f64> {
    if !matches!(effect.component, Component::Motor | Component::Gearbox) {
        return Vec::new();
    }
    let ratio = scene.base.gearbox.ratio;
    let bounds = effect.parameters[1].bounds;
    let seen = PERIOD_SEEN * std::f64::consts::TAU / (scene.simulator.travel_rad() * ratio);
    let sampled = PERIODS_SAMPLED / (scene.simulator.turns_per_sample() * ratio);
    let range = OrderRange { lowest: seen.max(bounds[0]), highest: sampled.min(bounds[1]) };
    let measured = scene.simulator.measured_signals(scene.simulator.most_active_recording());
    let over_angle = measured.and_then(|m| BalanceOverAngle::new(scene.base, &m, effect.effect));
    over_angle.map_or_else(Vec::new, |balance| balance.find_peaks(range))
}

/// Returns whether a torque that repeats with the motor's angle does so over its travel, rad: over less than most of a period, a
/// repetition cannot be recognised.
pub(crate) fn covers_a_period(order: f64, travel: f64) -> bool {
    order * travel > PERIOD_SEEN * std::f64::consts::TAU
}

/// Returns whether every ripple of motor and gearbox in a fit repeats over the travel. A fit may stretch one until it is a piece of
/// a sine, which is any smooth function of the position.
pub(crate) fn ripples_repeat(simulator: &dyn SimulatorAccess, fit: &EffectFit) -> bool {
    all_repeat(&fit.effects, &fit.values, simulator.travel_rad() * fit.parameters.gearbox.ratio)
}

fn all_repeat(effects: &[&'static Effect], values: &[f64], travel: f64) -> bool {
    let mut first = 0;
    effects.iter().all(|effect| {
        let own = values.get(first..).unwrap_or(&[]);
        first += effect.parameters.len();
        !effect.is_ripple()
            || effect.component == Component::Pivot
            || own.get(1).is_none_or(|o| covers_a_period(*o, travel))
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_of_a_sine_is_no_ripple() {
        let spring = find_effects(Component::Structure, EffectName::PositionStiffness)
            .find(|e| e.parameters.len() == 2)
            .unwrap();
        let mesh = find_effects(Component::Gearbox, EffectName::MeshRipple).next().unwrap();
        let of_order = |order: f64| [900.0, 0.01, 15.0, order, 0.3];
        let travel = 0.15 * 164.0;
        assert!(all_repeat(&[spring, mesh], &of_order(6.0), travel));
        assert!(!all_repeat(&[spring, mesh], &of_order(0.1), travel));
        let friction = find_effects(Component::Pivot, EffectName::PositionDependentFriction).next().unwrap();
        assert!(friction.is_ripple() && all_repeat(&[friction], &[0.3, 4.0, 0.0], 0.15));
    }
}
