//! The projection of heave and surge across the beam: what it computes, what the linear part sees of it, and what is refused.
#![allow(clippy::unwrap_used)]

use counterpoise_controller::signal::{HUB_POSITION, PLATFORM_ACCELERATION};
use counterpoise_controller::{
    Controller, Correction, Error, Parts, Path, PathSignal, Projection, Readings, SampledController, Scaling,
    SensorUse,
};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

const GAIN: f64 = 2.0;

/// The heave path is a gain, so that the control shows the acceleration that it is given.
fn parts(projection: Option<Projection>) -> Parts {
    let timebase = Timebase::Discrete { period_s: 1e-3 };
    let none = || Mat::zeros(0, 0);
    let system =
        StateSpace::new(none(), Mat::zeros(0, 1), Mat::zeros(1, 0), Mat::row(&[GAIN]), timebase).unwrap();
    let mut parts = Parts::new(1e-3, 1e3);
    parts.projection = projection;
    parts.paths.push(Path {
        name: "heave".into(),
        inputs: vec![PathSignal::PlatformAcceleration],
        system,
        anti_windup: Vec::new(),
        scaling: Scaling::Fixed,
    });
    parts
}

fn measured_projection(design_angle_rad: f64) -> Option<Projection> {
    Some(Projection { design_angle_rad, angle_reading: Some(HUB_POSITION), pitch_washout_s: None })
}

fn readings(angle: f64) -> Readings {
    Readings {
        platform_accel_m_s2: 1.7,
        platform_surge_m_s2: -3.1,
        hub_position_rad: angle,
        ..Readings::default()
    }
}

#[test]
fn heave_and_surge_are_projected_at_the_angle_that_is_read() {
    let mut runner = Controller::new(parts(measured_projection(0.1))).unwrap().runner();
    for angle in [-1.6, -0.9, -0.26, 0.0, 0.087, 0.26, 1.0, 1.6_f64] {
        let expected = GAIN * (1.7 * angle.cos() + 3.1 * angle.sin());
        // the first terms of the series that are left out, at this angle
        let allowed = GAIN * (1.7 * angle.powi(10) / 3_628_800.0 + 3.1 * angle.abs().powi(11) / 39_916_800.0);
        let found = runner.step(&readings(angle));
        assert!((found - expected).abs() <= allowed + 1e-14, "{angle}: {found} {expected}");
    }
    assert_eq!(
        runner.step(&readings(2.0)),
        runner.step(&readings(1.6)),
        "beyond the vertical the angle is limited"
    );
}

#[test]
fn the_platforms_pitch_makes_the_angle_inertial_for_a_while() {
    let washout_s = 10.0;
    let inertial = measured_projection(0.0).map(|one| Projection { pitch_washout_s: Some(washout_s), ..one });
    let mut runner = Controller::new(parts(inertial)).unwrap().runner();
    // the platform pitches by sines while the hub keeps its inertial angle
    let (rate, size, hub): (f64, f64, f64) = (3.0, 0.05, 0.2);
    let expected = GAIN * (1.7 * hub.cos() + 3.1 * hub.sin());
    for k in 0..20_000 {
        let t = 1e-3 * f64::from(k);
        let pitch = size * (rate * t).sin();
        let read = Readings { platform_rate_rad_s: size * rate * (rate * t).cos(), ..readings(hub - pitch) };
        // a high-pass of the corner 1 / washout leaves 1 / (rate washout) of the angle in the steady state and as much again while it starts, and
        // the sum over samples is late by less than one
        let allowed = GAIN * 3.6 * size * (2.0 / (rate * washout_s) + rate * 1e-3);
        assert!((runner.step(&read) - expected).abs() < allowed, "{t}");
    }
    let at_rest = (0..100_000).map(|_| runner.step(&readings(hub))).last().unwrap();
    assert!((at_rest - expected).abs() < 1e-4, "the pitch angle fades at rest");
}

#[test]
fn without_an_angle_the_elevation_of_the_design_holds() {
    let fixed = Projection { design_angle_rad: 0.3, angle_reading: None, pitch_washout_s: None };
    let mut runner = Controller::new(parts(Some(fixed))).unwrap().runner();
    let expected = GAIN * (1.7 * 0.3_f64.cos() + 3.1 * 0.3_f64.sin());
    assert!((runner.step(&readings(-0.5)) - expected).abs() < 1e-14);
}

#[test]
fn the_linear_part_has_the_share_of_heave_at_the_elevation_of_its_design() {
    let linear = Controller::new(parts(measured_projection(0.26))).unwrap().linear(0.0).unwrap();
    assert_eq!((linear.inputs(), linear.order()), (6, 0));
    for input in 0..6 {
        let expected = if input == PLATFORM_ACCELERATION { GAIN * 0.26_f64.cos() } else { 0.0 };
        assert!((linear.D[(0, input)] - expected).abs() < 1e-15, "{input}");
    }
}

#[test]
fn feedback_alone_uses_neither_accelerometer() {
    let controller = Controller::new(parts(measured_projection(0.2))).unwrap();
    assert_eq!(controller.feedback_alone().unwrap().runner().step(&readings(0.4)), 0.0);
    let mut runner = controller.runner();
    runner.use_sensors(SensorUse::FeedbackAlone);
    assert_eq!((0..200).map(|_| runner.step(&readings(0.4))).last(), Some(0.0));
}

#[test]
fn a_lost_surge_reading_is_replaced_and_flagged_on_its_own_bit() {
    let mut runner = Controller::new(parts(measured_projection(0.2))).unwrap().runner();
    let good = runner.step(&readings(0.4));
    let lost = Readings { platform_surge_m_s2: f64::NAN, ..readings(0.4) };
    assert_eq!((runner.step(&lost), runner.status().flags & 0x7f), (good, 0x40));
}

#[test]
fn a_controller_without_projection_takes_six_readings() {
    let (plain, projecting) = (parts(None), parts(measured_projection(0.0)));
    assert_eq!((plain.reading_count(), projecting.reading_count()), (6, 7));
    let mut runner = Controller::new(plain.clone()).unwrap().runner();
    assert_eq!(runner.step(&Readings { platform_surge_m_s2: f64::NAN, ..readings(0.4) }), GAIN * 1.7);
    assert_eq!(runner.status().flags & 0x7f, 0);
    let correction = Correction { reading: 6, gain: 1.1, offset: 0.0 };
    let corrected = |mut parts: Parts| {
        parts.corrections.push(correction);
        Controller::new(parts)
    };
    assert!(corrected(plain).is_err() && corrected(projecting).is_ok());
}

#[test]
fn a_projection_that_means_nothing_is_refused() {
    for wrong in [
        Projection { design_angle_rad: f64::NAN, angle_reading: None, pitch_washout_s: None },
        Projection { design_angle_rad: 1.7, angle_reading: None, pitch_washout_s: None },
        Projection { design_angle_rad: 0.0, angle_reading: Some(3), pitch_washout_s: None },
        Projection { design_angle_rad: 0.0, angle_reading: Some(9), pitch_washout_s: None },
        Projection { design_angle_rad: 0.0, angle_reading: Some(HUB_POSITION), pitch_washout_s: Some(0.0) },
    ] {
        assert!(matches!(Controller::new(parts(Some(wrong))), Err(Error::Range { .. })), "{wrong:?}");
    }
}
