//! Stability certificates against an independent simulator: a small share of what `.ci/evidence` runs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::studies::certificate::certify_controller;
use counterpoise_pipeline::{build_plant_model, reduce_plant, synthesise};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{ObserverFriction, ObserverOptions};
use counterpoise_synth::Drives;
use counterpoise_tests::certificates::trial;
use counterpoise_verify::Procedure;
use counterpoise_verify::certificate::{CaseCertificate, Stability, StabilityCriterion};

fn base() -> Project {
    let path = format!("{}/../examples/reference-rig/project.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    Project::parse(&text, "project.toml").unwrap_or_else(|errors| panic!("{errors:?}")).project
}

fn certify_project(project: &Project) -> CaseCertificate {
    let modelled = build_plant_model(project).unwrap();
    let made = synthesise(project, &modelled, &reduce_plant(project, &modelled).unwrap()).unwrap();
    let procedure = Procedure { road: None, ..project.verify.as_ref().unwrap().procedure.clone() };
    certify_controller(project, &modelled, &made, &procedure).unwrap().cases[0].clone()
}

#[test]
fn certificates_do_not_contradict_an_independent_simulator() {
    let base = base();
    for row in (0..3).filter_map(|seed| trial(seed, &base)) {
        assert!(!row.contradicts(), "seed {}: {:?} {:?}", row.seed, row.rest, row.motion);
    }
}

/// Both mechanisms have another motion beside the certified limit cycle, and a run that starts at the cycle's amplitude with the teeth moving
/// along meets that one.
#[test]
fn a_certified_limit_cycle_is_that_of_an_independent_simulator_from_the_same_burst() {
    let base = base();
    for seed in [1203, 50054] {
        let [amplitude, frequency] =
            trial(seed, &base).unwrap().cycle_errors().expect("the limit cycle stays");
        assert!(amplitude.abs() <= 0.2 && frequency.abs() <= 0.05, "seed {seed}: {amplitude} {frequency}");
    }
}

#[test]
fn the_reference_rig_is_stable_in_every_regime() {
    let found = certify_project(&base());
    assert_eq!(found.stability, Stability::Stable);
    assert!(found.regimes.iter().all(|at| at.pole_radius < 1.0), "{:?}", found.regimes);
}

/// What is proved for every Dahl friction up to the stated stiffness is quiet in simulation with little and with much friction, from the
/// disturbances that the certificate follows.
#[test]
fn the_reference_rig_is_proved_and_quiet_for_other_levels_of_friction() {
    let proof = certify_project(&base()).sector.unwrap();
    assert!(proof.holds(), "{proof:?}");
    assert_eq!(proof.criterion, StabilityCriterion::Circle, "passivity alone fails");
    for level in [0.1, 3.0] {
        let mut project = base();
        for friction in [&mut project.plant.motor_friction, &mut project.plant.pivot_friction] {
            let stiffness = friction.presliding_stiffness_nm_rad().unwrap();
            friction.law.scale_coulomb(level);
            friction.set_presliding_stiffness_nm_rad(stiffness);
        }
        let found = certify_project(&project);
        assert!(found.is_proved(), "{level}: {:?} {:?}", found.stability, found.sector);
        assert!(found.orbits.iter().all(|orbit| orbit.rms_rad_s <= 2.0 * found.noise_floor_rad_s), "{level}");
    }
}

/// A friction observer that cancels twice the friction that is there makes the loop hunt at rest; its margins do not show it.
#[test]
fn an_observer_of_twice_the_friction_is_certified_to_hunt() {
    let mut project = base();
    let identified = project.plant.clone();
    for friction in [&mut project.plant.motor_friction, &mut project.plant.pivot_friction] {
        friction.law.scale_coulomb(0.5);
        friction.scale_presliding_stiffness(0.5);
    }
    project.synth.as_mut().unwrap().options.observer = Some(ObserverOptions {
        drives: Drives::MeasuredRate,
        share: 1.0,
        motor: Some(identified.motor_friction),
        pivot: Some(identified.pivot_friction),
        model: ObserverFriction::Dahl,
        sign_rate_rad_s: 0.01,
        learning: None,
    });
    let found = certify_project(&project);
    assert!(found.sector.is_none(), "no sector argument applies to an observer in the loop");
    let sliding = found.regimes.iter().find(|at| at.regime.key() == "sliding").unwrap();
    assert!(sliding.gain_margin_db > 12.0, "the margins see nothing: {sliding:?}");
    let worst = found.worst_regime().unwrap();
    assert_eq!(worst.regime.key(), "presliding");
    assert!(worst.pole_radius > 1.0, "{worst:?}");
    let Stability::LimitCycle { amplitude_rad_s, frequency_hz } = found.stability else {
        panic!("{:?}", found.stability)
    };
    let run = found.rest;
    assert!((amplitude_rad_s / run.amplitude_rad_s - 1.0).abs() < 0.2, "{amplitude_rad_s} {run:?}");
    assert!((frequency_hz / run.frequency_hz - 1.0).abs() < 0.05, "{frequency_hz} {run:?}");
    assert!(!found.prediction.cycles.is_empty(), "the harmonic balance sees that the loop hunts");
}

/// A file without weights, designed with those that suit the machine.
fn certify_chosen_design(file: &str) -> CaseCertificate {
    let document = counterpoise_project::Document::parse(file, "project.toml");
    let files = counterpoise_project::Attachments::none();
    let read = Project::resolve_for(&document, &files, counterpoise_project::Purpose::Design);
    let project = read.unwrap().project;
    let chosen = counterpoise_pipeline::with_chosen_weights(&project).unwrap();
    certify_project(&chosen.map_or(project, |chosen| chosen.project))
}

/// A blade's pitch drive: its friction at rest is a spring on which the blade swings at 4 Hz, which the sliding plant does not show.
#[test]
fn a_first_design_holds_the_friction_at_rest() {
    let found = certify_chosen_design(
        "format = 2
        plant.inertia = \"12000 kg m^2\"
        plant.gearbox = { ratio = \"1500:1\", stiffness = \"30 MN m/rad\" }
        plant.motor = { inertia = \"0.02 kg m^2\", torque_constant = \"1.2 N m/A\" }
        plant.drive = { kind = \"current\", limit = \"60 A\" }
        plant.friction.pivot = { model = \"coulomb\", coulomb = \"4 kN m\" }
        plant.sensors.encoder = { place = \"motor\", counts = \"13 bit\" }
        plant.interface.sample_period = \"5 ms\"",
    );
    let worst = found.worst_regime().unwrap();
    assert_eq!(worst.regime.key(), "presliding");
    assert!(worst.pole_radius < 1.0 && worst.max_sensitivity < 2.05, "{worst:?}");
    assert!(matches!(found.stability, Stability::Stable), "{:?}", found.stability);
}

/// A joint whose torque sensor has no noise: the floor is what rounding keeps up, in N m, and no rate is measured against it.
#[test]
fn a_torque_loop_without_noise_is_quiet_by_a_floor_of_torque() {
    let found = certify_chosen_design(
        "format = 2
        verify.step.rate = 3.0
        plant.lumped = { hub_inertia = 0.3, position_stiffness = 60.0 }
        plant.gearbox = { ratio = 50.0, stiffness = 300.0 }
        plant.motor = { inertia = 6e-5, torque_constant = 0.1 }
        plant.drive = { kind = \"current\", limit = 15.0, bandwidth = \"800 Hz\" }
        plant.friction.pivot = { viscous = 0.1 }
        plant.friction.motor = { model = \"coulomb\", coulomb = 0.01, viscous = 1e-5 }
        plant.sensors.torque = { }
        plant.interface = { sample_period = 1e-3 }",
    );
    assert_eq!(found.stability, Stability::Stable);
    assert_eq!(found.controlled.unit(), "N m");
    assert!((found.noise_floor_rad_s / 3e-6 - 1.0).abs() < 0.01, "{}", found.noise_floor_rad_s);
    // the largest disturbance that is followed is the step of the verification, in N m
    assert!((found.orbits.last().unwrap().start_rad_s / 3.0 - 1.0).abs() < 1e-9);
}

/// A pendulum without friction that an encoder of 4096 counts holds: it moves within a count, which is no limit cycle; and there is neither a
/// presliding nor a sliding regime.
#[test]
fn a_pendulum_within_a_count_of_its_encoder_is_quiet() {
    let path = format!("{}/../examples/servo-pendulum/project.toml", env!("CARGO_MANIFEST_DIR"));
    let found = certify_chosen_design(&std::fs::read_to_string(path).unwrap());
    assert_eq!(found.stability, Stability::Stable);
    let count = std::f64::consts::TAU / 4096.0;
    assert!((found.noise.step_rad_s / count - 1.0).abs() < 1e-9 && found.rest.rms_rad_s < count);
    let regimes: Vec<&str> = found.regimes.iter().map(|at| at.regime.key()).collect();
    assert_eq!(regimes, ["frictionless"]);
}
