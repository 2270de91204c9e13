//! The noise of each channel, measured from the recordings: a project file may state more or less than there is.

use counterpoise_models::{Interface, Parameters, Sensor};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::{COMPARED, reading_floor, sensor_of};

use crate::tolerance::recording::REST_SAMPLES;

/// Returns the RMS of the white noise of a series from the median of its third differences, which steps and slow motion do not
/// disturb; 0 for a series that stands still or is too short.
///
/// Samples of a sensor at rest, which repeat exactly, say nothing about its noise and are left out if others remain.
pub fn measure_white_noise(series: &[f64]) -> f64 {
    let moving = without_rest(series);
    let third =
        moving.iter().flat_map(|part| part.windows(4)).map(|w| (w[3] - 3.0 * (w[2] - w[1]) - w[0]).abs());
    let mut sizes: Vec<f64> = third.filter(|d| d.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    median / (0.6745 * 20f64.sqrt())
}

/// Returns the parts of a series between long stretches of one value.
fn without_rest(series: &[f64]) -> Vec<&[f64]> {
    let (mut parts, mut from, mut at) = (Vec::new(), 0, 0);
    for run in series.chunk_by(|a, b| a == b) {
        if run.len() >= REST_SAMPLES {
            parts.push(&series[from..at]);
            from = at + run.len();
        }
        at += run.len();
    }
    parts.push(&series[from..]);
    parts
}

/// Returns the noise that a mechanism's sensor of a channel states, with its converter's step; 0 if there is no such sensor.
pub fn stated_noise(stated: &Parameters, channel: Channel) -> f64 {
    sensor_of(stated, channel).map_or(0.0, |s| reading_floor(s, &stated.interface))
}

/// Returns the RMS of the rounding of a channel's converter; 0 if there is no such sensor.
pub fn rounding_noise(base: &Parameters, channel: Channel) -> f64 {
    sensor_of(base, channel).map_or(0.0, |s| quantisation_floor(s, &base.interface))
}

/// Returns the noise floor of a channel of one recording: the noise that it shows, and no less than its converter's step leaves.
pub fn measure_noise_floor(base: &Parameters, channel: Channel, series: &[f64]) -> f64 {
    let output = base.interface.control_step_v() / 12f64.sqrt();
    let step = sensor_of(base, channel).map_or(output, |s| quantisation_floor(s, &base.interface));
    measure_white_noise(series).max(step).max(f64::MIN_POSITIVE)
}

/// Returns the mechanism with the sensor noise that the recordings show (the median over the recordings). A sensor whose channel
/// stands still or was not recorded keeps the project's noise.
pub fn with_recorded_noise(base: &Parameters, recordings: &[Recording]) -> Parameters {
    let mut heard = base.clone();
    for channel in COMPARED {
        let mut levels: Vec<f64> = recordings
            .iter()
            .filter_map(|r| r.samples(channel))
            .map(measure_white_noise)
            .filter(|n| *n > 0.0)
            .collect();
        levels.sort_by(f64::total_cmp);
        let Some(&level) = levels.get(levels.len() / 2) else { continue };
        if let Some(sensor) = sensor_mut(&mut heard, channel) {
            let step = quantisation_floor(sensor, &base.interface);
            sensor.noise_rms = (level * level - step * step).max(0.0).sqrt();
        }
    }
    heard
}

/// Returns the mechanism with the sensor noise of another.
pub fn with_noise_levels_of(mut mechanism: Parameters, other: &Parameters) -> Parameters {
    for channel in Channel::ALL {
        if let (Some(ours), Some(theirs)) = (sensor_mut(&mut mechanism, channel), sensor_of(other, channel)) {
            ours.noise_rms = theirs.noise_rms;
        }
    }
    mechanism
}

/// Returns the noise floor that the converter's step alone leaves of a sensor.
fn quantisation_floor(sensor: &Sensor, interface: &Interface) -> f64 {
    reading_floor(&Sensor { noise_rms: 0.0, ..sensor.clone() }, interface)
}

fn sensor_mut(p: &mut Parameters, channel: Channel) -> Option<&mut Sensor> {
    let s = &mut p.sensors;
    match channel {
        Channel::Demand
        | Channel::Control
        | Channel::MotorPosition
        | Channel::MotorCurrent
        | Channel::PlatformRoll
        | Channel::PlatformYaw => None,
        Channel::HubRate => Some(&mut s.hub_gyro),
        Channel::PlatformRate => Some(&mut s.platform_gyro),
        Channel::PlatformAccel => Some(&mut s.platform_accelerometer),
        Channel::MotorRate => s.motor_tachometer.as_mut(),
        Channel::HubPosition => s.hub_resolver.as_mut(),
        Channel::PlatformSurge => s.surge_accelerometer.as_mut(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use counterpoise_models::reference;

    #[test]
    fn noise_is_heard_through_steps_and_slow_motion() {
        let mut state = 9u64;
        let mut noise = || {
            let mut sum = -6.0;
            for _ in 0..12 {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                sum += (state >> 11) as f64 / (1u64 << 53) as f64;
            }
            sum
        };
        let rate: Vec<f64> = (0..5000)
            .map(|k| 0.1 * (k as f64 * 0.004).sin() + f64::from(k / 1000) + 2e-3 * noise())
            .collect();
        assert!((measure_white_noise(&rate) / 2e-3 - 1.0).abs() < 0.05, "{}", measure_white_noise(&rate));
        let recording = Recording::new("", 1e-3).with(Channel::HubRate, rate);
        let base = reference::rig();
        let heard = with_recorded_noise(&base, &[recording]);
        assert!((heard.sensors.hub_gyro.noise_rms / 2e-3 - 1.0).abs() < 0.05);
        assert_eq!(heard.sensors.platform_gyro, base.sensors.platform_gyro);
        assert_eq!(with_noise_levels_of(heard, &base), base);
    }
}
