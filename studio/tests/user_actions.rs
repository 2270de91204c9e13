//! The window driven as a user drives it: by mouse, keys and names, through every place; and what goes wrong is said in place.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::{Path, PathBuf};

use common::{bench, rest, rig, says, studio, text};
use counterpoise_studio::charts::chart_figure::chart_svg;
use counterpoise_studio::charts::csv::chart_csv;
use counterpoise_studio::command::{Command, DesignSlot, DiagnosisTab, Page, VerificationTab};
use counterpoise_studio::studio::Studio;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

#[test]
fn a_weight_is_dragged_by_its_handle_and_one_undo_takes_it_back() {
    let folder = rig("drag");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let before = text(&bench);
    let at = bench.get_by_label("error weight: corner and gain").rect().center();
    bench.drag_at(at);
    bench.run_steps(1);
    for k in 1..=12 {
        bench.hover_at(at + egui::vec2(2.0 * k as f32, -1.5 * k as f32));
        bench.run_steps(1);
        assert!(k < 5 || bench.state().view.dragging, "the handle is in the hand");
    }
    let end = at + egui::vec2(24.0, -18.0);
    bench.drop_at(end);
    rest(&mut bench);
    let dragged = text(&bench);
    assert_ne!(dragged, before);
    let handle = bench.get_by_label("error weight: corner and gain").rect().center();
    assert!(handle.distance(end) < 3.0, "the handle is where it was let go: {handle} {end}");
    let revision = bench.state().opened.as_ref().unwrap().session.revision();
    assert_eq!(bench.state().results.verified.as_ref().unwrap().revision, revision);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    rest(&mut bench);
    assert_eq!(text(&bench), before);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    rest(&mut bench);
    assert_eq!(text(&bench), dragged);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_handle_is_moved_by_the_keyboard_and_the_palette_runs_what_is_typed() {
    let folder = rig("keys");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let before = text(&bench);
    bench.get_by_label("control weight: corner and gain").focus();
    bench.run_steps(1);
    bench.key_press(Key::ArrowRight);
    rest(&mut bench);
    assert_ne!(text(&bench), before, "an arrow key moves the handle that has the focus");
    bench.key_press_modifiers(Modifiers::COMMAND, Key::K);
    bench.run_steps(2);
    bench.event(egui::Event::Text("go to plant".to_owned()));
    bench.run_steps(2);
    bench.key_press(Key::Enter);
    bench.run_steps(2);
    assert_eq!(bench.state().view.page, Page::Plant);
    assert!(bench.state().view.palette.is_none());
    let mut reached = std::collections::BTreeSet::new();
    for _ in 0..30 {
        bench.key_press(Key::Tab);
        bench.run_steps(1);
        reached.extend(bench.ctx.memory(|memory| memory.focused()).map(|id| id.value()));
    }
    assert!(reached.len() > 20, "Tab goes from widget to widget: {}", reached.len());
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn every_page_and_every_view_of_it_is_drawn_with_names_for_a_screen_reader() {
    let folder = rig("views");
    let mut bench = bench(&folder);
    rest(&mut bench);
    for page in Page::ALL {
        bench.get_by_label(page.name()).click();
        rest(&mut bench);
        assert_eq!(bench.state().view.page, page);
    }
    for command in [Command::ToggleTheme, Command::ToggleFrequency, Command::ToggleGain, Command::ToggleAngle]
    {
        bench.state_mut().run(&command);
        for page in Page::ALL {
            bench.state_mut().run(&Command::Go { page });
            rest(&mut bench);
        }
    }
    for tab in VerificationTab::ALL {
        bench.state_mut().run(&Command::ShowVerification { tab });
        rest(&mut bench);
    }
    for tab in DiagnosisTab::ALL {
        bench.state_mut().run(&Command::ShowDiagnosis { tab });
        rest(&mut bench);
    }
    bench.state_mut().run(&Command::Go { page: Page::Design });
    bench.state_mut().run(&Command::Keep { slot: DesignSlot::B });
    rest(&mut bench);
    for plot in
        ["Weights", "Loop gain", "Sensitivity", "Step of the demand", "Control effort", "Heave", "Pitch"]
    {
        assert!(says(&bench, &format!("plot: {plot}")), "{plot}");
    }
    bench.get_by_label("Loop").click();
    rest(&mut bench);
    for plot in ["Loop phase", "Nichols", "Nyquist", "Root locus", "Hub for the demand"] {
        assert!(says(&bench, &format!("plot: {plot}")), "{plot}");
    }
    let shape = bench.state().results.loop_view.clone().expect("the root locus follows the design");
    assert_eq!(Some(shape.revision), bench.state().results.design.as_ref().map(|design| design.revision));
    bench.get_by_label("Consequences").click();
    rest(&mut bench);
    assert!(says(&bench, "plot: Step of the demand"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn an_order_is_clicked_and_verdicts_lead_to_their_figures() {
    let folder = rig("clicks");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Reduce });
    rest(&mut bench);
    bench.get_by_label("balanced").click();
    rest(&mut bench);
    bench.get_by_label("6").click();
    rest(&mut bench);
    assert!(text(&bench).contains("order = 6"));
    bench.state_mut().run(&Command::Go { page: Page::Verify });
    rest(&mut bench);
    bench.query_all_by_label_contains("phase margin").next().unwrap().click();
    rest(&mut bench);
    assert_eq!(bench.state().view.verification_tab, VerificationTab::Rejection);
    bench.query_all_by_label_contains("RMS hub rate, road").next().unwrap().click();
    rest(&mut bench);
    assert_eq!(bench.state().view.verification_tab, VerificationTab::Histories);
    assert!(says(&bench, "On the road: hub rate"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_was_saved_and_exported_is_there_when_it_is_opened_again_and_a_log_gives_the_same_project() {
    let folder = rig("reopen");
    let set = |path: &str, value: f64| Command::Set { path: path.to_owned(), value, gesture: None };
    let log = [
        set("synth.feedback.error.gain", 27.5),
        set("plant.gearbox.backlash", 0.0015),
        Command::Undo,
        Command::Redo,
        Command::SetWhole { path: "synth.pade_order".to_owned(), value: 3 },
    ];
    let mut first = bench(&folder);
    rest(&mut first);
    log.iter().for_each(|command| first.state_mut().run(command));
    rest(&mut first);
    first.key_press_modifiers(Modifiers::COMMAND, Key::E);
    rest(&mut first);
    assert!(says(&first, "wrote "), "the export is told");
    first.key_press_modifiers(Modifiers::COMMAND, Key::S);
    rest(&mut first);
    let saved = text(&first);
    drop(first);
    assert!(folder.join("out/controller.c").is_file());
    let again = studio(&folder);
    assert_eq!(again.opened.as_ref().unwrap().session.text(), saved);
    assert!(!again.opened.as_ref().unwrap().session.is_changed());
    drop(again);
    let other = rig("replayed");
    let mut second = studio(&other);
    for command in &log {
        let line = serde_json::to_string(command).unwrap();
        second.run(&serde_json::from_str(&line).unwrap());
    }
    assert_eq!(second.opened.as_ref().unwrap().session.text(), saved);
    drop(second);
    [folder, other].iter().for_each(|f| std::fs::remove_dir_all(f).unwrap());
}

#[test]
fn weights_that_no_controller_meets_say_why_in_place_and_the_last_good_design_stays() {
    let folder = rig("refused");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let path = "synth.feedback.control.form".to_owned();
    bench.state_mut().run(&Command::SetText { path, value: "lag".to_owned() });
    rest(&mut bench);
    assert!(says(&bench, "No controller for these weights"));
    assert!(says(&bench, "as many zeros as poles"), "the way out is told");
    assert!(says(&bench, "plot: Loop gain"), "the last good design is still there");
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    rest(&mut bench);
    assert!(!says(&bench, "No controller for these weights"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

/// Returns the example with recordings that the model does not explain, given the weights of the reference rig, and short
/// windows.
fn left_out(name: &str) -> PathBuf {
    let folder = rig(name);
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let machine = std::fs::read_to_string(examples.join("left-out-friction/project.toml")).unwrap();
    let reference = std::fs::read_to_string(folder.join("project.toml")).unwrap();
    let (from, to) = (reference.find("[synth]").unwrap(), reference.find("[export]").unwrap());
    let both = format!("{machine}\n{}\n[recording]\nwindows = [[0.0, 2.0]]\n", &reference[from..to]);
    std::fs::write(folder.join("project.toml"), both).unwrap();
    for file in ["steps.parquet", "triangle.parquet"] {
        std::fs::copy(examples.join("left-out-friction").join(file), folder.join(file)).unwrap();
    }
    folder
}

#[test]
fn recordings_are_diagnosed_the_finding_is_accepted_and_design_and_verdicts_follow() {
    let folder = left_out("diagnose");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let paths = ["steps.parquet", "triangle.parquet"].map(|file| folder.join(file)).to_vec();
    bench.state_mut().run(&Command::Recordings { paths });
    bench.state_mut().run(&Command::Go { page: Page::Diagnose });
    rest(&mut bench);
    assert!(says(&bench, "x its noise floor"), "measured stands beside simulated");
    bench.key_press(Key::F6);
    bench.run_steps(2);
    bench.key_press(Key::Escape);
    rest(&mut bench);
    assert!(bench.state().jobs().diagnosis.is_none(), "a diagnosis that is stopped has no answer");
    let before = text(&bench);
    bench.key_press(Key::F6);
    rest(&mut bench);
    let found = bench.state().jobs().diagnosis.as_ref().unwrap().as_ref().unwrap();
    let names: Vec<&str> = found.answer.findings.iter().map(|f| f.effect.name()).collect();
    assert!(names.contains(&"stribeck"), "{names:?}");
    bench.state_mut().run(&Command::ShowDiagnosis { tab: DiagnosisTab::Map });
    bench.run_steps(2);
    assert!(says(&bench, "The best cell, pivot along"), "where and when");
    assert!(
        says(&bench, "Ringed: where the identified effect belongs"),
        "the cell of what was named is marked"
    );
    bench.state_mut().run(&Command::ShowDiagnosis { tab: DiagnosisTab::Findings });
    bench.run_steps(2);
    bench.get_by_label("Accept into the project").click();
    rest(&mut bench);
    let revision = bench.state().opened.as_ref().unwrap().session.revision();
    assert_ne!(text(&bench), before);
    assert_eq!(bench.state().results.verified.as_ref().unwrap().revision, revision);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    rest(&mut bench);
    assert_eq!(text(&bench), before, "one step takes the diagnosis back");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_recording_that_is_no_numbers_says_so_in_place_and_the_others_stay() {
    let folder = left_out("nan");
    let mut rows = String::from("time [s],demand [rad/s],control [V],hub_rate [rad/s]\n");
    (0..4000).for_each(|k| rows.push_str(&format!("{:.3},0.1,nan,nan\n", f64::from(k) * 1e-3)));
    std::fs::write(folder.join("broken.csv"), rows).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    let paths = vec![folder.join("broken.csv"), folder.join("steps.parquet")];
    bench.state_mut().run(&Command::Recordings { paths });
    bench.state_mut().run(&Command::Go { page: Page::Diagnose });
    rest(&mut bench);
    let seen = &bench.state().jobs().recording_views.as_ref().unwrap().value;
    let told: Vec<&String> = seen[0].errors.iter().chain(&seen[0].remarks).collect();
    eprintln!("{told:?}");
    assert!(!told.is_empty());
    assert!(says(&bench, told[0]), "{told:?}");
    assert!(seen[1].errors.is_empty() && seen[1].channels.iter().any(|t| t.model.is_some()));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_broken_file_says_where_and_is_mended_without_leaving_the_window() {
    let folder = rig("broken");
    let good = std::fs::read_to_string(folder.join("project.toml")).unwrap();
    std::fs::write(folder.join("project.toml"), good.replace("stiffness", "stifness")).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    assert!(says(&bench, "stifness"), "the wrong word is shown");
    std::fs::write(folder.join("project.toml"), &good).unwrap();
    bench.state_mut().run(&Command::Reload);
    rest(&mut bench);
    assert!(bench.state().results.design.is_some());
    drop(bench);
    std::fs::write(folder.join("project.toml"), [0xff, 0xfe, 0x00]).unwrap();
    let mut lost = Studio::new(&folder.join("state"), std::sync::Arc::new(|| {}));
    lost.run(&Command::Open { path: folder.clone() });
    common::wait_for_files(&mut lost);
    assert!(lost.opened.is_none() && lost.open_error.is_some());
    drop(lost);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_disk_that_takes_nothing_is_told_and_nothing_is_lost() {
    let folder = rig("full");
    let original = std::fs::read_to_string(folder.join("project.toml")).unwrap();
    let disk = std::sync::Arc::default();
    let mut bench = common::bench_on(&disk, &folder);
    rest(&mut bench);
    std::fs::write(folder.join("out"), "a file where a folder should be").unwrap();
    bench.state_mut().run(&Command::SetText { path: "plant.name".to_owned(), value: "other".to_owned() });
    rest(&mut bench);
    disk.set_full(true);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::S);
    rest(&mut bench);
    assert!(says(&bench, "not saved"));
    assert_eq!(std::fs::read_to_string(folder.join("project.toml")).unwrap(), original);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::E);
    rest(&mut bench);
    assert!(says(&bench, "not exported"));
    drop(bench);
    let again = studio(&folder);
    assert!(again.opened.as_ref().unwrap().session.text().contains("other"), "the edit is in the journal");
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn another_out_of_balance_is_tried_a_plot_is_copied_and_a_change_outside_is_noticed() {
    let folder = rig("habits");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let before = text(&bench);
    bench.state_mut().run(&Command::Try { out_of_balance_kg_m: Some(250.0) });
    rest(&mut bench);
    assert_eq!(bench.state().results.design.as_ref().unwrap().value.trial_moment_kg_m, Some(250.0));
    assert!(says(&bench, "tried, not in the project"));
    assert_eq!(text(&bench), before, "a trial is not in the project");
    bench.state_mut().run(&Command::Try { out_of_balance_kg_m: None });
    rest(&mut bench);
    let plot = bench.get_by_label("plot: Loop gain").rect().center();
    bench.hover_at(plot);
    bench.run_steps(2);
    bench.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::C);
    rest(&mut bench);
    assert!(says(&bench, "\"Loop gain\" is in the clipboard as numbers"));
    let chart = bench.state().view.chart.clone().unwrap();
    assert!(
        chart_csv(&chart).starts_with("curve,\"frequency, Hz\",\"modulus, dB\"\nL,")
            && chart_svg(&chart).starts_with("<svg")
    );
    std::fs::write(folder.join("project.toml"), before.replace("reference rig", "another rig")).unwrap();
    common::wait_until(&mut bench, "the change", |s| s.opened.as_ref().unwrap().disk_text.is_some());
    bench.run_steps(2);
    assert!(says(&bench, "changed by another program"));
    bench.get_by_label("Take theirs").click();
    rest(&mut bench);
    assert!(text(&bench).contains("another rig"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

fn projects(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            projects(&path, found);
        } else if path.extension().is_some_and(|e| e == "toml") {
            found.push(path);
        }
    }
}

/// Examples whose verification the pages show when it has ended: a rotary axis and a linear one. The pages of the others show it under way, or its
/// end too with `EVERY_EXAMPLE` set, as in `.ci/evidence`: `tests/tests/every_example` verifies them.
const VERIFIED: [&str; 2] = ["direct-gimbal/project.toml", "ball-screw/project.toml"];

/// Waits for the design of an example, or for the reason why it has none, and for the end of everything if its pages are to show that.
fn wait_for_design(bench: &mut common::StudioHarness, path: &Path) {
    if std::env::var_os("EVERY_EXAMPLE").is_some() || VERIFIED.iter().any(|name| path.ends_with(name)) {
        return rest(bench);
    }
    common::wait_until(bench, "a design", |s| {
        s.results.design.is_some() || s.results.design_failure.is_some() || s.is_idle()
    });
}

#[test]
fn every_example_opens_without_an_error_and_every_page_shows_it() {
    let mut found = Vec::new();
    projects(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples"), &mut found);
    assert!(found.len() >= 8);
    assert!(VERIFIED.iter().all(|name| found.iter().any(|path| path.ends_with(name))));
    let state = std::env::temp_dir().join(format!("counterpoise-examples-{}", std::process::id()));
    for path in found {
        let mut studio = Studio::new(&state, std::sync::Arc::new(|| {}));
        studio.run(&Command::Open { path: path.clone() });
        common::wait_for_files(&mut studio);
        let shown = path.display();
        assert_eq!(studio.open_error, None, "{shown}");
        assert!(studio.opened.as_ref().unwrap().session.errors().is_empty(), "{shown}");
        // Blocks that are still to be tuned are refused, with the command that tunes them.
        let synth = studio.opened.as_ref().unwrap().session.project().unwrap().synth.clone();
        let wants = synth.is_some_and(|synth| !synth.options.structure.is_open());
        let mut bench = common::open_window(studio);
        wait_for_design(&mut bench, &path);
        assert_eq!(
            bench.state().results.design.is_some(),
            wants,
            "{shown}: {:?}",
            bench.state().results.design_failure
        );
        for page in Page::ALL {
            bench.state_mut().run(&Command::Go { page });
            bench.run_steps(2);
        }
    }
    let _ = std::fs::remove_dir_all(state);
}

#[test]
fn a_new_project_is_made_from_an_empty_folder_in_the_window() {
    let folder = std::env::temp_dir().join(format!("counterpoise-new-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let mut bench = common::open_window(Studio::new(&folder.join("state"), std::sync::Arc::new(|| {})));
    bench.run_steps(2);
    bench.state_mut().view.browser.as_mut().unwrap().set_path(&folder.join("turret"));
    common::wait_until(&mut bench, "a listing", |s| {
        let browser = s.view.browser.as_ref().unwrap();
        browser.listing.as_ref().is_some_and(|l| l.request.folder == browser.folder())
    });
    bench.run_steps(2);
    bench.get_by_label("New project here").click();
    rest(&mut bench);
    assert_eq!(bench.state().opened.as_ref().unwrap().session.project().unwrap().plant.name, "turret");
    assert!(bench.state().results.verified.is_some());
    bench.key_press_modifiers(Modifiers::COMMAND, Key::W);
    rest(&mut bench);
    assert!(says(&bench, "Recent projects") && says(&bench, "turret"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
