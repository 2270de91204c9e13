//! The state of the file browser: one typed path, and what stands there.
//!
//! The path is all there is: what comes before its last separator is the folder that is listed, and what comes after it narrows the
//! list.

use std::path::{MAIN_SEPARATOR, Path, PathBuf};

use counterpoise_host::files::PROJECT_FILE;

use crate::command::{BrowsePurpose, Command};
use crate::jobs::folder_listing::{FolderListing, ListingRequest};
use counterpoise_host::folders::{FolderItem, ItemKind};

/// A path that is typed or clicked together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Browser {
    /// Kind of file or folder that the user is asked for.
    pub purpose: BrowsePurpose,
    /// The path.
    pub typed: String,
    /// The item that the arrow keys have selected.
    pub selected: Option<usize>,
    /// Recordings that are ticked.
    pub picked: Vec<PathBuf>,
    /// The content of the folder.
    pub listing: Option<FolderListing>,
    /// `true` if the text was set by a click, so that the cursor belongs at its end.
    pub is_text_replaced: bool,
}

/// Action of the browser's button.
#[derive(Debug, Clone, PartialEq)]
pub struct BrowserAction {
    /// The words on the button.
    pub label: String,
    /// The command.
    pub command: Command,
}

impl BrowserAction {
    fn new(label: impl Into<String>, command: Command) -> Self {
        Self { label: label.into(), command }
    }

    /// Returns whether the action replaces a file that exists; Enter alone does not do that.
    pub fn is_replacement(&self) -> bool {
        self.label == REPLACE
    }
}

const REPLACE: &str = "Replace";

impl Browser {
    /// Opens a browser at a path: inside it if it is a folder, with its name if it is a file.
    pub fn new(purpose: BrowsePurpose, start: &Path) -> Self {
        let mut browser = Self {
            purpose,
            typed: String::new(),
            selected: None,
            picked: Vec::new(),
            listing: None,
            is_text_replaced: true,
        };
        browser.set_path(start);
        browser
    }

    /// Sets the path; a folder is entered.
    pub fn set_path(&mut self, path: &Path) {
        self.typed = path.display().to_string();
        if path.is_dir() && !self.typed.ends_with(MAIN_SEPARATOR) {
            self.typed.push(MAIN_SEPARATOR);
        }
        (self.selected, self.is_text_replaced) = (None, true);
    }

    /// Returns the typed path; a relative one starts at the current folder.
    pub fn path(&self) -> PathBuf {
        let typed = self.typed.trim();
        let whole = match (typed.strip_prefix("~/"), std::env::var_os("HOME")) {
            (Some(rest), Some(home)) => PathBuf::from(home).join(rest),
            _ => PathBuf::from(typed),
        };
        if whole.is_absolute() { whole } else { std::env::current_dir().unwrap_or_default().join(whole) }
    }

    /// Returns the folder that is listed.
    pub fn folder(&self) -> PathBuf {
        let path = self.path();
        if self.is_inside() { path } else { path.parent().map_or_else(PathBuf::new, Path::to_owned) }
    }

    /// Returns the listing that the browser needs.
    pub fn wanted_listing(&self) -> ListingRequest {
        ListingRequest { folder: self.folder(), purpose: self.purpose }
    }

    /// Returns the text that narrows the list, in lower case.
    pub fn search_text(&self) -> String {
        let name = self.path().file_name().map(|n| n.to_string_lossy().to_lowercase());
        if self.is_inside() { String::new() } else { name.unwrap_or_default() }
    }

    /// Returns whether the path is a folder whose content is shown.
    fn is_inside(&self) -> bool {
        let typed = self.typed.trim();
        typed.is_empty() || typed.ends_with(MAIN_SEPARATOR) || typed.ends_with('/')
    }

    /// Returns the items that the list shows: those whose name contains the typed text; hidden files only if a dot is typed.
    pub fn visible_items(&self) -> Vec<&FolderItem> {
        let text = self.search_text();
        // the name of a file to be written is no search
        let is_search =
            !matches!(self.purpose, BrowsePurpose::SaveAs | BrowsePurpose::PlotFile | BrowsePurpose::Report);
        let fits = |item: &&FolderItem| {
            let name = item.name.to_lowercase();
            (!is_search || name.contains(&text)) && (text.starts_with('.') || !name.starts_with('.'))
        };
        let listing = self.listing.iter().filter(|l| l.request.folder == self.folder());
        listing.filter_map(|l| l.items.as_ref().ok()).flatten().filter(fits).collect()
    }

    /// Returns why the folder cannot be listed.
    pub fn error(&self) -> Option<&str> {
        let listing = self.listing.as_ref().filter(|l| l.request.folder == self.folder())?;
        listing.items.as_ref().err().map(String::as_str)
    }

    /// Returns whether the folder of the path has been listed.
    pub fn is_listed(&self) -> bool {
        self.listing.as_ref().is_some_and(|l| l.request == self.wanted_listing())
    }

