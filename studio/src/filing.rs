//! Projects opened, made, saved and left. A journal stands beside every one that is open, so that nothing is lost on the way.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use counterpoise_project::pipeline::World;
use counterpoise_project::{Attachments, Document, PlatformSource};

use crate::browser::Browser;
use crate::command::{Command, Purpose};
use crate::files::{self, Folder, PROJECT_FILE};
use crate::journal::{self, Head, Journal};
use crate::recordings;
use crate::results::Results;
use crate::session::Session;
use crate::studio::{Opened, Studio};

/// What to do where nothing can be written.
const WAY_OUT: &str =
    "Nothing is lost: make room and save again (Ctrl+S), or save under another name (Ctrl+Shift+S)";

impl Studio {
    /// Opens a browser where it is likely to be of use.
    pub(crate) fn browse(&mut self, purpose: Purpose) {
        let here = std::env::current_dir().unwrap_or_default();
        let file = self.opened.as_ref().map(|o| o.path.clone());
        if file.is_none() && purpose != Purpose::Project {
            return self.view.warn("no project is open");
        }
        let folder = file.as_deref().and_then(Path::parent).map_or(here, Path::to_owned);
        let start = match (purpose, file) {
            (Purpose::SaveAs, Some(file)) => file,
            (Purpose::Project, Some(_)) => folder.parent().map_or(folder.clone(), Path::to_owned),
            (Purpose::Export, _) => self.view.out.clone().unwrap_or_else(|| folder.join("out")),
            (Purpose::Recordings, _) => {
                self.jobs.recordings.last().and_then(|p| p.parent()).map_or(folder, Path::to_owned)
            }
            _ => folder,
        };
        self.refused = None;
        self.view.browser = Some(Browser::new(purpose, &start));
    }

    pub(crate) fn create(&mut self, folder: &Path) {
        match files::create(folder) {
            Ok(path) => {
                self.open(&path);
                self.view
                    .say(format!("{} is a complete machine: change its numbers to your own", path.display()));
            }
            Err(why) => self.refuse(why),
        }
    }

    pub(crate) fn refuse(&mut self, why: String) {
        self.view.warn(why.clone());
        self.refused = Some(why);
    }

    pub(crate) fn leave(&mut self) {
        self.jobs.forget();
        self.close();
        (self.results, self.asked, self.verify_at) = (Results::default(), None, None);
        (self.view.out, self.view.browser) = (None, None);
    }

    /// Opens a project; edits that were never saved come back.
    pub fn open(&mut self, path: &Path) {
        let path = files::project_file(path);
        match files::read(&path) {
            Ok((text, attachments)) => {
                self.leave();
                self.begin(path, &text, attachments);
            }
            Err(why) => self.refuse(why),
        }
    }

    fn begin(&mut self, path: PathBuf, text: &str, attachments: Attachments) {
        let name = name_of(&path);
        let mut session = Session::new(text, &name, attachments);
        let mut already = Vec::new();
        if let Some(found) = journal::recover(&journal::path_for(&self.state, &path)) {
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
        let journal = self.journal(&path, text, &already);
        files::note_recent(&self.state, &path);
        let modified = modified(&path);
        self.jobs.beside = path.parent().map_or(Vec::new(), |f| recordings::files(&[f.to_owned()]));
        self.refused = None;
        self.opened =
            Some(Opened { path, session, journal, modified, troubled: false, changed_outside: false });
        (self.asked, self.results) = (None, Results::default());
    }

    /// Begins the journal of a project; says where it cannot be written.
    fn journal(&mut self, path: &Path, text: &str, already: &[Command]) -> Option<Journal> {
        let place = journal::path_for(&self.state, path);
        let head = Head { project: path.to_owned(), text: text.to_owned() };
        let begun = Journal::begin(&place, &head, already);
        if let Err(error) = &begun {
            let place = place.display();
            self.view.warn(format!("edits are not kept against a crash, {place} cannot be written: {error}"));
        }
        begun.ok()
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

    pub(crate) fn save(&mut self) {
        let Some(mut opened) = self.opened.take() else { return };
        let shown = opened.path.display().to_string();
        match files::write(&opened.path, opened.session.text().as_bytes()) {
            Ok(()) => {
                self.view.say(format!("saved {shown}"));
                self.saved(&mut opened);
            }
            Err(error) => {
                self.view.warn(format!("not saved, {shown} cannot be written: {error}. {WAY_OUT}"));
            }
        }
        self.opened = Some(opened);
    }

    /// What follows from a project's having been written.
    fn saved(&mut self, opened: &mut Opened) {
        opened.session.mark_saved();
        (opened.modified, opened.changed_outside) = (modified(&opened.path), false);
        opened.journal = None;
        opened.journal = self.journal(&opened.path, opened.session.text(), &[]);
    }

    /// Writes the project to another file, with the files that it names, and goes on there.
    pub(crate) fn save_as(&mut self, path: &Path) {
        let path = files::project_file(path);
        let Some(mut opened) = self.opened.take() else { return };
        let done = beside(&opened).into_iter().try_for_each(|name| copied(&opened.path, &path, &name));
        let done = done.and_then(|()| {
            files::write(&path, opened.session.text().as_bytes())
                .map_err(|error| format!("{} cannot be written: {error}", path.display()))
        });
        match done {
            Ok(()) => {
                if let Some(journal) = opened.journal.take() {
                    journal.remove();
                }
                opened.session.rename(&name_of(&path));
                opened.path = path;
                self.view.say(format!("saved as {}", opened.path.display()));
                self.saved(&mut opened);
                files::note_recent(&self.state, &opened.path);
                (self.view.browser, self.refused) = (None, None);
            }
            Err(why) => self.refuse(format!("not saved, {why}; nothing is lost, choose another place")),
        }
        self.opened = Some(opened);
    }

    pub(crate) fn reload(&mut self) {
        let Some(opened) = self.opened.take() else { return };
        let path = opened.path.clone();
        if let Some(journal) = opened.journal {
            journal.remove();
        }
        self.open(&path);
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

/// The files beside the project that it names.
fn beside(opened: &Opened) -> Vec<String> {
    let mut names = Document::parse(opened.session.text(), PROJECT_FILE).attachments();
    let road = opened.session.project().and_then(|p| p.verify.as_ref()?.road.as_ref());
    if let Some(PlatformSource::Recording(source)) = road {
        names.push(source.recording.clone());
    }
    names
}

/// Copies a file that a project names to where its copy will look for it; one that is there already stays, and nothing is
/// written outside of the copy's folder.
fn copied(from: &Path, to: &Path, name: &str) -> Result<(), String> {
    let place = |file: &Path| file.parent().unwrap_or(Path::new(".")).join(name);
    let (source, target) = (place(from), place(to));
    let is_outside = Path::new(name).components().any(|part| part == std::path::Component::ParentDir);
    if is_outside || target.exists() || !source.is_file() {
        return Ok(());
    }
    let folder = Folder(from.parent().unwrap_or(Path::new(".")).to_owned());
    files::write(&target, &folder.read(name)?)
        .map_err(|error| format!("{} cannot be written: {error}", target.display()))
}

pub(crate) fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}
