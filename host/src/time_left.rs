//! The time that a diagnosis, or a study of designs, still takes, from its progress and the time that it took so far.

use crate::tolerance::EXTRAPOLATED_FROM_SHARE;
use std::time::{Duration, Instant};

/// Shares of the work at which the stages of a round begin and end, a round being the search for one effect. Measured as processor time on the
/// practice machine with a wrong out-of-balance: scans 15 %, screening 18 %, effects at full size 22 %, fits 20 %, fits of the best 10 %,
/// validation 6 %. Other machines differ by a factor of two, so that the time left is an estimate.
const ROUND: [(&str, [f64; 2]); 7] = [
    ("examining", [0.0, 0.01]),
    ("scanning", [0.05, 0.21]),
    ("screening", [0.21, 0.40]),
    ("sizing", [0.40, 0.62]),
    ("fitting", [0.62, 0.83]),
    ("comparing", [0.83, 0.93]),
    ("validating", [0.93, 1.0]),
];
/// Stages that are all of their work.
const WHOLE: [&str; 2] = ["searching", "comparing designs"];
/// The stage that begins a further round once an effect is found.
const NEXT_ROUND: &str = "naming";

/// Progress of a diagnosis, from which the remaining time is estimated.
#[derive(Debug, Clone)]
pub struct RemainingTime {
    began: Instant,
    rounds: usize,
    share: f64,
}

impl Default for RemainingTime {
    fn default() -> Self {
        Self { began: Instant::now(), rounds: 0, share: 0.0 }
    }
}

impl RemainingTime {
    /// Takes in that a stage has done so many of its parts. Each effect that is found adds a round to what is expected, and takes the share
    /// that was done back.
    pub fn update(&mut self, stage: &str, done: usize, of: usize) {
        if stage == NEXT_ROUND {
            self.rounds = done;
            self.share = self.rounds as f64 / (self.rounds + 1) as f64;
            return;
        }
        let part = (done as f64 / of.max(1) as f64).clamp(0.0, 1.0);
        if WHOLE.contains(&stage) {
            self.share = part;
            return;
        }
        let Some((_, [from, to])) = ROUND.iter().find(|(name, _)| *name == stage) else { return };
        let share = (self.rounds as f64 + from + part * (to - from)) / (self.rounds + 1) as f64;
        // candidates are fitted more than once in a round: what was done is not taken back
        self.share = self.share.max(share);
    }

    /// Returns the share of the work that is done, 0 to 1.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Returns the time left; `None` if too little is done to tell.
    pub fn remaining_time(&self) -> Option<Duration> {
        self.remaining_after(self.began.elapsed())
    }

    /// Returns the time left after a time gone.
    fn remaining_after(&self, gone: Duration) -> Option<Duration> {
        (self.share >= EXTRAPOLATED_FROM_SHARE).then(|| gone.mul_f64((1.0 - self.share) / self.share))
    }

    /// Returns a line that says the stage, how far it is, and the time left.
    pub fn line(&self, stage: &str, done: usize, of: usize) -> String {
        let at = format!("{stage} {}/{of}", (done + 1).min(of));
        match self.remaining_time() {
            Some(left) => format!("{at}, about {} s left", left.as_secs_f64().ceil()),
            None => at,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STAGES: [&str; 6] = ["scanning", "screening", "sizing", "fitting", "comparing", "validating"];

    #[test]
    fn the_share_rises_within_a_round_and_a_further_effect_takes_a_part_back() {
        let mut left = RemainingTime::default();
        left.update("examining", 0, 1);
        assert_eq!(left.remaining_after(Duration::from_secs(1)), None);
        for round in 0..3 {
            left.update("naming", round, 3);
            let begun = left.share();
            assert!((begun - round as f64 / (round + 1) as f64).abs() < 1e-12, "{begun}");
            let mut before = begun;
            for stage in STAGES {
                for done in 0..=4 {
                    left.update(stage, done, 4);
                    assert!(left.share() >= before && left.share() <= 1.0, "{stage} {done}");
                    before = left.share();
                }
            }
            assert!((before - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_stage_that_is_all_of_its_work_has_its_own_share() {
        let mut left = RemainingTime::default();
        left.update("searching", 30, 120);
        assert_eq!(left.share(), 0.25);
        let remaining = left.remaining_after(Duration::from_secs(2));
        assert_eq!(remaining, Some(Duration::from_secs(6)));
    }

    #[test]
    fn the_time_left_is_extrapolated_from_the_time_gone() {
        let mut left = RemainingTime::default();
        left.update("scanning", 0, 10);
        left.update("sizing", 1, 2);
        // (0.40 + 0.62) / 2 = 0.51 is done after 5.1 s
        let remaining = left.remaining_after(Duration::from_secs_f64(5.1));
        assert!(remaining.is_some_and(|r| (r.as_secs_f64() - 4.9).abs() < 1e-6), "{remaining:?}");
        left.update("fitting", 1, 2);
        let back = left.share();
        left.update("fitting", 0, 5);
        assert_eq!(left.share(), back, "a second list of fits takes nothing back");
        assert!(left.line("fitting", 0, 5).starts_with("fitting 1/5, about "));
    }
}
