//! A hose between hub and platform that yields, through the simulator: its recordings, from rest, are replayed, and the hose
//! is found again from another start.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::controller;
use counterpoise_diagnose::fitting::output_error::{FitSelection, Problem};
use counterpoise_diagnose::library::{Component, EffectName, find_effects};
use counterpoise_diagnose::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use counterpoise_models::{Parameters, Plant, reference};
use counterpoise_pool::Serial;
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::{ReplayLoop, Replayer, replay};
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

/// Control that holds the rig's weight, V.
const BIAS_V: f64 = 2.88;
const LEVEL_NM: f64 = 60.0;
const STIFFNESS_NM_RAD: f64 = 1500.0;

fn machine() -> Parameters {
    let mut p = reference::rig();
    let lumped = p.lumped.as_mut().unwrap();
    (lumped.hysteresis_nm, lumped.hysteresis_stiffness_nm_rad) = (LEVEL_NM, STIFFNESS_NM_RAD);
    p
}

/// A triangle wave of 0.15 rad/s, from rest; another period for another recording.
fn recording(seed: u64, period_s: f64) -> Recording {
    run(seed, period_s, 8.0).0
}

/// The recording of a run, and the hose's torque at its end.
fn run(seed: u64, period_s: f64, duration_s: f64) -> (Recording, f64) {
    let mut simulator = Simulator::new(&Plant::from_lumped(&machine()).unwrap()).unwrap();
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.15, period_s },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        ..Scenario::at_rest(duration_s)
    };
    let history = simulator.run(&mut controller(BIAS_V), &scenario).unwrap();
    let torque_nm = history.final_state.friction.hose;
    (history.readings.recording("triangle", 1e-3), torque_nm)
}

/// Recordings that begin in the middle of the motion, with the hose bent one way and the other.
#[test]
fn a_hose_bent_at_the_start_is_found_bent() {
    let control = ReplayLoop::from(&controller(BIAS_V));
    for middle_s in [2.9, 3.8] {
        let torque_nm = run(7, 2.0, middle_s).1;
        let later = recording(7, 2.0).part((1e3 * middle_s).round() as usize..8000);
        let found = replay(&machine(), &later, &control).unwrap();
        let worst = found.channels.iter().map(|c| c.rms_error / c.floor).fold(0.0, f64::max);
        println!("{torque_nm:.1} N m, found {:.1}, worst {worst:.2}", found.start.friction.hose);
        assert!(torque_nm.abs() > 0.3 * LEVEL_NM, "{torque_nm}");
        assert!((found.start.friction.hose - torque_nm).abs() < 0.15 * LEVEL_NM, "{torque_nm}");
        assert!(worst < 1.3, "{worst}");
        let mut straight = found.start.clone();
        straight.friction.hose = 0.0;
        let replayer = Replayer::new(&machine(), &later).unwrap();
        let missed = replayer.replay_from(&machine(), &control, &straight).unwrap();
        let missed = missed.channels.iter().map(|c| c.rms_error / c.floor).fold(0.0, f64::max);
        println!("taken as straight: {missed:.2}");
        assert!(missed > 1.5 * worst, "{missed}");
    }
}

#[test]
fn the_hose_is_replayed_to_the_noise_and_missed_where_it_is_left_out() {
    let recording = recording(7, 2.0);
    let control = ReplayLoop::from(&controller(BIAS_V));
    let worst = |p: &Parameters| {
        let found = replay(p, &recording, &control).unwrap();
        found.channels.iter().map(|c| c.rms_error / c.floor).fold(0.0, f64::max)
    };
    let (with, without) = (worst(&machine()), worst(&reference::rig()));
    println!("worst error over floor: {with:.2} with the hose, {without:.2} without");
    assert!(with < 1.5 && without > 3.0, "{with} {without}");
}

#[test]
fn the_hose_is_found_again() {
    let recordings = [recording(1, 2.0), recording(2, 0.9)];
    let base = reference::rig();
    let prepared = PreparedRecordings::new(&recordings, &base);
    let simulator = RecordingReplays::new(&base, &ReplayLoop::from(&controller(BIAS_V)), &prepared).unwrap();
    let effects: Vec<_> = find_effects(Component::Structure, EffectName::Hysteresis).collect();
    let selection = FitSelection::all(recordings.len());
    let problem = Problem {
        simulator: &simulator,
        pool: &Serial,
        selection: &selection,
        base: &base,
        effects,
        assessments: &[],
        preferences: &[],
    };
    let fit = problem.fit(&[30.0, 3000.0]).unwrap();
    let lumped = fit.parameters.lumped.unwrap();
    let found = [lumped.hysteresis_nm, lumped.hysteresis_stiffness_nm_rad];
    println!("level {:.2} N m, stiffness {:.1} N m/rad, cost {:.3}", found[0], found[1], fit.cost);
    assert!((found[0] / LEVEL_NM - 1.0).abs() < 0.05, "{found:?}");
    assert!((found[1] / STIFFNESS_NM_RAD - 1.0).abs() < 0.10, "{found:?}");
}
