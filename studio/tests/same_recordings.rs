//! The studio and the command line answer alike about recordings: what the command writes with `--json` is, byte for byte, what the studio has: `replay` and `diagnose`
//! here, `identify` and `experiment` among the studies.
//!
//! `counterpoise` is another package, whose program may be old or missing when these tests run. Its library is all of the program, so each command runs in a
//! process of its own, which is this one started again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::sync::Arc;

use common::{settle, studio};
use counterpoise_controller::{Readings, SampledController};
use counterpoise_host::json::json_text;
use counterpoise_host::worker::CancelToken;
use counterpoise_host::{files, projects};
use counterpoise_pipeline::build_plant_model;
use counterpoise_pipeline::exchange::SCHEMA;
use counterpoise_pipeline::recordings::{GapTreatment, read_files};
use counterpoise_pipeline::results::ReplayResult;
use counterpoise_project::{Project, Purpose};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::{Imperfections, Initial, Scenario, Simulator};
use counterpoise_studio::command::Command;
use counterpoise_studio::jobs::recording_views::{ReplayRequest, replay_files};
use serde::Serialize;

/// Examples that hold recordings, each with its folders of them.
const EXAMPLES: [(&str, &[&str]); 2] =
    [("left-out-friction", &[".", "unseen"]), ("amplifier-curve", &["balanced", "midpoint"])];

/// Examples whose recordings other people published. They lie beside the checkout, so `.ci/evidence` replays them.
#[cfg(feature = "evidence")]
const PUBLISHED: &str = "real-recordings";

/// The environment variable with the arguments of [`command_line_in_a_process_of_its_own`], one a line.
const ARGUMENTS: &str = "COUNTERPOISE_TEST_ARGUMENTS";

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("examples").join(name)
}

/// The command line of [`write_json`]; nothing if the tests are run as such.
#[test]
fn command_line_in_a_process_of_its_own() {
    let Ok(arguments) = std::env::var(ARGUMENTS) else { return };
    let words = std::iter::once("counterpoise").chain(arguments.lines());
    std::process::exit(counterpoise::run_command_line(words.map(OsString::from)).into());
}

/// Returns what a command of the command line writes with `--json`.
fn write_json(words: &[&str], project: &Path, recordings: &[PathBuf]) -> String {
    let scratch = files::scratch_folder().unwrap();
    let output = scratch.path().join("result.json");
    let paths = std::iter::once(project).chain(recordings.iter().map(PathBuf::as_path));
    let mut arguments: Vec<&OsStr> = words.iter().map(OsStr::new).collect();
    arguments.extend(paths.chain([Path::new("--json"), output.as_path()]).map(Path::as_os_str));
    run_command_line(&arguments);
    std::fs::read_to_string(output).unwrap()
}

/// Runs a command of the command line in a process of its own; a verdict that fails is no error.
pub fn run_command_line(arguments: &[&OsStr]) {
    let mut process = Process::new(std::env::current_exe().unwrap());
    process.args(["--exact", "same_recordings::command_line_in_a_process_of_its_own", "--nocapture"]);
    process.env(ARGUMENTS, arguments.join(OsStr::new("\n"))).stdout(Stdio::null());
    let status = process.status().unwrap();
    assert!(matches!(status.code(), Some(0 | 1)), "{arguments:?}: {status}");
}

/// Returns the text that the command line writes of a result.
fn written_by_command(result: &impl Serialize) -> String {
    json_text(result).unwrap().replacen("{\n", &format!("{{\n  \"schema\": \"{SCHEMA}\",\n"), 1)
}

/// The JSON of recordings replayed in the studio, and as the command line replays them. `path` is a project file or its folder.
fn both_ways(path: &Path, recordings: Vec<PathBuf>) -> [String; 2] {
    let loaded = projects::load_project(path, Purpose::Model).unwrap();
    // Without a controller of the recordings the command line asks for `--open-loop`; the studio plays the recorded control back.
    let open: &[&str] =
        if loaded.project.recording_controller.is_none() { &["replay", "--open-loop"] } else { &["replay"] };
    let expected = write_json(open, path, &recordings);
    let folder = loaded.path.parent().unwrap().to_owned();
    let ask = ReplayRequest { project: Arc::new(loaded.project), folder, paths: recordings, improved: None };
    let views = replay_files(&ask, &CancelToken::default()).unwrap().views;
    assert!(!views.is_empty());
    let errors: Vec<_> = views.iter().flat_map(|view| &view.errors).collect();
    let fit = |view: &counterpoise_studio::jobs::recording_views::RecordingView| view.fit.clone();
    let recordings =
        views.iter().map(fit).collect::<Option<Vec<_>>>().unwrap_or_else(|| panic!("{errors:?}"));
    [written_by_command(&ReplayResult { recordings }), expected]
}

/// Returns whether everything is replayed and diagnosed from start to end, as in `.ci/evidence`.
fn is_complete() -> bool {
    std::env::var_os("EVERY_EXAMPLE").is_some()
}

