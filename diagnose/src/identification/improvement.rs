//! The mechanism with what was identified in place of what the project said.

use counterpoise_models::Parameters;
use counterpoise_models::parameters::MapPoint;

use super::outcome::{Estimate, Identification, IdentifiedAmplifier};
use crate::tolerance::identification::{DIGITS, LINEAR_FROM_SHARE};

/// Returns the mechanism with the identified values of the first state of balance. A value stays where its interval holds what
/// the project says. Friction changes at the pivot, the motor's part is kept, unless there is too little for that: then both
/// shrink alike. Inertia changes in hub and beam alike.
pub fn apply_identified(p: &Parameters, found: &Identification) -> Parameters {
    let mut out = apply_except_amplifier(p, found);
    if let IdentifiedAmplifier::Curve { points } = &found.amplifier {
        out.amplifier.map = map(p, points.iter().map(|q| [q.input_v, q.current_a]));
        out.amplifier.dead_zone_v = 0.0;
    }
    out
}

/// The same, the amplifier as it was.
pub(super) fn apply_except_amplifier(p: &Parameters, found: &Identification) -> Parameters {
    let mut out = p.clone();
    if let Some(balance) = found.balances.first() {
        inertia(&mut out, balance.out_of_balance_kg_m, balance.inertia_kg_m2);
    }
    let ratio = p.gearbox.ratio;
    if let Some(level) = new_value(found.coulomb_nm) {
        let motor = ratio * p.motor_friction.coulomb_nm();
        let [pivot, motor] = split_level(level, motor);
        out.pivot_friction.law.set_or_add_coulomb_nm(pivot);
        out.motor_friction.law.set_or_add_coulomb_nm(motor / ratio);
    }
    if let Some(level) = new_value(found.viscous_nm_s_rad) {
        let [pivot, motor] = split_level(level, ratio * ratio * p.motor_friction.viscous_nm_s_rad);
        out.pivot_friction.viscous_nm_s_rad = pivot;
        out.motor_friction.viscous_nm_s_rad = motor / (ratio * ratio);
    }
    sensors(&mut out, found);
    out
}

/// The sensors with their identified errors. A misalignment changes the hub gyroscope, because kinematics tell its difference from the platform's alone.
fn sensors(out: &mut Parameters, found: &Identification) {
    let sensors = &mut out.sensors;
    if let Some(arm) = found.sensors.lever_arm_m.and_then(new_value) {
        sensors.accelerometer_lever_arm_m = arm;
    }
    let (hub, platform) = (&mut sensors.hub_gyro.alignment, sensors.platform_gyro.alignment);
    if let Some(roll) = found.sensors.roll_misalignment_rad.and_then(new_value) {
        hub.roll_sensitivity = round_for_file(platform.roll_sensitivity + roll);
    }
    if let Some(yaw) = found.sensors.yaw_misalignment_rad.and_then(new_value) {
        hub.yaw_sensitivity = round_for_file(platform.yaw_sensitivity + yaw);
    }
}

/// The value, where it is another than the project's.
fn new_value(estimate: Estimate) -> Option<f64> {
    (estimate.is_known() && !estimate.holds(estimate.before)).then_some(round_for_file(estimate.value))
}

/// A value to so many digits that a project file can be read: more than any interval is narrow.
fn round_for_file(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = 10_f64.powi(DIGITS - 1 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}

fn inertia(out: &mut Parameters, moment: Estimate, inertia: Estimate) {
    let Some(lumped) = out.lumped.as_mut() else { return };
    if let Some(moment) = new_value(moment) {
        lumped.out_of_balance_kg_m = moment;
    }
    if let Some(total) = new_value(inertia).filter(|total| *total > 0.0) {
        let growth = total / inertia.before;
        lumped.hub_inertia_kg_m2 = round_for_file(growth * lumped.hub_inertia_kg_m2);
        lumped.beam_inertia_kg_m2 = round_for_file(growth * lumped.beam_inertia_kg_m2);
        for link in &mut lumped.chain {
            link.inertia_kg_m2 = round_for_file(growth * link.inertia_kg_m2);
        }
    }
}

/// A level at the hub as the parts of pivot and motor, given the motor's part as it was.
fn split_level(level: f64, motor: f64) -> [f64; 2] {
    let level = level.max(0.0);
    if level >= motor { [level - motor, motor] } else { [0.0, level] }
}

/// The points that rise in input and current, and the start of the linear range.
fn map(p: &Parameters, points: impl Iterator<Item = [f64; 2]>) -> Vec<MapPoint> {
    let top = LINEAR_FROM_SHARE * p.amplifier.input_limit_v;
    let end = [top, p.amplifier.stall_gain_a_v(&p.motor) * p.amplifier.drive_v(top, &p.motor)];
    let mut out: Vec<MapPoint> = Vec::new();
    for [input_v, current_a] in points.filter(|q| q[1] < end[1]).chain([end]) {
        let last = out.last().map_or(0.0, |q| q.current_a);
        if current_a > last {
            out.push(MapPoint { input_v, current_a: round_for_file(current_a) });
        }
    }
    out
}
