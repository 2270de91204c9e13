//! The progress of a long campaign, what is left of it, and what a larger one would cost on this machine.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};

/// Samples of the large campaign whose cost is told.
const LARGE: usize = 100_000;
/// Seconds between lines where no terminal shows a bar, as in the log of a queue.
const LINE_EVERY: f64 = 10.0;

/// The pace of a campaign: what was found done counts as progress, and not as pace.
pub struct CampaignPace {
    bar: ProgressBar,
    lines: bool,
    count: usize,
    state: Mutex<State>,
}

struct State {
    begun: Instant,
    told: Instant,
    kept: usize,
    ran: usize,
}

impl CampaignPace {
    /// Returns the progress of a campaign of `count` samples, shown as a bar on a terminal and as a line now and then elsewhere.
    pub fn with_bar(count: usize) -> Result<Self> {
        let terminal = std::io::stderr().is_terminal();
        let bar = if terminal { ProgressBar::new(count as u64) } else { ProgressBar::hidden() };
        bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} samples, {elapsed} gone{msg}")?);
        bar.enable_steady_tick(Duration::from_millis(200));
        Ok(Self { lines: !terminal, ..Self::start(bar, count) })
    }

    /// Returns the progress of a campaign of `count` samples, shown nowhere.
    pub fn silent(count: usize) -> Self {
        Self::start(ProgressBar::hidden(), count)
    }

    fn start(bar: ProgressBar, count: usize) -> Self {
        let now = Instant::now();
        Self { bar, lines: false, count, state: Mutex::new(State { begun: now, told: now, kept: 0, ran: 0 }) }
    }

    /// Counts samples that were found done by an earlier run.
    pub fn count_kept(&self, samples: usize) {
        self.bar.inc(samples as u64);
        if let Ok(mut state) = self.state.lock() {
            state.kept += samples;
        }
    }

    /// Counts a sample that was run.
    pub fn count_run(&self) {
        self.bar.inc(1);
        let Ok(mut state) = self.state.lock() else { return };
        state.ran += 1;
        let gone = state.begun.elapsed().as_secs_f64();
        let left = self.count.saturating_sub(state.kept + state.ran);
        let to_go = span(gone * left as f64 / state.ran as f64);
        self.bar.set_message(format!(", {to_go} to go"));
        if self.lines && left > 0 && state.told.elapsed().as_secs_f64() > LINE_EVERY {
            state.told = Instant::now();
            let done = state.kept + state.ran;
            crate::terminal::print_message(&format!(
                "{done}/{} samples, {} gone, {to_go} to go",
                self.count,
                span(gone)
            ));
        }
    }

    /// Takes the bar away and says what the large campaign would cost, measured on the samples that were run.
    pub fn finish(&self) -> Option<String> {
        self.bar.finish_and_clear();
        let state = self.state.lock().ok()?;
        projection(state.ran, state.begun.elapsed().as_secs_f64(), rayon::current_num_threads())
    }
}

/// Returns what [`LARGE`] samples take where `ran` samples took `seconds` on `threads` threads.
fn projection(ran: usize, seconds: f64, threads: usize) -> Option<String> {
    if ran == 0 {
        return None;
    }
    let many = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
    let (samples, threads) = (many(ran, "sample"), many(threads, "thread"));
    let (took, large) = (span(seconds), span(seconds * LARGE as f64 / ran as f64));
    Some(format!("{samples} run in {took} on {threads}: at this pace {LARGE} would take {large}"))
}

/// Returns a time in the unit that a person would use.
fn span(seconds: f64) -> String {
    const MINUTE: f64 = 60.0;
    const HOUR: f64 = 3600.0;
    const DAY: f64 = 86_400.0;
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 2.0 * MINUTE => format!("{s:.0} s"),
        s if s < 2.0 * HOUR => format!("{:.0} min", s / MINUTE),
        s if s < 2.0 * DAY => format!("{:.1} h", s / HOUR),
        s => format!("{:.1} days", s / DAY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_told_in_a_unit_of_its_size() {
        let told = [0.04, 75.0, 600.0, 10_800.0, 864_000.0].map(span);
        assert_eq!(told, ["0.0 s", "75 s", "10 min", "3.0 h", "10.0 days"]);
    }

    #[test]
    fn a_large_campaign_costs_in_proportion_to_what_was_measured() {
        let told = projection(200, 36.0, 2).unwrap();
        assert_eq!(told, "200 samples run in 36 s on 2 threads: at this pace 100000 would take 5.0 h");
    }

    #[test]
    fn samples_of_an_earlier_run_say_nothing_of_the_pace() {
        let pace = CampaignPace::silent(100);
        pace.count_kept(100);
        assert_eq!(pace.finish(), None);
        pace.count_run();
        assert!(pace.finish().is_some_and(|told| told.starts_with("1 sample run in")));
    }
}
