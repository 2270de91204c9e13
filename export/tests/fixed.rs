//! Fixed point and single precision: never further from the reference than predicted; fixed C equals its reference.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::path::PathBuf;
use std::process::Command;

use counterpoise_controller::{Controller, READINGS};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::{
    FixedError, FixedPointController, FixedRunner, Ranges, fixed_c99, plan_fixed_point, single_precision,
    vectors::LARGEST,
};
use support::{
    RandomGenerator, Request, STRICT, assert_answers, folder, is_there, projecting_controller, provenance,
    random_controller, run, server_in, typical_controller, write,
};

const SAMPLES: usize = 2000;
/// Samples of a run of a random controller.
const FEW: usize = 250;

/// Returns readings as of a loop at work: a slow and a fast part, well inside the converters.
fn history(seed: u64, size: f64) -> Vec<[f64; READINGS]> {
    let mut random = RandomGenerator(seed);
    let mut slow = [0.0; READINGS];
    (0..SAMPLES)
        .map(|_| {
            let fast = random.readings();
            std::array::from_fn(|i| {
                slow[i] = 0.99 * slow[i] + 0.1 * fast[i];
                size * (0.7 * slow[i] + 0.3 * fast[i]).clamp(-LARGEST[i], LARGEST[i])
            })
        })
        .collect()
}

fn ranges(controller: &Controller, size: f64, margin: f64) -> Ranges {
    let histories = [history(3, size), history(4, size), history(5, size)];
    Ranges::from_readings(controller, &histories, margin)
}

/// Returns the largest and RMS deviation from the reference, and whether the limiter stayed out of it.
fn measure(
    controller: &Controller,
    other: &mut dyn FnMut(&[f64; READINGS]) -> f64,
    size: f64,
) -> (f64, f64, bool) {
    let mut reference = controller.runner();
    let (mut worst, mut squares, mut free) = (0.0_f64, 0.0, true);
    for readings in history(11, size) {
        let expected = reference.step_array(&readings);
        let deviation = other(&readings) - expected;
        worst = worst.max(deviation.abs());
        squares += deviation * deviation;
        free &= expected.abs() < controller.limit_v();
    }
    (worst, (squares / SAMPLES as f64).sqrt(), free)
}

#[test]
fn the_typical_controller_in_fixed_point_keeps_its_prediction() {
    keeps_its_prediction(&typical_controller());
}

#[test]
fn heave_and_surge_projected_in_fixed_point_keep_their_prediction() {
    keeps_its_prediction(&projecting_controller());
}

fn keeps_its_prediction(controller: &Controller) {
    let fixed = plan_fixed_point(controller, &ranges(controller, 0.05, 4.0), 2.5e-3, SAMPLES).unwrap();
    let mut runner = FixedRunner::new(&fixed);
    let (worst, rms, free) = measure(controller, &mut |readings| runner.step_array(readings), 0.05);
    let predicted = fixed.deviation;
    println!(
        "fixed: worst {worst:.2e} of {:.2e} V, RMS {rms:.2e} of {:.2e} V",
        predicted.worst_v, predicted.rms_v
    );
    assert!(free && worst > 0.0 && worst <= predicted.worst_v);
    assert!(rms < 3.0 * predicted.rms_v && rms > 0.02 * predicted.rms_v);
}

#[test]
fn the_typical_controller_in_single_precision_keeps_its_prediction() {
    let controller = typical_controller();
    let predicted = single_precision(&controller, &ranges(&controller, 0.05, 1.5), SAMPLES);
    let mut runner = controller.runner_in::<f32>();
    let (worst, rms, free) = measure(&controller, &mut |readings| runner.step_array(readings), 0.05);
    println!(
        "single: worst {worst:.2e} of {:.2e}, likely {:.2e} V, RMS {rms:.2e} of {:.2e} V",
        predicted.worst_v, predicted.likely_v, predicted.rms_v
    );
    assert!(free && worst <= predicted.likely_v && predicted.likely_v <= predicted.worst_v);
    assert!(worst > 0.05 * predicted.likely_v, "the prediction is loose");
    assert!(rms < 3.0 * predicted.rms_v && rms > 0.1 * predicted.rms_v);
}

