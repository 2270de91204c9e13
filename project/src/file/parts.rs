//! Parts: files that a project file includes, put in their place in its tree.
//!
//! `include = "motor.toml"` in a table adds what the named file holds to that table. Tables that both have are merged; a key that
//! both have is an error, so that nothing is overruled silently. Names are relative to the file that includes, and so are the files
//! that a part names.

use std::collections::{BTreeMap, BTreeSet};

use super::attachments::Attachments;
use super::source::{Remark, Source};
use super::tree::{self, Entry, Node, Start, Value};
use crate::diagnostic::{Diagnostic, DiagnosticKind, Severity};

/// The key that names parts.
pub(crate) const INCLUDE: &str = "include";
/// Most parts of a project.
const MOST_PARTS: usize = 64;
/// Deepest nesting of parts in parts.
const DEEPEST: usize = 8;
/// Most errors about parts that are kept.
const MOST_FINDINGS: usize = 100;

/// Keys besides those of [`super::NAMING_FILES`] that name a file beside the project.
const ROAD_RECORDING: &str = "verify.road.recording";

/// A tree with its parts in place.
pub(crate) struct AssembledTree {
    pub source: Source,
    pub entries: Vec<Entry>,
    /// Parts that are named, found or not.
    pub wanted: Vec<String>,
    /// Errors of the parts.
    pub findings: Vec<Diagnostic>,
}

/// Returns whether a tree includes parts.
pub(crate) fn has_parts(entries: &[Entry]) -> bool {
    let inside = |node: &Node| match &node.value {
        Value::Table(entries) => has_parts(entries),
        Value::List(items) => {
            items.iter().any(|item| matches!(&item.value, Value::Table(entries) if has_parts(entries)))
        }
        _ => false,
    };
    entries.iter().any(|entry| entry.key == INCLUDE || inside(&entry.node))
}

/// Puts the parts of a tree in their places.
pub(crate) fn assemble(source: &Source, entries: &[Entry], given: &Attachments) -> AssembledTree {
    let own = normal("", source.name().rsplit(['/', '\\']).next().unwrap_or_default()).unwrap_or_default();
    let mut assembly =
        Assembly { source: source.clone(), given, wanted: BTreeSet::new(), findings: Vec::new(), count: 0 };
    let place = Place { path: String::new(), chain: vec![own] };
    let entries = assembly.expand_includes(entries.to_vec(), &place);
    let Assembly { source, wanted, mut findings, .. } = assembly;
    findings.truncate(MOST_FINDINGS);
    AssembledTree { source, entries, wanted: wanted.into_iter().collect(), findings }
}

/// The parts on the way to a project.
struct Assembly<'a> {
    source: Source,
    given: &'a Attachments,
    wanted: BTreeSet<String>,
    findings: Vec<Diagnostic>,
    count: usize,
}

/// The place of a table: its path, and the files that led to it, the innermost last.
#[derive(Clone)]
struct Place {
    path: String,
    chain: Vec<String>,
}

impl Place {
    fn place_inside(&self, key: &str) -> Self {
        let path = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        Self { path, chain: self.chain.clone() }
    }

    fn folder(&self) -> &str {
        self.chain.last().and_then(|file| file.rsplit_once('/')).map_or("", |(folder, _)| folder)
    }
}

