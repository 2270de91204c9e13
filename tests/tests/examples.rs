//! Every shipped example: its design exists, costs what the equations predict, and meets its requirements.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::{Synthesised, model, reduce, synthesise, verify};
use counterpoise_project::Purpose;
use counterpoise_synth::{Certified, Sampling, SamplingMethod, discretise};
use counterpoise_tests::{decided, examples};
use counterpoise_verify::Verdict;

/// Predicted and achieved H2 norm agree within this.
const COST: f64 = 1e-6;

/// What is wrong with the costs of the same design made anew in sampled time.
fn in_sampled_time(made: &Synthesised) -> Option<String> {
    let sampling = Sampling { method: SamplingMethod::SampledData, ..made.sampling.clone() };
    match discretise(&made.design, &sampling) {
        Err(why) => Some(format!("{why:?}")),
        Ok(sampled) => {
            let agrees = |part: &Certified| part.cost.relative_difference().is_some_and(|d| d < COST);
            sampled.certified.iter().find(|part| !agrees(part)).map(|part| format!("{part:?}"))
        }
    }
}

#[test]
fn every_example_costs_what_is_predicted_and_meets_its_requirements() {
    let (mut designs, mut wrong) = (0, Vec::new());
    for path in examples::files() {
        let project = examples::resolved(&path, Purpose::Export).unwrap();
        if project.synth.is_none() {
            continue;
        }
        designs += 1;
        let world = examples::world(&path);
        let project = decided(project, &world);
        let name = path.strip_prefix(env!("CARGO_MANIFEST_DIR")).unwrap_or(&path).display().to_string();
        let modelled = model(&project).unwrap();
        let reduced = reduce(&project, &modelled).unwrap();
        let made = match synthesise(&project, &modelled, &reduced) {
            Ok(made) => made,
            Err(error) => {
                wrong.push(format!("{name}: {error}"));
                continue;
            }
        };
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
            wrong.extend(in_sampled_time(&made).map(|why| format!("{name}, in sampled time: {why}")));
        }
        if project.verify.is_some() {
            let verified = verify(&project, &modelled, &made, &world).unwrap();
            for (requirement, verdict) in &verified.verification().verdicts {
                println!("{name}: {}: {verdict:?}", requirement.figure.key());
                if !matches!(verdict, Verdict::Holds { .. }) {
                    wrong.push(format!("{name}: {}: {verdict:?}", requirement.figure.key()));
                }
            }
        }
    }
    assert!(designs >= 7, "{designs} designs");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
