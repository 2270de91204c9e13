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

/// A folder that holds nothing, for a program that was installed without its sources.
fn empty_folder(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn in_folder(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_counterpoise");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn every_example_of_the_manual_is_written_as_it_is_in_the_sources() {
    let folder = empty_folder("examples_written");
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut count = 0;
    for entry in fs::read_dir(&sources).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let path = format!("examples/{name}");
        let before = in_folder(&folder, &["check", &path]);
        let told = String::from_utf8_lossy(&before.stderr).into_owned();
        assert!(told.contains(&format!("counterpoise new {path} --example {name}")), "{told}");
        assert!(in_folder(&folder, &["new", &path, "--example", &name]).status.success());
        for file in fs::read_dir(sources.join(&name)).unwrap().map(|file| file.unwrap().path()) {
            if file.is_file() {
                let written = folder.join(&path).join(file.file_name().unwrap());
                assert_eq!(fs::read(written).unwrap(), fs::read(&file).unwrap());
            }
        }
        let again = in_folder(&folder, &["new", &path, "--example", &name]);
        assert!(String::from_utf8_lossy(&again.stderr).contains("not an empty folder"));
        count += 1;
    }
    assert!(count >= 12, "{count}");
}

#[test]
fn claims_are_measured_in_an_empty_folder() {
    let folder = empty_folder("claims_in_an_empty_folder");
    let done = in_folder(&folder, &["claims", "--only", "C1", "--quiet"]);
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.code().is_some_and(|code| code < 2), "{told}");
    assert!(folder.join("out/claims-C1.html").exists() && !folder.join("examples").exists());
}

#[test]
fn the_version_names_the_commit() {
    let told = counterpoise(&["--version"]);
    let text = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(text.contains(env!("CARGO_PKG_VERSION")) && text.contains("commit"), "{text}");
    assert_eq!(String::from_utf8_lossy(&counterpoise(&["-V"]).stdout).lines().count(), 1);
}

#[test]
fn a_command_that_finds_no_project_says_how_to_begin_one() {
    let folder = empty_folder("no_project");
    for (path, named) in
        [("nowhere", "counterpoise new nowhere --like"), ("a/project.toml", "counterpoise new a --like")]
    {
        let missing = in_folder(&folder, &["design", path]);
        let told = String::from_utf8_lossy(&missing.stderr).into_owned();
        assert_eq!(missing.status.code(), Some(2), "{told}");
        assert!(told.starts_with("error: cannot read the project file") && told.contains(named), "{told}");
    }
    fs::write(folder.join("bad.toml"), "[plant]\ngearbox = 1\nnothing = 2\n").unwrap();
    let told = String::from_utf8_lossy(&in_folder(&folder, &["check", "bad.toml"]).stderr).into_owned();
    let places = told.lines().filter(|line| line.contains(": error: "));
    assert!(places.clone().count() > 1 && places.clone().all(|line| line.starts_with("bad.toml:")), "{told}");
}