    /// Returns the kind of what the path leads to, or `None` if there is nothing.
    fn kind(&self) -> Option<ItemKind> {
        let listing = self.listing.as_ref().filter(|_| self.is_listed())?;
        let items = listing.items.as_ref().ok()?;
        if self.is_inside() {
            let is_project = listing.files.contains(PROJECT_FILE);
            return Some(if is_project { ItemKind::Project } else { ItemKind::Folder });
        }
        let name = self.path().file_name()?.to_string_lossy().into_owned();
        let listed = items.iter().find(|item| item.name == name).map(|item| item.kind);
        listed.or_else(|| listing.files.contains(&name).then_some(ItemKind::File))
    }

    /// Goes one folder up.
    pub fn go_up(&mut self) {
        let folder = self.folder();
        if let Some(above) = folder.parent() {
            let above = above.to_owned();
            self.set_path(&above);
        }
    }

    /// Moves the selection by some rows; 0 leaves it.
    pub fn move_selection(&mut self, rows: isize) {
        if rows == 0 {
            return;
        }
        let last = self.visible_items().len().checked_sub(1);
        let next = self.selected.map_or(if rows > 0 { 0 } else { isize::MAX }, |k| k as isize + rows);
        self.selected = last.map(|last| next.clamp(0, last as isize) as usize);
    }

    /// Activates an item that was clicked or entered: enters a folder, ticks a recording, or returns a command.
    pub fn activate(&mut self, item: &FolderItem) -> Option<Command> {
        match (self.purpose, item.kind) {
            (BrowsePurpose::Project, ItemKind::Project | ItemKind::File) => {
                return Some(Command::Open { path: item.path.clone() });
            }
            (BrowsePurpose::Recordings, ItemKind::File) => self.toggle_pick(&item.path),
            (_, ItemKind::Project | ItemKind::Folder | ItemKind::File) => self.set_path(&item.path),
        }
        None
    }

    /// Ticks a recording, or removes the tick.
    pub fn toggle_pick(&mut self, path: &Path) {
        match self.picked.iter().position(|p| p == path) {
            Some(k) => drop(self.picked.remove(k)),
            None => self.picked.push(path.to_owned()),
        }
    }

