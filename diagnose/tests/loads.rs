//! Equilibrator, recoil and the fold-back of the drive in recordings: each is found again from a model in which it has another value or none.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::controller;
use counterpoise_diagnose::fitting::output_error::{FitSelection, Problem};
use counterpoise_diagnose::library::{Component, EffectName, find_effects};
use counterpoise_diagnose::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use counterpoise_models::loads::equilibrator::{Equilibrator, Force};
use counterpoise_models::loads::{EndStops, Recoil};
use counterpoise_models::{Parameters, Plant, reference};
use counterpoise_pool::Serial;
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::ReplayLoop;
use counterpoise_simulate::{Detail, Firing, Imperfections, Scenario, Signal, Simulator};

/// Control that holds the rig's weight, V.
const BIAS_V: f64 = 2.88;

fn recording(machine: &Parameters, seed: u64, period_s: f64) -> Recording {
    let mut simulator = Simulator::new(&Plant::from_lumped(machine).unwrap()).unwrap();
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.15, period_s },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        firing: Firing::Stated,
        ..Scenario::at_rest(6.0)
    };
    let history = simulator.run(&mut controller(BIAS_V), &scenario).unwrap();
    history.readings.recording("triangle", 1e-3)
}

/// Returns the value of an effect's only parameter that recordings of a machine give, fitted from a model.
fn fitted_value(component: Component, effect: EffectName, truth: &Parameters, model: &Parameters) -> f64 {
    let recordings = [recording(truth, 1, 2.0), recording(truth, 2, 0.5)];
    let prepared = PreparedRecordings::new(&recordings, model);
    let simulator = RecordingReplays::new(model, &ReplayLoop::from(&controller(BIAS_V)), &prepared).unwrap();
    let effects: Vec<_> = find_effects(component, effect).collect();
    let start = effects[0].values(model);
    let selection = FitSelection::all(recordings.len());
    let problem = Problem {
        simulator: &simulator,
        pool: &Serial,
        selection: &selection,
        base: model,
        effects: effects.clone(),
        assessments: &[],
        preferences: &[],
    };
    let fit = problem.fit(&start).unwrap();
    effects[0].values(&fit.parameters)[0]
}

fn with(change: impl FnOnce(&mut Parameters)) -> Parameters {
    let mut p = reference::rig();
    change(&mut p);
    p
}

#[test]
fn a_weaker_equilibrator_is_found() {
    let machine = |factor: f64| {
        with(|p| {
            p.loads.equilibrator = Some(Equilibrator {
                arm_m: 0.4,
                arm_angle_rad: 0.0,
                anchor_m: 0.9,
                anchor_angle_rad: 1.5,
                factor,
                force: Force::Spring { stiffness_n_m: 2e3, free_length_m: 0.5 },
            });
        })
    };
    for model in [1.0, 0.0] {
        let factor =
            fitted_value(Component::Structure, EffectName::Equilibrator, &machine(0.85), &machine(model));
        assert!((factor / 0.85 - 1.0).abs() < 0.05, "{model}: {factor}");
    }
}

#[test]
fn the_height_of_the_recoil_is_found() {
    let machine = |height_m: f64| {
        with(|p| {
            p.loads.recoil = Some(Recoil {
                shots_s: vec![1.2, 2.9, 4.4],
                impulse_ns: 1000.0,
                shot_time_s: 0.006,
                mass_kg: 60.0,
                length_m: 0.3,
                run_out_s: 0.4,
                height_m,
                bore_offset_m: 0.0,
                ahead_m: 0.5,
            });
        })
    };
    let height = fitted_value(Component::Structure, EffectName::Recoil, &machine(0.04), &machine(0.0));
    assert!((height - 0.04).abs() < 2e-3, "{height}");
}

#[test]
fn a_stiffer_stop_is_found() {
    let machine = |stiffness_nm_rad: f64| {
        with(|p| {
            p.loads.end_stops = Some(EndStops {
                lower_rad: -0.02,
                upper_rad: 0.05,
                stiffness_nm_rad,
                dissipation_s_rad: 1.0,
            });
        })
    };
    let stiffness = fitted_value(Component::Structure, EffectName::EndStops, &machine(6e4), &machine(3e4));
    assert!((stiffness / 6e4 - 1.0).abs() < 0.05, "{stiffness}");
}

#[test]
fn another_fold_back_is_found() {
    let machine = |continuous_current_a: f64| {
        with(|p| {
            // the weight takes 8.7 A, quick reversals 11 A: the peak current and the fold-back both bind
            p.amplifier.current_limit_a = 10.5;
            (p.drive_limits.continuous_current_a, p.drive_limits.overload_time_s) =
                (continuous_current_a, 0.5);
        })
    };
    let current =
        fitted_value(Component::Amplifier, EffectName::ContinuousCurrent, &machine(9.2), &machine(8.95));
    assert!((current / 9.2 - 1.0).abs() < 0.01, "{current}");
}
