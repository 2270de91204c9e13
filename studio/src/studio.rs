//! The studio itself: carries out commands, asks the workers, takes their answers, keeps the journal.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use counterpoise_project::Attachments;
use counterpoise_project::verify::VerifiedController;

use crate::command::Command;
use crate::files::{self, Folder};
use crate::jobs::{self, Jobs, VerifyAsk};
use crate::journal::{self, Head, Journal};
use crate::live::{Ask, Live};
use crate::results::{Of, Results};
use crate::session::Session;
use crate::view::View;
use crate::worker::Wake;

/// How long after the last change the nonlinear verification begins.
const VERIFY_AFTER: Duration = Duration::from_millis(120);
/// How often it is looked whether the file was changed outside.
const LOOK_EVERY: Duration = Duration::from_secs(1);

/// An opened project.
pub struct Opened {
    /// The file.
    pub path: PathBuf,
    /// What is done to it.
    pub session: Session,
    journal: Option<Journal>,
    modified: Option<SystemTime>,
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
    jobs: Jobs,
    asked: Option<(u64, Option<f64>)>,
    verify_at: Option<Instant>,
    looked: Instant,
    /// Why a project could not be opened.
    pub refused: Option<String>,
}

impl Studio {
    /// A studio that keeps its own files in `state`, and calls `wake` when an answer has come.
    pub fn new(state: &Path, wake: Wake) -> Self {
        Self {
            state: state.to_owned(),
            opened: None,
            view: View::default(),
            results: Results::default(),
            jobs: Jobs::new(&wake),
            asked: None,
            verify_at: None,
            looked: Instant::now(),
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
            Ok(()) => {
                if let Some(journal) = &opened.journal {
                    journal.note(command);
                }
            }
            Err(error) => self.view.warn(error.to_string()),
        }
    }

    fn act(&mut self, command: &Command) {
        match command {
            Command::Open { path } => self.open(path),
            Command::Save => self.save(),
            Command::Reload => self.reload(),
            Command::Verify => self.verify(),
            Command::Cancel => self.cancel(),
            Command::Export => self.export(),
            Command::Keep { slot } => {
                if let Some(of) = &self.results.live {
                    self.view.keep(*slot, &of.value);
                    self.view.say(format!("kept as {}", slot.name()));
                }
            }
            Command::CopyCsv | Command::CopySvg | Command::CopyPng => {}
            Command::Recordings { paths } => self.jobs.recordings = paths.clone(),
            Command::Diagnose => self.diagnose(),
            Command::Accept => self.accept(),
            _ => {}
        }
    }

    /// Opens a project; edits that were never saved come back.
    pub fn open(&mut self, path: &Path) {
        let path = files::project_file(path);
        match files::read(&path) {
            Ok((text, attachments)) => {
                self.close();
                self.begin(path, &text, attachments);
            }
            Err(why) => {
                self.view.warn(why.clone());
                self.refused = Some(why);
            }
        }
    }

    fn begin(&mut self, path: PathBuf, text: &str, attachments: Attachments) {
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let mut session = Session::new(text, &name, attachments);
        let place = journal::path_for(&self.state, &path);
        let mut already = Vec::new();
        if let Some(found) = journal::recover(&place) {
            let mut before = Session::new(&found.head.text, &name, Attachments::none());
            let good = found.commands.iter().all(|c| before.apply(c).is_ok());
            if good && before.text() != text {
                let replace = Command::Replace { text: before.text().to_owned() };
                if session.apply(&replace).is_ok() {
                    already.push(replace);
                    let edits = found.commands.len();
                    self.view.say(format!(
                        "{edits} edits that were not saved are back; \"Read the file again\" leaves them"
                    ));
                }
            }
        }
        let head = Head { project: path.clone(), text: text.to_owned() };
        let journal = match Journal::begin(&place, &head, &already) {
            Ok(journal) => Some(journal),
            Err(error) => {
                let place = place.display();
                self.view
                    .warn(format!("edits are not kept against a crash, {place} cannot be written: {error}"));
                None
            }
        };
        files::note_recent(&self.state, &path);
        let modified = modified(&path);
        self.refused = None;
        self.opened = Some(Opened { path, session, journal, modified, changed_outside: false });
        (self.asked, self.results) = (None, Results::default());
    }

    /// Leaves the project; its journal goes when everything is saved, and stays when not.
    pub fn close(&mut self) {
        if let Some(opened) = self.opened.take()
            && !opened.session.is_changed()
            && let Some(journal) = opened.journal
        {
            journal.remove();
        }
    }

    fn save(&mut self) {
        let Some(opened) = &mut self.opened else { return };
        match files::write(&opened.path, opened.session.text().as_bytes()) {
            Ok(()) => {
                opened.session.mark_saved();
                (opened.modified, opened.changed_outside) = (modified(&opened.path), false);
                let head = Head { project: opened.path.clone(), text: opened.session.text().to_owned() };
                opened.journal = None;
                opened.journal = Journal::begin(&journal::path_for(&self.state, &opened.path), &head, &[]).ok();
                self.view.say(format!("saved {}", opened.path.display()));
            }
            Err(error) => self.view.warn(format!(
                "not saved, {} cannot be written: {error}. Nothing is lost: the edits are in the journal; make room or choose another folder, and save again",
                opened.path.display()
            )),
        }
    }

    fn reload(&mut self) {
        let Some(opened) = self.opened.take() else { return };
        let path = opened.path.clone();
        if let Some(journal) = opened.journal {
            journal.remove();
        }
        self.open(&path);
    }

