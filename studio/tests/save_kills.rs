//! A session that is killed at any system call of its save leaves the project file as it was, or whole with the edit, and the edit is
//! never lost.
//!
//! With `strace` the kill is placed at the k-th call that changes the file system; without it the test says so and does nothing.
//! `KILLS` sets how many are tried (default 8, spread over all calls); `.ci/evidence` tries every one.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::sync::Arc;

mod common;

use counterpoise_studio::command::Command;
use counterpoise_studio::studio::Studio;

/// The calls that change the file system.
const CALLS: &str =
    "openat,write,rename,renameat,renameat2,fsync,unlink,unlinkat,mkdir,mkdirat,fchmod,chmod,ftruncate";
/// In the environment of the process that is killed: the folder that it works in.
const FOLDER: &str = "COUNTERPOISE_SAVING_SESSION";
/// The edit: a key, and its new value, which the project file does not have.
const KEY: &str = "synth.feedback.error.gain";
const VALUE: f64 = 31.25;

/// The session: opens the project, makes one edit and saves it. Does nothing in an ordinary run of the tests.
#[test]
fn session_that_saves() {
    let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else { return };
    let mut studio = Studio::new(&folder.join("state"), Arc::new(|| {}));
    studio.run(&Command::Open { path: folder.clone() });
    common::filed(&mut studio);
    // The kills begin here: what a session does before its first edit changes no project.
    fs::write(folder.join("begun"), b"").unwrap();
    studio.run(&Command::Set { path: KEY.to_owned(), value: VALUE, gesture: None });
    common::filed(&mut studio);
    studio.run(&Command::Save);
    common::filed(&mut studio);
    fs::write(folder.join("saved"), b"").unwrap();
}

/// A folder with the example's project.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("save_kills_{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    fs::copy(example, folder.join("project.toml")).unwrap();
    folder
}

/// Runs the session under `strace`, killed at the k-th call where k is given. Returns the calls that it made, one a line.
fn traced(folder: &Path, kill_at: Option<usize>) -> Vec<String> {
    let log = folder.join("calls.log");
    let mut command = Process::new("strace");
    command.args(["-f", "-qq", "-e"]).arg(format!("trace={CALLS}")).arg("-o").arg(&log);
    if let Some(k) = kill_at {
        command.arg("-e").arg(format!("inject={CALLS}:signal=KILL:when={k}"));
    }
    command.arg(std::env::current_exe().unwrap()).args(["--exact", "session_that_saves", "--test-threads=1"]);
    command.env(FOLDER, folder).stdout(Stdio::null()).stderr(Stdio::null());
    let _ = command.status().unwrap();
    fs::read_to_string(&log).unwrap_or_default().lines().map(str::to_owned).collect()
}

/// Places at which to kill, spread evenly from the first edit to the end.
fn places(calls: &[String]) -> Vec<usize> {
    let from = calls.iter().position(|call| call.contains("/begun")).unwrap();
    let wanted = std::env::var("KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(8_usize);
    let count = wanted.min(calls.len() - from);
    (0..count).map(|k| from + 1 + k * (calls.len() - from) / count).collect()
}

/// The value of the edited key when the project is opened again, the journal included.
fn value_after(folder: &Path) -> f64 {
    let mut studio = Studio::new(&folder.join("state"), Arc::new(|| {}));
    studio.run(&Command::Open { path: folder.to_owned() });
    common::filed(&mut studio);
    let text = studio.opened.as_ref().unwrap().session.text().to_owned();
    let whole: toml::Table = text.parse().unwrap();
    let found = KEY.split('.').try_fold(&toml::Value::Table(whole), |place, key| place.get(key)).cloned();
    found.unwrap().as_float().unwrap()
}

#[test]
fn a_save_that_is_killed_leaves_a_whole_project() {
    let there = Process::new("strace").args(["-o", "/dev/null", "true"]).stderr(Stdio::null()).status();
    if !there.is_ok_and(|status| status.success()) {
        let _ = writeln!(std::io::stderr(), "skipped: no strace: no kills at the system calls of a save");
        return;
    }
    let whole = folder("whole");
    let old = fs::read(whole.join("project.toml")).unwrap();
    let calls = traced(&whole, None);
    let new = fs::read(whole.join("project.toml")).unwrap();
    assert!(whole.join("saved").exists() && new != old, "the session saves");
    let places = places(&calls);
    let (mut saved, mut kept) = (0, 0);
    for k in &places {
        let place = folder("killed");
        traced(&place, Some(*k));
        assert!(!place.join("saved").exists() || *k + 3 > calls.len(), "killed at call {k}");
        let found = fs::read(place.join("project.toml")).unwrap();
        assert!(found == old || found == new, "torn at call {k} of {}", calls.len());
        let is_new = found == new;
        saved += usize::from(is_new);
        if is_new {
            assert_eq!(value_after(&place), VALUE, "call {k}");
        } else {
            kept += usize::from(value_after(&place) == VALUE);
        }
    }
    println!(
        "{} kills over {} calls: {saved} saved, {kept} in the journal, no torn file",
        places.len(),
        calls.len()
    );
}
