//! Weights that make no solvable problem are refused before solving: with the weight, the frequency, a suggestion.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{rig, weights};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_synth::{
    Cause, DesignFinding, DesignPlant, DisturbanceKnowledge, FindingSeverity, Part, PlantCause, Reference,
    Specification, SpecificationCause, StatedDensity, Weight, WeightRole, design, preflight,
};

fn pair(re: f64, im: f64) -> Vec<C64> {
    vec![C64::new(re, im), C64::new(re, -im)]
}

/// The refusals of a changed specification; the design must give the same.
fn refusals(plant: &DesignPlant, change: impl FnOnce(&mut Specification)) -> Vec<DesignFinding> {
    let mut specification = weights();
    change(&mut specification);
    let findings = preflight(plant, &specification).unwrap();
    let refused: Vec<DesignFinding> =
        findings.iter().filter(|finding| finding.is_refusal()).cloned().collect();
    assert!(!refused.is_empty(), "{findings:?}");
    let reasons = design(plant, &specification).unwrap_err();
    assert_eq!(format!("{:?}", reasons.findings()), format!("{findings:?}"));
    refused
}

/// The rig with its plant's rate differentiated: a plant with a zero at the origin.
fn washed_out() -> DesignPlant {
    let wash = StateSpace::new(
        Mat::diag(&[-1.0]),
        Mat::eye(1),
        Mat::diag(&[-1.0]),
        Mat::eye(1),
        Timebase::Continuous,
    );
    let system = rig().system;
    let rate_only = system.select(&[0], &[0, 1, 2]);
    DesignPlant { system: counterpoise_lti::series(&rate_only, &wash.unwrap()).unwrap(), ..rig() }
}

#[test]
fn an_integrating_weight_on_a_plant_with_a_zero_at_the_origin() {
    let refused = refusals(&washed_out(), |_| ());
    assert!(matches!(
        refused[0].cause,
        Cause::Specification(SpecificationCause::PlantZeroAtErrorPole { .. })
    ));
    assert_eq!((refused[0].part, refused[0].rate_rad_s), (Part::Feedback, Some(0.0)));
    assert!(refused[0].weight.as_ref().unwrap().role == WeightRole::Error);
}

#[test]
fn an_integrating_weight_behind_a_sensor_that_reads_no_steady_rate() {
    let wash = Weight::ZeroPoleGain { zeros: vec![C64::ZERO], poles: vec![C64::new(-1.0, 0.0)], gain: 1.0 };
    let plant = DesignPlant { hub_sensor: Some(wash.realise().unwrap()), ..rig() };
    let refused = refusals(&plant, |_| ());
    assert_eq!(refused[0].cause, Cause::Specification(SpecificationCause::SensorBlindAtErrorPole));
    assert_eq!(refused[0].rate_rad_s, Some(0.0));
}

#[test]
fn a_resonant_error_weight_at_a_zero_of_the_plant() {
    let zero = C64::new(0.0, 110.0);
    let blocked = Weight::ZeroPoleGain { zeros: pair(0.0, 110.0), poles: pair(-40.0, 100.0), gain: 1.0 };
    let system =
        counterpoise_lti::series(&rig().system.select(&[0], &[0, 1, 2]), &blocked.realise().unwrap())
            .unwrap();
    let plant = DesignPlant { system, ..rig() };
    let refused = refusals(&plant, |s| {
        s.feedback.error = Weight::ZeroPoleGain { zeros: vec![], poles: pair(0.0, 110.0), gain: 1e4 };
        (s.heave, s.pitch) = (None, None);
    });
    assert!(matches!(
        refused[0].cause,
        Cause::Specification(SpecificationCause::PlantZeroAtErrorPole { .. })
    ));
    assert_eq!(refused[0].rate_rad_s, Some(zero.im));
}

