//! The sections of a project's text that make its design: taken out, put in, and compared.

use std::collections::BTreeMap;

use super::key_path::{key_name, section_name};

/// The sections of a project that make a design.
const DESIGN_SECTIONS: [&str; 2] = ["synth", "reduce"];

/// A key on which two designs differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WeightDifference {
    /// The path of the key, as in `synth.feedback.error.gain`.
    pub path: String,
    /// Its value in the first design; `None` if the key is not there.
    pub first: Option<String>,
    /// Its value in the second design; `None` if the key is not there.
    pub second: Option<String>,
}

/// A stretch of a text: a section with its heading, or a key before the first heading.
pub(crate) struct TextSection<'a> {
    /// The first part of the name of the section or of the key; empty before both.
    pub name: String,
    /// The text.
    pub text: &'a str,
    kind: StretchKind,
}

/// The kind of a stretch of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StretchKind {
    /// It stands before the first heading.
    Root,
    /// It begins with a heading.
    Headed,
}

/// Returns the sections of a text, and the keys before the first of them, which together are the text. The comments directly above a heading or
/// a key belong to it.
pub(crate) fn split_sections(text: &str) -> Vec<TextSection<'_>> {
    let mut starts = vec![StretchStart { byte: 0, name: String::new(), kind: StretchKind::Root }];
    let (mut byte, mut comment, mut kind) = (0, None, StretchKind::Root);
    for line in text.split_inclusive('\n') {
        let heading = section_name(line);
        if heading.is_some() {
            kind = StretchKind::Headed;
        }
        let key = if kind == StretchKind::Root { key_name(line) } else { None };
        if let Some(name) = heading.or(key) {
            let name = name.split('.').next().unwrap_or_default().to_owned();
            starts.push(StretchStart { byte: comment.unwrap_or(byte), name, kind });
        }
        comment = if line.starts_with('#') { comment.or(Some(byte)) } else { None };
        byte += line.len();
    }
    let ends: Vec<usize> = starts.iter().skip(1).map(|start| start.byte).chain([text.len()]).collect();
    let section = |(start, end): (StretchStart, usize)| {
        let StretchStart { byte, name, kind } = start;
        TextSection { text: &text[byte..end], name, kind }
    };
    starts.into_iter().zip(ends).map(section).collect()
}

/// The start of a stretch.
struct StretchStart {
    byte: usize,
    name: String,
    kind: StretchKind,
}

fn is_design(section: &TextSection) -> bool {
    DESIGN_SECTIONS.contains(&section.name.as_str())
}

/// Returns the parts of a project's text that make its design, with their comments.
pub fn design_sections(text: &str) -> String {
    split_sections(text).into_iter().filter(is_design).map(|section| section.text).collect()
}

/// Returns everything in a project's text but the parts that make its design.
pub fn other_sections(text: &str) -> String {
    split_sections(text)
        .into_iter()
        .filter(|section| !is_design(section))
        .map(|section| section.text)
        .collect()
}

/// Returns a project's text with the parts of its design replaced: keys before the first heading stand before it, and sections where the first of the
/// old ones stood.
pub fn replace_design_sections(text: &str, sections: &str) -> String {
    let part = |kind| {
        let of_kind = split_sections(sections).into_iter().filter(move |section| section.kind == kind);
        of_kind.map(|section| section.text).collect::<String>()
    };
    let (mut keys, mut headed) = (part(StretchKind::Root), part(StretchKind::Headed));
    let mut out = String::new();
    for section in split_sections(text) {
        if section.kind == StretchKind::Headed {
            push_lines(&mut out, &std::mem::take(&mut keys));
        }
        match (is_design(&section), section.kind) {
            (false, _) => push_lines(&mut out, section.text),
            (true, StretchKind::Root) => push_lines(&mut out, &std::mem::take(&mut keys)),
            (true, StretchKind::Headed) => push_lines(&mut out, &std::mem::take(&mut headed)),
        }
    }
    push_lines(&mut out, &keys);
    if !headed.is_empty() {
        push_lines(&mut out, "\n");
        push_lines(&mut out, &headed);
    }
    out
}

/// Adds lines to a text whose last line may have no end.
fn push_lines(text: &mut String, lines: &str) {
    if !lines.is_empty() && !text.is_empty() && !text.ends_with('\n') {
        text.push('\n');
    }
    text.push_str(lines);
}

