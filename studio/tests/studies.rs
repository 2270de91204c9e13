//! The studies of the page Studies: each shows the report that the command line writes, and what it proposes is what the command line saves.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use counterpoise_report::html_page;
use counterpoise_studio::command::{Command, Page};
use counterpoise_studio::jobs::studies::StudyResult;
use counterpoise_studio::studio::Studio;
use counterpoise_studio::study_inputs::{StudyInputs, StudyKind};
use egui_kittest::kittest::Queryable;

use crate::common::{open_window, settle, studio, wait_for_files};
use crate::same_recordings::run_command_line;

/// Returns a copy of an example in a folder of its own.
fn copy_example(example: &str, test: &str) -> PathBuf {
    let name = format!("counterpoise-studies-{test}-{}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(example);
    for item in std::fs::read_dir(from).unwrap() {
        let path = item.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
    }
    folder
}

/// Makes a study, and waits for it.
fn make(studio: &mut Studio, study: StudyKind) {
    settle(studio);
    studio.run(&Command::RunStudy { study });
    settle(studio);
}

/// Returns what a study found.
fn found(studio: &Studio, study: StudyKind) -> &StudyResult {
    let found = studio.jobs().studies.get(&study).expect("the study was made");
    found.value.as_ref().unwrap_or_else(|why| panic!("{study:?}: {why:?}"))
}

/// Returns the file that a command of the command line writes with an option that names a file.
fn written(words: &[&str], paths: &[&Path], option: &str) -> String {
    let scratch = counterpoise_host::files::scratch_folder().unwrap();
    let output = scratch.path().join("output");
    let demand = scratch.path().join("demand.csv");
    let mut arguments: Vec<&OsStr> = words.iter().map(OsStr::new).collect();
    arguments.extend(paths.iter().map(|path| path.as_os_str()));
    arguments.extend([OsStr::new(option), output.as_os_str()]);
    if words.contains(&"experiment") {
        arguments.extend([OsStr::new("-o"), demand.as_os_str()]);
    }
    run_command_line(&arguments);
    std::fs::read_to_string(output).unwrap()
}

/// Asserts that a study shows the report of a command.
fn check_report(studio: &Studio, study: StudyKind, words: &[&str], paths: &[&Path]) {
    let shown = html_page(&found(studio, study).report);
    assert!(shown == written(words, paths, "--report"), "{study:?} differs from {words:?}");
}

#[test]
fn a_search_shows_the_front_and_a_design_of_it_is_taken_as_the_command_line_saves_it() {
    let folder = copy_example("servo-pendulum", "search");
    let file = folder.join("project.toml");
    let mut studio = studio(&folder);
    make(&mut studio, StudyKind::Search);
    assert_eq!(studio.view.page, Page::Studies);
    check_report(&studio, StudyKind::Search, &["synth", "--search"], &[&file]);
    let result = found(&studio, StudyKind::Search).clone();
    assert!(
        result.proposals.len() > 10
            && result.places.iter().all(|figure| figure.len() == result.proposals.len())
    );
    let before = studio.opened.as_ref().unwrap().session.text().to_owned();
    let number = result.proposals.len() - 1;
    studio.run(&Command::TakeProposal { number });
    let taken = studio.opened.as_ref().unwrap().session.text().to_owned();
    let chosen = number.to_string();
    assert_eq!(taken, written(&["synth", "--search", "--choose", &chosen], &[&file], "--save"));
    settle(&mut studio);
    assert!(studio.results.design_failure.is_none(), "{:?}", studio.results.design_failure);
    studio.run(&Command::TakeProposal { number: 1 });
    assert_eq!(
        studio.opened.as_ref().unwrap().session.text(),
        taken,
        "a study of another state proposes nothing"
    );
    studio.run(&Command::Undo);
    assert_eq!(studio.opened.as_ref().unwrap().session.text(), before);
    drop(studio);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn recordings_are_identified_and_an_experiment_is_planned_as_on_the_command_line() {
    let folder = copy_example("left-out-friction", "recordings");
    let file = folder.join("project.toml");
    let recordings = ["triangle.parquet", "steps.parquet"].map(|name| folder.join(name));
    let mut studio = studio(&folder);
    make(&mut studio, StudyKind::Identify);
    let answer = &studio.jobs().studies[&StudyKind::Identify].value;
    assert!(answer.as_ref().unwrap_err()[0].contains("Ctrl+R"), "without recordings it says how to add them");
    studio.run(&Command::Recordings { paths: recordings.to_vec() });
    make(&mut studio, StudyKind::Identify);
    let paths: Vec<&Path> = std::iter::once(&file).chain(&recordings).map(PathBuf::as_path).collect();
    check_report(&studio, StudyKind::Identify, &["identify"], &paths);
    let inputs = StudyInputs { angle_rad: 0.12, rate_rad_s: 0.25, duration_s: 4.0, ..StudyInputs::default() };
    studio.run(&Command::SetStudyInputs { inputs });
    make(&mut studio, StudyKind::Experiment);
    let words = ["experiment", "--angle", "0.12", "--rate", "0.25", "--duration", "4"];
    check_report(&studio, StudyKind::Experiment, &words, &[&file]);
    let demand = found(&studio, StudyKind::Experiment).written.clone().unwrap();
    assert_eq!(demand, folder.join("demand.csv"));
    assert!(std::fs::read_to_string(demand).unwrap().lines().count() > 4000);
    let identified = &found(&studio, StudyKind::Identify).proposals[0];
    assert_eq!(identified.text, written(&["identify"], &paths, "--save"));
    drop(studio);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn another_project_is_compared_and_a_name_without_a_file_is_told() {
    let folder = copy_example("servo-pendulum", "against");
    let other = folder.join("slower.toml");
    let text = std::fs::read_to_string(folder.join("project.toml")).unwrap();
    std::fs::write(&other, text.replacen("[plant]", "[synth]\nbandwidth = 10.0\n\n[plant]", 1)).unwrap();
    let mut studio = studio(&folder);
    for (against, expected) in [("", "name the other project"), ("nothing.toml", "nothing.toml")] {
        studio.run(&Command::SetStudyInputs {
            inputs: StudyInputs { against: against.to_owned(), ..StudyInputs::default() },
        });
        make(&mut studio, StudyKind::Against);
        let answer = &studio.jobs().studies[&StudyKind::Against].value;
        assert!(answer.as_ref().unwrap_err().join(" ").contains(expected), "{answer:?}");
    }
    let inputs = StudyInputs { against: "slower.toml".to_owned(), ..StudyInputs::default() };
    studio.run(&Command::SetStudyInputs { inputs });
    make(&mut studio, StudyKind::Against);
    let report = &found(&studio, StudyKind::Against).report;
    assert!(report.sections[0].tables[0].rows.len() > 20, "{}", report.headline.text);
    drop(studio);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn every_study_can_be_stopped_and_shows_its_place() {
    let folder = copy_example("servo-pendulum", "stopped");
    let mut bench = open_window(studio(&folder));
    wait_for_files(bench.state_mut());
    settle(bench.state_mut());
    for study in StudyKind::ALL {
        bench.state_mut().run(&Command::RunStudy { study });
        bench.run_steps(2);
        assert!(bench.query_all_by_label_contains(study.name()).next().is_some(), "{study:?}");
        bench.state_mut().run(&Command::Cancel);
        settle(bench.state_mut());
        bench.run_steps(2);
    }
    bench.state_mut().run(&Command::RunStudy { study: StudyKind::Search });
    settle(bench.state_mut());
    bench.run_steps(4);
    assert!(bench.query_all_by_label_contains("take H2, weights").next().is_some());
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
