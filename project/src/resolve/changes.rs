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
            // An empty list of numbers is what an absent key means: some keys allow no empty list.
            let is_absent = !setting.is_finite()
                || usual && matches!(setting, SettingValue::Numbers(numbers) if numbers.is_empty());
            out = if is_absent { out.remove(path)? } else { out.set(path, setting)? };
        }
    }
    Ok(out)
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
