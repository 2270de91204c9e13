//! The platform's motion from the readings of its sensors.

use super::smoother::sensor_input;
use crate::motion::PlatformMotion;
use crate::recording::Recording;
use crate::sensing::CONVERTER_RANGE_V;
use crate::signal::Signal;
use counterpoise_models::{Interface, Parameters, Sensor};

/// RMS of what noise and quantisation add to a reading, in the measured unit: the root of the sum of the squares of
/// the noise and of the converter's step over the root of 12.
pub fn reading_floor(sensor: &Sensor, interface: &Interface) -> f64 {
    let step = 2.0 * CONVERTER_RANGE_V / f64::from(interface.input_bits).exp2() / sensor.scale_v_unit;
    sensor.noise_rms.hypot(step / 12f64.sqrt())
}

/// The motion of the platform that its sensors have seen, their errors (gain, bias, delay, lever arm, g-sensitivity)
/// as the parameters have them taken out; the platform is level at the start, for no sensor says otherwise.
///
/// Rate and heave come from a smoother that deconvolves the sensor and shrinks to a constant where there is nothing
/// but noise. A platform without the sensor is still.
pub fn platform_motion(parameters: &Parameters, recording: &Recording) -> PlatformMotion {
    let sensors = &parameters.sensors;
    let input = |readings: &Option<Vec<f64>>, sensor: &Sensor| {
        let readings = readings.as_deref()?;
        let noise = reading_floor(sensor, &parameters.interface);
        let input = sensor_input(readings, sensor, noise, recording.sample_period_s);
        let advanced = advanced(&input, sensor.delay_s / recording.sample_period_s);
        Some(advanced.into_iter().map(|value| (value - sensor.bias) / sensor.gain).collect::<Vec<f64>>())
    };
    let rate = input(&recording.platform_rate_rad_s, &sensors.platform_gyro);
    let mut heave = input(&recording.platform_accel_m_s2, &sensors.platform_accelerometer);
    let arm = sensors.accelerometer_lever_arm_m;
    if let (Some(heave), Some(rate), true) = (heave.as_mut(), rate.as_ref(), arm != 0.0) {
        let slope = slopes(rate, recording.sample_period_s);
        heave.iter_mut().zip(slope).for_each(|(h, a)| *h -= arm * a);
    }
    let sensitivity = sensors.platform_gyro.g_sensitivity / sensors.platform_gyro.gain;
    let corrected = rate.map(|mut rate| {
        if let (Some(heave), true) = (heave.as_ref(), sensitivity != 0.0) {
            rate.iter_mut().zip(heave).for_each(|(r, h)| *r -= sensitivity * h);
        }
        rate
    });
    let signal = |values: Option<Vec<f64>>| match values {
        Some(values) => Signal::Samples { period_s: recording.sample_period_s, values },
        None => Signal::ZERO,
    };
    PlatformMotion { pitch_rate_rad_s: signal(corrected), heave_m_s2: signal(heave), initial_angle_rad: 0.0 }
}

/// The series a number of samples earlier: what a delayed one shows.
fn advanced(values: &[f64], samples: f64) -> Vec<f64> {
    if samples == 0.0 {
        return values.to_vec();
    }
    let signal = Signal::Samples { period_s: 1.0, values: values.to_vec() };
    (0..values.len()).map(|k| signal.at(k as f64 + samples)).collect()
}

/// Central differences over the period.
fn slopes(values: &[f64], period_s: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |k: usize| values[k.min(last)];
    (0..values.len())
        .map(|k| {
            let (low, high) = (k.saturating_sub(1), (k + 1).min(last));
            if high == low { 0.0 } else { (at(high) - at(low)) / ((high - low) as f64 * period_s) }
        })
        .collect()
}
