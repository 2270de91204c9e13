//! The studio and the command line answer alike about recordings: the same JSON, to the last byte.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use common::{settle, studio};
use counterpoise_controller::{Readings, SampledController};
use counterpoise_host::worker::CancelToken;
use counterpoise_host::{files, projects};
use counterpoise_pipeline::build_plant_model;
use counterpoise_pipeline::recordings::read::{loop_of, recording_controller};
use counterpoise_pipeline::recordings::{GapTreatment, ReplayLength, diagnose, read_files, replay};
use counterpoise_project::{Project, Purpose};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_report::wording::answer::describe_diagnosed_recordings;
use counterpoise_report::wording::recordings::describe_replay;
use counterpoise_simulate::{Imperfections, Initial, Scenario, Simulator};
use counterpoise_studio::command::Command;
use counterpoise_studio::jobs::recording_views::{ReplayRequest, replay_files};
use serde::Serialize;

/// Examples that hold recordings, each with its folders of them.
const EXAMPLES: [(&str, &[&str]); 2] =
    [("left-out-friction", &[".", "unseen"]), ("amplifier-curve", &["balanced", "midpoint"])];

fn json(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).unwrap()
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

/// The JSON of recordings replayed in the studio, and as the command line replays them.
fn both_ways(folder: &Path, paths: Vec<PathBuf>) -> [String; 2] {
    let project = projects::load_project(folder, Purpose::Model).unwrap().project;
    let controller = recording_controller(&project).unwrap();
    let controller = controller.as_ref();
    let files = projects::read_recordings(&paths).unwrap();
    let read = read_files(&project, controller, &files, GapTreatment::Repaired).unwrap();
    let expected = replay(&project, &read, &loop_of(&project, controller), ReplayLength::Automatic).unwrap();
    let expected: Vec<_> = expected.iter().map(describe_replay).collect();
    let project = Arc::new(project);
    let ask = ReplayRequest { project, folder: folder.to_owned(), paths, improved: None };
    let seen = replay_files(&ask, &CancelToken::default()).unwrap().views;
    let found: Vec<_> = seen.iter().map(|one| one.fit.clone().unwrap()).collect();
    assert!(!found.is_empty());
    [json(&found), json(&expected)]
}

/// Returns what is replayed of a folder: its first recording, or the folder itself if `EVERY_EXAMPLE` is set, as in `.ci/evidence`.
fn choose_recording(folder: &Path) -> PathBuf {
    match std::env::var_os("EVERY_EXAMPLE") {
        Some(_) => folder.to_owned(),
        None => PathBuf::from(&projects::read_recordings(&[folder.to_owned()]).unwrap()[0].name),
    }
}

#[test]
fn a_replay_in_the_studio_is_the_replay_of_the_command_line() {
    for (name, folders) in EXAMPLES {
        for inside in folders {
            let folder = example(name);
            let [found, expected] = both_ways(&folder, vec![choose_recording(&folder.join(inside))]);
            assert_eq!(found, expected, "{name}/{inside}");
        }
    }
}

/// Control without a controller: two sines, in volts.
struct Sines {
    amplitude_v: f64,
    sample: f64,
    period_s: f64,
}

impl SampledController for Sines {
    fn reset(&mut self) {
        self.sample = 0.0;
    }

    fn step(&mut self, _: &Readings) -> f64 {
        let t = self.sample * self.period_s;
        self.sample += 1.0;
        self.amplitude_v * ((5.0 * t).sin() + 0.5 * (31.0 * t).sin())
    }
}

/// Samples and length of a recording of an example's machine, whichever is shorter.
const SAMPLES: f64 = 3000.0;
const LENGTH_S: f64 = 2.0;

