//! Readings and settings that cannot be right: the code answers as the reference does, to the last bit, its control stays finite
//! and within its limits, and a reset cures everything.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::process::Command;

use counterpoise_controller::guard::{ALONE, REFUSED, REPLACED, RESTARTED, UNCHANGED};
use counterpoise_controller::{Controller, Parts, PathSignal, READINGS, SampledController, SensorUse};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::{CodeOptions, FixedRunner, Ranges, c99, fixed_c99, plan_fixed_point, rust_crate};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use support::{
    RandomGenerator, Request, STRICT, Target, complete_controller, equal_to_the_last_bit, folder, is_there,
    path, provenance, random_controller, reference, requests, run, server, server_in, typical_controller,
    write,
};

/// The fault that a broken sensor or wire makes of a reading.
const BROKEN: [f64; 9] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e9, -1e9, 1e300, -0.0, 1e-310, -3e-45];

/// Irregular requests of which one reading in ten is broken, and one setting in three.
fn faulty(controllers: usize, samples: usize) -> Vec<(usize, Request)> {
    let mut random = RandomGenerator(17);
    let mut asked = requests(controllers, samples);
    let mut broken = |value: &mut f64, share: f64| {
        if random.unit() < share {
            *value = BROKEN[(random.unit() * BROKEN.len() as f64) as usize];
        }
    };
    for (_, request) in &mut asked {
        match request {
            Request::Step(readings) => readings.iter_mut().for_each(|value| broken(value, 0.1)),
            Request::Set(value) => broken(value, 0.3),
            Request::Reset => {}
        }
    }
    asked
}

/// Returns the controllers that every block occurs in.
fn controllers() -> Vec<Controller> {
    [typical_controller(), complete_controller()].into_iter().chain((0..6).map(random_controller)).collect()
}

/// Every answer is finite and within the limit, as the target's numbers hold it.
fn all_within(limits: &[f64], asked: &[(usize, Request)], answers: &[f64]) {
    for ((which, _), control) in asked.iter().zip(answers) {
        assert!(control.abs() <= limits[*which], "{control} {}", limits[*which]);
    }
}

#[test]
fn c_answers_broken_readings_as_the_reference_does() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let controllers = controllers();
    let asked = faulty(controllers.len(), 1500);
    for (kind, options) in
        [("double", CodeOptions::double as fn(&str) -> CodeOptions), ("single", CodeOptions::single)]
    {
        let folder = folder(&format!("faulty_{kind}"));
        let mut names = Vec::new();
        for (i, controller) in controllers.iter().enumerate() {
            let name = format!("controller_{i}");
            // What single precision cannot hold has no form in it.
            let files = c99(Unverified(controller), &provenance(), &options(&name)).unwrap();
            write(&folder, &files);
            names.push(name);
        }
        std::fs::write(folder.join("server.c"), server(&names)).unwrap();
        let sources: Vec<String> = names.iter().map(|name| format!("{name}.c")).collect();
        let flags: Vec<&str> = STRICT.into_iter().filter(|flag| *flag != "-Wdouble-promotion").collect();
        run(Command::new("cc").current_dir(&folder).args(flags).arg("server.c").args(&sources).args([
            "-fsanitize=undefined",
            "-fno-sanitize-recover=undefined",
            "-o",
            "server",
        ]));
        let answers = Target::start(&folder.join("server")).ask_all(&asked);
        let held = |limit: f64| if kind == "double" { limit } else { f64::from(limit as f32) };
        let limits: Vec<f64> = controllers.iter().map(|controller| held(controller.limit_v())).collect();
        all_within(&limits, &asked, &answers);
        let expected = match kind {
            "double" => reference::<f64>(&controllers, &asked),
            _ => reference::<f32>(&controllers, &asked),
        };
        equal_to_the_last_bit(&answers, &expected);
    }
}