/// Returns what is replayed of a folder: its first recording, or the folder itself if `EVERY_EXAMPLE` is set.
fn choose_recording(folder: &Path) -> PathBuf {
    if is_complete() {
        return folder.to_owned();
    }
    PathBuf::from(&projects::read_recordings(&[folder.to_owned()]).unwrap()[0].name)
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

#[cfg(feature = "evidence")]
#[test]
fn published_recordings_replay_in_the_studio_as_on_the_command_line() {
    let recordings = example("../../shared/recordings/real");
    let mut replayed = 0;
    for file in project_files().into_iter().filter(|file| file.starts_with(example(PUBLISHED))) {
        let machine = recordings.join(file.parent().unwrap().file_name().unwrap());
        let [found, expected] = both_ways(&file, vec![machine]);
        assert_eq!(found, expected, "{}", file.display());
        replayed += 1;
    }
    assert!(replayed >= 8, "{replayed}");
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

/// Returns the project files of all examples. That of a traverse axis is a part of another project.
fn project_files() -> Vec<PathBuf> {
    let (mut found, mut folders) = (Vec::new(), vec![example("")]);
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "toml") && !path.ends_with("traverse.toml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Returns a copy of a project file beside it in a folder of its own, without the names of columns: the recordings of [`record_machine`] have those of the
/// channels.
fn without_mapping(file: &Path, scratch: &Path) -> PathBuf {
    let mut table: toml::Table = std::fs::read_to_string(file).unwrap().parse().unwrap();
    table.remove("recording");
    let path = scratch.join("project.toml");
    files::write_file(&path, table.to_string().as_bytes()).unwrap();
    path
}

/// Every other project of the examples, on a recording that its own machine made.
#[test]
fn every_example_replays_in_the_studio_as_on_the_command_line() {
    let with_recordings = |path: &Path| EXAMPLES.iter().any(|(name, _)| path.starts_with(example(name)));
    let scratch = files::scratch_folder().unwrap();
    let mut replayed = 0;
    for file in project_files().into_iter().filter(|path| !with_recordings(path)) {
        let project = projects::load_project(&file, Purpose::Model).unwrap().project;
        let of_example = scratch.path().join(replayed.to_string());
        let recording = of_example.join("run.csv");
        files::write_file(&recording, record_machine(&project).as_bytes()).unwrap();
        let own = if project.recording.channels.is_empty() {
            file.clone()
        } else {
            without_mapping(&file, &of_example)
        };
        let [found, expected] = both_ways(&own, vec![recording]);
        assert_eq!(found, expected, "{}", file.display());
        replayed += 1;
    }
    assert!(replayed >= 29, "{replayed}");
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
    let of = |text: &str, k: usize| parse(text)["recordings"][k].clone();
    assert_eq!(of(&found, 0), of(&alone, 0));
    assert_ne!(of(&found, 0)["channels"]["hub_rate"], of(&found, 1)["channels"]["hub_rate"]);
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
    files::write_file(&folder.join("controller.json"), json_text(&controller).unwrap().as_bytes()).unwrap();
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

/// Returns a folder with the project of an example, and in it what is diagnosed of one of its recordings: its start, or all of it if
/// `EVERY_EXAMPLE` is set.
fn recording_to_diagnose(example_folder: &Path, recording: &str, folder: &Path) -> PathBuf {
    let project = projects::load_project(example_folder, Purpose::Model).unwrap().project;
    let file = projects::read_recordings(&[example_folder.join(recording)]).unwrap();
    let whole = read_files(&project, None, &file, GapTreatment::AsWritten).unwrap().remove(0).recording;
    let written = std::fs::read(example_folder.join("project.toml")).unwrap();
    files::write_file(&folder.join("project.toml"), &written).unwrap();
    let path = folder.join("start.csv");
    let samples = if is_complete() { whole.len() } else { 1500 };
    files::write_file(&path, excerpt(&whole, samples).as_bytes()).unwrap();
    path
}

#[test]
fn a_diagnosis_in_the_studio_is_the_diagnosis_of_the_command_line() {
    for (name, folders) in EXAMPLES {
        let recording = Path::new(folders[0]).join("triangle.parquet");
        let scratch = files::scratch_folder().unwrap();
        let folder = scratch.path().to_owned();
        let paths = vec![recording_to_diagnose(&example(name), &recording.display().to_string(), &folder)];
        let expected = write_json(&["diagnose"], &folder, &paths);
        let mut window = studio(&folder);
        settle(&mut window);
        window.run(&Command::Recordings { paths });
        settle(&mut window);
        window.run(&Command::Diagnose);
        settle(&mut window);
        let found = window.jobs().diagnosis.as_ref().unwrap().as_ref().unwrap();
        assert_eq!(written_by_command(&found.answer), expected, "{name}");
    }
}
