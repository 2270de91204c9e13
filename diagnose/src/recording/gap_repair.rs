//! Gap repair: what can be replayed of a recording with missing samples, and what was done to it.
//!
//! A replay needs the signals that drive it without a break: demand, control and the platform's motion. A few missing samples are
//! interpolated; a longer gap splits the recording, and each part is a recording of its own with its own initial state. Readings
//! that are only compared (hub rate, motor rate, hub position) are left out while their sensor stood still and the mechanism moved.

use crate::tolerance::recording::{LONGEST_FILLED_GAP, SHORTEST_PART_S, STUCK_MOTION_SHARE, STUCK_READINGS};
use std::ops::Range;

use counterpoise_recordings::{Channel, Recording};

use crate::recording::series::rms;

/// Repair of a channel or of a whole recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Repair {
    /// Readings that stand still while the mechanism moves are not compared.
    StuckReadings {
        /// The reading, in the channel's unit.
        value: f64,
        /// Number of samples.
        samples: usize,
        /// The first of them.
        first: usize,
    },
    /// The channel has not one sample, and is taken as not recorded.
    NoSamples,
    /// Missing samples were interpolated.
    Filled {
        /// Number of samples.
        samples: usize,
    },
    /// The recording was split at gaps in what drives the replay.
    Split {
        /// Number of gaps.
        gaps: usize,
        /// Their length in all, s.
        missing_s: f64,
        /// Time of the first, s.
        first_s: f64,
        /// Number of parts that are long enough to be replayed.
        parts: usize,
    },
}

/// Kind of data that a repair changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RepairedPart {
    /// The clock: the recording as a whole.
    Time,
    /// A channel.
    Channel(Channel),
}

impl RepairedPart {
    /// Returns the name of the column that was repaired.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Channel(channel) => channel.name(),
        }
    }
}

/// A recording without gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct RepairedRecording {
    /// The parts that can be replayed: the recording itself if it is whole, none if nothing is left.
    pub parts: Vec<Recording>,
    /// Repairs, each with the part that was repaired.
    pub repairs: Vec<(RepairedPart, Repair)>,
}

/// Repairs a recording; `ratio` is the gear's, motor turns per hub turn.
pub fn repair_gaps(recording: &Recording, ratio: f64) -> RepairedRecording {
    let mut whole = recording.clone();
    let mut repairs = Vec::new();
    let moving = motions(recording, ratio);
    for (channel, other) in COMPARED.into_iter().zip(moving) {
        if let (Some(series), Some(other)) = (whole.samples_mut(channel), other) {
            repairs.extend(
                remove_stuck_readings(series, &other).map(|repair| (RepairedPart::Channel(channel), repair)),
            );
        }
    }
    let length = whole.len();
    let mut broken = vec![false; length];
    for channel in DRIVING {
        let Some(series) = whole.samples_mut(channel) else { continue };
        if series.iter().all(|v| !v.is_finite()) {
            whole.remove(channel);
            repairs.push((RepairedPart::Channel(channel), Repair::NoSamples));
            continue;
        }
        repairs.extend(
            fill_short_gaps(series, &mut broken).map(|repair| (RepairedPart::Channel(channel), repair)),
        );
    }
    let (parts, repair) = split_at_gaps(&whole, &broken);
    repairs.extend(repair.map(|repair| (RepairedPart::Time, repair)));
    RepairedRecording { parts, repairs }
}

/// The channels that a replay only compares.
const COMPARED: [Channel; 3] = [Channel::HubRate, Channel::MotorRate, Channel::HubPosition];
/// The channels that drive a replay.
const DRIVING: [Channel; 4] =
    [Channel::Demand, Channel::Control, Channel::PlatformRate, Channel::PlatformAccel];

/// Returns, for hub rate, motor rate and hub position, the hub's rate on the platform as another sensor measures it.
fn motions(r: &Recording, ratio: f64) -> [Option<Vec<f64>>; 3] {
    let geared = r.samples(Channel::MotorRate).map(|w| w.iter().map(|v| v / ratio).collect::<Vec<f64>>());
    let gyros = r.samples(Channel::HubRate).map(|hub| {
        let still = vec![0.0; hub.len()];
        let platform = r.samples(Channel::PlatformRate).unwrap_or(&still);
        hub.iter().zip(platform).map(|(h, p)| h - p).collect::<Vec<f64>>()
    });
    [geared, gyros.clone(), gyros]
}

/// Removes the readings of a sensor that stood still while the mechanism moved.
fn remove_stuck_readings(series: &mut [f64], motion: &[f64]) -> Option<Repair> {
    let usual = rms(&motion.iter().copied().filter(|v| v.is_finite()).collect::<Vec<f64>>());
    let mut taken = Vec::new();
    let mut from = 0;
    while from < series.len() {
        let value = series[from];
        let run = series[from..].iter().take_while(|v| **v == value).count().max(1);
        let here = motion.get(from..from + run).unwrap_or(&[]);
        let during = rms(&here.iter().copied().filter(|v| v.is_finite()).collect::<Vec<f64>>());
        if run >= STUCK_READINGS && during > STUCK_MOTION_SHARE * usual && usual > 0.0 {
            taken.push((from, run, value));
        }
        from += run;
    }
    let samples: usize = taken.iter().map(|(_, run, _)| run).sum();
    let &(first, _, value) = taken.first()?;
    for (from, run, _) in taken {
        series[from..from + run].fill(f64::NAN);
    }
    Some(Repair::StuckReadings { value, samples, first })
}

