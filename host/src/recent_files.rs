//! Projects and folders that were used before, in two small files that a thread reads and writes; the window never waits for them.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use crate::files::{Disk, write_on};

/// Length of a list: what fits into the window beside the browser.
const LONGEST: usize = 8;

/// A list of paths, the last one used first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecentList {
    /// Projects that were opened.
    Projects,
    /// Folders that recordings were taken from or that files were written to.
    Folders,
}

impl RecentList {
    const ALL: [RecentList; 2] = [RecentList::Projects, RecentList::Folders];

    fn file(self, state: &Path) -> PathBuf {
        state.join(match self {
            RecentList::Projects => "recent.json",
            RecentList::Folders => "folders.json",
        })
    }
}

/// A path that was used, for the head of a list.
#[derive(Debug)]
struct Addition {
    list: RecentList,
    path: PathBuf,
}

type SharedLists = Arc<Mutex<[Vec<PathBuf>; 2]>>;

/// The lists, with the thread that keeps them on disk.
#[derive(Debug)]
pub struct RecentFiles {
    lists: SharedLists,
    inbox: Option<Sender<Addition>>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl RecentFiles {
    /// Starts the thread on the folder with the studio's own files; the lists are empty until they are read.
    pub fn new(state: &Path, disk: Arc<dyn Disk>) -> Self {
        let (inbox, additions) = channel();
        let lists = SharedLists::default();
        let (shared, state) = (Arc::clone(&lists), state.to_owned());
        let thread = std::thread::spawn(move || keep_lists(&state, disk.as_ref(), &shared, &additions));
        Self { lists, inbox: Some(inbox), thread: Some(thread) }
    }

    /// Returns a list, as far as it is known.
    pub fn paths(&self, list: RecentList) -> Vec<PathBuf> {
        self.lists.lock().map(|lists| lists[list as usize].clone()).unwrap_or_default()
    }

    /// Puts a path at the head of a list. An error of the disk is ignored: the list is a convenience.
    pub fn add(&self, list: RecentList, path: &Path) {
        if let Some(inbox) = &self.inbox {
            let _ = inbox.send(Addition { list, path: path.to_owned() });
        }
    }
}

impl Drop for RecentFiles {
    fn drop(&mut self) {
        self.inbox = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn keep_lists(state: &Path, disk: &dyn Disk, lists: &SharedLists, additions: &Receiver<Addition>) {
    let read = |list: RecentList| -> Vec<PathBuf> {
        let bytes = disk.read(&list.file(state)).ok();
        bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
    };
    let publish = |list: RecentList, all: &[PathBuf]| {
        if let Ok(mut lists) = lists.lock() {
            lists[list as usize] = all.to_vec();
        }
    };
    RecentList::ALL.into_iter().for_each(|list| publish(list, &read(list)));
    for Addition { list, path } in additions {
        let whole = path.canonicalize().unwrap_or(path);
        let mut all = read(list);
        all.retain(|path| *path != whole);
        all.insert(0, whole);
        all.truncate(LONGEST);
        publish(list, &all);
        if let Ok(bytes) = serde_json::to_vec(&all) {
            let _ = write_on(disk, &list.file(state), &bytes);
        }
    }
}
