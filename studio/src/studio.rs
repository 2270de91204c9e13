//! The studio itself: carries out commands. What concerns files stands in [`crate::filing`]; what it does by itself, frame after
//! frame, in [`crate::rounds`].

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Instant, SystemTime};

use counterpoise_project::{Document, Project};
use counterpoise_verify::VerifiedController;

use crate::command::{Command, Slot};
use crate::errands::Desk;
use counterpoise_host::code_files::Library;

use crate::exporting::ExportAsk;
use crate::filing::Filing;
use crate::jobs::{self, Copy, EffortAsk, Form, Jobs, VerifyAsk};
use crate::journal::Journal;
use crate::measure::MeasureAsk;
use crate::noted::{List, Noted};
use crate::recordings::LookAsk;
use crate::results::Results;
use crate::session::Session;
use crate::view::View;
use counterpoise_host::files::{Disk, Folder, Native, PROJECT_FILE};
use counterpoise_host::worker::Wake;

/// An opened project.
pub struct Opened {
    /// The file.
    pub path: PathBuf,
    /// What is done to it.
    pub session: Session,
    pub(crate) modified: Option<SystemTime>,
    /// Whether the file was changed by somebody else since it was read.
    pub changed_outside: bool,
}

/// The studio.
pub struct Studio {
    /// Where its own files are.
    pub state: PathBuf,
    /// The project.
    pub opened: Option<Opened>,
    /// The window.
    pub view: View,
    /// What was computed.
    pub results: Results,
    pub(crate) jobs: Jobs,
    pub(crate) journal: Journal,
    pub(crate) noted: Noted,
    /// What concerns files and is not done yet.
    pub filing: Filing,
    /// How often a project was saved.
    pub(crate) saves: u64,
    /// Why edits are not kept against a crash, where they are not.
    pub troubled: Option<String>,
    /// What is due for the clipboard.
    pub(crate) copied: Option<Copy>,
    pub(crate) asked: Option<(u64, Option<f64>)>,
    pub(crate) verify_at: Option<Instant>,
    pub(crate) looked: Instant,
    pub(crate) listed: Instant,
    /// Makes the libraries of FMI units; none are made where nobody says how.
    pub library: Library,
    /// Why a project could not be opened.
    pub refused: Option<String>,
}

impl Studio {
    /// A studio that keeps its own files in `state`, and calls `wake` when an answer has come.
    pub fn new(state: &Path, wake: Wake) -> Self {
        Self::on(state, wake, Arc::new(Native))
    }

    /// A studio on a disk.
    pub fn on(state: &Path, wake: Wake, disk: Arc<dyn Disk>) -> Self {
        let journal = Journal::new(Arc::clone(&disk));
        let desk = Desk { disk: Arc::clone(&disk), state: state.to_owned(), flush: journal.flush() };
        Self {
            state: state.to_owned(),
            opened: None,
            view: View::default(),
            results: Results::default(),
            jobs: Jobs::new(&wake, desk),
            journal,
            noted: Noted::new(state, disk),
            filing: Filing::default(),
            saves: 0,
            troubled: None,
            copied: None,
            asked: None,
            verify_at: None,
            looked: Instant::now(),
            listed: Instant::now(),
            library: |_, _| None,
            refused: None,
        }
    }

    /// Carries out a command.
    pub fn run(&mut self, command: &Command) {
        if command.edits() {
            self.edit(command);
        } else if !self.view.apply(command) {
            self.act(command);
        }
    }

    fn edit(&mut self, command: &Command) {
        let Some(opened) = &mut self.opened else { return };
        match opened.session.apply(command) {
            // A step back goes to what stands in no journal: the text is noted that it leads to.
            Ok(()) if matches!(command, Command::Undo | Command::Redo) => {
                self.journal.note(&Command::Replace { text: opened.session.text().to_owned() });
            }
            Ok(()) => self.journal.note(command),
            Err(error) => self.view.warn(error.to_string()),
        }
    }

    fn act(&mut self, command: &Command) {
        match command {
            Command::Open { .. }
            | Command::New { .. }
            | Command::Close
            | Command::Save
            | Command::SaveAs { .. }
            | Command::Reload => self.file(command),
            Command::Browse { purpose } => self.browse(*purpose),
            Command::Verify => self.verify(),
            Command::Cancel => self.cancel(),
            Command::Export => self.export(),
            Command::ExportTo { folder } => {
                self.noted.note(List::Folders, folder);
                (self.view.out, self.view.browser) = (Some(folder.clone()), None);
                self.export();
            }
            Command::Measure => self.measure(MeasureAsk::Map),
            Command::Sweep => self.sweep(),
            Command::Keep { slot } => {
                if let Some(of) = &self.results.live {
                    self.view.keep(*slot, &of.value);
                    self.view.say(format!("kept as {}", slot.name()));
                }
            }
            Command::Return { slot } => self.go_back(*slot),
            Command::CopyCsv => self.copy(Form::Csv),
            Command::CopySvg => self.copy(Form::Svg),
            Command::CopyPng => self.copy(Form::Png),
            Command::Recordings { paths } => self.record(paths),
            Command::Diagnose => self.diagnose(),
            Command::Accept => self.accept(),
            _ => {}
        }
    }

    /// Puts a kept design's weights and order into the project; one step of undo takes them out again.
    fn go_back(&mut self, slot: Slot) {
        let name = slot.name();
        let Some(kept) = self.view.kept.get(name).map(|live| Arc::clone(&live.project)) else {
            return self.view.warn(format!("nothing is kept as {name} (Ctrl+Shift+1 to 3 keeps a design)"));
        };
        let Some(opened) = &self.opened else { return };
        let Some(now) = opened.session.project() else { return };
        let back = Project { synth: kept.synth.clone(), reduce: kept.reduce, ..Project::clone(now) };
        let document = Document::parse(opened.session.text(), PROJECT_FILE);
        match back.update(&document, now) {
            Ok(updated) => {
                self.run(&Command::Replace { text: updated.text().to_owned() });
                self.view.say(format!("back at the weights of {name} (Ctrl+Z takes it back)"));
            }
            Err(error) => self.view.warn(format!("the weights of {name} cannot be taken over: {error}")),
        }
    }

