//! The source thesis' own two gaps between model and machine, as examples: the structure's modes (table 6-1) and the
//! amplifier's gain curve (tables 7-1 and 7-2).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use counterpoise_claims::identification::AMPLIFIER;
use counterpoise_diagnose::findings::answer::DiagnosisVerdict;
use counterpoise_diagnose::identification::{IdentifiedAmplifier, apply_identified, identify};
use counterpoise_pipeline::recordings::measured_modes::diagnose_structure;
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_recordings::{Recording, RecordingTable};
use counterpoise_report::wording::structure::{describe_hypothesis, describe_structure};
use counterpoise_simulate::replay::{ReplayLoop, replay};

fn folder(example: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(example)
}

fn project(example: &str) -> Project {
    let bytes = fs::read(folder(example).join("project.toml")).unwrap();
    Project::from_bytes(&bytes, "project.toml").unwrap().project
}

#[test]
fn shear_and_rotary_inertia_are_what_the_elements_of_table_6_1_left_out() {
    let project = project("measured-modes");
    let found = diagnose_structure(&project, project.measured.as_ref().unwrap()).unwrap();
    let answer = &found.answer;
    assert_eq!(answer.verdict, DiagnosisVerdict::Named, "{}", describe_structure(answer));
    assert_eq!(describe_hypothesis(answer.tried[1].hypothesis), "shear and rotary inertia");
    assert!(answer.alternatives.is_empty(), "{:?}", answer.alternatives);
    let (before, after) = (&answer.tried[0], &answer.tried[1]);
    assert!(before.left_out_percent > 5.0 && after.left_out_percent < 1.2, "{before:?} {after:?}");
    // the thesis' elements: the error grows with the mode, as without shear and rotary inertia
    let error = |k: usize| before.modes_hz[k] / answer.measured_hz[k] - 1.0;
    assert!(error(8) > 0.1 && error(8) > error(5) && error(5) > error(2));
    let again = diagnose_structure(&found.improved, found.improved.measured.as_ref().unwrap()).unwrap();
    assert_eq!(again.answer.verdict, DiagnosisVerdict::Consistent);
}

#[test]
fn modes_that_the_model_has_are_consistent_and_a_softer_beam_is_a_stiffness() {
    let mut project = project("measured-modes");
    let model = diagnose_structure(&project, project.measured.as_ref().unwrap()).unwrap().answer.model_hz;
    let measured = |project: &mut Project, factor: f64| {
        let modes = &mut project.measured.as_mut().unwrap().modes_hz;
        *modes = model.iter().map(|f| factor * f).collect();
    };
    measured(&mut project, 1.0);
    let found = diagnose_structure(&project, project.measured.as_ref().unwrap()).unwrap();
    assert_eq!(found.answer.verdict, DiagnosisVerdict::Consistent);
    measured(&mut project, 0.95);
    let found = diagnose_structure(&project, project.measured.as_ref().unwrap()).unwrap();
    assert_eq!(found.answer.verdict, DiagnosisVerdict::Named);
    let modulus = |p: &Project| p.plant.beam.as_ref().unwrap().youngs_modulus_pa;
    assert!((modulus(&found.improved) / modulus(&project) / 0.95_f64.powi(2) - 1.0).abs() < 1e-6);
}

/// The current of the concealed curve, A.
fn current_a(volt: f64) -> f64 {
    let curve: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(AMPLIFIER).collect();
    let above = curve.iter().position(|(v, _)| *v >= volt).unwrap().max(1);
    let ((v0, i0), (v1, i1)) = (curve[above - 1], curve[above]);
    i0 + (i1 - i0) * (volt - v0) / (v1 - v0)
}

fn recording(project: &Project, state: &str) -> Recording {
    let bytes = fs::read(folder("amplifier-curve").join(state).join("triangle.parquet")).unwrap();
    project.recording.apply(&RecordingTable::read(&bytes, state).unwrap()).unwrap()
}

#[test]
fn the_amplifiers_curve_is_recovered_in_one_iteration_and_the_second_changes_nothing() {
    let project = project("amplifier-curve");
    let (balanced, midpoint) = (recording(&project, "balanced"), recording(&project, "midpoint"));
    let states = [&[balanced.clone()][..], &[midpoint][..]];
    let found = identify(&project.plant, &states).unwrap();
    assert!(matches!(found.amplifier, IdentifiedAmplifier::Curve { .. }));
    let errors =
        found.amplifier.points().iter().map(|q| (q.input_v, q.current_a / current_a(q.input_v) - 1.0));
    let worst = errors.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap();
    assert!(worst.1.abs() < 0.04, "{worst:?}");
    let moments: Vec<f64> = found.balances.iter().map(|b| b.out_of_balance_kg_m.value).collect();
    assert!((moments[0] - 10.617).abs() < 0.05 && (moments[1] - 75.835).abs() < 0.05, "{moments:?}");
    let better = apply_identified(&project.plant, &found);
    let again = identify(&better, &states).unwrap();
    assert!(matches!(again.amplifier, IdentifiedAmplifier::AsInProject { .. }));
    // as figure 7-12: the balanced run, simulated with the linear and with the recovered amplifier
    let control = ReplayLoop::from(
        project
            .recording_controller
            .as_ref()
            .and_then(RecordingController::as_proportional_integral)
            .unwrap(),
    );
    let error = |plant| {
        let channels = replay(plant, &balanced, &control).unwrap().channels;
        channels.iter().find(|c| c.channel.name() == "control").unwrap().rms_error
    };
    assert!(error(&project.plant) > 15.0 * error(&better), "{} {}", error(&project.plant), error(&better));
}
