//! What `diagnose` saves, `replay` confirms: machines with one effect of the library and with free functions, diagnosed, saved as a
//! project, read again, and replayed as the command line does.
//!
//! By default two recordings of 3 s are diagnosed; `.ci/evidence` has three of 4 s, with the feature `evidence`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::ProportionalIntegral;
use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict};
use counterpoise_diagnose::library::EffectName;
use counterpoise_diagnose::{Diagnosis, diagnose};
use counterpoise_models::{LearnedElement, LearnedPlace, LearnedQuantity, Parameters, Plant, RegimeVariable};
use counterpoise_pipeline::recordings::ReadRecording;
use counterpoise_pipeline::recordings::replay::{ReplayLength, replay_one};
use counterpoise_pool::Serial;
use counterpoise_project::{Attachments, Document, Project};
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::ReplayLoop;
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

/// A replay and the diagnosis seek their initial states by different means.
const SAME_FIGURE: f64 = 0.05;
/// As the project states it, m/s^2.
const GRAVITY: f64 = 9.80665;
const PROJECT: &str = include_str!("../../examples/left-out-friction/project.toml");

fn controller() -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v: 2.88,
        sample_period_s: 1e-3,
        ..ProportionalIntegral::default()
    }
}

/// A project without what the test machine need not have.
fn project() -> (Document, Project) {
    let document = Document::parse(PROJECT, "project.toml");
    let project = Project::resolve(&document, &Attachments::default()).unwrap().project;
    (document, project)
}

/// Number of recordings of a diagnosis, and their length in s.
const RECORDED: (usize, f64) = if cfg!(feature = "evidence") { (3, 4.0) } else { (2, 3.0) };

/// Triangle waves of two periods, and a slower one of another size, from rest.
fn recordings(machine: &Parameters) -> Vec<Recording> {
    let one = |(k, (amplitude, period_s)): (usize, (f64, f64))| {
        let mut simulator = Simulator::new(&Plant::from_lumped(machine).unwrap()).unwrap();
        let scenario = Scenario {
            demand_rad_s: Signal::Triangle { amplitude, period_s },
            imperfections: Imperfections::NoiseAndQuantisation { seed: 21 + k as u64 },
            detail: Detail::Recording,
            ..Scenario::at_rest(RECORDED.1)
        };
        let history = simulator.run(&mut controller(), &scenario).unwrap();
        history.readings.recording(&format!("triangle {k}"), 1e-3)
    };
    [(0.15, 2.0), (0.12, 1.3), (0.08, 2.6)].into_iter().take(RECORDED.0).enumerate().map(one).collect()
}

/// Diagnoses a machine, saves the project, reads it again and compares the figures.
fn confirm_saved_model(machine: &Parameters) -> Answer {
    let (document, project) = project();
    let recordings = recordings(machine);
    let control = ReplayLoop::from(&controller());
    let Diagnosis { answer, improved, .. } =
        diagnose(&project.plant, control.clone(), &recordings, &Serial).unwrap();
    let names: Vec<_> = answer.findings.iter().map(|f| (f.component, f.effect, f.probability)).collect();
    println!("{:?} {names:?} {:?}", answer.verdict, answer.learned.as_ref().map(|l| &l.parts[0].reading));
    let saved = Project { plant: improved, ..project.clone() }.update(&document, &project).unwrap();
    let again = Document::parse(saved.text(), "improved.toml");
    let again = Project::resolve(&again, &Attachments::default()).unwrap().project;
    let of = |recording: &Recording| {
        let file = recording.name.clone();
        let item =
            ReadRecording { file, recording: recording.clone(), remarks: Vec::new(), keeps_samples: true };
        replay_one(&again.plant, &item, &control, ReplayLength::Automatic).unwrap().followed.replay.channels
    };
    let replayed: Vec<_> = recordings.iter().map(of).collect();
    for (channel, printed) in answer.fit.after.iter() {
        let name = channel.name();
        let squares = replayed.iter().flatten().filter(|c| c.channel == channel);
        let squares: Vec<f64> = squares.map(|c| c.rms_error.powi(2)).collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        println!("  {name}: printed {:.4e}, replayed {rms:.4e}", printed.rms_error);
        assert!((rms / printed.rms_error - 1.0).abs() < SAME_FIGURE, "{name}: {rms} {printed:?}");
    }
    answer
}

fn over_angle(quantity: LearnedQuantity, of: impl Fn(f64) -> f64) -> LearnedElement {
    let points: Vec<f64> = (0..201).map(|k| 0.15 * (f64::from(k) / 100.0 - 1.0)).collect();
    let values = points.iter().map(|x| of(*x)).collect();
    let element = LearnedElement::neutral(LearnedPlace::Pivot, quantity, RegimeVariable::Angle, points);
    LearnedElement { values, ..element }
}

#[test]
fn a_free_function_is_saved_and_replayed_as_printed() {
    let mut machine = project().1.plant;
    let wave = |x: f64| 45.0 * (60.0 * x + 0.4).sin() + 30.0 * (110.0 * x).sin() + 2.0e4 * x * x * x.signum();
    machine.learned.push(over_angle(LearnedQuantity::Torque, wave));
    let answer = confirm_saved_model(&machine);
    // no effect of the library is claimed with a probability that does not hold
    assert!(answer.verdict != DiagnosisVerdict::Named, "{:?}", answer.findings);
    let learned = answer.learned.expect("a free function");
    assert!(learned.worst_held_out[1] < 1.5, "{:?}", learned.worst_held_out);
}

#[test]
fn a_spring_that_pushes_away_is_an_effect_of_the_library_and_needs_no_free_function() {
    let mut machine = project().1.plant;
    let stiffness = -1150.0;
    machine.lumped.as_mut().unwrap().position_stiffness_nm_rad = stiffness;
    let answer = confirm_saved_model(&machine);
    assert!(
        matches!(answer.verdict, DiagnosisVerdict::Named | DiagnosisVerdict::Ambiguous),
        "{:?}",
        answer.findings
    );
    assert!(answer.learned.is_none() && answer.findings.len() == 1);
    let found = &answer.findings[0];
    let names = found.alternatives.iter().map(|name| name.effect).chain([found.effect]);
    assert!(names.into_iter().any(|effect| effect == EffectName::PositionStiffness), "{found:?}");
    // with the platform still, a mass above the axis is the same torque, -nu g theta: that is said, and no name is certain
    let per_rad = match found.effect {
        EffectName::VerticalOffset => -GRAVITY,
        _ => 1.0,
    };
    let [a, b] = found.parameters[0].ci95.map(|bound| per_rad * bound);
    let (low, high) = (a.min(b), a.max(b));
    assert!(high - low < 0.05 * stiffness.abs(), "{low} {high}");
    assert!((found.parameters[0].value * per_rad / stiffness - 1.0).abs() < 0.01, "{found:?}");
    assert!(found.alternatives.is_empty() || found.probability < 0.9, "{found:?}");
}