impl Assembly<'_> {
    fn refuse(&mut self, at: usize, path: &str, problem: DiagnosticKind, what: String) {
        if self.findings.len() < MOST_FINDINGS {
            let remark = Remark::new(problem, path, what);
            self.findings.push(self.source.diagnostic(Severity::Error, at, remark));
        }
    }

    /// Returns the keys of a table with those of its parts.
    fn expand_includes(&mut self, entries: Vec<Entry>, place: &Place) -> Vec<Entry> {
        let (includes, rest): (Vec<Entry>, Vec<Entry>) = entries.into_iter().partition(|e| e.key == INCLUDE);
        let mut all: Vec<Entry> = Vec::new();
        for mut entry in rest {
            let inside = place.place_inside(&entry.key);
            entry.node = self.expanded_node(entry.node, &inside);
            all.push(entry);
        }
        for include in &includes {
            for (name, at) in self.names(include, place) {
                let part = self.part(&name, at, place);
                all = self.merge_entries(all, part, place);
            }
        }
        all
    }

    fn expanded_node(&mut self, node: Node, place: &Place) -> Node {
        let value = match node.value {
            Value::Table(entries) => Value::Table(self.expand_includes(entries, place)),
            Value::List(items) => {
                Value::List(items.into_iter().map(|item| self.expanded_node(item, place)).collect())
            }
            other => other,
        };
        Node { span: node.span, value }
    }

    /// Returns the names that an `include` key holds, with their places.
    fn names(&mut self, include: &Entry, place: &Place) -> Vec<(String, usize)> {
        let items = match &include.node.value {
            Value::List(items) => items.iter().collect(),
            _ => vec![&include.node],
        };
        let mut names = Vec::new();
        for item in items {
            match &item.value {
                Value::Text(name) => names.push((name.clone(), item.span.start)),
                other => {
                    let what =
                        format!("must be the name of a file, or a list of names, not {}", other.kind());
                    let path = place.place_inside(INCLUDE).path;
                    self.refuse(item.span.start, &path, DiagnosticKind::WrongType, what);
                }
            }
        }
        names
    }

    /// Returns what a part holds, its own parts in place; nothing if it cannot be read, which is then reported.
    fn part(&mut self, name: &str, at: usize, place: &Place) -> Vec<Entry> {
        self.count += 1;
        let path = place.place_inside(INCLUDE).path;
        if self.count > MOST_PARTS {
            if self.count == MOST_PARTS + 1 {
                let what = format!("a project may include at most {MOST_PARTS} parts");
                self.refuse(at, &path, DiagnosticKind::OutOfRange, what);
            }
            return Vec::new();
        }
        let Some(file) = normal(place.folder(), name) else {
            let what = format!(
                "the name of a part must be relative to the file that includes it, with / between folders, not {name:?}"
            );
            self.refuse(at, &path, DiagnosticKind::OutOfRange, what);
            return Vec::new();
        };
        if place.chain.contains(&file) || place.chain.len() > DEEPEST {
            let what = format!("the file \"{file}\" includes itself: {}", place.chain.join(" includes "));
            let deep = format!("parts may include parts at most {DEEPEST} deep");
            let what = if place.chain.contains(&file) { what } else { deep };
            self.refuse(at, &path, DiagnosticKind::Conflict, what);
            return Vec::new();
        }
        self.wanted.insert(file.clone());
        let text = match self.given.text(&file) {
            Ok(text) => text,
            Err(why) => {
                self.refuse(at, &path, DiagnosticKind::UnknownName, why);
                return Vec::new();
            }
        };
        let mut within = place.clone();
        within.chain.push(file.clone());
        self.read(&file, &text, &within)
    }

    fn read(&mut self, file: &str, text: &str, place: &Place) -> Vec<Entry> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let start = self.source.add_part(file, text);
        let (mut entries, errors) = tree::parse(text, Start(start));
        for error in errors {
            self.refuse(error.span.start, "", DiagnosticKind::Syntax, error.message);
        }
        if let Some(format) = entries.iter().find(|e| e.key == "format")
            && let Some(what) = super::format_is_newer(&format.node)
        {
            self.refuse(format.node.span.start, "format", DiagnosticKind::Format, what);
        }
        // A part's format says how the part is written; it is no key of the table that includes it.
        entries.retain(|e| e.key != "format");
        rebase(&mut entries, &place.path, place.folder());
        self.expand_includes(entries, place)
    }

    /// Returns the keys of both; a key that both have and that is no table in both is an error.
    fn merge_entries(&mut self, mut own: Vec<Entry>, part: Vec<Entry>, place: &Place) -> Vec<Entry> {
        let mut known: BTreeMap<String, usize> =
            own.iter().enumerate().map(|(index, entry)| (entry.key.clone(), index)).collect();
        for entry in part {
            let Some(&index) = known.get(&entry.key) else {
                known.insert(entry.key.clone(), own.len());
                own.push(entry);
                continue;
            };
            let inside = place.place_inside(&entry.key);
            let here = own[index].key_span.start;
            match (&mut own[index].node.value, entry.node.value) {
                (Value::Table(mine), Value::Table(theirs)) => {
                    let both = self.merge_entries(std::mem::take(mine), theirs, &inside);
                    own[index].node.value = Value::Table(both);
                }
                _ => {
                    let remark = Remark::new(DiagnosticKind::Conflict, "", "");
                    let other = self.source.diagnostic(Severity::Error, here, remark);
                    let what =
                        format!("is given here and in {}:{}: remove one of the two", other.file, other.line);
                    self.refuse(entry.key_span.start, &inside.path, DiagnosticKind::Duplicate, what);
                }
            }
        }
        own
    }
}

/// Puts the folder of a part before the names of the files that it names.
fn rebase(entries: &mut [Entry], path: &str, folder: &str) {
    for entry in entries {
        let path = if path.is_empty() { entry.key.clone() } else { format!("{path}.{}", entry.key) };
        match &mut entry.node.value {
            Value::Table(inside) => rebase(inside, &path, folder),
            Value::Text(name) if super::NAMING_FILES.contains(&path.as_str()) || path == ROAD_RECORDING => {
                if let Some(whole) = normal(folder, name) {
                    *name = whole;
                }
            }
            _ => {}
        }
    }
}

/// Returns the name of a file relative to the project's folder, without `.` and `x/..`; `None` if it is empty, absolute, or holds a
/// character that no name of a file has.
fn normal(folder: &str, name: &str) -> Option<String> {
    let bad =
        name.is_empty() || name.starts_with('/') || name.chars().any(|c| c.is_control() || "\\:".contains(c));
    if bad {
        return None;
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(name.split('/')) {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            other => parts.push(other),
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_relative_and_without_detours() {
        assert_eq!(normal("parts", "motor.toml").as_deref(), Some("parts/motor.toml"));
        assert_eq!(normal("parts", "../shared/./motor.toml").as_deref(), Some("shared/motor.toml"));
        assert_eq!(normal("", "../a/../../b.toml").as_deref(), Some("../../b.toml"));
        for bad in ["", "/dev/zero", "C:\\motor.toml", "a\\b.toml", "a\nb", ".", "x/.."] {
            assert_eq!(normal("", bad), None, "{bad:?}");
        }
    }
}
