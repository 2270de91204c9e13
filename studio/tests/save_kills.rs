//! A session that is killed at any system call of its save leaves the project file as it was, or whole with the edit, and the edit is
//! never lost.
//!
//! With `strace` the kill is placed at the k-th call of one kind that a thread makes; without it the test says so and does nothing.
//! `KILLS` sets how many are tried (default 12, spread over all); `.ci/evidence` tries every one.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::sync::Arc;

use crate::common;

use counterpoise_studio::command::Command;
use counterpoise_studio::studio::Studio;

/// The calls that change files. A file is opened just before it is written, so a kill at the write is one after the opening.
const CALLS: &str =
    "write,fsync,rename,renameat,renameat2,unlink,unlinkat,mkdir,mkdirat,fchmod,chmod,ftruncate";
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
    common::wait_for_files(&mut studio);
    studio.run(&Command::Set { path: KEY.to_owned(), value: VALUE, gesture: None });
    common::wait_for_files(&mut studio);
    studio.run(&Command::Save);
    common::wait_for_files(&mut studio);
    fs::write(folder.join("saved"), b"").unwrap();
}

/// Returns a folder with the example's project.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("save_kills_{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    fs::copy(example, folder.join("project.toml")).unwrap();
    folder
}

/// A place at which the session is killed: a thread's k-th call of one kind.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    call: String,
    k: usize,
}

/// Runs the session under `strace`, killed at a place if one is given. Returns the places that it passed.
fn trace_session(folder: &Path, kill_at: Option<&Place>) -> BTreeSet<Place> {
    let log = folder.join("calls.log");
    let mut command = Process::new("strace");
    command.args(["-f", "-qq", "-e"]).arg(format!("trace={CALLS}")).arg("-o").arg(&log);
    if let Some(Place { call, k }) = kill_at {
        command.arg("-e").arg(format!("inject={call}:signal=KILL:when={k}"));
    }
    command.arg(std::env::current_exe().unwrap()).args([
        "--exact",
        "save_kills::session_that_saves",
        "--test-threads=1",
    ]);
    command.env(FOLDER, folder).stdout(Stdio::null()).stderr(Stdio::null());
    let _ = command.status().unwrap();
    let text = fs::read_to_string(&log).unwrap_or_default();
    let (mut counts, mut passed) = (BTreeMap::<(String, String), usize>::new(), BTreeSet::new());
    for line in text.lines() {
        // `THREAD CALL(...`; the second half of a call that was suspended begins with an angle bracket.
        let Some((thread, rest)) = line.split_once(' ') else { continue };
        let Some((call, _)) = rest.trim_start().split_once('(') else { continue };
        if CALLS.split(',').any(|known| known == call) {
            let count = counts.entry((thread.to_owned(), call.to_owned())).or_default();
            *count += 1;
            passed.insert(Place { call: call.to_owned(), k: *count });
        }
    }
    passed
}

/// Returns the places that are tried, spread evenly.
fn tried_places(places: &BTreeSet<Place>) -> Vec<&Place> {
    let wanted = std::env::var("KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(12_usize);
    let step = places.len().div_ceil(wanted.clamp(1, places.len().max(1)));
    places.iter().step_by(step.max(1)).collect()
}

/// Returns the value of the edited key when the project is opened again, the journal included.
fn value_after(folder: &Path) -> f64 {
    let mut studio = Studio::new(&folder.join("state"), Arc::new(|| {}));
    studio.run(&Command::Open { path: folder.to_owned() });
    common::wait_for_files(&mut studio);
    let text = studio.opened.as_ref().unwrap().session.text().to_owned();
    let whole: toml::Table = text.parse().unwrap();
    let found = KEY.split('.').try_fold(&toml::Value::Table(whole), |place, key| place.get(key)).cloned();
    found.unwrap().as_float().unwrap()
}

#[test]
fn a_save_that_is_killed_leaves_a_whole_project() {
    let there = Process::new("strace").args(["-o", "/dev/null", "true"]).stderr(Stdio::null()).status();
    if !there.is_ok_and(|status| status.success()) {
        return common::report_skip("no strace: no kills at the system calls of a save");
    }
    let whole = folder("whole");
    let old = fs::read(whole.join("project.toml")).unwrap();
    let places = trace_session(&whole, None);
    let new = fs::read(whole.join("project.toml")).unwrap();
    assert!(whole.join("saved").exists() && new != old, "the session saves");
    assert!(places.iter().any(|place| place.call.starts_with("rename")), "{places:?}");
    let places = tried_places(&places);
    let (mut saved, mut kept) = (0, 0);
    for at in &places {
        let place = folder("killed");
        trace_session(&place, Some(at));
        let found = fs::read(place.join("project.toml")).unwrap();
        assert!(found == old || found == new, "torn at {at:?}");
        assert!(found == new || !place.join("saved").exists(), "said to be saved, and not there, at {at:?}");
        let value = value_after(&place);
        assert!(found == old || value == VALUE, "saved, and then lost, at {at:?}");
        saved += usize::from(found == new);
        kept += usize::from(found == old && value == VALUE);
    }
    println!("{} kills: {saved} saved, {kept} in the journal, no torn file", places.len());
}
