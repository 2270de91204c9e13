//! The library of physics: every effect that a machine may have and its model may lack.
//!
//! An [`Effect`] is data: where it acts, its parameters with bounds, and the values from which a fit starts. Its block in the
//! simulator is the field of the mechanism's parameters that the parameter writes, so that an accepted effect is an ordinary
//! machine for every other part of the program.

mod amplifier_map;
mod curve;
mod drive;
mod effect;
mod free_functions;
mod learned_values;
mod names;
mod sensing;
mod structure;

pub use curve::{gain_curve_inputs, make_free_gain_curve, make_gain_curve};
pub use effect::{Access, Effect, EffectKind, EffectParameter, ParameterMapping};
pub use free_functions::{component_of, learned_element, make_learned_effect};
pub(crate) use free_functions::{has_free_points, learned_values_in, make_form_effect, value_rows};
pub(crate) use names::named;
pub use names::{Component, EffectName};

/// Returns the library, component by component.
pub fn list_effects() -> Vec<&'static Effect> {
    structure::EFFECTS.iter().chain(drive::EFFECTS).chain(sensing::EFFECTS).collect()
}

/// Returns the effects that only a machine with textbook values is tried with: what they change is known of a reference rig.
pub fn list_textbook_effects() -> Vec<&'static Effect> {
    drive::TEXTBOOK.iter().collect()
}

/// Returns the range over which an effect's only parameter is scanned before it is fitted; `None` if it need not be. The response
/// to these is so far from proportional that a fit from a distance does not converge.
pub fn find_scan_range(effect: &Effect) -> Option<[f64; 2]> {
    match (effect.component, effect.effect) {
        (Component::Gearbox, EffectName::Backlash) => Some([1e-4, 0.03]),
        (Component::Control, EffectName::Delay) => Some([1.0, 16.0]),
        _ => None,
    }
}

/// Returns the finer form of an effect that is found in a coarse form, the same effect with more parameters; `None` if there is
/// none.
pub fn find_refinement(effect: &Effect) -> Option<&'static Effect> {
    let coarse = effect.component == Component::Amplifier
        && effect.effect == EffectName::GainCurve
        && gain_curve_inputs(effect).is_none();
    coarse.then(make_free_gain_curve)
}

/// Returns the effects that have a name, in library order.
pub fn find_effects(component: Component, effect: EffectName) -> impl Iterator<Item = &'static Effect> {
    let all = list_effects().into_iter().chain(list_textbook_effects());
    all.filter(move |e| e.component == component && e.effect == effect)
}
