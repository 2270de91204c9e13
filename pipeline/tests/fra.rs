//! The analyser's map against two linear models, and the same instrument on a run of itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_diagnose::simulator_access::Serial;
use counterpoise_pipeline::model;
use counterpoise_pipeline::studies::fra::{Analyser, Around, On, Plan, Point};
use counterpoise_project::Project;
use counterpoise_recordings::{Channel, Recording};

fn rig() -> Project {
    Project::parse(include_str!("../../project/tests/data/rig.toml"), "rig.toml").unwrap().project
}

fn db(h: [f64; 2]) -> f64 {
    20.0 * h[0].hypot(h[1]).log10()
}

fn mapped(around: Around, amplitudes: &[f64], frequencies_hz: &[f64]) -> Vec<Point> {
    let project = rig();
    let modelled = model(&project).unwrap();
    let plan = Plan {
        around,
        amplitudes: amplitudes.to_vec(),
        frequencies_hz: frequencies_hz.to_vec(),
        offset_m: 0.0,
    };
    let analyser = Analyser::new(&project, &modelled, &plan, On::Simulation).unwrap();
    analyser.compare(&analyser.measure(&plan, &Serial).unwrap(), &Serial).unwrap().points
}

#[test]
fn the_describing_function_explains_what_the_linear_model_does_not() {
    for p in mapped(Around::Plant, &[0.5, 1.0], &[4.5, 9.5]) {
        let described = (db(p.describing.unwrap()) - p.gain_db).abs();
        assert!(p.settled && described < 0.1, "{} V, {} Hz: {described} dB", p.amplitude, p.frequency_hz);
        assert!((db(p.linear) - p.gain_db).abs() > 5.0 * described, "{} V", p.amplitude);
    }
}

#[test]
fn friction_carries_the_disconnected_mechanism_at_small_amplitudes() {
    let points = mapped(Around::Disconnected, &[0.002, 0.5], &[1.0]);
    assert!(points[0].gain_db > points[1].gain_db + 1.0, "{} {}", points[0].gain_db, points[1].gain_db);
}

#[test]
fn a_recording_without_a_line_is_told_and_a_missing_channel_refused() {
    let project = rig();
    let modelled = model(&project).unwrap();
    let plan =
        Plan { around: Around::Plant, amplitudes: Vec::new(), frequencies_hz: Vec::new(), offset_m: 0.0 };
    let analyser = Analyser::new(&project, &modelled, &plan, On::Recording).unwrap();
    let tone = |k: u32, hz: f64| (std::f64::consts::TAU * hz * f64::from(k) * 1e-3).sin();
    let tones = |gain: f64| (0..5000).map(|k| gain * tone(k, 5.0)).collect::<Vec<f64>>();
    let mut recording =
        Recording::new("tone", 1e-3).with(Channel::Control, tones(1.0)).with(Channel::HubRate, tones(0.02));
    let points = analyser.recorded(&recording, &[5.0, 8.0]).unwrap().points;
    assert!(points[0].settled && (points[0].gain_db - 20.0 * 0.02_f64.log10()).abs() < 1e-6);
    assert!(!points[1].settled);
    recording.remove(Channel::Control);
    let refused = analyser.recorded(&recording, &[5.0]).unwrap_err().to_string();
    assert!(refused.contains("tone") && refused.contains("control"), "{refused}");
}
