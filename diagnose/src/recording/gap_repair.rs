//! Recordings without their holes: what can be replayed of each, and what was done to it.
//!
//! A replay needs what drives it without a break: demand, control and the platform's motion. A few missing samples are
//! filled in; a longer hole parts the recording, and each part is a recording of its own with its own start. What is only
//! compared (hub rate, motor rate, hub position) is left out where its sensor stood still while the mechanism moved.

use counterpoise_simulate::recording::Recording;

use crate::recording::series::rms;

/// Missing samples in a row that are filled in on a straight line.
const FILLED: usize = 10;
/// Shortest part that is kept, s.
const SHORTEST_S: f64 = 1.0;
/// Equal readings in a row from which a sensor may be stuck.
const STUCK: usize = 40;
/// Share of its usual size that the motion has at the least while a sensor is stuck.
const MOVING: f64 = 0.3;

/// A recording without its holes.
#[derive(Debug, Clone, PartialEq)]
pub struct RepairedRecording {
    /// The parts that can be replayed: the recording itself where it is whole, none where nothing is left.
    pub parts: Vec<Recording>,
    /// What was found and done, each with its channel.
    pub remarks: Vec<(&'static str, String)>,
}

/// Mends a recording; `ratio` is the gear's, motor turns per hub turn.
pub fn repair_gaps(recording: &Recording, ratio: f64) -> RepairedRecording {
    let mut whole = recording.clone();
    let mut remarks = Vec::new();
    let moving = motions(recording, ratio);
    for ((channel, column), other) in compared(&mut whole).into_iter().zip(moving) {
        if let (Some(series), Some(other)) = (column.as_mut(), other) {
            remarks.extend(unstuck(series, &other).map(|what| (channel, what)));
        }
    }
    let length = whole.len();
    let mut broken = vec![false; length];
    for (channel, column) in driving(&mut whole) {
        let Some(series) = column.as_mut() else { continue };
        if series.iter().all(|v| !v.is_finite()) {
            *column = None;
            remarks.push((channel, "not one sample: taken as not recorded".to_owned()));
            continue;
        }
        remarks.extend(filled(series, &mut broken).map(|what| (channel, what)));
    }
    let (parts, remark) = parted(&whole, &broken);
    remarks.extend(remark.map(|what| ("time", what)));
    RepairedRecording { parts, remarks }
}

type Columns<'a, const N: usize> = [(&'static str, &'a mut Option<Vec<f64>>); N];

fn compared(r: &mut Recording) -> Columns<'_, 3> {
    [
        ("hub_rate", &mut r.hub_rate_rad_s),
        ("motor_rate", &mut r.motor_rate_rad_s),
        ("hub_position", &mut r.hub_position_rad),
    ]
}

fn driving(r: &mut Recording) -> Columns<'_, 4> {
    [
        ("demand", &mut r.demand_rad_s),
        ("control", &mut r.control_v),
        ("platform_rate", &mut r.platform_rate_rad_s),
        ("platform_accel", &mut r.platform_accel_m_s2),
    ]
}

/// For hub rate, motor rate and hub position: the hub's rate on the platform as another sensor has it.
fn motions(r: &Recording, ratio: f64) -> [Option<Vec<f64>>; 3] {
    let geared = r.motor_rate_rad_s.as_ref().map(|w| w.iter().map(|v| v / ratio).collect::<Vec<f64>>());
    let gyros = r.hub_rate_rad_s.as_ref().map(|hub| {
        let still = vec![0.0; hub.len()];
        let platform = r.platform_rate_rad_s.as_ref().unwrap_or(&still);
        hub.iter().zip(platform).map(|(h, p)| h - p).collect::<Vec<f64>>()
    });
    [geared, gyros.clone(), gyros]
}

/// Takes out the readings of a sensor that stood still while the mechanism moved.
fn unstuck(series: &mut [f64], motion: &[f64]) -> Option<String> {
    let usual = rms(&motion.iter().copied().filter(|v| v.is_finite()).collect::<Vec<f64>>());
    let mut taken = Vec::new();
    let mut from = 0;
    while from < series.len() {
        let value = series[from];
        let run = series[from..].iter().take_while(|v| **v == value).count().max(1);
        let here = motion.get(from..from + run).unwrap_or(&[]);
        let during = rms(&here.iter().copied().filter(|v| v.is_finite()).collect::<Vec<f64>>());
        if run >= STUCK && during > MOVING * usual && usual > 0.0 {
            taken.push((from, run, value));
        }
        from += run;
    }
    let samples: usize = taken.iter().map(|(_, run, _)| run).sum();
    let &(first, _, value) = taken.first()?;
    for (from, run, _) in taken {
        series[from..from + run].fill(f64::NAN);
    }
    Some(format!(
        "stuck or clipped at {value:.6} while the mechanism moved: {samples} samples from sample {first} on are not compared"
    ))
}

