//! Sensors that are misaligned, tilted or slower than the controller, against their closed forms, and their replay.
#![allow(clippy::unwrap_used)]

use counterpoise_models::{AccelerometerAxis, Alignment, Parameters, Plant, Sensor, reference};
use counterpoise_recordings::Channel;
use counterpoise_simulate::replay::platform_motion;
use counterpoise_simulate::{
    FurtherMotion, Imperfections, PlatformMotion, Playback, Scenario, Signal, Simulator, TimeHistory,
};

const SAMPLES: usize = 2000;

/// A platform that moves in every way that a sensor feels.
fn platform() -> PlatformMotion {
    let sine = |amplitude, rate| Signal::sine(amplitude, rate);
    PlatformMotion {
        pitch_rate_rad_s: sine(0.2, 5.0),
        heave_m_s2: sine(1.5, 7.0),
        initial_angle_rad: 0.0,
        further: Some(FurtherMotion {
            surge_m_s2: sine(2.5, 4.0),
            roll_rate_rad_s: sine(0.4, 6.0),
            yaw_rate_rad_s: sine(-0.3, 3.0),
        }),
    }
}

/// The reference rig whose sensors are ideal, with a second accelerometer, and light enough that its hub stays within the range of the readings.
fn rig() -> Parameters {
    let mut p = reference::rig();
    p.lumped.as_mut().unwrap().out_of_balance_kg_m = 40.0;
    let s = &mut p.sensors;
    (s.hub_gyro, s.platform_gyro) = (Sensor::IDEAL, Sensor::IDEAL);
    (s.platform_accelerometer, s.surge_accelerometer) = (Sensor::IDEAL, Some(Sensor::IDEAL));
    p
}

fn run(p: &Parameters) -> TimeHistory {
    let scenario = Scenario {
        platform: platform(),
        imperfections: Imperfections::None,
        ..Scenario::at_rest(1e-3 * SAMPLES as f64)
    };
    let zeros = vec![0.0; SAMPLES + 1];
    let plant = Plant::from_lumped(p).unwrap();
    Simulator::new(&plant).unwrap().run(&mut Playback::new(&zeros), &scenario).unwrap()
}

