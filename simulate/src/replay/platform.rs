//! The platform's motion from the readings of its sensors.

use super::smoother::sensor_input;
use crate::motion::{FurtherMotion, PlatformMotion};
use crate::signal::Signal;
use counterpoise_models::plant::SensorErrors;
use counterpoise_models::{AccelerometerAxis, Alignment, Interface, LearnedPlace, Parameters, Sensor};
use counterpoise_recordings::{Channel, Recording, repeat_last};

/// Returns the sensor of a machine that a channel is the reading of; `None` for a channel without one, or one that is not fitted.
pub fn sensor_of(parameters: &Parameters, channel: Channel) -> Option<&Sensor> {
    let sensors = &parameters.sensors;
    match channel {
        Channel::HubRate => Some(&sensors.hub_gyro),
        Channel::PlatformRate => Some(&sensors.platform_gyro),
        Channel::PlatformAccel => Some(&sensors.platform_accelerometer),
        Channel::MotorRate => sensors.motor_tachometer.as_ref(),
        Channel::HubPosition => sensors.hub_resolver.as_ref(),
        Channel::PlatformSurge => sensors.surge_accelerometer.as_ref(),
        Channel::Demand
        | Channel::Control
        | Channel::MotorPosition
        | Channel::MotorCurrent
        | Channel::PlatformRoll
        | Channel::PlatformYaw => None,
    }
}

/// Returns the RMS of what noise and quantisation add to a reading, in the measured unit: the root of the sum of the squares of
/// the noise and of the converter's step over the root of 12.
pub fn reading_floor(sensor: &Sensor, interface: &Interface) -> f64 {
    sensor.white_noise_rms(interface.sample_period_s).hypot(interface.reading_step(sensor) / 12f64.sqrt())
}

/// Returns the motion of the platform that its sensors have seen, their errors (gain, bias, delay, lever arm, g-sensitivity)
/// as the parameters have them taken out; the platform is level at the start, for no sensor says otherwise.
///
/// Rate and heave come from a smoother that deconvolves the sensor and shrinks to a constant if there is nothing
/// but noise. A platform without the sensor is still.
pub fn platform_motion(parameters: &Parameters, recording: &Recording) -> PlatformMotion {
    PlatformSensorInputs::new(parameters, recording, None).motion(parameters, recording.sample_period_s)
}

/// The motion that the platform's sensors were given, before their gain, bias and delay are taken out: the costly part, which many
/// mechanisms share.
#[derive(Debug, Clone)]
pub(crate) struct PlatformSensorInputs {
    rate: SensorInput,
    heave: SensorInput,
    /// Input of the sensor of surge, if the machine has one.
    surge: Option<SensorInput>,
    /// Recorded rates about the platform's forward and upward axes, rad/s.
    turning: Option<[Signal; 2]>,
    /// Mean of the recorded hub position, rad; 0 if it was not recorded.
    elevation_rad: f64,
}

/// The input of one sensor, and the dynamics that were taken out.
#[derive(Debug, Clone)]
struct SensorInput {
    dynamics: Sensor,
    noise: f64,
    input: Option<Vec<f64>>,
}

/// The readings of one sensor.
struct Column<'a> {
    /// One value a sample; `None` if the sensor was not recorded.
    values: Option<&'a [f64]>,
    period_s: f64,
}

impl SensorInput {
    /// Deconvolves the readings, unless that was done before for the same dynamics and noise.
    fn new(sensor: &Sensor, interface: &Interface, readings: &Column, before: Option<&Self>) -> Self {
        let noise = reading_floor(sensor, interface);
        let errorless = Sensor {
            gain: 1.0,
            bias: 0.0,
            delay_s: 0.0,
            g_sensitivity: 0.0,
            alignment: Alignment::NOMINAL,
            ..sensor.clone()
        };
        match before.filter(|b| b.dynamics == errorless && b.noise == noise) {
            Some(same) => same.clone(),
            None => {
                let input =
                    readings.values.map(|values| sensor_input(values, sensor, noise, readings.period_s));
                Self { dynamics: errorless, noise, input }
            }
        }
    }

    /// Returns the input with gain, bias and delay taken out; `None` if it was not recorded, or the machine has no such sensor and
    /// its column says nothing.
    fn corrected_input(
        &self,
        sensor: &Sensor,
        errors: Option<&SensorErrors>,
        period_s: f64,
    ) -> Option<Vec<f64>> {
        if !sensor.is_fitted() {
            return None;
        }
        let late = sensor.mean_delay_samples(period_s);
        let advanced = advance_series(self.input.as_deref()?, late);
        let one = |(k, value): (usize, f64)| {
            let read = errors.map_or(value, |e| e.corrected_reading(value, k as f64 * period_s));
            (read - sensor.bias) / sensor.gain
        };
        Some(advanced.into_iter().enumerate().map(one).collect())
    }
}

