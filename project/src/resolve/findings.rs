//! The findings of the checks, and the check that several of them share.

use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, DiagnosticKind, Severity};
use crate::file::Document;
use crate::file::source::Remark;

/// Most findings that are kept.
const MOST_FINDINGS: usize = 1000;

/// Findings of one check.
pub(super) struct Findings<'a> {
    document: &'a Document,
    list: Vec<Diagnostic>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(document: &'a Document) -> Self {
        Self { document, list: Vec::new() }
    }

    /// Returns whether the file states a value at a path.
    pub(super) fn states(&self, path: &str) -> bool {
        self.document.has(path)
    }

    /// Returns the value at a path as the file writes it, a text without its quotes.
    pub(super) fn written_at(&self, path: &str) -> Option<String> {
        let of_tolerance = self.document.source_text_at(&format!("{path}.value"));
        of_tolerance.or_else(|| self.document.source_text_at(path))
    }

    pub(super) fn into_list(self) -> Vec<Diagnostic> {
        self.list
    }

    pub(super) fn add(&mut self, severity: Severity, remark: Remark) {
        if self.list.len() < MOST_FINDINGS {
            self.list.push(self.document.finding(severity, remark));
        }
    }
}

/// Adds a finding for every name in a list that is taken already.
pub(super) fn report_duplicates<'n>(
    findings: &mut Findings<'_>,
    list: &str,
    names: impl Iterator<Item = &'n str>,
) {
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, name) in names.enumerate().filter(|(_, name)| !name.is_empty()) {
        if let Some(first) = seen.get(name) {
            let allowed = format!("the name is taken by {list}[{first}]; names must differ");
            let remark = Remark::new(DiagnosticKind::Duplicate, &format!("{list}[{index}].name"), allowed);
            findings.add(Severity::Error, remark.with_value(format!("\"{name}\"")));
        }
        seen.entry(name).or_insert(index);
    }
}
