//! The studio driven through its commands, with every place drawn (without pixels), and its results beside the command line's road.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::sync::Arc;

use common::{rig, settle, studio, wait_for_files, whole_rig};
use counterpoise_host::files::{NativeDisk, ProjectFolder, read_project};
use counterpoise_pipeline as pipeline;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_studio::command::{Command, DesignSlot, Page};
use counterpoise_studio::main_window;
use counterpoise_studio::studio::Studio;
use egui_kittest::Harness;

fn gain(value: f64, gesture: u64) -> Command {
    Command::Set { path: "synth.feedback.error.gain".to_owned(), value, gesture: Some(gesture) }
}

#[test]
fn every_page_is_drawn_and_driven() {
    let folder = rig("places");
    let mut harness = Harness::builder()
        .with_size([1280.0, 800.0])
        .build_ui_state(|ui, studio: &mut Studio| main_window::show(studio, ui), studio(&folder));
    settle(harness.state_mut());
    for page in Page::ALL {
        harness.state_mut().run(&Command::Go { page });
        harness.run_steps(3);
    }
    for k in 0..10 {
        harness.state_mut().run(&gain(26.0 + f64::from(k), 7));
        harness.state_mut().update();
        harness.run_steps(1);
    }
    harness.state_mut().run(&Command::Keep { slot: DesignSlot::A });
    settle(harness.state_mut());
    assert!(harness.state().results.verified.is_some());
    harness.state_mut().run(&Command::Undo);
    let opened = harness.state().opened.as_ref().unwrap();
    assert!(!opened.session.is_changed(), "a drag is one step of undo");
    drop(harness);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_design_made_in_the_window_exports_the_bytes_of_the_command_line() {
    let folder = whole_rig("bytes");
    let mut window = studio(&folder);
    window.run(&gain(28.5, 1));
    settle(&mut window);
    window.run(&Command::Export);
    settle(&mut window);
    window.run(&Command::Save);
    wait_for_files(&mut window);
    let (text, _) = read_project(&NativeDisk, &folder.join("project.toml")).unwrap();
    let project = counterpoise_project::Project::parse(&text, "project.toml").unwrap().project;
    let made = pipeline::run_stages(&project, &HeaderText, &ProjectFolder(folder.clone())).unwrap();
    for file in &made.files {
        let written = std::fs::read_to_string(folder.join("out").join(&file.name)).unwrap();
        assert_eq!(written, file.text, "{}", file.name);
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn infeasible_weights_say_why_and_the_last_good_design_stays() {
    let folder = rig("infeasible");
    let mut window = studio(&folder);
    settle(&mut window);
    let path = "synth.feedback.control.form".to_owned();
    window.run(&Command::SetText { path, value: "lag".to_owned() });
    settle(&mut window);
    let revision = window.opened.as_ref().unwrap().session.revision();
    assert!(!window.results.design_errors(revision).unwrap().is_empty());
    assert!(window.results.design.is_some());
    drop(window);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn edits_that_were_not_saved_come_back_and_what_cannot_be_opened_says_so() {
    let folder = rig("recovery");
    let mut window = studio(&folder);
    window.run(&gain(33.0, 1));
    drop(window);
    let again = studio(&folder);
    assert!(again.opened.as_ref().unwrap().session.text().contains("gain = 33.0"));
    drop(again);
    let mut lost = Studio::new(&folder.join("state"), Arc::new(|| {}));
    lost.run(&Command::Open { path: folder.join("absent.toml") });
    wait_for_files(&mut lost);
    assert!(lost.open_error.as_ref().unwrap().contains("absent.toml"));
    std::fs::remove_dir_all(folder).unwrap();
}
