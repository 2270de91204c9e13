//! The threads behind the journal: one writes what comes at once, the other waits until the disk has it.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::files::{Disk, write_on};
use crate::project_lock::ProjectLock;
use crate::worker::WakeWindow;

/// Treatment of a journal that ends: it is kept or removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JournalEnding {
    /// Something was not saved: it is restored when the project is opened again.
    Keep,
    /// Everything is saved, or was discarded.
    Remove,
}

/// A message to the journal's thread.
pub enum JournalMessage {
    /// A journal begins at a path, with this text.
    Begin(PathBuf, String),
    /// A line is appended.
    Line(String),
    /// The journal ends, and then the lock of its project.
    End(JournalEnding, Option<ProjectLock>),
    /// An answer is sent when everything before this message is written.
    Flush(Sender<()>),
    /// The thread ends.
    Stop,
}

/// The thread of a journal.
pub type JournalThread = JoinHandle<()>;

/// Starts the thread that carries out messages until it is told to stop; it leaves in `error` why the journal cannot be written, and calls
/// `wake` when an error appears or goes.
pub fn spawn_journal_writer(
    disk: Arc<dyn Disk>,
    wake: WakeWindow,
    messages: Receiver<JournalMessage>,
    error: Arc<Mutex<Option<String>>>,
) -> JournalThread {
    std::thread::spawn(move || Writer::new(disk, wake).run(&messages, &error))
}

/// Time before a write that failed is tried again: short enough that a user who made room sees the message go.
const RETRY_INTERVAL: Duration = Duration::from_millis(500);

/// Writes what comes, at once. What could not be written is tried again until it can.
struct Writer {
    disk: Arc<dyn Disk>,
    /// The journal's path; `None` before one is begun.
    path: Option<PathBuf>,
    /// The journal's file, once it has been begun on disk.
    file: Option<File>,
    /// The text that is not written yet; it starts with the header if there is no file.
    pending: String,
    syncer: Syncer,
    wake: WakeWindow,
}

/// Waits for the disk, while more is written.
struct Syncer {
    inbox: Option<Sender<(PathBuf, File)>>,
    error: Arc<Mutex<Option<String>>>,
    thread: Option<JoinHandle<()>>,
}

impl Syncer {
    fn new(disk: Arc<dyn Disk>, wake: WakeWindow) -> Self {
        let (inbox, files) = channel::<(PathBuf, File)>();
        let error = Arc::new(Mutex::new(None));
        let shared_error = Arc::clone(&error);
        let thread = std::thread::spawn(move || {
            while let Ok(first) = files.recv() {
                let due: BTreeMap<PathBuf, File> = std::iter::once(first).chain(files.try_iter()).collect();
                let failed = due.values().find_map(|file| disk.sync(file).err());
                replace_error(&shared_error, failed.map(|error| error.to_string()), &wake);
            }
        });
        Self { inbox: Some(inbox), error, thread: Some(thread) }
    }

    fn sync(&self, path: &Path, file: &File) {
        if let (Some(inbox), Ok(file)) = (&self.inbox, file.try_clone()) {
            let _ = inbox.send((path.to_owned(), file));
        }
    }

    fn error(&self) -> Option<String> {
        self.error.lock().ok().and_then(|error| error.clone())
    }
}

impl Drop for Syncer {
    fn drop(&mut self) {
        self.inbox = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Writer {
    /// Returns a writer without a journal.
    fn new(disk: Arc<dyn Disk>, wake: WakeWindow) -> Self {
        let syncer = Syncer::new(Arc::clone(&disk), Arc::clone(&wake));
        Self { disk, path: None, file: None, pending: String::new(), syncer, wake }
    }

    /// Carries out messages until it is told to stop; leaves in `error` why the journal cannot be written.
    fn run(&mut self, messages: &Receiver<JournalMessage>, error: &Mutex<Option<String>>) {
        loop {
            let first = if self.pending.is_empty() {
                messages.recv().map_err(|_| RecvTimeoutError::Disconnected)
            } else {
                messages.recv_timeout(RETRY_INTERVAL)
            };
            let mut is_done = first.as_ref().err() == Some(&RecvTimeoutError::Disconnected);
            let mut flushes = Vec::new();
            for message in first.into_iter().chain(messages.try_iter()) {
                match message {
                    JournalMessage::Begin(path, text) => {
                        self.file = self.file.take().filter(|_| self.path.as_ref() == Some(&path));
                        (self.path, self.pending) = (Some(path), text);
                    }
                    JournalMessage::Line(line) if self.path.is_some() => {
                        self.pending.extend([line.as_str(), "\n"]);
                    }
                    JournalMessage::Line(_) => {}
                    JournalMessage::End(ending, lock) => {
                        self.end(ending);
                        drop(lock);
                    }
                    JournalMessage::Flush(reply) => flushes.push(reply),
                    JournalMessage::Stop => is_done = true,
                }
            }
            let written = self.write();
            replace_error(error, written.err().or_else(|| self.syncer.error()), &self.wake);
            for reply in flushes {
                let _ = reply.send(());
            }
            if is_done {
                return;
            }
        }
    }

    fn end(&mut self, ending: JournalEnding) {
        let _ = if ending == JournalEnding::Keep { self.write() } else { Ok(()) };
        if let (Some(path), JournalEnding::Remove) = (&self.path, ending) {
            let _ = fs::remove_file(path);
        }
        (self.path, self.file) = (None, None);
        self.pending.clear();
    }

    /// Begins the file if that is due, and writes what is pending.
    fn write(&mut self) -> Result<(), String> {
        let Some(path) = &self.path else { return Ok(()) };
        match &mut self.file {
            Some(_) if self.pending.is_empty() => return Ok(()),
            Some(file) => {
                append(file, &self.pending).map_err(|error| error.to_string())?;
                self.syncer.sync(path, file);
            }
            None => {
                let begun = begin_file(self.disk.as_ref(), path, &self.pending);
                self.file = Some(begun.map_err(|error| format!("{}: {error}", path.display()))?);
            }
        }
        self.pending.clear();
        Ok(())
    }
}

/// Replaces an error, and wakes the window if it is another one.
fn replace_error(slot: &Mutex<Option<String>>, error: Option<String>, wake: &WakeWindow) {
    if let Ok(mut slot) = slot.lock()
        && *slot != error
    {
        *slot = error;
        wake();
    }
}

fn begin_file(disk: &dyn Disk, path: &Path, text: &str) -> io::Result<File> {
    write_on(disk, path, text.as_bytes())?;
    let mut file = fs::OpenOptions::new().write(true).open(path)?;
    file.seek(SeekFrom::End(0))?;
    Ok(file)
}

/// Appends a text to a file; if that fails, the file is as it was.
fn append(file: &mut File, text: &str) -> io::Result<()> {
    let end = file.stream_position()?;
    let done = file.write_all(text.as_bytes());
    if done.is_err() {
        file.set_len(end)?;
        file.seek(SeekFrom::Start(end))?;
    }
    done
}
