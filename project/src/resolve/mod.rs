//! The project file resolved: every value present, in SI units, checked against its range and its neighbours.

pub mod around;
mod changes;
mod checks;
mod controller;
pub mod design;
mod friction;
pub mod import;
pub mod measured;
pub mod model;
mod plant;
pub mod platform;
mod recording;
mod structure;
pub mod sweep;
pub mod verify;
mod weight;

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::Parameters;
use counterpoise_recordings::Mapping;

use crate::diagnostic::{Diagnostic, Problem, Severity};
use crate::file::field::{Field, Limit, TableField};
use crate::file::guide::{Guide, TURNS};
use crate::file::lister::{Line, Lister};
use crate::file::reader::Reader;
use crate::file::source::Remark;
use crate::file::visit::{Visit, optional, table};
use crate::file::{Attachments, Document, EditError, writer};
use design::{Export, Reduction, Synthesis};
use model::Modelling;
use sweep::Sweep;
use verify::Verification;

/// The format of project files that this version reads and writes.
pub const FORMAT: u32 = 1;

/// A project with every value resolved.
#[derive(Debug, Clone, PartialEq)]
pub struct Project {
    /// The mechanism.
    pub plant: Parameters,
    /// The structure as matrices from elsewhere, where there is one.
    pub import: Option<import::ImportedStructure>,
    /// Which description of the mechanism is taken, and where it stands.
    pub model: Modelling,
    /// How the plant is reduced before the design.
    pub reduce: Reduction,
    /// What is asked of the design.
    pub synth: Option<Synthesis>,
    /// What is done to the loop, and the limits of its figures.
    pub verify: Option<Verification>,
    /// How robustness is tried.
    pub sweep: Option<Sweep>,
    /// What code is generated.
    pub export: Export,
    /// The controller that was in the loop when recordings were made.
    pub recording_controller: Option<ProportionalIntegral>,
    /// How the columns of recordings become channels.
    pub recording: Mapping,
    /// Natural frequencies measured on the real structure.
    pub measured: Option<measured::MeasuredModes>,
}

/// A project and what is suspicious in its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Parsed {
    /// The project.
    pub project: Project,
    /// What is allowed but likely to be a mistake.
    pub warnings: Vec<Diagnostic>,
}

/// What a project file is read for: each command needs only its own sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Model and frequency responses of the plant.
    Model,
    /// Reduction of the plant.
    Reduce,
    /// Identification from recordings.
    Identify,
    /// Replay of recordings in closed loop.
    Replay,
    /// Diagnosis of recordings.
    Diagnose,
    /// The design of a controller, without judging it.
    Synth,
    /// The design of a controller and its verification.
    Verify,
    /// The whole road, to code.
    Design,
    /// Code alone.
    Export,
    /// A robustness campaign.
    Sweep,
}

impl Project {
    /// Reads a project file that refers to no other file.
    ///
    /// # Errors
    /// Every error of the file, in order of place.
    pub fn parse(text: &str, name: &str) -> Result<Parsed, Vec<Diagnostic>> {
        Self::resolve(&Document::parse(text, name), &Attachments::none())
    }

    /// Reads the bytes of a project file that refers to no other file.
    ///
    /// # Errors
    /// Every error of the file, in order of place.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Parsed, Vec<Diagnostic>> {
        Self::resolve(&Document::from_bytes(bytes, name)?, &Attachments::none())
    }

    /// Resolves a file as written, with the files that it refers to.
    ///
    /// # Errors
    /// Every error of the file, in order of place.
    pub fn resolve(document: &Document, attachments: &Attachments) -> Result<Parsed, Vec<Diagnostic>> {
        let mut project = Self::blank();
        let mut reader = Reader::new(&document.source, &document.entries, attachments);
        let format = file(&mut reader, &mut project);
        let mut findings = reader.finish();
        findings.extend(refused_format(document, format));
        findings.extend(checks::all(document, &project));
        if !document.syntax.is_empty() {
            findings.retain(|finding| stands_alone(document, finding));
            findings.extend(document.syntax.clone());
        }
        findings.sort_by_key(|d| (d.line, d.column));
        let (errors, warnings): (Vec<_>, Vec<_>) =
            findings.into_iter().partition(|d| d.severity == Severity::Error);
        if errors.is_empty() { Ok(Parsed { project, warnings }) } else { Err(errors) }
    }

    /// Resolves a file for a purpose: the sections that it needs must be there.
    ///
    /// # Errors
    /// Every error of the file, and every section that is missing.
    pub fn resolve_for(
        document: &Document,
        attachments: &Attachments,
        purpose: Purpose,
    ) -> Result<Parsed, Vec<Diagnostic>> {
        let parsed = Self::resolve(document, attachments)?;
        let missing = parsed.project.missing_for(document, purpose);
        if missing.is_empty() { Ok(parsed) } else { Err(missing) }
    }

    fn missing_for(&self, document: &Document, purpose: Purpose) -> Vec<Diagnostic> {
        let there = |section: &str| document.entries.iter().any(|e| e.key == section);
        let absent = purpose.sections().iter().filter(|section| !there(section));
        let remark = |section: &&str| {
            let allowed = format!("section [{section}] is missing; `{}` needs it", purpose.name());
            document.finding(Severity::Error, Remark::new(Problem::Missing, section, allowed))
        };
        absent.map(remark).collect()
    }

    /// The canonical text of the project: sections in fixed order, units in comments, usual values left out.
    pub fn to_text(&self) -> String {
        writer::canonical(&self.lines())
    }

    /// The file with every value that differs between two projects set, and everything else of it left as it is.
    ///
    /// # Errors
    /// The text is not TOML, or a value leads through something that is no table.
    pub fn update(&self, document: &Document, old: &Self) -> Result<Document, EditError> {
        changes::apply(document, &old.lines(), &self.lines())
    }

    /// The reference of all sections and keys, as Markdown, from the same walk that reads them.
    pub fn reference() -> String {
        let mut guide = Guide::default();
        for turn in 0..TURNS {
            guide.turn(turn);
            file(&mut guide, &mut Self::blank());
        }
        guide.text()
    }

    fn lines(&self) -> Vec<Line> {
        let mut lister = Lister::default();
        file(&mut lister, &mut self.clone());
        lister.lines
    }

    fn blank() -> Self {
        Self {
            plant: plant::blank(),
            import: None,
            model: Modelling::default(),
            reduce: Reduction::default(),
            synth: None,
            verify: None,
            sweep: None,
            export: Export::default(),
            recording_controller: None,
            recording: Mapping::default(),
            measured: None,
        }
    }
}

