//! Projects read and written for the window: on a worker, one job after the other. What the window shows of it is decided in
//! [`crate::studio`].

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use counterpoise_host::files::{self, Disk, PROJECT_FILE};
use counterpoise_project::starters::StarterKind;
use counterpoise_project::{Attachments, Document, STARTER};

use crate::command::Command;
use crate::editing::journal::{self, JournalFlush};
use crate::editing::session::{Session, file_name};
use crate::examples::Example;
use crate::jobs::history_file::history_path;
use crate::settings::ProjectSettings;
use counterpoise_host::file_check::{modification_time, recordings_beside};
use counterpoise_host::project_lock::ProjectLock;

/// Work on a project's files.
#[derive(Debug, Clone)]
pub enum FileJob {
    /// Reads a project.
    Open {
        /// The project file, or its folder.
        path: PathBuf,
    },
    /// Reads the text of the project file again.
    Reread {
        /// The file.
        path: PathBuf,
    },
    /// Makes a folder with a project to start from, and reads it.
    Create {
        /// The folder.
        folder: PathBuf,
        /// The kind of machine; `None` for a complete file.
        like: Option<StarterKind>,
    },
    /// Writes a copy of an example into a folder of its own, and reads it.
    CopyExample {
        /// The example.
        example: &'static Example,
        /// The folder in which the copy's folder is made.
        folder: PathBuf,
    },
    /// Writes a project to its file.
    Save {
        /// The file.
        path: PathBuf,
        /// The text.
        text: String,
        /// The treatment of a file if another program has changed the file.
        overwrite: Overwrite,
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

/// Behaviour of a save if another program has changed the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Overwrite {
    /// It writes only if the file still holds this text, or is absent.
    IfUnchanged(String),
    /// It writes in any case.
    Always,
}

/// Result of a file job.
#[derive(Debug)]
pub enum FileJobResult {
    /// A project was read.
    Loaded(Result<Box<LoadedProject>, String>),
    /// The text of the project file was read again.
    Reread {
        /// The file.
        path: PathBuf,
        /// Text with its time, or why it cannot be read.
        found: Result<DiskText, String>,
    },
    /// A project was written.
    Written {
        /// The file.
        path: PathBuf,
        /// The text.
        text: String,
        /// The outcome.
        outcome: SaveOutcome,
    },
}

/// A project's text on disk.
#[derive(Debug, Clone)]
pub struct DiskText {
    /// The text.
    pub text: String,
    /// The files that it names; `None` if they were not read.
    pub attachments: Option<Attachments>,
    /// The time of the file's last change.
    pub modified: Option<SystemTime>,
}

/// Outcome of a save.
#[derive(Debug)]
pub enum SaveOutcome {
    /// The file was written.
    Saved {
        /// The time of the file's last change.
        modified: Option<SystemTime>,
        /// The lock on another name, if the project was saved under one.
        lock: Option<ProjectLock>,
    },
    /// Another program has changed the file; nothing was written.
    Conflict(DiskText),
    /// Nothing was written, for this reason.
    Failed(String),
}

/// A project that was read.
#[derive(Debug)]
pub struct LoadedProject {
    /// The file.
    pub path: PathBuf,
    /// The text as it was read.
    pub text: String,
    /// The project, with restored edits.
    pub session: Session,
    /// The restored edits, as one command.
    pub restored: Vec<Command>,
    /// The number of restored edits.
    pub restored_count: usize,
    /// The time of the file's last change.
    pub modified: Option<SystemTime>,
    /// Recordings in its folder.
    pub nearby_recordings: Vec<PathBuf>,
    /// The origin of the project: made just now or read.
    pub origin: ProjectOrigin,
    /// The lock; `None` if another window holds it.
    pub lock: Option<ProjectLock>,
    /// View of the project when it was open last.
    pub settings: Option<ProjectSettings>,
}

/// Origin of a loaded project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProjectOrigin {
    /// The file was read.
    Existing,
    /// The file was made just now.
    Created,
}

/// Reads and writes projects.
pub struct ProjectStore {
    /// The disk.
    pub disk: Arc<dyn Disk>,
    /// The folder with the studio's own files.
    pub state: PathBuf,
    /// Waits until the last journal has ended, before a lock is acquired and a journal is read.
    pub flush: JournalFlush,
}

/// Edits that were recovered from a journal.
struct RestoredEdits {
    replace: Command,
    count: usize,
}

impl ProjectStore {
    /// Carries out a job.
    pub fn run(&self, job: FileJob) -> FileJobResult {
        match job {
            FileJob::Open { path } => FileJobResult::Loaded(self.load(&files::project_file(&path))),
            FileJob::Reread { path } => {
                let modified = modification_time(&path);
                let found = files::read_project(self.disk.as_ref(), &path)
                    .map(|(text, attachments)| DiskText { text, attachments: Some(attachments), modified });
                FileJobResult::Reread { path, found }
            }
            FileJob::Create { folder, like } => FileJobResult::Loaded(self.create(&folder, like)),
            FileJob::CopyExample { example, folder } => {
                FileJobResult::Loaded(self.copy_example(example, &folder))
            }
            FileJob::Save { path, text, overwrite } => {
                let outcome = self.save(&path, &text, &overwrite);
                FileJobResult::Written { path, text, outcome }
            }
            FileJob::SaveAs { from, to, text, names } => {
                let path = files::project_file(&to);
                let outcome = self.save_as(&from, &path, &text, &names);
                FileJobResult::Written { path, text, outcome }
            }
        }
    }