impl PlatformSensorInputs {
    /// Deconvolves both sensors' readings; what was done before for the same dynamics is kept.
    pub(crate) fn new(parameters: &Parameters, recording: &Recording, before: Option<&Self>) -> Self {
        let (sensors, interface) = (&parameters.sensors, &parameters.interface);
        let period_s = recording.sample_period_s;
        let rate = Column { values: recording.samples(Channel::PlatformRate), period_s };
        let heave = Column { values: recording.samples(Channel::PlatformAccel), period_s };
        let gyro = before.map(|b| &b.rate);
        let accelerometer = before.map(|b| &b.heave);
        let surge = Column { values: recording.samples(Channel::PlatformSurge), period_s };
        let forward = before.and_then(|b| b.surge.as_ref());
        Self {
            rate: SensorInput::new(&sensors.platform_gyro, interface, &rate, gyro),
            heave: SensorInput::new(&sensors.platform_accelerometer, interface, &heave, accelerometer),
            surge: sensors
                .surge_accelerometer
                .as_ref()
                .map(|sensor| SensorInput::new(sensor, interface, &surge, forward)),
            turning: turning_rates(recording),
            elevation_rad: mean_position(recording),
        }
    }

    /// Returns the motion of the platform with the sensors' errors taken out.
    pub(crate) fn motion(&self, parameters: &Parameters, period_s: f64) -> PlatformMotion {
        let sensors = &parameters.sensors;
        let errors = |place| SensorErrors::of(parameters, place);
        let (of_gyro, of_heave) =
            (errors(LearnedPlace::PlatformGyro), errors(LearnedPlace::PlatformAccelerometer));
        let rate = self.rate.corrected_input(&sensors.platform_gyro, of_gyro.as_ref(), period_s);
        let heave = self.heave.corrected_input(&sensors.platform_accelerometer, of_heave.as_ref(), period_s);
        let surge = self.surge.as_ref().zip(sensors.surge_accelerometer.as_ref());
        let mut felt = PlatformInputs {
            rate,
            heave,
            surge: surge.and_then(|(found, sensor)| found.corrected_input(sensor, None, period_s)),
        };
        felt.take_cross_axis_out(parameters, self.turning.as_ref(), period_s);
        felt.take_lever_arm_out(parameters, period_s);
        felt.take_tilt_out(parameters, self.elevation_rad);
        let surge = felt.surge.take();
        let mut motion = felt.motion(parameters, period_s);
        if surge.is_some() || self.turning.is_some() {
            let [roll_rate_rad_s, yaw_rate_rad_s] =
                self.turning.clone().unwrap_or([Signal::ZERO, Signal::ZERO]);
            let surge_m_s2 = surge.map_or(Signal::ZERO, |values| Signal::Samples { period_s, values });
            motion.further = Some(FurtherMotion { surge_m_s2, roll_rate_rad_s, yaw_rate_rad_s });
        }
        match sensors.accelerometer_axis {
            AccelerometerAxis::Vertical => motion,
            AccelerometerAxis::Elevated => {
                along_normal(motion, self.elevation_rad + sensors.platform_accelerometer.alignment.tilt_rad)
            }
        }
    }
}

/// Returns the recorded rates about the platform's forward and upward axes; `None` if neither was recorded.
fn turning_rates(recording: &Recording) -> Option<[Signal; 2]> {
    let channels = [Channel::PlatformRoll, Channel::PlatformYaw];
    if !channels.iter().any(|channel| recording.has(*channel)) {
        return None;
    }
    let period_s = recording.sample_period_s;
    let signal = |channel| match recording.samples(channel) {
        Some(values) => Signal::Samples { period_s, values: repeat_last(values) },
        None => Signal::ZERO,
    };
    Some(channels.map(signal))
}

/// The motion that the platform's sensors felt; `None` for one that was not recorded.
struct PlatformInputs {
    /// Pitch rate, rad/s.
    rate: Option<Vec<f64>>,
    /// Heave, m/s^2.
    heave: Option<Vec<f64>>,
    /// Surge, m/s^2.
    surge: Option<Vec<f64>>,
}

impl PlatformInputs {
    /// Takes what a misaligned gyroscope reads about other axes out of the pitch rate. The axes of the recorded rates and those of the platform
    /// differ by its pitch angle, which is small beside the misalignment itself.
    fn take_cross_axis_out(&mut self, parameters: &Parameters, turning: Option<&[Signal; 2]>, period_s: f64) {
        let alignment = parameters.sensors.platform_gyro.alignment;
        let (Some(rate), Some([roll, yaw])) = (self.rate.as_mut(), turning) else { return };
        if !alignment.has_cross_axis() {
            return;
        }
        for (k, value) in rate.iter_mut().enumerate() {
            let time_s = k as f64 * period_s;
            *value -=
                alignment.roll_sensitivity * roll.at(time_s) + alignment.yaw_sensitivity * yaw.at(time_s);
        }
    }

