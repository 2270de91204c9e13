//! The journal: every edit on disk before the next one is made, so that a crash loses next to nothing.
//!
//! A journal is a file of lines: first the project's path and text as it was opened, then one command a line; where the project is
//! saved, its text stands in a line again. A thread begins, writes and removes it, and another waits for the disk: neither the
//! window nor the next edit does.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::command::Command;
use counterpoise_host::files::{Disk, write_on};

/// The first line of a journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// The project file.
    pub project: PathBuf,
    /// Its text when the journal began.
    pub text: String,
}

/// What a journal holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// Where it began.
    pub head: Head,
    /// What was done since.
    pub commands: Vec<Command>,
}

/// What the journal's thread is told.
enum Note {
    Begin(PathBuf, String),
    Line(String),
    End(Fate),
    Flush(Sender<()>),
    Stop,
}

/// What becomes of a journal that ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// Something was not saved: it comes back when the project is opened again.
    Kept,
    /// Everything is saved.
    Removed,
}

/// The journal of the project that is open; its thread carries out what it is told, one after the other.
pub struct Journal {
    inbox: Sender<Note>,
    trouble: Arc<Mutex<Option<String>>>,
    thread: Option<std::thread::JoinHandle<()>>,
}

/// Waits on another thread until everything noted so far is on disk.
#[derive(Clone)]
pub struct Flush(Sender<Note>);

impl Flush {
    /// Waits.
    pub fn wait(&self) {
        let (done, said) = channel();
        if self.0.send(Note::Flush(done)).is_ok() {
            let _ = said.recv();
        }
    }
}

/// The journal's file for a project: one a project, in the studio's own folder.
pub fn path_for(folder: &Path, project: &Path) -> PathBuf {
    let whole = project.canonicalize().unwrap_or_else(|_| project.to_owned());
    let sum = whole.to_string_lossy().bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    folder.join(format!("journal-{sum:016x}.jsonl"))
}

impl Journal {
    /// A journal of nothing yet.
    pub fn new(disk: Arc<dyn Disk>) -> Self {
        let (inbox, notes) = channel();
        let trouble = Arc::new(Mutex::new(None));
        let told = Arc::clone(&trouble);
        let thread = std::thread::spawn(move || Writer::new(disk).run(&notes, &told));
        Self { inbox, trouble, thread: Some(thread) }
    }

    /// Begins in the place of what stands at a path, or goes on from here in the journal that stands there, with the edits that are
    /// already made.
    pub fn begin(&self, path: &Path, head: &Head, already: &[Command]) {
        let lines = already.iter().filter_map(|command| serde_json::to_string(command).ok());
        let text: String =
            serde_json::to_string(head).into_iter().chain(lines).map(|line| line + "\n").collect();
        let _ = self.inbox.send(Note::Begin(path.to_owned(), text));
    }

    /// Notes a command.
    pub fn note(&self, command: &Command) {
        if let Ok(line) = serde_json::to_string(command) {
            let _ = self.inbox.send(Note::Line(line));
        }
    }

    /// Ends the journal that was begun.
    pub fn end(&self, fate: Fate) {
        let _ = self.inbox.send(Note::End(fate));
    }

    /// Waits for it on another thread.
    pub fn flush(&self) -> Flush {
        Flush(self.inbox.clone())
    }

