//! Processors, progress and cancel, handed to the crates that know none of them.

use std::io;
use std::ops::Range;
use std::sync::Mutex;
use std::time::Duration;

use counterpoise_pool::Pool;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use crate::interrupt;
use crate::stages::ProgressDisplay;
use crate::time_left::RemainingTime;

/// All processors of this machine, without a word about how far the work is.
pub struct QuietPool;

impl Pool for QuietPool {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).into_par_iter().for_each(job);
    }

    fn processors(&self) -> usize {
        rayon::current_num_threads()
    }
}

/// Runs work that may take this many processors.
///
/// # Errors
/// The operating system's, if it gives no threads.
pub fn run_on<T: Send>(processors: usize, work: impl FnOnce() -> T + Send) -> io::Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(processors).build().map_err(io::Error::other)?;
    Ok(pool.install(work))
}

/// Does a job for each number of a range on all processors; returns the answers in order, or the first failure.
///
/// # Errors
/// Those of the jobs.
pub fn try_map<T: Send, E: Send>(
    range: Range<usize>,
    job: impl Fn(usize) -> Result<T, E> + Sync + Send,
) -> Result<Vec<T>, E> {
    range.into_par_iter().map(job).collect()
}

/// Does a job for each item that an iterator yields, as many at once as there are `processors`: while one takes the next item, the others work.
/// Returns the answers in the order of the items, or the first failure.
///
/// # Errors
/// Those of the jobs, and the operating system's, if it gives no threads.
pub fn try_map_stream<I: Send, T: Send, E: Send + From<io::Error>>(
    processors: usize,
    items: impl Iterator<Item = I> + Send,
    job: impl Fn(I) -> Result<T, E> + Sync + Send,
) -> Result<Vec<T>, E> {
    let mut done: Vec<(usize, T)> = run_on(processors, || {
        items.enumerate().par_bridge().map(|(k, item)| Ok((k, job(item)?))).collect::<Result<_, E>>()
    })??;
    done.sort_by_key(|(k, _)| *k);
    Ok(done.into_iter().map(|(_, answer)| answer).collect())
}

/// Starts work on a thread of its own, with a stack of as many bytes.
///
/// # Errors
/// The operating system's, if it gives no thread.
pub fn start_thread(name: &str, stack_bytes: usize, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    std::thread::Builder::new().name(name.to_owned()).stack_size(stack_bytes).spawn(work).map(drop)
}

/// All processors of this machine, with a line that says how far the work is.
pub struct ProgressPool {
    bar: Mutex<Line>,
}

/// The line on the terminal, and how far the work is.
struct Line {
    bar: ProgressBar,
    left: RemainingTime,
}

/// Parts of the bar.
const BAR_PARTS: u64 = 1000;

impl ProgressPool {
    /// Returns workers that show their progress on a terminal, or do not.
    pub fn new(progress: ProgressDisplay) -> Self {
        let bar = match progress {
            ProgressDisplay::Quiet => ProgressBar::hidden(),
            ProgressDisplay::Shown => ProgressBar::new(BAR_PARTS),
        };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {bar:30} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        Self { bar: Mutex::new(Line { bar, left: RemainingTime::default() }) }
    }

    /// Takes the line away.
    pub fn finish(&self) {
        if let Ok(line) = self.bar.lock() {
            line.bar.finish_and_clear();
        }
    }
}

impl Pool for ProgressPool {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        QuietPool.run(count, job);
    }

    fn is_cancelled(&self) -> bool {
        interrupt::is_stop_requested()
    }

    fn progress(&self, stage: &str, done: usize, of: usize) {
        if let Ok(mut line) = self.bar.lock() {
            line.left.update(stage, done, of);
            line.bar.set_position((line.left.share() * BAR_PARTS as f64) as u64);
            line.bar.set_message(line.left.line(stage, done, of));
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn answers_come_in_order_whatever_the_threads() {
        for processors in [1, 2, 5] {
            let squares = try_map_stream(processors, 0..100_u64, |k| Ok::<_, io::Error>(k * k)).unwrap();
            assert_eq!(squares, (0..100).map(|k| k * k).collect::<Vec<u64>>());
        }
        assert_eq!(try_map(3..6, |k| Ok::<_, ()>(10 * k)), Ok(vec![30, 40, 50]));
        assert_eq!(run_on(3, || QuietPool.processors()).unwrap(), 3);
    }

    #[test]
    fn a_job_that_fails_ends_the_map() {
        let odd = |k: usize| if k % 2 == 1 { Err(io::Error::other("odd")) } else { Ok(k) };
        assert!(try_map_stream(2, 0..10, odd).is_err() && try_map(0..10, odd).is_err());
    }
}
