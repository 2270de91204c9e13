//! Identification held to simulated truth and to the practice recordings.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::controller;
use counterpoise_diagnose::identification::{
    Estimate, Identification, IdentifiedAmplifier, Note, apply_identified, identify,
};
use counterpoise_models::parameters::{FrictionLaw, MapPoint, StribeckCurve};
use counterpoise_models::{Parameters, Plant, reference};
use counterpoise_recordings::{Channel, Mapping, Recording, RecordingTable};
use counterpoise_simulate::{
    Detail, FurtherMotion, Imperfections, PlatformMotion, Scenario, Signal, Simulator, Sine,
};

/// The points of the practice machine's amplifier: (V, A).
const CURVE: [(f64, f64); 14] = [
    (0.12, 0.27),
    (0.22, 0.48),
    (0.28, 0.6),
    (0.34, 0.7),
    (0.42, 0.83),
    (0.51, 0.96),
    (0.57, 1.08),
    (0.8, 1.86),
    (1.04, 2.79),
    (1.13, 3.04),
    (1.2, 3.3),
    (1.27, 3.53),
    (1.34, 3.81),
    (2.0, 6.0),
];

/// A triangle wave of 0.15 rad/s and 2 s for 10 s, with noise and quantisation.
fn triangle(simulator: &mut Simulator, bias_v: f64, seed: u64) -> Recording {
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.15, period_s: 2.0 },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        ..Scenario::at_rest(10.0)
    };
    let history = simulator.run(&mut controller(bias_v), &scenario).unwrap();
    history.readings.recording("triangle", 1e-3)
}

fn simulator(p: &Parameters) -> Simulator {
    Simulator::new(&Plant::from_lumped(p).unwrap()).unwrap()
}

/// A machine that is not what its project says.
fn other_machine() -> Parameters {
    let mut p = reference::rig();
    let lumped = p.lumped.as_mut().unwrap();
    lumped.out_of_balance_kg_m = 171.0;
    lumped.hub_inertia_kg_m2 *= 1.15;
    lumped.beam_inertia_kg_m2 *= 1.15;
    p.pivot_friction.viscous_nm_s_rad = 110.0;
    if let FrictionLaw::Dahl { coulomb_nm, .. } = &mut p.pivot_friction.law {
        *coulomb_nm = 150.0;
    }
    p
}

/// First moment, inertia, Coulomb, viscous.
fn four_estimates(found: &Identification) -> [Estimate; 4] {
    let b = &found.balances[0];
    [b.out_of_balance_kg_m, b.inertia_kg_m2, found.coulomb_nm, found.viscous_nm_s_rad]
}

#[test]
fn simulated_truth_is_found_and_lies_inside_the_intervals() {
    let project = reference::rig();
    let truth = other_machine();
    let expected = [171.0, 345.7 * 1.15, 150.0 + 13.0, 110.0 + 80.0];
    let mut machine = simulator(&truth);
    let mut inside = [0; 4];
    for seed in 0..20 {
        let recording = triangle(&mut machine, 2.88, seed);
        let found = identify(&project, &[&[recording]]).unwrap();
        for (k, (estimate, value)) in four_estimates(&found).iter().zip(expected).enumerate() {
            let limit = if k == 0 { 0.02 } else { 0.10 };
            assert!((estimate.value / value - 1.0).abs() < limit, "{k}: {estimate:?}, truth {value}");
            inside[k] += usize::from(estimate.holds(value));
        }
        if seed == 0 {
            println!("{:?}\n{:?} residual {}", four_estimates(&found), found.breakaway_nm, found.residual_nm);
        }
    }
    println!("inside of 20: {inside:?}");
    assert!(inside.iter().all(|count| *count >= 18), "{inside:?}");
}

/// A rig with the measured amplifier, in a state of balance.
fn nonlinear_rig(out_of_balance_kg_m: f64) -> Parameters {
    let mut p = reference::rig();
    p.amplifier.map = CURVE.iter().map(|&(input_v, current_a)| MapPoint { input_v, current_a }).collect();
    p.lumped.as_mut().unwrap().out_of_balance_kg_m = out_of_balance_kg_m;
    p
}

fn true_current(input_v: f64) -> f64 {
    let rig = nonlinear_rig(0.0);
    rig.amplifier.drive_v(input_v, &rig.motor) * rig.amplifier.stall_gain_a_v(&rig.motor)
}