#[test]
fn a_control_weight_that_vanishes_at_high_frequency() {
    for part in [Part::Feedback, Part::Heave, Part::Pitch] {
        let falling = Weight::Lag { gain: 1.0, time_s: 0.01 };
        let refused = refusals(&rig(), |s| match part {
            Part::Feedback => s.feedback.control = falling,
            Part::Heave => s.heave.as_mut().unwrap().control = falling,
            _ => s.pitch.as_mut().unwrap().control = falling,
        });
        assert_eq!(
            refused[0].cause,
            Cause::Specification(SpecificationCause::ControlWeightVanishes { excess: 1 })
        );
        assert_eq!((refused[0].part, refused[0].rate_rad_s), (part, Some(f64::INFINITY)));
    }
}

#[test]
fn an_error_weight_that_rises_without_bound() {
    let refused = refusals(&rig(), |s| s.feedback.error = Weight::Lead { gain: 1.0, time_s: 0.1 });
    assert_eq!(refused[0].cause, Cause::Specification(SpecificationCause::ErrorWeightImproper { excess: 1 }));
    assert_eq!(refused[0].rate_rad_s, Some(f64::INFINITY));
}

#[test]
fn a_free_control_where_the_error_does_not_show_it() {
    let free = Weight::QuadraticFreeAtZero { gain: 1.0, second_s2: 1e-4, first_s: 0.02 };
    let refused = refusals(&washed_out(), |s| {
        s.feedback.error = Weight::Lag { gain: 1.0, time_s: 1.0 };
        s.feedback.control = free;
    });
    assert_eq!(refused[0].cause, Cause::Specification(SpecificationCause::ControlFreeUnseen));
    assert_eq!(refused[0].rate_rad_s, Some(0.0));
}

#[test]
fn weights_that_are_both_infinite_at_one_frequency() {
    let refused = refusals(&rig(), |s| {
        s.feedback.control =
            Weight::ZeroPoleGain { zeros: vec![C64::new(-50.0, 0.0)], poles: vec![C64::ZERO], gain: 1.0 };
    });
    assert_eq!(refused[0].cause, Cause::Specification(SpecificationCause::WeightsBothInfinite));
    assert_eq!(refused[0].rate_rad_s, Some(0.0));
}

#[test]
fn weights_that_are_void_or_not_numbers() {
    let void = [
        Weight::Constant { gain: 0.0 },
        Weight::Lag { gain: 1.0, time_s: 0.0 },
        Weight::Integral { gain: f64::NAN, time_s: 1.0 },
    ];
    for weight in void {
        let refused = refusals(&rig(), |s| s.feedback.error = weight);
        assert_eq!(refused[0].cause, Cause::Specification(SpecificationCause::WeightVoid));
    }
    let lone = Weight::ZeroPoleGain { zeros: vec![], poles: vec![C64::new(-1.0, 2.0)], gain: 1.0 };
    assert_eq!(
        refusals(&rig(), |s| s.feedback.error = lone)[0].cause,
        Cause::Specification(SpecificationCause::WeightComplex)
    );
}

#[test]
fn noises_that_are_none() {
    for noise in [0.0, -1.0, f64::NAN] {
        let refused = refusals(&rig(), |s| s.feedback.measurement_noise = noise);
        assert!(matches!(
            refused[0].cause,
            Cause::Specification(SpecificationCause::Density { of: StatedDensity::MeasurementNoise, .. })
        ));
    }
    let refused = refusals(&rig(), |s| {
        s.heave.as_mut().unwrap().knowledge = DisturbanceKnowledge::Measured { noise: 0.0 }
    });
    assert!(matches!(refused[0].cause, Cause::Specification(SpecificationCause::Density { .. })));
    assert_eq!(refused[0].part, Part::Heave);
}

#[test]
fn generators_of_infinite_power() {
    let cases = [
        (
            Weight::Constant { gain: 1.0 },
            Cause::Specification(SpecificationCause::GeneratorNotProper),
            f64::INFINITY,
        ),
        (
            Weight::Integral { gain: 1.0, time_s: 1.0 },
            Cause::Specification(SpecificationCause::GeneratorUnstable { pole: C64::ZERO }),
            0.0,
        ),
    ];
    for (generator, cause, rate) in cases {
        let refused = refusals(&rig(), |s| s.heave.as_mut().unwrap().generator = generator);
        assert_eq!((refused[0].cause.clone(), refused[0].rate_rad_s), (cause, Some(rate)));
    }
}