/// The outcome of a random controller in fixed point and in single precision.
#[derive(Debug, Default)]
struct Score {
    kept: usize,
    refused: Vec<String>,
    refused_though_stable: usize,
    single: Vec<f64>,
    fixed: Vec<f64>,
}

impl Score {
    fn of(seeds: impl Iterator<Item = u64>) -> Self {
        seeds.fold(Self::default(), |mut score, seed| {
            score.add(seed);
            score
        })
    }

    fn add(&mut self, seed: u64) {
        let controller = random_controller(seed);
        let known = Ranges::from_readings(&controller, &[few_readings(3)], 4.0);
        match plan_fixed_point(&controller, &known, 5e-3, FEW) {
            Ok(fixed) => {
                let found = known.measure(&|| Box::new(FixedRunner::new(&fixed)));
                let predicted = fixed.deviation;
                assert!(found.largest_v <= predicted.likely_v, "{seed}: {found:?} {predicted:?}");
                assert!(predicted.likely_v <= predicted.worst_v);
                self.kept += 1;
                self.fixed.push(predicted.likely_v / found.largest_v);
            }
            Err(why) => {
                if let FixedError::TooCoarse { worst_v, allowed_v, .. } = why {
                    assert!(worst_v > allowed_v);
                }
                let stable = is_stable(&controller);
                assert!(!(stable && matches!(why, FixedError::Unstable { .. })), "{seed}: {why}");
                self.refused.push(format!("{seed}: {why}"));
                self.refused_though_stable += usize::from(stable);
            }
        }
        let single = single_precision(&controller, &known, FEW);
        let found = known.measure(&|| Box::new(controller.runner_in::<f32>()));
        assert!(found.largest_v <= single.likely_v, "{seed}: {found:?} {single:?}");
        if found.largest_v > 0.0 && single.likely_v.is_finite() {
            self.single.push(single.likely_v / found.largest_v);
        }
    }
}

/// Returns a short run of small readings.
fn few_readings(seed: u64) -> Vec<[f64; READINGS]> {
    history(seed, 0.02)[..FEW].to_vec()
}

