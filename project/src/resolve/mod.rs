//! The project file resolved: every value present, in SI units, checked against its range and its neighbours.

mod axis_words;
pub mod base_motion;
mod base_motion_checks;
mod beam_checks;
mod carrier;
mod cascade;
mod changes;
mod checks;
pub mod controller;
pub mod controller_file;
mod cylinder;
pub mod design;
mod digits;
mod drive;
mod effort_checks;
mod figure_names;
mod findings;
pub mod fixed_structure;
mod format;
mod free_functions;
mod friction;
pub mod front;
pub mod import;
pub mod imported_controller;
mod loads;
mod loop_sensor;
pub mod measured_modes;
pub mod model;
mod plant;
pub mod platform;
pub mod purpose;
mod recording;
mod section_hints;
mod seed;
mod sensor;
pub mod statements;
mod structure;
pub mod sweep;
pub mod synthesis;
pub mod synthesis_options;
mod transmission;
pub mod traverse;
mod users_unit;
pub mod verify;
mod weight;

use std::collections::{BTreeMap, BTreeSet};

use counterpoise_models::{AmplifierDynamics, Parameters};
use counterpoise_recordings::Mapping;

use crate::assumption::{Assumption, KeyTolerance};
use crate::diagnostic::{self, Diagnostic, DiagnosticKind, Severity};
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::guide::{Guide, WALKS};
use crate::file::lister::{Line, Lister};
use crate::file::reader::Reader;
use crate::file::setter::Setter;
use crate::file::visit::{Presence, Visit, table, visit_optional};
use crate::file::{Attachments, Document, EditError, FORMAT, writer};
use controller::RecordingController;
use design::{ExportRequest, ReductionOptions};
use format::News;
use model::PlantSelection;
use purpose::Purpose;
use sweep::RobustnessCampaign;
use synthesis::{DesignRequest, blank_synthesis};
use verify::VerificationOptions;

/// A project with every value resolved.
#[derive(Debug, Clone, PartialEq)]
pub struct Project {
    /// The mechanism.
    pub plant: Parameters,
    /// The structure as matrices from elsewhere, if there is one.
    pub import: Option<import::ImportedStructure>,
    /// Description of the mechanism that is taken, and its operating point.
    pub model: PlantSelection,
    /// Options of the reduction of the plant before the design.
    pub reduce: ReductionOptions,
    /// Requirements on the design.
    pub synth: Option<DesignRequest>,
    /// Procedure of the loop, and the limits of its figures.
    pub verify: Option<VerificationOptions>,
    /// The traverse axis under this elevation axis, if there is one.
    pub traverse: Option<traverse::TraverseAxis>,
    /// Options of the test of robustness.
    pub sweep: Option<RobustnessCampaign>,
    /// Code that is generated.
    pub export: ExportRequest,
    /// The controller that was in the loop when recordings were made.
    pub recording_controller: Option<RecordingController>,
    /// Mapping of the columns of recordings to channels.
    pub recording: Mapping,
    /// Natural frequencies measured on the real structure.
    pub measured: Option<measured_modes::MeasuredModes>,
    /// Values that are known within tolerances.
    pub tolerances: Vec<KeyTolerance>,
    /// Paths of the physical quantities that are stated with the value of their default: they are known, where an absent key leaves its quantity open.
    pub stated_defaults: BTreeSet<String>,
}

/// A project and what is suspicious in its file.
#[derive(Debug, Clone, PartialEq)]
pub struct ParsedProject {
    /// The project.
    pub project: Project,
    /// Warnings: values that are allowed but likely to be a mistake.
    pub warnings: Vec<Diagnostic>,
    /// Defaults that stand in for physical quantities that the file does not have.
    pub assumptions: Vec<Assumption>,
}

impl Project {
    /// Reads a project file that refers to no other file.
    ///
    /// # Errors
    /// Every error of the file, in order of place.
    pub fn parse(text: &str, name: &str) -> Result<ParsedProject, Vec<Diagnostic>> {
        Self::resolve(&Document::parse(text, name), &Attachments::none())
    }