/// Interpolates short gaps of a series, and marks the samples of long ones.
fn fill_short_gaps(series: &mut [f64], broken: &mut [bool]) -> Option<Repair> {
    let mut short = 0;
    let mut from = 0;
    while from < series.len() {
        if series[from].is_finite() {
            from += 1;
            continue;
        }
        let run = series[from..].iter().take_while(|v| !v.is_finite()).count();
        let before = from.checked_sub(1).map(|k| series[k]);
        let after = series.get(from + run).copied();
        match (before, after) {
            (Some(a), Some(b)) if run <= LONGEST_FILLED_GAP => {
                let step = (b - a) / (run + 1) as f64;
                (0..run).for_each(|k| series[from + k] = a + step * (k + 1) as f64);
                short += run;
            }
            _ => broken[from..from + run].fill(true),
        }
        from += run;
    }
    (short > 0).then_some(Repair::Filled { samples: short })
}

/// Splits a recording at long gaps.
fn split_at_gaps(whole: &Recording, broken: &[bool]) -> (Vec<Recording>, Option<Repair>) {
    if !broken.contains(&true) {
        return (vec![whole.clone()], None);
    }
    let shortest = (SHORTEST_PART_S / whole.sample_period_s).round() as usize;
    let mut stretches: Vec<Range<usize>> = Vec::new();
    let mut from = 0;
    for stretch in broken.chunk_by(|a, b| a == b) {
        if !stretch[0] && stretch.len() >= shortest {
            stretches.push(from..from + stretch.len());
        }
        from += stretch.len();
    }
    let holes = broken.chunk_by(|a, b| a == b).filter(|run| run[0]).count();
    let missing = broken.iter().filter(|b| **b).count() as f64 * whole.sample_period_s;
    let first = broken.iter().position(|b| *b).unwrap_or(0) as f64 * whole.sample_period_s;
    let repair = Repair::Split { gaps: holes, missing_s: missing, first_s: first, parts: stretches.len() };
    let count = stretches.len();
    let part = |(k, stretch): (usize, Range<usize>)| {
        let part = whole.part(stretch);
        if count > 1 { part.with_name(format!("{} (part {})", whole.name, k + 1)) } else { part }
    };
    let parts = stretches.into_iter().enumerate().map(part).collect();
    (parts, Some(repair))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    fn recording() -> Recording {
        let rate: Vec<f64> = (0..6000).map(|k| 0.1 * (f64::from(k) * 0.004).sin()).collect();
        let times = |factor: f64| rate.iter().map(|w| factor * w).collect::<Vec<f64>>();
        Recording::new("triangle", 1e-3)
            .with(Channel::Demand, rate.clone())
            .with(Channel::Control, times(10.0))
            .with(Channel::MotorRate, times(200.0))
            .with(Channel::HubRate, rate)
    }

    #[test]
    fn a_whole_recording_stays_as_it_is() {
        let repaired = repair_gaps(&recording(), 200.0);
        assert_eq!(repaired.parts, vec![recording()]);
        assert!(repaired.repairs.is_empty());
    }

    #[test]
    fn a_gap_parts_the_recording_and_is_told() {
        let mut r = recording();
        for channel in [Channel::Demand, Channel::Control, Channel::HubRate, Channel::MotorRate] {
            r.samples_mut(channel).unwrap()[2000..2500].fill(f64::NAN);
        }
        let repaired = repair_gaps(&r, 200.0);
        let lengths: Vec<usize> = repaired.parts.iter().map(Recording::len).collect();
        assert_eq!(lengths, [2000, 3500]);
        assert_eq!(repaired.parts[1].name, "triangle (part 2)");
        let gap = Repair::Split { gaps: 1, missing_s: 0.5, first_s: 2.0, parts: 2 };
        assert_eq!(repaired.repairs[0], (RepairedPart::Time, gap));
    }

    #[test]
    fn short_holes_are_filled_and_stuck_readings_left_out() {
        let mut r = recording();
        r.samples_mut(Channel::Control).unwrap()[100..104].fill(f64::NAN);
        r.samples_mut(Channel::MotorRate).unwrap()[3000..3300].fill(7.5);
        let repaired = repair_gaps(&r, 200.0);
        let part = &repaired.parts[0];
        let straight = part.samples(Channel::Control).unwrap()[102]
            - recording().samples(Channel::Control).unwrap()[102];
        assert!(straight.abs() < 1e-4);
        assert!(part.samples(Channel::MotorRate).unwrap()[3150].is_nan());
        let told: Vec<&str> = repaired.repairs.iter().map(|(part, _)| part.name()).collect();
        assert_eq!(told, ["motor_rate", "control"]);
    }

    #[test]
    fn a_sensor_that_rests_with_the_mechanism_is_not_stuck() {
        let mut r = recording();
        for channel in [Channel::HubRate, Channel::MotorRate] {
            r.samples_mut(channel).unwrap()[3000..3300].fill(0.0);
        }
        assert!(repair_gaps(&r, 200.0).repairs.is_empty());
    }
}
