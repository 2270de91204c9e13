//! The contents of the window while work runs and after it: names for a screen reader, streamed runs, campaigns, packed units, copies.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;
use counterpoise_report::wording::figures::describe_figure;

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use common::{StudioHarness, bench, rest, rig, says, studio, wait_until, whole_rig};
use counterpoise_studio::charts::chart::Chart;
use counterpoise_studio::command::{BrowsePurpose, Command, DesignSlot, DiagnosisTab, Page, VerificationTab};
use counterpoise_studio::results::VerificationState;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

fn edit_project(folder: &Path, from: &str, to: &str) {
    let path = folder.join("project.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from}");
    std::fs::write(path, text.replacen(from, to, 1)).unwrap();
}

/// Returns the names of what has the focus while Tab goes round once.
fn tab_order(bench: &mut StudioHarness) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut first = None;
    for _ in 0..400 {
        bench.key_press(Key::Tab);
        bench.run_steps(1);
        let root = bench.root();
        let Some(node) = root.children_recursive().find(|n| n.accesskit_node().is_focused()) else {
            continue;
        };
        let node = node.accesskit_node();
        let id = format!("{:?}", node.id());
        if first.as_ref() == Some(&id) {
            break;
        }
        first.get_or_insert(id);
        names.extend(node.label());
    }
    names
}

/// The controls of each page by which Tab has to come.
const WANTED: [(Page, &[&str]); 8] = [
    (Page::Plant, &["File", "gearbox", "mode 1", "hub inertia"]),
    (Page::Reduce, &["balanced", "none"]),
    (
        Page::Design,
        &[
            "error weight: corner and gain",
            "Heave",
            "A",
            "gain",
            "requirement: gain margin",
            "limit: gain margin",
        ],
    ),
    (Page::Verify, &["Verify", "Export code", "Rejection", "holds: gain margin"]),
    (Page::Diagnose, &["Add\u{2026}", "column of the hub rate"]),
    (Page::Text, &["Find", "text of the project"]),
    (Page::Commission, &["program", "folder of the rounds", "rate", "Read again"]),
    (Page::Studies, &["Search designs", "Plan an experiment", "Run"]),
];

