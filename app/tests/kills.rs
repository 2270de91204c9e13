//! A program that is killed at any system call leaves every file as it was, or whole.
//!
//! With `strace` the kill is placed at the k-th call that changes the file system; without it the test says so and does nothing.
//! `KILLS` sets how many are tried (default 6, spread over all calls); `.ci/evidence` tries every one.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::support;

use support::{CAMPAIGN, folder, folder_with, report_skip};

/// The calls that change the file system.
const CALLS: &str =
    "openat,write,rename,renameat,renameat2,fsync,unlink,unlinkat,mkdir,mkdirat,fchmod,chmod,ftruncate";

fn strace() -> bool {
    let tried = Command::new("strace").args(["-o", "/dev/null", "true"]).stderr(Stdio::null()).status();
    tried.is_ok_and(|status| status.success())
}

/// Returns the project that is exported: a quicker one if it is not said how many kills are tried.
fn exported_project() -> PathBuf {
    let is_quick = std::env::var_os("KILLS").is_none();
    let name = if is_quick { "direct-gimbal/project.toml" } else { "appendix-5/integral.toml" };
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

/// Returns files below a folder by their path in it; what was left half-written under a name of its own is not
/// among them.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut open, mut found) = (vec![folder.to_owned()], BTreeMap::new());
    while let Some(place) = open.pop() {
        for entry in fs::read_dir(&place).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_none_or(|ending| ending != "partial") {
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Runs the program under `strace`; it is killed at the k-th call, where k is given. Returns the number of calls made.
fn trace_program(arguments: &[&str], output: &Path, kill_at: Option<usize>) -> usize {
    let log = output.with_extension("log");
    let mut command = Command::new("strace");
    command.args(["-f", "-qq", "-e"]).arg(format!("trace={CALLS}")).arg("-o").arg(&log);
    if let Some(k) = kill_at {
        command.arg("-e").arg(format!("inject={CALLS}:signal=KILL:when={k}"));
    }
    command.arg(env!("CARGO_BIN_EXE_counterpoise")).args(arguments).arg("-o").arg(output);
    let _ =
        command.env("RAYON_NUM_THREADS", "1").stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap();
    fs::read_to_string(&log).unwrap_or_default().lines().count()
}

/// Returns places at which to kill, spread evenly.
fn places(calls: usize) -> Vec<usize> {
    let wanted = std::env::var("KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(6_usize);
    let count = wanted.min(calls).max(1);
    (0..count).map(|k| 1 + k * calls / count).collect()
}

#[test]
fn an_export_that_is_killed_leaves_whole_files() {
    if !strace() {
        return report_skip("no strace: no kills at system calls");
    }
    let base = folder("kills_export");
    let project = exported_project();
    let arguments = ["export", project.to_str().unwrap(), "-q"];
    let calls = trace_program(&arguments, &base.join("whole"), None);
    let whole = files(&base.join("whole"));
    assert!(whole.len() > 3 && calls > 20, "{} files, {calls} calls", whole.len());
    let mut torn = 0;
    for k in places(calls) {
        let place = base.join(format!("killed-{k}"));
        fs::create_dir_all(&place).unwrap();
        for name in whole.keys() {
            fs::create_dir_all(place.join(name).parent().unwrap()).unwrap();
            fs::write(place.join(name), b"old").unwrap();
        }
        trace_program(&arguments, &place, Some(k));
        for (name, found) in files(&place) {
            let is_whole = found == b"old" || whole.get(&name) == Some(&found);
            torn += usize::from(!is_whole && !name.to_string_lossy().ends_with(".fmu"));
            assert!(
                is_whole || name.to_string_lossy().ends_with(".fmu"),
                "{} after call {k}",
                name.display()
            );
        }
    }
    println!("export: {} kills over {calls} system calls, {torn} torn files", places(calls).len());
}

#[test]
fn a_sweep_that_is_killed_goes_on_to_the_same_end() {
    if !strace() {
        return report_skip("no strace: no kills at system calls");
    }
    let base = folder_with("kills_sweep", CAMPAIGN);
    let project = base.join("project.toml");
    let arguments = ["sweep", project.to_str().unwrap(), "--shard", "0/2", "-q"];
    let calls = trace_program(&arguments, &base.join("whole"), None);
    let whole = files(&base.join("whole"));
    assert_eq!(whole.len(), 1);
    for k in places(calls) {
        let place = base.join(format!("killed-{k}"));
        fs::create_dir_all(&place).unwrap();
        trace_program(&arguments, &place, Some(k));
        assert!(files(&place).iter().all(|(name, found)| whole.get(name) == Some(found)), "after call {k}");
    }
    let place = base.join("killed-1");
    trace_program(&arguments, &place, None);
    assert_eq!(files(&place), whole);
    println!("sweep: {} kills over {calls} system calls, no torn file", places(calls).len());
}
