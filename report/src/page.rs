//! The parts of a report.

use counterpoise_pipeline::ProjectIdentity;
use counterpoise_plot::Figure;

/// A whole report.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Subject of the report, for example the machine's name.
    pub title: String,
    /// One line under the title.
    pub subtitle: String,
    /// The answer, before anything else.
    pub headline: Headline,
    /// The few numbers that a reader wants first.
    pub tiles: Vec<FigureTile>,
    /// Tables of the first screen: the verdicts.
    pub verdicts: ReportTable,
    /// Figures of the first screen, beside the verdicts.
    pub glance: Vec<Figure>,
    /// The evidence.
    pub sections: Vec<ReportSection>,
    /// Origin of the report: version, project, command.
    pub provenance: Vec<ProvenanceEntry>,
}

/// One thing that a report says about where it comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProvenanceEntry {
    /// The text.
    pub name: String,
    /// Value.
    pub value: String,
}

impl ProvenanceEntry {
    /// Returns an entry.
    pub fn new(name: &str, value: impl Into<String>) -> Self {
        Self { name: name.to_owned(), value: value.into() }
    }
}

/// Origin of a report: the command and the project.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReportOrigin {
    /// Path of the project file; empty for none.
    pub project: String,
    /// The command line that makes the report again.
    pub command: String,
}

/// The answer in one line.
#[derive(Debug, Clone, PartialEq)]
pub struct Headline {
    /// Good, bad, or neither.
    pub tone: OutcomeTone,
    /// For example "All 12 requirements hold".
    pub text: String,
    /// A qualification that belongs to the same sentence; may be empty.
    pub detail: String,
}

/// A number with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureTile {
    /// Label.
    pub label: String,
    /// Value, already formatted.
    pub value: String,
    /// Unit; may be empty.
    pub unit: String,
    /// A remark under it, for example its limit; may be empty.
    pub note: String,
    /// Good, bad, or neither.
    pub tone: OutcomeTone,
}

/// Tone of an outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutcomeTone {
    /// The requirement holds.
    Good,
    /// The requirement fails.
    Bad,
    /// The requirement could not be assessed, or there is nothing to judge.
    Neutral,
}

/// A part of the evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportSection {
    /// Heading.
    pub heading: String,
    /// Paragraphs of plain text.
    pub text: Vec<String>,
    /// Figures, in order.
    pub figures: Vec<Figure>,
    /// Tables, in order.
    pub tables: Vec<ReportTable>,
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportTable {
    /// Conclusion; may be empty.
    pub caption: String,
    /// Columns.
    pub columns: Vec<ReportColumn>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<ReportCell>>,
}

/// A column of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReportColumn {
    /// Text, to the left.
    Text(&'static str),
    /// Numbers, to the right.
    Number(&'static str),
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum ReportCell {
    /// Words or an already formatted number.
    Text(String),
    /// A verdict in words with its sign and colour.
    Verdict(OutcomeTone, String),
    /// A bar from 0 to 1 with its text: how much room there is.
    Room(OutcomeTone, f64, String),
}

impl ReportOrigin {
    /// Returns version, project file, project hash and command as pairs of name and value.
    pub fn provenance(&self, identity: &ProjectIdentity) -> Vec<ProvenanceEntry> {
        let mut all = vec![ProvenanceEntry::new("version", env!("CARGO_PKG_VERSION"))];
        all.extend((!self.project.is_empty()).then(|| ProvenanceEntry::new("project", &self.project)));
        all.extend([
            ProvenanceEntry::new("project hash", &identity.hash),
            ProvenanceEntry::new("command", &self.command),
        ]);
        all
    }
}

impl Report {
    /// Returns the same report, with the command that produces it again under every figure of the evidence that has none.
    pub fn with_command(mut self, command: &str) -> Self {
        let figures = self.sections.iter_mut().flat_map(|section| &mut section.figures);
        let bare = figures.filter(|figure| figure.command.is_empty());
        bare.for_each(|figure| command.clone_into(&mut figure.command));
        self
    }
}

impl FigureTile {
    /// Returns a number that is neither good nor bad, without a remark.
    pub fn plain(label: &str, value: String, unit: &str) -> Self {
        let (label, unit) = (label.to_owned(), unit.to_owned());
        Self { label, value, unit, note: String::new(), tone: OutcomeTone::Neutral }
    }

    /// Returns the tile with a remark under it.
    pub fn with_note(mut self, note: &str) -> Self {
        note.clone_into(&mut self.note);
        self
    }
}

impl ReportCell {
    /// Returns a cell of text.
    pub fn text(text: impl Into<String>) -> Self {
        ReportCell::Text(text.into())
    }

    /// Returns a number with four significant digits.
    pub fn number(value: f64) -> Self {
        ReportCell::Text(counterpoise_plot::number::short_number(value))
    }
}

impl ReportSection {
    /// Returns a section without content.
    pub fn new(heading: &str) -> Self {
        Self { heading: heading.to_owned(), text: Vec::new(), figures: Vec::new(), tables: Vec::new() }
    }

    /// Returns the same section with one more paragraph.
    pub fn with_text(mut self, text: impl Into<String>) -> Self {
        self.text.push(text.into());
        self
    }

    /// Returns the same section with more figures.
    pub fn with_figures(mut self, figures: impl IntoIterator<Item = Figure>) -> Self {
        self.figures.extend(figures);
        self
    }

    /// Returns the same section with one more table.
    pub fn with_table(mut self, table: ReportTable) -> Self {
        self.tables.push(table);
        self
    }
}

impl ReportTable {
    /// Returns a table without rows.
    pub fn new(caption: &str, columns: &[ReportColumn]) -> Self {
        Self { caption: caption.to_owned(), columns: columns.to_vec(), rows: Vec::new() }
    }
}
