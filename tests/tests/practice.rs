//! Recordings of an independent simulator: the machine as modelled replays to its noise floor, and what a machine has
//! more than its model is named, with its size, from recordings alone.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use counterpoise_diagnose::diagnose;
use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_models::Plant;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_project::{Attachments, Document, Project, SettingValue};
use counterpoise_recordings::{Channel, Recording, RecordingTable};
use counterpoise_simulate::replay::{Replay, ReplayLoop, Replayer, replay};
use counterpoise_simulate::{Imperfections, Scenario, Signal, run};
use counterpoise_tests::Threads;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn project(folder: &Path) -> Project {
    Project::from_bytes(&fs::read(folder.join("project.toml")).unwrap(), "project.toml").unwrap().project
}

fn recordings(project: &Project, folder: &Path) -> Vec<Recording> {
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "parquet"));
    paths.sort();
    let read = |path: &PathBuf| {
        let table = RecordingTable::read(&fs::read(path).unwrap(), &path.display().to_string()).unwrap();
        project.recording.apply(&table).unwrap()
    };
    paths.iter().map(read).collect()
}

/// Returns what is diagnosed of a folder's recordings: the first 3 s of steps and triangle; with the feature `evidence`, as in
/// `.ci/evidence`, every recording, whole.
fn diagnosed_recordings(project: &Project, folder: &Path) -> Vec<Recording> {
    let mut all = recordings(project, folder);
    if cfg!(not(feature = "evidence")) {
        all.retain(|recording| ["steps", "triangle"].iter().any(|name| recording.name.contains(name)));
        assert_eq!(all.len(), 2);
        all = all.iter().map(|recording| recording.part(0..3000)).collect();
    }
    all
}

/// The largest RMS error of a channel over its floor.
fn largest_ratio(project: &Project, folder: &Path) -> f64 {
    let control = ReplayLoop::from(
        project
            .recording_controller
            .as_ref()
            .and_then(RecordingController::as_proportional_integral)
            .unwrap(),
    );
    let replays =
        recordings(project, folder).into_iter().map(|r| replay(&project.plant, &r, &control).unwrap());
    let ratios = replays.flat_map(|r| r.channels.into_iter().map(|c| c.rms_error / c.floor));
    ratios.fold(0.0, f64::max)
}

fn practice(machine: &str) -> PathBuf {
    root().join("tests/data/practice").join(machine)
}

#[test]
fn a_machine_as_modelled_replays_to_its_floor_and_is_consistent() {
    let folder = practice("p08");
    let project = project(&folder);
    assert!(largest_ratio(&project, &folder) < 1.5);
    let controller = project
        .recording_controller
        .as_ref()
        .and_then(RecordingController::as_proportional_integral)
        .unwrap()
        .clone();
    let found =
        diagnose(&project.plant, &controller, &diagnosed_recordings(&project, &folder), &Threads).unwrap();
    assert_eq!(found.answer.verdict, DiagnosisVerdict::Consistent, "{:?}", found.answer.findings);
    assert!(found.answer.findings.is_empty());
}

#[test]
fn left_out_friction_is_named_sized_and_its_improved_model_fits_what_it_has_not_seen() {
    let folder = root().join("examples/left-out-friction");
    let project = project(&folder);
    assert!(largest_ratio(&project, &folder) > 3.0);
    let controller = project
        .recording_controller
        .as_ref()
        .and_then(RecordingController::as_proportional_integral)
        .unwrap()
        .clone();
    let found =
        diagnose(&project.plant, &controller, &diagnosed_recordings(&project, &folder), &Threads).unwrap();
    assert_eq!(found.answer.verdict, DiagnosisVerdict::Named);
    assert_eq!(found.answer.findings.len(), 1);
    let finding = &found.answer.findings[0];
    assert_eq!(finding.name().names(), ("pivot", "stribeck"));
    let value = |name: &str| finding.parameters.iter().find(|p| p.name == name).unwrap().value;
    assert!((value("static_ratio") / 1.55 - 1.0).abs() < 0.02);
    assert!((value("stribeck_rate") / 0.012 - 1.0).abs() < 0.05);
    for (channel, after) in found.answer.fit.held_out_after.iter() {
        let name = channel.name();
        assert!(after.rms_error < 1.5 * after.floor, "{name}: {after:?}");
    }
    let improved = Project { plant: found.improved, ..project };
    assert!(largest_ratio(&improved, &folder.join("unseen")) < 1.5);
}