/// A recording of a project's machine under two sines, as CSV.
fn record_machine(project: &Project) -> String {
    let plant = build_plant_model(project).unwrap().plant;
    let period_s = plant.parameters().interface.sample_period_s;
    let scenario = Scenario {
        imperfections: Imperfections::NoiseAndQuantisation { seed: 3 },
        initial: Initial::Rest { hub_angle_rad: project.model.operating_point.hub_angle_rad },
        ..Scenario::at_rest(LENGTH_S.min(SAMPLES * period_s))
    };
    let mut control = Sines { amplitude_v: 0.5, sample: 0.0, period_s };
    let history = Simulator::new(&plant).unwrap().run(&mut control, &scenario).unwrap();
    excerpt(&history.readings.recording("run", period_s), history.readings.control_v().len())
}

/// Every other example, on a recording that its own machine made.
#[test]
fn every_example_replays_in_the_studio_as_on_the_command_line() {
    let all = std::fs::read_dir(example(".")).unwrap().map(|entry| entry.unwrap().path());
    let with_recordings = |path: &Path| EXAMPLES.iter().any(|(name, _)| path.ends_with(name));
    let scratch = files::scratch_folder().unwrap();
    let mut replayed = 0;
    for folder in all.filter(|path| path.join("project.toml").exists() && !with_recordings(path)) {
        let project = projects::load_project(&folder, Purpose::Model).unwrap().project;
        let path = scratch.path().join(format!("{replayed}.csv"));
        files::write_file(&path, record_machine(&project).as_bytes()).unwrap();
        let [found, expected] = both_ways(&folder, vec![path]);
        assert_eq!(found, expected, "{}", folder.display());
        replayed += 1;
    }
    assert!(replayed >= 11, "{replayed}");
}

/// One recording lacks the demand: it alone is replayed under its recorded control, in the studio as on the command line.
#[test]
fn a_recording_without_the_demand_does_not_change_how_the_others_are_replayed() {
    let folder = example("left-out-friction");
    let scratch = files::scratch_folder().unwrap();
    let project = projects::load_project(&folder, Purpose::Replay).unwrap().project;
    let file = projects::read_recordings(&[folder.join("triangle.parquet")]).unwrap();
    let mut whole = read_files(&project, None, &file, GapTreatment::AsWritten).unwrap().remove(0).recording;
    let written = |name: &str, recording: &Recording| {
        let path = scratch.path().join(name);
        files::write_file(&path, excerpt(recording, 1500).as_bytes()).unwrap();
        path
    };
    let with = written("with.csv", &whole);
    whole.remove(Channel::Demand);
    let without = written("without.csv", &whole);
    let [alone, _] = both_ways(&folder, vec![with.clone()]);
    let [found, expected] = both_ways(&folder, vec![with, without]);
    assert_eq!(found, expected);
    let parse = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    assert_eq!(parse(&found)[0], parse(&alone)[0]);
    assert_ne!(parse(&found)[0]["channels"]["hub_rate"], parse(&found)[1]["channels"]["hub_rate"]);
}

