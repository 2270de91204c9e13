//! Reads a tree into fields, and gathers every finding on the way instead of stopping at the first.

mod keys;
mod numbers;
pub(crate) mod synonyms;

use std::collections::{BTreeMap, BTreeSet};

use super::attachments::Attachments;
use super::field::{Fallback, Field};
use super::source::{Remark, Source};
use super::tree::{Entry, Node, Value};
use super::visit::Visit;
use crate::assumption::{Assumption, KeyTolerance};
use crate::diagnostic::{Diagnostic, DiagnosticKind, Severity, nearest_name};

/// A walk over the tree of a file.
pub(crate) struct Reader<'a> {
    source: &'a Source,
    attachments: &'a Attachments,
    frames: Vec<Frame<'a>>,
    lists: Vec<List<'a>>,
    pub findings: Vec<Diagnostic>,
    /// Defaults that stand in for physical quantities.
    pub assumptions: Vec<Assumption>,
    /// Keys of physical quantities that the file states with the value of their default.
    pub stated_defaults: BTreeSet<String>,
    /// Values that have tolerances.
    pub tolerances: Vec<KeyTolerance>,
    /// Units of the keys of quantities, by the bytes at which the quantities stand.
    pub units: BTreeMap<usize, &'static str>,
}

/// The table in which the walk stands.
struct Frame<'a> {
    path: String,
    start: usize,
    entries: &'a [Entry],
    known: Vec<String>,
    /// Something above is wrong already: say nothing of what is missing or not known here.
    silent: bool,
    /// The keys that must be here and are not; forgiven where a misspelt key was meant for it.
    missing: Vec<(String, Diagnostic)>,
    /// The keys that are known here have been listed.
    listed: bool,
}

impl<'a> Frame<'a> {
    fn new(path: String, start: usize, entries: &'a [Entry]) -> Self {
        Self { path, start, entries, known: Vec::new(), silent: false, missing: Vec::new(), listed: false }
    }

    /// Returns the frame of a table that is missing or wrong, which has been reported.
    fn silent_frame(path: String, start: usize) -> Self {
        Self { silent: true, ..Self::new(path, start, NOTHING) }
    }
}

/// The list of tables in which the walk stands.
struct List<'a> {
    path: String,
    items: &'a [Node],
}

const NOTHING: &[Entry] = &[];
/// Most findings that are kept: a file with more is no project file.
const MOST_FINDINGS: usize = 1000;
/// The remedy if a physical quantity without default is not known.
const ESTIMATE: &str = "nothing is assumed for it, but an estimate will do, with how far it may be off: { value = ..., tolerance = 0.3 }";
/// Most known keys that a finding lists.
const MOST_KNOWN: usize = 24;

impl<'a> Reader<'a> {
    pub fn new(source: &'a Source, entries: &'a [Entry], attachments: &'a Attachments) -> Self {
        let root = Frame::new(String::new(), 0, entries);
        Self {
            source,
            attachments,
            frames: vec![root],
            lists: Vec::new(),
            findings: Vec::new(),
            assumptions: Vec::new(),
            stated_defaults: BTreeSet::new(),
            tolerances: Vec::new(),
            units: BTreeMap::new(),
        }
    }

    /// Reports what the outermost table holds that the walk did not name.
    pub fn finish(&mut self) {
        self.leave();
    }

    fn path(&self, key: &str) -> String {
        match self.frames.last() {
            Some(frame) if !frame.path.is_empty() && key.is_empty() => frame.path.clone(),
            Some(frame) if !frame.path.is_empty() => format!("{}.{key}", frame.path),
            _ => key.to_owned(),
        }
    }

    fn report(&mut self, at: usize, remark: Remark) {
        if self.findings.len() < MOST_FINDINGS {
            self.findings.push(self.source.diagnostic(Severity::Error, at, remark));
        }
    }

