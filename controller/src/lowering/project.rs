//! The projection of heave and surge across the beam.

use crate::Projection;
use crate::READINGS;
use crate::lowering::{Limits, States, Update, Writer};
use crate::program::{OnRestart, ProgramTerm, Slot};
use crate::signal::{PLATFORM_ACCELERATION, PLATFORM_RATE, PLATFORM_SURGE};
use crate::tolerance::HIGHEST_ELEVATION_RAD;

/// The inputs of a projection.
pub(super) struct ProjectionInput<'a> {
    /// The corrected readings.
    pub readings: &'a [Slot; READINGS],
    /// Sample period, s.
    pub sample_period_s: f64,
}

/// Writes a_z cos(theta) - a_x sin(theta), and returns where it stands.
pub(super) fn project_across_beam(
    projection: Projection,
    given: &ProjectionInput<'_>,
    states: &mut States,
    writer: &mut Writer,
    pending: &mut Vec<Update>,
) -> Slot {
    writer.section("heave and surge across the beam");
    let (heave, surge) = (given.readings[PLATFORM_ACCELERATION], given.readings[PLATFORM_SURGE]);
    let Some(reading) = projection.angle_reading else {
        let (sin, cos) = projection.design_angle_rad.sin_cos();
        return writer.sum("accel_across_m_s2", &[cos * heave, -sin * surge]);
    };
    let mut angle = given.readings[reading];
    if let Some(washout_s) = projection.pitch_washout_s {
        let pitch = pitch(washout_s, given, states, writer, pending);
        angle = writer.sum("inertial_angle_rad", &[1.0 * angle, 1.0 * pitch]);
    }
    let (sin, cos) = sine_and_cosine(angle, writer);
    let heave = writer.product("heave_across_m_s2", cos, heave);
    let surge = writer.product("surge_across_m_s2", sin, surge);
    writer.sum("accel_across_m_s2", &[1.0 * heave, -1.0 * surge])
}

/// Writes the platform's pitch angle: phi + T (rate - phi / washout), by the implicit step of its lag.
fn pitch(
    washout_s: f64,
    given: &ProjectionInput<'_>,
    states: &mut States,
    writer: &mut Writer,
    pending: &mut Vec<Update>,
) -> Slot {
    let state = states.scalar("platform_pitch_rad", 0.0, OnRestart::Restart);
    let keep = washout_s / (washout_s + given.sample_period_s);
    let rate = given.readings[PLATFORM_RATE];
    let next = writer.sum("platform_pitch_next_rad", &[keep * state, keep * given.sample_period_s * rate]);
    pending.push(Update { state, value: next });
    next
}

/// Writes the sine to the ninth and the cosine to the eighth power of the limited angle.
fn sine_and_cosine(angle: Slot, writer: &mut Writer) -> (Slot, Slot) {
    let theta = writer.clamp("elevation_rad", angle, Limits::symmetric(HIGHEST_ELEVATION_RAD));
    let square = writer.product("elevation_square", theta, theta);
    let fourth = writer.product("elevation_fourth", square, square);
    let sixth = writer.product("elevation_sixth", square, fourth);
    let eighth = writer.product("elevation_eighth", fourth, fourth);
    let mut series = |name: &str, divisors: [f64; 4]| {
        let into = writer.local(name);
        let powers = [square, fourth, sixth, eighth];
        let signs = [-1.0, 1.0, -1.0, 1.0];
        let terms: Vec<ProgramTerm> = (0..4).map(|i| signs[i] / divisors[i] * powers[i]).collect();
        writer.sum_into(into, Some(1.0), &terms);
        into
    };
    let cos = series("elevation_cosine", [2.0, 24.0, 720.0, 40_320.0]);
    let ratio = series("elevation_sine_ratio", [6.0, 120.0, 5040.0, 362_880.0]);
    (writer.product("elevation_sine", theta, ratio), cos)
}
