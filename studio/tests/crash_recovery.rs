//! A session killed at any moment, thirty times: what was done a second before is there again, and the project file is whole.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common;

use counterpoise_project::{Attachments, Document, Project};
use counterpoise_studio::command::Command;
use counterpoise_studio::studio::Studio;

/// In the environment of the process that is killed: the folder that it works in.
const FOLDER: &str = "COUNTERPOISE_KILLED_SESSION";
const KILLS: u32 = 30;
/// The edits that a crash may take.
const LOSS: Duration = Duration::from_secs(1);
/// A session on a busy machine makes its first edit by then.
const STARTS_WITHIN: Duration = Duration::from_secs(60);
/// One kill of so many comes while the session starts.
const EARLY_KILLS: u32 = 5;
/// Every so many edits the session saves.
const SAVES: u32 = 17;

fn gain(k: u32) -> f64 {
    25.0 + 0.001 * f64::from(k)
}

/// The session: edits and saves without end, and says each edit when it is made. Does nothing in an ordinary run of the tests.
#[test]
fn session_that_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else { return };
    let mut studio = Studio::new(&folder.join("state"), Arc::new(|| {}));
    studio.run(&Command::Open { path: folder.clone() });
    common::wait_for_files(&mut studio);
    let first = (error_gain(studio.opened.as_ref().unwrap().session.text()) - 25.0) / 0.001;
    for k in first.round() as u32 + 1.. {
        let path = "synth.feedback.error.gain".to_owned();
        studio.run(&Command::Set { path, value: gain(k), gesture: Some(u64::from(k / 5)) });
        if k % SAVES == 0 {
            studio.run(&Command::Save);
        }
        studio.update();
        println!("made {k}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Returns the error weight's gain in a project's text, which must be whole.
fn error_gain(text: &str) -> f64 {
    let document = Document::parse(text, "project.toml");
    let project = Project::resolve(&document, &Attachments::none()).expect("the project is whole").project;
    let weight = &project.synth.expect("weights").specification.feedback.error;
    counterpoise_synth::weight::handles::weight_numbers(weight)[0].value
}

fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("counterpoise-killed-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    std::fs::copy(example, folder.join("project.toml")).unwrap();
    folder
}

/// The moment of a kill.
enum Kill {
    AfterStart(Duration),
    AfterFirstEdit(Duration),
}

/// Runs the session and kills it; gives when each edit was made, and when it was killed.
fn run_and_kill(folder: &Path, kill: Kill) -> (Vec<(u32, Instant)>, Instant) {
    let mut child = Process::new(std::env::current_exe().unwrap())
        .args(["--exact", "crash_recovery::session_that_is_killed", "--nocapture"])
        .env(FOLDER, folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let (first, seen) = std::sync::mpsc::channel();
    let reader = std::thread::spawn(move || {
        let number = |line: String| {
            let made = (line.split_once("made ")?.1.trim().parse().ok()?, Instant::now());
            // Nobody listens any more when a slow session makes its first edit.
            let _ = first.send(());
            Some(made)
        };
        lines.map_while(Result::ok).filter_map(number).collect::<Vec<_>>()
    });
    match kill {
        Kill::AfterStart(after) => std::thread::sleep(after),
        Kill::AfterFirstEdit(after) => {
            seen.recv_timeout(STARTS_WITHIN).unwrap();
            std::thread::sleep(after);
        }
    }
    let at = Instant::now();
    child.kill().unwrap();
    child.wait().unwrap();
    (reader.join().unwrap(), at)
}

#[test]
fn thirty_kills_lose_at_most_the_last_second() {
    let folder = folder();
    let (mut edits, mut lost, mut oldest) = (0, 0, Duration::ZERO);
    for k in 0..KILLS {
        let after = Duration::from_millis(u64::from(k * 7919 % 140));
        let kill = if k % EARLY_KILLS == 0 { Kill::AfterStart(after) } else { Kill::AfterFirstEdit(after) };
        let (made, at) = run_and_kill(&folder, kill);
        error_gain(&std::fs::read_to_string(folder.join("project.toml")).unwrap());
        let mut again = Studio::new(&folder.join("state"), Arc::new(|| {}));
        again.run(&Command::Open { path: folder.clone() });
        common::wait_for_files(&mut again);
        let there = error_gain(again.opened.as_ref().unwrap().session.text());
        let due = made.iter().rev().find(|(_, when)| at.duration_since(*when) >= LOSS).map_or(0, |(k, _)| *k);
        assert!(there >= gain(due) - 1e-9, "kill {k}: {there} where {} was made a second before", gain(due));
        edits += made.len();
        for (_, when) in made.iter().filter(|(n, _)| gain(*n) > there + 1e-9) {
            lost += 1;
            oldest = oldest.max(at.saturating_duration_since(*when));
        }
    }
    eprintln!(
        "{KILLS} kills, {edits} edits, {lost} lost with the session, the oldest made {oldest:.0?} before its end"
    );
    assert!(edits > KILLS as usize, "the sessions did next to nothing: {edits} edits");
    std::fs::remove_dir_all(folder).unwrap();
}
