//! Projects opened, made, saved and left. A worker reads and writes ([`crate::errands`]), one errand at a time; here errands wait
//! for their turn, and what they have done is taken over. A journal stands beside the project that is open, so that nothing is
//! lost on the way.

use std::collections::VecDeque;
use std::path::Path;

use counterpoise_project::{Document, PlatformSource};

use crate::browser::Browser;
use crate::command::{Command, Purpose};
use crate::errands::{Done, Errand, Found, Unsaved, name_of};
use crate::journal::{self, Fate, Head};
use crate::noted::List;
use crate::results::Results;
use crate::studio::{Opened, Studio};
use counterpoise_host::files::PROJECT_FILE;

/// What to do where nothing can be written.
const WAY_OUT: &str =
    "Nothing is lost: make room and save again (Ctrl+S), or save under another name (Ctrl+Shift+S)";

/// What concerns files and is not done yet.
#[derive(Debug, Default)]
pub struct Filing {
    /// The command that the worker carries out.
    under_way: Option<Command>,
    /// Those that wait, with the text that is to be saved.
    waiting: VecDeque<(Command, String)>,
}

fn saves(command: &Command) -> bool {
    matches!(command, Command::Save | Command::SaveAs { .. })
}

impl Filing {
    /// Whether anything is under way or waits.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some() || !self.waiting.is_empty()
    }

    /// Whether a project is being saved.
    pub fn is_saving(&self) -> bool {
        self.under_way.as_ref().is_some_and(saves) || self.waiting.iter().any(|(command, _)| saves(command))
    }

    /// What is being opened or made.
    pub fn opening(&self) -> Option<&Path> {
        match self.under_way.as_ref()? {
            Command::Open { path } => Some(path),
            Command::New { folder } => Some(folder),
            Command::Reload => Some(Path::new("the project again")),
            _ => None,
        }
    }

    /// Puts a command in its place: what saves comes before what leaves the project, else the order is that of asking.
    fn wait(&mut self, command: Command, text: String) {
        let saved = self.waiting.iter().take_while(|(other, _)| saves(other)).count();
        let place = if saves(&command) { saved } else { self.waiting.len() };
        self.waiting.insert(place, (command, text));
    }

    /// Takes back what would leave the project.
    fn stay(&mut self) {
        self.waiting.retain(|(command, _)| saves(command));
    }
}

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

    pub(crate) fn refuse(&mut self, why: String) {
        self.view.warn(why.clone());
        self.refused = Some(why);
    }

    /// Opens a project; edits that were never saved come back. The one that is open stays until the other is read.
    pub fn open(&mut self, path: &Path) {
        self.file(&Command::Open { path: path.to_owned() });
    }

    /// Takes on what concerns files. A text to save is the one of this moment.
    pub(crate) fn file(&mut self, command: &Command) {
        let text = self.opened.as_ref().map_or_else(String::new, |o| o.session.text().to_owned());
        if saves(command)
            && let Some(leaving) = self.filing.under_way.take_if(|other| !saves(other))
        {
            self.jobs.file.cancel();
            let again = match leaving {
                Command::New { folder } => Command::Open { path: folder },
                other => other,
            };
            let first = self.filing.waiting.iter().take_while(|(other, _)| saves(other)).count();
            self.filing.waiting.insert(first, (again, String::new()));
        }
        self.filing.wait(command.clone(), text);
        self.next_errand();
    }

    /// Gives the worker what is next.
    fn next_errand(&mut self) {
        while self.filing.under_way.is_none() {
            let Some((command, text)) = self.filing.waiting.pop_front() else { return };
            if command == Command::Close {
                self.leave();
            } else if let Some(errand) = self.errand(&command, text) {
                self.filing.under_way = Some(command);
                self.jobs.file.ask(0, errand);
            }
        }
    }

    fn errand(&self, command: &Command, text: String) -> Option<Errand> {
        let open = self.opened.as_ref();
        Some(match command {
            Command::Open { path } => Errand::Open { path: path.clone(), unsaved: Unsaved::Recovered },
            Command::Reload => Errand::Open { path: open?.path.clone(), unsaved: Unsaved::Left },
            Command::New { folder } => Errand::Make { folder: folder.clone() },
            Command::Save => Errand::Save { path: open?.path.clone(), text },
            Command::SaveAs { path } => {
                let names = beside(open?);
                Errand::SaveAs { from: open?.path.clone(), to: path.clone(), text, names }
            }
            _ => return None,
        })
    }

    /// Takes over what an errand has done.
    pub(crate) fn take_filed(&mut self) {
        if let Some((_, done)) = self.jobs.file.take() {
            let command = self.filing.under_way.take();
            match done {
                Done::Read(Ok(found)) => self.begin(*found, command == Some(Command::Reload)),
                Done::Read(Err(why)) => self.refuse(why),
                Done::Written { path, text, done: Ok(modified) } => {
                    if let Some(opened) = &mut self.opened {
                        (opened.modified, opened.changed_outside) = (modified, false);
                    }
                    self.saved(&path, &text);
                }
                Done::Written { path, done: Err(why), .. } => self.not_saved(&path, &why),
            }
        }
        self.next_errand();
    }

    fn begin(&mut self, mut found: Found, is_again: bool) {
        let open =
            self.opened.as_ref().filter(|o| !is_again && o.path == found.path && o.session.is_changed());
        if let Some(text) = open.map(|o| o.session.text().to_owned()) {
            found.already = vec![Command::Replace { text: text.clone() }];
            let _ = found.session.apply(&Command::Replace { text });
        }
        self.leave();
        self.refused = None;
        if found.is_new {
            let file = found.path.display();
            self.view.say(format!("{file} is a complete machine: change its numbers to your own"));
        } else if found.edits > 0 {
            self.view.say(format!(
                "{} edits that were not saved are back; \"Read the file again\" leaves them",
                found.edits
            ));
        }
        let head = Head { project: found.path.clone(), text: found.text };
        self.journal.begin(&journal::path_for(&self.state, &found.path), &head, &found.already);
        self.noted.note(List::Projects, &found.path);
        self.jobs.beside = found.beside;
        let (path, session, modified) = (found.path, found.session, found.modified);
        self.opened = Some(Opened { path, session, modified, changed_outside: false });
    }

    /// What follows from a project's having been written: the journal begins anew, with what was edited meanwhile.
    fn saved(&mut self, path: &Path, text: &str) {
        let Some(opened) = &mut self.opened else { return };
        opened.session.mark_saved(text);
        let mut said = format!("saved {}", path.display());
        if opened.path != path {
            self.journal.end(Fate::Removed);
            opened.session.rename(&name_of(path));
            opened.path = path.to_owned();
            said = format!("saved as {}", path.display());
            self.noted.note(List::Projects, path);
            (self.view.browser, self.refused) = (None, None);
        } else if self.view.browser.as_ref().is_some_and(|b| b.purpose == Purpose::SaveAs) {
            self.view.browser = None;
        }
        let head = Head { project: path.to_owned(), text: text.to_owned() };
        let further = opened.session.text() != text;
        let already = further.then(|| Command::Replace { text: opened.session.text().to_owned() });
        self.journal.begin(&journal::path_for(&self.state, path), &head, already.as_slice());
        self.saves += 1;
        self.view.say(said);
    }

    fn not_saved(&mut self, path: &Path, why: &str) {
        self.filing.stay();
        if self.opened.as_ref().is_some_and(|o| o.path == path) {
            self.view.warn(format!("not saved, {why}. {WAY_OUT}"));
        } else {
            self.refuse(format!("not saved, {why}; nothing is lost, choose another place"));
        }
    }

    /// Stops what is being opened; what is being saved goes on.
    pub(crate) fn stop_opening(&mut self) {
        self.filing.stay();
        if self.filing.under_way.take_if(|command| !saves(command)).is_some() {
            self.jobs.file.cancel();
        }
    }

    pub(crate) fn leave(&mut self) {
        self.jobs.forget();
        if let Some(opened) = self.opened.take() {
            self.journal.end(if opened.session.is_changed() { Fate::Kept } else { Fate::Removed });
        }
        (self.results, self.asked, self.verify_at) = (Results::default(), None, None);
        (self.view.out, self.view.browser) = (None, None);
    }

    /// Waits until everything is saved that was to be, and leaves the project; its journal goes when everything is saved, and stays
    /// when not.
    pub fn close(&mut self) {
        self.stop_opening();
        while self.filing.is_saving() {
            std::thread::sleep(std::time::Duration::from_millis(2));
            self.take_filed();
        }
        self.leave();
    }
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
