//! Recordings of an independent simulator: the machine as modelled replays to its noise floor, and what a machine has
//! more than its model is named, with its size, from recordings alone.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use counterpoise_diagnose::answer::Verdict;
use counterpoise_diagnose::bench::Pool;
use counterpoise_diagnose::diagnose;
use counterpoise_project::Project;
use counterpoise_project::recording::Table;
use counterpoise_simulate::recording::Recording;
use counterpoise_simulate::replay::{Loop, replay};

/// As many threads as the machine has.
struct Threads;

impl Pool for Threads {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        counterpoise_tests::in_parallel(count, job);
    }
}

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
        let table = Table::read(&fs::read(path).unwrap(), &path.display().to_string()).unwrap();
        project.recording.apply(&table).unwrap().recording()
    };
    paths.iter().map(read).collect()
}

/// The largest RMS error of a channel over its floor.
fn worst(project: &Project, folder: &Path) -> f64 {
    let control = Loop::Closed(project.recording_controller.clone().unwrap());
    let replays =
        recordings(project, folder).into_iter().map(|r| replay(&project.plant, &r, &control).unwrap());
    let ratios = replays.flat_map(|r| r.channels.into_iter().map(|c| c.rms_error / c.floor));
    ratios.fold(0.0, f64::max)
}

fn practice(machine: &str) -> Option<PathBuf> {
    let folder = root().join("../shared/recordings/practice").join(machine);
    if !folder.is_dir() {
        println!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

#[test]
fn a_machine_as_modelled_replays_to_its_floor_and_is_consistent() {
    let Some(folder) = practice("p08") else { return };
    let project = project(&folder);
    assert!(worst(&project, &folder) < 1.5);
    let controller = project.recording_controller.clone().unwrap();
    let found = diagnose(&project.plant, &controller, &recordings(&project, &folder), &Threads).unwrap();
    assert_eq!(found.answer.verdict, Verdict::Consistent, "{:?}", found.answer.findings);
    assert!(found.answer.findings.is_empty());
}

#[test]
fn left_out_friction_is_named_sized_and_its_improved_model_fits_what_it_has_not_seen() {
    let folder = root().join("examples/left-out-friction");
    let project = project(&folder);
    assert!(worst(&project, &folder) > 3.0);
    let controller = project.recording_controller.clone().unwrap();
    let found = diagnose(&project.plant, &controller, &recordings(&project, &folder), &Threads).unwrap();
    assert_eq!(found.answer.verdict, Verdict::Named);
    assert_eq!(found.answer.findings.len(), 1);
    let finding = &found.answer.findings[0];
    assert_eq!((finding.component, finding.effect), ("pivot", "stribeck"));
    let value = |name: &str| finding.parameters.iter().find(|p| p.name == name).unwrap().value;
    assert!((value("static_ratio") / 1.55 - 1.0).abs() < 0.02);
    assert!((value("stribeck_rate") / 0.012 - 1.0).abs() < 0.05);
    for (channel, after) in &found.answer.fit.held_out_after {
        assert!(after.rms_error < 1.5 * after.floor, "{channel}: {after:?}");
    }
    let improved = Project { plant: found.improved, ..project };
    assert!(worst(&improved, &folder.join("unseen")) < 1.5);
}
