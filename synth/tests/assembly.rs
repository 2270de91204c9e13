//! The assembly of the parts, the action of the limiter, and the tip's motion.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use crate::common;
use counterpoise_linalg::sparse::VectorEntry;

use common::{rig, weights};
use counterpoise_controller::{Controller, Readings, SampledController};
use counterpoise_linalg::{C64, Mat, eigenvalues};
use counterpoise_lti::{Discretisation, StateSpace, c2d, h2norm, lft, response::response_at};
use counterpoise_models::LinearPlant;
use counterpoise_synth::{
    Assembly, Cause, Design, DesignPlant, DisturbanceChannel, DisturbanceKnowledge, FeedforwardBasis,
    SampledLoop, Sampling, SamplingMethod, Specification, SpecificationCause, Weight, design, discretise,
    stabilisation_error, total_cost,
};

fn design_controller(plant: &DesignPlant, specification: &Specification) -> Design {
    design(plant, specification).unwrap()
}

/// True rate over heave with the joint controller around the design plant, heave known exactly.
fn rate_over_heave(design: &Design, rate: f64) -> C64 {
    let plant = &design.plant;
    let seen = response_at(&plant.measured_plant().unwrap(), rate).unwrap();
    let K = response_at(&design.joint_controller().unwrap(), rate).unwrap();
    let (control, heave) = (plant.control, plant.heave[0]);
    // u = k_y (G u + G_d d) + k_d d, with G the measured and G' the true rate.
    let u = (K[(0, 1)] * seen[(0, heave)] + K[(0, 2)]) / (C64::ONE - K[(0, 1)] * seen[(0, control)]);
    seen[(1, heave)] + seen[(1, control)] * u
}

#[test]
fn in_grimble_s_assembly_the_feedback_keeps_out_of_what_the_feedforward_leaves() {
    let mut specification = Specification { pitch: None, ..weights() };
    let heave = specification.heave.as_mut().unwrap();
    heave.knowledge = DisturbanceKnowledge::Exact;
    heave.generator = Weight::Lag { gain: 1.0, time_s: 0.1 };
    let simple = design_controller(&rig(), &specification);
    specification.assembly = Assembly::Grimble;
    let grimble = design_controller(&rig(), &specification);
    for rate in [0.5, 6.0, 40.0] {
        let expected = response_at(&grimble.heave.as_ref().unwrap().module, rate).unwrap()[(1, 0)];
        let found = rate_over_heave(&grimble, rate);
        assert!((found - expected).norm() < 1e-8 * expected.norm(), "at {rate}: {found} {expected}");
        let seen = response_at(&rig().measured_plant().unwrap(), rate).unwrap()[(0, 0)];
        let K = response_at(&simple.feedback_controller(), rate).unwrap()[(0, 1)];
        let cleaned = expected / (C64::ONE - seen * K);
        let truth = rate_over_heave(&simple, rate);
        // Simple addition: the same error times the sensitivity, but for the sensor between true and measured rate.
        assert!((truth - cleaned).norm() < 1e-8 * cleaned.norm(), "at {rate}: {truth} {cleaned}");
    }
}

#[test]
fn the_joint_controller_runs_sampled_with_all_three_signals() {
    let specification = Specification { assembly: Assembly::Grimble, ..weights() };
    let design = design_controller(&rig(), &specification);
    let sampled = discretise(&design, &Sampling::new(1e-3, 10.0)).unwrap();
    assert_eq!(sampled.controller.parts().paths.len(), 1);
    let linear = response_at(&sampled.controller.linear(0.0).unwrap(), 5.0).unwrap();
    let joint = response_at(&design.joint_controller().unwrap(), 5.0).unwrap();
    for (reading, input) in [(0, 0), (1, 1), (3, 2), (2, 3)] {
        let (a, b) = (linear[(0, reading)], joint[(0, input)]);
        assert!((a - b).norm() < 1e-3 * b.norm(), "reading {reading}: {a} {b}");
    }
}

/// Largest true rate over a demand that saturates the control.
fn saturated_peak(sampled: &SampledLoop, demand: f64) -> f64 {
    let undelayed = DesignPlant { pade_order: 0, ..rig() };
    let seen = undelayed.measured_plant().unwrap().select(&[0, 1], &[0]);
    let P = c2d(&seen, 1e-3, Discretisation::ZeroOrderHold).unwrap();
    let mut runner = sampled.controller.runner();
    let (mut x, mut peak) = (Mat::zeros(P.order(), 1), 0.0_f64);
    for _ in 0..8000 {
        let y = &P.C * &x;
        let readings = Readings { demand_rad_s: demand, hub_rate_rad_s: y[(0, 0)], ..Readings::default() };
        let u = runner.step(&readings);
        assert!(u.abs() <= 3.0);
        x = &(&P.A * &x) + &(&P.B * &Mat::col(&[u]));
        peak = peak.max(y[(1, 0)]);
    }
    peak
}

