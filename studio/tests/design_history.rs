//! The history of designs as a user has it: kept with a name, drawn in the plots, restored, renamed, deleted and put back, and its file
//! damaged or changed by somebody else.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::{Path, PathBuf};

use common::{StudioHarness, bench, rest, rig, says, studio, wait_until};
use counterpoise_studio::command::{Command, DesignTab, Page, VerificationTab};
use counterpoise_studio::studio::Studio;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

const GAIN: &str = "synth.feedback.error.gain";

fn set_gain(bench: &mut StudioHarness, value: f64) {
    bench.state_mut().run(&Command::Set { path: GAIN.to_owned(), value, gesture: None });
    rest(bench);
}

fn keep(bench: &mut StudioHarness, name: &str) {
    bench.state_mut().run(&Command::KeepDesign { name: name.to_owned() });
    rest(bench);
}

fn file(folder: &Path) -> PathBuf {
    folder.join("project.designs.toml")
}

fn content(folder: &Path) -> String {
    std::fs::read_to_string(file(folder)).unwrap_or_default()
}

fn names(studio: &Studio) -> Vec<String> {
    studio.view.history.designs.designs().map(|design| design.name.clone()).collect()
}

fn is_readable(studio: &Studio) -> bool {
    studio.view.history.file == counterpoise_studio::design_overlays::HistoryFileState::Readable
}

#[test]
fn a_design_is_kept_by_key_drawn_everywhere_and_gone_back_to() {
    let folder = rig("history");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::D);
    bench.run_steps(3);
    assert!(
        bench.state().view.design_tab == DesignTab::History && bench.state().view.history.typed == "design 1"
    );
    bench.event(egui::Event::Text("soft".to_owned()));
    bench.run_steps(2);
    bench.key_press(Key::Enter);
    rest(&mut bench);
    assert_eq!(names(bench.state()), ["soft"], "what was typed replaced the proposed name");
    assert!(says(&bench, "the weights are those of the project") && says(&bench, "requirements"));
    let kept = content(&folder);
    assert!(kept.contains("name = \"soft\"") && kept.contains("[design.verdicts]"), "{kept}");
    assert!(kept.contains("\"gain_margin_db\" = ") && kept.contains("hub_rms_rad_s\" = "), "{kept}");
    let before = common::text(&bench);
    set_gain(&mut bench, 40.0);
    assert!(says(&bench, "feedback error gain 25 (now 40)"), "the difference to the design as it stands");
    bench.get_by_label("draw soft").click();
    rest(&mut bench);
    for (tab, plot) in
        [(DesignTab::Consequences, "plot: Step of the demand"), (DesignTab::Loop, "plot: Nyquist")]
    {
        bench.state_mut().run(&Command::ShowDesign { tab });
        rest(&mut bench);
        assert!(draws(&mut bench, plot, "soft"), "{plot}");
    }
    for (tab, plot) in [
        (VerificationTab::Histories, "plot: Control"),
        (VerificationTab::Rejection, "plot: Rejection of heave"),
    ] {
        bench.state_mut().run(&Command::ShowVerification { tab });
        rest(&mut bench);
        assert!(draws(&mut bench, plot, "soft"), "{plot}");
    }
    bench.state_mut().run(&Command::ShowDesign { tab: DesignTab::History });
    rest(&mut bench);
    bench.get_by_label("go back to soft").click();
    rest(&mut bench);
    assert_eq!(common::text(&bench), before);
    bench.state_mut().run(&Command::Undo);
    assert!(common::text(&bench).contains("gain = 40"));
    drop(bench);
    let again = common::bench(&folder);
    assert_eq!(
        again.state().view.history.shown.values().collect::<Vec<_>>(),
        ["soft"],
        "it is drawn after a start, too"
    );
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

/// Returns whether a plot has a curve of a name.
fn draws(bench: &mut StudioHarness, plot: &str, name: &str) -> bool {
    bench.hover_at(bench.get_by_label(plot).rect().center());
    bench.run_steps(2);
    let chart = bench.state().view.chart.clone().unwrap();
    plot.ends_with(chart.title.as_str()) && chart.curves.iter().any(|curve| curve.name == name)
}

