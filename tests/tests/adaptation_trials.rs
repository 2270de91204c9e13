//! Adaptation put to the test where it can fail: the default is nowhere worse than none, and removes what a changed load adds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use counterpoise_pipeline::exchange::verified_loop;
use counterpoise_pipeline::results::VerifyResult;
use counterpoise_pipeline::studies::adaptation_trials::{Load, Motion, Trials, own_trials};
use counterpoise_pipeline::{World, model, procedure, reduce, synthesise, verify};
use counterpoise_project::{Attachments, Document, Project, Setting};

/// The share of the hub rate added by a changed load that an adaptation must remove.
const REMOVED: f64 = 0.8;

struct Example;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig")
}

impl World for Example {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        fs::read(folder().join(name)).map_err(|error| error.to_string())
    }
}

/// The reference rig with a friction observer and a method of adaptation.
fn adapting(method: &str) -> Project {
    let document = Document::from_bytes(&fs::read(folder().join("project.toml")).unwrap(), "p").unwrap();
    let set = |document: Document, key: &str, value: Setting| document.set(key, &value).unwrap();
    let document = set(document, "synth.observer.share", Setting::Number(0.9));
    let document = set(document, "synth.adaptation.method", Setting::Text(method.to_owned()));
    Project::resolve(&document, &Attachments::none()).unwrap().project
}

fn trials(project: &Project) -> (Trials, VerifyResult) {
    let modelled = model(project).unwrap();
    let made = synthesise(project, &modelled, &reduce(project, &modelled).unwrap()).unwrap();
    let procedure = procedure(project, &Example).unwrap();
    let tried = own_trials(project, &modelled, &made, &procedure).unwrap().unwrap();
    let verified = verify(project, &modelled, &made, &Example).unwrap();
    let measured_on = verified_loop(&modelled.plant, verified.controller(), &procedure).unwrap();
    let result = VerifyResult::new(verified.verification(), measured_on);
    (tried.clone(), result.with_adaptation(Some(tried)))
}

#[test]
fn the_default_is_nowhere_worse_than_none_and_removes_what_a_changed_load_adds() {
    let (tried, result) = trials(&adapting("recursive"));
    assert_eq!(tried.rows.len(), 12);
    assert!(tried.refused.is_empty() && result.adaptation_trials.is_some());
    for row in &tried.rows {
        assert!(row.with_rad_s <= row.without_rad_s, "{row:?}");
        if matches!(row.load, Load::Sudden | Load::Slow) && row.motion != Motion::Sines {
            assert!(row.removed().unwrap() >= REMOVED, "{row:?}");
        }
    }
}

#[test]
fn a_method_that_makes_it_worse_is_refused_by_the_verification() {
    let (tried, result) = trials(&adapting("windowed-mean"));
    assert!(tried.refused[0].ratio > 1.03 && !result.passes);
    assert_eq!(tried.refused[0].worst.method, "windowed-mean");
}
