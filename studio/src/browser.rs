//! Files and folders looked through in the window: one typed path, and what stands there. The path is all there is: what comes
//! before its last separator is the folder that is listed, what comes after it narrows the list.

use std::collections::BTreeSet;
use std::path::{MAIN_SEPARATOR, Path, PathBuf};

use crate::command::{Command, Purpose};
use counterpoise_host::files::PROJECT_FILE;

/// What an item of a list is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A folder with a project in it.
    Project,
    /// Another folder.
    Folder,
    /// A file.
    File,
}

/// A file or folder that is offered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Item {
    /// What it is.
    pub kind: Kind,
    /// Its name.
    pub name: String,
    /// Where it is.
    pub path: PathBuf,
    /// Size of a file in bytes.
    pub bytes: u64,
}

/// What a folder holds, as far as it serves a purpose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listing {
    /// The folder.
    pub folder: PathBuf,
    /// For what it was looked through.
    pub purpose: Purpose,
    /// Folders first, each kind by name; or why it cannot be listed.
    pub items: Result<Vec<Item>, String>,
    /// Names of all its files, whatever they are.
    pub files: BTreeSet<String>,
}

/// A path that is typed or clicked together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Browser {
    /// For what.
    pub purpose: Purpose,
    /// The path.
    pub typed: String,
    /// Which of the shown items the arrow keys stand on.
    pub chosen: Option<usize>,
    /// Recordings that are ticked.
    pub picked: Vec<PathBuf>,
    /// What was found in the folder.
    pub listing: Option<Listing>,
    /// Whether the text was set from outside, so that its cursor belongs at the end.
    pub moved: bool,
}

/// Lists a folder: folders, and the files that serve the purpose.
pub fn list(folder: &Path, purpose: Purpose) -> Listing {
    let listed = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()));
    let mut files = BTreeSet::new();
    let items = listed.map(|entries| {
        let mut items: Vec<Item> = entries.filter_map(|entry| item(entry.ok()?.path())).collect();
        files.extend(items.iter().filter(|i| i.kind == Kind::File).map(|i| i.name.clone()));
        items.retain(|item| serves(item, purpose));
        items.sort_by_cached_key(|item| (item.kind, item.name.to_lowercase()));
        items
    });
    Listing { folder: folder.to_owned(), purpose, items, files }
}

fn item(path: PathBuf) -> Option<Item> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let about = std::fs::metadata(&path).ok()?;
    let kind = match about.is_dir() {
        true if path.join(PROJECT_FILE).is_file() => Kind::Project,
        true => Kind::Folder,
        false => Kind::File,
    };
    Some(Item { kind, name, bytes: if kind == Kind::File { about.len() } else { 0 }, path })
}

fn serves(item: &Item, purpose: Purpose) -> bool {
    item.kind != Kind::File
        || match purpose {
            Purpose::Project | Purpose::SaveAs => item.path.extension().is_some_and(|e| e == "toml"),
            Purpose::Recordings => counterpoise_host::files::is_recording(&item.path),
            Purpose::Export => false,
        }
}

impl Browser {
    /// A browser that begins at a path: in it where it is a folder, with its name where it is a file.
    pub fn new(purpose: Purpose, start: &Path) -> Self {
        let mut browser = Self {
            purpose,
            typed: String::new(),
            chosen: None,
            picked: Vec::new(),
            listing: None,
            moved: true,
        };
        browser.go(start);
        browser
    }

    /// Goes to a path; into it where it is a folder.
    pub fn go(&mut self, path: &Path) {
        self.typed = path.display().to_string();
        if path.is_dir() && !self.typed.ends_with(MAIN_SEPARATOR) {
            self.typed.push(MAIN_SEPARATOR);
        }
        (self.chosen, self.moved) = (None, true);
    }

    /// The path that is typed, from the present folder where it is not whole.
    pub fn path(&self) -> PathBuf {
        let typed = self.typed.trim();
        let whole = match (typed.strip_prefix("~/"), std::env::var_os("HOME")) {
            (Some(rest), Some(home)) => PathBuf::from(home).join(rest),
            _ => PathBuf::from(typed),
        };
        if whole.is_absolute() { whole } else { std::env::current_dir().unwrap_or_default().join(whole) }
    }

    /// The folder that is listed.
    pub fn folder(&self) -> PathBuf {
        let path = self.path();
        if self.is_inside() { path } else { path.parent().map_or_else(PathBuf::new, Path::to_owned) }
    }

