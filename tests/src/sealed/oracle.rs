//! The references of the diagnosis: the truth's own structure refitted, and the model as it was with its
//! parameters refitted.

use counterpoise_diagnose::findings::answer::Answer;
use counterpoise_diagnose::library::{Component, Effect, EffectName, find_effects};
use counterpoise_diagnose::{Error, Structure, refit};
use counterpoise_models::Parameters;
use counterpoise_pool::Serial;

use super::row::recordings;
use super::{Case, MachineFamily, controller};

/// Parameters of the model as it is that a refit of it may change: component, effect.
const ORDINARY: [(&str, &str); 8] = [
    ("pivot", "coulomb"),
    ("pivot", "viscous"),
    ("motor", "coulomb"),
    ("motor", "viscous"),
    ("motor", "torque_constant"),
    ("structure", "out_of_balance"),
    ("structure", "inertia"),
    ("gearbox", "stiffness"),
];

/// Returns the mean ln(RMS / floor) on the last part of every recording, fitted to the first: the model as it was, its parameters
/// refitted, what was found, and the truth (`None` if the library does not have it).
///
/// # Errors
/// As the diagnosis itself.
pub fn compare_fits(base: &Parameters, case: &Case, answer: &Answer) -> Result<[Option<f64>; 4], Error> {
    let known = case.sealed.family != MachineFamily::Outside;
    let structures =
        [Structure::default(), ordinary_structure(base), found_structure(answer), truth(base, case)];
    let left = refit(base, &controller(), &recordings(case), &structures, &Serial)?;
    Ok([left[0], left[1], left[2], left[3].filter(|_| known)])
}

/// The first entry of the library with a name that has a parameter of the given name, or else the first with the name.
fn entry(component: &str, effect: &str, parameter: Option<&str>) -> Option<&'static Effect> {
    let has = |e: &&'static Effect| e.parameters.iter().any(|k| Some(k.name) == parameter);
    let (component, effect) = (Component::from_name(component)?, EffectName::from_name(effect)?);
    let first = find_effects(component, effect).next();
    find_effects(component, effect).find(has).or(first)
}

fn ordinary_structure(base: &Parameters) -> Structure {
    let effects: Vec<&'static Effect> =
        ORDINARY.iter().filter_map(|(component, effect)| entry(component, effect, None)).collect();
    let start = effects.iter().flat_map(|e| e.values(base)).collect();
    Structure { effects, start }
}

fn found_structure(answer: &Answer) -> Structure {
    let mut structure = Structure::default();
    for finding in &answer.findings {
        let parameter = finding.parameters.first().map(|p| p.name);
        let (component, effect) = finding.name().names();
        let Some(effect) = parameter.and_then(|_| entry(component, effect, parameter)) else {
            continue;
        };
        let values: Vec<f64> = finding.parameters.iter().map(|p| p.value).collect();
        let coarse = effect.starts.first().map_or_else(Vec::new, |s| s.to_vec());
        structure.start.extend(if values.len() == effect.parameters.len() { values } else { coarse });
        structure.effects.push(effect);
    }
    structure
}

/// The concealed effects at their true values; parameters that the truth does not speak of start where the library does.
fn truth(base: &Parameters, case: &Case) -> Structure {
    let mut structure = Structure::default();
    for c in &case.sealed.concealed {
        let Some(effect) = entry(c.component, c.effect, c.parameters.first().map(|p| p.0)) else {
            continue;
        };
        let usual = effect.starts.first().map_or_else(|| effect.values(base), |s| s.to_vec());
        let known = |name: &str| c.parameters.iter().find(|(n, _)| *n == name).map(|p| p.1);
        structure.start.extend(effect.parameters.iter().zip(usual).map(|(k, v)| known(k.name).unwrap_or(v)));
        structure.effects.push(effect);
    }
    structure
}
