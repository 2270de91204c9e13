//! A controller that was made elsewhere goes through the whole pipeline like one of the program's own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use counterpoise_lti::response_at;
use counterpoise_pipeline::exchange::SystemResult;
use counterpoise_pipeline::{DesignStages, PipelineError, run_stages};
use counterpoise_project::{Document, Project};
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::errors::describe_pipeline_error;
use counterpoise_tests::ExampleFolder;
use counterpoise_tests::examples::attachments;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig")
}

/// The reference rig's loop of a PI, a notch and a lag, as a person writes it.
const BLOCKS: &str = "[[synth.block]]\nkind = \"pi\"\ngain = 90.0\ncorner = 6.0\n[[synth.block]]\nkind = \"notch\"\nfrequency = 180.0\n\
                      damping = 0.5\ndepth = 0.2\n[[synth.block]]\nkind = \"low-pass\"\nfrequency = 300.0\n";

fn stages(sections: &str, controller: Option<&str>) -> Result<DesignStages, PipelineError> {
    let text = std::fs::read_to_string(folder().join("project.toml")).unwrap();
    let document = Document::parse(&format!("{text}\n{sections}"), "project.toml");
    let beside = attachments(&document, &folder());
    let files = match controller {
        Some(text) => beside.with("legacy.json", text.as_bytes().to_vec()),
        None => beside,
    };
    let project =
        Project::resolve(&document, &files).unwrap_or_else(|findings| panic!("{findings:?}")).project;
    run_stages(&project, &HeaderText, &ExampleFolder(folder()))
}

#[test]
fn a_sampled_controller_runs_as_it_was_given_and_is_judged_like_an_own_one() {
    let own = stages(BLOCKS, None).unwrap();
    let path = &own.verified.controller().parts().paths[0];
    let file = serde_json::to_string(&SystemResult::new("K", &path.system, &[], &[])).unwrap();
    let imported = stages("[synth.controller]\nfile = \"legacy.json\"\n", Some(&file)).unwrap();
    let again = &imported.verified.controller().parts().paths[0];
    for rate in [0.5, 6.0, 40.0, 180.0, 900.0] {
        let (a, b) = (
            response_at(&path.system, rate).unwrap()[(0, 0)],
            response_at(&again.system, rate).unwrap()[(0, 0)],
        );
        assert!((a - b).norm() < 1e-10 * a.norm(), "{rate}: {a} {b}");
    }
    let figures = |stages: &DesignStages| stages.verified.verification().verdicts.clone();
    for ((requirement, a), (_, b)) in figures(&own).iter().zip(&figures(&imported)) {
        assert_eq!(
            std::mem::discriminant(a),
            std::mem::discriminant(b),
            "{}: {a:?} {b:?}",
            requirement.figure.key()
        );
    }
    assert!(imported.files.iter().any(|file| file.text.contains("the controller in legacy.json")));
}

#[test]
fn a_controller_that_does_not_hold_the_loop_is_refused_with_the_pole() {
    let file = r#"{"num": [-400.0], "den": [1.0], "Ts": 0}"#;
    let refused = stages("[synth.controller]\nfile = \"legacy.json\"\n", Some(file));
    let said = describe_pipeline_error(&refused.unwrap_err());
    assert!(said.contains("\"legacy.json\" does not hold the loop") && said.contains("pole"), "{said}");
    let ringing = r#"{"num": [2.0, -2.0], "den": [1.0, 1.0], "Ts": 0.001}"#;
    let refused = stages("[synth.controller]\nfile = \"legacy.json\"\n", Some(ringing));
    assert!(matches!(refused, Err(PipelineError::ControllerPole { .. })), "{:?}", refused.err());
}
