//! A simpler model in place of what a stage finds: a spring for a hose that does not yield.

use crate::library::{Component, Effect, EffectName};
use crate::selection::candidate::FittedCandidate;
use crate::selection::signature::EffectSignature;

/// If the best candidate adds a hose, returns a spring in its place, as stiff as the hose and a spring beside it together, with the
/// other effect that it adds; `effects` are those that are tried. A hose that does not yield is a spring, and a fit of the spring from the model as it is may not find
/// it.
pub(crate) fn spring_in_place_of_hose(
    candidates: &[FittedCandidate],
    present: usize,
    recordings: usize,
    effects: &[&'static Effect],
) -> Option<Vec<EffectSignature>> {
    let best = candidates.iter().min_by(|a, b| a.whole.level().total_cmp(&b.whole.level()))?;
    let added = best.fit.effects.get(present..)?;
    let is_hose = |e: &Effect| e.component == Component::Structure && e.effect == EffectName::Hysteresis;
    let is_spring =
        |e: &Effect| e.component == Component::Structure && e.effect == EffectName::PositionStiffness;
    let lumped = best.fit.parameters.lumped.as_ref().filter(|_| added.iter().any(|e| is_hose(e)))?;
    let own = lumped.position_stiffness_nm_rad;
    let both = own + lumped.hysteresis_stiffness_nm_rad;
    let centre = own * lumped.position_stiffness_centre_rad / if both == 0.0 { 1.0 } else { both };
    let spring = effects.iter().copied().find(|e| is_spring(e))?;
    let start = vec![both, centre][..spring.parameters.len()].to_vec();
    let others = added.iter().filter(|e| !is_hose(e) && !is_spring(e));
    let kept = others.map(|e| EffectSignature::from_start(e, e.values(&best.fit.parameters), recordings));
    Some(std::iter::once(EffectSignature::from_start(spring, start, recordings)).chain(kept).collect())
}
