//! `check` and `new`: what is printed, what is refused, and that older files are migrated with their comments.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn counterpoise(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_counterpoise")).args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn rig() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml"))
        .unwrap()
}

fn scratch(name: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("check").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("project.toml");
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_file_is_explained_with_what_is_assumed_and_what_that_may_cost() {
    let text = rig().replacen("back_emf_constant", "# back_emf_constant", 1);
    let path = scratch("explained", &text);
    let done = counterpoise(&["check", path.to_str().unwrap()]);
    let said = String::from_utf8(done.stdout).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    for words in [
        "inertia of 345.7 kg m^2",
        "gearbox between motor and hub): ratio 200.0",
        "plant.motor.back_emf_constant = 0.86 V s/rad (equal to the torque constant in SI units",
        "measure this next",
        "Commands that can run on this file: model",
    ] {
        assert!(said.contains(words), "{words} is missing in\n{said}");
    }
    let json = counterpoise(&["check", path.to_str().unwrap(), "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let effects = found["effects"].as_array().unwrap();
    assert!(effects.iter().any(|effect| effect["key"] == "plant.motor.back_emf_constant"), "{effects:?}");
    let size = |effect: &serde_json::Value| effect["largest_change_db"].as_f64().unwrap_or(f64::INFINITY);
    assert!(effects.windows(2).all(|two| size(&two[0]) >= size(&two[1])), "the largest comes first");
}

#[test]
fn at_most_ten_errors_are_printed_and_json_has_all() {
    let broken = rig().replace(" = 0.", " = -0.").replace("gain = ", "gian = ");
    let path = scratch("broken", &broken);
    let done = counterpoise(&["check", path.to_str().unwrap()]);
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2));
    assert_eq!(said.matches(": error: ").count(), 10, "{said}");
    assert!(said.contains("\nand ") && said.contains(" more\n"), "{said}");
    let json = counterpoise(&["check", path.to_str().unwrap(), "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!(found["errors"].as_array().unwrap().len() > 10);
    assert_eq!(json.status.code(), Some(2));
}

#[test]
fn an_older_file_is_migrated_with_its_comments() {
    let path = scratch("older", &rig());
    assert!(counterpoise(&["check", "--migrate", path.to_str().unwrap()]).status.success());
    assert_eq!(fs::read_to_string(&path).unwrap(), rig().replacen("format = 1", "format = 2", 1));
    let again = counterpoise(&["check", "--migrate", path.to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&again.stdout).contains("already"));
}

#[test]
fn devices_and_parts_that_are_devices_are_refused_at_once() {
    for name in ["/dev/zero", "/dev/null"] {
        assert_eq!(counterpoise(&["check", name]).status.code(), Some(2), "{name}");
    }
    let path = scratch("device", "include = \"../../../../../../../../../../dev/zero\"\n");
    let done = counterpoise(&["check", path.to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&done.stderr).contains("is no regular file"), "{done:?}");
}

#[test]
fn without_a_terminal_new_asks_nothing_and_says_what_to_give() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("check").join("asked");
    let _ = fs::remove_dir_all(&folder);
    let done = counterpoise(&["new", folder.to_str().unwrap()]);
    assert_eq!(done.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&done.stderr).contains("--like sight|gun"), "{done:?}");
    assert!(!folder.exists());
    let unknown = counterpoise(&["new", folder.to_str().unwrap(), "--like", "tank"]);
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("there is no kind of machine \"tank\""));
}
