//! Errors of the sensors of a moving base: the accelerometer's lever arm from the torque balance, the misalignment of the gyroscopes from kinematics.
//!
//! While the base rolls and yaws with the rates P and R, hub and platform gyroscopes differ from the hub's rate on the platform by
//!
//! ```text
//!     Q [w_h - w_p - theta'] = c_r Q G [P] + c_y Q G [R] + bias
//! ```
//!
//! c_r and c_y are the hub gyroscope's sensitivities less the platform gyroscope's: near level both read the same two rates, so that kinematics alone
//! tell their difference. `diagnose` tells which of the two it is, by what the loop does with each.

use counterpoise_models::{FeedbackSignal, Parameters};
use counterpoise_recordings::{Channel, Recording, repeat_last};

use super::outcome::{Estimate, SensorErrors};
use super::problem::Layout;
use super::regression::{Block, RegressionFit, fit_rows};
use super::signal::{Chain, Kernel};
use crate::recording::series::rms;
use crate::tolerance::identification::{LEAST_TURNING_RAD_S, LOW_PASS_S, MEMORY_S};

/// Returns what the recordings say of the sensors, beside the torque balance with its unknowns.
pub(super) fn sensor_errors(
    p: &Parameters,
    states: &[&[Recording]],
    balance: &RegressionFit,
    layout: Layout,
) -> SensorErrors {
    let known = p.sensors.accelerometer_lever_arm_m;
    let arm = layout.lever_arm().filter(|place| balance.value[*place].is_finite());
    let lever_arm_m =
        arm.map(|place| Estimate::new(known + balance.value[place], balance.half_width[place], known));
    let recordings: Vec<&Recording> = states.iter().flat_map(|state| state.iter()).collect();
    let [roll_misalignment_rad, yaw_misalignment_rad] = misalignment(p, &recordings).unwrap_or_default();
    SensorErrors { lever_arm_m, roll_misalignment_rad, yaw_misalignment_rad }
}

/// Rows of one recording: the kinematic difference, roll rate, yaw rate, and ones.
struct RotationRows {
    difference: Vec<f64>,
    columns: [Vec<f64>; 3],
    counts: Vec<bool>,
    memory: usize,
}

/// Returns the misalignments about roll and yaw; `None` if no recording shows them.
fn misalignment(p: &Parameters, recordings: &[&Recording]) -> Option<[Option<Estimate>; 2]> {
    let sensors = &p.sensors;
    if sensors.measured != FeedbackSignal::HubRate || !sensors.platform_gyro.is_fitted() {
        return None;
    }
    let parts: Vec<RotationRows> =
        recordings.iter().filter_map(|recording| turning_rows(p, recording)).collect();
    let blocks = parts.iter().map(|part| Block {
        columns: part.columns.iter().map(|column| Some(column.as_slice())).collect(),
        target: &part.difference,
        counts: &part.counts,
        noise: vec![0.0; 3],
        shared: vec![0.0; 3],
        memory: part.memory,
    });
    let found = fit_rows(&blocks.collect::<Vec<Block>>())?;
    let (hub, platform) = (&sensors.hub_gyro.alignment, &sensors.platform_gyro.alignment);
    let before =
        [hub.roll_sensitivity - platform.roll_sensitivity, hub.yaw_sensitivity - platform.yaw_sensitivity];
    let estimate = |k: usize| {
        let value = Estimate::new(found.value[k], found.half_width[k], before[k]);
        value.is_known().then_some(value)
    };
    Some([0, 1].map(estimate))
}

/// Returns the rows of a recording; `None` if it lacks a column, or the platform hardly rolls and yaws.
fn turning_rows(p: &Parameters, recording: &Recording) -> Option<RotationRows> {
    let period_s = recording.sample_period_s;
    let (chain, kernel) = (Chain::new(p, period_s), Kernel::new(LOW_PASS_S, period_s));
    let column = |channel| recording.samples(channel);
    let (hub, platform) = (column(Channel::HubRate)?, column(Channel::PlatformRate)?);
    let position = column(Channel::HubPosition).filter(|_| p.sensors.hub_resolver.is_some())?;
    let rates = [column(Channel::PlatformRoll)?, column(Channel::PlatformYaw)?];
    let count = [hub, platform, position, rates[0], rates[1]].map(<[f64]>::len).into_iter().min()?;
    let is_whole =
        |k: usize| [hub, platform, position, rates[0], rates[1]].iter().all(|column| column[k].is_finite());
    let whole: Vec<bool> = (0..count).map(is_whole).collect();
    let filled = |column: &[f64]| repeat_last(&column[..count]);
    let rates = rates.map(filled);
    if rates.iter().all(|rate| rms(rate) < LEAST_TURNING_RAD_S) {
        return None;
    }
    let sensors = &p.sensors;
    let hub = chain.reading_of(&sensors.hub_gyro, &filled(hub));
    let base = chain.reading_of(&sensors.platform_gyro, &filled(platform));
    let apart: Vec<f64> = hub.iter().zip(base).map(|(hub, base)| hub - base).collect();
    let turned =
        kernel.slope(&chain.as_gyro(&chain.reading_of(sensors.hub_resolver.as_ref()?, &filled(position))));
    let difference = kernel.smooth(&apart).iter().zip(turned).map(|(apart, rate)| apart - rate).collect();
    let [roll, yaw] = rates.map(|rate| kernel.smooth(&chain.as_gyro(&chain.as_late(&rate))));
    let half = kernel.half_length();
    let clear = |k: usize| {
        k >= 2 * half && k + half < count && whole[k - half..=k + half].iter().all(|is_whole| *is_whole)
    };
    let counts = (0..count).map(clear).collect();
    let memory = ((MEMORY_S / period_s) as usize).max(1);
    Some(RotationRows { difference, columns: [roll, yaw, vec![1.0; count]], counts, memory })
}