    /// Has the plot that was pointed at last written for the clipboard.
    fn copy(&mut self, form: Form) {
        if let Some(chart) = &self.view.chart {
            self.jobs.copy.ask(0, (chart.clone(), form));
        }
    }

    fn cancel(&mut self) {
        self.verify_at = None;
        self.jobs.cancel();
        self.stop_opening();
        self.view.say("stopped");
    }

    pub(crate) fn ask_verification(&self) -> Option<(u64, VerifyAsk)> {
        let (opened, of) = (self.opened.as_ref()?, self.results.live.as_ref()?);
        let folder = opened.path.parent().unwrap_or(Path::new(".")).to_owned();
        Some((of.revision, VerifyAsk { live: Arc::clone(&of.value), folder: Folder(folder) }))
    }

    pub(crate) fn verify(&mut self) {
        self.verify_at = None;
        if let Some((revision, ask)) = self.ask_verification() {
            let live = Arc::clone(&ask.live);
            self.jobs.verify.ask(revision, (revision, ask));
            self.jobs.effort.ask(revision, EffortAsk { live });
        }
    }

    /// The design with its verification, where both are of the project as it stands; else says what is missing.
    fn verified_now(&mut self, what: &str) -> Option<(u64, VerifyAsk, Arc<VerifiedController>)> {
        let (Some((revision, ask)), Some(of)) = (self.ask_verification(), self.results.verified.clone())
        else {
            self.view.warn(format!("{what}: the design is not verified yet (F5)"));
            return None;
        };
        let stale = self.opened.as_ref().is_none_or(|o| o.session.revision() != of.revision);
        if stale || ask.live.tried_kg_m.is_some() {
            self.view.warn(format!("{what}: the verification is of an older design; verify (F5) first"));
            return None;
        }
        Some((revision, ask, of.value))
    }

    fn export(&mut self) {
        let Some((revision, design, verified)) = self.verified_now("not exported") else { return };
        let out = self.view.out.clone().unwrap_or_else(|| design.folder.0.join("out"));
        self.jobs.export.ask(revision, ExportAsk { design, verified, out, library: self.library });
    }

    fn measure(&mut self, of: fn(VerifyAsk) -> MeasureAsk) {
        match self.ask_verification() {
            Some((revision, ask)) => self.jobs.measure.ask(revision, of(ask)),
            None => self.view.warn("there is no controller to measure with yet"),
        }
    }

    fn sweep(&mut self) {
        if let Some((revision, ask, verified)) = self.verified_now("not tried") {
            self.jobs.measure.ask(revision, MeasureAsk::Robust(ask, verified));
        }
    }

    fn record(&mut self, paths: &[PathBuf]) {
        self.view.browser = None;
        if let Some(folder) = paths.last().and_then(|path| path.parent()) {
            self.noted.note(List::Folders, folder);
        }
        self.jobs.recordings = paths.to_vec();
        (self.jobs.seen, self.jobs.diagnosed, self.jobs.diagnosed_plant) = (None, None, None);
        self.view.recording = 0;
        self.look();
    }

    /// Lays the recordings beside the model as it stands, and beside the diagnosed one.
    pub(crate) fn look(&mut self) {
        let Some(opened) = &self.opened else { return };
        let Some(project) = opened.session.project() else { return };
        let diagnosed = self.jobs.diagnosed.as_ref().and_then(|found| found.as_ref().ok());
        let improved = diagnosed
            .filter(|_| self.jobs.diagnosed_plant.as_ref() == Some(&project.plant))
            .map(|found| Arc::new(found.diagnosis.improved.clone()));
        let (project, paths) = (Arc::clone(project), self.jobs.recordings.clone());
        self.jobs.look.ask(opened.session.revision(), LookAsk { project, paths, improved });
    }

    fn diagnose(&mut self) {
        let Some(opened) = &self.opened else { return };
        let Some(project) = opened.session.project() else { return };
        if self.jobs.recordings.is_empty() {
            return self.view.warn("drop recordings (CSV, Parquet, MATLAB, HDF5) onto the window first");
        }
        let ask = jobs::DiagnoseAsk { project: Arc::clone(project), paths: self.jobs.recordings.clone() };
        self.jobs.diagnosed_plant = Some(project.plant.clone());
        self.jobs.diagnose.ask(opened.session.revision(), ask);
    }

    fn accept(&mut self) {
        let Some(project) = self.opened.as_ref().and_then(|o| o.session.project()) else { return };
        if self.jobs.diagnosed_plant.as_ref().is_some_and(|plant| *plant != project.plant) {
            return self
                .view
                .warn("not accepted: the mechanism was changed since the diagnosis; diagnose again (F6)");
        }
        let improved =
            self.opened.as_ref().and_then(|o| self.jobs.improved(o.session.text(), o.session.project()?));
        match improved {
            Some(Ok(text)) => {
                self.run(&Command::Replace { text });
                self.view.say(
                    "the diagnosis is in the project; design and verification follow (Ctrl+Z takes it back)",
                );
            }
            Some(Err(why)) => self.view.warn(why),
            None => self.view.warn("there is no diagnosis to accept"),
        }
    }

    /// What the diagnosis knows.
    pub fn diagnosis(&self) -> &Jobs {
        &self.jobs
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        self.close();
    }
}
