//! The text of a file, its name, and where its bytes stand in lines and columns.

use std::ops::Range;

use crate::diagnostic::{Diagnostic, Problem, Severity};

/// A text with its name.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    pub name: String,
    pub text: String,
}

/// What is said about a place of the text.
pub(crate) struct Remark {
    pub problem: Problem,
    pub path: String,
    pub found: Option<String>,
    pub allowed: String,
    pub hint: Option<String>,
}

/// Longest piece of the text that a finding quotes, in characters.
const LONGEST_QUOTE: usize = 48;

impl Source {
    /// Line and column (in characters), both from 1, of a byte of the text.
    pub fn position(&self, byte: usize) -> (usize, usize) {
        let before = self.text.get(..byte).unwrap_or(&self.text);
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let line = before.matches('\n').count() + 1;
        (line, before[line_start..].chars().count() + 1)
    }

    /// The text at a place, on one line, shortened where it is long.
    pub fn quote(&self, span: &Range<usize>) -> String {
        let written = self.text.get(span.clone()).unwrap_or_default();
        let flat = written.split_whitespace().collect::<Vec<_>>().join(" ");
        if flat.chars().count() <= LONGEST_QUOTE {
            return flat;
        }
        let head: String = flat.chars().take(LONGEST_QUOTE).collect();
        format!("{head}...")
    }

    /// A finding at a place of the text.
    pub fn diagnostic(&self, severity: Severity, at: usize, remark: Remark) -> Diagnostic {
        let (line, column) = self.position(at);
        let Remark { problem, path, found, allowed, hint } = remark;
        Diagnostic { severity, problem, file: self.name.clone(), line, column, path, found, allowed, hint }
    }
}

impl Remark {
    pub fn new(problem: Problem, path: &str, allowed: impl Into<String>) -> Self {
        Self { problem, path: path.to_owned(), found: None, allowed: allowed.into(), hint: None }
    }

    pub fn found(mut self, found: impl Into<String>) -> Self {
        self.found = Some(found.into());
        self
    }

    pub fn hint(mut self, hint: Option<String>) -> Self {
        self.hint = hint;
        self
    }
}
