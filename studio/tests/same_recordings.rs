//! The studio and the command line answer alike about recordings: the same JSON, to the last byte.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use common::{settle, studio};
use counterpoise_host::worker::Token;
use counterpoise_host::{files, projects};
use counterpoise_pipeline::recordings::read::{control_for, recording_controller};
use counterpoise_pipeline::recordings::{Gaps, ReplayLength, diagnose, read, replay};
use counterpoise_project::Purpose;
use counterpoise_recordings::{Channel, Recording};
use counterpoise_report::wording::answer::describe_diagnosed_recordings;
use counterpoise_report::wording::recordings::describe_replay;
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

#[test]
fn a_replay_in_the_studio_is_the_replay_of_the_command_line() {
    for (name, folders) in EXAMPLES {
        let folder = example(name);
        let project = projects::load_project(&folder, Purpose::Model).unwrap().project;
        for inside in folders {
            let paths = vec![folder.join(inside)];
            let controller = recording_controller(&project).unwrap();
            let controller = controller.as_ref();
            let files = projects::read_recordings(&paths).unwrap();
            let read = read(&project, controller, &files, Gaps::Repaired).unwrap();
            let control = control_for(controller, read.iter().map(|item| &item.recording));
            let expected = replay(&project, &read, &control, ReplayLength::Automatic).unwrap();
            let expected: Vec<_> = expected.iter().map(describe_replay).collect();
            let ask = ReplayRequest {
                project: Arc::new(project.clone()),
                folder: folder.clone(),
                paths,
                improved: None,
            };
            let seen = replay_files(&ask, &Token::default()).unwrap().views;
            let found: Vec<_> = seen.iter().map(|one| one.fit.clone().unwrap()).collect();
            assert_eq!(json(&found), json(&expected), "{name}/{inside}");
            assert!(!found.is_empty());
        }
    }
}

/// Recordings under a controller that another state of the project exported: the note of the command line stands first.
#[test]
fn a_replay_in_the_studio_says_if_another_project_exported_the_controller() {
    let folder = std::env::temp_dir().join(format!("counterpoise-other-export-{}", std::process::id()));
    let text = std::fs::read_to_string(example("reference-rig").join("project.toml")).unwrap();
    let whole = text.replace("sandy-loam.parquet", "road.parquet");
    let road = std::fs::read(example("reference-rig").join("sandy-loam.parquet")).unwrap();
    files::write(&folder.join("road.parquet"), &road).unwrap();
    files::write(&folder.join("project.toml"), whole.as_bytes()).unwrap();
    let project = projects::load_project(&folder, Purpose::Design).unwrap().project;
    let modelled = counterpoise_pipeline::model(&project).unwrap();
    let reduced = counterpoise_pipeline::reduce(&project, &modelled).unwrap();
    let made = counterpoise_pipeline::synthesise(&project, &modelled, &reduced).unwrap();
    let identity = counterpoise_pipeline::ProjectIdentity { name: "rig".to_owned(), hash: "0123".to_owned() };
    let controller =
        counterpoise_pipeline::exchange::ControllerResult::new(&identity, &made.sampled.controller);
    files::write(&folder.join("controller.json"), json(&controller).as_bytes()).unwrap();
    let named = "\n[recording_controller]\nkind = \"exported\"\nfile = \"controller.json\"\n";
    let text = format!("{whole}{named}");
    files::write(&folder.join("project.toml"), text.as_bytes()).unwrap();
    let project = projects::load_project(&folder, Purpose::Model).unwrap().project;
    let source = example("left-out-friction").join("triangle.parquet");
    let file = projects::read_recordings(&[source]).unwrap();
    let recorded = read(&project, None, &file, Gaps::AsWritten).unwrap();
    files::write(&folder.join("start.csv"), excerpt(&recorded[0].recording, 1500).as_bytes()).unwrap();
    let paths = vec![folder.join("start.csv")];
    let ask =
        ReplayRequest { project: Arc::new(project.clone()), folder: folder.clone(), paths, improved: None };
    let views = replay_files(&ask, &Token::default()).unwrap().views;
    let other = counterpoise_pipeline::recordings::controller_origin::other_export(
        &project,
        &files::Folder(folder.clone()),
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
    let whole = read(&project, None, &files, Gaps::AsWritten).unwrap();
    files::write(&folder.join("project.toml"), &std::fs::read(source.join("project.toml")).unwrap()).unwrap();
    files::write(&folder.join("start.csv"), excerpt(&whole[0].recording, 2500).as_bytes()).unwrap();
    let paths = vec![folder.join("start.csv")];
    let workers = counterpoise_host::workers::Workers::new(counterpoise_host::stages::Progress::Quiet);
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
