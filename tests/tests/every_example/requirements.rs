//! Every shipped example: its design exists and costs what the equations predict; and the examples that the longest suites try meet their
//! requirements, as every one does if `EVERY_EXAMPLE` is set.

use std::path::Path;
use std::sync::Mutex;

use counterpoise_pipeline::SynthesisedDesign;
use counterpoise_project::Purpose;
use counterpoise_synth::{PartCertificates, Sampling, SamplingMethod, discretise};
use counterpoise_tests::examples;
use counterpoise_verify::Verdict;

/// Predicted and achieved H2 norm agree within this.
const COST: f64 = 1e-6;

/// Returns what is wrong with the costs of the same design made again in sampled time.
fn in_sampled_time(made: &SynthesisedDesign) -> Option<String> {
    let sampling = Sampling { method: SamplingMethod::SampledData, ..made.sampling.clone() };
    match discretise(&made.design, &sampling) {
        Err(why) => Some(format!("{why:?}")),
        Ok(sampled) => {
            let agrees = |part: &PartCertificates| part.cost.relative_difference().is_some_and(|d| d < COST);
            sampled.certified.iter().find(|part| !agrees(part)).map(|part| format!("{part:?}"))
        }
    }
}

/// Returns what is wrong with an example's design; `None` if it asks for none.
fn wrong(path: &Path) -> Option<Vec<String>> {
    examples::resolve_example(path, Purpose::Export).unwrap().synth?;
    let designed = examples::design_example(path)?;
    let (project, made) = (&designed.project, &designed.made);
    let (name, mut wrong) = (examples::name(path), Vec::new());
    let costs = [Some(made.design.feedback.cost)]
        .into_iter()
        .chain([made.design.heave.as_ref(), made.design.pitch.as_ref()].map(|part| part.map(|p| p.cost)));
    for cost in costs.flatten() {
        match cost.relative_difference() {
            Some(difference) if difference < COST => {}
            other => wrong.push(format!("{name}: cost differs by {other:?}: {cost:?}")),
        }
    }
    if made.design.substitute.is_none() {
        wrong.extend(in_sampled_time(made).map(|why| format!("{name}, in sampled time: {why}")));
    }
    if project.verify.is_some() && examples::chosen_files().iter().any(|chosen| chosen == path) {
        let verified = examples::verify_example(path)?;
        for (requirement, verdict) in &verified.verification().verdicts {
            println!("{name}: {}: {verdict:?}", requirement.figure.key());
            if !matches!(verdict, Verdict::Holds { .. }) {
                wrong.push(format!("{name}: {}: {verdict:?}", requirement.figure.key()));
            }
        }
    }
    Some(wrong)
}

#[test]
fn every_example_costs_what_is_predicted_and_meets_its_requirements() {
    let files = examples::files();
    let found = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(files.len(), &|k| found.lock().unwrap().extend(wrong(&files[k])));
    let found = found.into_inner().unwrap();
    assert!(found.len() >= 7, "{} designs", found.len());
    assert!(found.iter().all(Vec::is_empty), "{}", found.concat().join("\n"));
}