    /// Why the journal could not be written, where it could not.
    pub fn trouble(&self) -> Option<String> {
        self.trouble.lock().ok().and_then(|told| told.clone())
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        let _ = self.inbox.send(Note::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// How long to wait before a write that failed is tried again.
const AGAIN: Duration = Duration::from_millis(500);

/// Writes what comes, at once; then waits until the disk has it. What could not be written is tried again until it can.
struct Writer {
    disk: Arc<dyn Disk>,
    /// Where the journal stands; nowhere before one is begun.
    path: Option<PathBuf>,
    /// The file, where it has been begun.
    file: Option<File>,
    /// What is not written yet; from the head on where there is no file.
    waiting: String,
    syncer: Syncer,
}

/// Waits for the disk, while more is written.
struct Syncer {
    inbox: Option<Sender<(PathBuf, File)>>,
    trouble: Arc<Mutex<Option<String>>>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Syncer {
    fn new(disk: Arc<dyn Disk>) -> Self {
        let (inbox, files) = channel::<(PathBuf, File)>();
        let trouble = Arc::new(Mutex::new(None));
        let told = Arc::clone(&trouble);
        let thread = std::thread::spawn(move || {
            while let Ok(first) = files.recv() {
                let due: BTreeMap<PathBuf, File> = std::iter::once(first).chain(files.try_iter()).collect();
                let failed = due.values().find_map(|file| disk.sync(file).err());
                if let Ok(mut told) = told.lock() {
                    *told = failed.map(|error| error.to_string());
                }
            }
        });
        Self { inbox: Some(inbox), trouble, thread: Some(thread) }
    }

    fn sync(&self, path: &Path, file: &File) {
        if let (Some(inbox), Ok(file)) = (&self.inbox, file.try_clone()) {
            let _ = inbox.send((path.to_owned(), file));
        }
    }

    fn trouble(&self) -> Option<String> {
        self.trouble.lock().ok().and_then(|told| told.clone())
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
    fn new(disk: Arc<dyn Disk>) -> Self {
        let syncer = Syncer::new(Arc::clone(&disk));
        Self { disk, path: None, file: None, waiting: String::new(), syncer }
    }

    fn run(&mut self, notes: &Receiver<Note>, trouble: &Mutex<Option<String>>) {
        loop {
            let first = if self.waiting.is_empty() {
                notes.recv().map_err(|_| RecvTimeoutError::Disconnected)
            } else {
                notes.recv_timeout(AGAIN)
            };
            let (mut done, mut flushed) =
                (first.as_ref().err() == Some(&RecvTimeoutError::Disconnected), Vec::new());
            for note in first.into_iter().chain(notes.try_iter()) {
                match note {
                    Note::Begin(path, text) => {
                        self.file = self.file.take().filter(|_| self.path.as_ref() == Some(&path));
                        (self.path, self.waiting) = (Some(path), text);
                    }
                    Note::Line(line) if self.path.is_some() => self.waiting.extend([line.as_str(), "\n"]),
                    Note::Line(_) => {}
                    Note::End(fate) => self.end(fate),
                    Note::Flush(reply) => flushed.push(reply),
                    Note::Stop => done = true,
                }
            }
            let written = self.write();
            if let Ok(mut told) = trouble.lock() {
                *told = written.err().or_else(|| self.syncer.trouble());
            }
            for reply in flushed {
                let _ = reply.send(());
            }
            if done {
                return;
            }
        }
    }

    fn end(&mut self, fate: Fate) {
        let _ = if fate == Fate::Kept { self.write() } else { Ok(()) };
        if let (Some(path), Fate::Removed) = (&self.path, fate) {
            let _ = fs::remove_file(path);
        }
        (self.path, self.file) = (None, None);
        self.waiting.clear();
    }

    /// Begins the file where that is due, and writes what waits.
    fn write(&mut self) -> Result<(), String> {
        let Some(path) = &self.path else { return Ok(()) };
        match &mut self.file {
            Some(_) if self.waiting.is_empty() => return Ok(()),
            Some(file) => {
                append(file, &self.waiting).map_err(|error| error.to_string())?;
                self.syncer.sync(path, file);
            }
            None => {
                let begun = begin(self.disk.as_ref(), path, &self.waiting);
                self.file = Some(begun.map_err(|error| format!("{}: {error}", path.display()))?);
            }
        }
        self.waiting.clear();
        Ok(())
    }
}

fn begin(disk: &dyn Disk, path: &Path, text: &str) -> io::Result<File> {
    write_on(disk, path, text.as_bytes())?;
    let mut file = fs::OpenOptions::new().write(true).open(path)?;
    file.seek(SeekFrom::End(0))?;
    Ok(file)
}

/// Appends a text to a file; it is as it was where that fails.
fn append(file: &mut File, text: &str) -> io::Result<()> {
    let end = file.stream_position()?;
    let done = file.write_all(text.as_bytes());
    if done.is_err() {
        file.set_len(end)?;
        file.seek(SeekFrom::Start(end))?;
    }
    done
}

/// Reads a journal; a last line that is cut off is left out. `None` if there is no journal or nothing was done.
pub fn recover(path: &Path) -> Option<Recovered> {
    let mut lines = BufReader::new(File::open(path).ok()?).lines().map_while(Result::ok);
    let mut head: Head = serde_json::from_str(&lines.next()?).ok()?;
    let mut commands: Vec<Command> = Vec::new();
    for line in lines {
        if let Ok(command) = serde_json::from_str(&line) {
            commands.push(command);
        } else if let Ok(saved) = serde_json::from_str(&line) {
            head = saved;
            commands.clear();
        } else {
            break;
        }
    }
    (!commands.is_empty()).then_some(Recovered { head, commands })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn what_was_noted_is_recovered_and_a_torn_line_is_left_out() {
        let folder = std::env::temp_dir().join(format!("counterpoise-journal-{}", std::process::id()));
        let path = path_for(&folder, Path::new("rig.toml"));
        let head = Head { project: "rig.toml".into(), text: "[plant]\n".to_owned() };
        let journal = Journal::new(Arc::new(counterpoise_host::files::Native));
        journal.begin(&path, &head, &[]);
        journal.note(&Command::Undo);
        journal.note(&Command::SetText { path: "plant.name".to_owned(), value: "x".to_owned() });
        drop(journal);
        fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"{\"set\":{\"pa").unwrap();
        let found = recover(&path).unwrap();
        assert_eq!(found.head, head);
        assert_eq!(found.commands.len(), 2);
        let journal = Journal::new(Arc::new(counterpoise_host::files::Native));
        journal.begin(&path, &head, &found.commands);
        journal.flush().wait();
        assert_eq!(recover(&path).unwrap(), found);
        let later = Head { text: "[plant]\nname = \"x\"\n".to_owned(), ..head };
        journal.begin(&path, &later, &[]);
        journal.flush().wait();
        assert_eq!(recover(&path), None, "all of it is saved");
        journal.note(&Command::Redo);
        journal.flush().wait();
        assert_eq!(recover(&path).unwrap(), Recovered { head: later, commands: vec![Command::Redo] });
        journal.end(Fate::Removed);
        drop(journal);
        assert!(!path.exists());
        fs::remove_dir_all(folder).unwrap();
    }
}
