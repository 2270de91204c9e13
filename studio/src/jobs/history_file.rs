//! The file with the history of designs, read and written beside the project.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use counterpoise_host::files::{Disk, read_file, write_on};
use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};

/// Work on the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum HistoryJob {
    /// Reads it.
    Read {
        /// The file.
        path: PathBuf,
    },
    /// Writes it, unless another program has changed it.
    Write {
        /// The file.
        path: PathBuf,
        /// The contents that this window has read or written; an empty one if there was no file.
        known: Vec<String>,
        /// The new content.
        text: String,
    },
}

/// The content of the file after a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryFile {
    /// The file.
    pub path: PathBuf,
    /// Its content, empty if there is no file; or why it cannot be read.
    pub content: Result<String, String>,
    /// The outcome of the job.
    pub outcome: HistoryOutcome,
}

/// Outcome of a job on the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum HistoryOutcome {
    /// The file was read.
    Read,
    /// The file was written.
    Written,
    /// Nothing was written, for this reason.
    NotWritten(String),
}

/// Returns the file with the history of the designs of a project.
pub fn history_path(project: &Path) -> PathBuf {
    project.with_extension("designs.toml")
}

/// Returns whether a file is the history of the designs of a project.
pub fn is_history(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(".designs.toml"))
}

/// Reads and writes the file.
pub type HistoryWorker = BackgroundWorker<HistoryJob, HistoryFile>;

/// Returns a worker that reads and writes the file on a disk.
pub fn history_worker(wake: &WakeWindow, disk: Arc<dyn Disk>) -> HistoryWorker {
    BackgroundWorker::new(Arc::clone(wake), move |job, _: &CancelToken| run_history_job(job, disk.as_ref()))
}

/// Carries out a job on a disk.
pub fn run_history_job(job: HistoryJob, disk: &dyn Disk) -> HistoryFile {
    match job {
        HistoryJob::Read { path } => {
            HistoryFile { content: read_content(&path), path, outcome: HistoryOutcome::Read }
        }
        HistoryJob::Write { path, known, text } => {
            let found = read_content(&path);
            let changed =
                "another program has changed the file, whose designs are shown as they are now; do it again";
            let failure = match &found {
                Ok(found) if !known.contains(found) => Some(changed.to_owned()),
                Ok(_) => write_on(disk, &path, text.as_bytes()).err().map(|error| error.to_string()),
                Err(why) => Some(why.clone()),
            };
            match failure {
                None => HistoryFile { path, content: Ok(text), outcome: HistoryOutcome::Written },
                Some(why) => HistoryFile { path, content: found, outcome: HistoryOutcome::NotWritten(why) },
            }
        }
    }
}

/// Returns the content of a file; a file that is not there is empty.
fn read_content(path: &Path) -> Result<String, String> {
    match read_file(path) {
        Ok(bytes) => String::from_utf8(bytes)
            .map_err(|error| format!("byte {} is not UTF-8 text", error.utf8_error().valid_up_to())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(String::new()),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use counterpoise_host::files::NativeDisk;

    #[test]
    fn a_file_that_another_program_has_changed_is_not_overwritten() {
        let folder = counterpoise_host::files::scratch_folder().unwrap();
        let path = history_path(&folder.path().join("rig.toml"));
        assert!(path.ends_with("rig.designs.toml") && is_history(&path));
        let write = |known: &[&str], text: &str| {
            let known = known.iter().map(|text| (*text).to_owned()).collect();
            run_history_job(
                HistoryJob::Write { path: path.clone(), known, text: text.to_owned() },
                &NativeDisk,
            )
        };
        assert_eq!(write(&[""], "one").outcome, HistoryOutcome::Written);
        assert_eq!(write(&["zero", "one"], "two").content.unwrap(), "two");
        std::fs::write(&path, "theirs").unwrap();
        let refused = write(&["one", "two"], "three");
        assert!(matches!(refused.outcome, HistoryOutcome::NotWritten(_)));
        assert_eq!(refused.content.unwrap(), "theirs");
        std::fs::write(&path, [0xff, 0xfe]).unwrap();
        let read = run_history_job(HistoryJob::Read { path: path.clone() }, &NativeDisk);
        assert!(read.content.unwrap_err().contains("byte 0"));
        assert!(matches!(write(&[""], "four").outcome, HistoryOutcome::NotWritten(_)));
        assert_eq!(std::fs::read(&path).unwrap(), [0xff, 0xfe], "what cannot be read is not overwritten");
    }
}
