//! Reads a tree into fields, and gathers every finding on the way instead of stopping at the first.

use super::attachments::Attachments;
use super::field::{Fallback, Field, Limit, Need, TableField};
use super::source::{Remark, Source};
use super::tree::{Entry, Node, Value};
use super::visit::{Count, Visit};
use crate::diagnostic::{Diagnostic, Problem, Severity, did_you_mean, nearest};

/// A walk over the tree of a file.
pub(crate) struct Reader<'a> {
    source: &'a Source,
    attachments: &'a Attachments,
    frames: Vec<Frame<'a>>,
    lists: Vec<List<'a>>,
    pub findings: Vec<Diagnostic>,
}

/// The table in which the walk stands.
struct Frame<'a> {
    path: String,
    start: usize,
    entries: &'a [Entry],
    known: Vec<String>,
    /// Something above is wrong already: say nothing of what is missing or not known here.
    silent: bool,
    /// What must be here and is not; forgiven where a misspelt key was meant for it.
    missing: Vec<(String, Diagnostic)>,
}

/// The list of tables in which the walk stands.
struct List<'a> {
    path: String,
    items: &'a [Node],
}

const NOTHING: &[Entry] = &[];

impl<'a> Reader<'a> {
    pub fn new(source: &'a Source, entries: &'a [Entry], attachments: &'a Attachments) -> Self {
        let root = Frame {
            path: String::new(),
            start: 0,
            entries,
            known: Vec::new(),
            silent: false,
            missing: Vec::new(),
        };
        Self { source, attachments, frames: vec![root], lists: Vec::new(), findings: Vec::new() }
    }

    /// Says what the outermost table holds that the walk did not name, and gives the findings.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        self.leave();
        self.findings
    }

    fn path(&self, key: &str) -> String {
        match self.frames.last() {
            Some(frame) if !frame.path.is_empty() => format!("{}.{key}", frame.path),
            _ => key.to_owned(),
        }
    }

    fn report(&mut self, at: usize, remark: Remark) {
        self.findings.push(self.source.diagnostic(Severity::Error, at, remark));
    }

    /// The node of a key, which from now on is known.
    fn look(&mut self, key: &str) -> Option<&'a Entry> {
        let frame = self.frames.last_mut()?;
        frame.known.push(key.to_owned());
        frame.entries.iter().find(|e| e.key == key)
    }

    fn missing(&mut self, key: &str, allowed: String) {
        let path = self.path(key);
        let Some(frame) = self.frames.last_mut().filter(|f| !f.silent) else { return };
        let finding = self.source.diagnostic(
            Severity::Error,
            frame.start,
            Remark::new(Problem::Missing, &path, allowed),
        );
        frame.missing.push((key.to_owned(), finding));
    }

    /// The node of a field, or a finding if it is required and not there.
    fn find(&mut self, field: &Field) -> Option<&'a Node> {
        let entry = self.look(field.key);
        if entry.is_none() && field.default == Fallback::Required {
            let unit = if field.unit.is_empty() { String::new() } else { format!(", {}", field.unit) };
            self.missing(field.key, format!("is missing; it is required: {}{unit}", field.meaning));
        }
        entry.map(|e| &e.node)
    }

    fn refuse(&mut self, path: &str, node: &Node, problem: Problem, allowed: String) {
        let found = self.source.quote(&node.span);
        let remark = Remark::new(problem, path, allowed).found(found);
        self.report(node.span.start, remark);
    }

    fn wrong_type(&mut self, path: &str, node: &Node, wanted: &str) {
        let is = node.value.kind();
        let found =
            if matches!(node.value, Value::Table(_)) { is.to_owned() } else { self.source.quote(&node.span) };
        let remark =
            Remark::new(Problem::WrongType, path, format!("must be {wanted}, not {is}")).found(found);
        self.report(node.span.start, remark);
    }

    /// A number at a node that obeys a field's range.
    fn number_at(&mut self, path: &str, node: &Node, field: &Field) -> Option<f64> {
        let value = match &node.value {
            Value::Number(value) => *value,
            Value::Whole(value) => *value as f64,
            _ => {
                self.wrong_type(path, node, &format!("a number{}", in_unit(field.unit)));
                return None;
            }
        };
        if !value.is_finite() {
            let range = if field.limit == Limit::Any {
                String::new()
            } else {
                format!("; it {}", field.limit.words(field.unit))
            };
            self.refuse(path, node, Problem::NotFinite, format!("must be a finite number{range}"));
            return None;
        }
        if !field.limit.holds(value) {
            self.refuse(path, node, Problem::OutOfRange, field.limit.words(field.unit));
            return None;
        }
        Some(value)
    }

    /// The items of a list, or a finding.
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
            self.refuse(path, node, Problem::OutOfRange, format!("must hold 2 numbers, not {}", items.len()));
            return None;
        };
        Some([self.number_at(path, first, field)?, self.number_at(path, second, field)?])
    }

    fn pairs_from(&mut self, path: &str, node: &Node, name: &str) -> Option<Vec<[f64; 2]>> {
        match self.attachments.pairs(name) {
            Ok(pairs) => Some(pairs),
            Err(why) => {
                self.refuse(path, node, Problem::UnknownName, why);
                None
            }
        }
    }

    fn push(&mut self, path: String, start: usize, entries: &'a [Entry], silent: bool) {
        self.frames.push(Frame { path, start, entries, known: Vec::new(), silent, missing: Vec::new() });
    }

    fn unknown(&mut self, frame: &mut Frame<'_>, entry: &Entry) {
        let what = if matches!(entry.node.value, Value::Table(_)) { "section" } else { "key" };
        let known: Vec<&str> = frame.known.iter().map(String::as_str).collect();
        let near = nearest(&entry.key, known.iter().copied()).map(str::to_owned);
        let path =
            if frame.path.is_empty() { entry.key.clone() } else { format!("{}.{}", frame.path, entry.key) };
        let allowed = format!("there is no such {what}; known here: {}", known.join(", "));
        let hint = near.as_ref().map(|name| format!("did you mean \"{name}\"?"));
        frame.missing.retain(|(key, _)| near.as_ref() != Some(key));
        self.report(entry.key_span.start, Remark::new(Problem::UnknownKey, &path, allowed).hint(hint));
    }
}

