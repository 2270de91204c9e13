//! Processors, progress and cancel, handed to the crates that know none of them.

use std::sync::Mutex;
use std::time::Duration;

use counterpoise_diagnose::simulator_access::Pool;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use crate::interrupt;
use crate::stages::Progress;
use crate::time_left::TimeLeft;

/// All processors of this machine, without a word about how far the work is.
pub struct Processors;

impl Pool for Processors {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).into_par_iter().for_each(job);
    }

    fn processors(&self) -> usize {
        rayon::current_num_threads()
    }
}

/// All processors of this machine, with a line that says how far the work is.
pub struct Workers {
    bar: Mutex<Line>,
}

/// The line on the terminal, and how far the work is.
struct Line {
    bar: ProgressBar,
    left: TimeLeft,
}

/// Parts of the bar.
const BAR_PARTS: u64 = 1000;

impl Workers {
    /// Returns workers that show their progress on a terminal, or do not.
    pub fn new(progress: Progress) -> Self {
        let bar = match progress {
            Progress::Quiet => ProgressBar::hidden(),
            Progress::Shown => ProgressBar::new(BAR_PARTS),
        };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {bar:30} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        Self { bar: Mutex::new(Line { bar, left: TimeLeft::default() }) }
    }

    /// Takes the line away.
    pub fn finish(&self) {
        if let Ok(line) = self.bar.lock() {
            line.bar.finish_and_clear();
        }
    }
}

impl Pool for Workers {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).into_par_iter().for_each(job);
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
