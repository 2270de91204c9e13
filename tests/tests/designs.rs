//! Feedback of fixed structure through the whole pipeline, and the table of designs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use counterpoise_pipeline::{
    PipelineError, build_plant_model, reduce_plant, run_stages, synthesise, with_tuned_structure,
};
use counterpoise_project::{Attachments, Document, FurtherPlants, Project};
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_synth::{BlockKind, LoopLimits};
use counterpoise_tests::ExampleFolder;
use counterpoise_tests::examples::attachments;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig")
}

fn document(name: &str) -> (Document, Attachments) {
    let path = folder().join(name);
    let document = Document::from_bytes(&std::fs::read(&path).unwrap(), name).unwrap();
    let attachments = attachments(&document, &folder());
    (document, attachments)
}

fn project(name: &str) -> Project {
    let (document, attachments) = document(name);
    Project::resolve(&document, &attachments).unwrap().project
}

#[test]
fn a_tuned_structure_is_verified_exported_and_saved_like_any_controller() {
    let stated = project("tuned.toml");
    let world = ExampleFolder(folder());
    let (modelled, reduced) = (
        build_plant_model(&stated).unwrap(),
        reduce_plant(&stated, &build_plant_model(&stated).unwrap()).unwrap(),
    );
    assert!(matches!(synthesise(&stated, &modelled, &reduced), Err(PipelineError::NotTuned)));
    let tuned = with_tuned_structure(&stated, &world).unwrap().expect("open parameters");
    assert_eq!(tuned.tuned.missed, 0.0, "{:?}", tuned.tuned.measures);
    assert!(tuned.limits.worst_shortfall(&tuned.tuned.measures[0]) < 1e-3);
    let stages = run_stages(&tuned.project, &HeaderText, &world).unwrap();
    let failing: Vec<String> = stages
        .verified
        .verification()
        .verdicts
        .iter()
        .filter(|(_, verdict)| !matches!(verdict, counterpoise_verify::Verdict::Holds { .. }))
        .map(|(requirement, verdict)| format!("{}: {verdict:?}", requirement.figure.key()))
        .collect();
    assert!(failing.is_empty(), "{failing:?}");
    assert!(stages.files.iter().any(|file| file.text.contains("controller_step")));
    assert!(with_tuned_structure(&tuned.project, &world).unwrap().is_none(), "nothing is open any more");
    // What is written into the file is read back as the same controller.
    let (document, attachments) = document("tuned.toml");
    let saved = tuned.project.update(&document.with_parts(&attachments), &stated).unwrap();
    let again = Project::resolve(&Document::parse(saved.text(), "saved.toml"), &attachments).unwrap().project;
    assert_eq!(again.synth.unwrap().options.structure, tuned.project.synth.unwrap().options.structure);
}

/// Starts of the search for weights; `.ci/evidence` has more, with the feature `evidence`.
const STARTS: usize = if cfg!(feature = "evidence") { 6 } else { 3 };

#[test]
fn tuned_weights_are_verified_and_saved_like_any_weights() {
    let mut stated = project("tuned-weights.toml");
    stated.synth.as_mut().unwrap().options.tuning.as_mut().unwrap().starts = STARTS;
    let world = ExampleFolder(folder());
    let tuned = with_tuned_structure(&stated, &world).unwrap().expect("weights to tune");
    assert_eq!(tuned.tuned.missed, 0.0, "{:?}", tuned.tuned.measures);
    let stages = run_stages(&tuned.project, &HeaderText, &world).unwrap();
    let (holds, fails, open) = stages.verified.verification().counts();
    assert_eq!((fails, open), (0, 0), "{holds} hold: {:?}", stages.verified.verification().verdicts);
    assert!(with_tuned_structure(&tuned.project, &world).unwrap().is_none(), "they are tuned already");
    // In a project of one file the weights are written where they stand.
    let (whole, attachments) = document("project.toml");
    let (asked, _) = document("tuned-weights.toml");
    let section = asked.text().split_once("[synth.tune]").unwrap().1;
    let text = format!("{}\n[synth.tune]{section}", whole.text());
    let whole = Document::parse(&text, "whole.toml").with_parts(&attachments);
    let before = Project::resolve(&whole, &attachments).unwrap().project;
    let mut after = before.clone();
    after.synth.clone_from(&tuned.project.synth);
    let saved = after.update(&whole, &before).unwrap();
    let again = Project::resolve(&Document::parse(saved.text(), "saved.toml"), &attachments).unwrap().project;
    let (again, first) = (again.synth.unwrap(), tuned.project.synth.unwrap());
    assert_eq!(again.specification.feedback, first.specification.feedback);
    assert_eq!(
        again.options.tuning.map(|tuning| tuning.weights),
        first.options.tuning.map(|tuning| tuning.weights)
    );
}

#[test]
fn one_controller_keeps_its_limits_on_the_sweep() {
    let mut project = project("tuned.toml");
    let options = &mut project.synth.as_mut().unwrap().options;
    options
        .structure
        .blocks
        .retain(|block| matches!(block.kind, BlockKind::ProportionalIntegral | BlockKind::LowPass));
    let tuning = options.tuning.as_mut().unwrap();
    tuning.plants = vec![FurtherPlants::Sweep];
    tuning.limits = LoopLimits { max_sensitivity: 1.6, max_complementary: 1.5, ..LoopLimits::default() };
    (tuning.starts, project.sweep.as_mut().unwrap().samples) = (3, 30);
    let tuned = with_tuned_structure(&project, &ExampleFolder(folder())).unwrap().unwrap();
    assert_eq!((tuned.tuned.missed, tuned.plants), (0.0, 31));
}
