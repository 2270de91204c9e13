//! Commissioning: rounds in a folder, with the exported C in the loop of a simulated machine; what was stopped goes on.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::support::{folder, report_skip};

/// A sight as drawn, whose step the machine must follow.
const DRAWN: &str = include_str!("../../pipeline/tests/data/drawn_sight.toml");

const PROGRAM: &str = env!("CARGO_BIN_EXE_counterpoise");

fn commission(folder: &Path, machine: &str) -> Output {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(["commission", "drawn.toml", "-q", "--rounds", "2", "-o", "rounds"]);
    command.args(["--angle", "1", "--rate", "1", "--duration", "2", "--machine", machine]).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

#[test]
fn a_commissioning_runs_the_exported_code_and_goes_on_where_it_stopped() {
    if Command::new("cc").arg("--version").output().is_err() {
        return report_skip("no C compiler");
    }
    let folder = folder("commission");
    fs::write(folder.join("drawn.toml"), DRAWN).unwrap();
    let built = DRAWN.replace("{ value = 2.0, tolerance = 0.3 }", "2.3");
    fs::write(folder.join("built.toml"), built).unwrap();
    let machine = format!("{PROGRAM} machine built.toml");
    let first = commission(&folder, &machine);
    assert_eq!(first.status.code(), Some(0), "{}", said(&first));
    assert!(said(&first).contains("every requirement holds on the machine"), "{}", said(&first));
    let round = folder.join("rounds/round-1");
    for name in ["project.toml", "round.json", "controller/machine_step.c", "step/recording.csv"] {
        assert!(round.join(name).is_file(), "{name}");
    }
    assert!(fs::read_to_string(folder.join("rounds/story.html")).unwrap().contains("Round 1"));

    // What was answered is not run again: this machine program would fail.
    fs::remove_file(round.join("round.json")).unwrap();
    let recording = fs::read(round.join("step/recording.csv")).unwrap();
    let again = commission(&folder, "false");
    assert_eq!(again.status.code(), Some(0), "{}", said(&again));
    assert_eq!(fs::read(round.join("step/recording.csv")).unwrap(), recording);

    // Another controller than that of the round is refused.
    fs::remove_file(round.join("round.json")).unwrap();
    let answer = fs::read_to_string(round.join("step/answer.json")).unwrap();
    let hash = fs::read_to_string(round.join("step/request.json")).unwrap();
    let hash = hash.split("\"controller_hash\": \"").nth(1).unwrap().split('"').next().unwrap().to_owned();
    fs::write(round.join("step/answer.json"), answer.replace(&hash, "0")).unwrap();
    let refused = commission(&folder, "false");
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("was asked for"), "{}", said(&refused));

    // So is another project in the same folder.
    fs::write(folder.join("drawn.toml"), DRAWN.replace("2.0, tolerance", "2.1, tolerance")).unwrap();
    let other = commission(&folder, &machine);
    assert_eq!(other.status.code(), Some(2));
    assert!(said(&other).contains("give another folder"), "{}", said(&other));
}
