//! Files of data beside the JSON result: every command writes them, histories have their time, and responses carry units.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;

use crate::support;

/// Runs a command on a folder's project with `--data` and returns the tables that it lists: name of the file and columns.
fn write_data(folder: &Path, command: &[&str]) -> Vec<(String, Vec<String>)> {
    let data = folder.join("data");
    let done = support::counterpoise()
        .arg(command[0])
        .arg(folder)
        .args(&command[1..])
        .arg("-q")
        .arg("--data")
        .arg(&data)
        .output()
        .unwrap();
    assert!(done.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&done.stderr));
    let contents = fs::read_to_string(data.join("contents.csv")).unwrap();
    let file = |line: &str| line.split(',').next().unwrap().to_owned();
    let header = |file: &str| fs::read_to_string(data.join(file)).unwrap().lines().next().unwrap().to_owned();
    let columns = |file: &str| {
        header(file).split("\",\"").flat_map(|part| part.split(',')).map(str::to_owned).collect()
    };
    contents.lines().skip(1).map(|line| (file(line), columns(&file(line)))).collect()
}

#[test]
fn the_version_of_the_matlab_file_is_chosen() {
    let folder = support::quick_folder("data_version");
    write_data(&folder, &["model", "--matlab", "7.3"]);
    let file = fs::read(folder.join("data/result.mat")).unwrap();
    assert!(file.starts_with(b"MATLAB 7.3 MAT-file"));
    let refused =
        support::counterpoise().arg("model").arg(&folder).args(["--data", "d", "--matlab", "6"]).output();
    let refused = refused.unwrap();
    assert!(String::from_utf8_lossy(&refused.stderr).contains("must be 5 or 7.3"));
}

#[test]
fn a_model_is_written_as_matlab_and_its_responses_carry_units() {
    let folder = support::quick_folder("data_model");
    let tables = write_data(&folder, &["model"]);
    let responses = tables.iter().find(|(file, _)| file == "responses.csv").expect("responses");
    assert_eq!(responses.1[0], "frequency_hz");
    let header =
        fs::read_to_string(folder.join("data/responses.csv")).unwrap().lines().next().unwrap().to_owned();
    assert!(
        header.contains("hub_rate_rad_s over control_nm, real [(rad/s)/(N m)]")
            || header.contains(" [(rad/s)/("),
        "{header}"
    );
    assert!(!header.contains("()"), "{header}");
    let file = fs::read(folder.join("data/result.mat")).unwrap();
    assert!(file.starts_with(b"MATLAB 5.0 MAT-file"));
    assert!(!folder.join("data/figures").exists());
}

#[test]
fn a_verification_writes_histories_without_json_and_figures_with_its_report() {
    let folder = support::quick_folder("data_verify");
    let report = folder.join("report.html");
    let tables = write_data(&folder, &["verify", "--histories", "--report", report.to_str().unwrap()]);
    let histories: Vec<_> =
        tables.iter().filter(|(file, _)| file.starts_with("histories.") && file != "histories.csv").collect();
    assert!(!histories.is_empty(), "{tables:?}");
    assert!(histories.iter().all(|(_, columns)| columns[0] == "time_s"), "{histories:?}");
    let without_unit =
        fs::read_to_string(folder.join("data/responses.csv")).unwrap().lines().next().unwrap().contains("()");
    assert!(!without_unit);
    assert!(folder.join("data/figures/contents.csv").is_file() && report.is_file());
}

#[test]
fn the_same_result_gives_the_same_files() {
    let [one, other] = ["data_one", "data_other"].map(support::quick_folder);
    for folder in [&one, &other] {
        write_data(folder, &["reduce"]);
    }
    for entry in fs::read_dir(one.join("data")).unwrap() {
        let name = entry.unwrap().file_name();
        let bytes = |folder: &Path| fs::read(folder.join("data").join(&name)).unwrap();
        assert_eq!(bytes(&one), bytes(&other), "{name:?}");
    }
}

#[test]
fn histories_need_a_file_to_go_to() {
    let folder = support::quick_folder("data_none");
    let done = support::counterpoise().arg("verify").arg(&folder).arg("--histories").output().unwrap();
    assert_eq!(done.status.code(), Some(2));
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(told.contains("--json") && told.contains("--data"), "{told}");
}
