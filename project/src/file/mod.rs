//! The project file as written: text, positions, comments; and how it is changed without disturbing the rest.

mod attachments;
mod edit;
pub(crate) mod field;
pub(crate) mod guide;
pub(crate) mod lister;
mod parts;
pub(crate) mod reader;
pub(crate) mod setter;
pub(crate) mod setting;
pub(crate) mod source;
pub(crate) mod tree;
pub(crate) mod visit;
pub(crate) mod writer;

pub use attachments::Attachments;
pub use edit::EditError;
pub use setting::SettingValue;
pub use visit::NamedChoice;

use crate::diagnostic::{Diagnostic, DiagnosticKind, Severity};
use attachments::LARGEST_TEXT;
use source::{Remark, Source};
use tree::{Entry, Lookup, Node, Start, Value};

/// The format of project files that this version writes; it reads this one and all before it.
///
/// Format 2 adds quantities with units, values with tolerances, and parts.
pub const FORMAT: u32 = 2;

/// Keys that name a file which resolving the project needs; some may hold the table itself instead.
const NAMING_FILES: [&str; 12] = [
    "plant.amplifier.map",
    "plant.import.mass_matrix",
    "plant.import.stiffness_matrix",
    "plant.import.row_names",
    "plant.import.damping_matrix",
    "plant.import.node_map",
    "verify.road.heave_psd",
    "verify.road.pitch_psd",
    "verify.road.sines",
    "recording_controller.file",
    "synth.controller.file",
    "traverse.file",
];

/// A project file as written.
#[derive(Debug, Clone)]
pub struct Document {
    pub(crate) source: Source,
    /// The tree, with its parts in their places as far as they were given.
    pub(crate) entries: Vec<Entry>,
    pub(crate) syntax: Vec<Diagnostic>,
    /// Errors of the parts.
    pub(crate) inclusion: Vec<Diagnostic>,
    /// Names of the parts.
    included: Vec<String>,
    /// The files that were given for the parts.
    given: Attachments,
    /// `true` if the file's own text includes parts.
    includes: bool,
}

impl Document {
    /// Reads a text. Mistakes in its syntax are kept and come out when it is resolved.
    pub fn parse(text: &str, name: &str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source::new(name, text);
        let (entries, errors) = tree::parse(text, Start(0));
        let finding = |e: &tree::SyntaxError| {
            let remark = Remark::new(DiagnosticKind::Syntax, "", e.message.clone())
                .hint(syntax_hint(text, e.span.start));
            source.diagnostic(Severity::Error, e.span.start, remark)
        };
        let syntax = errors.iter().map(finding).collect();
        let includes = parts::has_parts(&entries);
        let (inclusion, included, given) = (Vec::new(), Vec::new(), Attachments::none());
        let written = Self { source, entries, syntax, inclusion, included, given, includes };
        if includes { written.with_parts(&Attachments::none()) } else { written }
    }

