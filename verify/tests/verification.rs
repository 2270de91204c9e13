//! Verdicts of a whole verification.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

mod support;

use counterpoise_controller::Controller;
use counterpoise_verify::{
    Arrangement, Figure, Limit, LoopFigure, Model, Procedure, Quantity, Requirement, Source, StepFigure,
    Verdict, verify_linear,
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