impl Purpose {
    /// The sections that must be there; the others have usual values.
    pub fn sections(self) -> &'static [&'static str] {
        match self {
            Self::Model | Self::Reduce | Self::Identify | Self::Diagnose => &["plant"],
            Self::Replay => &["plant", "recording_controller"],
            Self::Synth => &["plant", "synth"],
            Self::Verify | Self::Design | Self::Export | Self::Sweep => &["plant", "synth", "verify"],
        }
    }

    /// The command's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Reduce => "reduce",
            Self::Identify => "identify",
            Self::Replay => "replay",
            Self::Diagnose => "diagnose",
            Self::Synth => "synth",
            Self::Verify => "verify",
            Self::Design => "design",
            Self::Export => "export",
            Self::Sweep => "sweep",
        }
    }
}

/// Reads or lists the whole file; gives its format.
fn file(v: &mut dyn Visit, project: &mut Project) -> u32 {
    let mut format = FORMAT;
    v.whole(
        &Field::new("format", "format of this file").limit(Limit::AtLeast(0.0)).or(f64::from(FORMAT)).shown(),
        &mut format,
    );
    table(v, &TableField::required("plant", "the mechanism"), project, |v, project| {
        plant::plant(v, &mut project.plant);
        let section = TableField::optional("import", "the structure as matrices of a finite-element package");
        optional(v, &section, &mut project.import, import::blank(), import::import);
    });
    designs(v, project);
    recordings(v, project);
    format
}

/// Sections of which every key has a usual value are written only where they differ from it.
fn unless_usual<T: Default + PartialEq>(
    v: &mut dyn Visit,
    field: &TableField,
    value: &mut T,
    walk: fn(&mut dyn Visit, &mut T),
) {
    if v.enter(field, *value != T::default()) {
        walk(v, value);
        v.leave();
    }
}

fn designs(v: &mut dyn Visit, project: &mut Project) {
    unless_usual(v, &TableField::optional("model", "which plant is meant"), &mut project.model, model::model);
    unless_usual(
        v,
        &TableField::optional("reduce", "reduction before the design"),
        &mut project.reduce,
        design::reduce,
    );
    let section = TableField::optional("synth", "what is asked of the design");
    optional(v, &section, &mut project.synth, design::blank_synthesis(), design::synth);
    let section = TableField::optional("verify", "what is done to the loop, and its limits");
    optional(v, &section, &mut project.verify, verify::blank(), verify::verify);
    let section = TableField::optional("sweep", "how robustness is tried");
    optional(v, &section, &mut project.sweep, sweep::blank(), sweep::sweep);
    if let Some(verification) = &mut project.verify {
        verification.procedure.operating_point = project.model.operating_point;
        verification.procedure.friction = project.model.friction;
    }
    unless_usual(v, &TableField::optional("export", "generated code"), &mut project.export, design::export);
}

fn recordings(v: &mut dyn Visit, project: &mut Project) {
    let section =
        TableField::optional("recording_controller", "the controller in the loop when recordings were made");
    optional(
        v,
        &section,
        &mut project.recording_controller,
        controller::blank(),
        controller::recording_controller,
    );
    if let Some(controller) = &mut project.recording_controller {
        controller.sample_period_s = project.plant.interface.sample_period_s;
    }
    let section = TableField::optional("recording", "how the columns of recordings become channels");
    unless_usual(v, &section, &mut project.recording, recording::recording);
    let section = TableField::optional("measured", "natural frequencies measured on the real structure");
    optional(v, &section, &mut project.measured, measured::blank(), measured::measured);
}

/// Whether a finding holds even though the syntax is broken elsewhere.
fn stands_alone(document: &Document, finding: &Diagnostic) -> bool {
    let elsewhere = document.syntax.iter().all(|s| s.line != finding.line);
    elsewhere && matches!(finding.problem, Problem::OutOfRange | Problem::NotFinite)
}

fn refused_format(document: &Document, format: u32) -> Option<Diagnostic> {
    if format == FORMAT {
        return None;
    }
    let hint =
        if format > FORMAT { "use a newer version of Counterpoise" } else { "formats are counted from 1" };
    let remark = Remark::new(Problem::Format, "format", format!("this version reads format {FORMAT}"));
    Some(document.finding(Severity::Error, remark.found(format.to_string()).hint(Some(hint.to_owned()))))
}
