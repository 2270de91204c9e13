//! The canonical text of a project: sections in a fixed order, a comment with unit and meaning beside each key.

use super::field::TableForm;
use super::lister::Line;
use super::setting::SettingValue;

/// Column at which the comments stand, where the values leave room.
const COMMENT_COLUMN: usize = 34;

/// Returns the text of listed lines. What is as usual is left out, and so are inline tables with nothing
/// unusual.
pub(crate) fn canonical_text(lines: &[Line]) -> String {
    let mut text = String::new();
    let mut at = 0;
    while at < lines.len() {
        at = match &lines[at] {
            Line::Open { form: TableForm::Inline, .. } => inline(lines, at, &mut text),
            Line::Open { path, item, meaning, .. } => {
                if *item || speaks(lines, at) {
                    let name = without_indices(path);
                    let line = if *item { format!("[[{name}]]") } else { format!("[{name}]") };
                    header(&line, meaning, &mut text);
                }
                at + 1
            }
            Line::Value { key, setting, unit, meaning, usual: false, tolerance, .. } => {
                let meaning = if key.replace('_', " ") == *meaning { "" } else { meaning };
                add_comment(&format!("{key} = {}", as_written(setting, tolerance)), unit, meaning, &mut text);
                at + 1
            }
            Line::Value { .. } | Line::Close => at + 1,
        };
    }
    text
}

/// Returns a value as the file spells it, with its tolerance.
pub(crate) fn as_written(setting: &SettingValue, tolerance: &Option<String>) -> String {
    match tolerance {
        None => setting.as_written(),
        Some(tolerance) => format!("{{ value = {}, tolerance = {tolerance} }}", setting.as_written()),
    }
}

/// Returns whether a section needs its own header: it has a key of its own, or nothing at all inside it.
fn speaks(lines: &[Line], open: usize) -> bool {
    !matches!(lines.get(open + 1), Some(Line::Open { form: TableForm::Section, .. }))
        && (own_values(lines, open)
            || !lines[open + 1..close(lines, open)].iter().any(|l| matches!(l, Line::Open { .. })))
}

fn own_values(lines: &[Line], open: usize) -> bool {
    lines[open + 1..]
        .iter()
        .take_while(|l| !matches!(l, Line::Open { form: TableForm::Section, .. } | Line::Close))
        .any(is_written)
}

fn is_written(line: &Line) -> bool {
    matches!(line, Line::Value { usual: false, .. })
}

/// Returns the line that closes a table.
fn close(lines: &[Line], open: usize) -> usize {
    let mut depth = 0_usize;
    for (at, line) in lines.iter().enumerate().skip(open) {
        match line {
            Line::Open { .. } => depth += 1,
            Line::Close => depth -= 1,
            Line::Value { .. } => {}
        }
        if depth == 0 {
            return at;
        }
    }
    lines.len()
}

fn header(line: &str, meaning: &str, text: &mut String) {
    if !text.is_empty() {
        text.push('\n');
    }
    add_comment(line, "", meaning, text);
}

/// `plant.beam.section[1]` as a header has it: `plant.beam.section`.
fn without_indices(path: &str) -> String {
    path.split('.').map(|part| part.split('[').next().unwrap_or(part)).collect::<Vec<_>>().join(".")
}

fn add_comment(line: &str, unit: &str, meaning: &str, text: &mut String) {
    let comment = match (unit.is_empty(), meaning.is_empty()) {
        (true, true) => String::new(),
        (false, true) => format!("# {unit}"),
        (true, false) => format!("# {meaning}"),
        (false, false) => format!("# {unit}, {meaning}"),
    };
    text.push_str(format!("{line:<COMMENT_COLUMN$} {comment}").trim_end());
    text.push('\n');
}

/// Writes an inline table and gives the line after it.
fn inline(lines: &[Line], open: usize, text: &mut String) -> usize {
    let end = close(lines, open);
    let values = lines[open + 1..end].iter().filter_map(|line| match line {
        Line::Value { key, setting, usual: false, tolerance, .. } => {
            Some(format!("{key} = {}", as_written(setting, tolerance)))
        }
        _ => None,
    });
    let values: Vec<String> = values.collect();
    if let (false, Line::Open { path, meaning, .. }) = (values.is_empty(), &lines[open]) {
        let key = path.rsplit('.').next().unwrap_or(path);
        add_comment(&format!("{key} = {{ {} }}", values.join(", ")), "", meaning, text);
    }
    end + 1
}
