//! The project file as written: text, positions, comments; and how it is changed without disturbing the rest.

mod attachments;
mod edit;
pub(crate) mod field;
pub(crate) mod guide;
pub(crate) mod lister;
pub(crate) mod reader;
mod setting;
pub(crate) mod source;
pub(crate) mod tree;
pub(crate) mod visit;
pub(crate) mod writer;

pub use attachments::Attachments;
pub use edit::EditError;
pub use setting::Setting;
pub use visit::Choice;

use crate::diagnostic::{Diagnostic, Problem, Severity};
use source::{Remark, Source};
use tree::{Entry, Value};

/// Keys that name a file which resolving the project needs; some may hold the table itself instead.
const NAMING_FILES: [&str; 8] = [
    "plant.amplifier.map",
    "plant.import.mass_matrix",
    "plant.import.stiffness_matrix",
    "plant.import.damping_matrix",
    "plant.import.node_map",
    "verify.road.heave_psd",
    "verify.road.pitch_psd",
    "verify.road.sines",
];

/// A project file as written.
#[derive(Debug, Clone)]
pub struct Document {
    pub(crate) source: Source,
    pub(crate) entries: Vec<Entry>,
    pub(crate) syntax: Vec<Diagnostic>,
}

impl Document {
    /// Reads a text. Mistakes in its syntax are kept and come out when it is resolved.
    pub fn parse(text: &str, name: &str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source { name: name.to_owned(), text: text.to_owned() };
        let (entries, errors) = tree::parse(text);
        let finding = |e: &tree::SyntaxError| {
            let remark =
                Remark::new(Problem::Syntax, "", e.message.clone()).hint(syntax_hint(text, e.span.start));
            source.diagnostic(Severity::Error, e.span.start, remark)
        };
        let syntax = errors.iter().map(finding).collect();
        Self { source, entries, syntax }
    }

    /// Reads bytes, which must be UTF-8.
    ///
    /// # Errors
    /// The place of the first byte that is not text.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self, Vec<Diagnostic>> {
        std::str::from_utf8(bytes).map(|text| Self::parse(text, name)).map_err(|error| {
            let good = error.valid_up_to();
            let text = String::from_utf8_lossy(&bytes[..good]).into_owned();
            let source = Source { name: name.to_owned(), text };
            let byte = bytes.get(good).copied().unwrap_or_default();
            let allowed = format!("byte 0x{byte:02x} is not UTF-8 text");
            let remark =
                Remark::new(Problem::Syntax, "", allowed).hint(Some("save the file as UTF-8".to_owned()));
            vec![source.diagnostic(Severity::Error, good, remark)]
        })
    }

    /// The text as it stands.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// The name under which findings are reported.
    pub fn name(&self) -> &str {
        &self.source.name
    }

    /// Names of the files that the project file refers to and that resolving it needs.
    pub fn attachments(&self) -> Vec<String> {
        let mut names: Vec<String> = NAMING_FILES.iter().filter_map(|path| self.text_at(path)).collect();
        names.retain(|name| !name.is_empty());
        names.sort();
        names.dedup();
        names
    }

    /// The text at a path of keys, where one stands there.
    fn text_at(&self, path: &str) -> Option<String> {
        let mut entries = self.entries.as_slice();
        let mut found = None;
        for key in path.split('.') {
            let entry = entries.iter().find(|e| e.key == key)?;
            entries = if let Value::Table(inside) = &entry.node.value { inside } else { &[] };
            found = Some(&entry.node.value);
        }
        if let Some(Value::Text(text)) = found { Some(text.clone()) } else { None }
    }

    /// The same file with one value set; comments, order and spaces stay. Sections on the way are made.
    /// A path names keys and items of lists (from 0), as in `plant.beam.section[1].to`.
    ///
    /// # Errors
    /// The text is not TOML, the path leads nowhere, or the value cannot be written.
    pub fn set(&self, path: &str, setting: &Setting) -> Result<Self, EditError> {
        edit::set(self.text(), path, setting).map(|text| Self::parse(&text, self.name()))
    }

    /// The same file without a key.
    ///
    /// # Errors
    /// The text is not TOML, or the path leads nowhere.
    pub fn remove(&self, path: &str) -> Result<Self, EditError> {
        edit::remove(self.text(), path).map(|text| Self::parse(&text, self.name()))
    }

    /// The byte at which the value at a path stands, or the nearest thing around it that is there.
    pub(crate) fn locate(&self, path: &str) -> usize {
        let (mut entries, mut at) = (self.entries.as_slice(), 0);
        for part in path.split('.') {
            let (key, index) = part
                .split_once('[')
                .map_or((part, None), |(k, i)| (k, i.trim_end_matches(']').parse::<usize>().ok()));
            let Some(entry) = entries.iter().find(|e| e.key == key) else { return at };
            let node = match (&entry.node.value, index) {
                (Value::List(items), Some(index)) => items.get(index).unwrap_or(&entry.node),
                _ => &entry.node,
            };
            at = node.span.start;
            entries = if let Value::Table(inside) = &node.value { inside } else { &[] };
        }
        at
    }

    /// Whether something stands at a path of keys.
    pub(crate) fn has(&self, path: &str) -> bool {
        let mut entries = self.entries.as_slice();
        path.split('.').all(|key| {
            let Some(entry) = entries.iter().find(|e| e.key == key) else { return false };
            entries = if let Value::Table(inside) = &entry.node.value { inside } else { &[] };
            true
        })
    }

    /// A finding at the place of its path.
    pub(crate) fn finding(&self, severity: Severity, remark: Remark) -> Diagnostic {
        let at = self.locate(&remark.path);
        self.source.diagnostic(severity, at, remark)
    }
}

/// What to do about a mistake in the syntax, where it is a usual one.
fn syntax_hint(text: &str, at: usize) -> Option<String> {
    let (before, after) = (text.get(..at)?, text.get(at..)?);
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let comma = after.starts_with(',') && digit(before.chars().next_back()) && digit(after.chars().nth(1));
    comma.then(|| "numbers are written with a decimal point, as in 9.8".to_owned())
}
