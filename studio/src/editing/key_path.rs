//! The path of the key at a place of a project's text, also of a text that is not TOML yet.

/// Returns the path of the key on the line of a byte, as in `plant.gearbox.backlash`; on the line of a section's heading it is that of the
/// section. Items of lists are not counted. `None` if the line has neither a key nor a heading.
pub fn key_path_at(text: &str, byte: usize) -> Option<String> {
    let before = text.get(..byte)?;
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    let line = text[start..].lines().next().unwrap_or_default();
    if let Some(section) = section_name(line) {
        return Some(section);
    }
    let key = key_name(line)?;
    let section = text[..start].lines().rev().find_map(section_name).unwrap_or_default();
    Some(if section.is_empty() { key } else { format!("{section}.{key}") })
}

/// Returns the section of a heading, as `[plant.gearbox]` or `[[plant.beam.section]]`; `None` if the line is none.
pub(crate) fn section_name(line: &str) -> Option<String> {
    let inside = line.trim_start().strip_prefix('[')?;
    let (name, behind) = inside.trim_start_matches('[').split_once(']')?;
    let behind = behind.trim_start_matches(']').trim_start();
    (is_key(name) && (behind.is_empty() || behind.starts_with('#'))).then(|| joined_parts(name))
}

/// Returns the key of a line, as in `backlash = 0.001`; `None` if the line has none.
pub(crate) fn key_name(line: &str) -> Option<String> {
    let (key, _) = line.split_once('=')?;
    is_key(key).then(|| joined_parts(key))
}

/// Returns whether a text can be a key: a line in which "=" stands in a comment or in a value of several lines has none.
fn is_key(text: &str) -> bool {
    let letters = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '"' | ' ' | '\t');
    !text.trim().is_empty() && text.chars().all(letters)
}

fn joined_parts(key: &str) -> String {
    let parts: Vec<&str> = key.split('.').map(|part| part.trim().trim_matches('"')).collect();
    parts.join(".")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    const TEXT: &str = "format = 2\n[plant]\nname = \"a = b\"\n\n[[plant.beam.section]]\nfrom = 0.0 # = start\n# of = x\nmap = [\n  [1, 2],\n]\nlost";

    fn path_at(part: &str) -> Option<String> {
        key_path_at(TEXT, TEXT.find(part).unwrap())
    }

    #[test]
    fn keys_and_headings_are_found_by_their_lines() {
        assert_eq!(path_at("format").unwrap(), "format");
        assert_eq!(path_at("b\"").unwrap(), "plant.name");
        assert_eq!(path_at("beam").unwrap(), "plant.beam.section");
        assert_eq!(path_at("start").unwrap(), "plant.beam.section.from");
        assert_eq!(path_at("map").unwrap(), "plant.beam.section.map");
        for nothing in ["of =", "[1, 2]", "lost"] {
            assert_eq!(path_at(nothing), None, "{nothing}");
        }
        assert_eq!(key_path_at(TEXT, TEXT.len() + 1), None);
    }
}