fn in_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in {unit}") }
}

impl Visit for Reader<'_> {
    fn number(&mut self, field: &Field, value: &mut f64) {
        match self.find(field) {
            Some(node) => *value = self.number_at(&self.path(field.key), node, field).unwrap_or(f64::NAN),
            None => *value = if let Fallback::Number(default) = field.default { default } else { f64::NAN },
        }
    }

    fn whole(&mut self, field: &Field, value: &mut u32) {
        let Some(node) = self.find(field) else {
            *value = if let Fallback::Number(default) = field.default { default as u32 } else { 0 };
            return;
        };
        let path = self.path(field.key);
        match node.value {
            Value::Whole(whole) if field.limit.holds(whole as f64) && u32::try_from(whole).is_ok() => {
                *value = whole as u32
            }
            Value::Whole(_) => self.refuse(&path, node, Problem::OutOfRange, field.limit.words(field.unit)),
            Value::Number(_) => {
                self.refuse(
                    &path,
                    node,
                    Problem::WrongType,
                    "must be a whole number, without decimal point".to_owned(),
                );
            }
            _ => self.wrong_type(&path, node, "a whole number"),
        }
    }

    fn text(&mut self, field: &Field, value: &mut String) {
        let Some(node) = self.find(field) else {
            *value =
                if let Fallback::Text(default) = field.default { default.to_owned() } else { String::new() };
            return;
        };
        let path = self.path(field.key);
        match &node.value {
            Value::Text(text) if text.trim().is_empty() && field.default == Fallback::Required => {
                self.refuse(&path, node, Problem::OutOfRange, "must not be empty".to_owned());
            }
            Value::Text(text) => text.clone_into(value),
            _ => self.wrong_type(&path, node, "a text in quotes"),
        }
    }

    fn choice(&mut self, field: &Field, allowed: &[&'static str], value: &mut &'static str) {
        let Some(node) = self.find(field) else {
            if let Fallback::Text(default) = field.default {
                *value = default;
            } else {
                self.silence();
            }
            return;
        };
        let path = self.path(field.key);
        let list = allowed.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        let one_of = if allowed.len() == 1 { list } else { format!("one of {list}") };
        let Value::Text(text) = &node.value else {
            self.wrong_type(&path, node, &one_of);
            self.silence();
            return;
        };
        if let Some(name) = allowed.iter().find(|name| *name == text) {
            *value = name;
            return;
        }
        let remark = Remark::new(Problem::OutOfRange, &path, format!("must be {one_of}"))
            .found(self.source.quote(&node.span));
        self.report(node.span.start, remark.hint(did_you_mean(text, allowed.iter().copied())));
        self.silence();
    }

    fn numbers(&mut self, field: &Field, count: Count, value: &mut Vec<f64>) {
        let Some(node) = self.find(field) else {
            value.clear();
            return;
        };
        let path = self.path(field.key);
        let Some(items) = self.items(&path, node, "a list of numbers") else { return };
        match count {
            Count::Exactly(n) if items.len() != n => {
                self.refuse(
                    &path,
                    node,
                    Problem::OutOfRange,
                    format!("must hold {n} numbers, not {}", items.len()),
                );
            }
            Count::AtLeastOne if items.is_empty() => {
                self.refuse(&path, node, Problem::OutOfRange, "must hold at least one number".to_owned());
            }
            _ => {
                *value = items
                    .iter()
                    .enumerate()
                    .filter_map(|(i, item)| self.number_at(&format!("{path}[{i}]"), item, field))
                    .collect()
            }
        }
    }

    fn texts(&mut self, field: &Field, value: &mut Vec<String>) {
        value.clear();
        let Some(node) = self.find(field) else { return };
        let path = self.path(field.key);
        let Some(items) = self.items(&path, node, "a list of texts") else { return };
        for (i, item) in items.iter().enumerate() {
            match &item.value {
                Value::Text(text) => value.push(text.clone()),
                _ => self.wrong_type(&format!("{path}[{i}]"), item, "a text in quotes"),
            }
        }
    }

    fn pairs(&mut self, field: &Field, value: &mut Vec<[f64; 2]>) {
        value.clear();
        let Some(node) = self.find(field) else { return };
        let path = self.path(field.key);
        if let Value::Text(name) = &node.value {
            *value = self.pairs_from(&path, node, name).unwrap_or_default();
            return;
        }
        let Some(items) = self.items(&path, node, "a list of pairs of numbers or the name of a file") else {
            return;
        };
        *value = items
            .iter()
            .enumerate()
            .filter_map(|(i, item)| self.pair_at(&format!("{path}[{i}]"), item, field))
            .collect();
    }

    fn enter(&mut self, table: &TableField, _present: bool) -> bool {
        let path = self.path(table.key);
        let Some(entry) = self.look(table.key) else {
            if table.need == Need::Required {
                self.missing(
                    table.key,
                    format!("section [{path}] is missing; it is required: {}", table.meaning),
                );
            }
            return false;
        };
        let Value::Table(entries) = &entry.node.value else {
            self.wrong_type(&path, &entry.node, &format!("a table, as in [{path}]"));
            return false;
        };
        self.push(path, entry.node.span.start, entries, false);
        true
    }

    fn leave(&mut self) {
        let Some(mut frame) = self.frames.pop() else { return };
        let entries = if frame.silent { NOTHING } else { frame.entries };
        let unknown: Vec<&Entry> = entries.iter().filter(|e| !frame.known.contains(&e.key)).collect();
        for entry in unknown {
            self.unknown(&mut frame, entry);
        }
        self.findings.extend(frame.missing.into_iter().map(|(_, finding)| finding));
    }

    fn enter_list(&mut self, table: &TableField, _length: usize) -> usize {
        let path = self.path(table.key);
        let entry = self.look(table.key);
        let items: &[Node] = match entry.map(|e| &e.node) {
            Some(Node { value: Value::List(items), .. }) => items,
            Some(node) => {
                self.wrong_type(&path, node, &format!("a list of tables, as in [[{path}]]"));
                &[]
            }
            None => {
                if table.need == Need::Required {
                    self.missing(
                        table.key,
                        format!("section [[{path}]] is missing; at least one is required: {}", table.meaning),
                    );
                }
                &[]
            }
        };
        self.lists.push(List { path, items });
        items.len()
    }

    fn enter_item(&mut self, index: usize) {
        let Some(List { path, items }) = self.lists.last() else { return };
        let (path, node) = (format!("{path}[{index}]"), items.get(index));
        match node {
            Some(Node { span, value: Value::Table(entries) }) => self.push(path, span.start, entries, false),
            Some(node) => {
                self.wrong_type(&path, node, "a table");
                self.push(path, node.span.start, NOTHING, true);
            }
            None => self.push(path, 0, NOTHING, true),
        }
    }

    fn leave_list(&mut self) {
        self.lists.pop();
    }

    fn complain(&mut self, key: &str, allowed: &str, hint: Option<String>) {
        let path = self.path(key);
        let Some(entry) = self.frames.last().and_then(|f| f.entries.iter().find(|e| e.key == key)) else {
            return;
        };
        let item = self
            .frames
            .last()
            .map(|f| f.path.clone())
            .filter(|p| p.ends_with(']'))
            .unwrap_or_else(|| path.clone());
        let told = self.findings.iter().any(|f| f.path == path || f.path.starts_with(&item));
        if !told {
            let remark =
                Remark::new(Problem::OutOfRange, &path, allowed).found(self.source.quote(&entry.node.span));
            self.report(entry.node.span.start, remark.hint(hint));
        }
    }

    fn shorthand(&mut self, key: &str, value: &mut String) -> bool {
        let Some(entry) = self.frames.last().and_then(|f| f.entries.iter().find(|e| e.key == key)) else {
            return false;
        };
        let Value::Text(text) = &entry.node.value else { return false };
        text.clone_into(value);
        self.look(key);
        true
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
