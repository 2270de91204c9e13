//! The contents of a folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::files::PROJECT_FILE;

/// The kind of an item in a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ItemKind {
    /// A folder with a project in it.
    Project,
    /// Another folder.
    Folder,
    /// A file.
    File,
}

/// A file or folder in a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderItem {
    /// Kind.
    pub kind: ItemKind,
    /// Name.
    pub name: String,
    /// Path.
    pub path: PathBuf,
    /// Size of a file in bytes.
    pub bytes: u64,
}

/// Returns the files and folders in a folder, in no order; those that cannot be looked at are left out.
///
/// # Errors
/// Those of the file system.
pub fn folder_items(folder: &Path) -> io::Result<Vec<FolderItem>> {
    Ok(fs::read_dir(folder)?.filter_map(|entry| folder_item(entry.ok()?.path())).collect())
}

fn folder_item(path: PathBuf) -> Option<FolderItem> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let metadata = fs::metadata(&path).ok()?;
    let kind = match metadata.is_dir() {
        true if path.join(PROJECT_FILE).is_file() => ItemKind::Project,
        true => ItemKind::Folder,
        false => ItemKind::File,
    };
    Some(FolderItem { kind, name, bytes: if kind == ItemKind::File { metadata.len() } else { 0 }, path })
}
