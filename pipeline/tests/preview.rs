//! Designs of a project that states no weights, as a window asks for them one after the other.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::sync::Arc;

use counterpoise_pipeline::preview::{DesignPreview, PreviewCache, PreviewRequest, preview_design};
use counterpoise_pipeline::with_chosen_weights;
use counterpoise_pool::Serial;
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_project::{Attachments, Document, Project, Purpose};

/// Returns the starter's machine without weights, at a bandwidth that is found sooner than the highest one.
fn without_weights() -> Project {
    let project = Project::parse(counterpoise_project::STARTER, "project.toml").unwrap().project;
    Project {
        synth: Some(DesignRequest { bandwidth_rad_s: Some(10.0), ..DesignRequest::default() }),
        ..project
    }
}

fn chosen_weights(project: &Project) -> Option<DesignRequest> {
    with_chosen_weights(project).unwrap().unwrap().project.synth
}

fn preview(project: &Project, moment_kg_m: Option<f64>, cache: &mut PreviewCache) -> DesignPreview {
    let request = PreviewRequest { project: Arc::new(project.clone()), out_of_balance_kg_m: moment_kg_m };
    preview_design(&request, cache, &Serial).unwrap()
}

#[test]
fn kept_weights_are_those_that_the_project_at_hand_asks_for() {
    let mut cache = PreviewCache::default();
    let first = without_weights();
    let own = chosen_weights(&first);
    assert_eq!(preview(&first, None, &mut cache).project.synth, own);

    let mut renamed = first.clone();
    renamed.plant.name = "the same machine".to_owned();
    renamed.sweep = None;
    let found = preview(&renamed, None, &mut cache);
    assert_eq!((&found.project.synth, &*found.project.plant.name), (&own, "the same machine"));

    let mut shaken = renamed.clone();
    shaken.verify.as_mut().unwrap().procedure.heave.amplitude *= 3.0;
    let found = preview(&shaken, None, &mut cache);
    assert_ne!(found.project.synth, own);

    let mut heavy = shaken.clone();
    heavy.plant.lumped.as_mut().unwrap().hub_inertia_kg_m2 *= 2.0;
    let before = found.project.synth.clone();
    let found = preview(&heavy, None, &mut cache);
    assert_eq!(found.project.synth, chosen_weights(&heavy));
    assert_ne!(found.project.synth, before);
}

#[test]
fn a_moment_that_is_tried_leaves_the_weights_of_the_project_as_they_are() {
    let project = without_weights();
    let own = chosen_weights(&project);
    for moments in [[None, Some(30.0)], [Some(30.0), None]] {
        let mut cache = PreviewCache::default();
        for moment in moments {
            let found = preview(&project, moment, &mut cache);
            assert_eq!(found.project.synth, own);
            let used = found.modelled.plant.body().out_of_balance_kg_m;
            assert_eq!(used == 30.0, moment.is_some());
        }
    }
}

/// Returns the example whose structure is imported, read with its files.
fn imported_project() -> Project {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/imported-structure");
    let text = std::fs::read_to_string(folder.join("project.toml")).unwrap();
    let document = Document::parse(&text, "project.toml");
    let read = |all: Attachments, name: String| {
        let bytes = std::fs::read(folder.join(&name)).unwrap();
        all.with(&name, bytes)
    };
    let attached = document.attachments().into_iter().filter(|name| !name.ends_with(".parquet"));
    let attached = attached.fold(Attachments::none(), read);
    Project::resolve_for(&document, &attached, Purpose::Synth).unwrap().project
}

#[test]
fn an_edit_of_an_imported_structure_reaches_the_plant() {
    let mut cache = PreviewCache::default();
    let project = imported_project();
    let damping = |found: &DesignPreview| {
        let poles = counterpoise_lti::poles(&found.modelled.linear.system).unwrap();
        let flexible = poles.iter().filter(|pole| pole.im > 100.0);
        flexible.map(|pole| -pole.re / pole.norm()).fold(f64::INFINITY, f64::min)
    };
    let before = damping(&preview(&project, None, &mut cache));
    let mut damped = project;
    damped.import.as_mut().unwrap().modal_damping.iter_mut().for_each(|ratio| *ratio *= 3.0);
    let after = damping(&preview(&damped, None, &mut cache));
    assert!(after > 1.5 * before, "{before} {after}");
}
