//! The sensor of the controlled output, each kind a section of its own: gyroscope, tachometer, encoder, resolver, torque or current.
//!
//! Without any, the loop has an ideal rate gyroscope.

use counterpoise_models::{AxisKind, Drift, FeedbackSignal, Parameters, Sensor, Sensors};
use std::f64::consts::TAU;

use super::axis_words::{Words, turning_of_motor};
use super::digits::shortest_that_gives;
use super::sensor::{self, IDEAL_SCALE, SensorKind, gyroscope, sensor};
use crate::file::field::{Field, NumberRange, TableField, UsualRange};
use crate::file::visit::{NamedChoice, Presence, Visit, choose};

/// A loop's sensor of which nothing is written: ideal, with a range beyond every motion.
pub(super) const UNKNOWN: Sensor = Sensor { scale_v_unit: IDEAL_SCALE, ..Sensor::IDEAL };

/// Returns the section of the loop's sensor where its readings go through a converter.
fn section_of_analogue(measured: FeedbackSignal) -> &'static str {
    match measured {
        FeedbackSignal::HubRate => "hub_gyro",
        FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate => "tachometer",
        FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition => "resolver",
        FeedbackSignal::Torque => "torque",
        FeedbackSignal::Current => "current",
    }
}

/// Returns the section of the loop's sensor.
pub(super) fn section_of(sensors: &Sensors) -> &'static str {
    if sensors.hub_gyro.resolution > 0.0 {
        return "encoder";
    }
    section_of_analogue(sensors.measured)
}

/// The place of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Load,
    Motor,
}

impl NamedChoice for Place {
    const NAMES: &'static [(&'static str, Self)] = &[("load", Self::Load), ("motor", Self::Motor)];
}

const PLACE: Field = Field::new(
    "place",
    "where it sits: on the load, or on the motor's shaft, in whose terms noise, bias and scale then are; the controller divides its readings by the ratio",
)
.or_text("load");

/// What the loop takes from an encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
enum EncoderReading {
    Angle,
    Rate,
}

impl NamedChoice for EncoderReading {
    const NAMES: &'static [(&'static str, Self)] = &[("angle", Self::Angle), ("rate", Self::Rate)];
}

impl EncoderReading {
    /// Returns the measured quantity at a place.
    fn at(self, place: Place) -> FeedbackSignal {
        match (self, place) {
            (Self::Angle, Place::Load) => FeedbackSignal::HubPosition,
            (Self::Angle, Place::Motor) => FeedbackSignal::MotorPosition,
            (Self::Rate, Place::Load) => FeedbackSignal::RelativeRate,
            (Self::Rate, Place::Motor) => FeedbackSignal::MotorRate,
        }
    }
}

const SHOWS: Field = Field::new(
    "reads",
    "what the controller takes from it: the angle, or the rate as the difference of two angles over the time between them, as a loop of speed does",
)
.or_text("angle");

/// Keys of a gyroscope that is not stated.
const OF_GYROSCOPE: [&str; 3] = ["hub_gyro.noise", "hub_gyro.delay", "hub_gyro.natural_frequency"];

/// Reads or lists the loop's sensor.
pub(super) fn loop_sensor(v: &mut dyn Visit, plant: &mut Parameters) {
    let (axis, measured, mut found) = (plant.axis, plant.sensors.measured, 0);
    let digital = plant.sensors.hub_gyro.resolution > 0.0;
    let gyro = TableField::optional("hub_gyro", "inertial rate of the hub");
    let there = measured == FeedbackSignal::HubRate && plant.sensors.hub_gyro != UNKNOWN;
    if Words::of(axis, v).enter(&gyro, Presence::from(there)) {
        gyroscope(&mut Words::of(axis, v), &mut plant.sensors.hub_gyro);
        found += measures(plant, FeedbackSignal::HubRate, found);
        v.leave();
        refuse_on_slide(v, axis);
    }
    let rate = matches!(measured, FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate) && !digital;
    if Words::of(axis, v).enter(
        &TableField::optional("tachometer", "rate relative to the platform, which the loop controls"),
        Presence::from(rate),
    ) {
        let mut place = if measured == FeedbackSignal::MotorRate { Place::Motor } else { Place::Load };
        choose(v, &PLACE, &mut place);
        placed_sensor(v, plant, place, "rad/s");
        let rates = [FeedbackSignal::RelativeRate, FeedbackSignal::MotorRate];
        found += measures(plant, rates[usize::from(place == Place::Motor)], found);
        v.leave();
    }
    found += angle_sensors(v, plant, PresentReading { measured, is_digital: digital }, found);
    found += efforts(&mut Words::of(axis, v), plant, found);
    not_alone(&mut Words::of(axis, v));
    if found == 0 {
        assume_gyroscope(&mut Words::of(axis, v), OF_GYROSCOPE);
    }
    if found > 1 {
        refuse_several(v);
    }
}