/// Largest difference of a column from what it should be at every sample.
fn largest_difference(column: &[f64], expected: impl Fn(usize, f64) -> f64) -> f64 {
    column.iter().enumerate().map(|(k, v)| (v - expected(k, 1e-3 * k as f64)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_misaligned_gyroscope_reads_rates_about_the_axes_of_what_carries_it() {
    let mut p = rig();
    let alignment = Alignment { roll_sensitivity: 0.04, yaw_sensitivity: -0.025, tilt_rad: 0.0 };
    (p.sensors.hub_gyro.alignment, p.sensors.platform_gyro.alignment) = (alignment, alignment);
    let found = run(&p);
    let moved = platform().further.unwrap();
    let about = |time_s: f64, angle: f64| {
        let (roll, yaw) = (moved.roll_rate_rad_s.at(time_s), moved.yaw_rate_rad_s.at(time_s));
        let (sin, cos) = angle.sin_cos();
        0.04 * (roll * cos + yaw * sin) - 0.025 * (yaw * cos - roll * sin)
    };
    let truth = &found.truth;
    let hub = |k: usize, t: f64| truth.hub_rate_rad_s()[k] + about(t, truth.hub_angle_rad()[k]);
    let base = |k: usize, t: f64| truth.platform_rate_rad_s()[k] + about(t, truth.platform_angle_rad()[k]);
    assert!(truth.hub_angle_rad().iter().any(|angle| angle.abs() > 0.02), "the hub moves");
    let worst = [
        largest_difference(found.readings.hub_rate_rad_s(), hub),
        largest_difference(found.readings.platform_rate_rad_s(), base),
    ];
    // the hub's own rate, which the reading has without misalignment too, is integrated to 1e-7 rad/s
    assert!(worst[0] < 2e-7 && worst[1] < 1e-12, "{worst:?}");
}

#[test]
fn a_tilted_accelerometer_reads_other_shares_of_heave_surge_and_gravity() {
    let mut p = rig();
    let g = p.gravity_m_s2;
    p.sensors.platform_accelerometer.alignment.tilt_rad = 0.06;
    p.sensors.surge_accelerometer.as_mut().unwrap().alignment.tilt_rad = -0.03;
    let heave = |t: f64| platform().heave_m_s2.at(t);
    let surge = |t: f64| platform().further.unwrap().surge_m_s2.at(t);
    let found = run(&p);
    let (sin, cos) = 0.06_f64.sin_cos();
    let upward = |_: usize, t: f64| heave(t) * cos - surge(t) * sin + g * (cos - 1.0);
    assert!(largest_difference(found.readings.platform_accel_m_s2(), upward) < 1e-9);
    let (sin, cos) = (-0.03_f64).sin_cos();
    let forward = |_: usize, t: f64| surge(t) * cos + (heave(t) + g) * sin;
    assert!(largest_difference(found.readings.platform_surge_m_s2(), forward) < 1e-9);

    (p.sensors.accelerometer_axis, p.sensors.surge_accelerometer) = (AccelerometerAxis::Elevated, None);
    let found = run(&p);
    let normal = |k: usize, t: f64| {
        let angle = found.truth.hub_angle_rad()[k];
        let (sin, cos) = (angle + 0.06).sin_cos();
        heave(t) * cos - surge(t) * sin + g * (cos - angle.cos())
    };
    assert!(largest_difference(found.readings.platform_accel_m_s2(), normal) < 1e-9);
}

#[test]
fn a_slower_sensor_gives_its_last_reading_again() {
    let mut p = rig();
    p.sensors.platform_gyro.own_period_s = 5e-3;
    let found = run(&p).readings;
    let each = run(&rig()).readings;
    let (found, each) = (found.platform_rate_rad_s(), each.platform_rate_rad_s());
    assert!((0..SAMPLES).all(|k| found[k] == each[k - k % 5]));
    assert_eq!(p.sensors.platform_gyro.mean_delay(1e-3).samples, 2);
}

#[test]
fn a_replay_takes_misalignment_and_tilt_out_again() {
    let mut p = rig();
    p.sensors.platform_gyro.alignment =
        Alignment { roll_sensitivity: 0.05, yaw_sensitivity: 0.03, tilt_rad: 0.0 };
    p.sensors.platform_accelerometer.alignment.tilt_rad = 0.05;
    p.sensors.surge_accelerometer.as_mut().unwrap().alignment.tilt_rad = -0.04;
    let moved = platform().further.unwrap();
    let column = |signal: &Signal| (0..SAMPLES).map(|k| signal.at(1e-3 * k as f64)).collect::<Vec<f64>>();
    let recording = run(&p)
        .readings
        .recording("moving", 1e-3)
        .with(Channel::PlatformRoll, column(&moved.roll_rate_rad_s))
        .with(Channel::PlatformYaw, column(&moved.yaw_rate_rad_s));
    let found = platform_motion(&p, &recording);
    let further = found.further.unwrap();
    let off = |found: &Signal, truth: &Signal| {
        let times = (100..1900).map(|k| 1e-3 * f64::from(k));
        times.map(|t| (found.at(t) - truth.at(t)).abs()).fold(0.0, f64::max)
    };
    // what the smoother leaves of readings without noise, and for the pitch rate the platform's own angle of 0.08 rad times the cross rates
    assert!(off(&found.heave_m_s2, &platform().heave_m_s2) < 2e-3);
    assert!(off(&further.surge_m_s2, &moved.surge_m_s2) < 3e-3);
    assert!(off(&found.pitch_rate_rad_s, &platform().pitch_rate_rad_s) < 3e-3);
    assert!(off(&further.roll_rate_rad_s, &moved.roll_rate_rad_s) < 1e-9);
}
