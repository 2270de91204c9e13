//! The sections of a project's text that make its design: taken out, put in, and compared.

use std::collections::BTreeMap;

use super::key_path::section_name;

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

/// A stretch of a text: a section with its heading, or what stands before the first one.
pub(crate) struct TextSection<'a> {
    /// The first part of the section's name; empty before the first heading.
    pub name: String,
    /// The text.
    pub text: &'a str,
}

/// Returns the sections of a text, which together are the text. The comments directly above a heading belong to its section.
pub(crate) fn split_sections(text: &str) -> Vec<TextSection<'_>> {
    let mut starts = vec![SectionStart { byte: 0, name: String::new() }];
    let (mut byte, mut comment) = (0, None);
    for line in text.split_inclusive('\n') {
        if let Some(name) = section_name(line) {
            let name = name.split('.').next().unwrap_or_default().to_owned();
            starts.push(SectionStart { byte: comment.unwrap_or(byte), name });
        }
        comment = if line.starts_with('#') { comment.or(Some(byte)) } else { None };
        byte += line.len();
    }
    let ends: Vec<usize> = starts.iter().skip(1).map(|start| start.byte).chain([text.len()]).collect();
    let section =
        |(start, end): (SectionStart, usize)| TextSection { text: &text[start.byte..end], name: start.name };
    starts.into_iter().zip(ends).map(section).collect()
}

/// The start of a section.
struct SectionStart {
    byte: usize,
    name: String,
}

fn is_design(section: &TextSection) -> bool {
    DESIGN_SECTIONS.contains(&section.name.as_str())
}

/// Returns the sections of a project's text that make its design, with their comments.
pub fn design_sections(text: &str) -> String {
    split_sections(text).into_iter().filter(is_design).map(|section| section.text).collect()
}

/// Returns everything in a project's text but the sections that make its design.
pub fn other_sections(text: &str) -> String {
    split_sections(text)
        .into_iter()
        .filter(|section| !is_design(section))
        .map(|section| section.text)
        .collect()
}

/// Returns a project's text with the sections of its design replaced; they stand where the first of the old ones stood.
pub fn replace_design_sections(text: &str, sections: &str) -> String {
    let (mut out, mut is_written) = (String::new(), false);
    for section in split_sections(text) {
        if !is_design(&section) {
            out.push_str(section.text);
        } else if !std::mem::replace(&mut is_written, true) {
            out.push_str(sections);
        }
    }
    if !is_written {
        out.push('\n');
        out.push_str(sections);
    }
    out
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