#[test]
fn designs_are_renamed_deleted_and_put_back_and_the_other_lines_of_the_file_stay() {
    let folder = rig("history-names");
    let mut bench = bench(&folder);
    rest(&mut bench);
    keep(&mut bench, "first");
    set_gain(&mut bench, 31.0);
    keep(&mut bench, "second");
    let two = content(&folder);
    keep(&mut bench, "first");
    assert!(says(&bench, "the name of another design"), "another design is not replaced");
    assert_eq!(content(&folder), two);
    bench.state_mut().run(&Command::ShowDesign { tab: DesignTab::History });
    rest(&mut bench);
    bench.get_by_label("rename first").click();
    bench.run_steps(3);
    bench.event(egui::Event::Text("the old one".to_owned()));
    bench.run_steps(2);
    bench.key_press(Key::Enter);
    rest(&mut bench);
    assert_eq!(content(&folder), two.replace("name = \"first\"", "name = \"the old one\""));
    bench.get_by_label("delete the old one").click();
    rest(&mut bench);
    assert_eq!(names(bench.state()), ["second"]);
    assert!(
        two.ends_with(content(&folder).split_once("[[design]]").unwrap().1),
        "what stays has the same bytes"
    );
    bench.get_by_label("Put \"the old one\" back").click();
    rest(&mut bench);
    assert_eq!(names(bench.state()), ["the old one", "second"]);
    assert_eq!(content(&folder), two.replace("name = \"first\"", "name = \"the old one\""));
    // a copy of the project has the history, too
    let copy = folder.join("copy");
    std::fs::create_dir_all(&copy).unwrap();
    bench.state_mut().run(&Command::SaveAs { path: copy.clone() });
    common::wait_for_files(bench.state_mut());
    rest(&mut bench);
    assert_eq!(content(&copy), content(&folder));
    keep(&mut bench, "third");
    assert_eq!(names(bench.state()), ["the old one", "second", "third"]);
    assert!(content(&copy).contains("third") && !content(&folder).contains("third"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_damaged_history_is_named_with_its_line_and_never_written() {
    let folder = rig("history-damage");
    let mut bench = bench(&folder);
    rest(&mut bench);
    keep(&mut bench, "first");
    let good = content(&folder);
    let damaged = good.replace("name = \"first\"", "<<<<<<< ours\nname = \"first\"");
    std::fs::write(file(&folder), &damaged).unwrap();
    wait_until(&mut bench, "the damage", |s| !is_readable(s));
    bench.state_mut().run(&Command::ShowDesign { tab: DesignTab::History });
    rest(&mut bench);
    let line = 1 + damaged[..damaged.find("<<<").unwrap()].matches('\n').count();
    assert!(
        says(&bench, &format!("project.designs.toml, line {line}: ")) && says(&bench, "Correct this line")
    );
    keep(&mut bench, "second");
    assert_eq!(content(&folder), damaged, "a file that cannot be read is not written");
    std::fs::write(file(&folder), &good).unwrap();
    wait_until(&mut bench, "the good file", is_readable);
    // another program adds a design
    let theirs =
        good.clone() + "\n" + &good[good.find("[[design]]").unwrap()..].replace("\"first\"", "\"theirs\"");
    std::fs::write(file(&folder), &theirs).unwrap();
    wait_until(&mut bench, "the other design", |s| names(s) == ["first", "theirs"]);
    keep(&mut bench, "second");
    assert!(content(&folder).starts_with(theirs.trim_end()), "their design stays");
    assert_eq!(names(bench.state()), ["first", "theirs", "second"]);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_second_window_shows_the_history_and_writes_nothing() {
    let folder = rig("history-windows");
    let mut first = bench(&folder);
    rest(&mut first);
    let mut second = common::open_window(studio(&folder));
    rest(&mut second);
    keep(&mut second, "of the second window");
    assert!(says(&second, "open in another window"));
    assert!(!file(&folder).exists());
    keep(&mut first, "of the first window");
    wait_until(&mut second, "the design of the first window", |s| names(s) == ["of the first window"]);
    second.state_mut().run(&Command::OverlayDesign { name: "of the first window".to_owned() });
    rest(&mut second);
    assert!(second.state().view.history.previews.contains_key("of the first window"));
    drop((first, second));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_design_that_is_kept_before_it_is_verified_gets_its_figures_and_a_drawn_one_follows_the_mechanism() {
    let folder = rig("history-verification");
    let mut bench = bench(&folder);
    wait_until(&mut bench, "a design", |s| s.results.design.is_some() && is_readable(s));
    bench.state_mut().run(&Command::KeepDesign { name: "early".to_owned() });
    assert!(bench.state().view.history.designs.find("early").unwrap().verdicts.is_empty());
    rest(&mut bench);
    assert!(content(&folder).contains("[design.verdicts]"), "the figures follow with the verification");
    set_gain(&mut bench, 30.0);
    bench.state_mut().run(&Command::OverlayDesign { name: "early".to_owned() });
    bench.state_mut().run(&Command::Go { page: Page::Design });
    rest(&mut bench);
    let margin = |s: &Studio| s.view.history.previews["early"].margins.gain_margin_db();
    let before = margin(bench.state());
    set_gain(&mut bench, 35.0);
    assert_eq!(margin(bench.state()), before, "weights of the project do not change it");
    let inertia = Command::Set { path: "plant.motor.resistance".to_owned(), value: 1.0, gesture: None };
    bench.state_mut().run(&inertia);
    rest(&mut bench);
    assert!(bench.state().opened.as_ref().unwrap().session.errors().is_empty());
    assert_ne!(margin(bench.state()), before, "its weights are designed on the mechanism as it stands");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_kept_design_is_the_way_back_from_weights_that_give_no_controller() {
    let folder = rig("history-infeasible");
    let mut first = bench(&folder);
    rest(&mut first);
    keep(&mut first, "good");
    let good = common::text(&first);
    let path = "synth.feedback.control.form".to_owned();
    first.state_mut().run(&Command::SetText { path, value: "lag".to_owned() });
    first.state_mut().run(&Command::Save);
    common::wait_for_files(first.state_mut());
    drop(first);
    let mut again = common::open_window(studio(&folder));
    again.state_mut().run(&Command::ShowDesign { tab: DesignTab::History });
    rest(&mut again);
    assert!(again.state().results.design.is_none());
    again.get_by_label("go back to good").click();
    rest(&mut again);
    assert_eq!(common::text(&again), good);
    assert!(again.state().results.design.is_some());
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn keys_of_a_design_before_the_first_heading_are_kept_and_gone_back_to() {
    let folder = rig("history-keys");
    let path = folder.join("project.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let line = "[reduce]\nmethod = \"none\"              # the lumped plant is small as it is\n";
    assert!(text.contains(line));
    let dotted = format!("reduce.method = \"none\"\n{}", text.replace(line, ""));
    std::fs::write(&path, dotted).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    keep(&mut bench, "dotted");
    let project = |bench: &StudioHarness| bench.state().opened.as_ref().unwrap().session.project().cloned();
    let before = project(&bench).unwrap();
    let kept = &bench.state().view.history.designs.find("dotted").unwrap().weights;
    assert!(kept.starts_with("reduce.method = \"none\"\n"), "{kept}");
    let path = "reduce.method".to_owned();
    bench.state_mut().run(&Command::SetText { path, value: "balanced".to_owned() });
    set_gain(&mut bench, 31.0);
    assert_ne!(project(&bench).unwrap(), before);
    bench.state_mut().run(&Command::RestoreDesign { name: "dotted".to_owned() });
    rest(&mut bench);
    assert!(bench.state().opened.as_ref().unwrap().session.errors().is_empty());
    assert_eq!(project(&bench).unwrap(), before, "every value is back");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
