//! Suites that cross crates: the map, the golden projects, the pipeline from project file to code, the sealed machines.
//!
//! The suites are in `tests/tests`; comparisons with tools that somebody else wrote are in `tests/peers`.
//!
//! *Invariant*: nothing here is used by the product.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod certificates;
pub mod exported_loop;
pub mod sealed;
pub mod workspace;

/// Runs independent jobs on as many threads as the machine has.
pub fn in_parallel(count: usize, job: &(dyn Fn(usize) + Sync)) {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let work = || {
        loop {
            let k = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if k >= count {
                break;
            }
            job(k);
        }
    };
    std::thread::scope(|scope| {
        (0..threads).for_each(|_| {
            scope.spawn(work);
        });
    });
}