    fn create(&self, folder: &Path, like: Option<StarterKind>) -> Result<Box<LoadedProject>, String> {
        let path = files::create_project(
            folder,
            &Document::parse(like.map_or(STARTER, StarterKind::text), PROJECT_FILE),
        )?;
        let mut loaded = self.load(&path)?;
        loaded.origin = ProjectOrigin::Created;
        Ok(loaded)
    }

    fn copy_example(&self, example: &Example, folder: &Path) -> Result<Box<LoadedProject>, String> {
        let names =
            (1..).map(|k| if k == 1 { example.name.to_owned() } else { format!("{}-{k}", example.name) });
        let mut places = names.map(|name| folder.join(name));
        let place = places.find(|place| !place.exists()).unwrap_or_else(|| folder.to_owned());
        for file in example.files {
            self.write_content(&place.join(file.name), file.content)?;
        }
        let mut loaded = self.load(&place.join(PROJECT_FILE))?;
        loaded.origin = ProjectOrigin::Created;
        Ok(loaded)
    }

    /// Writes the project, unless another program has changed the file: its content is compared just before it is replaced.
    fn save(&self, path: &Path, text: &str, overwrite: &Overwrite) -> SaveOutcome {
        if let Overwrite::IfUnchanged(expected) = overwrite
            && path.is_file()
            && let Ok(found) = self.text_on_disk(path)
            && found.text != *expected
            && found.text != text
        {
            return SaveOutcome::Conflict(found);
        }
        match self.write(path, text) {
            Ok(modified) => SaveOutcome::Saved { modified, lock: None },
            Err(why) => SaveOutcome::Failed(why),
        }
    }

    fn save_as(&self, from: &Path, to: &Path, text: &str, names: &[String]) -> SaveOutcome {
        let lock = ProjectLock::acquire(&self.state, to);
        if lock.is_none() && from != to {
            return SaveOutcome::Failed(format!("{} is open in another window", to.display()));
        }
        let copied = names.iter().try_for_each(|name| self.copy_named_file(from, to, name));
        let copied = copied.and_then(|()| self.copy_file(&history_path(from), &history_path(to)));
        match copied.and_then(|()| self.write(to, text)) {
            Ok(modified) => SaveOutcome::Saved { modified, lock },
            Err(why) => SaveOutcome::Failed(why),
        }
    }

    fn text_on_disk(&self, path: &Path) -> Result<DiskText, String> {
        let modified = modification_time(path);
        let bytes =
            self.disk.read(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
        Ok(DiskText { text: String::from_utf8_lossy(&bytes).into_owned(), attachments: None, modified })
    }

    fn write(&self, path: &Path, text: &str) -> Result<Option<SystemTime>, String> {
        self.write_content(path, text.as_bytes())?;
        Ok(modification_time(path))
    }

    fn write_content(&self, path: &Path, content: &[u8]) -> Result<(), String> {
        files::write_on(self.disk.as_ref(), path, content)
            .map_err(|error| format!("{} cannot be written: {error}", path.display()))
    }

    fn load(&self, path: &Path) -> Result<Box<LoadedProject>, String> {
        let (text, attachments) = files::read_project(self.disk.as_ref(), path)?;
        let modified = modification_time(path);
        self.flush.wait();
        let lock = ProjectLock::acquire(&self.state, path);
        let mut session = Session::new(&text, &file_name(path), attachments);
        let (mut restored, mut restored_count) = (Vec::new(), 0);
        if let Some(edits) = lock.as_ref().and_then(|_| self.unsaved_edits(path, &text))
            && session.apply(&edits.replace).is_ok()
        {
            (restored, restored_count) = (vec![edits.replace], edits.count);
        }
        Ok(Box::new(LoadedProject {
            path: path.to_owned(),
            text,
            session,
            restored,
            restored_count,
            modified,
            nearby_recordings: recordings_beside(path),
            origin: ProjectOrigin::Existing,
            lock,
            settings: ProjectSettings::load(&self.state, path),
        }))
    }

    /// Returns the edits in a project's journal as one command, or `None` if they lead to the text on disk.
    fn unsaved_edits(&self, path: &Path, text: &str) -> Option<RestoredEdits> {
        let found = journal::recover_journal(&counterpoise_host::journals::journal_path(&self.state, path))?;
        let mut before = Session::new(&found.header.text, &file_name(path), Attachments::none());
        let applies = found.commands.iter().all(|command| before.apply(command).is_ok());
        (applies && before.text() != text).then(|| RestoredEdits {
            replace: Command::Replace { text: before.text().to_owned() },
            count: found.commands.len(),
        })
    }

    /// Copies a file that a project names to the place where its copy will look for it. A file that is there already stays, and
    /// nothing is written outside the folder of the copy.
    fn copy_named_file(&self, from: &Path, to: &Path, name: &str) -> Result<(), String> {
        let place = |file: &Path| file.parent().unwrap_or(Path::new(".")).join(name);
        let (source, target) = (place(from), place(to));
        let is_outside = Path::new(name).components().any(|part| part == std::path::Component::ParentDir);
        if is_outside { Ok(()) } else { self.copy_file(&source, &target) }
    }

    /// Copies a file to a place where none stands.
    fn copy_file(&self, source: &Path, target: &Path) -> Result<(), String> {
        if target.exists() || !source.is_file() {
            return Ok(());
        }
        let bytes =
            self.disk.read(source).map_err(|error| format!("cannot read {}: {error}", source.display()))?;
        files::write_on(self.disk.as_ref(), target, &bytes)
            .map_err(|error| format!("{} cannot be written: {error}", target.display()))
    }
}
