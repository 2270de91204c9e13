//! The plots as tiles: dragged by their titles, maximised, hidden, and remembered for the project.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::{StudioHarness, bench, rest, rig, says};
use counterpoise_studio::command::{Command, DesignTab, VerificationTab};
use counterpoise_studio::tile_layout::{LayoutNode, TilePlace};
use egui::{Key, Modifiers, Rect};
use egui_kittest::kittest::Queryable;

fn plot(bench: &StudioHarness, title: &str) -> Rect {
    bench.get_by_label(&format!("plot: {title}")).rect()
}

fn has_plot(bench: &StudioHarness, title: &str) -> bool {
    bench.query_by_label(&format!("plot: {title}")).is_some()
}

/// Drags the title of a plot to a place.
fn drag_title(bench: &mut StudioHarness, title: &str, to: egui::Pos2) {
    let from = bench.get_by_label(title).rect().center();
    bench.drag_at(from);
    bench.run_steps(1);
    for k in 1..=8 {
        bench.hover_at(from + (to - from) * (k as f32 / 8.0));
        bench.run_steps(1);
    }
    bench.drop_at(to);
    bench.run_steps(4);
}

#[test]
fn a_plot_is_dragged_to_another_place_which_is_remembered_for_the_project() {
    let folder = rig("tiles");
    let mut first = bench(&folder);
    rest(&mut first);
    let heave = plot(&first, "Heave");
    assert!(plot(&first, "Sensitivity").bottom() < heave.top());
    let below = egui::pos2(heave.center().x, heave.bottom() - 8.0);
    drag_title(&mut first, "Sensitivity", below);
    rest(&mut first);
    let moved = plot(&first, "Sensitivity");
    assert!(moved.top() > plot(&first, "Heave").bottom(), "it stands below the plot on which it was let go");
    assert!(first.state().view.tiles.layouts().contains_key(&TilePlace::Consequences));
    assert!(has_plot(&first, "Step of the demand"), "the others stay");
    drop(first);
    let mut again = bench(&folder);
    rest(&mut again);
    assert!((plot(&again, "Sensitivity").center() - moved.center()).length() < 2.0);
    assert!(says(&again, "Plots"), "the menu of the plots is there");
    again.state_mut().run(&Command::ResetPlots);
    rest(&mut again);
    assert!(plot(&again, "Sensitivity").bottom() < plot(&again, "Heave").top());
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_plot_is_maximised_by_its_title_its_button_and_by_key() {
    let folder = rig("maximised");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::ShowDesign { tab: DesignTab::Loop });
    rest(&mut bench);
    let small = plot(&bench, "Nyquist");
    bench.get_by_label("maximise Nyquist").click();
    bench.run_steps(3);
    assert!(plot(&bench, "Nyquist").width() > 2.0 * small.width() && !has_plot(&bench, "Nichols"));
    bench.get_by_label("show all plots beside Nyquist").click();
    bench.run_steps(3);
    assert!(has_plot(&bench, "Nichols"));
    let title = bench.get_by_label("Nichols").rect().center();
    for _ in 0..2 {
        let click = |pressed| egui::Event::PointerButton {
            pos: title,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        bench.input_mut().events.extend([egui::Event::PointerMoved(title), click(true), click(false)]);
        bench.run_steps(1);
    }
    bench.run_steps(3);
    assert!(has_plot(&bench, "Nichols") && !has_plot(&bench, "Nyquist"), "a double click on the title");
    bench.key_press_modifiers(Modifiers::COMMAND, Key::M);
    bench.run_steps(3);
    assert!(has_plot(&bench, "Nyquist"), "the key shows all again");
    bench.hover_at(plot(&bench, "Root locus").center());
    bench.run_steps(2);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::M);
    bench.run_steps(3);
    assert!(
        has_plot(&bench, "Root locus") && !has_plot(&bench, "Nyquist"),
        "and maximises the plot under the pointer"
    );
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn plots_are_hidden_and_shown_again_and_put_into_tabs_and_a_window_at_rest_draws_nothing() {
    let folder = rig("hidden");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::ShowVerification { tab: VerificationTab::Histories });
    rest(&mut bench);
    let before = plot(&bench, "Current");
    bench.hover_at(plot(&bench, "Tip rate").center());
    bench.run_steps(2);
    bench.state_mut().run(&Command::HidePlot);
    rest(&mut bench);
    assert!(!has_plot(&bench, "Tip rate") && plot(&bench, "Current").width() > 1.5 * before.width());
    bench.get_by_label("Plots").click();
    bench.run_steps(3);
    bench.get_by_label("Show Tip").click();
    rest(&mut bench);
    assert!(has_plot(&bench, "Tip rate"));
    let middle = plot(&bench, "Control").center();
    drag_title(&mut bench, "Tip rate", middle);
    rest(&mut bench);
    let layout = bench.state().view.tiles.layouts()[&TilePlace::Histories].clone();
    assert!(has_tabs(&layout), "a plot on the middle of another is a tab beside it: {layout:?}");
    bench.hover_at(egui::pos2(3.0, 3.0));
    bench.run_steps(20);
    assert!(!bench.ctx.has_requested_repaint(), "nothing moves, so nothing is drawn");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_plot_in_the_middle_of_all_becomes_a_tab_beside_the_plot_under_it() {
    let folder = rig("tabs");
    let mut bench = bench(&folder);
    rest(&mut bench);
    // the middle of the plot is the middle of the whole page, too, where the library would make all other plots one tab
    let middle = plot(&bench, "Step of the demand").center() - egui::vec2(16.0, 0.0);
    drag_title(&mut bench, "Sensitivity", middle);
    rest(&mut bench);
    assert!(has_plot(&bench, "Sensitivity") && has_plot(&bench, "Weights") && has_plot(&bench, "Heave"));
    let layout = bench.state().view.tiles.layouts()[&TilePlace::Consequences].clone();
    assert!(has_tabs(&layout), "{layout:?}");
    bench.get_by_label("Step of the demand").click();
    rest(&mut bench);
    assert!(has_plot(&bench, "Step of the demand") && !has_plot(&bench, "Sensitivity"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

fn has_tabs(layout: &LayoutNode) -> bool {
    match layout {
        LayoutNode::Plot(_) => false,
        LayoutNode::Row { tiles, .. } | LayoutNode::Column { tiles, .. } => tiles.iter().any(has_tabs),
        LayoutNode::Tabs { tiles, .. } => tiles.len() == 2,
    }
}