    /// Returns the node of a key, which from now on is known.
    fn look(&mut self, key: &str) -> Option<&'a Entry> {
        let frame = self.frames.last_mut()?;
        frame.known.push(key.to_owned());
        frame.entries.iter().find(|e| e.key == key)
    }

    fn report_missing(&mut self, key: &str, allowed: String) {
        let path = self.path(key);
        let Some(frame) = self.frames.last_mut().filter(|f| !f.silent) else { return };
        let finding = self.source.diagnostic(
            Severity::Error,
            frame.start,
            Remark::new(DiagnosticKind::Missing, &path, allowed),
        );
        frame.missing.push((key.to_owned(), finding));
    }

    /// Adds to the last missing key what to do if its value is not known.
    fn hint_last_missing(&mut self, unknown: &str) {
        let last = self.frames.last_mut().and_then(|frame| frame.missing.last_mut());
        if let Some((_, finding)) = last {
            finding.hint = Some(format!("if it is not known: {unknown}"));
        }
    }

    /// Reports an error of a key that the file does not have: its default does not fit the keys around it.
    /// Said only where nothing else is wrong in its table: a value that could not be read is no ground to judge others.
    /// A complaint of no key is one of the section itself.
    fn complain_of_default(&mut self, key: &str, allowed: &str, hint: Option<String>) {
        let Some(frame) = self.frames.last() else { return };
        let told = !frame.missing.is_empty() || self.findings.iter().any(|f| f.path.starts_with(&frame.path));
        if told {
            return;
        }
        if frame.known.iter().any(|known| known == key) {
            self.report_missing(key, format!("{allowed}; it is not written, and its default does not fit"));
        } else {
            self.report_missing(key, allowed.to_owned());
        }
        if let Some((_, finding)) = self.frames.last_mut().and_then(|frame| frame.missing.last_mut()) {
            finding.hint = hint;
        }
    }

    /// Returns the node of a field, or a finding if it is required and not there.
    fn find(&mut self, field: &Field) -> Option<&'a Node> {
        let entry = self.look(field.key);
        if entry.is_none() && field.default == Fallback::Required {
            let unit = if field.unit.is_empty() { String::new() } else { format!(", {}", field.unit) };
            let estimate = !field.unit.is_empty() && self.path(field.key).starts_with(numbers::PHYSICAL);
            let unknown = if field.unknown.is_empty() && estimate { ESTIMATE } else { field.unknown };
            self.report_missing(field.key, format!("is missing; it is required: {}{unit}", field.meaning));
            if !unknown.is_empty() {
                self.hint_last_missing(unknown);
            }
        }
        entry.map(|e| &e.node)
    }

    fn refuse(&mut self, path: &str, node: &Node, problem: DiagnosticKind, allowed: String) {
        let found = self.source.quote(&node.span);
        let remark = Remark::new(problem, path, allowed).with_value(found);
        self.report(node.span.start, remark);
    }

    fn wrong_type(&mut self, path: &str, node: &Node, wanted: &str) {
        let is = node.value.kind();
        let found =
            if matches!(node.value, Value::Table(_)) { is.to_owned() } else { self.source.quote(&node.span) };
        let remark = Remark::new(DiagnosticKind::WrongType, path, format!("must be {wanted}, not {is}"))
            .with_value(found);
        self.report(node.span.start, remark);
    }

    /// Returns the items of a list, or a finding.
    fn items(&mut self, path: &str, node: &'a Node, wanted: &str) -> Option<&'a [Node]> {
        if let Value::List(items) = &node.value {
            return Some(items);
        }
        self.wrong_type(path, node, wanted);
        None
    }

    fn pair_at(&mut self, path: &str, node: &'a Node, field: &Field) -> Option<[f64; 2]> {
        let items = self.items(path, node, "a pair of numbers, as in [0.5, 1.5]")?;
        let [first, second] = items else {
            self.refuse(
                path,
                node,
                DiagnosticKind::OutOfRange,
                format!("must hold 2 numbers, not {}", items.len()),
            );
            return None;
        };
        Some([self.number_at(path, first, field)?, self.number_at(path, second, &field.item(1))?])
    }

    fn pairs_from(&mut self, path: &str, node: &Node, name: &str) -> Option<Vec<[f64; 2]>> {
        match self.attachments.pairs(name) {
            Ok(pairs) => Some(pairs),
            Err(why) => {
                self.refuse(path, node, DiagnosticKind::UnknownName, why);
                None
            }
        }
    }

    fn report_unknown(&mut self, frame: &mut Frame<'_>, entry: &Entry) {
        let what = if matches!(entry.node.value, Value::Table(_)) { "section" } else { "key" };
        let known: Vec<&str> = frame.known.iter().take(MOST_KNOWN).map(String::as_str).collect();
        let known = if frame.listed { String::new() } else { format!("; known here: {}", known.join(", ")) };
        frame.listed = true;
        let near = nearest_name(&entry.key, frame.known.iter().map(String::as_str));
        let near = near.or_else(|| synonyms::find_synonym(&entry.key, &frame.known)).map(str::to_owned);
        let path =
            if frame.path.is_empty() { entry.key.clone() } else { format!("{}.{}", frame.path, entry.key) };
        let allowed = format!("there is no such {what}{known}");
        let hint = near.as_ref().map(|name| format!("did you mean \"{name}\"?"));
        frame.missing.retain(|(key, _)| near.as_ref() != Some(key));
        self.report(entry.key_span.start, Remark::new(DiagnosticKind::UnknownKey, &path, allowed).hint(hint));
    }
}

impl Reader<'_> {
    /// The rest of this table cannot be judged.
    fn silence(&mut self) {
        if let Some(frame) = self.frames.last_mut() {
            frame.silent = true;
        }
    }
}
