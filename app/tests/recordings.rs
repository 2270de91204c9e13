//! Recordings through the command line: every format, other rates, several clocks, windows, renamed and missing columns.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PROJECT: &str = include_str!("../../examples/left-out-friction/project.toml");
const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/");

fn counterpoise(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_counterpoise")).args(arguments).output().unwrap()
}

/// Returns a fresh folder with a project that has some text more.
fn project(name: &str, more: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("project.toml"), format!("{PROJECT}\n{more}")).unwrap();
    folder
}

/// Returns the replay of a file, as JSON.
fn replay_file(project: &Path, file: &Path) -> serde_json::Value {
    let run = counterpoise(&["replay", project.to_str().unwrap(), file.to_str().unwrap(), "--json"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).unwrap()
}

fn data(file: &str) -> PathBuf {
    Path::new(DATA).join(file)
}

#[test]
fn every_format_gives_the_same_numbers() {
    let project = project("formats", "");
    let channels = |file: &str| replay_file(&project, &data(file))["recordings"][0]["channels"].clone();
    let csv = channels("run.csv");
    assert_eq!(csv.as_object().unwrap().len(), 4, "{csv}");
    for file in ["run.parquet", "run_v5.mat", "run_v73.mat"] {
        assert_eq!(channels(file), csv, "{file}");
    }
}

#[test]
fn windows_are_recordings_of_their_own() {
    let project = project("windows", "[recording]\nwindows = [[0.0, 0.2], [0.15, 0.35]]\n");
    let result = replay_file(&project, &data("run.csv"));
    let files: Vec<&str> =
        result["recordings"].as_array().unwrap().iter().map(|r| r["file"].as_str().unwrap()).collect();
    assert!(files.len() == 2 && files[1].ends_with("run.csv, 0.15 to 0.35 s"), "{files:?}");
    let beyond = self::project("windows-beyond", "[recording]\nwindows = [[0.0, 5.0]]\n");
    let run = counterpoise(&["replay", beyond.to_str().unwrap(), data("run.csv").to_str().unwrap()]);
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(2));
    assert!(
        said.contains("recording.windows: from 0 s to 5 s is not within the recording's 0 to 0.4 s"),
        "{said}"
    );
}

