//! An improved project is a project: every command takes what `diagnose --save` writes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::support;

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/");

/// Runs a command in a folder; the verdict of a requirement may be that it fails.
fn counterpoise(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_counterpoise");
    let run = Command::new(program).args(arguments).current_dir(folder).output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(matches!(run.status.code(), Some(0 | 1)), "{arguments:?}: {said}");
    run
}

/// Returns the reference rig's project with short runs and the controller of the recordings, small enough for a quick
/// test.
fn project(folder: &Path) -> String {
    let rig = support::write_short_rig(folder, 3);
    rig + "\n[recording_controller]\nkind = \"pi\"\nkp = 18.0\nki = 80.0\nbias = 2.88\n\n[recording]\nwindows = [[0.0, 2.5]]\n[recording.channels]\ncontrol = \"control\"\n"
}

#[test]
fn what_a_diagnosis_saves_every_command_takes() {
    let folder = support::folder("improved");
    fs::write(folder.join("project.toml"), project(&folder)).unwrap();
    let recording = format!("{EXAMPLES}left-out-friction/triangle.parquet");
    let run = counterpoise(
        &folder,
        &["diagnose", "project.toml", &recording, "--save", "improved.toml", "--report", "diagnosis.html"],
    );
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(said.contains("the project's design on the improved model"), "{said}");
    assert_ne!(
        fs::read(folder.join("improved.toml")).unwrap(),
        fs::read(folder.join("project.toml")).unwrap()
    );
    let page = fs::read_to_string(folder.join("diagnosis.html")).unwrap();
    for part in [
        "What it means for the controller",
        "Control against rate",
        "Spectra of the errors",
        "Residual tests",
        "Localisation",
        "What was tried",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("NaN"), "a number that is none reached the page");
    for arguments in [
        &["model", "improved.toml"][..],
        &["reduce", "improved.toml"],
        &["synth", "improved.toml"],
        &["verify", "improved.toml"],
        &["design", "improved.toml", "-o", "design"],
        &["export", "improved.toml", "-o", "code"],
        &["sweep", "improved.toml", "-o", "sweep"],
        &["fra", "improved.toml", "--loop", "plant", "--amplitudes", "1", "--frequencies", "5,8"],
        &["replay", "improved.toml", &recording],
        &["identify", "improved.toml", &recording],
    ] {
        counterpoise(&folder, arguments);
    }
}
