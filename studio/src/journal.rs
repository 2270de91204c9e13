//! The journal: every edit on disk before the next one is made, so that a crash loses next to nothing.
//!
//! A journal is a file of lines: first the project's path and text as it was opened or saved, then one command a line. A thread
//! writes; the window never waits for a disk.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::command::Command;

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

/// A journal that is being written.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    lines: Option<Sender<String>>,
    trouble: Arc<Mutex<Option<String>>>,
    thread: Option<std::thread::JoinHandle<()>>,
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
    /// Begins a journal in the place of an old one, with the edits that are already made.
    ///
    /// # Errors
    /// The folder or the file cannot be written.
    pub fn begin(path: &Path, head: &Head, already: &[Command]) -> io::Result<Self> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let partial = path.with_extension("partial");
        let mut file = File::create(&partial)?;
        writeln!(file, "{}", serde_json::to_string(head)?)?;
        for command in already {
            writeln!(file, "{}", serde_json::to_string(command)?)?;
        }
        file.sync_data()?;
        fs::rename(&partial, path)?;
        let (lines, inbox) = channel();
        let trouble = Arc::new(Mutex::new(None));
        let told = Arc::clone(&trouble);
        let thread = std::thread::spawn(move || write_lines(file, &inbox, &told));
        Ok(Self { path: path.to_owned(), lines: Some(lines), trouble, thread: Some(thread) })
    }

    /// Notes a command.
    pub fn note(&self, command: &Command) {
        if let (Some(lines), Ok(line)) = (&self.lines, serde_json::to_string(command)) {
            let _ = lines.send(line);
        }
    }

    /// Why the journal could not be written, where it could not.
    pub fn trouble(&self) -> Option<String> {
        self.trouble.lock().ok().and_then(|told| told.clone())
    }

    /// Ends the journal and removes it: everything is saved.
    pub fn remove(mut self) {
        self.finish();
        let _ = fs::remove_file(&self.path);
    }

    fn finish(&mut self) {
        self.lines = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        self.finish();
    }
}

/// How long to wait before a write that failed is tried again.
const AGAIN: Duration = Duration::from_millis(500);

/// Writes what comes, at once; then waits until the disk has it. What could not be written is tried again until it can.
fn write_lines(mut file: File, inbox: &Receiver<String>, trouble: &Mutex<Option<String>>) {
    let mut waiting = String::new();
    loop {
        let first = if waiting.is_empty() {
            inbox.recv().map_err(|_| RecvTimeoutError::Disconnected)
        } else {
            inbox.recv_timeout(AGAIN)
        };
        let is_end = first == Err(RecvTimeoutError::Disconnected);
        for line in first.into_iter().chain(inbox.try_iter()) {
            waiting.push_str(&line);
            waiting.push('\n');
        }
        let done = append(&mut file, &waiting);
        if done.is_ok() {
            waiting.clear();
        }
        if let Ok(mut told) = trouble.lock() {
            *told = done.err().map(|error| error.to_string());
        }
        if is_end {
            return;
        }
    }
}

/// Appends a text to a file and waits until the disk has it; the file is as it was where that fails.
fn append(file: &mut File, text: &str) -> io::Result<()> {
    let end = file.stream_position()?;
    let done = file.write_all(text.as_bytes()).and_then(|()| file.sync_data());
    if done.is_err() {
        file.set_len(end)?;
        file.seek(SeekFrom::Start(end))?;
    }
    done
}

/// Reads a journal; a last line that is cut off is left out. None where there is no journal or nothing was done.
pub fn recover(path: &Path) -> Option<Recovered> {
    let mut lines = BufReader::new(File::open(path).ok()?).lines().map_while(Result::ok);
    let head = serde_json::from_str(&lines.next()?).ok()?;
    let commands: Vec<Command> = lines.map_while(|line| serde_json::from_str(&line).ok()).collect();
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
        let journal = Journal::begin(&path, &head, &[]).unwrap();
        journal.note(&Command::Undo);
        journal.note(&Command::SetText { path: "plant.name".to_owned(), value: "x".to_owned() });
        drop(journal);
        fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"{\"set\":{\"pa").unwrap();
        let found = recover(&path).unwrap();
        assert_eq!(found.head, head);
        assert_eq!(found.commands.len(), 2);
        fs::remove_dir_all(folder).unwrap();
    }
}
