//! Verdicts of a whole verification.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

mod support;

use counterpoise_controller::Controller;
use counterpoise_verify::{
    Arrangement, Experiment, Figure, Limit, LoopFigure, Model, Procedure, Quantity, Requirement, Source,
    StepFigure, Verdict, verify, verify_linear,
};
use support::{controller, plant};

fn require(key: &str, limit: Limit) -> Requirement {
    Requirement::new(Figure::from_key(key).unwrap(), limit).unwrap()
}

/// The same controller with its feedback `factor` times as strong.
fn stronger(factor: f64) -> Controller {
    controller()
        .with(|parts| parts.paths[0].system = parts.paths[0].system.scale_io(&[factor], &[1.0]).unwrap())
        .unwrap()
}

#[test]
fn margins_are_those_that_a_stronger_loop_uses_up() {
    let found = verify_linear(&plant(), &controller(), &Procedure::default(), &[]).unwrap();
    let db = found.value(Figure::Loop(LoopFigure::GainMargin)).unwrap();
    let factor = 10f64.powf(db / 20.0);
    for (share, stable) in [(0.995, true), (1.005, false)] {
        let other = verify_linear(&plant(), &stronger(share * factor), &Procedure::default(), &[]).unwrap();
        assert_eq!(other.evidence.margins.closed_loop_stable, stable, "{share}");
        assert_eq!(other.value(Figure::Loop(LoopFigure::PoleRadius)).unwrap() < 1.0, stable);
    }
}

#[test]
fn an_unstable_loop_fails_and_is_not_an_error() {
    let requirements = [
        require("gain_margin_db", Limit::AtLeast(6.0)),
        require("linear_step_overshoot_percent", Limit::AtMost(50.0)),
        require("pitch_feedback_drr_db at 1 Hz", Limit::AtMost(0.0)),
    ];
    let found = verify_linear(&plant(), &stronger(1e3), &Procedure::default(), &requirements).unwrap();
    assert_eq!(found.counts(), (0, 3, 0), "{:?}", found.verdicts);
    assert!(!found.passes());
}

#[test]
fn feedforward_helps_and_control_helps_more_than_none() {
    let found = verify_linear(&plant(), &controller(), &Procedure::default(), &[]).unwrap();
    let rms = |arrangement| {
        found.value(Figure::Disturbance(Model::Linear, Source::Heave, arrangement, Quantity::HubRms)).unwrap()
    };
    let (none, feedback, both) =
        (rms(Arrangement::Uncontrolled), rms(Arrangement::Feedback), rms(Arrangement::Compensated));
    assert!(none > 2.0 * feedback && feedback > 10.0 * both, "{none} {feedback} {both}");
}

#[test]
fn what_was_not_run_cannot_be_judged() {
    let requirements = [require("linear_road_feedback_hub_rms_rad_s", Limit::AtMost(1.0))];
    let found = verify_linear(&plant(), &controller(), &Procedure::default(), &requirements).unwrap();
    assert!(matches!(&found.verdicts[0].1, Verdict::NotApplicable { why } if why.contains("not run")));
    assert!(found.value(Figure::Step(Model::Linear, StepFigure::SteadyStateError)).unwrap() < 0.5);
}

/// A mechanism without what is not linear.
fn linear_rig() -> counterpoise_models::plant::Plant {
    use counterpoise_models::parameters::FrictionLaw;
    let mut rig = support::rig();
    rig.gearbox.backlash_rad = 0.0;
    rig.motor_friction.law = FrictionLaw::None;
    rig.pivot_friction.law = FrictionLaw::None;
    for sensor in
        [&mut rig.sensors.hub_gyro, &mut rig.sensors.platform_gyro, &mut rig.sensors.platform_accelerometer]
    {
        sensor.noise_rms = 0.0;
    }
    counterpoise_models::plant::Plant::lumped(&rig).unwrap()
}

#[test]
fn the_simulator_without_friction_and_backlash_is_the_linear_loop() {
    let verified = verify(&linear_rig(), &controller(), &Procedure::default(), &[]).unwrap();
    let found = verified.verification();
    for experiment in [
        Experiment::Step,
        Experiment::Disturbance(Source::Heave, Arrangement::Feedback),
        Experiment::Disturbance(Source::Pitch, Arrangement::Compensated),
        Experiment::Disturbance(Source::Both, Arrangement::Uncontrolled),
    ] {
        let linear = found.history(Model::Linear, experiment).unwrap();
        let nonlinear = found.history(Model::Nonlinear, experiment).unwrap();
        let samples = linear.hub_rate_rad_s.len().min(nonlinear.hub_rate_rad_s.len());
        let error: f64 = (0..samples)
            .map(|k| (linear.hub_rate_rad_s[k] - nonlinear.hub_rate_rad_s[k]).abs())
            .fold(0.0, f64::max);
        let size = linear.hub_rate_rad_s.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        // what is left: converters, and the cosine of the hub's angle in the out-of-balance
        assert!(error < 0.03 * size, "{experiment:?}: {error} of {size}");
    }
}

#[test]
fn a_whole_verification_measures_everything_twice_alike() {
    let run = || verify(&plant(), &controller(), &Procedure::default(), &[]).unwrap();
    let (first, second) = (run(), run());
    assert_eq!(first, second);
    let found = first.verification();
    for figure in Figure::all() {
        let road = matches!(figure, Figure::Disturbance(_, Source::Road, ..));
        let present = found.figures.iter().any(|measured| measured.figure == figure);
        assert_eq!(present, !road, "{figure}");
    }
    let open =
        Figure::Disturbance(Model::Nonlinear, Source::Both, Arrangement::Compensated, Quantity::GearOpen);
    assert_eq!(found.value(open), Some(0.0), "gravity preloads the gear");
}
