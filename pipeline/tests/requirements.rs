//! Every figure that can be required, required in a project file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Write as _;

use crate::bare_header::BareHeader;
use counterpoise_pipeline::{World, run_stages};
use counterpoise_project::Project;
use counterpoise_verify::{MissingReason, PerformanceFigure, Verdict};

struct Example;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/reference-rig/");

impl World for Example {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(format!("{FOLDER}{name}")).map_err(|error| error.to_string())
    }
}

/// Returns the example with every figure required twice: at most and at least a number that no figure
/// reaches.
fn with_every_figure(drop_road: &str) -> Project {
    let text = std::fs::read_to_string(format!("{FOLDER}project.toml")).unwrap();
    let (head, rest) = text.split_once("[[verify.requirement]]").unwrap();
    let tail = rest.split_once("[export]").unwrap().1;
    let head = if drop_road.is_empty() { head } else { head.split_once(drop_road).unwrap().0 };
    let mut all = format!(
        "{head}[verify.triangle]\nrate = 0.1\nperiod = 4.0\n\n[verify.line_of_sight]\n\n\
         [verify.line_of_sight.coincidence]\nwindow = 5e-3\ntarget = 5e-3\n\n\
         [verify.line_of_sight.optics]\nfocal_length = 0.1\nspatial_frequency = 3e4\n\n"
    );
    for figure in PerformanceFigure::all() {
        let key = figure.key();
        write!(all, "[[verify.requirement]]\nfigure = \"{key}\"\nat_most = 1e6\n\n").unwrap();
        let beyond = match key.as_str() {
            "phase_margin_deg" => 179.9,
            "disk_margin" => 2.0,
            _ => 1e6,
        };
        write!(all, "[[verify.requirement]]\nfigure = \"{key}\"\nat_least = {beyond}\n\n").unwrap();
    }
    Project::parse(&format!("{all}[export]{tail}"), "project.toml").unwrap().project
}

#[test]
fn a_project_file_can_require_every_figure_and_each_gets_its_verdict() {
    let designed = run_stages(&with_every_figure(""), &BareHeader, &Example).unwrap();
    let verdicts = &designed.verified.verification().verdicts;
    assert_eq!(verdicts.len(), 2 * PerformanceFigure::all().len());
    for pair in verdicts.chunks(2) {
        let key = pair[0].0.figure.key();
        match (&pair[0].1, &pair[1].1) {
            (Verdict::Holds { .. }, Verdict::Fails { by, .. }) => assert!(*by > 0.0, "{key}"),
            // a margin that has no bound
            (Verdict::Fails { value, .. }, Verdict::Holds { .. }) => assert!(value.is_infinite(), "{key}"),
            (Verdict::NotApplicable { why }, Verdict::NotApplicable { .. }) => {
                assert!(key.starts_with("linear") && key.ends_with("gear_open_fraction"), "{key}: {why:?}");
            }
            other => panic!("{key}: {other:?}"),
        }
    }
}

#[test]
fn without_a_road_its_figures_say_that_there_is_none() {
    let designed = run_stages(&with_every_figure("[verify.road]"), &BareHeader, &Example).unwrap();
    let on_road = |key: &str| key.contains("_road_");
    for (requirement, verdict) in &designed.verified.verification().verdicts {
        let key = requirement.figure.key();
        let absent = matches!(verdict, Verdict::NotApplicable { why: MissingReason::NoRoad });
        assert_eq!(absent, on_road(&key), "{key}: {verdict:?}");
    }
}
