//! Adaptation put to the test where it can fail: the default is nowhere worse than none, and removes what a changed load adds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::PathBuf;

use counterpoise_pipeline::exchange::verified_loop;
use counterpoise_pipeline::results::VerifyResult;
use counterpoise_pipeline::studies::adaptation_trials::{
    AdaptationTrials, TrialLoad, TrialMotion, own_trials,
};
use counterpoise_pipeline::{build_plant_model, project_procedure, reduce_plant, synthesise, verify};
use counterpoise_project::{Attachments, Document, Project, SettingValue};
use counterpoise_tests::adaptation::trial;
use counterpoise_tests::workspace::root;
use counterpoise_tests::{ExampleFolder, decide_choices};

/// The share of the hub rate added by a changed load that an adaptation must remove.
const REMOVED: f64 = 0.8;

fn folder() -> PathBuf {
    root().join("examples/reference-rig")
}

/// The reference rig with a friction observer and a method of adaptation.
fn adapting(method: &str) -> Project {
    let document = Document::from_bytes(&fs::read(folder().join("project.toml")).unwrap(), "p").unwrap();
    let set = |document: Document, key: &str, value: SettingValue| document.set(key, &value).unwrap();
    let document = set(document, "synth.observer.share", SettingValue::Number(0.9));
    let document = set(document, "synth.adaptation.method", SettingValue::Text(method.to_owned()));
    Project::resolve(&document, &Attachments::none()).unwrap().project
}

fn trials(project: &Project) -> (AdaptationTrials, VerifyResult) {
    let modelled = build_plant_model(project).unwrap();
    let made = synthesise(project, &modelled, &reduce_plant(project, &modelled).unwrap()).unwrap();
    let beside = ExampleFolder(folder());
    let procedure = project_procedure(project, &beside).unwrap();
    let tried = own_trials(project, &modelled, &made, &procedure).unwrap().unwrap();
    let verified = verify(project, &modelled, &made, &beside).unwrap();
    let measured_on = verified_loop(&modelled.plant, verified.controller(), &procedure).unwrap();
    let result = VerifyResult::new(verified.verification(), measured_on);
    (tried.clone(), result.with_adaptation(Some(tried)))
}

#[test]
fn the_default_is_nowhere_worse_than_none_and_removes_what_a_changed_load_adds() {
    let (tried, result) = trials(&decide_choices(adapting("recursive"), &ExampleFolder(folder())));
    assert!(tried.bands.unwrap().is_exported);
    assert_eq!(tried.rows.len(), 18);
    assert!(tried.refused.is_empty() && result.studies.adaptation_trials.is_some());
    for row in &tried.rows {
        // without adaptation a load that has returned is known exactly; else no more than noise alone changes
        let allowed = if row.load == TrialLoad::Returned { 1.02 } else { 1.001 };
        assert!(row.with_rad_s <= allowed * row.without_rad_s, "{row:?}");
        let has_changed = matches!(row.load, TrialLoad::Sudden | TrialLoad::Slow | TrialLoad::Lower);
        if has_changed && row.motion != TrialMotion::Sines {
            assert!(row.removed_share().unwrap() >= REMOVED, "{row:?}");
        }
    }
}

#[test]
fn a_method_that_makes_it_worse_is_refused_by_the_verification() {
    let (tried, result) = trials(&adapting("windowed-mean"));
    assert!(tried.refused[0].ratio > 1.03 && !result.passes);
    assert_eq!(tried.refused[0].worst.method, "windowed-mean");
}

#[test]
fn the_default_stands_still_where_friction_decides() {
    // heave as strong as friction without gravity, and a road on which a right estimate is worse than a wrong one
    for (seed, acts) in [(118, false), (110, true)] {
        let case = trial(seed, 0).unwrap();
        assert_eq!(case.bands.is_some(), acts, "{case:?}");
        assert!(case.is_never_worse() && case.removes_enough() && !case.is_refused, "{case:?}");
        let on_road = case.rows.iter().filter(|row| row.motion == TrialMotion::Road);
        for row in on_road {
            assert_eq!(row.with_rad_s.to_bits(), row.without_rad_s.to_bits(), "{row:?}");
        }
    }
}

/// Half a minute for each project: `.ci/evidence` runs it.
#[cfg(feature = "evidence")]
mod every_project {
    use super::*;

    /// Projects whose load may change: the name of an example, and whether its friction is observed.
    const PROJECTS: [(&str, bool); 6] = [
        ("reference-rig/project.toml", true),
        ("reference-rig/project.toml", false),
        ("appendix-5/chapter-6.toml", true),
        ("tip-control/project.toml", true),
        ("azimuth/project.toml", true),
        ("out-of-balance-schedule/project.toml", true),
    ];

    /// An example with the default adaptation.
    fn adapting_by_default((name, observes): (&str, bool)) -> (Project, ExampleFolder) {
        let file = root().join("examples").join(name);
        let mut document = Document::from_bytes(&fs::read(&file).unwrap(), name).unwrap();
        for section in ["synth.adaptation", "synth.schedule", "synth.observer"] {
            document = document.remove(section).unwrap_or(document);
        }
        document =
            document.set("synth.adaptation.method", &SettingValue::Text("recursive".to_owned())).unwrap();
        if observes {
            document = document.set("synth.observer.share", &SettingValue::Number(0.9)).unwrap();
        }
        let beside = ExampleFolder(file.parent().unwrap().to_owned());
        let project = Project::resolve(&document, &Attachments::none()).unwrap().project;
        (decide_choices(project, &beside), beside)
    }

    #[test]
    fn the_default_is_nowhere_worse_than_none_on_every_project_or_is_refused_there() {
        let (mut wrong, mut refused) = (Vec::new(), Vec::new());
        for case in PROJECTS {
            let (project, beside) = adapting_by_default(case);
            let modelled = build_plant_model(&project).unwrap();
            let made = synthesise(&project, &modelled, &reduce_plant(&project, &modelled).unwrap()).unwrap();
            let procedure = project_procedure(&project, &beside).unwrap();
            let mut tried = own_trials(&project, &modelled, &made, &procedure).unwrap().unwrap();
            if !tried.bands.unwrap().is_exported {
                tried.rows.iter_mut().for_each(|row| row.with_rad_s = row.without_rad_s);
            }
            for row in &tried.rows {
                let [without, with, told] =
                    [row.without_rad_s, row.with_rad_s, row.told_rad_s].map(|rate| 1e3 * rate);
                let removed = row.removed_share();
                let named = format!("{case:?} {:?} {:?}", row.motion, row.load);
                println!(
                    "{named}: none {without:.3}, adapted {with:.3}, told {told:.3}, removed {removed:.2?}"
                );
                let changed = matches!(row.load, TrialLoad::Sudden | TrialLoad::Slow)
                    && row.motion != TrialMotion::Sines;
                let worse = row.is_harmful();
                let too_little = changed && removed.is_some_and(|share| share < REMOVED);
                if tried.refused.is_empty() && (worse || too_little) {
                    wrong.push(format!("{named}: {with:.3} of {without:.3}, removed {removed:.2?}"));
                }
            }
            refused.extend(tried.refused.iter().map(|why| (case.0, why.ratio)));
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
        // on an axis without gravity, a synthetic road tells too little of the load
        assert!(refused.iter().all(|(name, _)| *name == "azimuth/project.toml"), "{refused:?}");
    }
}
