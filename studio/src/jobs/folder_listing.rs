//! The content of a folder, as far as it serves a purpose.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use counterpoise_host::files::{PROJECT_FILE, is_recording};

use crate::command::BrowsePurpose;

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
    /// Its kind.
    pub kind: ItemKind,
    /// Its name.
    pub name: String,
    /// Its path.
    pub path: PathBuf,
    /// Size of a file in bytes.
    pub bytes: u64,
}

/// The folder to list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListingRequest {
    /// The folder.
    pub folder: PathBuf,
    /// What the user looks for.
    pub purpose: BrowsePurpose,
}

/// What a folder holds, as far as it serves a purpose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderListing {
    /// What was asked for.
    pub request: ListingRequest,
    /// Folders first, each kind by name; or why the folder cannot be listed.
    pub items: Result<Vec<FolderItem>, String>,
    /// Names of all files in the folder.
    pub files: BTreeSet<String>,
}

/// Lists a folder: its folders, and the files that serve the purpose.
pub fn list_folder(request: ListingRequest) -> FolderListing {
    let folder = &request.folder;
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()));
    let mut files = BTreeSet::new();
    let items = entries.map(|entries| {
        let mut items: Vec<FolderItem> =
            entries.filter_map(|entry| folder_item(entry.ok()?.path())).collect();
        files.extend(items.iter().filter(|i| i.kind == ItemKind::File).map(|i| i.name.clone()));
        items.retain(|item| serves(item, request.purpose));
        items.sort_by_cached_key(|item| (item.kind, item.name.to_lowercase()));
        items
    });
    FolderListing { request, items, files }
}

fn folder_item(path: PathBuf) -> Option<FolderItem> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let metadata = std::fs::metadata(&path).ok()?;
    let kind = match metadata.is_dir() {
        true if path.join(PROJECT_FILE).is_file() => ItemKind::Project,
        true => ItemKind::Folder,
        false => ItemKind::File,
    };
    Some(FolderItem { kind, name, bytes: if kind == ItemKind::File { metadata.len() } else { 0 }, path })
}

fn serves(item: &FolderItem, purpose: BrowsePurpose) -> bool {
    let has_ending = |ending: &str| Path::new(&item.name).extension().is_some_and(|e| e == ending);
    item.kind != ItemKind::File
        || match purpose {
            BrowsePurpose::Project | BrowsePurpose::SaveAs => has_ending("toml"),
            BrowsePurpose::Recordings => is_recording(&item.path),
            BrowsePurpose::Export => false,
            BrowsePurpose::PlotFile => ["svg", "png", "csv"].into_iter().any(has_ending),
            BrowsePurpose::Report => has_ending("html"),
        }
}
