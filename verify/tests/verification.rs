//! Verdicts of a whole verification.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use counterpoise_controller::Controller;
use counterpoise_recordings::Signals;
use counterpoise_verify::{
    Arrangement, Coincidence, Experiment, Limit, LineOfSight, LoopFigure, MissingReason, Model, Optics,
    PerformanceFigure, Procedure, Quantity, Requirement, Road, RoadOrigin, Source, StepFigure, Triangle,
    Verdict, verify, verify_linear,
};
use support::{controller, plant};

fn require(key: &str, limit: Limit) -> Requirement {
    Requirement::new(PerformanceFigure::from_key(key).unwrap(), limit).unwrap()
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
    let db = found.value(PerformanceFigure::Loop(LoopFigure::GainMargin)).unwrap();
    let factor = 10f64.powf(db / 20.0);
    for (share, stable) in [(0.995, true), (1.005, false)] {
        let other = verify_linear(&plant(), &stronger(share * factor), &Procedure::default(), &[]).unwrap();
        assert_eq!(other.evidence.margins.closed_loop_stable, stable, "{share}");
        assert_eq!(other.value(PerformanceFigure::Loop(LoopFigure::PoleRadius)).unwrap() < 1.0, stable);
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
        found
            .value(PerformanceFigure::Disturbance(
                Model::Linear,
                Source::Heave,
                arrangement,
                Quantity::HubRms,
            ))
            .unwrap()
    };
    let (none, feedback, both) =
        (rms(Arrangement::Uncontrolled), rms(Arrangement::Feedback), rms(Arrangement::Compensated));
    assert!(none > 2.0 * feedback && feedback > 10.0 * both, "{none} {feedback} {both}");
}

#[test]
fn what_was_not_run_cannot_be_judged() {
    let requirements = [require("linear_road_feedback_hub_rms_rad_s", Limit::AtMost(1.0))];
    let found = verify_linear(&plant(), &controller(), &Procedure::default(), &requirements).unwrap();
    assert!(matches!(&found.verdicts[0].1, Verdict::NotApplicable { why: MissingReason::NoRoad }));
    let simulated = [require("rest_drift_rad", Limit::AtMost(1.0))];
    let found = verify_linear(&plant(), &controller(), &Procedure::default(), &simulated).unwrap();
    assert!(matches!(&found.verdicts[0].1, Verdict::NotApplicable { why: MissingReason::LinearPlantAlone }));
    assert!(found.value(PerformanceFigure::Step(Model::Linear, StepFigure::SteadyStateError)).unwrap() < 0.5);
}

const TRIANGLE: Triangle = Triangle { rate_rad_s: 0.15, period_s: 2.0 };

/// A road of two seconds: heave and pitch of one tone each.
fn road() -> Road {
    let sine = |amplitude: f64, hz: f64| -> Vec<f64> {
        (0..400).map(|k| amplitude * (std::f64::consts::TAU * hz * f64::from(k) * 0.005).sin()).collect()
    };
    let (heave, pitch) = (sine(1.0, 1.5), sine(0.1, 1.0));
    Road {
        origin: RoadOrigin::Recording("tones".to_owned()),
        sample_period_s: 0.005,
        signals: Signals::stack([&heave[..], &pitch]),
    }
}