    /// Reads the bytes of a project file that refers to no other file.
    ///
    /// # Errors
    /// Every error of the file, in order of place.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<ParsedProject, Vec<Diagnostic>> {
        Self::resolve(&Document::from_bytes(bytes, name)?, &Attachments::none())
    }

    /// Resolves a file as written, with the files that it refers to.
    ///
    /// # Errors
    /// Every error of the file, the most important first. A file of a newer format has that error alone, and so have parts that
    /// cannot be put in their places.
    pub fn resolve(document: &Document, attachments: &Attachments) -> Result<ParsedProject, Vec<Diagnostic>> {
        let document = &document.with_parts(attachments);
        format::check_readable(document)?;
        let mut project = Self::blank();
        let mut reader = Reader::new(&document.source, &document.entries, attachments);
        let format = file(&mut reader, &mut project);
        reader.finish();
        project.tolerances = std::mem::take(&mut reader.tolerances);
        project.stated_defaults = std::mem::take(&mut reader.stated_defaults);
        let plain = reader.units.is_empty() && project.tolerances.is_empty() && document.parts().is_empty();
        let news = if plain { News::Unused } else { News::Used };
        let (mut findings, assumptions) = (reader.findings, reader.assumptions);
        findings.extend(format::judge_format(document, format, news));
        findings.extend(checks::check_project(document, &project));
        if !document.has("plant") {
            // everything that refers to the machine follows from its absence
            findings
                .retain(|finding| finding.path == "plant" || finding.problem == DiagnosticKind::UnknownKey);
        }
        if !document.syntax.is_empty() {
            findings.retain(|finding| stands_alone(document, finding));
            findings.extend(document.syntax.clone());
        }
        diagnostic::sort(&mut findings);
        section_hints::hint_at_sections(&mut findings);
        section_hints::drop_consequences(document, &mut findings);
        let (errors, warnings): (Vec<_>, Vec<_>) =
            findings.into_iter().partition(|d| d.severity == Severity::Error);
        if errors.is_empty() { Ok(ParsedProject { project, warnings, assumptions }) } else { Err(errors) }
    }

    /// Resolves a file for a purpose: the sections that it needs must be there.
    ///
    /// # Errors
    /// Every error of the file, and every section that is missing.
    pub fn resolve_for(
        document: &Document,
        attachments: &Attachments,
        purpose: Purpose,
    ) -> Result<ParsedProject, Vec<Diagnostic>> {
        let document = &document.with_parts(attachments);
        let mut parsed = Self::resolve(document, attachments)?;
        let missing = parsed.project.missing_for(document, purpose);
        if purpose.needs_weights() {
            parsed.project = parsed.project.with_usual_verification();
        }
        if missing.is_empty() { Ok(parsed) } else { Err(missing) }
    }

    /// Returns the project with the usual procedure and no requirement if it has no section `verify`.
    #[must_use]
    pub fn with_usual_verification(mut self) -> Self {
        self.verify.get_or_insert_with(|| {
            verify::usual_verification(&self.model, self.plant.interface.sample_period_s)
        });
        self
    }

    /// Returns the canonical text of the project: sections in fixed order, units in comments, usual values
    /// left out where the file does not state them either.
    pub fn to_text(&self) -> String {
        let mut lines = self.lines();
        for line in &mut lines {
            if let Line::Value { path, usual, .. } = line
                && self.stated_defaults.contains(path)
            {
                *usual = false;
            }
        }
        writer::canonical_text(&lines)
    }

    /// Returns the assumptions of the project: the defaults that stand in for physical quantities, with their usual ranges.
    pub fn assumptions(&self) -> Vec<Assumption> {
        let document = Document::parse(&self.to_text(), "project.toml");
        // What stands in other files is not read again: it is stated, not assumed.
        let attachments = Attachments::none();
        let mut reader = Reader::new(&document.source, &document.entries, &attachments);
        file(&mut reader, &mut Self::blank());
        reader.assumptions
    }

    /// Returns the path of a key of the loop's sensor.
    pub fn key_of_loop_sensor(&self, key: &str) -> String {
        format!("plant.sensors.{}.{key}", loop_sensor::section_of(&self.plant.sensors))
    }

    /// Returns the path of the stiffness of the transmission, or of the structure if the motor drives it directly.
    pub fn key_of_stiffness(&self) -> String {
        let section = transmission::section_of(self.plant.gearbox.kind).unwrap_or("lumped");
        format!("plant.{section}.stiffness")
    }

    /// Returns the file with every value that differs between two projects set, and everything else of it left
    /// as it is.
    ///
    /// # Errors
    /// The text is not TOML, or a value leads through something that is no table.
    pub fn update(&self, document: &Document, old: &Self) -> Result<Document, EditError> {
        let mut updated = changes::apply(document, &old.lines(), &self.lines())?;
        for tolerance in &self.tolerances {
            let before = old.tolerances.iter().find(|before| before.key == tolerance.key);
            let changed = before.is_some_and(|before| before.as_written() != tolerance.as_written());
            if changed && updated.has(&format!("{}.tolerance", tolerance.key)) {
                let path = format!("{}.tolerance", tolerance.key);
                updated = updated.set(&path, &tolerance.setting())?;
            }
        }
        Ok(updated)
    }

    /// Returns the reference of all sections and keys, as Markdown, from the same walk that reads them.
    pub fn reference() -> String {
        let mut guide = Guide::default();
        for walk in 0..WALKS {
            guide.turn(walk);
            file(&mut guide, &mut Self::blank());
        }
        guide.text() + &figure_names::figure_table()
    }

    /// Returns the project with the number at a path replaced; `None` if no number stands there.
    pub fn with_number(&self, path: &str, value: f64) -> Option<Self> {
        let set = |path: &str| {
            let mut changed = self.clone();
            let mut setter = Setter::new(path, value);
            file(&mut setter, &mut changed);
            setter.is_set.then_some(changed)
        };
        // A drive that takes a voltage has become an amplifier.
        let of_amplifier = path.strip_prefix("plant.drive.").map(|key| format!("plant.amplifier.{key}"));
        let is_amplifier = self.plant.amplifier.dynamics == AmplifierDynamics::Modelled;
        match of_amplifier.filter(|_| is_amplifier) {
            Some(path) => set(&path),
            None => set(path),
        }
    }

    fn lines(&self) -> Vec<Line> {
        let mut lister = Lister::default();
        file(&mut lister, &mut self.clone());
        for line in &mut lister.lines {
            if let Line::Value { path, tolerance, usual, .. } = line
                && let Some(found) = self.tolerances.iter().find(|t| t.key == *path)
            {
                (*tolerance, *usual) = (Some(found.as_written()), false);
            }
        }
        lister.lines
    }

    fn blank() -> Self {
        Self {
            plant: plant::blank_parameters(),
            import: None,
            model: PlantSelection::default(),
            reduce: ReductionOptions::default(),
            synth: None,
            verify: None,
            traverse: None,
            sweep: None,
            export: ExportRequest::default(),
            recording_controller: None,
            recording: Mapping::default(),
            measured: None,
            tolerances: Vec::new(),
            stated_defaults: BTreeSet::new(),
        }
    }
}