/// Fills short holes of a series, and marks the samples of long ones.
fn filled(series: &mut [f64], broken: &mut [bool]) -> Option<String> {
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
            (Some(a), Some(b)) if run <= FILLED => {
                let step = (b - a) / (run + 1) as f64;
                (0..run).for_each(|k| series[from + k] = a + step * (k + 1) as f64);
                short += run;
            }
            _ => broken[from..from + run].fill(true),
        }
        from += run;
    }
    (short > 0).then(|| format!("{short} missing samples filled in on straight lines"))
}

/// The stretches between long holes.
fn parted(whole: &Recording, broken: &[bool]) -> (Vec<Recording>, Option<String>) {
    if !broken.contains(&true) {
        return (vec![whole.clone()], None);
    }
    let shortest = (SHORTEST_S / whole.sample_period_s).round() as usize;
    let mut stretches: Vec<(usize, usize)> = Vec::new();
    let mut from = 0;
    for stretch in broken.chunk_by(|a, b| a == b) {
        if !stretch[0] && stretch.len() >= shortest {
            stretches.push((from, from + stretch.len()));
        }
        from += stretch.len();
    }
    let holes = broken.chunk_by(|a, b| a == b).filter(|run| run[0]).count();
    let missing = broken.iter().filter(|b| **b).count() as f64 * whole.sample_period_s;
    let first = broken.iter().position(|b| *b).unwrap_or(0) as f64 * whole.sample_period_s;
    let many = if holes == 1 { "a gap".to_owned() } else { format!("{holes} gaps") };
    let what = format!(
        "{many} of {missing:.3} s in all in what drives the replay, the first after {first:.3} s: {} replayed",
        match stretches.len() {
            0 => "nothing that is left is long enough to be".to_owned(),
            1 => "the longest stretch is".to_owned(),
            n => format!("{n} stretches are, each by itself,"),
        }
    );
    let count = stretches.len();
    let parts = stretches.iter().enumerate().map(|(k, stretch)| part(whole, *stretch, (k, count))).collect();
    (parts, Some(what))
}

fn part(whole: &Recording, (from, to): (usize, usize), (k, count): (usize, usize)) -> Recording {
    let mut part = whole.part(from..to);
    if count > 1 {
        part.name = format!("{} (part {})", whole.name, k + 1);
    }
    part
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    fn recording() -> Recording {
        let rate: Vec<f64> = (0..6000).map(|k| 0.1 * (f64::from(k) * 0.004).sin()).collect();
        Recording {
            name: "triangle".to_owned(),
            sample_period_s: 1e-3,
            demand_rad_s: Some(rate.clone()),
            control_v: Some(rate.iter().map(|w| 10.0 * w).collect()),
            motor_rate_rad_s: Some(rate.iter().map(|w| 200.0 * w).collect()),
            hub_rate_rad_s: Some(rate),
            ..Recording::default()
        }
    }

    #[test]
    fn a_whole_recording_stays_as_it_is() {
        let mended = repair_gaps(&recording(), 200.0);
        assert_eq!(mended.parts, vec![recording()]);
        assert!(mended.remarks.is_empty());
    }

    #[test]
    fn a_gap_parts_the_recording_and_is_told() {
        let mut r = recording();
        for column in [&mut r.demand_rad_s, &mut r.control_v, &mut r.hub_rate_rad_s, &mut r.motor_rate_rad_s]
        {
            column.as_mut().unwrap()[2000..2500].fill(f64::NAN);
        }
        let mended = repair_gaps(&r, 200.0);
        let lengths: Vec<usize> = mended.parts.iter().map(Recording::len).collect();
        assert_eq!(lengths, [2000, 3500]);
        assert_eq!(mended.parts[1].name, "triangle (part 2)");
        assert_eq!(mended.remarks[0].0, "time");
        assert!(mended.remarks[0].1.starts_with("a gap of 0.500 s"), "{:?}", mended.remarks);
    }

    #[test]
    fn short_holes_are_filled_and_stuck_readings_left_out() {
        let mut r = recording();
        r.control_v.as_mut().unwrap()[100..104].fill(f64::NAN);
        r.motor_rate_rad_s.as_mut().unwrap()[3000..3300].fill(7.5);
        let mended = repair_gaps(&r, 200.0);
        let part = &mended.parts[0];
        let straight = part.control_v.as_ref().unwrap()[102] - recording().control_v.unwrap()[102];
        assert!(straight.abs() < 1e-4);
        assert!(part.motor_rate_rad_s.as_ref().unwrap()[3150].is_nan());
        let told: Vec<&str> = mended.remarks.iter().map(|(channel, _)| *channel).collect();
        assert_eq!(told, ["motor_rate", "control"]);
    }

    #[test]
    fn a_sensor_that_rests_with_the_mechanism_is_not_stuck() {
        let mut r = recording();
        for (column, value) in [(&mut r.hub_rate_rad_s, 0.0), (&mut r.motor_rate_rad_s, 0.0)] {
            column.as_mut().unwrap()[3000..3300].fill(value);
        }
        assert!(repair_gaps(&r, 200.0).remarks.is_empty());
    }
}
