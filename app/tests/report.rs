//! The report of the reference rig's design: complete, self-contained, small. It is left in the target folder for a person to look at.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::export::target_proofs::StepCosts;
use counterpoise_pipeline::results::DesignResult;
use counterpoise_pipeline::{DesignContents, World, design_project};
use counterpoise_project::Project;
use counterpoise_report::design::DesignRun;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::{ReportOrigin, html_page, of_design};

/// The folder of the example.
struct Example;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/reference-rig/");

impl World for Example {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(format!("{FOLDER}{name}")).map_err(|error| error.to_string())
    }
}

#[test]
fn the_report_of_the_reference_rig_holds_every_part_and_stays_small() {
    let text = std::fs::read_to_string(format!("{FOLDER}project.toml")).unwrap();
    let project = Project::parse(&text, "project.toml").unwrap().project;
    let designed = design_project(&project, &DesignContents::default(), &HeaderText, &Example).unwrap();
    let run = DesignRun {
        origin: &ReportOrigin::default(),
        times: &[],
        proofs: &[],
        costs: &StepCosts::default(),
        first_design: None,
    };
    let page = html_page(&of_design(&designed, &DesignResult::from(&designed), &run));
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/report.html"), &page).unwrap();
    for part in [
        "Requirements",
        "Loop and margins",
        "Platform in motion",
        "Hub rate under the road, nonlinear plant",
        "Disturbance rejection ratio",
        "Controllers",
        "Weights",
        "Certificates",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.len() < 3_000_000, "{}", page.len());
    assert!(!page.contains("NaN"), "a number that is none reached the page");
}
