//! What is wrong with a file, where, what was read, what is allowed, and a hint: plain data, many at once.

use std::fmt;

use serde::Serialize;

/// How bad a finding is.
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
pub enum Problem {
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
    /// How bad it is.
    pub severity: Severity,
    /// Its kind.
    pub problem: Problem,
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Path of the key, as in `plant.beam.section[0].from` (items count from 0); empty for the file as a whole.
    pub path: String,
    /// What was read, where it says something.
    pub found: Option<String>,
    /// What is allowed, or what is wrong.
    pub allowed: String,
    /// What to do.
    pub hint: Option<String>,
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
        write!(f, "{}:{}:{}: {}: ", self.file, self.line, self.column, self.severity)?;
        if !self.path.is_empty() {
            write!(f, "{}", self.path)?;
            if let Some(found) = &self.found {
                write!(f, " = {found}")?;
            }
            f.write_str(": ")?;
        }
        f.write_str(&self.allowed)?;
        match &self.hint {
            Some(hint) => write!(f, " ({hint})"),
            None => Ok(()),
        }
    }
}

impl Diagnostic {
    /// The finding with the line of the file that it speaks of, and a mark under its column.
    pub fn excerpt(&self, text: &str) -> String {
        let Some(line) = text.lines().nth(self.line.saturating_sub(1)) else { return self.to_string() };
        let number = self.line.to_string();
        let margin = " ".repeat(number.len());
        let shown = line.replace('\t', " ");
        let mark = " ".repeat(self.column.saturating_sub(1));
        format!("{self}\n{margin} |\n{number} | {shown}\n{margin} | {mark}^")
    }
}

/// The name in `known` that is nearest to `written`, if any is near enough to be meant.
pub(crate) fn nearest<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let distance = |name: &str| strsim::damerau_levenshtein(&written.to_lowercase(), name);
    let extends = |name: &str| {
        name.len() >= 3 && written.len() >= 3 && (written.starts_with(name) || name.starts_with(written))
    };
    let length = written.chars().count();
    let close = |distance: usize| distance <= (length / 3).max(1) && 2 * distance <= length;
    let near = |name: &&str| close(distance(name)) || extends(name);
    known.into_iter().filter(near).min_by_key(|name| distance(name))
}

/// A hint that names the nearest of the known names.
pub(crate) fn did_you_mean<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(written, known).map(|name| format!("did you mean \"{name}\"?"))
}
