//! The project file's reference of a key: unit, allowed range, meaning. File, page and window have this one source.

use std::collections::BTreeMap;
use std::sync::OnceLock;

/// The reference that the project crate generates from its keys; a test there compares the two.
const PAGE: &str = include_str!("../../../docs/reference/project-file.md");

/// A key of the project file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyReference {
    /// The unit; empty for a pure number.
    pub unit: String,
    /// The allowed range, in words.
    pub allowed: String,
    /// The meaning.
    pub meaning: String,
}

/// Returns the reference of the key at a path; indices of lists are left out.
pub fn find_key(path: &str) -> Option<&'static KeyReference> {
    static KEYS: OnceLock<BTreeMap<String, KeyReference>> = OnceLock::new();
    KEYS.get_or_init(|| read_tables(PAGE)).get(&without_indices(path))
}

fn without_indices(path: &str) -> String {
    path.split('.').map(|part| part.split('[').next().unwrap_or(part)).collect::<Vec<_>>().join(".")
}

/// Reads the tables of the reference: paths with their keys.
fn read_tables(reference: &str) -> BTreeMap<String, KeyReference> {
    let (mut section, mut keys) = (String::new(), BTreeMap::new());
    let mut aliases: Vec<(String, String)> = Vec::new();
    for line in reference.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            let name = heading.split('`').nth(1).unwrap_or_default();
            section = name.trim_matches(['[', ']']).to_owned();
        }
        if let Some(other) = line.strip_prefix("Keys as in `[").and_then(|rest| rest.split(']').next()) {
            aliases.push((section.clone(), other.to_owned()));
        }
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        if let (true, [name, unit, allowed, _, meaning, ..]) = (line.starts_with("| `"), &cells[..]) {
            let name = name.trim_matches('`');
            let path = if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") };
            let text = |cell: &str| cell.to_owned();
            keys.insert(
                path,
                KeyReference { unit: text(unit), allowed: text(allowed), meaning: text(meaning) },
            );
        }
    }
    for (section, other) in aliases {
        let inside = format!("{other}.");
        let copies: Vec<(String, KeyReference)> = keys
            .iter()
            .filter_map(|(path, key)| {
                Some((format!("{section}.{}", path.strip_prefix(&inside)?), key.clone()))
            })
            .collect();
        keys.extend(copies);
    }
    keys
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn the_reference_is_read() {
        let backlash = find_key("plant.gearbox.backlash").unwrap();
        assert_eq!(backlash.unit, "rad");
        assert!(backlash.allowed.contains('0'), "{}", backlash.allowed);
        assert_eq!(find_key("plant.friction.motor.coulomb").unwrap().unit, "N m");
        assert!(find_key("synth.heave.control.gain").unwrap().meaning.starts_with("factor K"));
        assert!(find_key("plant.beam.section[2].from").is_some());
    }
}
