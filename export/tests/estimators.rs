//! Estimators of the out-of-balance in fixed point and single precision: their divisors are proven, their rounding is
//! predicted along the run, and their C never overflows.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::process::Command;

use counterpoise_controller::{Controller, Estimator, Learning, Parts, PathSignal, READINGS, Scaling};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::{
    Deviation, FixedRunner, MeasuredDeviation, Ranges, fixed_c99, plan_fixed_point, single_precision,
};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use support::{
    RandomGenerator, Request, assert_answers, folder, is_there, path, provenance, run, server_in, write,
};

const SAMPLES: usize = 6000;
const GRAVITY: f64 = 9.80665;
const VOLTS_PER_KG_M: f64 = 0.019;

/// Feedback with an integrator, heave that scales and an estimator.
fn estimating(learning: Learning, gravity_m_s2: f64) -> Controller {
    let timebase = Timebase::Discrete { period_s: 1e-3 };
    let one = |x: f64| Mat::from_rows(&[&[x]]);
    let integrator = StateSpace::new(one(1.0), one(0.02), one(1.0), one(9.0), timebase).unwrap();
    let lag = StateSpace::new(one(0.97), one(0.03), one(-0.2), one(0.0), timebase).unwrap();
    let mut parts = Parts::new(1e-3, 10.0);
    let mut heave = path("heave", vec![PathSignal::PlatformAcceleration], lag);
    heave.scaling = Scaling::WithOutOfBalance;
    parts.paths = vec![path("feedback", vec![PathSignal::RateError], integrator), heave];
    parts.design_out_of_balance_kg_m = 120.0;
    parts.out_of_balance_range_kg_m = (-400.0, 400.0);
    parts.bias_v_per_kg_m = if gravity_m_s2 == 0.0 { 0.0 } else { VOLTS_PER_KG_M };
    parts.transfer_time_s = 0.2;
    parts.estimator = Some(Estimator {
        learning,
        gravity_m_s2,
        rate: PathSignal::RelativeRate,
        half_rate_rad_s: 0.01,
        volts_per_kg_m_s2: VOLTS_PER_KG_M / GRAVITY,
        rate_limit_kg_m_s: 200.0,
        hold_band_kg_m: 0.0,
        follow_samples: 0,
        hold_samples: 300,
    });
    Controller::new(parts).unwrap()
}

fn kinds() -> Vec<(&'static str, Controller)> {
    let squares = || Learning::Squares {
        forget: 0.9995,
        dead_band_m_s2: 0.2,
        deviation: [0.1, 0.5, 0.5, 0.5],
        filter_s: 0.02,
        inertia_v_s2_rad: [0.05, 0.01],
    };
    vec![
        ("mean", estimating(Learning::Mean { window_samples: 1000 }, GRAVITY)),
        ("squares", estimating(squares(), GRAVITY)),
        ("squares in azimuth", estimating(squares(), 0.0)),
        ("gradient", estimating(Learning::Gradient { step: 0.01, scale: [0.02, 0.1, 0.1] }, GRAVITY)),
    ]
}

/// Returns a platform that heaves and pitches under a hub that is held, with noise; the rate error drives the control
/// slowly.
fn motion(seed: u64) -> Vec<[f64; READINGS]> {
    let mut random = RandomGenerator(seed);
    let mut noise = |size: f64| size * random.signed_unit();
    (0..SAMPLES)
        .map(|k| {
            let t = k as f64 * 1e-3;
            let heave = 2.0 * (9.4 * t).sin() + noise(0.01);
            let pitch = 0.2 * (6.3 * t).sin() + noise(4e-4);
            let hub = 0.01 * (1.1 * t).cos() + 2e-3 * (9.4 * t).sin() + noise(4e-4);
            [0.0, hub, pitch, heave, -200.0 * pitch, 0.03 * (6.3 * t).cos(), 0.0]
        })
        .collect()
}

fn ranges(controller: &Controller) -> Ranges {
    Ranges::from_readings(controller, &[motion(3)], 4.0)
}

fn holds(name: &str, found: MeasuredDeviation, predicted: &Deviation) {
    let (largest, rms) = (found.largest_v, found.rms_v);
    let ratio = predicted.likely_v / largest;
    println!(
        "{name}: {largest:.1e} V of {:.1e} ({ratio:.1}), RMS {rms:.1e} of {:.1e}",
        predicted.likely_v, predicted.rms_v
    );
    assert!(largest <= predicted.likely_v && ratio < 20.0, "{name}");
    assert!(rms < 3.0 * predicted.rms_v, "{name}");
}

#[test]
fn every_estimator_keeps_the_prediction_along_its_run() {
    for (name, controller) in kinds() {
        let known = ranges(&controller);
        let mut moved = controller.runner();
        motion(3).iter().for_each(|readings| {
            moved.step_array(readings);
        });
        assert!((moved.state(0).unwrap() - 120.0).abs() > 1.0, "{name} has learnt nothing");
        let found = known.measure(&|| Box::new(controller.runner_in::<f32>()));
        holds(&format!("{name}, single"), found, &single_precision(&controller, &known, SAMPLES));
        let fixed = plan_fixed_point(&controller, &known, 5e-3, SAMPLES)
            .unwrap_or_else(|why| panic!("{name}: {why}"));
        let found = known.measure(&|| Box::new(FixedRunner::new(&fixed)));
        holds(&format!("{name}, fixed"), found, &fixed.deviation);
    }
}

/// Integers of any size, settings and resets, with every overflow and every division by 0 trapped.
#[test]
fn no_reading_brings_a_divisor_to_0() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let folder = folder("estimators_trapped");
    let plans: Vec<_> = kinds()
        .into_iter()
        .map(|(_, controller)| plan_fixed_point(&controller, &ranges(&controller), 5e-3, SAMPLES).unwrap())
        .collect();
    let names: Vec<String> = (0..plans.len()).map(|i| format!("estimator_{i}")).collect();
    for (fixed, name) in plans.iter().zip(&names) {
        write(&folder, &fixed_c99(Unverified(&fixed.controller), fixed, &provenance(), name).unwrap());
    }
    std::fs::write(folder.join("server.c"), server_in(&names, |_| "int32_t".into())).unwrap();
    let flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic"];
    let trap = ["-fsanitize=undefined", "-fno-sanitize-recover=all", "server.c", "-o", "server"];
    let sources = names.iter().map(|name| format!("{name}.c"));
    run(Command::new("cc").current_dir(&folder).args(flags).args(trap).args(sources));
    let mut random = RandomGenerator(5);
    let mut asked = Vec::new();
    for k in 0..1500 {
        for which in 0..plans.len() {
            match k % 500 {
                117 => asked.push((which, Request::Set((random.signed_unit() * 2147483647.0).round()))),
                400 => asked.push((which, Request::Reset)),
                _ => {}
            }
            let size = [2147483647.0, 1e9, 1e7, 0.0][(k / 50) % 4];
            asked
                .push((which, Request::Step(std::array::from_fn(|_| (random.signed_unit() * size).round()))));
        }
    }
    assert_answers(&plans, &folder.join("server"), &asked);
}