#[test]
fn every_control_of_every_page_has_a_name_and_is_reached_by_tab() {
    let folder = rig("names");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Recordings { paths: vec![folder.join("sandy-loam.parquet")] });
    for (page, names) in WANTED {
        bench.state_mut().run(&Command::Go { page });
        rest(&mut bench);
        bench.check_accessibility();
        let reached = tab_order(&mut bench);
        for name in names {
            assert!(reached.iter().any(|n| n.contains(name)), "{page:?}: {name} not among {reached:?}");
        }
    }
    for tab in VerificationTab::ALL {
        bench.state_mut().run(&Command::ShowVerification { tab });
        rest(&mut bench);
        bench.check_accessibility();
    }
    for tab in DiagnosisTab::ALL {
        bench.state_mut().run(&Command::ShowDiagnosis { tab });
        rest(&mut bench);
        bench.check_accessibility();
    }
    for purpose in
        [BrowsePurpose::Project, BrowsePurpose::SaveAs, BrowsePurpose::Recordings, BrowsePurpose::Export]
    {
        bench.state_mut().run(&Command::Browse { purpose });
        bench.run_steps(3);
        bench.check_accessibility();
    }
    bench.key_press(Key::Escape);
    bench.run_steps(2);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::K);
    bench.run_steps(2);
    bench.check_accessibility();
    bench.key_press(Key::Escape);
    bench.run_steps(2);
    assert!(bench.state().view.palette.is_none(), "Esc closes the list of commands");
    bench.state_mut().run(&Command::Close);
    bench.run_steps(3);
    bench.check_accessibility();
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn runs_stream_in_while_they_are_computed_and_can_be_stopped() {
    let folder = whole_rig("stream");
    edit_project(
        &folder,
        "duration = 10.0              # s of heave",
        "duration = 100.0              # s of heave",
    );
    let mut bench = bench(&folder);
    wait_until(&mut bench, "a design", |s| s.results.design.is_some());
    bench.state_mut().run(&Command::Go { page: Page::Verify });
    let running = |s: &counterpoise_studio::studio::Studio| {
        let revision = s.opened.as_ref().unwrap().session.revision();
        s.results.verification(revision).and_then(|(found, standing)| {
            (standing == VerificationState::Running).then_some(found.evidence.histories.len())
        })
    };
    let mut counts = BTreeSet::new();
    wait_until(&mut bench, "the first runs", |s| running(s).is_some_and(|n| n > 0));
    bench.run_steps(1);
    assert!(says(&bench, "running") || running(bench.state()).is_none());
    assert!(says(&bench, "plot: "), "the runs that are there are drawn");
    while let Some(count) = running(bench.state()) {
        counts.insert(count);
        std::thread::sleep(std::time::Duration::from_millis(3));
        bench.run_steps(1);
    }
    rest(&mut bench);
    eprintln!("runs seen so far, one picture after the other: {counts:?}");
    assert!(counts.len() >= 3, "{counts:?}");
    assert!(bench.state().results.verified.is_some());
    bench.key_press(Key::F5);
    wait_until(&mut bench, "another verification", |s| s.results.verifying);
    bench.key_press(Key::Escape);
    rest(&mut bench);
    assert!(!bench.state().results.verifying && says(&bench, "stopped"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_campaign_fills_its_table_and_a_requirement_leads_to_its_spread() {
    let folder = rig("campaign");
    edit_project(&folder, "samples = 200", "samples = 30");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::ShowVerification { tab: VerificationTab::Robustness });
    bench.run_steps(2);
    assert!(says(&bench, "No campaign yet"));
    bench.key_press(Key::F8);
    let some = |s: &counterpoise_studio::studio::Studio| match &s.results.measurements.campaign {
        Some(of) => of.value.as_ref().map_or(0, |robust| robust.done),
        None => 0,
    };
    wait_until(&mut bench, "the first mechanisms", |s| some(s) > 0);
    assert!(some(bench.state()) < 30, "the table fills while the campaign runs");
    bench.check_accessibility();
    rest(&mut bench);
    assert_eq!(some(bench.state()), 30);
    assert!(says(&bench, "30 of 30 mechanisms"));
    for node in bench.root().children_recursive().filter(|n| n.accesskit_node().raw_bounds().is_some()) {
        let right = node.rect().right();
        assert!(right < 1281.0, "{:?} ends at {right}, outside of the window", node.accesskit_node().label());
    }
    bench.get_by_label("phase margin").click();
    rest(&mut bench);
    assert_eq!(bench.state().view.verification_tab, VerificationTab::Robustness);
    assert!(says(&bench, "plot: Share of mechanisms below a value"));
    let of = bench.state().results.measurements.campaign.as_ref().unwrap().value.as_ref().unwrap();
    let row = &of.rows[bench.state().view.requirement];
    assert!(
        describe_figure(row.requirement.figure, row.controlled).contains("phase margin")
            && row.values.len() == 30
    );
    assert!(row.values.is_sorted());
    let path = "synth.feedback.error.gain".to_owned();
    bench.state_mut().run(&Command::Set { path, value: 28.0, gesture: None });
    rest(&mut bench);
    assert!(says(&bench, "of an older design"), "a campaign of another design is told as such");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn code_and_a_packed_unit_are_exported_from_the_window() {
    let folder = rig("unit");
    edit_project(&folder, "languages = [\"c99\"]", "languages = [\"c99\", \"rust\", \"fmi\"]");
    let mut state = studio(&folder);
    state.library = |_, name| Some(format!("library of {name}").into_bytes());
    let mut bench = common::open_window(state);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Verify });
    rest(&mut bench);
    bench.get_by_label("Export code").click();
    rest(&mut bench);
    assert!(says(&bench, "wrote ") && says(&bench, "controller.c"));
    let units: Vec<_> = std::fs::read_dir(folder.join("out"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "fmu"))
        .collect();
    let packed = std::fs::read(&units[0]).unwrap();
    assert!(packed.starts_with(b"PK"));
    let inside = String::from_utf8_lossy(&packed);
    assert!(inside.contains("modelDescription.xml") && inside.contains("library of "));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_plot_is_copied_as_numbers_drawing_and_pixels() {
    let folder = rig("copies");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.hover_at(bench.get_by_label("plot: Sensitivity").rect().center());
    bench.run_steps(2);
    let copied = |bench: &mut StudioHarness, command: Command| -> Vec<egui::OutputCommand> {
        bench.get_by_label("plot: Sensitivity").click_secondary();
        bench.run_steps(3);
        let name = match command {
            Command::CopyCsv => "Copy as CSV",
            Command::CopySvg => "Copy as SVG",
            _ => "Copy as PNG",
        };
        bench.get_by_label(name).click();
        let mut said = Vec::new();
        // a worker draws the picture: on a busy machine that takes a while
        for _ in 0..2000 {
            std::thread::sleep(std::time::Duration::from_millis(5));
            bench.run_steps(1);
            said.extend(bench.output().platform_output.commands.clone());
            if !said.is_empty() {
                break;
            }
        }
        said
    };
    let csv = copied(&mut bench, Command::CopyCsv);
    assert!(
        csv.iter().any(
            |c| matches!(c, egui::OutputCommand::CopyText(t) if t.starts_with("curve,\"frequency, Hz\""))
        ),
        "{csv:?}"
    );
    let svg = copied(&mut bench, Command::CopySvg);
    assert!(svg.iter().any(|c| matches!(c, egui::OutputCommand::CopyText(t) if t.starts_with("<svg"))));
    let png = copied(&mut bench, Command::CopyPng);
    let image = png.iter().find_map(|c| match c {
        egui::OutputCommand::CopyImage(image) => Some(image),
        _ => None,
    });
    let image = image.expect("an image is put into the clipboard");
    let curve = image.pixels.iter().filter(|pixel| pixel.b() > pixel.r().saturating_add(100)).count();
    assert!(image.size[0] == 1280 && image.size[1] > 400 && curve > 1000, "{:?}, {curve}", image.size);
    assert_eq!(image.pixels[0], egui::Color32::WHITE);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn units_are_those_that_were_chosen_in_every_page() {
    let folder = rig("units");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::G);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::H);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::B);
    rest(&mut bench);
    for (page, plot) in
        [(Page::Plant, "Friction at the hub"), (Page::Design, "Heave"), (Page::Verify, "Tip rate")]
    {
        bench.state_mut().run(&Command::Go { page });
        rest(&mut bench);
        bench.hover_at(bench.get_by_label(&format!("plot: {plot}")).rect().center());
        bench.run_steps(2);
        let chart = bench.state().view.chart.clone().unwrap();
        assert_eq!(chart.title, plot);
        assert!(chart.labels.iter().any(|label| label.ends_with("deg/s")), "{:?}", chart.labels);
    }
    bench.state_mut().run(&Command::Go { page: Page::Design });
    rest(&mut bench);
    bench.hover_at(bench.get_by_label("plot: Loop gain").rect().center());
    bench.run_steps(2);
    let labels = bench.state().view.chart.as_ref().unwrap().labels.clone();
    assert_eq!(labels, ["frequency, rad/s", "modulus"]);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_beam_is_edited_where_it_is_drawn_and_one_undo_takes_it_back() {
    let folder = rig("beam");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Plant });
    rest(&mut bench);
    bench.get_by_label("beam").click();
    rest(&mut bench);
    assert!(says(&bench, "section rear tube") && says(&bench, "mass 5"));
    let before = common::text(&bench);
    let diameter = |bench: &StudioHarness| {
        let project = Arc::clone(bench.state().opened.as_ref().unwrap().session.project().unwrap());
        format!("{:?}", project.plant.beam.as_ref().unwrap().sections[0].shape)
    };
    let shape = diameter(&bench);
    let is_field = |n: &egui_kittest::Node<'_>| n.accesskit_node().role() == egui::Role::SpinButton;
    let field = bench.query_all_by_label("outer diameter 1").find(is_field).unwrap();
    field.focus();
    bench.run_steps(1);
    bench.key_press(Key::ArrowUp);
    rest(&mut bench);
    assert_ne!(common::text(&bench), before, "an arrow key turns the number that has the focus");
    assert_ne!(diameter(&bench), shape);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    rest(&mut bench);
    assert_eq!(common::text(&bench), before);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_kept_design_is_gone_back_to_and_one_undo_leaves_it_again() {
    let folder = rig("slots");
    let mut bench = bench(&folder);
    rest(&mut bench);
    let first = common::text(&bench);
    bench.get_by_label("keep this design as A").click();
    rest(&mut bench);
    let set = |path: &str, value: f64| Command::Set { path: path.to_owned(), value, gesture: None };
    bench.state_mut().run(&set("synth.feedback.error.gain", 40.0));
    bench.state_mut().run(&set("synth.feedback.control.gain", 2.0));
    bench.state_mut().run(&set("plant.gearbox.backlash", 0.0015));
    rest(&mut bench);
    let second = common::text(&bench);
    bench.get_by_label("kept design A").click();
    bench.run_steps(3);
    bench.get_by_label("Go back to A").click();
    rest(&mut bench);
    let weights = |text: &str| text[text.find("[synth]").unwrap()..text.find("[verify").unwrap()].to_owned();
    assert_eq!(weights(&common::text(&bench)), weights(&first));
    assert!(common::text(&bench).contains("0.0015"), "the mechanism stays as it is");
    assert!(bench.state().view.kept.contains_key(&DesignSlot::A));
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    rest(&mut bench);
    assert_eq!(common::text(&bench), second);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_limit_of_the_chosen_requirement_is_drawn_where_its_figure_is_read_and_in_the_units_of_the_window() {
    let folder = rig("limits");
    // A requirement on the linear rejection has a place in a plot; the nonlinear one is a single figure of the whole motion.
    let path = folder.join("project.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let linear = text.replace("nonlinear_heave_compensated_drr_db", "heave_compensated_drr_db at 1 Hz");
    assert_ne!(linear, text);
    std::fs::write(&path, linear).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Verify });
    rest(&mut bench);
    assert!(says(&bench, "10 mrad/s") && !says(&bench, "0.01 rad/s"), "limits bear the unit of the window");
    let mut seen = |figure: &str, plot: &str| {
        bench.query_all_by_label_contains(figure).next().unwrap().click();
        rest(&mut bench);
        bench.hover_at(bench.get_by_label(&format!("plot: {plot}")).rect().center());
        bench.run_steps(2);
        bench.state().view.chart.clone().unwrap()
    };
    let selected = |chart: &Chart| {
        chart.bounds.iter().filter(|bound| bound.is_selected).map(|bound| bound.at).collect::<Vec<_>>()
    };
    let rejection = seen("DRR heave at 1 Hz", "Rejection of heave");
    assert_eq!(selected(&rejection).len(), 1);
    assert!((selected(&rejection)[0] + 70.0).abs() < 1e-9);
    let [from, to] = rejection.bounds[0].span.unwrap();
    assert!(from < 1.0 && to > 1.0, "the limit stands about its frequency");
    assert!(selected(&seen("gain margin", "Rejection of heave")).is_empty());
    assert_eq!(selected(&seen("peak current", "Current")), [30.0, -30.0]);
    let overshoot = selected(&seen("step overshoot, nonlinear", "Step of the demand: hub rate"));
    assert!((overshoot[0] - 115.0).abs() < 1e-9);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}
