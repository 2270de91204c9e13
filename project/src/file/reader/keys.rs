//! The reading of keys: look it up, judge it, fill the field.

use super::{Frame, List, NOTHING, Reader};
use crate::diagnostic::{DiagnosticKind, did_you_mean, is_control};
use crate::file::field::{Fallback, Field, Need, TableField};
use crate::file::source::Remark;
use crate::file::tree::{self, Entry, Lookup, Node, Value};
use crate::file::visit::{Count, Presence, Visit};

const NOT_WHOLE: &str = "must be a whole number, without decimal point";
/// Longest text, in bytes: the longest path of a file.
const LONGEST_TEXT: usize = 4096;

/// Returns what keeps a text from being a name or a path.
fn text_problem(text: &str) -> Option<String> {
    if text.chars().any(is_control) {
        return Some("must not hold control characters".to_owned());
    }
    let length = text.len();
    (length > LONGEST_TEXT).then(|| format!("must not be longer than {LONGEST_TEXT} bytes (it has {length})"))
}

impl<'a> Visit for Reader<'a> {
    fn number(&mut self, field: &Field, value: &mut f64) {
        match self.find(field) {
            Some(node) => {
                *value = self.keyed_number(&self.path(field.key), node, field).unwrap_or(f64::NAN);
                self.note_stated(field, *value);
            }
            None => {
                *value = if let Fallback::Number(default) = field.default { default } else { f64::NAN };
                self.note_default(field);
            }
        }
    }

    fn whole_number(&mut self, field: &Field, value: &mut u32) {
        let Some(node) = self.find(field) else {
            *value = if let Fallback::Number(default) = field.default { default as u32 } else { 0 };
            self.note_default(field);
            return;
        };
        let path = self.path(field.key);
        match &node.value {
            Value::Whole(whole) if field.limit.holds(*whole as f64) && u32::try_from(*whole).is_ok() => {
                *value = *whole as u32
            }
            Value::Whole(_) => {
                self.refuse(&path, node, DiagnosticKind::OutOfRange, field.limit.words(field.unit))
            }
            Value::Number(_) => self.refuse(&path, node, DiagnosticKind::WrongType, NOT_WHOLE.to_owned()),
            Value::Text(_) if !field.unit.is_empty() => {
                let Some(number) = self.number_at(&path, node, field) else { return };
                if number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number) {
                    *value = number as u32;
                } else {
                    self.refuse(&path, node, DiagnosticKind::WrongType, NOT_WHOLE.to_owned());
                }
            }
            _ => self.wrong_type(&path, node, "a whole number"),
        }
        self.note_stated(field, f64::from(*value));
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
                self.refuse(&path, node, DiagnosticKind::OutOfRange, "must not be empty".to_owned());
            }
            Value::Text(text) => match text_problem(text) {
                Some(problem) => self.refuse(&path, node, DiagnosticKind::OutOfRange, problem),
                None => text.clone_into(value),
            },
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
        let remark = Remark::new(DiagnosticKind::OutOfRange, &path, format!("must be {one_of}"))
            .with_value(self.source.quote(&node.span));
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
                    DiagnosticKind::OutOfRange,
                    format!("must hold {n} numbers, not {}", items.len()),
                );
            }
            Count::AtLeastOne if items.is_empty() => {
                self.refuse(
                    &path,
                    node,
                    DiagnosticKind::OutOfRange,
                    "must hold at least one number".to_owned(),
                );
            }
            _ => {
                *value = items
                    .iter()
                    .enumerate()
                    .filter_map(|(i, item)| self.number_at(&format!("{path}[{i}]"), item, &field.item(i)))
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
                Value::Text(text) => match text_problem(text) {
                    Some(problem) => {
                        self.refuse(&format!("{path}[{i}]"), item, DiagnosticKind::OutOfRange, problem)
                    }
                    None => value.push(text.clone()),
                },
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

    fn enter(&mut self, table: &TableField, _presence: Presence) -> bool {
        let path = self.path(table.key);
        let Some(entry) = self.look(table.key) else {
            if table.need == Need::Required {
                let smallest = match table.smallest {
                    "" => String::new(),
                    content => format!("; the smallest is `{} = {{ {content} }}`", table.key),
                };
                let meaning = table.meaning;
                self.report_missing(
                    table.key,
                    format!("section [{path}] is missing; it is required: {meaning}{smallest}"),
                );
            }
            return false;
        };
        let Value::Table(entries) = &entry.node.value else {
            self.wrong_type(&path, &entry.node, &format!("a table, as in [{path}]"));
            return false;
        };
        self.frames.push(Frame::new(path, entry.node.span.start, entries));
        true
    }

    fn leave(&mut self) {
        let Some(mut frame) = self.frames.pop() else { return };
        let entries = if frame.silent { NOTHING } else { frame.entries };
        let unknown: Vec<&Entry> = entries.iter().filter(|e| !frame.known.contains(&e.key)).collect();
        for entry in unknown {
            self.report_unknown(&mut frame, entry);
        }
        let space = super::MOST_FINDINGS.saturating_sub(self.findings.len());
        self.findings.extend(frame.missing.into_iter().map(|(_, finding)| finding).take(space));
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
                    self.report_missing(
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
            Some(Node { span, value: Value::Table(entries) }) => {
                self.frames.push(Frame::new(path, span.start, entries));
            }
            Some(node) => {
                self.wrong_type(&path, node, "a table");
                self.frames.push(Frame::silent_frame(path, node.span.start));
            }
            None => self.frames.push(Frame::silent_frame(path, 0)),
        }
    }

    fn leave_list(&mut self) {
        self.lists.pop();
    }

    fn complain(&mut self, key: &str, allowed: &str, hint: Option<String>) {
        let path = self.path(key);
        let (Some(node), Lookup::Exact) =
            self.frames.last().map_or((None, Lookup::Enclosing), |f| tree::find(f.entries, key))
        else {
            self.complain_of_default(key, allowed, hint);
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
            let remark = Remark::new(DiagnosticKind::OutOfRange, &path, allowed)
                .with_value(self.source.quote(&node.span));
            self.report(node.span.start, remark.hint(hint));
        }
    }

    fn attached_text(&mut self, name: &str) -> Option<Result<String, String>> {
        if name.is_empty() { None } else { Some(self.attachments.text(name)) }
    }

    fn attached_bytes(&mut self, name: &str) -> Option<Result<Vec<u8>, String>> {
        if name.is_empty() { None } else { Some(self.attachments.bytes(name).map(<[u8]>::to_vec)) }
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

    fn has(&self, key: &str) -> bool {
        self.frames.last().is_some_and(|frame| tree::find(frame.entries, key).1 == Lookup::Exact)
    }

    fn assume(&mut self, field: &Field, value: f64) {
        let path = self.path(field.key);
        self.note(path, field, value);
    }
}