/// What the loop reads before its sensors are read from the file.
#[derive(Clone, Copy)]
struct PresentReading {
    measured: FeedbackSignal,
    /// `true` if it has steps.
    is_digital: bool,
}

/// Reads or lists the sensors of an angle, given how many sensors were found before; returns how many there are.
fn angle_sensors(v: &mut dyn Visit, plant: &mut Parameters, present: PresentReading, before: usize) -> usize {
    let (axis, PresentReading { measured, is_digital }) = (plant.axis, present);
    let mut found = 0;
    for (key, meaning, there) in [
        (
            ENCODER,
            "angle relative to the platform in counts: the loop controls it or, by the difference of two readings, its rate",
            is_digital,
        ),
        (
            "resolver",
            "angle relative to the platform, which the loop controls",
            measured.is_position() && !is_digital,
        ),
    ] {
        if Words::of(axis, v).enter(&TableField::optional(key, meaning), Presence::from(there)) {
            let reading = angle_sensor(v, plant, measured, key);
            found += measures(plant, reading, before + found);
            v.leave();
        }
    }
    found
}

/// Key of an encoder.
const ENCODER: &str = "encoder";

/// Reads or lists a sensor of an angle; returns what the loop measures by it.
fn angle_sensor(
    v: &mut dyn Visit,
    plant: &mut Parameters,
    measured: FeedbackSignal,
    key: &str,
) -> FeedbackSignal {
    let on_motor = matches!(measured, FeedbackSignal::MotorPosition | FeedbackSignal::MotorRate);
    let mut place = if on_motor { Place::Motor } else { Place::Load };
    choose(v, &PLACE, &mut place);
    if plant.axis == AxisKind::Linear && place == Place::Load && v.has("counts") {
        let allowed = "must be \"motor\" for an encoder with counts a turn";
        let hint = "an encoder on the motor: place = \"motor\"; a scale along the slide: resolution = \"1 um\" in place of `counts`";
        v.complain("place", allowed, Some(hint.to_owned()));
        place = Place::Motor;
    }
    let is_differenced = plant.sensors.hub_gyro.is_differenced;
    let mut reading = if is_differenced { EncoderReading::Rate } else { EncoderReading::Angle };
    if key == ENCODER {
        resolution(v, plant, place);
        choose(v, &SHOWS, &mut reading);
        plant.sensors.hub_gyro.is_differenced = reading == EncoderReading::Rate;
    }
    placed_sensor(v, plant, place, if reading == EncoderReading::Rate { "rad/s" } else { "rad" });
    reading.at(place)
}

