//! Projects and folders that were used before, in two small files that a thread reads and writes; the window never waits for them.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use counterpoise_host::files::{Disk, write_on};

const MOST: usize = 8;

/// A list of paths, the last one used first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum List {
    /// Projects that were opened.
    Projects,
    /// Folders that recordings were taken from or code was exported to.
    Folders,
}

impl List {
    const ALL: [List; 2] = [List::Projects, List::Folders];

    fn file(self, state: &Path) -> PathBuf {
        state.join(match self {
            List::Projects => "recent.json",
            List::Folders => "folders.json",
        })
    }
}

type Lists = Arc<Mutex<[Vec<PathBuf>; 2]>>;

/// The lists, with the thread that keeps them.
#[derive(Debug)]
pub struct Noted {
    lists: Lists,
    inbox: Option<Sender<(List, PathBuf)>>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Noted {
    /// The lists of a folder for the studio's own files; they are empty until they are read.
    pub fn new(state: &Path, disk: Arc<dyn Disk>) -> Self {
        let (inbox, news) = channel();
        let lists = Lists::default();
        let (kept, state) = (Arc::clone(&lists), state.to_owned());
        let thread = std::thread::spawn(move || keep(&state, disk.as_ref(), &kept, &news));
        Self { lists, inbox: Some(inbox), thread: Some(thread) }
    }

    /// A list as far as it is known.
    pub fn list(&self, list: List) -> Vec<PathBuf> {
        self.lists.lock().map(|lists| lists[list as usize].clone()).unwrap_or_default()
    }

    /// Notes a path at the head of a list; a list that cannot be written is no harm.
    pub fn note(&self, list: List, path: &Path) {
        if let Some(inbox) = &self.inbox {
            let _ = inbox.send((list, path.to_owned()));
        }
    }
}

impl Drop for Noted {
    fn drop(&mut self) {
        self.inbox = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn keep(state: &Path, disk: &dyn Disk, lists: &Lists, news: &Receiver<(List, PathBuf)>) {
    let read = |list: List| -> Vec<PathBuf> {
        let bytes = disk.read(&list.file(state)).ok();
        bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
    };
    let show = |list: List, all: &[PathBuf]| {
        if let Ok(mut lists) = lists.lock() {
            lists[list as usize] = all.to_vec();
        }
    };
    List::ALL.into_iter().for_each(|list| show(list, &read(list)));
    for (list, path) in news {
        let whole = path.canonicalize().unwrap_or(path);
        let mut all = read(list);
        all.retain(|path| *path != whole);
        all.insert(0, whole);
        all.truncate(MOST);
        show(list, &all);
        if let Ok(bytes) = serde_json::to_vec(&all) {
            let _ = write_on(disk, &list.file(state), &bytes);
        }
    }
}
