//! What a first design makes of a step of the demand that nobody stated.

use counterpoise_pipeline::first_design::Chosen;
use counterpoise_pipeline::with_chosen_weights;
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_synth::{LimitKind, Unknown};

/// A stage on a linear motor: 40 kg, 1020 N, a scale of 1 nm.
const STAGE: &str = "format = 2
plant.axis = \"linear\"
plant.mass = \"40 kg\"
plant.motor = { torque_constant = \"68 N/A\" }
plant.drive = { kind = \"current\", limit = \"15 A\", bandwidth = \"1.5 kHz\" }
plant.sensors.encoder = { resolution = \"1 nm\" }
plant.interface.sample_period = \"100 us\"
";
fn read(text: &str) -> (Document, Project) {
    let document = Document::parse(text, "machine.toml");
    let parsed = Project::resolve_for(&document, &Attachments::none(), Purpose::Design).unwrap();
    (document, parsed.project)
}

fn chosen(text: &str) -> Chosen {
    with_chosen_weights(&read(text).1).unwrap().unwrap()
}

fn step(chosen: &Chosen) -> f64 {
    chosen.project.verify.as_ref().unwrap().procedure.step.rate_rad_s
}

#[test]
fn a_step_that_nobody_stated_limits_no_loop_and_one_that_is_stated_does() {
    let open = chosen(STAGE);
    let stated = chosen(&format!("{STAGE}verify.step.rate = 0.1\n"));
    let bandwidth = |chosen: &Chosen| chosen.first.bandwidth.bandwidth_rad_s;
    assert_eq!(stated.first.bandwidth.limited_by, [LimitKind::Control]);
    assert_eq!(step(&stated), 0.1);
    // 0.1 m within 1020 N on 40 kg leave sqrt(1020 / 40 / 0.1) = 16 rad/s
    assert!(bandwidth(&stated) < 16.0, "{}", bandwidth(&stated));
    assert!(open.first.bandwidth.unknown.contains(&Unknown::Demand));
    assert!(!open.first.bandwidth.limited_by.contains(&LimitKind::Control));
    assert!(bandwidth(&open) > 50.0 * bandwidth(&stated), "{}", bandwidth(&open));
    // what is not known lowers the ceiling: structure, sensor and step, each by 0.7
    let ceiling = std::f64::consts::TAU * 1e4 / 20.0 * 0.7_f64.powi(3);
    assert!(bandwidth(&open) <= ceiling * 1.001, "{} {ceiling}", bandwidth(&open));
    // the step that it is verified by stays within the limit, and is read again from the saved file
    assert!(step(&open) * open.first.judgement.step_gain <= 10.0, "{}", step(&open));
    assert!(2.5 * step(&open) * open.first.judgement.step_gain > 10.0, "the next size exceeds it");
    let (document, project) = read(STAGE);
    let saved = open.project.update(&document, &project).unwrap();
    let again = read(saved.text()).1;
    let specification = |project: &Project| project.synth.as_ref().unwrap().specification.clone();
    assert_eq!(specification(&again), specification(&open.project));
    assert_eq!(again.verify, open.project.verify);
}