/// Notes what is assumed of the gyroscope of a loop of which no sensor is stated, given the paths of its noise, delay and natural frequency.
pub(super) fn assume_gyroscope(v: &mut dyn Visit, [noise, delay, natural_frequency]: [&'static str; 3]) {
    let field = Field::new(noise, "RMS of the noise, white at the sample rate").unit("rad/s");
    let source = "what is left out is ideal; a first design takes 0.01 deg/s per root hertz";
    v.assume(&field.with_assumption("none, as in an ideal gyroscope", source, UsualRange::Unknown), 0.0);
    v.assume(&Field { key: delay, ..sensor::delay(SensorKind::Gyroscope) }, 0.0);
    let frequency = sensor::natural_frequency(SensorKind::Gyroscope);
    v.assume(&Field { key: natural_frequency, ..frequency }, f64::INFINITY);
}

/// Reports that the loop has more than one sensor.
fn refuse_several(v: &mut dyn Visit) {
    v.complain(
        "",
        "must have one sensor of the loop: hub_gyro, tachometer, encoder, resolver, torque or current",
        Some("remove all of these but one; other sensors of the machine are motor_tachometer, hub_resolver and those of the platform".to_owned()),
    );
}

/// Reports a gyroscope on a slide, which does not turn.
fn refuse_on_slide(v: &mut dyn Visit, axis: AxisKind) {
    if axis == AxisKind::Linear {
        let allowed = "is no sensor of a slide: it measures a rate of rotation";
        let hint =
            "write tachometer for a loop of speed, or encoder or resolver for one of position, in its place";
        v.complain("hub_gyro", allowed, Some(hint.to_owned()));
    }
}

/// Reads or lists a sensor in the terms of what it sits on.
fn placed_sensor(v: &mut dyn Visit, plant: &mut Parameters, place: Place, unit: &'static str) {
    let (axis, ratio) = (plant.axis, plant.gearbox.ratio);
    if place == Place::Load || ratio == 1.0 {
        return sensor(&mut Words::of(axis, v), &mut plant.sensors.hub_gyro, unit);
    }
    let at_load = &plant.sensors.hub_gyro;
    let of_shaft = |value: f64| shortest_that_gives(value, value * ratio, |own| own / ratio);
    let mut own = in_terms_of(at_load, of_shaft);
    let scale_v_unit = at_load.scale_v_unit;
    own.scale_v_unit = shortest_that_gives(scale_v_unit, scale_v_unit / ratio, |own| own * ratio);
    sensor(&mut Words::of(turning_of_motor(plant), v), &mut own, unit);
    let scale_v_unit = own.scale_v_unit * ratio;
    plant.sensors.hub_gyro = Sensor { scale_v_unit, ..in_terms_of(&own, |value| value / ratio) };
}

/// Returns a sensor with everything that is in the unit of its reading in other terms.
fn in_terms_of(sensor: &Sensor, terms: impl Fn(f64) -> f64) -> Sensor {
    let drift = Drift {
        angle_random_walk: terms(sensor.drift.angle_random_walk),
        bias_instability: terms(sensor.drift.bias_instability),
        rate_random_walk: terms(sensor.drift.rate_random_walk),
    };
    Sensor {
        noise_rms: terms(sensor.noise_rms),
        bias: terms(sensor.bias),
        g_sensitivity: terms(sensor.g_sensitivity),
        drift,
        ..sensor.clone()
    }
}

/// Why an accelerometer cannot be the sensor of a loop, and what to add.
const DRIFTS: &str = "cannot be the sensor of the loop: it does not see a steady rate, so its bias would make the rate drift without end";
const SEES_RATE: &str = "add hub_gyro or tachometer for a loop of rate, encoder or resolver for one of position, and leave the accelerometer out; one on the platform is platform_accelerometer";

/// Complains of an accelerometer, which cannot be the only sensor of a loop.
fn not_alone(v: &mut dyn Visit) {
    if v.has("accelerometer") && v.enter(&TableField::optional("accelerometer", DRIFTS), Presence::Absent) {
        sensor(v, &mut UNKNOWN.clone(), "m/s^2");
        v.leave();
        v.complain("accelerometer", DRIFTS, Some(SEES_RATE.to_owned()));
    }
}

/// Reads or lists a sensor of torque and one of current; returns how many there are.
fn efforts(v: &mut dyn Visit, plant: &mut Parameters, found: usize) -> usize {
    let measured = plant.sensors.measured;
    let torque_unit = match plant.axis {
        AxisKind::Rotary => "N m",
        AxisKind::Linear => "N",
    };
    let mut count = 0;
    for (key, meaning, of, unit) in [
        (
            "torque",
            "torque or force that the transmission passes to the load, which the loop controls",
            FeedbackSignal::Torque,
            torque_unit,
        ),
        ("current", "current of the motor, which the loop controls", FeedbackSignal::Current, "A"),
    ] {
        if v.enter(&TableField::optional(key, meaning), Presence::from(measured == of)) {
            sensor(v, &mut plant.sensors.hub_gyro, unit);
            count += measures(plant, of, found + count);
            v.leave();
        }
    }
    count
}

/// Sets what the loop's sensor measures, if `found` sensors before it are none: the first one of a file counts. Returns 1.
fn measures(plant: &mut Parameters, measured: FeedbackSignal, found: usize) -> usize {
    if found == 0 {
        plant.sensors.measured = measured;
    }
    1
}

/// Reads or lists the step of an encoder: by the counts a turn of what it sits on, or as a length of a linear scale.
fn resolution(v: &mut dyn Visit, plant: &mut Parameters, place: Place) {
    let scale_of_a_slide = place == Place::Load && plant.axis == AxisKind::Linear;
    let known = plant.sensors.hub_gyro.resolution;
    if scale_of_a_slide {
        let step = Field::new("resolution", "step of the linear scale")
            .unit("m")
            .limit(NumberRange::Above(0.0))
            .or(IDEAL_STEP_M)
            .with_assumption(
                "1 pm: steps that nothing feels",
                "an ideal scale",
                UsualRange::Values(1e-9, 1e-5),
            );
        v.number(&step, &mut plant.sensors.hub_gyro.resolution);
        return;
    }
    let turn = if place == Place::Motor { TAU / plant.gearbox.ratio } else { TAU };
    let mut counts = (turn / known).round();
    let field =
        Field::new("counts", "steps a turn").unit(COUNTS).limit(NumberRange::AtLeast(1.0)).or(IDEAL_COUNTS);
    let field = field.with_assumption(
        "2^32: steps that nothing feels",
        "an ideal encoder",
        UsualRange::Values(1e3, 1e7),
    );
    v.number(&field, &mut counts);
    plant.sensors.hub_gyro.resolution = turn / counts;
}

/// Unit of an encoder's steps a turn, which may also be written in bits, "16 bit".
const COUNTS: &str = "counts";
/// Step of a linear scale of which nothing is known, m.
const IDEAL_STEP_M: f64 = 1e-12;
/// Counts a turn of an encoder of which nothing is known.
const IDEAL_COUNTS: f64 = 4_294_967_296.0;
