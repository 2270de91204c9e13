//! The recording of an inertial measurement unit: mounting, lever arm and gravity are taken out before it drives a verification.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::base_motion::Traverse;
use counterpoise_pipeline::inertial_unit::inertial_unit;
use counterpoise_project::resolve::base_motion::{InertialUnit, UnitReading};
use counterpoise_recordings::RecordingTable;

const G: f64 = 9.80665;
const RATE_RAD_S: f64 = 3.0;

/// Nose-up angle of a base that pitches, and its first two derivatives.
fn pitch(t: f64) -> [f64; 3] {
    let (sin, cos) = (RATE_RAD_S * t).sin_cos();
    [0.1 * sin, 0.1 * RATE_RAD_S * cos, -0.1 * RATE_RAD_S * RATE_RAD_S * sin]
}

fn surge(t: f64) -> f64 {
    1.5 * (5.0 * t).sin()
}

fn heave(t: f64) -> f64 {
    0.8 * (7.0 * t).cos()
}

/// Returns what a unit reads that stands `arm` (forward, up) behind the pivot on that base and is turned by a half turn
/// about z.
fn record_unit(arm: [f64; 2]) -> RecordingTable {
    let row = |k: i32| {
        let t = 0.002 * f64::from(k);
        let [angle, rate, slope] = pitch(t);
        let (sin, cos) = angle.sin_cos();
        // the pivot's specific force along the base, then the unit's, which lies at -arm: a' = a - w' x r - w x (w x r)
        let (level, up) = (surge(t), G + heave(t));
        let (forward, upward) = (level * cos + up * sin, up * cos - level * sin);
        let [x, z] = arm;
        let forward = forward + slope * z + rate * rate * x;
        let upward = upward - slope * x + rate * rate * z;
        format!("{t},{},0,{upward},0,{rate},0\n", -forward)
    };
    let rows: String = (0..10_001).map(row).collect();
    let header = "time [s],ax [m/s^2],ay [m/s^2],az [m/s^2],wx [rad/s],wy [rad/s],wz [rad/s]\n";
    RecordingTable::read((header.to_owned() + &rows).as_bytes(), "unit.csv").unwrap()
}

fn unit() -> InertialUnit {
    let columns = |names: [&str; 3]| names.map(str::to_owned);
    InertialUnit {
        recording: "unit.csv".to_owned(),
        acceleration: columns(["ax", "ay", "az"]),
        rate: columns(["wx", "wy", "wz"]),
        reading: UnitReading::SpecificForce,
        mounting_rad: [0.0, 0.0, std::f64::consts::PI],
        lever_arm_m: [0.6, 0.0, 0.4],
        traverse: Traverse::default(),
        low_pass_hz: None,
        start_s: 0.0,
        // whole periods of every tone: the means are those of the instruments alone
        duration_s: 6.0 * std::f64::consts::PI,
        fade_s: 0.0,
    }
}

#[test]
fn the_pivot_s_motion_comes_back_without_gravity() {
    let made = inertial_unit(&unit(), &record_unit([0.6, 0.4])).unwrap();
    let worst = |found: &[f64], truth: &dyn Fn(f64) -> f64| {
        let off: Vec<f64> = found.iter().enumerate().map(|(k, v)| v - truth(0.002 * k as f64)).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        off.iter().map(|v| (v - mean).abs()).fold(0.0, f64::max)
    };
    let (up, forward) = (worst(made.heave_m_s2(), &heave), worst(made.surge_m_s2(), &surge));
    let rate = worst(made.pitch_rate_rad_s(), &|t| pitch(t)[1]);
    assert!(up < 0.01 && forward < 0.02 && rate < 1e-4, "{up} {forward} {rate}");
    assert!(made.roll_rate_rad_s().iter().chain(made.yaw_rate_rad_s()).all(|rate| rate.abs() < 1e-12));
}

#[test]
fn a_lever_arm_that_is_left_out_appears_as_surge_and_heave() {
    let without = InertialUnit { lever_arm_m: [0.0; 3], ..unit() };
    let made = inertial_unit(&without, &record_unit([0.6, 0.4])).unwrap();
    let off = made.heave_m_s2().iter().enumerate().map(|(k, v)| (v - heave(0.002 * k as f64)).abs());
    assert!(off.fold(0.0, f64::max) > 0.4);
}

#[test]
fn a_column_that_is_missing_is_told() {
    let wrong = InertialUnit { rate: ["wx", "wy", "gz"].map(str::to_owned), ..unit() };
    assert!(inertial_unit(&wrong, &record_unit([0.0; 2])).unwrap_err().to_string().contains("gz"));
    let long = InertialUnit { duration_s: 50.0, ..unit() };
    assert!(inertial_unit(&long, &record_unit([0.0; 2])).is_err());
}
