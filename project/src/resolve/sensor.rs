//! The keys that every sensor has, whatever it measures.

use counterpoise_models::{Drift, Sensor};

use crate::assumption::{
    LATEST_USUAL_COUNT_S, LATEST_USUAL_READING_S, SLOWEST_USUAL_COUNT_RAD_S, SLOWEST_USUAL_GYROSCOPE_RAD_S,
    SLOWEST_USUAL_READING_RAD_S,
};
use crate::file::field::{Field, NumberRange, UsualRange};
use crate::file::visit::Visit;
use crate::tolerance::MOST_TILT_RAD;

const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
const ABOVE_0: NumberRange = NumberRange::Above(0.0);
/// Volts per unit of a sensor of which nothing is known: its range is beyond every motion.
pub(super) const IDEAL_SCALE: f64 = 1e-3;

/// Returns units of a sensor's scale, in volts per unit, and of its error per acceleration.
fn units_of(measured: &'static str) -> (&'static str, &'static str) {
    match measured {
        "rad/s" => ("V s/rad", "(rad/s)/(m/s^2)"),
        "rad" => ("V/rad", "rad/(m/s^2)"),
        "N m" => ("V/(N m)", "N m/(m/s^2)"),
        "N" => ("V/N", "N/(m/s^2)"),
        "A" => ("V/A", "A/(m/s^2)"),
        _ => ("V/(m/s^2)", "(m/s^2)/(m/s^2)"),
    }
}

/// Reads or lists what every sensor has: its dynamics, scale, noise and errors. `unit` is that of the measured quantity.
pub(super) fn sensor(v: &mut dyn Visit, sensor: &mut Sensor, unit: &'static str) {
    let kind = SensorKind::of(sensor, unit);
    sensor_of_kind(v, sensor, unit, kind);
}

fn sensor_of_kind(v: &mut dyn Visit, sensor: &mut Sensor, unit: &'static str, kind: SensorKind) {
    let (scale_unit, per_acceleration) = units_of(unit);
    v.number(&natural_frequency(kind), &mut sensor.natural_frequency_rad_s);
    v.number(
        &Field::new("damping_ratio", "damping ratio of the sensor").limit(ABOVE_0).or(0.7),
        &mut sensor.damping_ratio,
    );
    let scale = Field::new("scale", "voltage at the converter per unit of the measured quantity");
    let scale = scale.unit(scale_unit).limit(ABOVE_0).or(IDEAL_SCALE).with_assumption(
        "0.001: a range of 10 000 units",
        "an ideal sensor has no range",
        UsualRange::Unknown,
    );
    v.number(&scale, &mut sensor.scale_v_unit);
    let noise = Field::new("noise", "RMS of the noise, white at the sample rate");
    v.number(&noise.unit(unit).limit(AT_LEAST_0).or(0.0), &mut sensor.noise_rms);
    v.number(
        &Field::new("gain", "factor on the reading; 1 is no error").limit(NumberRange::Not0).or(1.0),
        &mut sensor.gain,
    );
    v.number(&Field::new("bias", "constant error of the reading").unit(unit).or(0.0), &mut sensor.bias);
    v.number(&delay(kind), &mut sensor.delay_s);
    v.number(
        &Field::new("g_sensitivity", "error of the reading per m/s^2 of heave")
            .unit(per_acceleration)
            .or(0.0),
        &mut sensor.g_sensitivity,
    );
    drift(v, &mut sensor.drift, unit);
    let period = "time between two readings of its own, which the controller sees again until the next: whole samples; 0 is one each sample";
    v.number(
        &Field::new("sample_period", period).unit("s").limit(AT_LEAST_0).or(0.0),
        &mut sensor.own_period_s,
    );
}

/// The kinds of sensors of which different lags are usual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SensorKind {
    /// A gyroscope, which filters.
    Gyroscope,
    /// An encoder or a current sensor, whose readings come at once.
    Counter,
    /// Any other.
    Other,
}

impl SensorKind {
    fn of(sensor: &Sensor, unit: &'static str) -> Self {
        if sensor.resolution > 0.0 || unit == "A" { Self::Counter } else { Self::Other }
    }
}

