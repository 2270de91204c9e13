//! `synth --search`: the front is the same on any number of threads, and the file that `--save` writes designs the controller that was chosen.

use std::path::Path;

use serde_json::Value;

use crate::support::{counterpoise, folder};

/// Runs `synth --search` on a project and returns its result.
fn front(project: &Path, threads: &str, options: &[&str]) -> Value {
    let mut command = counterpoise();
    command.env("RAYON_NUM_THREADS", threads).arg("synth").arg(project).args(["--search", "-q", "--json"]);
    let done = command.args(options).output().unwrap();
    assert!(done.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap()
}

fn message(project: &Path, options: &[&str]) -> String {
    let mut command = counterpoise();
    let done = command.arg("synth").arg(project).args(options).output().unwrap();
    assert_eq!(done.status.code(), Some(2), "{options:?}");
    String::from_utf8_lossy(&done.stderr).into_owned()
}

fn pendulum() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/servo-pendulum")
}

const FEW: [&str; 2] = ["--evaluations", "240"];

#[test]
fn a_front_is_the_same_on_one_thread_and_on_four() {
    let one = front(&pendulum(), "1", &FEW);
    assert_eq!(one, front(&pendulum(), "4", &FEW));
    let kinds: Vec<&str> =
        one["kinds"].as_array().unwrap().iter().map(|kind| kind["role"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["own", "bar", "other"]);
    let designs = one["designs"].as_array().unwrap();
    assert!(designs.len() > 10);
    for (k, design) in designs.iter().enumerate() {
        assert_eq!(design["number"], k + 1);
        let linear = &design["linear"];
        let figures = [&linear["residual_rad"], &linear["noise_gain"], &linear["max_sensitivity"]];
        assert_eq!(design["figures"], Value::from(figures.map(Value::clone).to_vec()));
    }
}

#[test]
fn the_saved_file_designs_the_controller_that_was_chosen() {
    let out = folder("front_saved");
    let all = front(&pendulum(), "2", &FEW);
    let designs = all["designs"].as_array().unwrap();
    let numbers = ["H2, weights", "PI with a lag"].map(|kind| {
        designs.iter().find(|design| design["kind"] == kind).unwrap()["number"].as_u64().unwrap()
    });
    for number in numbers {
        let saved = out.join(format!("chosen-{number}.toml"));
        let options = ["--choose", &number.to_string(), "--save", saved.to_str().unwrap()];
        let chosen = front(&pendulum(), "2", &[&FEW[..], &options[..]].concat());
        assert_eq!(chosen["chosen"], number);
        let design = &designs[number as usize - 1]["linear"];
        // The own design of the saved file is the design that was chosen, with nine digits of each value. The residual is that of another
        // disturbance, which is estimated with the weights of the file.
        let again = front(&saved, "2", &["--evaluations", "1"])["references"][0]["linear"].clone();
        for key in ["noise_gain", "max_sensitivity", "max_complementary", "control_peak", "decay_rad_s"] {
            let (here, there) = (again[key].as_f64().unwrap(), design[key].as_f64().unwrap());
            assert!((here / there - 1.0).abs() < 1e-5, "design {number}, {key}: {here} for {there}");
        }
    }
}

#[test]
fn what_a_front_cannot_be_asked_is_refused_with_what_may_stand_there() {
    let of = |options: &[&str]| message(&pendulum(), options);
    assert!(of(&["--search", "--objectives", "residual"]).contains("two objectives or more"));
    assert!(of(&["--search", "--objectives", "residual,noise"]).contains("did you mean"));
    assert!(of(&["--search", "--objectives", "effort,effort"]).contains("stands twice"));
    assert!(of(&["--search", "--limit", "max-sensitivity=0.5"]).contains("above 1"));
    assert!(of(&["--search", "--limit", "speed=3"]).contains("max-complementary"));
    assert!(of(&["--search", "--save", "/nonexistent/x.toml"]).contains("--choose"));
    assert!(of(&["--search", "--evaluations", "0"]).contains("0"));
    assert!(of(&["--choose", "3"]).contains("--search"));
    assert!(of(&["--search", "--evaluations", "60", "--choose", "0"]).contains("the designs 1 to"));
    assert!(
        of(&["--search", "--evaluations", "60", "--limit", "noise-gain=1e-9"]).contains("raise the limits")
    );
}
