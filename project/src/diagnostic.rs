//! Findings about a file: what is wrong and where, what was read, what is allowed, and a hint; plain data, many at once.

use std::fmt;

use serde::Serialize;

/// Severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The file cannot be used.
    Error,
    /// The file can be used; what was found is likely to be a mistake.
    Warning,
}

/// The kind of a finding, for machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DiagnosticKind {
    /// The text is not TOML, or not text.
    Syntax,
    /// The file is of a format that this version does not read.
    Format,
    /// A key or section that does not exist.
    UnknownKey,
    /// A key or section that must be there and is not.
    Missing,
    /// A value of another type.
    WrongType,
    /// A number that is not finite.
    NotFinite,
    /// A value outside its range or its list of choices.
    OutOfRange,
    /// Two items of the same name.
    Duplicate,
    /// A name that nothing bears.
    UnknownName,
    /// Values that do not fit each other.
    Conflict,
}

/// One finding in a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Severity.
    pub severity: Severity,
    /// Kind.
    pub problem: DiagnosticKind,
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Path of the key, as in `plant.beam.section[0].from` (items count from 0); empty for the file as a whole.
    pub path: String,
    /// The text that was read, if it says something.
    pub found: Option<String>,
    /// Allowed values, or a description of the error.
    pub allowed: String,
    /// The remedy.
    pub hint: Option<String>,
}

impl DiagnosticKind {
    /// Returns the rank of a kind of finding: what must be put right first has the lowest. Wrong values come before keys that are not
    /// known, and these before what is missing, because a mistyped key is both; values that do not fit each other come last, because they often follow.
    fn rank(self) -> u8 {
        match self {
            Self::Syntax | Self::Format => 0,
            Self::WrongType | Self::NotFinite | Self::OutOfRange | Self::Duplicate | Self::UnknownName => 1,
            Self::UnknownKey => 2,
            Self::Missing => 3,
            Self::Conflict => 4,
        }
    }
}

/// Sorts findings by importance, then by place.
pub(crate) fn sort(findings: &mut [Diagnostic]) {
    let is_section = |finding: &Diagnostic| finding.allowed.starts_with("section");
    // A section that is missing hides among no wrong values: without it nothing is done.
    let rank = |finding: &Diagnostic| match finding.problem {
        DiagnosticKind::Missing if is_section(finding) => DiagnosticKind::WrongType.rank(),
        problem => problem.rank(),
    };
    findings.sort_by_cached_key(|d| (rank(d), u8::from(!is_section(d)), d.file.clone(), d.line, d.column));
}

/// Most findings that are shown at once.
pub const MOST_SHOWN: usize = 10;

/// Returns the first findings, each as `shown` words it, with a line that says how many more there are.
pub fn first_findings(findings: &[Diagnostic], shown: impl Fn(&Diagnostic) -> String) -> Vec<String> {
    let mut lines: Vec<String> = findings.iter().take(MOST_SHOWN).map(shown).collect();
    if let Some(more) = findings.len().checked_sub(MOST_SHOWN).filter(|more| *more > 0) {
        lines.push(format!("and {more} more"));
    }
    lines
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
        })
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: {}: ", escape_control(&self.file), self.line, self.column, self.severity)?;
        if !self.path.is_empty() {
            f.write_str(&escape_control(&self.path))?;
            if let Some(found) = &self.found {
                write!(f, " = {}", escape_control(found))?;
            }
            f.write_str(": ")?;
        }
        f.write_str(&escape_control(&self.allowed))?;
        match &self.hint {
            Some(hint) => write!(f, " ({})", escape_control(hint)),
            None => Ok(()),
        }
    }
}

/// Longest piece of a line that an excerpt shows, in characters.
const LONGEST_EXCERPT: usize = 120;

impl Diagnostic {
    /// Returns the finding with the line of the file that it speaks of, and a mark under its column.
    pub fn excerpt(&self, text: &str) -> String {
        let line = text.lines().nth(self.line.saturating_sub(1));
        line.map_or_else(|| self.to_string(), |line| self.with_line(line))
    }

    /// Returns the finding with its line, and a mark under its column.
    pub fn with_line(&self, line: &str) -> String {
        let number = self.line.to_string();
        let margin = " ".repeat(number.len());
        let column = self.column.saturating_sub(1);
        // Of a long line only what is around the column is shown.
        let skipped = if column < LONGEST_EXCERPT { 0 } else { column - LONGEST_EXCERPT / 2 };
        let shown: String = line.chars().skip(skipped).take(LONGEST_EXCERPT).map(visible_character).collect();
        let mark = " ".repeat(column - skipped);
        format!("{self}\n{margin} |\n{number} | {shown}\n{margin} | {mark}^")
    }
}

/// Returns a character as a line of one column for each shows it: a tab as a space, other control characters as a replacement.
fn visible_character(c: char) -> char {
    match c {
        '\t' => ' ',
        c if is_control(c) => char::REPLACEMENT_CHARACTER,
        c => c,
    }
}

/// Returns whether a character moves the cursor of a terminal, changes its colours, or turns the direction of
/// writing.
pub(crate) fn is_control(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Returns a text of a file as a terminal may show it: control characters as escapes.
pub fn escape_control(text: &str) -> String {
    if !text.chars().any(is_control) {
        return text.to_owned();
    }
    let escaped = |c: char| if is_control(c) { c.escape_unicode().to_string() } else { c.to_string() };
    text.chars().map(escaped).collect()
}

/// Longest name for which a similar one is looked for, in bytes.
const LONGEST_MISSPELT: usize = 64;

/// Returns the name in `known` that is nearest to `written`, if any is near enough to be meant.
pub(crate) fn nearest_name<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if written.len() > LONGEST_MISSPELT {
        return None;
    }
    let distance = |name: &str| strsim::damerau_levenshtein(&written.to_lowercase(), &name.to_lowercase());
    let extends = |name: &str| {
        name.len() >= 3 && written.len() >= 3 && (written.starts_with(name) || name.starts_with(written))
    };
    let length = written.chars().count();
    let close = |distance: usize| distance <= (length / 3).max(1) && 2 * distance <= length;
    let near = |name: &&str| close(distance(name)) || extends(name);
    known.into_iter().filter(near).min_by_key(|name| distance(name))
}

/// Returns a hint that names the nearest of the known names.
pub(crate) fn did_you_mean<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest_name(written, known).map(|name| format!("did you mean \"{name}\"?"))
}
