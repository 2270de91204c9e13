//! The journal: every edit is on disk before the next one is made, so that a crash loses next to nothing.
//!
//! A journal is a file of lines. The first line holds the project's path and its text as it was opened; then there is one command on
//! each line. When the project is saved, its path and text stand on a line again. One thread begins, writes and removes the file, and
//! another waits for the disk ([`counterpoise_host::journal_writer`]): neither the window nor the next edit does.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};

use counterpoise_host::files::Disk;
use counterpoise_host::journal_writer::{JournalEnding, JournalMessage, JournalThread, spawn_journal_writer};
use counterpoise_host::journals::journal_lines;
use counterpoise_host::project_lock::ProjectLock;
use counterpoise_host::worker::WakeWindow;
use serde::{Deserialize, Serialize};

use crate::command::Command;

/// The first line of a journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JournalHeader {
    /// The project file.
    pub project: PathBuf,
    /// Text when the journal began.
    pub text: String,
}

/// The content of a journal.
#[derive(Debug, Clone, PartialEq)]
pub struct RecoveredJournal {
    /// The project as it was opened or saved last.
    pub header: JournalHeader,
    /// The edits since then.
    pub commands: Vec<Command>,
}

/// The journal of the open project; its thread carries out messages one after the other.
pub struct Journal {
    inbox: Sender<JournalMessage>,
    error: Arc<Mutex<Option<String>>>,
    thread: Option<JournalThread>,
}

/// Waits on another thread until everything that was appended so far is on disk.
#[derive(Clone)]
pub struct JournalFlush(Sender<JournalMessage>);

impl JournalFlush {
    /// Waits.
    pub fn wait(&self) {
        let (done, answer) = channel();
        if self.0.send(JournalMessage::Flush(done)).is_ok() {
            let _ = answer.recv();
        }
    }
}

impl Journal {
    /// Starts the journal's thread; there is no file before [`Journal::begin`].
    /// `wake` is called when an error appears or goes.
    pub fn new(disk: Arc<dyn Disk>, wake: WakeWindow) -> Self {
        let (inbox, messages) = channel();
        let error = Arc::new(Mutex::new(None));
        let thread = spawn_journal_writer(disk, wake, messages, Arc::clone(&error));
        Self { inbox, error, thread: Some(thread) }
    }

    /// Begins a journal with the edits that were already made. A journal that this studio writes at the same path goes on from here;
    /// any other file there is replaced.
    pub fn begin(&self, path: &Path, header: &JournalHeader, already: &[Command]) {
        let lines = already.iter().filter_map(|command| serde_json::to_string(command).ok());
        let text: String =
            serde_json::to_string(header).into_iter().chain(lines).map(|line| line + "\n").collect();
        let _ = self.inbox.send(JournalMessage::Begin(path.to_owned(), text));
    }

    /// Appends a command.
    pub fn append(&self, command: &Command) {
        if let Ok(line) = serde_json::to_string(command) {
            let _ = self.inbox.send(JournalMessage::Line(line));
        }
    }

    /// Ends the journal that was begun, and then the lock of its project: another window reads a complete journal.
    pub fn end(&self, ending: JournalEnding, lock: Option<ProjectLock>) {
        let _ = self.inbox.send(JournalMessage::End(ending, lock));
    }

    /// Returns what waits for the disk on another thread.
    pub fn flush(&self) -> JournalFlush {
        JournalFlush(self.inbox.clone())
    }

    /// Returns why the journal cannot be written, or `None` if it can.
    pub fn error(&self) -> Option<String> {
        self.error.lock().ok().and_then(|error| error.clone())
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        let _ = self.inbox.send(JournalMessage::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Reads a journal; a last line that is cut off is left out. Returns `None` if there is no journal or it holds no edits.
pub fn recover_journal(path: &Path) -> Option<RecoveredJournal> {
    let mut lines = journal_lines(path)?;
    let mut header: JournalHeader = serde_json::from_str(&lines.next()?).ok()?;
    let mut commands: Vec<Command> = Vec::new();
    for line in lines {
        if let Ok(command) = serde_json::from_str(&line) {
            commands.push(command);
        } else if let Ok(saved) = serde_json::from_str(&line) {
            header = saved;
            commands.clear();
        } else {
            break;
        }
    }
    (!commands.is_empty()).then_some(RecoveredJournal { header, commands })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use counterpoise_host::files::NativeDisk;
    use counterpoise_host::journals::journal_path;
    use std::fs;
    use std::io::Write;

    #[test]
    fn appended_commands_are_recovered_and_a_torn_line_is_left_out() {
        let folder = std::env::temp_dir().join(format!("counterpoise-journal-{}", std::process::id()));
        let path = journal_path(&folder, Path::new("rig.toml"));
        let header = JournalHeader { project: "rig.toml".into(), text: "[plant]\n".to_owned() };
        let journal = Journal::new(Arc::new(NativeDisk), Arc::new(|| {}));
        journal.begin(&path, &header, &[]);
        journal.append(&Command::Undo);
        journal.append(&Command::SetText { path: "plant.name".to_owned(), value: "x".to_owned() });
        drop(journal);
        fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"{\"set\":{\"pa").unwrap();
        let found = recover_journal(&path).unwrap();
        assert_eq!(found.header, header);
        assert_eq!(found.commands.len(), 2);
        let journal = Journal::new(Arc::new(NativeDisk), Arc::new(|| {}));
        journal.begin(&path, &header, &found.commands);
        journal.flush().wait();
        assert_eq!(recover_journal(&path).unwrap(), found);
        let later = JournalHeader { text: "[plant]\nname = \"x\"\n".to_owned(), ..header };
        journal.begin(&path, &later, &[]);
        journal.flush().wait();
        assert_eq!(recover_journal(&path), None, "all of it is saved");
        journal.append(&Command::Redo);
        journal.flush().wait();
        let expected = RecoveredJournal { header: later, commands: vec![Command::Redo] };
        assert_eq!(recover_journal(&path).unwrap(), expected);
        journal.end(JournalEnding::Remove, None);
        drop(journal);
        assert!(!path.exists());
        fs::remove_dir_all(folder).unwrap();
    }
}
