//! From one project to another by the fewest changes of the file.

use crate::file::lister::Line;
use crate::file::{Document, EditError, SettingValue};

/// Returns the file with what differs between two listings set or removed.
pub(crate) fn apply(document: &Document, before: &[Line], after: &[Line]) -> Result<Document, EditError> {
    let mut out = document.clone();
    for path in removed_paths(before, after).into_iter().rev() {
        out = out.remove(path)?;
    }
    let old = values(before);
    for (path, setting, usual) in values(after) {
        let known = old.iter().find(|(p, ..)| *p == path);
        let absent = |value: &SettingValue| !value.is_finite() && !setting.is_finite();
        // An absent key whose default follows another value must be written once it no longer does.
        let still = |was_usual: bool| usual == was_usual || document.has(path);
        let same = known.map_or(usual, |(_, value, was)| (*value == setting && still(*was)) || absent(value));
        if !same {
            let (stated, path) = find_place(out, path, after)?;
            out = stated;
            let path = path.as_str();
            // An empty list of numbers is what an absent key means: some keys allow no empty list.
            let is_absent = !setting.is_finite()
                || usual && matches!(setting, SettingValue::Numbers(numbers) if numbers.is_empty());
            out = if is_absent { out.remove(path)? } else { out.set(path, setting)? };
        }
    }
    Ok(out)
}

/// The keys of an amplifier that a drive has too.
const OF_DRIVE: [&str; 4] = ["time_constant", "dead_zone", "current_limit", "map"];

/// Returns the file in which a changed key of a listing has a place, and the path of that place. A listing always calls a drive that takes a voltage an amplifier; a
/// file may call it a drive, which a key that a drive lacks makes an amplifier.
fn find_place(file: Document, path: &str, after: &[Line]) -> Result<(Document, String), EditError> {
    let (of_drive, of_amplifier) = (path.strip_prefix("plant.drive."), path.strip_prefix("plant.amplifier."));
    match of_drive.or(of_amplifier.filter(|key| OF_DRIVE.contains(key))) {
        Some(key) if file.has("plant.drive") => Ok((open_drive(file)?, format!("plant.drive.{key}"))),
        None if of_amplifier.is_some() && file.has("plant.drive") => {
            let is_of_amplifier = |path: &str| path.starts_with("plant.amplifier.");
            let mut stated = file.remove("plant.drive")?;
            for (path, setting, _) in
                values(after).into_iter().filter(|(path, _, usual)| is_of_amplifier(path) && !usual)
            {
                stated = stated.set(path, setting)?;
            }
            Ok((stated, path.to_owned()))
        }
        _ => Ok((file, path.to_owned())),
    }
}

/// Returns the file with a section in the place of the word of a drive, if it has one.
fn open_drive(file: Document) -> Result<Document, EditError> {
    let Some(word) = file.text_at("plant.drive") else { return Ok(file) };
    file.remove("plant.drive")?.set("plant.drive.kind", &SettingValue::Text(word))
}

/// Paths of tables and keys that are no longer there, the outermost of each; later items stand later.
fn removed_paths<'l>(before: &'l [Line], after: &[Line]) -> Vec<&'l str> {
    let kept: Vec<&str> = after.iter().filter_map(path).collect();
    let mut gone: Vec<&str> = Vec::new();
    for path in before.iter().filter_map(path).filter(|p| !kept.contains(p)) {
        let inside = gone
            .iter()
            .any(|outer| path.strip_prefix(outer).is_some_and(|rest| rest.starts_with(['.', '['])));
        if !inside {
            gone.push(path);
        }
    }
    gone
}

fn path(line: &Line) -> Option<&str> {
    match line {
        Line::Open { path, .. } | Line::Value { path, .. } => Some(path),
        Line::Close => None,
    }
}

fn values(lines: &[Line]) -> Vec<(&str, &SettingValue, bool)> {
    let value = |line| match line {
        &Line::Value { ref path, ref setting, usual, .. } => Some((path.as_str(), setting, usual)),
        _ => None,
    };
    lines.iter().filter_map(value).collect()
}