/// Reads or lists the whole file; gives its format.
fn file(v: &mut dyn Visit, project: &mut Project) -> u32 {
    let mut format = FORMAT;
    v.whole_number(
        &Field::new("format", "format of this file")
            .limit(NumberRange::AtLeast(0.0))
            .or(f64::from(FORMAT))
            .show_default(),
        &mut format,
    );
    let smallest = "inertia = \"1 kg m^2\", drive = \"torque\", interface = { sample_period = \"1 ms\" }";
    table(
        v,
        &TableField::mandatory("plant", "the mechanism").with_smallest(smallest),
        project,
        |v, project| {
            plant::plant(v, &mut project.plant);
            let section =
                TableField::optional("import", "the structure as matrices of a finite-element package");
            visit_optional(v, &section, &mut project.import, import::blank_structure(), import::import);
        },
    );
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
    if v.enter(field, Presence::from(*value != T::default())) {
        walk(v, value);
        v.leave();
    }
}

fn designs(v: &mut dyn Visit, project: &mut Project) {
    unless_usual(
        v,
        &TableField::optional("model", "the description of the plant that is used, and its operating point"),
        &mut project.model,
        model::model,
    );
    unless_usual(
        v,
        &TableField::optional("reduce", "reduction of the plant before the design"),
        &mut project.reduce,
        design::reduce,
    );
    let section = TableField::optional("synth", "the design: weights and options");
    let (measured, axis) = (project.plant.sensors.measured, project.plant.axis);
    visit_optional(v, &section, &mut project.synth, blank_synthesis(), |v, synth| {
        design::synth(v, synth, measured, axis);
    });
    let section = TableField::optional("verify", "tests of the loop, and requirements");
    let controlled = project.plant.controlled_quantity();
    let period_s = project.plant.interface.sample_period_s;
    visit_optional(v, &section, &mut project.verify, verify::blank_options(period_s), |v, verification| {
        verify::verify(v, verification, controlled, axis, period_s);
    });
    let section = TableField::optional(
        "traverse",
        "the traverse axis under this elevation axis, verified together with it",
    );
    visit_optional(v, &section, &mut project.traverse, traverse::blank_axis(), traverse::visit_traverse_axis);
    let section = TableField::optional("sweep", "robustness campaign");
    visit_optional(v, &section, &mut project.sweep, sweep::blank_campaign(), sweep::sweep);
    if let Some(verification) = &mut project.verify {
        verification.procedure.operating_point = project.model.operating_point;
        verification.procedure.friction = project.model.friction;
    }
    unless_usual(
        v,
        &TableField::optional("export", "the generated code"),
        &mut project.export,
        design::export,
    );
}

