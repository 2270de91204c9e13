//! Help: F1 on what is under the pointer or has the focus, the terms of the glossary, and the hint of the first start.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::{StudioHarness, bench, open_window, rest, rig, says, studio};
use egui::Key;
use egui_kittest::kittest::Queryable;

fn topic(bench: &StudioHarness) -> Option<String> {
    bench.state().view.help.shown.as_ref().map(|topic| topic.title.clone())
}

#[test]
fn f1_explains_what_is_under_the_pointer_or_has_the_focus_and_esc_closes() {
    let folder = rig("help");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.key_press(Key::F1);
    bench.run_steps(2);
    assert_eq!(topic(&bench).as_deref(), Some("The page Design"));
    assert!(says(&bench, "Round handles in the plot of the weights"), "what can be dragged");
    bench.key_press(Key::Escape);
    bench.run_steps(2);
    assert_eq!(topic(&bench), None);
    let plot = bench.get_by_label("plot: Sensitivity").rect().center();
    bench.hover_at(plot);
    bench.run_steps(2);
    bench.key_press(Key::F1);
    bench.run_steps(2);
    assert_eq!(topic(&bench).as_deref(), Some("Sensitivity"));
    assert!(says(&bench, "what the loop leaves of a disturbance"), "the term of the glossary");
    bench.key_press(Key::F1);
    bench.run_steps(2);
    assert_eq!(topic(&bench), None, "F1 on the same thing closes it");
    bench.hover_at(egui::pos2(640.0, 794.0));
    bench.get_by_label("error weight: corner and gain").focus();
    bench.run_steps(2);
    bench.key_press(Key::F1);
    bench.run_steps(2);
    assert_eq!(topic(&bench).as_deref(), Some("error weight: corner and gain"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_hint_on_what_can_be_dragged_is_shown_until_it_was_read() {
    const HINT: &str = "Round handles of weights";
    let folder = rig("hint");
    let mut first = bench(&folder);
    rest(&mut first);
    first.state_mut().view.notice = None;
    first.run_steps(2);
    assert!(says(&first, HINT));
    first.get_by_label("Understood").click();
    rest(&mut first);
    assert!(!says(&first, HINT));
    drop(first);
    let mut again = open_window(studio(&folder));
    rest(&mut again);
    again.state_mut().view.notice = None;
    again.run_steps(2);
    assert!(!says(&again, HINT), "it does not come back");
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}