/// Five of each order from 1 to 40, two of them full and in units from 1e-8 to 1e8.
#[test]
fn random_controllers_keep_their_prediction_or_are_refused() {
    let halves: Vec<Score> = std::thread::scope(|scope| {
        let start = |half: u64| scope.spawn(move || Score::of((0..200).filter(move |seed| seed % 2 == half)));
        [start(0), start(1)].into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let sum = |count: fn(&Score) -> usize| halves.iter().map(count).sum::<usize>();
    let all = |of: fn(&Score) -> &Vec<f64>| median(halves.iter().flat_map(|h| of(h).clone()).collect());
    let (kept, refused) = (sum(|s| s.kept), sum(|s| s.refused.len()));
    println!("{kept} keep their bound, {refused} refused:");
    halves.iter().flat_map(|half| &half.refused).for_each(|why| println!("  {why}"));
    let (single, fixed) = (all(|s| &s.single), all(|s| &s.fixed));
    println!("likely over measured, median: single {single:.1}, fixed {fixed:.1}");
    assert_eq!(kept + refused, 200);
    assert!(kept > 120 && sum(|s| s.refused_though_stable) <= 6, "{halves:?}");
    assert!(single < 20.0 && fixed < 20.0);
}

/// Returns whether the controller by itself, with every out-of-balance at which a gain has a corner, forgets
/// what was.
fn is_stable(controller: &Controller) -> bool {
    let (low, high) = controller.parts().out_of_balance_range_kg_m;
    let settings = [low, 90.0, controller.parts().design_out_of_balance_kg_m, high];
    settings.into_iter().all(|set| {
        let poles = counterpoise_lti::poles(&controller.linear(set).unwrap()).unwrap();
        poles.iter().all(|pole| pole.norm() < 1.0 + 1e-9)
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn what_cannot_be_planned_says_why() {
    let controller = typical_controller();
    let still = Ranges::from_readings(&controller, &[vec![[0.0; READINGS]; 10]], 4.0);
    assert!(matches!(plan_fixed_point(&controller, &still, 1.0, 10), Err(FixedError::NeverMoved { .. })));
    let known = ranges(&controller, 0.05, 4.0);
    let refused = plan_fixed_point(&controller, &known, 1e-12, SAMPLES);
    assert!(matches!(refused, Err(FixedError::TooCoarse { allowed_v: 1e-12, .. })));
}

fn build(test: &str, plans: &[FixedPointController], flags: &[&str]) -> PathBuf {
    let folder = folder(test);
    let mut names = Vec::new();
    let mut sources = vec!["server.c".to_owned()];
    for (i, fixed) in plans.iter().enumerate() {
        let name = format!("controller_{i}");
        write(&folder, &fixed_c99(Unverified(&fixed.controller), fixed, &provenance(), &name).unwrap());
        sources.push(format!("{name}.c"));
        names.push(name);
    }
    std::fs::write(folder.join("server.c"), server_in(&names, |_| "int32_t".into())).unwrap();
    run(Command::new("cc").current_dir(&folder).args(flags).args(&sources).args(["-o", "server"]));
    folder.join("server")
}

/// Integers of any size in every reading, settings and resets, against the C with every overflow trapped: 16 random controllers, or 40 with
/// `EVERY_CONTROLLER` set, as in `.ci/evidence`.
#[test]
fn fixed_c_equals_its_reference_and_never_overflows() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let random = if std::env::var_os("EVERY_CONTROLLER").is_some() { 40 } else { 16 };
    let controllers: Vec<Controller> = [typical_controller(), projecting_controller()]
        .into_iter()
        .chain((0..random).map(random_controller))
        .collect();
    let known =
        |controller: &Controller| Ranges::from_readings(controller, &[few_readings(3), few_readings(4)], 4.0);
    let planned = |controller: &Controller| plan_fixed_point(controller, &known(controller), 1.0, FEW);
    let plans: Vec<FixedPointController> =
        controllers.iter().filter_map(|controller| planned(controller).ok()).collect();
    assert!(2 * plans.len() >= controllers.len(), "{} of {}", plans.len(), controllers.len());
    let trap =
        ["-fsanitize=undefined", "-fno-sanitize-recover=all", "-std=c99", "-Wall", "-Wextra", "-Wconversion"];
    let program = build("fixed_trapped", &plans, &[&trap[..], &["-Werror", "-pedantic"]].concat());
    let mut random = RandomGenerator(5);
    let mut asked = Vec::new();
    for k in 0..200 {
        for which in 0..plans.len() {
            if k % 40 == 17 {
                asked.push((which, Request::Set((random.signed_unit() * 2147483647.0).round())));
            }
            let size = [2147483647.0, 1e9, 1e7, 1e5][k % 4];
            asked
                .push((which, Request::Step(std::array::from_fn(|_| (random.signed_unit() * size).round()))));
        }
    }
    assert_answers(&plans, &program, &asked);
}

#[test]
fn shipped_fixed_point_compiles_in_silence_and_passes() {
    for compiler in ["gcc", "clang"] {
        if !is_there(compiler) {
            support::report_skip(&format!("no {compiler}"));
            continue;
        }
        let folder = folder(&format!("fixed_{compiler}"));
        let controller = typical_controller();
        let fixed = plan_fixed_point(&controller, &ranges(&controller, 0.05, 4.0), 2.5e-3, SAMPLES).unwrap();
        write(&folder, &fixed_c99(Unverified(&fixed.controller), &fixed, &provenance(), "axis").unwrap());
        let sources = ["axis.c", "axis_self_test.c", "axis_test.c", "-o", "axis_test"];
        let said = run(Command::new(compiler).current_dir(&folder).args(STRICT).args(sources));
        assert_eq!(said, "");
        let interrupt = ["-c", "axis_interrupt.c"];
        assert_eq!(run(Command::new(compiler).current_dir(&folder).args(STRICT).args(interrupt)), "");
        let outcome = run(&mut Command::new(folder.join("axis_test")));
        assert!(outcome.contains("48 samples equal to the last bit"), "{outcome}");
    }
}
