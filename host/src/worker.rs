//! Work off the window's thread: the latest request wins, every answer bears the revision that was asked for.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Time between two looks at a worker by a caller that waits for it.
const LOOK_INTERVAL: Duration = Duration::from_millis(2);

/// Waits until the next look at a worker.
pub fn wait_between_looks() {
    std::thread::sleep(LOOK_INTERVAL);
}

/// Wakes the window.
pub type WakeWindow = Arc<dyn Fn() + Send + Sync>;

/// A flag that a job looks at.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Returns whether the job should end.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

struct State<I, O> {
    asked: Option<(u64, I)>,
    running: Option<u64>,
    token: CancelToken,
    answer: Option<(u64, O)>,
    ended: bool,
}

struct SharedQueue<I, O> {
    state: Mutex<State<I, O>>,
    asked: Condvar,
}

/// One thread that does one kind of work.
pub struct BackgroundWorker<I, O> {
    shared: Arc<SharedQueue<I, O>>,
}

impl<I: Send + 'static, O: Send + 'static> BackgroundWorker<I, O> {
    /// Returns a worker; `wake` is called when an answer is there.
    pub fn new(wake: WakeWindow, mut work: impl FnMut(I, &CancelToken) -> O + Send + 'static) -> Self {
        let state =
            State { asked: None, running: None, token: CancelToken::default(), answer: None, ended: false };
        let shared = Arc::new(SharedQueue { state: Mutex::new(state), asked: Condvar::new() });
        let own = Arc::clone(&shared);
        std::thread::spawn(move || {
            while let Some((revision, input, token)) = own.next() {
                let output = work(input, &token);
                own.store_answer(revision, output, &token);
                wake();
            }
        });
        Self { shared }
    }

    /// Asks for work; a request that has not begun is replaced.
    pub fn ask(&self, revision: u64, input: I) {
        self.shared.lock().asked = Some((revision, input));
        self.shared.asked.notify_one();
    }

    /// Returns the answer; `None` if none has come.
    pub fn take(&self) -> Option<(u64, O)> {
        self.shared.lock().answer.take()
    }

    /// Returns whether something is asked for or running.
    pub fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.asked.is_some() || state.running.is_some()
    }

    /// Returns whether something is asked for, running, or answered and not yet taken.
    pub fn is_pending(&self) -> bool {
        let state = self.shared.lock();
        state.asked.is_some() || state.running.is_some() || state.answer.is_some()
    }

    /// Drops what is asked for, and what is running when it looks at its token; an answer is dropped in any case.
    pub fn cancel(&self) {
        let mut state = self.shared.lock();
        (state.asked, state.answer) = (None, None);
        state.token.0.store(true, Ordering::Relaxed);
    }
}

impl<I, O> Drop for BackgroundWorker<I, O> {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.ended = true;
        state.token.0.store(true, Ordering::Relaxed);
        self.shared.asked.notify_one();
    }
}

impl<I, O> SharedQueue<I, O> {
    fn lock(&self) -> MutexGuard<'_, State<I, O>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn next(&self) -> Option<(u64, I, CancelToken)> {
        let mut state = self.lock();
        loop {
            if state.ended {
                return None;
            }
            if let Some((revision, input)) = state.asked.take() {
                state.running = Some(revision);
                state.token = CancelToken::default();
                return Some((revision, input, state.token.clone()));
            }
            state = self.asked.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn store_answer(&self, revision: u64, output: O, token: &CancelToken) {
        let mut state = self.lock();
        state.running = None;
        if !token.is_cancelled() {
            state.answer = Some((revision, output));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn the_latest_request_wins_and_a_cancelled_one_gives_no_answer() {
        let (go, gate) = channel::<()>();
        let (done, ended) = channel();
        let wake: WakeWindow = Arc::new(move || done.send(()).unwrap());
        let worker = BackgroundWorker::new(wake, move |input: u32, _: &CancelToken| {
            gate.recv().unwrap();
            input
        });
        (0..5).for_each(|k| worker.ask(k, k as u32));
        go.send(()).unwrap();
        ended.recv().unwrap();
        if worker.is_busy() {
            go.send(()).unwrap();
            ended.recv().unwrap();
        }
        assert_eq!(worker.take(), Some((4, 4)));
        worker.ask(9, 9);
        worker.cancel();
        worker.ask(10, 10);
        go.send(()).unwrap();
        let _ = go.send(());
        while worker.is_busy() {
            std::thread::yield_now();
        }
        assert_eq!(worker.take(), Some((10, 10)));
    }
}