/// Recordings under a controller that another state of the project exported: the note of the command line stands first.
#[test]
fn a_replay_in_the_studio_says_if_another_project_exported_the_controller() {
    let folder = std::env::temp_dir().join(format!("counterpoise-other-export-{}", std::process::id()));
    let text = std::fs::read_to_string(example("reference-rig").join("project.toml")).unwrap();
    let whole = text.replace("sandy-loam.parquet", "road.parquet");
    let road = std::fs::read(example("reference-rig").join("sandy-loam.parquet")).unwrap();
    files::write_file(&folder.join("road.parquet"), &road).unwrap();
    files::write_file(&folder.join("project.toml"), whole.as_bytes()).unwrap();
    let project = projects::load_project(&folder, Purpose::Design).unwrap().project;
    let modelled = build_plant_model(&project).unwrap();
    let reduced = counterpoise_pipeline::reduce_plant(&project, &modelled).unwrap();
    let made = counterpoise_pipeline::synthesise(&project, &modelled, &reduced).unwrap();
    let identity = counterpoise_pipeline::ProjectIdentity { name: "rig".to_owned(), hash: "0123".to_owned() };
    let controller =
        counterpoise_pipeline::exchange::ControllerResult::new(&identity, &made.sampled.controller);
    files::write_file(&folder.join("controller.json"), json(&controller).as_bytes()).unwrap();
    let named = "\n[recording_controller]\nkind = \"exported\"\nfile = \"controller.json\"\n";
    let text = format!("{whole}{named}");
    files::write_file(&folder.join("project.toml"), text.as_bytes()).unwrap();
    let project = projects::load_project(&folder, Purpose::Model).unwrap().project;
    let source = example("left-out-friction").join("triangle.parquet");
    let file = projects::read_recordings(&[source]).unwrap();
    let recorded = read_files(&project, None, &file, GapTreatment::AsWritten).unwrap();
    files::write_file(&folder.join("start.csv"), excerpt(&recorded[0].recording, 1500).as_bytes()).unwrap();
    let paths = vec![folder.join("start.csv")];
    let ask =
        ReplayRequest { project: Arc::new(project.clone()), folder: folder.clone(), paths, improved: None };
    let views = replay_files(&ask, &CancelToken::default()).unwrap().views;
    let other = counterpoise_pipeline::recordings::controller_origin::other_export(
        &project,
        &files::ProjectFolder(folder.clone()),
    );
    let note = counterpoise_report::wording::recordings::describe_other_export(&other.unwrap());
    assert!(note.contains("0123"), "{note}");
    assert_eq!(views[0].remarks.first(), Some(&note));
    let _ = std::fs::remove_dir_all(folder);
}

/// Returns the first seconds of a recording as CSV: enough for an answer, and quick.
fn excerpt(recording: &Recording, samples: usize) -> String {
    let part = recording.part(0..samples);
    let channels = [Channel::Demand, Channel::Control, Channel::HubRate, Channel::MotorRate];
    let columns: Vec<_> =
        channels.into_iter().filter_map(|channel| Some((channel, part.samples(channel)?))).collect();
    let names: Vec<String> =
        columns.iter().map(|(channel, _)| format!("{} [{}]", channel.name(), channel.unit())).collect();
    let mut text = format!("time [s],{}\n", names.join(","));
    for k in 0..samples {
        let values: Vec<String> = columns.iter().map(|column| format!("{:?}", column.1[k])).collect();
        text += &format!("{:?},{}\n", k as f64 * part.sample_period_s, values.join(","));
    }
    text
}

#[test]
fn a_diagnosis_in_the_studio_is_the_diagnosis_of_the_command_line() {
    let folder = std::env::temp_dir().join(format!("counterpoise-same-diagnosis-{}", std::process::id()));
    let source = example("left-out-friction");
    let project = projects::load_project(&source, Purpose::Model).unwrap().project;
    let files = projects::read_recordings(&[source.join("triangle.parquet")]).unwrap();
    let whole = read_files(&project, None, &files, GapTreatment::AsWritten).unwrap();
    files::write_file(&folder.join("project.toml"), &std::fs::read(source.join("project.toml")).unwrap())
        .unwrap();
    files::write_file(&folder.join("start.csv"), excerpt(&whole[0].recording, 1500).as_bytes()).unwrap();
    let paths = vec![folder.join("start.csv")];
    let workers =
        counterpoise_host::workers::ProgressPool::new(counterpoise_host::stages::ProgressDisplay::Quiet);
    let expected = diagnose(&project, &projects::read_recordings(&paths).unwrap(), &workers).unwrap();
    let mut window = studio(&folder);
    settle(&mut window);
    window.run(&Command::Recordings { paths });
    settle(&mut window);
    window.run(&Command::Diagnose);
    settle(&mut window);
    let found = window.jobs().diagnosis.as_ref().unwrap().as_ref().unwrap();
    assert_eq!(json(&found.answer), json(&describe_diagnosed_recordings(&expected).answer));
    assert!(found.diagnosis.improved == expected.diagnosis.improved);
    drop(window);
    std::fs::remove_dir_all(folder).unwrap();
}