/// Returns what a machine has more than its project says, entered by hand: keys of the project file and their values.
fn truth(machine: &str) -> Vec<(&'static str, SettingValue)> {
    let number = |key, value| (key, SettingValue::Number(value));
    match machine {
        "p01" => vec![
            number("plant.friction.pivot.static_ratio", 1.55),
            number("plant.friction.pivot.stribeck_rate", 0.012),
        ],
        "p02" => vec![number("plant.gearbox.backlash", 6e-3)],
        "p03" => vec![("plant.amplifier.map", SettingValue::Pairs(GAIN_CURVE.to_vec()))],
        "p04" => vec![number("plant.lumped.out_of_balance", 186.0)],
        "p05" => vec![
            number("plant.motor.cogging.amplitude", 0.16),
            number("plant.motor.cogging.order", 6.0),
            number("plant.motor.cogging.phase", 0.7),
        ],
        "p06" => vec![("plant.interface.output_delay_samples", SettingValue::Whole(6))],
        "p07" => vec![
            number("plant.lumped.position_stiffness", 900.0),
            number("plant.lumped.position_stiffness_centre", -0.04),
        ],
        _ => Vec::new(),
    }
}

/// Input voltage and stalled current of p03's amplifier.
const GAIN_CURVE: [[f64; 2]; 14] = [
    [0.12, 0.27],
    [0.22, 0.48],
    [0.28, 0.6],
    [0.34, 0.7],
    [0.42, 0.83],
    [0.51, 0.96],
    [0.57, 1.08],
    [0.8, 1.86],
    [1.04, 2.79],
    [1.13, 3.04],
    [1.2, 3.3],
    [1.27, 3.53],
    [1.34, 3.81],
    [2.0, 6.0],
];

/// A practice machine's project with the truth entered, and all its recordings.
fn known_machine(machine: &str) -> (Project, Vec<Recording>) {
    let folder = practice(machine);
    let text = fs::read_to_string(folder.join("project.toml")).unwrap();
    let document = truth(machine)
        .iter()
        .fold(Document::parse(&text, machine), |document, (key, value)| document.set(key, value).unwrap());
    let project = Project::resolve(&document, &Attachments::none()).unwrap().project;
    let mut all = recordings(&project, &folder);
    all.extend(recordings(&project, &folder.join("unseen")));
    assert_eq!(all.len(), 7);
    (project, all)
}

/// Every channel of a replay within 1.5 times its floor.
fn assert_fits(machine: &str, recording: &str, replayed: &Replay) {
    for fit in &replayed.channels {
        let ratio = fit.rms_error / fit.floor;
        assert!(ratio < 1.5, "{machine} {recording} {}: {ratio:.2} times the floor", fit.channel.name());
    }
}

#[test]
fn machines_whose_truth_is_known_replay_in_closed_loop_to_their_floor() {
    for machine in ["p01", "p04", "p05", "p06", "p07"] {
        let (project, all) = known_machine(machine);
        let control = ReplayLoop::from(
            project
                .recording_controller
                .as_ref()
                .and_then(RecordingController::as_proportional_integral)
                .unwrap(),
        );
        counterpoise_tests::run_in_parallel(all.len(), &|k| {
            let replayed = replay(&project.plant, &all[k], &control).unwrap();
            assert_fits(machine, &all[k].name, &replayed);
        });
    }
}

#[test]
fn machines_that_hunt_replay_to_their_floor_over_half_a_second() {
    for machine in ["p02", "p03"] {
        let (project, all) = known_machine(machine);
        counterpoise_tests::run_in_parallel(all.len(), &|k| {
            let replayer = Replayer::new(&project.plant, &all[k]).unwrap();
            assert_fits(machine, &all[k].name, &replayer.replay_windowed(&project.plant, 0.5).unwrap());
        });
    }
}

