//! Projects read and written for the window: on a worker, one errand after the other. What the window sees of it is in
//! [`crate::filing`].

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use counterpoise_project::Attachments;

use crate::command::Command;
use crate::journal::{self, Flush};
use crate::session::Session;
use counterpoise_host::files::{self, Disk};

/// What is to be done.
#[derive(Debug, Clone)]
pub enum Errand {
    /// Reads a project.
    Open {
        /// The project file, or its folder.
        path: PathBuf,
        /// What becomes of edits that were never saved.
        unsaved: Unsaved,
    },
    /// Makes a folder with a project to start from, and reads it.
    Make {
        /// The folder.
        folder: PathBuf,
    },
    /// Writes a project to its file.
    Save {
        /// The file.
        path: PathBuf,
        /// The text.
        text: String,
    },
    /// Writes a project to another file, with the files that it names.
    SaveAs {
        /// The file that it was read from.
        from: PathBuf,
        /// The other file, or a folder for it.
        to: PathBuf,
        /// The text.
        text: String,
        /// The files beside it that it names.
        names: Vec<String>,
    },
}

/// Edits that were never saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unsaved {
    /// They come back.
    Recovered,
    /// They are left.
    Left,
}

/// What was done, or why not.
#[derive(Debug)]
pub enum Done {
    /// A project was read.
    Read(Result<Box<Found>, String>),
    /// A project was written.
    Written {
        /// Where.
        path: PathBuf,
        /// What.
        text: String,
        /// When the file says that it was changed, or why nothing was written.
        done: Result<Option<SystemTime>, String>,
    },
}

/// A project that was read.
#[derive(Debug)]
pub struct Found {
    /// The file.
    pub path: PathBuf,
    /// The text as it was read.
    pub text: String,
    /// The project, with edits that came back.
    pub session: Session,
    /// These edits, in one.
    pub already: Vec<Command>,
    /// How many they were.
    pub edits: usize,
    /// When the file says that it was changed.
    pub modified: Option<SystemTime>,
    /// Recordings beside it.
    pub beside: Vec<PathBuf>,
    /// Whether it was made just now.
    pub is_new: bool,
}

/// Where errands are carried out.
pub struct Desk {
    /// The disk.
    pub disk: Arc<dyn Disk>,
    /// Where the studio's own files are.
    pub state: PathBuf,
    /// Waits until the journal is on disk, before it is read.
    pub flush: Flush,
}

impl Desk {
    /// Carries out an errand.
    pub fn carry_out(&self, errand: Errand) -> Done {
        match errand {
            Errand::Open { path, unsaved } => Done::Read(self.read(&files::project_file(&path), unsaved)),
            Errand::Make { folder } => Done::Read(files::create(&folder).and_then(|path| {
                let mut found = self.read(&path, Unsaved::Left)?;
                found.is_new = true;
                Ok(found)
            })),
            Errand::Save { path, text } => {
                let done = self.write(&path, &text);
                Done::Written { path, text, done }
            }
            Errand::SaveAs { from, to, text, names } => {
                let path = files::project_file(&to);
                let copied = names.iter().try_for_each(|name| self.copy(&from, &path, name));
                let done = copied.and_then(|()| self.write(&path, &text));
                Done::Written { path, text, done }
            }
        }
    }

    fn write(&self, path: &Path, text: &str) -> Result<Option<SystemTime>, String> {
        files::write_on(self.disk.as_ref(), path, text.as_bytes())
            .map_err(|error| format!("{} cannot be written: {error}", path.display()))?;
        Ok(modified(path))
    }

    fn read(&self, path: &Path, unsaved: Unsaved) -> Result<Box<Found>, String> {
        let (text, attachments) = files::read(self.disk.as_ref(), path)?;
        let modified = modified(path);
        let mut session = Session::new(&text, &name_of(path), attachments);
        let (mut already, mut edits) = (Vec::new(), 0);
        if let (Unsaved::Recovered, Some((replace, count))) = (unsaved, self.unsaved(path, &text))
            && session.apply(&replace).is_ok()
        {
            (already, edits) = (vec![replace], count);
        }
        let beside = path.parent().map_or(Vec::new(), |folder| files::recording_files(&[folder.to_owned()]));
        let path = path.to_owned();
        Ok(Box::new(Found { path, text, session, already, edits, modified, beside, is_new: false }))
    }

    /// The edits in a project's journal as one, where they make another text, and their number.
    fn unsaved(&self, path: &Path, text: &str) -> Option<(Command, usize)> {
        self.flush.wait();
        let found = journal::recover(&journal::path_for(&self.state, path))?;
        let mut before = Session::new(&found.head.text, &name_of(path), Attachments::none());
        let good = found.commands.iter().all(|command| before.apply(command).is_ok());
        (good && before.text() != text)
            .then(|| (Command::Replace { text: before.text().to_owned() }, found.commands.len()))
    }

    /// Copies a file that a project names to where its copy will look for it; one that is there already stays, and nothing is
    /// written outside of the copy's folder.
    fn copy(&self, from: &Path, to: &Path, name: &str) -> Result<(), String> {
        let place = |file: &Path| file.parent().unwrap_or(Path::new(".")).join(name);
        let (source, target) = (place(from), place(to));
        let is_outside = Path::new(name).components().any(|part| part == std::path::Component::ParentDir);
        if is_outside || target.exists() || !source.is_file() {
            return Ok(());
        }
        let bytes =
            self.disk.read(&source).map_err(|error| format!("cannot read {}: {error}", source.display()))?;
        files::write_on(self.disk.as_ref(), &target, &bytes)
            .map_err(|error| format!("{} cannot be written: {error}", target.display()))
    }
}

/// The name of a path's file.
pub fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}

/// A look at the project file, and beside it.
#[derive(Debug, Clone)]
pub struct Glance {
    /// The file.
    pub path: PathBuf,
    /// When it was changed, as far as is known.
    pub modified: Option<SystemTime>,
}

/// What a look has found.
#[derive(Debug)]
pub struct Glanced {
    /// The file.
    pub path: PathBuf,
    /// When it was changed.
    pub modified: Option<SystemTime>,
    /// What it holds, where it was changed since it was looked at before.
    pub content: Option<Vec<u8>>,
    /// Recordings beside it.
    pub beside: Vec<PathBuf>,
}

/// Looks at a project file.
pub fn glance(of: Glance, disk: &dyn Disk) -> Glanced {
    let now = modified(&of.path);
    let content = (now.is_some() && now != of.modified).then(|| disk.read(&of.path).ok()).flatten();
    let beside = of.path.parent().map_or(Vec::new(), |folder| files::recording_files(&[folder.to_owned()]));
    Glanced { path: of.path, modified: now, content, beside }
}