    /// Reads bytes, which must be UTF-8.
    ///
    /// # Errors
    /// The place of the first byte that is not text.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self, Vec<Diagnostic>> {
        if bytes.len() > LARGEST_TEXT {
            let (size, most) = (bytes.len() >> 20, LARGEST_TEXT >> 20);
            let allowed = format!("the file has {size} MB, but a project file has at most {most} MB");
            return Err(vec![Source::new(name, "").diagnostic(
                Severity::Error,
                0,
                Remark::new(DiagnosticKind::Syntax, "", allowed),
            )]);
        }
        std::str::from_utf8(bytes).map(|text| Self::parse(text, name)).map_err(|error| {
            let good = error.valid_up_to();
            let source = Source::new(name, &String::from_utf8_lossy(&bytes[..good]));
            let byte = bytes.get(good).copied().unwrap_or_default();
            let allowed = format!("byte 0x{byte:02x} is not UTF-8 text");
            let remark = Remark::new(DiagnosticKind::Syntax, "", allowed)
                .hint(Some("save the file as UTF-8".to_owned()));
            vec![source.diagnostic(Severity::Error, good, remark)]
        })
    }

    /// Returns the same file with the parts that it includes put in their places, as far as they are among the given files.
    #[must_use]
    pub fn with_parts(&self, given: &Attachments) -> Self {
        if !self.includes {
            return Self { given: given.clone(), ..self.clone() };
        }
        let (entries, _) = tree::parse(self.text(), Start(0));
        let assembled = parts::assemble(&Source::new(self.name(), self.text()), &entries, given);
        Self {
            source: assembled.source,
            entries: assembled.entries,
            syntax: self.syntax.clone(),
            inclusion: assembled.findings,
            included: assembled.wanted,
            given: given.clone(),
            includes: true,
        }
    }

    /// Returns the text as it stands, without its parts.
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// Returns the name under which findings are reported.
    pub fn name(&self) -> &str {
        self.source.name()
    }

    /// Returns names of the parts that the file includes, as far as they are known: those of a part only once it
    /// was given.
    pub fn parts(&self) -> &[String] {
        &self.included
    }

    /// Returns names of the files that the project file refers to and that resolving it needs, its parts among them. The
    /// files that a part names are known once the part was given to [`Document::with_parts`].
    pub fn attachments(&self) -> Vec<String> {
        let mut names: Vec<String> = NAMING_FILES.iter().filter_map(|path| self.text_at(path)).collect();
        names.retain(|name| !name.is_empty());
        names.extend(self.included.iter().cloned());
        names.sort();
        names.dedup();
        names
    }

    /// Returns a finding with the line of the file that it speaks of, and a mark under its column.
    pub fn excerpt(&self, finding: &Diagnostic) -> String {
        self.source.line(finding).map_or_else(|| finding.to_string(), |line| finding.with_line(line))
    }

    /// Returns the text at a path of keys, where one stands there.
    pub(crate) fn text_at(&self, path: &str) -> Option<String> {
        match self.node_at(path).map(|node| &node.value) {
            Some(Value::Text(text)) => Some(text.clone()),
            _ => None,
        }
    }

    /// Returns what stands at a path as it is written, without the quotes of a text; `None` if nothing is there.
    pub fn source_text_at(&self, path: &str) -> Option<String> {
        let node = self.node_at(path)?;
        match &node.value {
            Value::Text(text) => Some(text.clone()),
            _ => Some(self.source.quote(&node.span)),
        }
    }

    /// Returns whether a text, quoted, stands at a path.
    pub fn is_text(&self, path: &str) -> bool {
        self.text_at(path).is_some()
    }

    /// Returns the node at a path, if it is there.
    pub(crate) fn node_at(&self, path: &str) -> Option<&Node> {
        let (node, found) = tree::find(&self.entries, path);
        node.filter(|_| found == Lookup::Exact)
    }

    /// Returns the same file with the value at a path replaced as it is given, whatever unit stood there
    /// before.
    ///
    /// # Errors
    /// As for [`Document::set`].
    pub fn replace(&self, path: &str, setting: &SettingValue) -> Result<Self, EditError> {
        self.refuse_part(path)?;
        edit::set(self.text(), path, setting).map(|text| self.with_text(&text))
    }

    /// Returns the same file without a key.
    ///
    /// # Errors
    /// The text is not TOML, the path leads nowhere, or the key stands in a part.
    pub fn remove(&self, path: &str) -> Result<Self, EditError> {
        self.refuse_part(path)?;
        edit::remove(self.text(), path).map(|text| self.with_text(&text))
    }

    /// Returns the file with another text and the same parts.
    #[must_use]
    pub fn with_text(&self, text: &str) -> Self {
        Self::parse(text, self.name()).with_parts(&self.given)
    }

    /// Refuses to change what stands in a part, which other projects may share.
    pub(crate) fn refuse_part(&self, path: &str) -> Result<(), EditError> {
        let (node, found) = tree::find(&self.entries, path);
        let inside_of_list = path.contains('[');
        let Some(node) = node.filter(|_| found == Lookup::Exact || inside_of_list) else { return Ok(()) };
        match self.source.part_at(node.span.start) {
            None => Ok(()),
            Some(part) => Err(EditError::InPart { path: path.to_owned(), part: part.to_owned() }),
        }
    }

    /// Returns the byte at which the value at a path stands, or the nearest thing around it that is there.
    pub(crate) fn locate(&self, path: &str) -> usize {
        tree::find(&self.entries, path).0.map_or(0, |node| node.span.start)
    }

    /// Returns whether something stands at a path of keys.
    pub(crate) fn has(&self, path: &str) -> bool {
        self.node_at(path).is_some()
    }

    /// Returns a finding at the place of its path.
    pub(crate) fn finding(&self, severity: Severity, remark: Remark) -> Diagnostic {
        let at = self.locate(&remark.path);
        self.source.diagnostic(severity, at, remark)
    }

    /// Returns the format that the file states; `None` if it states none, or none that is a whole number.
    pub fn format(&self) -> Option<u32> {
        match self.node_at("format")?.value {
            Value::Whole(format) => u32::try_from(format).ok(),
            _ => None,
        }
    }

    /// Returns the same file in the present format, with its comments. The values of older formats mean the same in this one.
    ///
    /// # Errors
    /// The text is not TOML.
    pub fn migrate(&self) -> Result<Self, EditError> {
        let set = edit::set_first(self.text(), "format", &SettingValue::Whole(i64::from(FORMAT)))?;
        Ok(self.with_text(&set))
    }
}

/// Returns why a file of a newer format is not read; `None` if it is of this format or an older one.
pub(crate) fn format_is_newer(node: &Node) -> Option<String> {
    match node.value {
        Value::Whole(format) if format > i64::from(FORMAT) => Some(format!(
            "the file is of format {format}, but this version of Counterpoise reads formats up to {FORMAT}: use a newer version"
        )),
        _ => None,
    }
}

/// Returns what to do about a mistake in the syntax, where it is a usual one.
fn syntax_hint(text: &str, at: usize) -> Option<String> {
    let (before, after) = (text.get(..at)?, text.get(at..)?);
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let comma = after.starts_with(',') && digit(before.chars().next_back()) && digit(after.chars().nth(1));
    comma.then(|| "numbers are written with a decimal point, as in 9.8".to_owned())
}