#[test]
fn a_generator_too_rough_for_the_derivative_and_knowledge_that_is_not_complete() {
    let mut plant = rig();
    plant.pitch.push(2);
    let refused =
        refusals(&plant, |s| s.pitch.as_mut().unwrap().generator = Weight::Lag { gain: 1.0, time_s: 1.0 });
    assert_eq!(
        refused[0].cause,
        Cause::Specification(SpecificationCause::GeneratorTooRough { relative_degree: 1, needed: 2 })
    );
    let refused = refusals(&rig(), |s| s.pitch.as_mut().unwrap().knowledge = DisturbanceKnowledge::Exact);
    assert_eq!(
        refused[0].cause,
        Cause::Specification(SpecificationCause::KnowledgeIncomplete { order: 2, known: 1 })
    );
}

#[test]
fn a_feedforward_without_its_input_and_one_without_effect() {
    let plant = DesignPlant { heave: vec![], ..rig() };
    assert_eq!(refusals(&plant, |_| ())[0].cause, Cause::Plant(PlantCause::ChannelMissing));
    let mut balanced = rig();
    for state in 0..balanced.system.order() {
        balanced.system.B[(state, 1)] = 0.0;
    }
    let findings = preflight(&balanced, &weights()).unwrap();
    assert_eq!(
        (findings[0].severity, findings[0].cause.clone()),
        (FindingSeverity::Warning, Cause::Plant(PlantCause::ChannelWithoutEffect))
    );
}

#[test]
fn an_integrating_feedforward_with_a_noisy_sensor() {
    let refused =
        refusals(&rig(), |s| s.heave.as_mut().unwrap().error = Weight::Integral { gain: 1.0, time_s: 1.0 });
    assert_eq!(refused[0].cause, Cause::Plant(PlantCause::FeedforwardUnbounded { pole: C64::ZERO }));
    assert_eq!((refused[0].part, refused[0].rate_rad_s), (Part::Heave, Some(0.0)));
}

#[test]
fn modes_out_of_reach_of_control_or_measurement() {
    let hidden = |B: f64, C: f64| {
        let plant = rig();
        let mut system = plant.system.clone();
        let n = system.order();
        system.A = system.A.block_diag(&Mat::eye(1).scale(2.0));
        system.B = system.B.vstack(&Mat::row(&[B, 0.0, 0.0]));
        system.C = system.C.hstack(&Mat::col(&[C, 0.0, 0.0]));
        assert_eq!(system.A.nrows(), n + 1);
        DesignPlant { system, ..plant }
    };
    let refused = refusals(&hidden(0.0, 1.0), |s| (s.heave, s.pitch) = (None, None));
    assert!(
        matches!(refused[0].cause, Cause::Plant(PlantCause::NotStabilisable { pole }) if (pole - 2.0).norm() < 1e-9)
    );
    let refused = refusals(&hidden(1.0, 0.0), |s| (s.heave, s.pitch) = (None, None));
    assert!(
        matches!(refused[0].cause, Cause::Plant(PlantCause::NotDetectable { pole }) if (pole - 2.0).norm() < 1e-9)
    );
}

#[test]
fn an_undamped_mode_that_no_noise_excites() {
    let A = Mat::from_rows(&[&[-1.0, 0.0, 0.0], &[0.0, 0.0, 10.0], &[0.0, -10.0, 0.0]]);
    let B = Mat::from_rows(&[&[1.0, 1.0], &[0.0, 0.0], &[1.0, 0.0]]);
    let system =
        StateSpace::new(A, B, Mat::row(&[1.0, 1.0, 0.0]), Mat::zeros(1, 2), Timebase::Continuous).unwrap();
    let plant = DesignPlant::ideal(system, 0, 0);
    let refused = refusals(&plant, |s| {
        (s.heave, s.pitch) = (None, None);
        s.feedback.loop_recovery = 0.0;
    });
    assert!(matches!(refused[0].cause, Cause::Plant(PlantCause::NoiseMissesMode { .. })));
    assert!((refused[0].rate_rad_s.unwrap() - 10.0).abs() < 1e-9);
}

