//! The texts of a project, their names, and where their bytes stand in lines and columns.
//!
//! The parts that a project file includes follow its own text in one count of bytes, so that a single number tells the file and
//! the place in it.

use std::ops::Range;

use crate::diagnostic::{Diagnostic, DiagnosticKind, Severity, escape_control};

/// A text with its name, and the parts that it includes.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    own: Text,
    parts: Vec<Text>,
}

/// One text.
#[derive(Debug, Clone)]
struct Text {
    name: String,
    text: String,
    /// Byte at which the text begins in the count of all texts.
    start: usize,
    /// Bytes of this text at which its lines begin.
    lines: Vec<usize>,
}

/// A message about a place of the text.
pub(crate) struct Remark {
    pub problem: DiagnosticKind,
    pub path: String,
    pub found: Option<String>,
    pub allowed: String,
    pub hint: Option<String>,
}

/// Longest piece of the text that a finding quotes, in characters.
const LONGEST_QUOTE: usize = 48;
/// Largest column that is counted out, in bytes: beyond it, the byte is given.
const LARGEST_COLUMN: usize = 10_000;

impl Text {
    fn new(name: &str, text: &str, start: usize) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at + 1);
        let lines = std::iter::once(0).chain(breaks).collect();
        Self { name: name.to_owned(), text: text.to_owned(), start, lines }
    }

    /// Returns line and column (in characters), both from 1, of a byte of this text.
    fn position(&self, byte: usize) -> (usize, usize) {
        let byte = byte.min(self.text.len());
        let line = self.lines.partition_point(|start| *start <= byte);
        let start = self.lines.get(line.saturating_sub(1)).copied().unwrap_or(0);
        let before = self.text.get(start..byte).unwrap_or_default();
        let column = if before.len() > LARGEST_COLUMN { before.len() } else { before.chars().count() };
        (line.max(1), column + 1)
    }
}

impl Source {
    /// Returns a text without parts.
    pub fn new(name: &str, text: &str) -> Self {
        Self { own: Text::new(name, text, 0), parts: Vec::new() }
    }

    /// Returns the project file's own text.
    pub fn text(&self) -> &str {
        &self.own.text
    }

    /// Returns the project file's name.
    pub fn name(&self) -> &str {
        &self.own.name
    }

    /// Adds a part and returns the byte at which it begins in the count of all texts.
    pub fn add_part(&mut self, name: &str, text: &str) -> usize {
        let last = self.parts.last().unwrap_or(&self.own);
        // One byte lies between two texts, so that the end of one is not the beginning of the next.
        let start = last.start + last.text.len() + 1;
        self.parts.push(Text::new(name, text, start));
        start
    }

    /// Returns the text in which a byte lies.
    fn at(&self, byte: usize) -> &Text {
        let after = self.parts.partition_point(|part| part.start <= byte);
        after.checked_sub(1).and_then(|index| self.parts.get(index)).unwrap_or(&self.own)
    }

    /// Returns the name of the part in which a byte lies; `None` for the project file itself.
    pub fn part_at(&self, byte: usize) -> Option<&str> {
        let text = self.at(byte);
        (text.start > 0).then_some(text.name.as_str())
    }

    /// Returns the line of a finding.
    pub fn line(&self, finding: &Diagnostic) -> Option<&str> {
        let mut texts = std::iter::once(&self.own).chain(&self.parts);
        let text = texts.find(|text| text.name == finding.file)?;
        let start = *text.lines.get(finding.line.checked_sub(1)?)?;
        text.text.get(start..)?.lines().next()
    }

    /// Returns the text at a place, on one line, shortened where it is long.
    pub fn quote(&self, span: &Range<usize>) -> String {
        let text = self.at(span.start);
        let within = span.start.saturating_sub(text.start)..span.end.saturating_sub(text.start);
        let written = text.text.get(within).unwrap_or_default();
        // Four bytes a character at most: a long value is cut before its words are joined.
        let mut end = written.len().min(8 * LONGEST_QUOTE);
        while !written.is_char_boundary(end) {
            end -= 1;
        }
        let flat = written[..end].split_whitespace().collect::<Vec<_>>().join(" ");
        if flat.chars().count() <= LONGEST_QUOTE && end == written.len() {
            return escape_control(&flat);
        }
        let head: String = flat.chars().take(LONGEST_QUOTE).collect();
        escape_control(&format!("{head}..."))
    }

    /// Returns a finding at a place of the text.
    pub fn diagnostic(&self, severity: Severity, at: usize, remark: Remark) -> Diagnostic {
        let text = self.at(at);
        let (line, column) = text.position(at.saturating_sub(text.start));
        let Remark { problem, path, found, allowed, hint } = remark;
        Diagnostic { severity, problem, file: text.name.clone(), line, column, path, found, allowed, hint }
    }
}

impl Remark {
    pub fn new(problem: DiagnosticKind, path: &str, allowed: impl Into<String>) -> Self {
        Self { problem, path: path.to_owned(), found: None, allowed: allowed.into(), hint: None }
    }

    pub fn with_value(mut self, found: impl Into<String>) -> Self {
        self.found = Some(found.into());
        self
    }

    pub fn hint(mut self, hint: Option<String>) -> Self {
        self.hint = hint;
        self
    }
}
