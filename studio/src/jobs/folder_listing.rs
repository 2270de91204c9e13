//! The content of a folder, as far as it serves a purpose.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use counterpoise_host::files::is_recording;
use counterpoise_host::folders::{FolderItem, ItemKind, folder_items};

use super::history_file::is_history;
use crate::command::BrowsePurpose;

/// The folder to list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListingRequest {
    /// The folder.
    pub folder: PathBuf,
    /// Kind of file or folder that the user is asked for.
    pub purpose: BrowsePurpose,
}

/// Entries of a folder that serve a purpose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderListing {
    /// Request.
    pub request: ListingRequest,
    /// Folders first, each kind by name; or why the folder cannot be listed.
    pub items: Result<Vec<FolderItem>, String>,
    /// Names of all files in the folder.
    pub files: BTreeSet<String>,
}

/// Lists a folder: its folders, and the files that serve the purpose.
pub fn list_folder(request: ListingRequest) -> FolderListing {
    let folder = &request.folder;
    let found = folder_items(folder).map_err(|error| format!("{}: {error}", folder.display()));
    let mut files = BTreeSet::new();
    let items = found.map(|mut items| {
        files.extend(items.iter().filter(|i| i.kind == ItemKind::File).map(|i| i.name.clone()));
        items.retain(|item| serves(item, request.purpose));
        items.sort_by_cached_key(|item| (item.kind, item.name.to_lowercase()));
        items
    });
    FolderListing { request, items, files }
}

fn serves(item: &FolderItem, purpose: BrowsePurpose) -> bool {
    let has_ending = |ending: &str| Path::new(&item.name).extension().is_some_and(|e| e == ending);
    item.kind != ItemKind::File
        || match purpose {
            BrowsePurpose::Project | BrowsePurpose::SaveAs => has_ending("toml") && !is_history(&item.path),
            BrowsePurpose::Recordings => is_recording(&item.path),
            BrowsePurpose::Export => false,
            BrowsePurpose::PlotFile => ["svg", "png", "csv"].into_iter().any(has_ending),
            BrowsePurpose::Report => has_ending("html"),
        }
}