    /// What narrows the list.
    pub fn start(&self) -> String {
        let name = self.path().file_name().map(|n| n.to_string_lossy().to_lowercase());
        if self.is_inside() { String::new() } else { name.unwrap_or_default() }
    }

    /// Whether the path is a folder that is looked into.
    fn is_inside(&self) -> bool {
        let typed = self.typed.trim();
        typed.is_empty() || typed.ends_with(MAIN_SEPARATOR) || typed.ends_with('/')
    }

    /// What is shown of the folder: what begins or goes on with the typed name; hidden files only where a dot is typed.
    pub fn shown(&self) -> Vec<&Item> {
        let start = self.start();
        // A name that stands in its field to be saved under is no search.
        let search = self.purpose != Purpose::SaveAs;
        let fits = |item: &&Item| {
            let name = item.name.to_lowercase();
            (!search || name.contains(&start)) && (start.starts_with('.') || !name.starts_with('.'))
        };
        let all = self.listing.iter().filter(|l| l.folder == self.folder());
        all.filter_map(|l| l.items.as_ref().ok()).flatten().filter(fits).collect()
    }

    /// Why the folder cannot be listed.
    pub fn trouble(&self) -> Option<&str> {
        let listing = self.listing.as_ref().filter(|l| l.folder == self.folder())?;
        listing.items.as_ref().err().map(String::as_str)
    }

    /// Whether the folder of the path has been listed.
    fn is_known(&self) -> bool {
        self.listing.as_ref().is_some_and(|l| l.folder == self.folder() && l.purpose == self.purpose)
    }

    /// What stands at the path, by the listing; `None` if nothing does.
    fn kind(&self) -> Option<Kind> {
        let listing = self.listing.as_ref().filter(|_| self.is_known())?;
        let items = listing.items.as_ref().ok()?;
        if self.is_inside() {
            let is_project = listing.files.contains(PROJECT_FILE);
            return Some(if is_project { Kind::Project } else { Kind::Folder });
        }
        let name = self.path().file_name()?.to_string_lossy().into_owned();
        let listed = items.iter().find(|item| item.name == name).map(|item| item.kind);
        listed.or_else(|| listing.files.contains(&name).then_some(Kind::File))
    }

    /// Goes one folder up.
    pub fn up(&mut self) {
        let folder = self.folder();
        if let Some(above) = folder.parent() {
            let above = above.to_owned();
            self.go(&above);
        }
    }

    /// Moves the choice by rows.
    pub fn step(&mut self, rows: isize) {
        let last = self.shown().len().checked_sub(1);
        let next = self.chosen.map_or(if rows > 0 { 0 } else { isize::MAX }, |k| k as isize + rows);
        self.chosen = last.map(|last| next.clamp(0, last as isize) as usize);
    }

    /// Moves the choice, where it is to be moved.
    pub fn step_if(&mut self, rows: isize) {
        if rows != 0 {
            self.step(rows);
        }
    }

    /// Takes an item that was clicked or entered: into a folder, or what it gives to do.
    pub fn take(&mut self, item: &Item) -> Option<Command> {
        match (self.purpose, item.kind) {
            (Purpose::Project, Kind::Project | Kind::File) => {
                return Some(Command::Open { path: item.path.clone() });
            }
            (Purpose::Recordings, Kind::File) => self.pick(&item.path),
            (_, Kind::Project | Kind::Folder | Kind::File) => self.go(&item.path),
        }
        None
    }

    /// Ticks a recording, or takes the tick away.
    pub fn pick(&mut self, path: &Path) {
        match self.picked.iter().position(|p| p == path) {
            Some(k) => drop(self.picked.remove(k)),
            None => self.picked.push(path.to_owned()),
        }
    }