/// Where the points of an amplifier's curve lie is found with it: the improved model follows what it has not seen, with fewer points
/// than one every 0.1 V. It takes minutes, so `.ci/evidence` runs it.
#[cfg(feature = "evidence")]
#[test]
fn an_amplifier_s_curve_is_found_as_fine_as_the_recordings_ask() {
    let folder = practice("p03");
    let project = project(&folder);
    let controller = project
        .recording_controller
        .as_ref()
        .and_then(RecordingController::as_proportional_integral)
        .unwrap()
        .clone();
    let found = diagnose(&project.plant, &controller, &recordings(&project, &folder), &Threads).unwrap();
    assert_eq!(found.answer.verdict, DiagnosisVerdict::Named);
    let finding = &found.answer.findings[0];
    assert_eq!(finding.name().names(), ("amplifier", "gain_curve"));
    assert!(finding.parameters.len() <= 20, "{}", finding.parameters.len());
    let unseen = recordings(&project, &folder.join("unseen"));
    counterpoise_tests::run_in_parallel(unseen.len(), &|k| {
        let replayer = Replayer::new(&found.improved, &unseen[k]).unwrap();
        let followed =
            replayer.replay_free_or_windowed(&found.improved, &ReplayLoop::from(&controller)).unwrap();
        assert_fits("p03", &unseen[k].name, &followed.replay);
    });
}

/// In open loop a machine that nearly stalls remembers a start for longer than its first moments show it.
#[test]
fn cogging_that_nearly_stalls_the_motor_replays_in_open_loop() {
    let (project, all) = known_machine("p05");
    counterpoise_tests::run_in_parallel(all.len(), &|k| {
        let replayer = Replayer::new(&project.plant, &all[k]).unwrap();
        assert_fits("p05", &all[k].name, &replayer.replay_open(&project.plant).unwrap());
    });
}

/// Why the machine that hunts is judged over half a second: two runs of the machine itself, from the same start, that differ in the
/// noise of the sensors alone part by more than ten times that noise.
#[test]
fn a_machine_that_hunts_does_not_repeat_itself() {
    let (project, all) = known_machine("p02");
    let steps = all.iter().find(|r| r.name.contains("steps")).unwrap();
    let mut controller = project
        .recording_controller
        .as_ref()
        .and_then(RecordingController::as_proportional_integral)
        .unwrap()
        .clone();
    controller.integral_v = 0.0;
    let plant = Plant::from_lumped(&project.plant).unwrap();
    let run = |seed: u64| {
        let values = steps.samples(Channel::Demand).unwrap().to_vec();
        let scenario = Scenario {
            demand_rad_s: Signal::Held { period_s: steps.sample_period_s, values },
            imperfections: Imperfections::NoiseAndQuantisation { seed },
            ..Scenario::at_rest(steps.sample_period_s * steps.len() as f64)
        };
        run(&plant, &mut controller.clone(), &scenario).unwrap().truth.hub_rate_rad_s().to_vec()
    };
    let (one, other) = (run(1), run(2));
    let apart = one.iter().zip(&other).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / one.len() as f64;
    println!("two runs differ by {:.1e} rad/s RMS", apart.sqrt());
    assert!(apart.sqrt() > 10.0 * 2e-4, "{:e}", apart.sqrt());
}

#[test]
fn short_horizons_do_not_hide_what_a_model_lacks() {
    let folder = practice("p02");
    let project = project(&folder);
    let lacking = recordings(&project, &folder);
    let worst = |recording: &Recording| {
        let replayer = Replayer::new(&project.plant, recording).unwrap();
        let replayed = replayer.replay_windowed(&project.plant, 0.5).unwrap();
        replayed.channels.iter().map(|c| c.rms_error / c.floor).fold(0.0, f64::max)
    };
    assert!(lacking.iter().map(worst).fold(0.0, f64::max) > 10.0);
}
