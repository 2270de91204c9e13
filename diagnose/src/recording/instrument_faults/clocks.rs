//! Columns on another clock: late by a constant time, or by a growing one.

use crate::tolerance::recording::{
    CLOCK_DRIFT_S, COMMON_OFFSET_S, DRIFT_AGREEMENT, DRIFT_BENT_SHARE, KINEMATIC_REMAINDER, LAG_CORRECTIONS,
    LARGEST_SHIFT, MOST_OFFSET_DOUBT, PLATFORM_MOVES_RAD_S, SHIFT_REMAINDER, SMALLEST_MOVING_OFFSET_S,
    SMALLEST_OFFSET_DOUBTS, SMALLEST_OFFSET_S,
};
use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{Parameters, Sensor};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::ReplayLoop;

use super::column::RecorderColumn;
use super::identities::{
    ColumnShift, Identity, controller_identity, kinematic_identity, proportional_integral,
};
use super::regression::delay_series;
use crate::recording::series::{derivative, deviation};

/// The delay of a column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lateness {
    /// Late by this, s.
    pub late_s: f64,
    /// Doubt of it, s.
    pub doubt_s: f64,
}

/// Returns how late motor or resolver are against the gyroscopes, less the gyroscopes' own lag.
pub(super) fn estimate_lateness(
    base: &Parameters,
    r: &Recording,
    column: RecorderColumn,
) -> Option<Lateness> {
    let rate = rate(base, r, column)?;
    let mut shift = 0.0;
    for _ in 0..LAG_CORRECTIONS {
        let found: Identity =
            kinematic_identity(column, &delay_series(&rate, -shift / r.sample_period_s), r)?;
        let left = expected_lead(base, column) - found.lead_s.0;
        if left.abs() < 0.5 * r.sample_period_s || !left.is_finite() {
            let believed = found.share < KINEMATIC_REMAINDER;
            return believed.then_some(Lateness { late_s: shift + left, doubt_s: found.lead_s.1 });
        }
        shift += left;
    }
    None
}

/// Returns a sensor's rate of the hub on the platform.
fn rate(base: &Parameters, r: &Recording, column: RecorderColumn) -> Option<Vec<f64>> {
    let series = column.of(r)?;
    Some(match column {
        RecorderColumn::MotorRate => series.iter().map(|w| w / base.gearbox.ratio).collect(),
        _ => derivative(series, r.sample_period_s),
    })
}

/// Returns the time by which a column leads the gyroscopes in a sound recording, s.
fn expected_lead(base: &Parameters, column: RecorderColumn) -> f64 {
    let period_s = base.interface.sample_period_s;
    let held_s =
        |s: &Sensor| (s.mean_hold_samples(period_s) + s.difference_delay_samples(period_s)) * period_s;
    let lag = |s: &Sensor| 2.0 * s.damping_ratio / s.natural_frequency_rad_s + s.delay_s + held_s(s);
    lag(&base.sensors.hub_gyro) - column.sensor(base).map_or(0.0, lag)
}

/// Returns how late motor and resolver are if that cannot be the gyroscopes' own lag: late against them, or different from each
/// other. The motor's gear twists, so that it leads or lags a little if the platform moves; then a larger offset is required.
fn detect_lateness(base: &Parameters, r: &Recording) -> Vec<(RecorderColumn, Lateness)> {
    let of = |column| {
        estimate_lateness(base, r, column)
            .filter(|lateness| lateness.doubt_s < MOST_OFFSET_DOUBT * SMALLEST_OFFSET_S)
    };
    let moved = r.samples(Channel::PlatformRate).is_some_and(|p| deviation(p) > PLATFORM_MOVES_RAD_S);
    let sure = |column: RecorderColumn, Lateness { late_s, doubt_s }: Lateness| {
        let least = if moved && column == RecorderColumn::MotorRate {
            SMALLEST_MOVING_OFFSET_S
        } else {
            SMALLEST_OFFSET_S
        };
        late_s.abs() > least && late_s.abs() > SMALLEST_OFFSET_DOUBTS * doubt_s
    };
    let (motor, resolver) = (of(RecorderColumn::MotorRate), of(RecorderColumn::HubPosition));
    let own = match (motor, resolver) {
        (Some(motor), Some(resolver)) => {
            let apart = Lateness {
                late_s: motor.late_s - resolver.late_s,
                doubt_s: motor.doubt_s.max(resolver.doubt_s),
            };
            motor.late_s < 0.0 && !sure(RecorderColumn::MotorRate, apart)
        }
        // one alone that is early may be the gyroscope's own delay
        (motor, resolver) => motor.or(resolver).is_none_or(|lateness| lateness.late_s < 0.0),
    };
    let both = [(RecorderColumn::MotorRate, motor), (RecorderColumn::HubPosition, resolver)];
    let all = both.into_iter().filter_map(|(column, lateness)| Some((column, lateness?)));
    all.filter(|(column, lateness)| !own && sure(*column, *lateness)).collect()
}

