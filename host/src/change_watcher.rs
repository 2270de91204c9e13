//! A thread that looks at files and folders once a second and wakes the window only if one of them has changed.
//!
//! The window itself does not look: a window that is not touched draws nothing.

use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use crate::worker::WakeWindow;

/// Time between two looks: short enough that a change is shown before a user saves over it, long enough to cost nothing.
const INTERVAL: Duration = Duration::from_secs(1);

#[derive(Default)]
struct WatchState {
    paths: Vec<PathBuf>,
    times: Vec<Option<SystemTime>>,
    has_changed: bool,
    has_ended: bool,
}

/// The state that the thread and its owner share.
#[derive(Default)]
struct SharedWatch {
    state: Mutex<WatchState>,
    /// Told when the watcher ends.
    end: Condvar,
}

impl SharedWatch {
    fn lock(&self) -> MutexGuard<'_, WatchState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Watches the times of files and folders.
pub struct ChangeWatcher {
    shared: Arc<SharedWatch>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl ChangeWatcher {
    /// Starts the thread; it watches nothing yet.
    pub fn new(wake: WakeWindow) -> Self {
        let shared = Arc::new(SharedWatch::default());
        let own = Arc::clone(&shared);
        let thread = std::thread::spawn(move || watch(&own, &wake));
        Self { shared, thread: Some(thread) }
    }

    /// Sets what is watched from now on.
    pub fn set_paths(&self, paths: Vec<PathBuf>) {
        let mut state = self.shared.lock();
        if state.paths != paths {
            state.times = modification_times(&paths);
            state.paths = paths;
        }
    }

    /// Returns whether anything has changed since the last call.
    pub fn take_change(&self) -> bool {
        let mut state = self.shared.lock();
        std::mem::take(&mut state.has_changed)
    }
}

impl Drop for ChangeWatcher {
    fn drop(&mut self) {
        self.shared.lock().has_ended = true;
        self.shared.end.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn modification_times(paths: &[PathBuf]) -> Vec<Option<SystemTime>> {
    paths.iter().map(|path| std::fs::metadata(path).and_then(|m| m.modified()).ok()).collect()
}

fn watch(shared: &SharedWatch, wake: &WakeWindow) {
    let mut state = shared.lock();
    while !state.has_ended {
        state = shared.end.wait_timeout(state, INTERVAL).unwrap_or_else(PoisonError::into_inner).0;
        let paths = state.paths.clone();
        drop(state);
        let times = modification_times(&paths);
        state = shared.lock();
        if state.paths == paths && state.times != times {
            (state.times, state.has_changed) = (times, true);
            wake();
        }
    }
}