/// Every figure that a project file can name holds where the limit leaves room, by that room, and fails where it does not, by as much;
/// one that does not exist on a plant says why.
#[test]
fn every_figure_can_be_required_and_is_judged_by_how_much() {
    let procedure = Procedure {
        duration_s: 2.0,
        settle_s: 0.5,
        road: Some(road()),
        triangle: Some(TRIANGLE),
        line_of_sight: Some(LineOfSight {
            coincidence: Some(Coincidence { window_rad: 5e-3, target_rad: 5e-3, ..Coincidence::default() }),
            optics: Some(Optics::default()),
            ..LineOfSight::default()
        }),
        ..Procedure::default()
    };
    let first = verify(&plant(), &controller(), &procedure, &[]).unwrap();
    let (mut asked, mut expected) = (Vec::new(), Vec::new());
    for figure in PerformanceFigure::all() {
        let value = first.verification().value(figure).filter(|value| value.is_finite());
        let limit = value.unwrap_or(1.0);
        let room = 0.1 * limit.abs().max(1e-6);
        for limit in [
            Limit::AtMost(limit + room),
            Limit::AtMost(limit - room),
            Limit::AtLeast(limit - room),
            Limit::AtLeast(limit + room),
        ] {
            asked.push(Requirement::new(figure, limit).unwrap());
            expected.push((value, room));
        }
    }
    let found = verify(&plant(), &controller(), &procedure, &asked).unwrap();
    let verdicts = &found.verification().verdicts;
    for (k, ((requirement, verdict), (value, room))) in verdicts.iter().zip(&expected).enumerate() {
        let key = requirement.figure;
        match (verdict, value) {
            (Verdict::Holds { margin, .. }, Some(_)) => {
                assert!(k % 2 == 0 && (margin - room).abs() < 1e-9 * (1.0 + room), "{key}")
            }
            (Verdict::Fails { by, .. }, Some(_)) => {
                assert!(k % 2 == 1 && (by - room).abs() < 1e-9 * (1.0 + room), "{key}")
            }
            (Verdict::NotApplicable { why }, None) => {
                // the linear plant has no teeth that part, and a step that stays below the demand no peak
                let teeth = key.key().starts_with("linear") && key.key().ends_with("gear_open_fraction");
                let peak = key.key().ends_with("step_peak_time_s") && *why == MissingReason::NoPeak;
                let certificate = matches!(key, PerformanceFigure::Certificate(_));
                let open = certificate && *why == MissingReason::NoCertificate;
                assert!(teeth || peak || open, "{key}: {why:?}");
            }
            // a margin without bound
            (Verdict::Holds { value, .. } | Verdict::Fails { value, .. }, None) => {
                assert!(value.is_infinite(), "{key}")
            }
            other => panic!("{key}: {other:?}"),
        }
    }
    assert_eq!(verdicts.len(), 4 * PerformanceFigure::all().len());
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
    counterpoise_models::plant::Plant::from_lumped(&rig).unwrap()
}

#[test]
fn the_simulator_without_friction_and_backlash_is_the_linear_loop() {
    let procedure = Procedure { triangle: Some(TRIANGLE), ..Procedure::default() };
    let verified = verify(&linear_rig(), &controller(), &procedure, &[]).unwrap();
    let found = verified.verification();
    for experiment in [
        Experiment::Step,
        Experiment::Triangle,
        Experiment::Disturbance(Source::Heave, Arrangement::Feedback),
        Experiment::Disturbance(Source::Pitch, Arrangement::Compensated),
        Experiment::Disturbance(Source::Both, Arrangement::Uncontrolled),
    ] {
        let linear = found.history(Model::Linear, experiment).unwrap();
        let nonlinear = found.history(Model::Nonlinear, experiment).unwrap();
        let samples = linear.len().min(nonlinear.len());
        let error: f64 = (0..samples)
            .map(|k| (linear.hub_rate_rad_s()[k] - nonlinear.hub_rate_rad_s()[k]).abs())
            .fold(0.0, f64::max);
        let size = linear.hub_rate_rad_s().iter().fold(0.0f64, |a, b| a.max(b.abs()));
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
    for figure in PerformanceFigure::all() {
        let road = matches!(
            figure,
            PerformanceFigure::Disturbance(_, Source::Road, ..)
                | PerformanceFigure::Triangle(..)
                | PerformanceFigure::Sight(_)
                | PerformanceFigure::Certificate(_)
        );
        let present = found.figures.iter().any(|measured| measured.figure == figure);
        assert_eq!(present, !road, "{figure}");
    }
    let open = PerformanceFigure::Disturbance(
        Model::Nonlinear,
        Source::Both,
        Arrangement::Compensated,
        Quantity::GearOpen,
    );
    assert_eq!(found.value(open), Some(0.0), "gravity preloads the gear");
}
