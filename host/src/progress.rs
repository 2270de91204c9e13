//! Processors, progress and cancel, handed to work that knows none of them.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use counterpoise_diagnose::simulator_access::Pool;

use crate::worker::{Token, Wake};

/// How far a job is, in words that two threads share.
#[derive(Debug, Clone, Default)]
pub struct Progress(Arc<Mutex<String>>);

impl Progress {
    /// The last words.
    pub fn said(&self) -> String {
        self.0.lock().map(|text| text.clone()).unwrap_or_default()
    }

    /// Says how far it is.
    pub fn say(&self, text: String) {
        if let Ok(mut said) = self.0.lock() {
            *said = text;
        }
    }
}

/// All processors; the work stops when its token says so.
pub struct Watch<'a> {
    /// Whether to stop.
    pub token: &'a Token,
    /// Where it is said how far the work is.
    pub progress: &'a Progress,
    /// Wakes the window.
    pub wake: &'a Wake,
}

impl Pool for Watch<'_> {
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

    fn cancelled(&self) -> bool {
        self.token.is_cancelled()
    }

    fn progress(&self, stage: &str, done: usize, of: usize) {
        self.progress.say(format!("{stage} {}/{of}", done + 1));
        (self.wake)();
    }
}