    /// What stands ready: the words of its button with its command, or why nothing can be done with the path.
    pub fn ready(&self) -> Result<(String, Command), &'static str> {
        let path = self.path();
        let named = !self.typed.trim().is_empty();
        let kind = self.kind();
        match self.purpose {
            Purpose::Recordings => self.add(),
            _ if named && !self.is_known() => Err("looking at the folder"),
            Purpose::Project if named && matches!(kind, Some(Kind::Project | Kind::File)) => {
                Ok(("Open".to_owned(), Command::Open { path }))
            }
            Purpose::Project => Err("choose a project, or type the name of a folder for a new one"),
            Purpose::SaveAs if named => self.save_as(path),
            Purpose::SaveAs => Err("type the name of a folder, or of a file that ends in .toml"),
            Purpose::Export if kind == Some(Kind::File) => Err("this is a file; the code goes into a folder"),
            Purpose::Export if named => Ok(("Export here".to_owned(), Command::ExportTo { folder: path })),
            Purpose::Export => Err("choose a folder, or type the name of a new one"),
        }
    }

    fn save_as(&self, path: PathBuf) -> Result<(String, Command), &'static str> {
        let is_file = path.extension().is_some_and(|e| e == "toml") && !self.is_inside();
        let replaces = match self.kind() {
            Some(Kind::Project | Kind::Folder) if is_file => {
                return Err("this is a folder; give a file that ends in .toml");
            }
            Some(Kind::File) if !is_file => return Err("this is a file that does not end in .toml"),
            Some(Kind::Project | Kind::File) => true,
            Some(Kind::Folder) | None => false,
        };
        let file = if is_file { path } else { path.join(PROJECT_FILE) };
        Ok((if replaces { "Replace" } else { "Save" }.to_owned(), Command::SaveAs { path: file }))
    }

    /// The ticked recordings; where none is ticked, the one that is typed, or all of the folder.
    fn add(&self) -> Result<(String, Command), &'static str> {
        let inside = || self.shown().into_iter().filter(|i| i.kind == Kind::File).map(|i| i.path.clone());
        let paths: Vec<PathBuf> =
            if self.picked.is_empty() { inside().collect() } else { self.picked.clone() };
        let words = match (paths.len(), self.picked.len()) {
            (0, _) => return Err("no recording here (CSV, Parquet, MATLAB, HDF5)"),
            (1, _) => "Add this recording".to_owned(),
            (count, 0) => format!("Add all {count}"),
            (_, count) => format!("Add {count} recordings"),
        };
        Ok((words, Command::Recordings { paths }))
    }

    /// Where a new project would be made: a folder that holds none.
    pub fn free(&self) -> Option<PathBuf> {
        let is_free = self.is_known() && matches!(self.kind(), None | Some(Kind::Folder));
        (self.purpose == Purpose::Project && !self.typed.trim().is_empty() && is_free).then(|| self.path())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

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

    fn names(browser: &Browser) -> Vec<&str> {
        browser.shown().iter().map(|item| item.name.as_str()).collect()
    }

    #[test]
    fn a_folder_shows_what_serves_and_typing_narrows_it() {
        let folder = machines();
        let mut browser = Browser::new(Purpose::Project, &folder);
        browser.listing = Some(list(&folder, Purpose::Project));
        assert_eq!(names(&browser), ["turret", "crane", "empty", "other.toml"]);
        browser.typed.push_str("cr");
        assert_eq!(names(&browser), ["crane"]);
        assert_eq!(browser.free(), Some(folder.join("cr")));
        browser.typed = folder.join("notes.txt").display().to_string();
        assert_eq!(browser.free(), None, "a file is there");
        browser.typed = folder.join("turret").display().to_string();
        assert_eq!((browser.ready().unwrap().0.as_str(), browser.free()), ("Open", None));
        browser.typed = format!("{}/elsewhere/", folder.display());
        assert_eq!(browser.ready(), Err("looking at the folder"));
        browser.typed = format!("{}/", folder.display());
        browser.listing = Some(list(&folder, Purpose::Recordings));
        (browser.purpose, browser.typed) = (Purpose::Recordings, format!("{}/", folder.display()));
        assert_eq!(names(&browser)[3..], ["a.csv", "b.MAT", "c.h5"]);
        assert_eq!(browser.ready().unwrap().0, "Add all 3");
        browser.pick(&folder.join("a.csv"));
        let paths = vec![folder.join("a.csv")];
        assert_eq!(browser.ready().unwrap().1, Command::Recordings { paths });
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn arrows_stay_on_the_list_and_a_folder_that_is_not_there_says_so() {
        let folder = std::env::temp_dir().join("counterpoise-no-such-folder");
        let mut browser = Browser::new(Purpose::Export, &folder.join("deeper"));
        browser.listing = Some(list(&folder, Purpose::Export));
        assert!(browser.trouble().is_some() && browser.shown().is_empty());
        browser.step(1);
        assert_eq!(browser.chosen, None);
        assert_eq!(browser.ready().unwrap().1, Command::ExportTo { folder: folder.join("deeper") });
        browser.up();
        assert_eq!(browser.folder(), std::env::temp_dir());
    }
}
