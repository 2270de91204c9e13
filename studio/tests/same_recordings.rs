//! The studio and the command line answer alike about recordings: the same JSON, to the last byte.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

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
        let project = projects::load(&folder, Purpose::Model).unwrap().project;
        for inside in folders {
            let paths = vec![folder.join(inside)];
            let controller = recording_controller(&project).unwrap();
            let controller = controller.as_ref();
            let files = projects::recordings(&paths).unwrap();
            let read = read(&project, controller, &files, Gaps::Repaired).unwrap();
            let control = control_for(controller, read.iter().map(|item| &item.recording));
            let expected = replay(&project, &read, &control, ReplayLength::Automatic).unwrap();
            let expected: Vec<_> = expected.iter().map(describe_replay).collect();
            let ask = ReplayRequest { project: Arc::new(project.clone()), paths, improved: None };
            let seen = replay_files(&ask, &Token::default()).unwrap().views;
            let found: Vec<_> = seen.iter().map(|one| one.fit.clone().unwrap()).collect();
            assert_eq!(json(&found), json(&expected), "{name}/{inside}");
            assert!(!found.is_empty());
        }
    }
}

/// The first seconds of a recording as CSV: enough for an answer, and quick.
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
    let project = projects::load(&source, Purpose::Model).unwrap().project;
    let files = projects::recordings(&[source.join("triangle.parquet")]).unwrap();
    let whole = read(&project, None, &files, Gaps::AsWritten).unwrap();
    files::write(&folder.join("project.toml"), &std::fs::read(source.join("project.toml")).unwrap()).unwrap();
    files::write(&folder.join("start.csv"), excerpt(&whole[0].recording, 2500).as_bytes()).unwrap();
    let paths = vec![folder.join("start.csv")];
    let workers = counterpoise_host::workers::Workers::new(counterpoise_host::stages::Progress::Quiet);
    let expected = diagnose(&project, &projects::recordings(&paths).unwrap(), &workers).unwrap();
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