    fn cancel(&mut self) {
        self.verify_at = None;
        self.jobs.cancel();
        self.view.say("stopped");
    }

    fn ask_verification(&self) -> Option<(u64, VerifyAsk)> {
        let (opened, of) = (self.opened.as_ref()?, self.results.live.as_ref()?);
        let folder = opened.path.parent().unwrap_or(Path::new(".")).to_owned();
        Some((of.revision, VerifyAsk { live: Arc::clone(&of.value), folder: Folder(folder) }))
    }

    fn verify(&mut self) {
        self.verify_at = None;
        if let Some((revision, ask)) = self.ask_verification() {
            self.jobs.verify.ask(revision, ask);
        }
    }

    fn export(&mut self) {
        let (Some((_, ask)), Some(of)) = (self.ask_verification(), self.results.verified.clone()) else {
            return self.view.warn("there is nothing to export: the design is not verified yet (F5)");
        };
        let stale = self.opened.as_ref().is_none_or(|o| o.session.revision() != of.revision);
        if stale || ask.live.tried_kg_m.is_some() {
            return self
                .view
                .warn("not exported: the verification is of an older design; verify (F5), then export");
        }
        let out = ask.folder.0.join("out");
        match jobs::export(&ask, &of.value, &out) {
            Ok(names) => self.view.say(format!("wrote {} to {}", names.join(", "), out.display())),
            Err(why) => self.view.warn(format!("not exported: {why}")),
        }
    }

    fn diagnose(&mut self) {
        let Some(opened) = &self.opened else { return };
        let Some(project) = opened.session.project() else { return };
        if self.jobs.recordings.is_empty() {
            return self.view.warn("drop recordings (CSV, Parquet, MATLAB) onto the window first");
        }
        let ask = jobs::DiagnoseAsk { project: Arc::clone(project), paths: self.jobs.recordings.clone() };
        self.jobs.diagnose.ask(opened.session.revision(), ask);
    }

    fn accept(&mut self) {
        let improved =
            self.opened.as_ref().and_then(|o| self.jobs.improved(o.session.text(), o.session.project()?));
        match improved {
            Some(Ok(text)) => self.run(&Command::Replace { text }),
            Some(Err(why)) => self.view.warn(why),
            None => self.view.warn("there is no diagnosis to accept"),
        }
    }

    /// Takes answers, asks for what is due; once a frame.
    pub fn tick(&mut self) {
        self.take_answers();
        self.ask_design();
        if self.verify_at.is_some_and(|at| Instant::now() >= at) && !self.view.dragging {
            self.verify();
        }
        self.look_outside();
        (self.results.designing, self.results.verifying) =
            (self.jobs.live.is_busy(), self.jobs.verify.is_busy());
    }

    /// When the studio should next look after itself, while nobody touches it.
    pub fn wakes_after(&self) -> Duration {
        let verify = self.verify_at.map(|at| at.saturating_duration_since(Instant::now()));
        verify.unwrap_or(LOOK_EVERY).max(Duration::from_millis(5))
    }

    /// Whether nothing is asked for or running.
    pub fn is_idle(&self) -> bool {
        self.verify_at.is_none() && !self.jobs.is_busy()
    }

    /// What the diagnosis knows.
    pub fn diagnosis(&self) -> &Jobs {
        &self.jobs
    }

    fn take_answers(&mut self) {
        if let Some((revision, answer)) = self.jobs.live.take() {
            match answer {
                Ok(live) => self.designed(revision, live),
                Err(why) => self.results.no_design = Some(Of { revision, value: why }),
            }
        }
        if let Some((revision, answer)) = self.jobs.verify.take() {
            match answer {
                Ok(found) => self.verified(revision, found),
                Err(why) => self.results.no_verification = Some(Of { revision, value: why }),
            }
        }
        self.jobs.take_diagnosis();
    }

    fn designed(&mut self, revision: u64, live: Box<Live>) {
        self.results.no_design = None;
        self.results.live = Some(Of { revision, value: Arc::new(*live) });
        self.verify_at = Some(Instant::now() + VERIFY_AFTER);
    }

    fn verified(&mut self, revision: u64, found: VerifiedController) {
        self.results.no_verification = None;
        self.results.verified = Some(Of { revision, value: Arc::new(found) });
    }

    fn ask_design(&mut self) {
        let Some(opened) = &self.opened else { return };
        let now = (opened.session.revision(), self.view.tried_kg_m);
        if self.asked == Some(now) {
            return;
        }
        self.asked = Some(now);
        if !opened.session.errors().is_empty() {
            let value = opened.session.errors().iter().map(ToString::to_string).collect();
            self.results.no_design = Some(Of { revision: now.0, value });
        } else if let Some(project) = opened.session.project() {
            let ask = Ask { project: Arc::clone(project), out_of_balance_kg_m: now.1 };
            self.jobs.live.ask(now.0, ask);
        }
    }

    /// Looks whether somebody else wrote the file, and whether the journal is written.
    fn look_outside(&mut self) {
        if self.looked.elapsed() < LOOK_EVERY {
            return;
        }
        self.looked = Instant::now();
        let Some(opened) = &mut self.opened else { return };
        let now = modified(&opened.path);
        if now.is_some() && now != opened.modified {
            opened.modified = now;
            opened.changed_outside =
                std::fs::read(&opened.path).is_ok_and(|b| b != opened.session.text().as_bytes());
        }
        if let Some(why) = opened.journal.as_ref().and_then(Journal::trouble) {
            self.view.warn(format!(
                "edits are not kept against a crash: {why}. Save (Ctrl+S) as soon as there is room"
            ));
        }
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        self.close();
    }
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}
