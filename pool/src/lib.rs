//! Many independent jobs at once, on processors that the caller hands in.
//!
//! In come a [`Pool`] and a job with a number; out come the results in order. Results do not depend on how many processors there are.
//!
//! *Invariant*: nothing here starts a thread or knows what a job does. [`Serial`] is the calling thread; whoever owns processors hands in
//! another pool.
//!
//! ```
//! use counterpoise_pool::{Serial, map};
//! assert_eq!(map(&Serial, 3, |k| 10 * k), [0, 10, 20]);
//! ```

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

/// Runs independent jobs, in any order, on as many processors as the caller has.
pub trait Pool: Sync {
    /// Calls `job(0) .. job(count - 1)`, each once.
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync));
    /// Returns how many jobs run side by side: work that may turn out not to be needed is begun only if there are two or more.
    fn processors(&self) -> usize {
        1
    }
    /// Returns whether the user asked to stop.
    fn is_cancelled(&self) -> bool {
        false
    }
    /// Says how many parts of a stage are done, from none to all of them.
    fn progress(&self, _stage: &str, _done: usize, _of: usize) {}
}

/// One job after the other, on the calling thread.
pub struct Serial;

impl Pool for Serial {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).for_each(job);
    }
}

/// Returns `count` results of independent jobs, in order; fewer where the user asked to stop.
pub fn map<T: Send>(pool: &dyn Pool, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
    run_into_slots(pool, count, |k| (!pool.is_cancelled()).then(|| job(k)))
        .into_iter()
        .flatten()
        .flatten()
        .collect()
}

/// Returns the results of all `count` jobs, in order: a job that the pool leaves out, because the user asked to stop, is done on the calling thread.
pub fn map_all<T: Send>(pool: &dyn Pool, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let slots = run_into_slots(pool, count, &job);
    slots.into_iter().enumerate().map(|(k, slot)| slot.unwrap_or_else(|| job(k))).collect()
}

/// Returns the result of each of `count` jobs, in order; `None` for a job that the pool leaves out.
fn run_into_slots<T: Send>(pool: &dyn Pool, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<Option<T>> {
    let slots: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    pool.run(count, &|k| {
        let result = job(k);
        if let Ok(mut slot) = slots[k].lock() {
            *slot = Some(result);
        }
    });
    slots.into_iter().map(|slot| slot.into_inner().ok().flatten()).collect()
}

/// Returns the results of two jobs that know nothing of each other, done side by side.
pub fn join<A: Send + Sync, B: Send + Sync>(
    pool: &dyn Pool,
    first: impl Fn() -> A + Sync,
    second: impl Fn() -> B + Sync,
) -> (A, B) {
    let (a, b) = (OnceLock::new(), OnceLock::new());
    pool.run(2, &|part| match part {
        0 => drop(a.set(first())),
        _ => drop(b.set(second())),
    });
    // A pool that was asked to stop leaves jobs out.
    (a.into_inner().unwrap_or_else(first), b.into_inner().unwrap_or_else(second))
}

/// Does the same as [`map`], and says how many of the jobs of a stage are done.
pub fn map_with_progress<T: Send>(
    pool: &dyn Pool,
    stage: &str,
    count: usize,
    job: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let done = AtomicUsize::new(0);
    pool.progress(stage, 0, count);
    map(pool, count, |index| {
        let result = job(index);
        pool.progress(stage, done.fetch_add(1, Ordering::Relaxed) + 1, count);
        result
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Does every other job, as a pool that was asked to stop may.
    struct StoppedPool;

    impl Pool for StoppedPool {
        fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
            (0..count).step_by(2).for_each(job);
        }
    }

    #[test]
    fn a_job_that_the_pool_leaves_out_is_done_all_the_same() {
        assert_eq!(map_all(&StoppedPool, 5, |k| 10 * k), [0, 10, 20, 30, 40]);
    }
}
