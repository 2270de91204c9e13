//! Pages that the command line writes: every figure of the evidence names its quantities and the command that makes it again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support;

const RIG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/reference-rig");

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_counterpoise")).args(arguments).output().unwrap()
}

fn page(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_file(&path);
    path
}

/// Returns what stands after the first screen.
fn evidence(page: &str) -> &str {
    &page[page.find("<section").unwrap()..]
}

#[test]
fn rows_of_the_claims_are_measured_alone_each_with_figures_that_name_their_command() {
    let path = page("claims.html");
    let told = run(&["claims", RIG, "-q", "--only", "c5,C16", "--report", path.to_str().unwrap()]);
    let text = String::from_utf8(told.stdout).unwrap();
    assert!(text.starts_with("C5 ") && text.contains("\nC16 ") && !text.contains("\nC6 "), "{text}");
    let page = fs::read_to_string(path).unwrap();
    assert!(page.contains("1 of 2 claims holds, 1 differs for a reason, 0 fail"));
    let (figures, commands) = (page.matches("<figure>").count(), page.matches("--only C").count());
    assert_eq!(figures, 3, "loop, step and cost");
    assert_eq!(figures, commands);
    let refused = run(&["claims", RIG, "--only", "C99"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("the rows are C1 to C34 and F1 to F4"));
}

#[test]
fn a_verification_with_a_triangle_shows_it_on_every_plant() {
    let folder = support::folder("triangle");
    support::write_short_rig(&folder, 8);
    for plant in ["linear", "lumped", "fe"] {
        let path = page(&format!("triangle-{plant}.html"));
        let told = run(&[
            "verify",
            folder.to_str().unwrap(),
            "-q",
            "--plant",
            plant,
            "--triangle",
            "0.1/4",
            "--report",
            path.to_str().unwrap(),
        ]);
        assert!(told.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&told.stderr));
        let page = fs::read_to_string(path).unwrap();
        assert!(
            page.contains("Triangle of the demanded hub rate") && page.contains("Control against hub rate"),
            "{plant}"
        );
        assert!(page.contains("linear_triangle_error_rms_rad_s"), "{plant}");
        assert_eq!(page.contains("nonlinear_triangle_error_rms_rad_s"), plant != "linear");
        let evidence = evidence(&page);
        let command = format!("--plant {plant} --triangle 0.1/4</code>");
        assert_eq!(evidence.matches("<figure>").count(), evidence.matches(&command).count(), "{plant}");
    }
    let refused = run(&["verify", RIG, "-q", "--triangle", "0.1"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("write RATE/PERIOD"));
}

#[test]
fn two_projects_are_compared_and_the_verdict_that_turned_comes_first() {
    let (before, folder) = (support::folder("calmer"), support::folder("livelier"));
    let text = support::write_short_rig(&before, 8);
    support::write_short_rig(&folder, 8);
    assert!(text.contains("\ngain = 25.0\n"));
    fs::write(folder.join("project.toml"), text.replace("\ngain = 25.0\n", "\ngain = 45.0\n")).unwrap();
    let path = page("difference.html");
    let told = run(&[
        "verify",
        folder.to_str().unwrap(),
        "-q",
        "--against",
        before.to_str().unwrap(),
        "--report",
        path.to_str().unwrap(),
    ]);
    assert_eq!(told.status.code(), Some(1), "the phase margin fails now");
    let text = String::from_utf8(told.stdout).unwrap();
    assert!(text.contains("no longer holds phase margin") && text.contains("1 verdict turned"), "{text}");
    let page = fs::read_to_string(path).unwrap();
    let (before, rest) = (page.find("Before and after").unwrap(), page.find("Loop and margins").unwrap());
    assert!(before < rest && page.contains("no longer holds"));
}

/// The analyser measures the same loop on two inertias and on finite elements: alike at low frequency, and not equal.
#[test]
fn a_frequency_response_is_measured_on_the_plant_that_is_asked_for() {
    let gain = |plant: &str| {
        let common = ["fra", RIG, "-q", "--json", "--amplitudes", "0.1", "--frequencies", "1"];
        let told = run(&[&common[..], &["--plant", plant]].concat());
        let maps: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
        maps["maps"][0]["points"][0]["gain_db"].as_f64().unwrap()
    };
    let (project, lumped, fe) = (gain("project"), gain("lumped"), gain("fe"));
    assert_eq!(project, lumped);
    assert!(lumped != fe && (lumped - fe).abs() < 1.0, "{lumped} {fe}");
}