fn worst_point(found: &Identification) -> f64 {
    let IdentifiedAmplifier::Curve { points } = &found.amplifier else {
        panic!("no curve: {:?}", found.amplifier)
    };
    for q in points {
        println!("  {:?} truth {:.3}", q, true_current(q.input_v));
    }
    points.iter().map(|q| (q.current_a / true_current(q.input_v) - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn the_gain_curve_is_recovered_from_balanced_and_midpoint_runs() {
    let balanced = triangle(&mut simulator(&nonlinear_rig(10.0)), 0.2, 1);
    let midpoint = triangle(&mut simulator(&nonlinear_rig(75.0)), 1.45, 2);
    let found = identify(&reference::rig(), &[&[balanced], &[midpoint]]).unwrap();
    println!("{:?} {:?} {:?}", found.balances, found.coulomb_nm, found.viscous_nm_s_rad);
    assert!(worst_point(&found) < 0.10);
    assert!((found.balances[0].out_of_balance_kg_m.value - 10.0).abs() < 0.5);
    assert!((found.balances[1].out_of_balance_kg_m.value / 75.0 - 1.0).abs() < 0.02);
    assert!((found.coulomb_nm.value / 130.0 - 1.0).abs() < 0.10);
    let better = apply_identified(&reference::rig(), &found);
    assert!(better.amplifier.map.len() > 5);
    assert!(Plant::from_lumped(&better).is_ok());
}

#[test]
fn a_linear_amplifier_is_left_as_it_is() {
    let recording = triangle(&mut simulator(&reference::rig()), 2.88, 3);
    let found = identify(&reference::rig(), &[&[recording]]).unwrap();
    assert!(!matches!(found.amplifier, IdentifiedAmplifier::Curve { .. }), "{:?}", found.amplifier);
}

#[test]
fn hub_rate_and_control_alone_are_enough() {
    let whole = triangle(&mut simulator(&other_machine()), 2.88, 4);
    let mut bare = whole;
    bare.remove(Channel::MotorRate);
    bare.remove(Channel::HubPosition);
    let found = identify(&reference::rig(), &[&[bare]]).unwrap();
    for (estimate, value) in four_estimates(&found).iter().zip([171.0, 397.555, 163.0, 190.0]) {
        assert!((estimate.value / value - 1.0).abs() < 0.05, "{estimate:?}, truth {value}");
    }
    assert!(found.notes.contains(&Note::NoMotorRate));
}

#[test]
fn the_improved_mechanism_is_found_again_as_it_is() {
    let recording = triangle(&mut simulator(&other_machine()), 2.88, 5);
    let found = identify(&reference::rig(), &[std::slice::from_ref(&recording)]).unwrap();
    let better = apply_identified(&reference::rig(), &found);
    let again = identify(&better, &[&[recording]]).unwrap();
    assert!(four_estimates(&again).iter().all(|e| e.holds(e.before)), "{:?}", four_estimates(&again));
    assert_eq!(apply_identified(&better, &again), better);
}

#[test]
fn a_mechanism_at_rest_is_refused_with_what_would_help() {
    let still = Recording::new("", 1e-3)
        .with(Channel::Control, vec![2.88; 3000])
        .with(Channel::HubRate, vec![0.0; 3000]);
    let error = identify(&reference::rig(), &[&[still]]).unwrap_err();
    assert!(error.to_string().contains("triangle"), "{error}");
}

/// Returns a practice recording, made by an independent simulator.
fn practice(machine: &str, experiment: &str) -> Recording {
    let base = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/practice");
    let bytes = std::fs::read(format!("{base}/{machine}/{experiment}.parquet")).unwrap();
    Mapping::default().apply(&RecordingTable::read(&bytes, experiment).unwrap()).unwrap()
}

/// Returns the practice recordings of a machine.
fn practices(machine: &str) -> Vec<Recording> {
    ["triangle", "steps", "road", "multisine"].iter().map(|e| practice(machine, e)).collect()
}

#[test]
fn practice_machines_have_their_out_of_balance() {
    for (machine, moment) in [("p08", 151.67), ("p01", 151.67), ("p04", 186.0)] {
        let recordings = practices(machine);
        for set in [&recordings[..1], &recordings[..]] {
            let found = identify(&reference::rig(), &[set]).unwrap();
            let expected = [moment, 345.7, 130.0, 140.0];
            println!(
                "{machine} {}: {:?}",
                set.len(),
                four_estimates(&found).map(|e| [e.value, e.ci95[0], e.ci95[1]])
            );
            println!("   {:?} {:?} res {}", found.breakaway_nm, found.lobes, found.residual_nm);
            for (k, (estimate, value)) in four_estimates(&found).iter().zip(expected).enumerate() {
                let limit = if k == 0 { 0.02 } else { 0.10 };
                assert!((estimate.value / value - 1.0).abs() < limit, "{machine} {k}: {estimate:?}");
            }
        }
    }
}

#[test]
fn the_practice_machines_gain_curve_is_recovered() {
    let (balanced, normal) = (practices("p03"), practices("p08"));
    let one = identify(&reference::rig(), &[&balanced]).unwrap();
    assert!(worst_point(&one) < 0.10);
    let triangle = identify(&reference::rig(), &[&balanced[..1], &normal[..1]]).unwrap();
    assert!(worst_point(&triangle) < 0.10);
}

/// A base that moves in five degrees of freedom, with its roll and yaw rates as a logger has them.
fn on_a_moving_base(machine: &Parameters, seed: u64) -> Recording {
    let sines = |amplitudes: [f64; 2], rates: [f64; 2]| {
        let sine =
            |k: usize| Sine { amplitude: amplitudes[k], frequency_rad_s: rates[k], phase_rad: k as f64 };
        Signal::Sines(vec![sine(0), sine(1)])
    };
    let further = FurtherMotion {
        surge_m_s2: Signal::ZERO,
        roll_rate_rad_s: sines([0.2, 0.1], [5.0, 13.0]),
        yaw_rate_rad_s: sines([0.15, 0.1], [3.0, 9.0]),
    };
    let platform = PlatformMotion {
        pitch_rate_rad_s: sines([0.1, 0.08], [7.0, 17.0]),
        heave_m_s2: sines([0.7, 0.4], [6.0, 11.0]),
        further: Some(further.clone()),
        ..PlatformMotion::STILL
    };
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.25, period_s: 2.0 },
        platform,
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        ..Scenario::at_rest(20.0)
    };
    let recording =
        simulator(machine).run(&mut controller(2.88), &scenario).unwrap().readings.recording("base", 1e-3);
    let column =
        |signal: &Signal| (0..recording.len()).map(|k| signal.at(1e-3 * k as f64)).collect::<Vec<f64>>();
    let (roll, yaw) = (column(&further.roll_rate_rad_s), column(&further.yaw_rate_rad_s));
    recording.with(Channel::PlatformRoll, roll).with(Channel::PlatformYaw, yaw)
}

#[test]
fn lever_arm_and_misalignment_are_identified_on_a_moving_base() {
    let project = reference::rig();
    let mut truth = reference::rig();
    truth.sensors.accelerometer_lever_arm_m = 0.8;
    truth.sensors.hub_gyro.alignment.roll_sensitivity = 0.03;
    truth.sensors.platform_gyro.alignment.yaw_sensitivity = 0.02;
    let recording = on_a_moving_base(&truth, 4);
    let found = identify(&project, &[&[recording]]).unwrap();
    let near = |estimate: Option<Estimate>, truth: f64, off: f64| {
        let value = estimate.unwrap().value;
        assert!((value - truth).abs() < off, "{:?}", found.sensors);
    };
    near(found.sensors.lever_arm_m, 0.8, 0.08);
    near(found.sensors.roll_misalignment_rad, 0.03, 2e-3);
    near(found.sensors.yaw_misalignment_rad, -0.02, 2e-3);
    let improved = apply_identified(&project, &found);
    assert!((improved.sensors.accelerometer_lever_arm_m - 0.8).abs() < 0.08);
    assert!((improved.sensors.hub_gyro.alignment.roll_sensitivity - 0.03).abs() < 2e-3);

    let still = identify(&project, &[&[triangle(&mut simulator(&truth), 2.88, 5)]]).unwrap();
    assert!(still.sensors.is_empty(), "{:?}", still.sensors);
}

#[test]
fn friction_that_falls_with_speed_is_no_negative_viscous_friction() {
    let told = reference::rig();
    let mut machine = told.clone();
    let friction = &mut machine.pivot_friction;
    let coulomb_nm = friction.coulomb_nm();
    friction.law = FrictionLaw::Stribeck { coulomb_nm, curve: StribeckCurve::Gaussian };
    (friction.static_ratio, friction.stribeck_rate_rad_s, friction.viscous_nm_s_rad) = (3.0, 0.1, 0.0);
    let found = identify(&told, &[&[triangle(&mut simulator(&machine), 2.88, 5)]]).unwrap();
    assert!(found.notes.contains(&Note::NegativeViscous), "{:?} {:?}", found.viscous_nm_s_rad, found.notes);
    assert!(!found.viscous_nm_s_rad.is_known());
    assert!(found.coulomb_nm.is_known() && found.coulomb_nm.value > 0.0);
    let improved = apply_identified(&told, &found);
    assert_eq!(improved.pivot_friction.viscous_nm_s_rad, told.pivot_friction.viscous_nm_s_rad);
    assert_eq!(improved.motor_friction.viscous_nm_s_rad, told.motor_friction.viscous_nm_s_rad);
}
