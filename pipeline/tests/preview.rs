//! Designs of a project that states no weights, as a window asks for them one after the other.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use counterpoise_diagnose::simulator_access::Serial;
use counterpoise_pipeline::preview::{DesignPreview, PreviewCache, PreviewRequest, preview_design};
use counterpoise_pipeline::with_chosen_weights;
use counterpoise_project::Project;
use counterpoise_project::resolve::design::Synthesis;
use counterpoise_verify::{Figure, Limit, Requirement};

/// The starter's machine without weights.
fn without_weights() -> Project {
    let project = Project::parse(counterpoise_project::STARTER, "project.toml").unwrap().project;
    Project { synth: None, ..project }
}

fn chosen(project: &Project) -> Option<Synthesis> {
    with_chosen_weights(project).unwrap().unwrap().project.synth
}

fn shown(project: &Project, moment_kg_m: Option<f64>, cache: &mut PreviewCache) -> DesignPreview {
    let request = PreviewRequest { project: Arc::new(project.clone()), out_of_balance_kg_m: moment_kg_m };
    preview_design(&request, cache, &Serial).unwrap()
}

#[test]
fn kept_weights_are_those_that_the_project_at_hand_asks_for() {
    let mut cache = PreviewCache::default();
    let first = without_weights();
    assert_eq!(shown(&first, None, &mut cache).project.synth, chosen(&first));

    let mut renamed = first.clone();
    renamed.plant.name = "the same machine".to_owned();
    renamed.sweep = None;
    let found = shown(&renamed, None, &mut cache);
    assert_eq!(found.project.synth, chosen(&renamed));
    assert_eq!(found.project.plant.name, "the same machine");

    let mut careful = renamed.clone();
    let figure = Figure::from_key("max_sensitivity").unwrap();
    let limit = Requirement::new(figure, Limit::AtMost(1.3)).unwrap();
    careful.verify.as_mut().unwrap().requirements.push(limit);
    let found = shown(&careful, None, &mut cache);
    assert_eq!(found.project.synth, chosen(&careful));
    assert_ne!(found.project.synth, chosen(&renamed));

    let mut heavy = careful.clone();
    heavy.plant.lumped.as_mut().unwrap().hub_inertia_kg_m2 *= 2.0;
    let found = shown(&heavy, None, &mut cache);
    assert_eq!(found.project.synth, chosen(&heavy));
    assert_ne!(found.project.synth, chosen(&careful));
}

#[test]
fn a_moment_that_is_tried_leaves_the_weights_of_the_project_as_they_are() {
    let project = without_weights();
    let own = chosen(&project);
    for moments in [[None, Some(30.0)], [Some(30.0), None]] {
        let mut cache = PreviewCache::default();
        for moment in moments {
            let found = shown(&project, moment, &mut cache);
            assert_eq!(found.project.synth, own);
            let used = found.modelled.plant.body().out_of_balance_kg_m;
            assert_eq!(used == 30.0, moment.is_some());
        }
    }
}
