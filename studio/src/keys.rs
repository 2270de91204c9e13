//! What the project file's own reference says of a key: unit, allowed range, meaning. One source for file, page and window.

use std::collections::BTreeMap;
use std::sync::OnceLock;

/// The page that the project crate writes of its keys, and holds to its reader by a test.
const PAGE: &str = include_str!("../../docs/reference/project-file.md");

/// A key of the project file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key {
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What is allowed, in words.
    pub allowed: String,
    /// What it means.
    pub meaning: String,
}

/// The key at a path; indices of lists are left out.
pub fn key(path: &str) -> Option<&'static Key> {
    static KEYS: OnceLock<BTreeMap<String, Key>> = OnceLock::new();
    KEYS.get_or_init(|| read(PAGE)).get(&plain(path))
}

fn plain(path: &str) -> String {
    path.split('.').map(|part| part.split('[').next().unwrap_or(part)).collect::<Vec<_>>().join(".")
}

/// Reads the tables of the reference.
fn read(reference: &str) -> BTreeMap<String, Key> {
    let (mut section, mut keys) = (String::new(), BTreeMap::new());
    let mut same: Vec<(String, String)> = Vec::new();
    for line in reference.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            let name = heading.split('`').nth(1).unwrap_or_default();
            section = name.trim_matches(['[', ']']).to_owned();
        }
        if let Some(other) = line.strip_prefix("Keys as in `[").and_then(|rest| rest.split(']').next()) {
            same.push((section.clone(), other.to_owned()));
        }
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        if let (true, [name, unit, allowed, _, meaning, ..]) = (line.starts_with("| `"), &cells[..]) {
            let name = name.trim_matches('`');
            let path = if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") };
            let text = |cell: &str| cell.to_owned();
            keys.insert(path, Key { unit: text(unit), allowed: text(allowed), meaning: text(meaning) });
        }
    }
    for (section, other) in same {
        let inside = format!("{other}.");
        let alike: Vec<(String, Key)> = keys
            .iter()
            .filter_map(|(path, key)| {
                Some((format!("{section}.{}", path.strip_prefix(&inside)?), key.clone()))
            })
            .collect();
        keys.extend(alike);
    }
    keys
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn the_reference_is_read() {
        let backlash = key("plant.gearbox.backlash").unwrap();
        assert_eq!(backlash.unit, "rad");
        assert!(backlash.allowed.contains('0'), "{}", backlash.allowed);
        assert_eq!(key("plant.friction.pivot.coulomb").unwrap().unit, "N m");
        assert!(key("synth.heave.control.gain").unwrap().meaning.starts_with("factor K"));
        assert!(key("plant.beam.section[2].from").is_some());
    }
}