    /// Takes the pitch acceleration that a lever arm adds out of the heave.
    fn take_lever_arm_out(&mut self, parameters: &Parameters, period_s: f64) {
        let arm = parameters.sensors.accelerometer_lever_arm_m;
        if let (Some(heave), Some(rate), true) = (self.heave.as_mut(), self.rate.as_ref(), arm != 0.0) {
            let slope = slopes(rate, period_s);
            heave.iter_mut().zip(slope).for_each(|(h, a)| *h -= arm * a);
        }
    }

    /// Takes what tilted accelerometers feel along other axes out of heave and surge: with the tilts t and t_x their readings are
    /// a cos(t) - a_x sin(t) + g (cos(t) - 1) and a_x cos(t_x) + (a + g) sin(t_x). One on the elevated mass keeps its axis and loses the
    /// constant alone.
    fn take_tilt_out(&mut self, parameters: &Parameters, elevation_rad: f64) {
        let (sensors, gravity) = (&parameters.sensors, parameters.gravity_m_s2);
        let tilt = sensors.platform_accelerometer.alignment.tilt_rad;
        let surge_tilt = sensors.surge_accelerometer.as_ref().map_or(0.0, |one| one.alignment.tilt_rad);
        if tilt == 0.0 && surge_tilt == 0.0 {
            return;
        }
        let (surge_sin, surge_cos) = surge_tilt.sin_cos();
        let Some(heave) = self.heave.as_mut() else {
            let alone = |value: &mut f64| *value = (*value - gravity * surge_sin) / surge_cos;
            return self.surge.iter_mut().flatten().for_each(alone);
        };
        if sensors.accelerometer_axis == AccelerometerAxis::Elevated {
            let constant = gravity * ((elevation_rad + tilt).cos() - elevation_rad.cos());
            return heave.iter_mut().for_each(|value| *value -= constant);
        }
        let (sin, cos) = tilt.sin_cos();
        let Some(surge) = self.surge.as_mut() else {
            return heave.iter_mut().for_each(|value| *value = (*value - gravity * (cos - 1.0)) / cos);
        };
        let determinant = cos * surge_cos + sin * surge_sin;
        for (up, forward) in heave.iter_mut().zip(surge) {
            let (read_up, read_forward) = (*up - gravity * (cos - 1.0), *forward - gravity * surge_sin);
            *up = (read_up * surge_cos + read_forward * sin) / determinant;
            *forward = (read_forward * cos - read_up * surge_sin) / determinant;
        }
    }

    /// Returns the motion in pitch and heave, with the gyroscope's g-sensitivity taken out.
    fn motion(self, parameters: &Parameters, period_s: f64) -> PlatformMotion {
        let gyro = &parameters.sensors.platform_gyro;
        let heave = self.heave;
        let corrected = self.rate.map(|mut rate| {
            let sensitivity = gyro.g_sensitivity / gyro.gain;
            if let (Some(heave), true) = (heave.as_ref(), sensitivity != 0.0) {
                rate.iter_mut().zip(heave).for_each(|(r, h)| *r -= sensitivity * h);
            }
            rate
        });
        let signal = |values: Option<Vec<f64>>| match values {
            Some(values) => Signal::Samples { period_s, values },
            None => Signal::ZERO,
        };
        PlatformMotion {
            pitch_rate_rad_s: signal(corrected),
            heave_m_s2: signal(heave),
            ..PlatformMotion::STILL
        }
    }
}

/// Returns the motion with the readings of an accelerometer on the elevated mass, which stand in the place of heave, split into heave and surge along
/// the normal of the beam at its mean elevation: what acts across it is not felt.
fn along_normal(motion: PlatformMotion, elevation_rad: f64) -> PlatformMotion {
    let (sin, cos) = elevation_rad.sin_cos();
    let share = |factor: f64| match &motion.heave_m_s2 {
        Signal::Samples { period_s, values } => {
            Signal::Samples { period_s: *period_s, values: values.iter().map(|v| factor * v).collect() }
        }
        other => other.clone(),
    };
    let (heave_m_s2, surge_m_s2) = (share(cos), share(-sin));
    let still = || FurtherMotion {
        surge_m_s2: Signal::ZERO,
        roll_rate_rad_s: Signal::ZERO,
        yaw_rate_rad_s: Signal::ZERO,
    };
    let turning = motion.further.clone().unwrap_or_else(still);
    PlatformMotion { heave_m_s2, further: Some(FurtherMotion { surge_m_s2, ..turning }), ..motion }
}

fn mean_position(recording: &Recording) -> f64 {
    let known = recording.samples(Channel::HubPosition).unwrap_or_default();
    let (sum, count) = known.iter().filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Returns the series a number of samples earlier: what a delayed one shows.
fn advance_series(values: &[f64], samples: f64) -> Vec<f64> {
    if samples == 0.0 {
        return values.to_vec();
    }
    let signal = Signal::Samples { period_s: 1.0, values: values.to_vec() };
    (0..values.len()).map(|k| signal.at(k as f64 + samples)).collect()
}

/// Returns the central differences over the period.
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