/// Returns the keys on which two designs differ, in the order of their names; comments, order and spaces are no differences.
/// `None` if one of the texts cannot be read.
pub fn weight_differences(first: &str, second: &str) -> Option<Vec<WeightDifference>> {
    let (first, second) = (key_values(first)?, key_values(second)?);
    let mut paths: Vec<&String> = first.keys().chain(second.keys()).collect();
    paths.sort();
    paths.dedup();
    let difference = |path: &String| WeightDifference {
        path: path.clone(),
        first: first.get(path).cloned(),
        second: second.get(path).cloned(),
    };
    Some(paths.into_iter().filter(|path| first.get(*path) != second.get(*path)).map(difference).collect())
}

/// Returns the value of every key of a text, by its path.
fn key_values(text: &str) -> Option<BTreeMap<String, String>> {
    let table: toml::Table = toml::from_str(text).ok()?;
    let mut values = BTreeMap::new();
    add_values(&mut values, "", &toml::Value::Table(table));
    Some(values)
}

fn add_values(values: &mut BTreeMap<String, String>, path: &str, value: &toml::Value) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                add_values(values, &path, value);
            }
        }
        toml::Value::Array(items) if items.iter().any(toml::Value::is_table) => {
            for (k, value) in items.iter().enumerate() {
                add_values(values, &format!("{path}[{k}]"), value);
            }
        }
        // 25 and 25.0 are the same value
        toml::Value::Integer(whole) => drop(values.insert(path.to_owned(), format!("{:?}", *whole as f64))),
        toml::Value::Float(number) => drop(values.insert(path.to_owned(), format!("{number:?}"))),
        toml::Value::String(word) => drop(values.insert(path.to_owned(), word.clone())),
        other => drop(values.insert(path.to_owned(), other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    const RIG: &str = include_str!("../../../examples/reference-rig/project.toml");

    #[test]
    fn the_sections_of_a_design_are_taken_out_and_put_back() {
        let sections = design_sections(RIG);
        assert!(sections.contains("[synth.feedback.error]") && !sections.contains("[plant]"));
        assert_eq!(replace_design_sections(RIG, &sections).len(), RIG.len());
        assert_eq!(other_sections(RIG).len() + sections.len(), RIG.len());
        let changed = sections.replace("gain", "gain ");
        let text = replace_design_sections(RIG, &changed);
        assert_eq!(design_sections(&text), changed);
        assert_eq!(replace_design_sections("[plant]\n", "[synth]\n"), "[plant]\n\n[synth]\n");
    }

    #[test]
    fn keys_before_the_first_heading_belong_to_a_design_too() {
        let text = "format = 2\n# of the loop\nsynth.loop = \"cascade\"\nverify.step.rate = 1e-3\n\n[plant]\nname = \"a\"\n";
        let kept = design_sections(text);
        assert_eq!(kept, "# of the loop\nsynth.loop = \"cascade\"\n");
        assert_eq!(replace_design_sections(text, &kept), text);
        let headed = "[synth]\nloop = \"rate\"\n";
        let changed = replace_design_sections(text, headed);
        assert_eq!(
            changed,
            "format = 2\nverify.step.rate = 1e-3\n\n[plant]\nname = \"a\"\n\n[synth]\nloop = \"rate\"\n"
        );
        let back = replace_design_sections(&changed, &kept);
        assert_eq!(weight_differences(&back, text).unwrap(), []);
        assert!(back.find("synth.loop").unwrap() < back.find("[plant]").unwrap());
        let none = replace_design_sections(text, "");
        assert_eq!(design_sections(&none), "");
    }

    #[test]
    fn designs_are_compared_by_their_values_and_not_by_how_they_are_written() {
        let first = "[synth]\norder = 3\n\n[synth.feedback.error]\ngain = 26.0 # of the rig\n";
        let same = "[synth.feedback.error]\ngain = 26\n[synth]\norder = 3\n";
        assert_eq!(weight_differences(first, same).unwrap(), []);
        let other = "[synth.feedback.error]\ngain = 31.5\n[[synth.notch]]\nrate = 2.0\n";
        let found = weight_differences(first, other).unwrap();
        let shown: Vec<String> =
            found.iter().map(|d| format!("{} {:?} {:?}", d.path, d.first, d.second)).collect();
        let expected = [
            "synth.feedback.error.gain Some(\"26.0\") Some(\"31.5\")",
            "synth.notch[0].rate None Some(\"2.0\")",
            "synth.order Some(\"3.0\") None",
        ];
        assert_eq!(shown, expected);
        assert_eq!(weight_differences(first, "gain = = 3"), None);
    }
}
