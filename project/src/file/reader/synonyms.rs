//! Names that data sheets and other programs give to what a project file calls otherwise.

/// Pairs of a name that people write and the key, seen from the same section, that means it.
const SYNONYMS: &[(&str, &str)] = &[
    ("name", "plant.name"),
    ("sample_period", "plant.interface.sample_period"),
    ("sample_time", "sample_period"),
    ("ts", "sample_period"),
    ("bandwidth", "synth.bandwidth"),
    ("resolution", "counts"),
    ("counts", "resolution"),
    ("inertia", "mass"),
    ("hub_inertia", "mass"),
    ("beam_inertia", "tip_mass"),
    ("mass", "inertia"),
    ("mass", "hub_inertia"),
    ("lines", "counts"),
    ("ppr", "counts"),
    ("force_constant", "torque_constant"),
    ("kt", "torque_constant"),
    ("km", "torque_constant"),
    ("ke", "back_emf_constant"),
    ("voltage_constant", "back_emf_constant"),
    ("rotor_inertia", "inertia"),
    ("j", "inertia"),
    ("r", "resistance"),
    ("l", "inductance"),
    ("max_current", "limit"),
    ("friction", "coulomb"),
];

/// Returns the key that a name means, if it, or the section in which it stands, is known here.
pub(super) fn find_synonym(written: &str, known: &[String]) -> Option<&'static str> {
    let written = written.to_lowercase();
    let here = |key: &str| {
        let first = key.split('.').next().unwrap_or(key);
        known.iter().any(|name| name == first)
    };
    SYNONYMS.iter().find(|(name, key)| *name == written && here(key)).map(|(_, key)| *key)
}
