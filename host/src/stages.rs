//! The time that each stage of the pipeline took.

use std::sync::Mutex;
use std::time::Instant;

use counterpoise_pipeline::StageTime;

/// Display of progress on the error stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProgressDisplay {
    /// The progress is printed.
    Shown,
    /// Nothing is printed.
    Quiet,
}

/// The stages of a run, printed on the error stream as they end.
pub struct StagePrinter {
    progress: ProgressDisplay,
    state: Mutex<(Instant, Vec<StageTime>)>,
}

impl StagePrinter {
    /// Starts the clock.
    pub fn new(progress: ProgressDisplay) -> Self {
        Self { progress, state: Mutex::new((Instant::now(), Vec::new())) }
    }

    /// Notes that a stage begins.
    pub fn begins(&self, name: &str) {
        if let Ok(mut state) = self.state.lock() {
            state.0 = Instant::now();
            state.1.push(StageTime { name: name.to_owned(), milliseconds: 0.0 });
        }
    }

    /// Notes that the stage that began last has ended.
    pub fn ends(&self) {
        let Ok(mut state) = self.state.lock() else { return };
        let milliseconds = 1e3 * state.0.elapsed().as_secs_f64();
        if let Some(last) = state.1.last_mut() {
            last.milliseconds = milliseconds;
            if self.progress == ProgressDisplay::Shown {
                crate::terminal::print_message(&format!("{:>12}  {milliseconds:8.1} ms", last.name));
            }
        }
    }

    /// Returns what each stage took.
    pub fn times(&self) -> Vec<StageTime> {
        self.state.lock().map(|state| state.1.clone()).unwrap_or_default()
    }
}