fn recordings(v: &mut dyn Visit, project: &mut Project) {
    let section =
        TableField::optional("recording_controller", "the controller in the loop when recordings were made");
    visit_optional(
        v,
        &section,
        &mut project.recording_controller,
        controller::blank_recording_controller(),
        controller::recording_controller,
    );
    let period_s = project.plant.interface.sample_period_s;
    match &mut project.recording_controller {
        Some(RecordingController::ProportionalIntegral(controller)) => controller.sample_period_s = period_s,
        Some(RecordingController::Position(controller)) => {
            if project.plant.sensors.measured.is_position() {
                controller::read_position_of_loop(v, controller);
            }
            controller.sample_period_s = period_s;
        }
        _ => {}
    }
    let section = TableField::optional("recording", "how the columns of recordings become channels");
    unless_usual(v, &section, &mut project.recording, recording::recording);
    let section = TableField::optional("measured", "natural frequencies measured on the real structure");
    visit_optional(
        v,
        &section,
        &mut project.measured,
        measured_modes::blank_modes(),
        measured_modes::measured_modes,
    );
}

/// Returns whether a finding holds even though the syntax is broken elsewhere.
fn stands_alone(document: &Document, finding: &Diagnostic) -> bool {
    let elsewhere = document.syntax.iter().all(|s| s.line != finding.line);
    elsewhere && matches!(finding.problem, DiagnosticKind::OutOfRange | DiagnosticKind::NotFinite)
}

/// Returns the units of the keys of a file's quantities, by the bytes at which the quantities stand.
pub(crate) fn units(document: &Document) -> BTreeMap<usize, &'static str> {
    let files = Attachments::none();
    let mut reader = Reader::new(&document.source, &document.entries, &files);
    file(&mut reader, &mut Project::blank());
    reader.finish();
    reader.units
}
