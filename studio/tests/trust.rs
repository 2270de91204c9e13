//! The safety of the studio with work: conflicts on disk, locks, unsaved edits, Esc, limits of plots, settings, and rest.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use common::{StudioHarness, bench, crash, rest, rig, says, studio, text, wait_for_files, wait_until};
use counterpoise_studio::command::{BrowsePurpose, Command, DesignSlot, Page, VerificationTab};
use counterpoise_studio::studio::{Studio, WindowClosing};
use counterpoise_studio::view::CloseTarget;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

const CTRL: Modifiers = Modifiers::COMMAND;

fn rename(bench: &mut StudioHarness, name: &str) {
    bench.state_mut().run(&Command::SetText { path: "plant.name".to_owned(), value: name.to_owned() });
    rest(bench);
}

fn file(folder: &Path) -> PathBuf {
    folder.join("project.toml")
}

fn on_disk(folder: &Path) -> String {
    std::fs::read_to_string(file(folder)).unwrap()
}

/// Changes the file as another program does.
fn change_outside(folder: &Path, name: &str) {
    std::fs::write(file(folder), on_disk(folder).replace("reference rig", name)).unwrap();
}

#[test]
fn saving_never_overwrites_what_another_program_wrote_unless_asked_to() {
    let folder = rig("conflict");
    let mut bench = bench(&folder);
    rest(&mut bench);
    rename(&mut bench, "mine");
    change_outside(&folder, "theirs");
    let theirs = on_disk(&folder);
    bench.key_press_modifiers(CTRL, Key::S);
    rest(&mut bench);
    assert_eq!(on_disk(&folder), theirs, "the file is as the other program left it");
    assert!(says(&bench, "not saved") && says(&bench, "changed by another program"));
    bench.get_by_label("Difference").click();
    bench.run_steps(3);
    assert!(says(&bench, "- name = \"theirs\"") && says(&bench, "+ name = \"mine\""));
    bench.key_press_modifiers(CTRL, Key::S);
    rest(&mut bench);
    assert_eq!(on_disk(&folder), theirs, "asking again changes nothing");
    bench.get_by_label("Take theirs").click();
    rest(&mut bench);
    assert_eq!(text(&bench), theirs);
    assert!(!says(&bench, "changed by another program"));
    bench.key_press_modifiers(CTRL, Key::Z);
    rest(&mut bench);
    assert!(text(&bench).contains("\"mine\""), "reading the file again can be undone");
    bench.key_press_modifiers(CTRL, Key::S);
    rest(&mut bench);
    assert!(on_disk(&folder).contains("\"mine\""), "without a further change it is saved");
    change_outside(&folder, "again");
    std::fs::write(file(&folder), on_disk(&folder).replace("mine", "third")).unwrap();
    rename(&mut bench, "last");
    bench.key_press_modifiers(CTRL, Key::S);
    rest(&mut bench);
    bench.get_by_label("Keep mine").click();
    rest(&mut bench);
    assert!(on_disk(&folder).contains("\"last\"") && !says(&bench, "changed by another program"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_second_window_reads_only_until_the_first_is_closed_and_may_save_a_copy() {
    let folder = rig("two-windows");
    let mut first = bench(&folder);
    rest(&mut first);
    rename(&mut first, "first");
    let mut second = bench(&folder);
    rest(&mut second);
    assert!(second.state().opened.as_ref().unwrap().is_read_only());
    assert!(says(&second, "open in another window"));
    assert!(!text(&second).contains("\"first\""), "the edits of another window are not taken");
    let before = text(&second);
    rename(&mut second, "second");
    assert_eq!(text(&second), before);
    second.key_press_modifiers(CTRL, Key::S);
    rest(&mut second);
    assert!(says(&second, "not saved"));
    second.state_mut().run(&Command::SaveAs { path: folder.join("copy") });
    rest(&mut second);
    assert!(!second.state().opened.as_ref().unwrap().is_read_only(), "the copy is its own");
    rename(&mut second, "second");
    assert!(text(&second).contains("\"second\""));
    drop(second);
    crash(first);
    let again = studio(&folder);
    let opened = again.opened.as_ref().unwrap();
    assert!(!opened.is_read_only() && opened.session.text().contains("\"first\""));
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn closing_with_unsaved_edits_asks_and_each_answer_does_what_it_says() {
    let folder = rig("close");
    let original = on_disk(&folder);
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.key_press_modifiers(CTRL, Key::W);
    rest(&mut bench);
    assert!(bench.state().opened.is_none(), "nothing is unsaved, nothing is asked");
    let open = Command::Open { path: folder.clone() };
    bench.state_mut().run(&open);
    rest(&mut bench);
    rename(&mut bench, "kept");
    bench.key_press_modifiers(CTRL, Key::W);
    bench.run_steps(3);
    assert!(says(&bench, "There are unsaved edits") && bench.state().opened.is_some());
    bench.key_press(Key::Escape);
    bench.run_steps(3);
    assert!(bench.state().view.close_question.is_none() && bench.state().opened.is_some());
    bench.key_press_modifiers(CTRL, Key::W);
    bench.run_steps(3);
    bench.get_by_label("Keep for later").click();
    rest(&mut bench);
    assert!(bench.state().opened.is_none() && on_disk(&folder) == original);
    bench.state_mut().run(&open);
    rest(&mut bench);
    assert!(text(&bench).contains("\"kept\""), "the edits come back");
    bench.key_press_modifiers(CTRL, Key::W);
    bench.run_steps(3);
    bench.get_by_label("Discard").click();
    rest(&mut bench);
    bench.state_mut().run(&open);
    rest(&mut bench);
    assert_eq!(text(&bench), original, "discarded edits do not come back");
    rename(&mut bench, "saved");
    bench.state_mut().view.close_question = Some(CloseTarget::Window);
    bench.run_steps(3);
    bench.get_by_label("Save").click();
    rest(&mut bench);
    assert!(on_disk(&folder).contains("\"saved\"") && bench.state().opened.is_none());
    assert_eq!(bench.state().window_closing, WindowClosing::WhenProjectIsClosed);
    drop(bench);
    // the thread that writes the journal may still be ending
    let is_removed = |_| std::fs::remove_dir_all(&folder).is_ok() || !folder.exists();
    assert!((0..100_000).any(is_removed));
}

#[test]
fn escape_reverts_a_number_and_closes_a_menu_before_it_stops_work() {
    let folder = rig("escape");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let before = text(&bench);
    let is_field = |n: &egui_kittest::Node<'_>| n.accesskit_node().role() == egui::Role::SpinButton;
    use egui_kittest::kittest::NodeT;
    bench.query_all_by_label("corner").find(is_field).unwrap().focus();
    bench.run_steps(2);
    bench.event(egui::Event::Text("99".to_owned()));
    bench.run_steps(1);
    bench.state_mut().run(&Command::Verify);
    bench.key_press(Key::Escape);
    bench.run_steps(2);
    assert_eq!(text(&bench), before, "a half-typed number is not taken");
    assert!(!says(&bench, "stopped"), "Esc ended the editing and nothing else");
    rest(&mut bench);
    bench.get_by_label("File").click();
    bench.run_steps(3);
    assert!(says(&bench, "Save the project"));
    bench.state_mut().run(&Command::Verify);
    bench.key_press(Key::Escape);
    bench.run_steps(3);
    assert!(!says(&bench, "Save the project as") && !says(&bench, "stopped"), "Esc closed the menu");
    bench.state_mut().run(&Command::Verify);
    bench.key_press(Key::Escape);
    bench.run_steps(2);
    assert!(says(&bench, "stopped"), "without anything to close, Esc stops the work");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_digit_with_shift_is_a_shortcut_on_any_layout() {
    let folder = rig("digits");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.event(egui::Event::Key {
        key: Key::Exclamationmark,
        physical_key: Some(Key::Num1),
        pressed: true,
        repeat: false,
        modifiers: Modifiers { shift: true, ..Modifiers::COMMAND },
    });
    bench.run_steps(2);
    assert!(bench.state().view.kept.contains_key(&DesignSlot::A));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

fn wheel(bench: &mut StudioHarness, points: f32) {
    bench.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, points),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    bench.run_steps(30);
}

#[test]
fn the_wheel_zooms_a_plot_a_double_click_fits_it_and_another_unit_does_too() {
    let folder = rig("limits-of-plots");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let at = bench.get_by_label("plot: Loop gain").rect().center();
    bench.hover_at(at);
    bench.run_steps(2);
    assert!(bench.query_by_label("Fit").is_none());
    wheel(&mut bench, 200.0);
    assert!(bench.query_by_label("Fit").is_some(), "a plot that was zoomed offers to be fitted");
    bench.get_by_label("Fit").click();
    bench.run_steps(4);
    assert!(bench.query_by_label("Fit").is_none());
    bench.hover_at(at);
    wheel(&mut bench, 200.0);
    bench.run_steps(2);
    bench.key_press_modifiers(CTRL, Key::F);
    bench.run_steps(4);
    assert!(bench.query_by_label("Fit").is_none(), "the command fits the plot under the pointer");
    wheel(&mut bench, -200.0);
    assert!(bench.query_by_label("Fit").is_some());
    bench.state_mut().run(&Command::ToggleGain);
    bench.run_steps(4);
    assert!(bench.query_by_label("Fit").is_none(), "limits in dB say nothing about absolute gains");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_mechanism_moves_with_the_slider_and_with_the_cursor_on_a_plot_over_time() {
    let folder = rig("mechanism");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::ShowVerification { tab: VerificationTab::Histories });
    rest(&mut bench);
    assert!(says(&bench, "plot: Mechanism") && says(&bench, "0.00 s, motion x"));
    bench.state_mut().view.motion.time_s = 0.5;
    bench.run_steps(2);
    assert!(says(&bench, "0.50 s, motion x"));
    let plot = bench.get_by_label("plot: Control").rect();
    bench.hover_at(plot.left_center() + 0.25 * plot.size() * egui::Vec2::X);
    bench.run_steps(3);
    assert!(!says(&bench, "0.50 s, motion x"), "the cursor leads");
    bench.get_by_label("Run").click();
    bench.run_steps(3);
    assert!(bench.state().view.motion.time_s > 0.5, "it runs on");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_second_cursor_measures_differences_until_it_is_taken_away() {
    let folder = rig("second-cursor");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Design });
    bench.run_steps(3);
    let differs = |bench: &StudioHarness| bench.query_all_by_label_contains("(+").next().is_some();
    let plot = bench.get_by_label_contains("plot: Step of the demand").rect();
    let place = |share: f32| plot.left_center() + share * plot.size() * egui::Vec2::X;
    bench.hover_at(place(0.4));
    bench.run_steps(2);
    assert!(!differs(&bench));
    bench.key_press_modifiers(CTRL, Key::J);
    bench.run_steps(2);
    bench.hover_at(place(0.7));
    bench.run_steps(3);
    assert!(differs(&bench), "the distance from the second cursor is shown");
    bench.key_press_modifiers(CTRL, Key::J);
    bench.run_steps(3);
    assert!(!differs(&bench), "the same takes it away");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_project_without_a_controller_is_an_ordinary_one() {
    let folder = rig("model-only");
    let whole = on_disk(&folder);
    let cut = |from: &str, to: &str| whole[whole.find(from).unwrap()..whole.find(to).unwrap()].to_owned();
    let model = whole.replace(&cut("[synth]", "[export]"), "");
    std::fs::write(file(&folder), &model[..model.find("[export]").unwrap()]).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    assert!(bench.state().opened.as_ref().unwrap().session.errors().is_empty(), "{}", on_disk(&folder));
    assert!(bench.state().results.design_failure.is_none());
    for page in Page::ALL {
        bench.state_mut().run(&Command::Go { page });
        rest(&mut bench);
        assert!(!says(&bench, "file has errors") && !says(&bench, "No controller for"), "{page:?}");
        match page {
            Page::Plant => assert!(says(&bench, "plot: Plant: hub rate") && says(&bench, "held by")),
            Page::Reduce => assert!(says(&bench, "plot: Control to hub rate")),
            Page::Design | Page::Verify => assert!(says(&bench, "A model without a controller")),
            Page::Diagnose => assert!(says(&bench, "No recordings yet")),
            Page::Commission => assert!(says(&bench, "No round yet")),
            Page::Text => assert!(says(&bench, "No errors")),
            Page::Studies => assert!(says(&bench, "Not made yet")),
        }
    }
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn theme_units_page_and_kept_designs_are_remembered() {
    let folder = rig("remembered");
    let mut first = bench(&folder);
    rest(&mut first);
    first.state_mut().run(&Command::Keep { slot: DesignSlot::B });
    first.state_mut().run(&Command::ToggleTheme);
    first.state_mut().run(&Command::ToggleGain);
    first.state_mut().run(&Command::Go { page: Page::Reduce });
    rest(&mut first);
    let theme = first.state().view.theme;
    drop(first);
    let mut again = bench(&folder);
    rest(&mut again);
    let view = &again.state().view;
    assert!(view.theme == theme && view.page == Page::Reduce);
    assert_eq!(view.units.gain, counterpoise_studio::units::GainUnit::Absolute);
    assert!(view.kept.contains_key(&DesignSlot::B), "the kept design is computed again");
    let kept = &view.kept[&DesignSlot::B];
    let now = &again.state().results.design.as_ref().unwrap().value;
    assert_eq!(kept.margins.gain_margin_db(), now.margins.gain_margin_db());
    drop(again);
    let other = rig("remembered-other");
    let mut elsewhere = Studio::new(&folder.join("state"), Arc::new(|| {}));
    elsewhere.run(&Command::Open { path: other.clone() });
    wait_for_files(&mut elsewhere);
    assert!(elsewhere.view.theme == theme && elsewhere.view.page == Page::Design);
    assert!(elsewhere.view.kept.is_empty(), "kept designs belong to their project");
    drop(elsewhere);
    [folder, other].iter().for_each(|f| std::fs::remove_dir_all(f).unwrap());
}

#[test]
fn a_window_at_rest_asks_for_no_frame() {
    let folder = rig("rest");
    let mut bench = bench(&folder);
    rest(&mut bench);
    for page in Page::ALL {
        bench.state_mut().run(&Command::Go { page });
        rest(&mut bench);
        bench.run_steps(20);
        assert_eq!(bench.state().next_wake_after(), None, "{page:?}");
        assert!(!bench.ctx.has_requested_repaint(), "{page:?}: {:?}", bench.ctx.repaint_causes());
    }
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_plot_and_the_report_are_written_to_files() {
    let folder = rig("files");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.hover_at(bench.get_by_label("plot: Sensitivity").rect().center());
    bench.run_steps(2);
    bench.state_mut().run(&Command::Browse { purpose: BrowsePurpose::PlotFile });
    wait_until(&mut bench, "a listing", |s| s.view.browser.as_ref().is_some_and(|b| b.is_listed()));
    bench.run_steps(2);
    bench.key_press(Key::Enter);
    wait_until(&mut bench, "the drawing", |_| folder.join("sensitivity.svg").is_file());
    for (name, start) in [("plot.png", &b"\x89PNG"[..]), ("plot.csv", b"curve,")] {
        bench.state_mut().run(&Command::SavePlot { path: folder.join(name) });
        wait_until(&mut bench, name, |_| folder.join(name).is_file());
        rest(&mut bench);
        assert!(std::fs::read(folder.join(name)).unwrap().starts_with(start), "{name}");
    }
    let report = folder.join("report.html");
    bench.state_mut().run(&Command::WriteReport { path: report.clone() });
    rest(&mut bench);
    assert!(says(&bench, "the report is in"));
    let page = std::fs::read_to_string(report).unwrap();
    assert!(page.contains("reference rig") && page.contains("<svg"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_measurement_and_a_campaign_say_where_they_are() {
    let folder = rig("progress");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.key_press(Key::F8);
    bench.run_steps(2);
    let measuring = |s: &Studio| s.jobs().measure.is_busy();
    wait_until(&mut bench, "the campaign", measuring);
    assert!(says(&bench, "measuring"), "the window says that it measures");
    bench.key_press(Key::Escape);
    rest(&mut bench);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
