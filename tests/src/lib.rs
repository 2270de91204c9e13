//! Suites that cross crates: the map, the golden projects, the pipeline from project file to code, the sealed machines.
//!
//! The suites are in `tests/tests`; comparisons with tools that other people wrote are in `tests/peers`.
//!
//! *Invariant*: nothing here is used by the product.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::PathBuf;

use counterpoise_pipeline::World;
use counterpoise_pool::Pool;
use counterpoise_project::Project;

pub mod adaptation;
pub mod certificates;
pub mod examples;
pub mod exported_loop;
pub mod sealed;
pub mod workspace;

/// Runs independent jobs on as many threads as the machine has.
pub fn run_in_parallel(count: usize, job: &(dyn Fn(usize) + Sync)) {
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

/// Pool with as many threads as the machine has, for a diagnosis.
pub struct Threads;

impl Pool for Threads {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        run_in_parallel(count, job);
    }
}

/// The files beside a project.
pub struct ExampleFolder(pub PathBuf);

impl World for ExampleFolder {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(self.0.join(name)).map_err(|error| error.to_string())
    }
}

/// Returns the project with everything that its file leaves to the program: weights chosen, blocks tuned.
pub fn decide_choices(project: Project, world: &dyn World) -> Project {
    counterpoise_pipeline::choose_and_tune(&project, world).unwrap().project
}
