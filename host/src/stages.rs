//! What each stage of the pipeline took.

use std::sync::Mutex;
use std::time::Instant;

/// What a stage took.
#[derive(Debug, Clone, PartialEq)]
pub struct StageTime {
    /// The stage.
    pub name: String,
    /// Its time, ms.
    pub milliseconds: f64,
}

/// The stages of a run, told on the error stream as they end.
pub struct Stages {
    quiet: bool,
    state: Mutex<(Instant, Vec<StageTime>)>,
}

impl Stages {
    /// Starts the clock.
    pub fn new(quiet: bool) -> Self {
        Self { quiet, state: Mutex::new((Instant::now(), Vec::new())) }
    }

    /// A stage begins.
    pub fn begins(&self, name: &str) {
        if let Ok(mut state) = self.state.lock() {
            state.0 = Instant::now();
            state.1.push(StageTime { name: name.to_owned(), milliseconds: 0.0 });
        }
    }

    /// The stage that began last has ended.
    pub fn ended(&self) {
        let Ok(mut state) = self.state.lock() else { return };
        let milliseconds = 1e3 * state.0.elapsed().as_secs_f64();
        if let Some(last) = state.1.last_mut() {
            last.milliseconds = milliseconds;
            if !self.quiet {
                eprintln!("{:>12}  {milliseconds:8.1} ms", last.name);
            }
        }
    }

    /// What each stage took.
    pub fn times(&self) -> Vec<StageTime> {
        self.state.lock().map(|state| state.1.clone()).unwrap_or_default()
    }
}
