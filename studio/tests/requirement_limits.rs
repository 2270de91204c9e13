//! The strip of requirements, and the limits in the plots: they are read, dragged, moved by keys, and undone.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::{StudioHarness, bench, rest, rig, says, text};
use counterpoise_studio::command::{Command, DesignTab, Page, VerificationTab};
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

const SENSITIVITY: &str = "limit: largest sensitivity Ms at most";

/// Returns the line of the limit of the largest sensitivity.
fn sensitivity_limit(bench: &StudioHarness) -> f64 {
    let text = text(bench);
    let item = text.split("figure = \"max_sensitivity\"").nth(1).unwrap();
    let line = item.lines().find(|line| line.starts_with("at_most")).unwrap();
    line.split('=').nth(1).unwrap().split('#').next().unwrap().trim().parse().unwrap()
}

/// Returns what the chip of a requirement says.
fn chip(bench: &StudioHarness, name: &str) -> String {
    let label = format!("requirement: {name}");
    let node = bench.query_all_by_label_contains(&label).next();
    node.unwrap_or_else(|| panic!("no chip of {name}")).accesskit_node().label().unwrap()
}

#[test]
fn every_requirement_has_a_chip_with_value_limit_and_verdict() {
    let folder = rig("chips");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let requirements =
        bench.state().opened.as_ref().unwrap().session.project().unwrap().verify.as_ref().unwrap();
    let count = requirements.requirements.len();
    assert_eq!(bench.query_all_by_label_contains("requirement: ").count(), count);
    assert!(chip(&bench, "gain margin").contains("\u{2265} 12 dB, holds"));
    assert!(chip(&bench, "largest sensitivity Ms").contains("\u{2264} 1.5"));
    bench.query_all_by_label_contains("requirement: gain margin").next().unwrap().click();
    bench.run_steps(2);
    assert_eq!(bench.state().view.requirement, 0);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_limit_is_dragged_in_its_plot_is_judged_at_once_and_one_undo_takes_it_back() {
    let folder = rig("limit");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let before = text(&bench);
    let limit = sensitivity_limit(&bench);
    let at = bench.get_by_label_contains(SENSITIVITY).rect().center();
    bench.drag_at(at);
    bench.run_steps(1);
    for k in 1..=10 {
        bench.hover_at(at + egui::vec2(0.0, 2.0 * k as f32));
        bench.run_steps(1);
    }
    bench.drop_at(at + egui::vec2(0.0, 20.0));
    bench.run_steps(2);
    let dragged = sensitivity_limit(&bench);
    assert!(dragged < limit && dragged >= 1.0, "the limit went down from {limit} to {dragged}");
    rest(&mut bench);
    let said = chip(&bench, "largest sensitivity Ms");
    assert!(said.contains("FAILS"), "{said}");
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    rest(&mut bench);
    assert_eq!(text(&bench), before);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_limit_is_moved_by_the_arrow_keys_and_stands_in_every_plot_that_it_concerns() {
    let folder = rig("arrows");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let limit = sensitivity_limit(&bench);
    bench.get_by_label_contains(SENSITIVITY).focus();
    bench.run_steps(1);
    bench.key_press(Key::ArrowUp);
    rest(&mut bench);
    assert!(sensitivity_limit(&bench) > limit, "an arrow key moves the limit that has the focus");
    for name in ["gain margin", "step overshoot, linear plant", "step settling time, nonlinear plant"] {
        assert!(says(&bench, &format!("limit: {name}")), "{name}");
    }
    bench.state_mut().run(&Command::ShowDesign { tab: DesignTab::Loop });
    rest(&mut bench);
    assert!(says(&bench, "limit: phase margin"));
    bench.state_mut().run(&Command::ShowVerification { tab: VerificationTab::Rejection });
    rest(&mut bench);
    assert!(says(&bench, SENSITIVITY));
    assert_eq!(bench.state().view.page, Page::Verify);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