/// Returns the rows of the recording as CSV, every `step`-th, with a clock of its own for the motor's rate.
fn rows(step: usize) -> Vec<Vec<String>> {
    let text = fs::read_to_string(data("run.csv")).unwrap();
    let rows = text.lines().skip(1).step_by(step);
    rows.map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn a_file_at_another_rate_is_put_on_the_projects_clock_and_told() {
    let project = project("rates", "");
    let slow = project.join("slow.csv");
    let mut text = "time [s],demand [rad/s],control [V],hub_rate [rad/s]\n".to_owned();
    for row in rows(2) {
        text.push_str(&format!("{},{},{},{}\n", row[0], row[1], row[2], row[3]));
    }
    fs::write(&slow, text).unwrap();
    let result = replay_file(&project, &slow);
    let told = result["recordings"][0]["remarks"][0].as_str().unwrap().to_owned();
    assert_eq!(told, "sampled every 0.002 s: interpolated to the project's 0.001 s");
    let vaf = result["recordings"][0]["channels"]["hub_rate"]["vaf"].as_f64().unwrap();
    assert!(vaf > 99.9, "{vaf}");
}

#[test]
fn a_channel_with_a_clock_of_its_own_lands_on_the_files_clock() {
    let more = "[recording.channels]\nmotor_rate = { column = \"tacho\", unit = \"rad/s\", scale = -1.0, clock = \"t2\" }\n";
    let project = project("clocks", more);
    let file = project.join("two-clocks.csv");
    let mut text = "time [s],control [V],demand [rad/s],hub_rate [rad/s],t2 [ms],tacho\n".to_owned();
    let slow = rows(3);
    for (k, row) in rows(1).iter().enumerate() {
        let tacho = slow.get(k).map_or(",".to_owned(), |r| {
            let (time, rate): (f64, f64) = (r[0].parse().unwrap(), r[4].parse().unwrap());
            format!("{},{}", 1e3 * time, -rate)
        });
        text.push_str(&format!("{},{},{},{},{tacho}\n", row[0], row[2], row[1], row[3]));
    }
    fs::write(&file, text).unwrap();
    let own = replay_file(&project, &file);
    let whole = replay_file(&self::project("one-clock", ""), &data("run.csv"));
    let error = |result: &serde_json::Value| {
        result["recordings"][0]["channels"]["motor_rate"]["rms_error"].as_f64().unwrap()
    };
    assert!((error(&own) / error(&whole) - 1.0).abs() < 0.2, "{} {}", error(&own), error(&whole));
}

#[test]
fn a_control_at_its_limit_is_told_and_played_back_at_its_limit() {
    let project = project("clipped", "");
    let file = project.join("clipped.csv");
    let mut text = "time [s],demand [rad/s],control [V],hub_rate [rad/s]\n".to_owned();
    for (k, row) in rows(1).iter().enumerate() {
        let control = if (100..160).contains(&k) { "10.0" } else { &row[2] };
        text.push_str(&format!("{},{},{control},{}\n", row[0], row[1], row[3]));
    }
    fs::write(&file, text).unwrap();
    let run = counterpoise(&["replay", project.to_str().unwrap(), file.to_str().unwrap(), "--open-loop"]);
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(run.status.success() && said.contains("control: clipped at 10"), "{said}");
}

#[test]
fn how_a_recording_was_followed_is_told() {
    let project = project("followed", "");
    let run = |windows: &[&str]| {
        let file = data("run.csv");
        let mut arguments = vec!["replay", project.to_str().unwrap(), file.to_str().unwrap(), "--json"];
        arguments.extend(windows);
        counterpoise(&arguments)
    };
    let followed = |windows: &[&str]| -> serde_json::Value {
        let found: serde_json::Value = serde_json::from_slice(&run(windows).stdout).unwrap();
        found["recordings"][0].clone()
    };
    let auto = followed(&[]);
    assert_eq!((&auto["followed"], &auto["window_s"]), (&"free".into(), &serde_json::Value::Null));
    assert!(auto["parting"]["floors"].as_f64().unwrap() > 0.0, "{auto}");
    assert_eq!(followed(&["--windows", "none"])["channels"], auto["channels"]);
    let windows = followed(&["--windows", "0.1"]);
    assert_eq!((&windows["followed"], &windows["window_s"]), (&"windows".into(), &0.1.into()));
    assert!(windows["channels"]["control"]["floor"].is_f64(), "{windows}");
    let refused = run(&["--windows", "half"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("`auto`, `none` or a length"), "{said}");
}

#[test]
fn a_controller_that_was_not_in_the_loop_is_told() {
    let project = project("foreign", "");
    let run = || {
        let run = counterpoise(&["replay", project.to_str().unwrap(), data("run.csv").to_str().unwrap()]);
        String::from_utf8_lossy(&run.stdout).into_owned()
    };
    assert!(!run().contains("another controller"), "{}", run());
    fs::write(project.join("project.toml"), PROJECT.replace("kp = 18.0", "kp = 12.0")).unwrap();
    assert!(run().contains("control: it is not what the project's recording controller makes"), "{}", run());
}

#[test]
fn an_experiment_separates_what_a_diagnosis_leaves() {
    let project = project("experiment", "");
    let (findings, demand) = (project.join("findings.json"), project.join("demand.csv"));
    // Stribeck friction and Coulomb friction at the pivot, as a diagnosis writes them
    let text = r#"{ "findings": [{ "effect": "stribeck", "component": "pivot", "probability": 0.5,
        "parameters": [{ "name": "static_ratio", "value": 1.5 }, { "name": "stribeck_rate", "value": 0.012 }],
        "alternatives": [{ "effect": "coulomb", "component": "pivot" }] }],
        "hypotheses": [{ "effect": "coulomb", "component": "pivot", "log_likelihood_gain": 10.0,
        "values": [{ "name": "coulomb", "value": 140.0 }] }] }"#;
    fs::write(&findings, text).unwrap();
    let planned = |more: &[&str]| {
        let path = |path: &Path| path.to_str().unwrap().to_owned();
        let (project, findings, demand) = (path(&project), path(&findings), path(&demand));
        let mut arguments =
            vec!["experiment", &project, &findings, "--json", "-o", &demand, "--duration", "2"];
        arguments.extend(more);
        counterpoise(&arguments)
    };
    let run = planned(&["--angle", "0.1", "--rate", "0.2"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let plan: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(plan["machines"].as_array().unwrap().len(), 2, "{plan}");
    assert!(plan["separations"][0]["log_likelihood_ratio"].as_f64().unwrap() > 18.0, "{plan}");
    assert!(plan["reached_angle_rad"].as_f64().unwrap() <= 0.11, "{plan}");
    let written = fs::read_to_string(&demand).unwrap();
    assert_eq!((written.lines().count(), written.lines().next()), (2001, Some("time [s],demand")));
    // a current that holds the weight already is too small for any demand
    let refused = planned(&["--angle", "0.1", "--rate", "0.2", "--current", "0.001"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        refused.status.code() == Some(2) && said.contains("no demand in the menu keeps the limits"),
        "{said}"
    );
}

#[test]
fn held_out_recordings_are_replayed_before_and_after() {
    let project = project("held-out", "");
    let file = data("run.csv");
    let run = counterpoise(&[
        "diagnose",
        project.to_str().unwrap(),
        file.to_str().unwrap(),
        "--held-out",
        file.to_str().unwrap(),
        "--json",
    ]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let answer: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let held_out = &answer["held_out_recordings"][0];
    assert!(held_out["file"].as_str().unwrap().ends_with("run.csv"), "{held_out}");
    assert!(held_out["channels"]["hub_rate"]["before"].as_f64().unwrap() > 0.0, "{held_out}");
}

/// A machine whose file leaves every weight to the program.
const OPEN: &str = "format = 2
plant.inertia = 0.02
plant.drive = { limit = 6.0 }
plant.friction.pivot = { model = \"coulomb\", coulomb = 0.03, viscous = 0.01 }
plant.sensors.encoder = { counts = \"20 bit\" }
plant.interface = { sample_period = 1e-3, output_bits = 16 }
";

#[test]
fn the_projects_own_design_replays_as_the_file_that_its_export_writes() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("own-design");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let under = |name: &str, controller: &str| {
        let path = folder.join(name);
        fs::write(&path, format!("{OPEN}recording_controller = {{ {controller} }}\n")).unwrap();
        path
    };
    let own = under("own.toml", "kind = \"project\"");
    let exported = under("exported.toml", "kind = \"exported\", file = \"controller.json\"");
    let row = |k: u32| {
        let t = f64::from(k) * 1e-3;
        let (demand, control) = (0.01 * (6.0 * t).sin(), 0.1 * (6.0 * t).cos());
        format!("{t:.3},{demand},{control},{}\n", 0.009 * (6.0 * t - 0.1).sin())
    };
    let table =
        (0..1500).map(row).fold("time,demand,control,hub_position\n".to_owned(), |all, row| all + &row);
    fs::write(folder.join("run.csv"), table).unwrap();
    let out = folder.join("out");
    let run = counterpoise(&["export", own.to_str().unwrap(), "-o", out.to_str().unwrap()]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    fs::copy(out.join("controller.json"), folder.join("controller.json")).unwrap();
    let result = |project: &Path| replay_file(project, &folder.join("run.csv"))["recordings"][0].clone();
    let found = result(&own);
    assert_eq!(found, result(&exported));
    // what the controller makes of the readings is compared with the recorded control, so the remark tells one controller from another
    let remark = found["remarks"][0].as_str().unwrap();
    assert!(remark.contains("V RMS off"), "{found}");
}

#[test]
fn a_closed_loop_is_measured_where_the_file_leaves_the_weights_open() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("open-weights");
    fs::create_dir_all(&folder).unwrap();
    for synth in ["", "synth.loop = \"position\"\n"] {
        fs::write(folder.join("project.toml"), format!("{OPEN}{synth}")).unwrap();
        let [loop_name, hz, size] = [["--loop", "closed"], ["--frequencies", "1"], ["--amplitudes", "0.05"]];
        let asked = [&["fra", folder.to_str().unwrap(), "--json"][..], &loop_name, &hz, &size].concat();
        let run = counterpoise(&asked);
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let result: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let gain_db = result["maps"][0]["points"][0]["gain_db"].as_f64().unwrap();
        assert!(gain_db.abs() < 3.0, "{synth}: {gain_db} dB");
    }
}