#[test]
fn the_limiter_does_not_wind_the_integrator_up() {
    let design = design_controller(&rig(), &weights());
    let sampled = discretise(&design, &Sampling::new(1e-3, 3.0)).unwrap();
    let path = &sampled.controller.parts().paths[0];
    let g = Mat::col(&path.anti_windup);
    let held = &path.system.A - &(&g * &path.system.C);
    assert!(eigenvalues(&held).unwrap().iter().all(|pole| pole.norm() < 1.0));
    // 3 V hold 0.5 rad/s at most: a demand of 0.4 rad/s is on the limit for long.
    let with = saturated_peak(&sampled, 0.4);
    let bare: Controller = sampled.controller.with(|parts| parts.paths[0].anti_windup.fill(0.0)).unwrap();
    let without = saturated_peak(&SampledLoop { controller: bare, ..sampled }, 0.4);
    assert!(with < 1.08 * 0.4 && without > with + 0.02, "{with} with, {without} without");
}

/// RMS of hub and tip rate under white torque, which enters as the control does.
fn motion(design: &Design) -> (f64, f64) {
    let plant = &design.plant;
    let seen = plant.measured_plant().unwrap();
    let K = design.feedback_controller().select(&[0], &[1]);
    let rms = |output: usize| {
        let P: StateSpace = seen.select(&[1 + output, 0], &[plant.control, plant.control]);
        h2norm(&lft(&P, &K).unwrap()).unwrap()
    };
    (rms(LinearPlant::HUB_RATE), rms(LinearPlant::TIP_RATE))
}

#[test]
fn weighing_the_tip_calms_the_tip() {
    let mut specification = Specification { heave: None, pitch: None, ..weights() };
    let hub_only = motion(&design_controller(&rig(), &specification));
    specification.feedback.combination =
        vec![VectorEntry::new(LinearPlant::TIP_RATE, 60.0), VectorEntry::new(LinearPlant::HUB_RATE, -60.0)];
    let design = design_controller(&rig(), &specification);
    let with_tip = motion(&design);
    assert!(with_tip.1 < 0.95 * hub_only.1, "tip {} before, {} after", hub_only.1, with_tip.1);
    assert!(design.worst_cost_difference().unwrap() < 1e-6);
}

/// The spectra's integral is what the Riccati equations predict of the feedback; the slope of a quadratic is its difference.
#[test]
fn the_total_cost_has_the_feedback_s_own_cost_in_it_and_its_slopes_are_differences() {
    for assembly in [Assembly::SimpleAdd, Assembly::Grimble] {
        let specification = Specification { assembly, ..weights() };
        let design = design_controller(&rig(), &specification);
        let found = total_cost(&design).unwrap();
        println!("{found:?}");
        let own = design.feedback.cost.achieved.unwrap();
        assert!((found.sources[0].cost / own - 1.0).abs() < 2e-3, "{} {own}", found.sources[0].cost);
        assert!(
            (found.sources.iter().map(|source| source.cost).sum::<f64>() / found.total - 1.0).abs() < 1e-12
        );
        if assembly == Assembly::Grimble {
            // Each source then costs what its own weights say, and no gain is better than 1.
            for (source, part) in found.sources[1..].iter().zip([&design.heave, &design.pitch]) {
                let own = part.as_ref().unwrap().cost.achieved.unwrap();
                assert!((source.cost / own - 1.0).abs() < 2e-3, "{} {own}", source.cost);
                assert!((source.best_gain.unwrap() - 1.0).abs() < 2e-3, "{source:?}");
            }
        }
    }
}

/// With integral action in the feedback a steady control of the pitch feedforward is cancelled, and yet both are had.
#[test]
fn both_feedforwards_are_had_on_the_closed_loop() {
    let mut specification = weights();
    for part in [&mut specification.heave, &mut specification.pitch] {
        part.as_mut().unwrap().basis = FeedforwardBasis::ClosedLoop;
    }
    let design = design_controller(&rig(), &specification);
    assert!(design.warnings.iter().any(|finding| matches!(
        finding.cause,
        Cause::Specification(SpecificationCause::FreeControlUnseen { .. })
    )));
    let sampled = discretise(&design, &Sampling::new(1e-3, 10.0)).unwrap();
    assert!(sampled.closed_loop.iter().all(|pole| pole.norm() < 1.0));
    assert!(design.worst_cost_difference().unwrap() < 1e-6, "{:?}", design.worst_cost_difference());
    let anew = Sampling { method: SamplingMethod::SampledData, ..Sampling::new(1e-3, 10.0) };
    assert!(discretise(&design, &anew).is_ok());
}

/// The residual of an expected motion is that of the assembly that runs: in Grimble's the feedback is told what to expect,
/// and leaves it to the feedforward.
#[test]
fn the_residual_is_that_of_the_assembly() {
    let of = |assembly| {
        let design = design_controller(&rig(), &Specification { assembly, ..weights() });
        [DisturbanceChannel::Heave, DisturbanceChannel::Pitch]
            .map(|c| stabilisation_error(&design.plant, &design, c, 1.0).unwrap())
    };
    let (added, apart) = (of(Assembly::SimpleAdd), of(Assembly::Grimble));
    println!("{added:?} {apart:?}");
    assert!((apart[0] / added[0] - 1.0).abs() > 0.02, "{added:?} {apart:?}");
}