#[test]
fn fixed_point_answers_any_integer_as_its_reference_does() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let mut random = RandomGenerator(3);
    let history: Vec<[f64; READINGS]> =
        (0..2000).map(|_| random.readings().map(|value| 0.05 * value)).collect();
    let controller = typical_controller();
    let fixed =
        plan_fixed_point(&controller, &Ranges::from_readings(&controller, &[history], 4.0), 1e-2, 2000)
            .unwrap();
    let folder = folder("faulty_fixed");
    write(&folder, &fixed_c99(Unverified(&controller), &fixed, &provenance(), "axis").unwrap());
    std::fs::write(folder.join("server.c"), server_in(&["axis".into()], |_| "int32_t".into())).unwrap();
    let flags =
        ["-fsanitize=undefined", "-fno-sanitize-recover=undefined", "server.c", "axis.c", "-o", "server"];
    run(Command::new("cc").current_dir(&folder).args(STRICT).args(flags));
    let extreme = [f64::from(i32::MIN), f64::from(i32::MAX), -f64::from(i32::MAX), 0.0];
    let mut integer = || match random.unit() {
        share if share < 0.2 => extreme[(20.0 * share) as usize],
        _ => (random.signed_unit() * 2f64.powi(31)).trunc().clamp(f64::from(i32::MIN), f64::from(i32::MAX)),
    };
    let asked: Vec<(usize, Request)> = (0..20_000)
        .map(|k| match k % 50 {
            7 => (0, Request::Set(integer())),
            33 => (0, Request::Reset),
            _ => (0, Request::Step(std::array::from_fn(|_| integer()))),
        })
        .collect();
    support::assert_answers(std::slice::from_ref(&fixed), &folder.join("server"), &asked);
    let mut runner = FixedRunner::new(&fixed);
    runner.set_out_of_balance(f64::NAN);
    for value in BROKEN {
        assert!(runner.step_array(&[value; READINGS]).abs() <= controller.limit_v());
    }
    assert_eq!(runner.status().flags & REPLACED, 0);
    runner.step_array(&[f64::NAN; READINGS]);
    assert_eq!(runner.status().flags & REPLACED, REPLACED);
}

/// After a reset the controller answers as a new one, whatever was done to it before.
#[test]
fn a_reset_cures_everything() {
    for controller in controllers() {
        let mut fresh = controller.runner();
        let mut cured = controller.runner();
        for (_, request) in faulty(1, 400) {
            match request {
                Request::Set(value) => cured.set_out_of_balance(value),
                Request::Step(readings) => {
                    cured.step_array(&readings);
                }
                Request::Reset => {}
            }
        }
        cured.reset();
        assert_eq!(cured.status(), Default::default());
        assert_eq!(cured.states(), fresh.states());
        let mut random = RandomGenerator(5);
        for _ in 0..50 {
            let readings = random.readings();
            let (a, b) = (cured.step_array(&readings), fresh.step_array(&readings));
            assert_eq!(a.to_bits(), b.to_bits());
            assert!(a.abs() <= controller.limit_v());
        }
    }
}

#[test]
fn flags_and_counts_say_what_happened() {
    let mut runner = typical_controller().runner();
    let good = [0.1, 0.1, 0.02, 0.5, 1.0, 0.01, 0.0];
    runner.step_array(&good);
    assert_eq!((runner.status().flags & REPLACED, runner.status().replaced), (0, 0));
    let mut bad = good;
    (bad[1], bad[4]) = (f64::NAN, 1e9);
    runner.step_array(&bad);
    assert_eq!((runner.status().flags & REPLACED, runner.status().replaced), (0b01_0010, 2));
    runner.set_out_of_balance(f64::INFINITY);
    runner.step_array(&good);
    assert_eq!((runner.status().flags & REPLACED, runner.status().flags & REFUSED), (0, REFUSED));
    (0..1000).for_each(|_| {
        runner.step_array(&good);
    });
    assert_eq!(runner.status().flags & UNCHANGED, UNCHANGED);
    runner.reset();
    assert_eq!(runner.status().flags, 0);
}

