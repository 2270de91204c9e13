//! A new project: it designs as it is, and never overwrites another.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn counterpoise(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_counterpoise")).args(arguments).output().unwrap()
}

#[test]
fn a_new_project_designs_as_it_is_and_is_not_overwritten() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new").join("a crane");
    let _ = fs::remove_dir_all(&folder);
    let name = folder.to_str().unwrap();
    assert!(counterpoise(&["new", name, "--full"]).status.success());
    let text = fs::read_to_string(folder.join("project.toml")).unwrap();
    assert!(text.contains("name = \"a crane\""));

    let out = folder.join("out");
    let designed = counterpoise(&["design", name, "-o", out.to_str().unwrap(), "--quiet"]);
    assert!(designed.status.success(), "{}", String::from_utf8_lossy(&designed.stderr));
    assert!(out.join("controller.c").exists());

    let again = counterpoise(&["new", name, "--full"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("is there already"));
    assert_eq!(fs::read_to_string(folder.join("project.toml")).unwrap(), text);
}
