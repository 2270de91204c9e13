//! The page Commission: finished rounds as a time line, the next round, and the model that they left.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use counterpoise_studio::command::{Command, Page};
use counterpoise_studio::commissioning_inputs::CommissioningInputs;
use egui_kittest::kittest::Queryable;

use crate::common::{bench, rest, wait_until};

/// A sight with a dead zone and a biased gyroscope that its project lacks, and its commissioning in two rounds on the machine program in Python.
const DRAWN: &str = include_str!("data/commission/project.toml");
const ROUNDS: [&str; 2] =
    [include_str!("data/commission/round-1.json"), include_str!("data/commission/round-2.json")];
const MODEL: &str = include_str!("data/commission/round-2.toml");

/// Returns a folder with the project and its rounds.
pub fn commissioned_folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("counterpoise-studio-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    let write = |path: &Path, text: &str| {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    write(&folder.join("project.toml"), DRAWN);
    for (k, text) in ROUNDS.iter().enumerate() {
        write(&folder.join(format!("commission/round-{}/round.json", k + 1)), text);
    }
    write(&folder.join("commission/round-1/project.toml"), DRAWN);
    write(&folder.join("commission/round-2/project.toml"), MODEL);
    folder
}

#[test]
fn finished_rounds_are_a_time_line_and_their_model_is_taken_over() {
    let folder = commissioned_folder("rounds");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Commission });
    rest(&mut bench);
    for said in ["Round 1", "Round 2", "Every requirement holds on the machine"] {
        assert!(bench.query_by_label(said).is_some(), "{said}");
    }
    assert!(bench.query_by_label_contains("amplifier dead zone").is_some());
    bench.check_accessibility();

    bench.state_mut().run(&Command::AcceptRound);
    rest(&mut bench);
    let text = bench.state().opened.as_ref().unwrap().session.text().to_owned();
    assert_eq!(text, MODEL);
    assert!(bench.state().opened.as_ref().unwrap().session.errors().is_empty());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_round_that_cannot_run_says_why() {
    let folder = commissioned_folder("refused-rounds");
    std::fs::remove_dir_all(folder.join("commission")).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Commission });
    rest(&mut bench);
    bench.state_mut().run(&Command::RunRound);
    assert!(bench.state().view.notice.as_ref().unwrap().text.contains("name the program"));

    let inputs = CommissioningInputs {
        machine: "false".to_owned(),
        angle_rad: 0.5,
        rate_rad_s: 0.5,
        ..CommissioningInputs::default()
    };
    bench.state_mut().run(&Command::SetCommissioning { inputs });
    bench.state_mut().run(&Command::RunRound);
    wait_until(&mut bench, "a round that fails", |studio| {
        studio.jobs().commissioning.as_ref().is_some_and(Result::is_err)
    });
    rest(&mut bench);
    assert!(bench.query_by_label("The round did not come to its end").is_some());

    let path = folder.join("project.toml");
    let project = bench.state().opened.as_ref().unwrap().session.project().unwrap().plant.name.clone();
    assert_eq!(project, "machine-006");
    bench.state_mut().run(&Command::SetText { path: "plant.name".to_owned(), value: "edited".to_owned() });
    bench.state_mut().run(&Command::RunRound);
    assert!(bench.state().view.notice.as_ref().unwrap().text.contains("save the project first"));
    assert_eq!(std::fs::read_to_string(path).unwrap(), DRAWN);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
