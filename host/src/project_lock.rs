//! A lock on a project, so that two windows do not write one journal.
//!
//! The lock is one of the operating system on a file in the studio's own folder. It ends with the process, however that ends.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;

use crate::journals::journal_path;

/// A project that this window alone may write.
#[derive(Debug)]
pub struct ProjectLock {
    /// The locked file; `None` if the studio's folder cannot be written: then nothing is locked, and no journal is shared either.
    _file: Option<File>,
}

impl ProjectLock {
    /// Locks a project; returns `None` if another window holds the lock.
    pub fn acquire(state: &Path, project: &Path) -> Option<Self> {
        let path = journal_path(state, project).with_extension("lock");
        let _ = std::fs::create_dir_all(state);
        let Ok(file) = OpenOptions::new().create(true).truncate(false).write(true).open(path) else {
            return Some(Self { _file: None });
        };
        match file.try_lock() {
            Ok(()) => Some(Self { _file: Some(file) }),
            Err(TryLockError::WouldBlock) => None,
            Err(TryLockError::Error(_)) => Some(Self { _file: None }),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_second_lock_is_refused_until_the_first_ends() {
        let state = crate::files::scratch_folder().unwrap();
        let first = ProjectLock::acquire(state.path(), Path::new("rig.toml"));
        assert!(first.is_some());
        assert!(ProjectLock::acquire(state.path(), Path::new("rig.toml")).is_none());
        assert!(ProjectLock::acquire(state.path(), Path::new("other.toml")).is_some());
        drop(first);
        assert!(ProjectLock::acquire(state.path(), Path::new("rig.toml")).is_some());
    }
}
