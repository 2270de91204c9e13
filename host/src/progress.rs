//! Processors, progress and cancel, handed to work that knows none of them.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use counterpoise_pool::Pool;

use crate::time_left::RemainingTime;
use crate::worker::{CancelToken, WakeWindow};

/// Progress of a job, in words that two threads share.
#[derive(Debug, Clone, Default)]
pub struct SharedProgress(Arc<Mutex<LastMessage>>);

/// The last words, and how far a diagnosis is.
#[derive(Debug, Clone, Default)]
struct LastMessage {
    text: String,
    left: RemainingTime,
}

impl SharedProgress {
    /// Returns the text of the last message.
    pub fn last_message(&self) -> String {
        self.0.lock().map(|said| said.text.clone()).unwrap_or_default()
    }

    /// Begins a job: nothing is said of it yet, and its time left counts from now.
    pub fn begin(&self) {
        if let Ok(mut said) = self.0.lock() {
            *said = LastMessage::default();
        }
    }

    /// Says how far it is.
    pub fn say(&self, text: String) {
        if let Ok(mut said) = self.0.lock() {
            said.text = text;
        }
    }

    /// Says the stage of a diagnosis, how far it is, and the time left.
    fn say_stage(&self, stage: &str, done: usize, of: usize) {
        if let Ok(mut said) = self.0.lock() {
            said.left.update(stage, done, of);
            said.text = said.left.line(stage, done, of);
        }
    }
}

/// All processors; the work stops when its token says so.
pub struct CancellablePool<'a> {
    /// The request to stop.
    pub token: &'a CancelToken,
    /// Receiver of the progress.
    pub progress: &'a SharedProgress,
    /// Wakes the window.
    pub wake: &'a WakeWindow,
}

impl Pool for CancellablePool<'_> {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        let next = AtomicUsize::new(0);
        let work = || {
            loop {
                let k = next.fetch_add(1, Ordering::Relaxed);
                if k >= count {
                    break;
                }
                job(k);
            }
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
        std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    }

    fn is_cancelled(&self) -> bool {
        self.token.is_cancelled()
    }

    fn progress(&self, stage: &str, done: usize, of: usize) {
        self.progress.say_stage(stage, done, of);
        (self.wake)();
    }
}