/// A controller that grows without bound by itself goes back to its start, and says so.
#[test]
fn states_that_run_away_are_put_back() {
    let one = |x: f64| Mat::from_rows(&[&[x]]);
    let timebase = Timebase::Discrete { period_s: 1e-3 };
    let mut parts = Parts::new(1e-3, 10.0);
    let system = StateSpace::new(one(1.5), one(1.0), one(1.0), one(0.0), timebase).unwrap();
    parts.paths.push(path("wild", vec![PathSignal::RateError], system));
    let controller = Controller::new(parts).unwrap();
    let (mut double, mut single) = (controller.runner(), controller.runner_in::<f32>());
    let mut restarts = 0;
    for _ in 0..5000 {
        let readings = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for control in [double.step_array(&readings), single.step_array(&readings)] {
            assert!(control.abs() <= 10.0);
        }
        restarts += u32::from(double.status().flags & RESTARTED != 0);
    }
    assert!(restarts > 0);
}

/// After a handover the controller is the one that is certified for it, and neither way the control makes a step.
#[test]
fn a_handover_ends_at_feedback_alone() {
    let controller = typical_controller();
    let (mut runner, mut certified) = (controller.runner(), controller.feedback_alone().unwrap().runner());
    let readings =
        |k: usize| [0.02, 0.018, 0.05, 1.0, 3.0, 0.01, 0.0].map(|x: f64| x * (0.01 * k as f64).cos());
    let mut largest = 0.0_f64;
    let mut before = runner.step_array(&readings(0));
    certified.step_array(&readings(0));
    for k in 1..20_000 {
        if k == 2000 {
            runner.use_sensors(SensorUse::FeedbackAlone);
        }
        let control = runner.step_array(&readings(k));
        let alone = certified.step_array(&readings(k));
        largest = largest.max((control - before).abs());
        before = control;
        if k > 18_000 {
            assert_eq!(runner.status().flags & ALONE, ALONE);
            assert!((control - alone).abs() < 1e-3, "{k}: {control} {alone}");
        }
    }
    assert!(largest < 2.0, "{largest}");
}

/// Numbers that decay at rest become 0 before they are subnormal.
#[test]
fn nothing_subnormal_is_left_at_rest() {
    for controller in controllers() {
        let (mut double, mut single) = (controller.runner(), controller.runner_in::<f32>());
        double.step_array(&[0.1; READINGS]);
        single.step_array(&[0.1; READINGS]);
        for _ in 0..20_000 {
            double.step_array(&[1e-310; READINGS]);
            single.step_array(&[1e-310; READINGS]);
            assert!(double.states().iter().all(|state| !state.is_subnormal()));
            assert!(single.states().iter().all(|state| !(*state as f32).is_subnormal()));
        }
    }
}

/// Clippy finds nothing in the generated crates, with all of its default lints as errors.
#[test]
fn generated_crates_are_clean_for_clippy() {
    if !Command::new("cargo").args(["clippy", "--version"]).output().is_ok_and(|o| o.status.success()) {
        return support::report_skip("no cargo clippy");
    }
    let folder = folder("clippy");
    for (name, controller) in [("plain", typical_controller()), ("every_block", complete_controller())] {
        for (numbers, options) in
            [("double", CodeOptions::double(name)), ("single", CodeOptions::single(name))]
        {
            let place = folder.join(numbers);
            write(&place, &rust_crate(Unverified(&controller), &provenance(), &options).unwrap());
            let mut clippy = Command::new("cargo");
            clippy.current_dir(place.join(name)).env("CARGO_TARGET_DIR", folder.join("target"));
            clippy.args(["clippy", "--offline", "--all-targets", "--", "-D", "warnings"]);
            run(&mut clippy);
        }
    }
}