#[test]
fn a_direct_path_and_a_demand_without_states_to_enter() {
    let mut plant = DesignPlant { delay_s: 0.0, hub_sensor: None, ..rig() };
    plant.system.D[(0, 0)] = 0.1;
    assert_eq!(refusals(&plant, |_| ())[0].cause, Cause::Plant(PlantCause::DirectPath { gain: 0.1 }));
    let refused = refusals(&rig(), |s| {
        s.reference = Reference::WeightOnly;
        s.feedback.error = Weight::Constant { gain: 1.0 };
    });
    assert_eq!(refused[0].cause, Cause::Plant(PlantCause::ReferenceWithoutStates));
}

#[test]
fn warnings_do_not_stand_in_the_way() {
    let warned = |change: &dyn Fn(&mut DesignPlant, &mut Specification)| {
        let (mut plant, mut specification) = (rig(), weights());
        change(&mut plant, &mut specification);
        let design = design(&plant, &specification).unwrap();
        design.warnings.first().map(|finding| finding.cause.clone())
    };
    assert_eq!(warned(&|_, _| ()), None);
    let left_out = warned(&|plant, _| plant.pade_order = 0);
    assert_eq!(left_out, Some(Cause::Plant(PlantCause::DelayLeftOut { delay_s: 1e-3 })));
    let delayed = warned(&|plant, _| plant.delay_s = 0.03);
    assert!(matches!(delayed, Some(Cause::Plant(PlantCause::DelayLimits { .. }))), "{delayed:?}");
    let mirrored = warned(&|_, s| s.feedback.control = Weight::Lead { gain: 1.0, time_s: -0.005 });
    assert!(matches!(mirrored, Some(Cause::Specification(SpecificationCause::WeightMirrored { .. }))));
    let deaf = warned(&|_, s| (s.feedback.loop_recovery, s.feedback.disturbances) = (0.0, vec![]));
    assert_eq!(deaf, Some(Cause::Specification(SpecificationCause::NothingDisturbs)));
}

#[test]
fn a_finding_names_the_weight_and_the_frequency() {
    let refused =
        refusals(&washed_out(), |s| s.feedback.error = Weight::Integral { gain: 200.0, time_s: 1.0 });
    let weight = refused[0].weight.as_ref().unwrap();
    assert_eq!(
        (weight.role, &weight.weight),
        (WeightRole::Error, &Weight::Integral { gain: 200.0, time_s: 1.0 })
    );
    assert_eq!((refused[0].part, refused[0].rate_rad_s), (Part::Feedback, Some(0.0)));
}

/// A slide of 25 kg on a ball screw of 90 N/um and 10 mm lead, its position read at the motor (1.06 kg cm^2): states are the motor's rate,
/// the wind-up, the slide's rate and its position, in rad/s, m, m/s and m.
#[test]
fn a_stiff_axis_in_metres_and_newtons_is_reached_and_seen() {
    let (k, d, mass, inertia, per_m) = (9e7, 950.0, 25.0, 1.06e-4, 628.3);
    let A = Mat::from_rows(&[
        &[-d / (per_m * per_m * inertia), -k / (per_m * inertia), d / (per_m * inertia), 0.0],
        &[1.0 / per_m, 0.0, -1.0, 0.0],
        &[d / (per_m * mass), k / mass, -d / mass, 0.0],
        &[0.0, 0.0, 1.0, 0.0],
    ]);
    let B = Mat::col(&[0.13 / inertia, 0.0, 0.0, 0.0]);
    let C = Mat::row(&[0.0, 1.0, 0.0, 1.0]);
    let system = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
    let plant = DesignPlant { system, control: 0, rate: 0, heave: Vec::new(), pitch: Vec::new(), ..rig() };
    let mut specification = weights();
    (specification.heave, specification.pitch) = (None, None);
    specification.feedback.disturbances.clear();
    let found = preflight(&plant, &specification).unwrap();
    let refused: Vec<&DesignFinding> =
        found.iter().filter(|finding| finding.part == Part::Plant && finding.is_refusal()).collect();
    assert!(refused.is_empty(), "{refused:?}");
}