    /// Returns what the button does, or why nothing can be done with the path.
    pub fn action(&self) -> Result<BrowserAction, &'static str> {
        let path = self.path();
        let has_text = !self.typed.trim().is_empty();
        let kind = self.kind();
        match self.purpose {
            BrowsePurpose::Recordings => self.recordings_action(),
            _ if has_text && !self.is_listed() => Err("reading the folder"),
            BrowsePurpose::Project
                if has_text && matches!(kind, Some(ItemKind::Project | ItemKind::File)) =>
            {
                Ok(BrowserAction::new("Open", Command::Open { path }))
            }
            BrowsePurpose::Project => Err("choose a project, or type the name of a folder for a new one"),
            BrowsePurpose::SaveAs if has_text => self.save_as_action(path),
            BrowsePurpose::SaveAs => Err("type the name of a folder, or of a file that ends in .toml"),
            BrowsePurpose::Export if kind == Some(ItemKind::File) => {
                Err("this is a file; the code goes into a folder")
            }
            BrowsePurpose::Export if has_text => {
                Ok(BrowserAction::new("Export here", Command::ExportTo { folder: path }))
            }
            BrowsePurpose::Export => Err("choose a folder, or type the name of a new one"),
            BrowsePurpose::PlotFile => self.file_action(
                &path,
                &["svg", "png", "csv"],
                "type a file name that ends in .svg, .png or .csv",
                Command::SavePlot { path: path.clone() },
            ),
            BrowsePurpose::Report => self.file_action(
                &path,
                &["html"],
                "type a file name that ends in .html",
                Command::WriteReport { path: path.clone() },
            ),
        }
    }

    fn save_as_action(&self, path: PathBuf) -> Result<BrowserAction, &'static str> {
        let is_file = path.extension().is_some_and(|e| e == "toml") && !self.is_inside();
        let is_replacement = match self.kind() {
            Some(ItemKind::Project | ItemKind::Folder) if is_file => {
                return Err("this is a folder; give a file that ends in .toml");
            }
            Some(ItemKind::File) if !is_file => return Err("this is a file that does not end in .toml"),
            Some(ItemKind::Project | ItemKind::File) => true,
            Some(ItemKind::Folder) | None => false,
        };
        let file = if is_file { path } else { path.join(PROJECT_FILE) };
        let label = if is_replacement { REPLACE } else { "Save" };
        Ok(BrowserAction::new(label, Command::SaveAs { path: file }))
    }

    /// Returns the action that writes a file with one of some endings.
    fn file_action(
        &self,
        path: &Path,
        endings: &[&str],
        advice: &'static str,
        command: Command,
    ) -> Result<BrowserAction, &'static str> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let is_known = ending.is_some_and(|e| endings.contains(&e.as_str()));
        match self.kind() {
            _ if !is_known || self.is_inside() => Err(advice),
            Some(ItemKind::Project | ItemKind::Folder) => Err("this is a folder; type a file name"),
            Some(ItemKind::File) => Ok(BrowserAction::new(REPLACE, command)),
            None => Ok(BrowserAction::new("Save", command)),
        }
    }

    /// Returns the ticked recordings as a command; without a tick, all recordings in the list.
    fn recordings_action(&self) -> Result<BrowserAction, &'static str> {
        let listed =
            || self.visible_items().into_iter().filter(|i| i.kind == ItemKind::File).map(|i| i.path.clone());
        let paths: Vec<PathBuf> =
            if self.picked.is_empty() { listed().collect() } else { self.picked.clone() };
        let label = match (paths.len(), self.picked.len()) {
            (0, _) => return Err("no recording here (CSV, Parquet, MATLAB, HDF5, NumPy)"),
            (1, _) => "Add this recording".to_owned(),
            (count, 0) => format!("Add all {count}"),
            (_, count) => format!("Add {count} recordings"),
        };
        Ok(BrowserAction::new(label, Command::Recordings { paths }))
    }

    /// Returns the folder for a new project: the typed one, if it holds none.
    pub fn new_project_folder(&self) -> Option<PathBuf> {
        let is_free = self.is_listed() && matches!(self.kind(), None | Some(ItemKind::Folder));
        let has_text = !self.typed.trim().is_empty();
        (self.purpose == BrowsePurpose::Project && has_text && is_free).then(|| self.path())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::jobs::folder_listing::list_folder;

    fn machines() -> PathBuf {
        let folder = std::env::temp_dir().join(format!("counterpoise-browser-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        for name in ["turret", "crane", ".hidden", "empty"] {
            std::fs::create_dir_all(folder.join(name)).unwrap();
        }
        std::fs::write(folder.join("turret").join(PROJECT_FILE), "").unwrap();
        for name in ["a.csv", "b.MAT", "notes.txt", "other.toml", "c.h5"] {
            std::fs::write(folder.join(name), "12345").unwrap();
        }
        folder
    }

    fn listing(folder: &Path, purpose: BrowsePurpose) -> Option<FolderListing> {
        Some(list_folder(ListingRequest { folder: folder.to_owned(), purpose }))
    }

    fn names(browser: &Browser) -> Vec<&str> {
        browser.visible_items().iter().map(|item| item.name.as_str()).collect()
    }

    #[test]
    fn a_folder_shows_what_serves_and_typing_narrows_it() {
        let folder = machines();
        let mut browser = Browser::new(BrowsePurpose::Project, &folder);
        browser.listing = listing(&folder, BrowsePurpose::Project);
        assert_eq!(names(&browser), ["turret", "crane", "empty", "other.toml"]);
        browser.typed.push_str("cr");
        assert_eq!(names(&browser), ["crane"]);
        assert_eq!(browser.new_project_folder(), Some(folder.join("cr")));
        browser.typed = folder.join("notes.txt").display().to_string();
        assert_eq!(browser.new_project_folder(), None, "a file is there");
        browser.typed = folder.join("turret").display().to_string();
        assert_eq!((browser.action().unwrap().label.as_str(), browser.new_project_folder()), ("Open", None));
        browser.typed = format!("{}/elsewhere/", folder.display());
        assert_eq!(browser.action(), Err("reading the folder"));
        browser.listing = listing(&folder, BrowsePurpose::Recordings);
        (browser.purpose, browser.typed) = (BrowsePurpose::Recordings, format!("{}/", folder.display()));
        assert_eq!(names(&browser)[3..], ["a.csv", "b.MAT", "c.h5"]);
        assert_eq!(browser.action().unwrap().label, "Add all 3");
        browser.toggle_pick(&folder.join("a.csv"));
        let paths = vec![folder.join("a.csv")];
        assert_eq!(browser.action().unwrap().command, Command::Recordings { paths });
        browser.listing = listing(&folder, BrowsePurpose::PlotFile);
        (browser.purpose, browser.typed) =
            (BrowsePurpose::PlotFile, folder.join("a.csv").display().to_string());
        assert!(browser.action().unwrap().is_replacement());
        browser.typed = folder.join("loop").display().to_string();
        assert!(browser.action().is_err(), "the ending is missing");
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn the_selection_stays_in_the_list_and_a_missing_folder_is_reported() {
        let folder = std::env::temp_dir().join("counterpoise-no-such-folder");
        let mut browser = Browser::new(BrowsePurpose::Export, &folder.join("deeper"));
        browser.listing = listing(&folder, BrowsePurpose::Export);
        assert!(browser.error().is_some() && browser.visible_items().is_empty());
        browser.move_selection(1);
        assert_eq!(browser.selected, None);
        assert_eq!(browser.action().unwrap().command, Command::ExportTo { folder: folder.join("deeper") });
        browser.go_up();
        assert_eq!(browser.folder(), std::env::temp_dir());
    }
}