/// Returns the recordings in which motor or resolver are late, and how late. A recording that does not contradict the others is
/// taken to have their offset.
pub(super) fn estimate_offsets(
    base: &Parameters,
    recordings: &[Recording],
) -> Vec<(usize, RecorderColumn, Lateness)> {
    let seen: Vec<Vec<(RecorderColumn, Lateness)>> =
        recordings.iter().map(|r| detect_lateness(base, r)).collect();
    let mut out = Vec::new();
    for column in [RecorderColumn::MotorRate, RecorderColumn::HubPosition] {
        let of = |r: usize| seen[r].iter().find(|(c, _)| *c == column).map(|(_, lateness)| *lateness);
        let sure: Vec<Lateness> = (0..recordings.len()).filter_map(of).collect();
        let Some(&best) = sure.iter().min_by(|a, b| a.doubt_s.total_cmp(&b.doubt_s)) else { continue };
        let alike = |r: usize| match estimate_lateness(base, &recordings[r], column) {
            Some(lateness) => (lateness.late_s - best.late_s).abs() < COMMON_OFFSET_S,
            None => column.of(&recordings[r]).is_some(),
        };
        let each = (0..recordings.len()).filter_map(|r| Some((r, of(r).or(alike(r).then_some(best))?)));
        out.extend(each.map(|(r, lateness)| (r, column, lateness)));
    }
    out
}

/// Returns the share by which a column's clock runs slow, from how the offsets of the two halves of each recording differ.
pub(super) fn estimate_drift(
    base: &Parameters,
    recordings: &[Recording],
    column: RecorderColumn,
) -> Option<(f64, f64)> {
    let parted = |r: &Recording| {
        let half = r.len() / 2;
        let first = estimate_lateness(base, &r.part(0..half), column)?;
        let second = estimate_lateness(base, &r.part(half..2 * half), column)?;
        let time = half as f64 * r.sample_period_s;
        Some((second.late_s - first.late_s, time, first.doubt_s.max(second.doubt_s)))
    };
    if !recordings.iter().all(|r| grows_evenly(base, r, column)) {
        return None;
    }
    let all: Vec<(f64, f64, f64)> = recordings.iter().filter_map(parted).collect();
    let count = all.len().max(1) as f64;
    let slow = all.iter().map(|(apart, time, _)| apart / time).sum::<f64>() / count;
    let apart = all.iter().map(|(apart, ..)| apart.abs()).fold(f64::INFINITY, f64::min);
    let alike = all.iter().all(|(apart, time, _)| (apart / time - slow).abs() < DRIFT_AGREEMENT * slow.abs());
    let least = if all.len() > 1 { CLOCK_DRIFT_S.0 } else { CLOCK_DRIFT_S.1 };
    let spread = all.iter().map(|(apart, time, _)| (apart / time - slow).abs()).fold(0.0, f64::max);
    (!all.is_empty() && alike && apart > least).then_some((slow, spread))
}

/// Returns whether the offset of a column grows evenly over the thirds of a recording, as that of a clock does; also if a third does not
/// show it.
fn grows_evenly(base: &Parameters, r: &Recording, column: RecorderColumn) -> bool {
    let third = r.len() / 3;
    let late = |k: usize| estimate_lateness(base, &r.part(k * third..(k + 1) * third), column);
    let (Some(first), Some(middle), Some(last)) = (late(0), late(1), late(2)) else { return true };
    let bent = (middle.late_s - 0.5 * (first.late_s + last.late_s)).abs();
    let doubt = first.doubt_s.max(middle.doubt_s).max(last.doubt_s);
    bent < DRIFT_BENT_SHARE * (last.late_s - first.late_s).abs() + SMALLEST_OFFSET_DOUBTS * doubt
}

/// Returns which of the controller's columns is late, how late, and in which recordings: the whole number of samples for which the
/// controller's identity holds in every recording in which it did not.
pub(super) fn control_offset(
    base: &Parameters,
    control: &ReplayLoop,
    recordings: &[Recording],
) -> Option<(RecorderColumn, Lateness, Vec<usize>)> {
    let controller = proportional_integral(control)?;
    let noise = RecorderColumn::Control.converter_step(base)? / 12f64.sqrt();
    let bad: Vec<(usize, f64)> = recordings
        .iter()
        .enumerate()
        .filter_map(|(r, recording)| {
            Some((r, controller_identity(controller, recording, ColumnShift::NONE)?.left))
        })
        .filter(|(_, left)| *left > SHIFT_REMAINDER.1 * noise)
        .collect();
    let period_s = recordings.get(bad.first()?.0)?.sample_period_s;
    let share = |column, samples| {
        let of = |(r, before): &(usize, f64)| {
            Some(identity(controller, &recordings[*r], samples, column)?.left / before)
        };
        bad.iter().map(of).try_fold(0.0, |sum, share| Some(sum + share?))
    };
    let columns = [RecorderColumn::Control, RecorderColumn::HubRate, RecorderColumn::Demand];
    let all =
        columns.into_iter().flat_map(|c| (-LARGEST_SHIFT..=LARGEST_SHIFT).map(move |samples| (c, samples)));
    let tried = all.filter_map(|(c, samples)| Some((share(c, samples)?, c, samples)));
    let (after, column, samples) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let inside = samples.abs() < LARGEST_SHIFT && samples != 0;
    let lateness = Lateness { late_s: f64::from(samples) * period_s, doubt_s: 0.5 * period_s };
    let recordings = bad.iter().map(|(r, _)| *r).collect();
    (inside && after < SHIFT_REMAINDER.0 * bad.len() as f64).then_some((column, lateness, recordings))
}

/// Returns the controller's identity if every factor in it is one.
fn identity(
    controller: &ProportionalIntegral,
    r: &Recording,
    samples: i32,
    column: RecorderColumn,
) -> Option<Identity> {
    let found = controller_identity(controller, r, ColumnShift { column, samples })?;
    found.ratios.iter().all(|ratio| (ratio.value - 1.0).abs() <= ratio.doubt).then_some(found)
}
