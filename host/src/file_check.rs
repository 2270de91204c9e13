//! Checks whether another program wrote the project file, or recordings into its folder.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::files::{self, Disk};

/// Returns the time of a file's last change.
pub fn modification_time(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}

/// Returns the recordings in the folder of a project file.
pub fn recordings_beside(path: &Path) -> Vec<PathBuf> {
    path.parent().map_or(Vec::new(), |folder| files::recording_files(&[folder.to_owned()]))
}

/// A check whether another program wrote the project file.
#[derive(Debug, Clone)]
pub struct FileCheck {
    /// The file.
    pub path: PathBuf,
    /// The time of its last change, as far as it is known.
    pub modified: Option<SystemTime>,
}

/// Result of a check of a file on disk.
#[derive(Debug)]
pub struct FileCheckResult {
    /// The file.
    pub path: PathBuf,
    /// The time of its last change.
    pub modified: Option<SystemTime>,
    /// Content, if it was changed since the last check.
    pub content: Option<Vec<u8>>,
    /// Recordings in its folder.
    pub nearby_recordings: Vec<PathBuf>,
}

/// Checks a project file, and looks for recordings in its folder.
pub fn check_file(check: FileCheck, disk: &dyn Disk) -> FileCheckResult {
    let modified = modification_time(&check.path);
    let is_changed = modified.is_some() && modified != check.modified;
    let content = is_changed.then(|| disk.read(&check.path).ok()).flatten();
    let nearby_recordings = recordings_beside(&check.path);
    FileCheckResult { path: check.path, modified, content, nearby_recordings }
}