/// Returns the key of a sensor's natural frequency, with what is usual for its kind.
pub(super) fn natural_frequency(kind: SensorKind) -> Field {
    let (source, slowest) = match kind {
        SensorKind::Gyroscope => (
            "what is left out is ideal; gyroscopes usually have 100 Hz or more",
            SLOWEST_USUAL_GYROSCOPE_RAD_S,
        ),
        SensorKind::Counter => (
            "what is left out is ideal; encoders and current sensors usually have 3 kHz or more",
            SLOWEST_USUAL_COUNT_RAD_S,
        ),
        SensorKind::Other => (
            "what is left out is ideal; tachometers, resolvers and torque sensors usually have 300 Hz or more",
            SLOWEST_USUAL_READING_RAD_S,
        ),
    };
    let frequency = Field::new("natural_frequency", "natural frequency of the sensor").unit("rad/s");
    frequency.limit(ABOVE_0).or(f64::INFINITY).with_assumption(
        "unlimited, as in an ideal sensor",
        source,
        UsualRange::Values(slowest, f64::INFINITY),
    )
}

/// Returns the key of a sensor's delay, with what is usual.
pub(super) fn delay(kind: SensorKind) -> Field {
    let (source, latest_s) = match kind {
        SensorKind::Counter => (
            "what is left out is ideal; encoders and current sensors are usually up to 0.1 ms late",
            LATEST_USUAL_COUNT_S,
        ),
        SensorKind::Gyroscope | SensorKind::Other => {
            ("what is left out is ideal; digital sensors are usually up to 2 ms late", LATEST_USUAL_READING_S)
        }
    };
    Field::new("delay", "delay of the reading").unit("s").limit(AT_LEAST_0).or(0.0).with_assumption(
        "none, as in an ideal sensor",
        source,
        UsualRange::Values(0.0, latest_s),
    )
}

/// Reads or lists a rate gyroscope: what every sensor has, and what it reads about other axes.
pub(super) fn gyroscope(v: &mut dyn Visit, gyro: &mut Sensor) {
    sensor_of_kind(v, gyro, "rad/s", SensorKind::Gyroscope);
    let per_rate = |key, meaning| Field::new(key, meaning).unit("rad").or(0.0);
    let about = "reading per inertial rate about the forward axis of what carries it: the angle of a misalignment, or a cross-axis sensitivity";
    v.number(&per_rate("roll_sensitivity", about), &mut gyro.alignment.roll_sensitivity);
    let about = "the same about the upward axis (on the elevated mass, the normal of the beam)";
    v.number(&per_rate("yaw_sensitivity", about), &mut gyro.alignment.yaw_sensitivity);
}

/// Reads or lists an accelerometer: what every sensor has, and the tilt of its axis.
pub(super) fn accelerometer(v: &mut dyn Visit, accelerometer: &mut Sensor) {
    sensor(v, accelerometer, "m/s^2");
    let tilt = "angle of its axis about the elevation axis, positive nose-up: it then reads other shares of heave, surge and gravity";
    v.number(
        &Field::new("tilt", tilt)
            .unit("rad")
            .limit(NumberRange::Between(-MOST_TILT_RAD, MOST_TILT_RAD))
            .or(0.0),
        &mut accelerometer.alignment.tilt_rad,
    );
}

/// Slow errors, as the Allan deviation shows them.
fn drift(v: &mut dyn Visit, drift: &mut Drift, unit: &'static str) {
    let field = |key, meaning| Field::new(key, meaning).unit(unit).limit(AT_LEAST_0).or(0.0);
    let walk = "white noise of any bandwidth: the Allan deviation at 1 s on its slope of -1/2";
    v.number(&field("angle_random_walk", walk), &mut drift.angle_random_walk);
    let flicker = "flicker of the bias: the lowest Allan deviation over 0.664";
    v.number(&field("bias_instability", flicker), &mut drift.bias_instability);
    let rate = "random walk of the bias: the Allan deviation at 3 s on its slope of +1/2";
    v.number(&field("rate_random_walk", rate), &mut drift.rate_random_walk);
}
