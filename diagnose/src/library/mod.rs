//! The library of physics: every effect that a machine may have and its model may lack.
//!
//! An [`Effect`] is data: where it sits, its equation and source, its parameters ([`Parameter`]s) with bounds, and the
//! values from which a fit starts. Its block in the simulator is the field of the mechanism's parameters that the
//! parameter writes, so an effect that is accepted is an ordinary machine that every other part of the studio takes.

mod amplifier_map;
mod curve;
mod drive;
mod effect;
mod names;
mod sensing;
mod structure;

pub use curve::{curve_inputs, curve_of, free_curve};
pub use effect::{Access, Effect, Kind, Mapping, Parameter};
pub(crate) use names::named;
pub use names::{Component, EffectName};

/// The library, component by component.
pub fn library() -> Vec<&'static Effect> {
    structure::EFFECTS.iter().chain(drive::EFFECTS).chain(sensing::EFFECTS).collect()
}

/// What a textbook's model may have at another value besides, and a reference rig's is known for.
pub fn textbook() -> Vec<&'static Effect> {
    drive::TEXTBOOK.iter().collect()
}

/// The range over which an effect's only parameter is scan_parameter before it is fitted: where the response is so far from
/// proportional to it that a fit from a distance goes astray.
pub fn scan_range(effect: &Effect) -> Option<[f64; 2]> {
    match (effect.component, effect.effect) {
        (Component::Gearbox, EffectName::Backlash) => Some([1e-4, 0.03]),
        (Component::Control, EffectName::Delay) => Some([1.0, 16.0]),
        _ => None,
    }
}

/// What an effect found in a coarse form is refined to: the same effect with more parameters.
pub fn refinement(effect: &Effect) -> Option<&'static Effect> {
    let coarse = effect.component == Component::Amplifier
        && effect.effect == EffectName::GainCurve
        && curve_inputs(effect).is_none();
    coarse.then(free_curve)
}

/// The effects that carry a name, in library order.
pub fn effects_named(component: Component, effect: EffectName) -> impl Iterator<Item = &'static Effect> {
    let all = library().into_iter().chain(textbook());
    all.filter(move |e| e.component == component && e.effect == effect)
}
