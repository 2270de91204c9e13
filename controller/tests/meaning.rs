//! The meaning of a controller, whatever carries it out.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_controller::{
    Controller, Correction, Error, Estimator, FrictionObserver, Learning, ObserverLaw, Parts, Path,
    PathSignal, READINGS, Runner, SampledController, Scaling,
};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

const T: f64 = 1e-3;

fn system(A: Mat, B: Mat, C: Mat, D: Mat) -> StateSpace {
    StateSpace::new(A, B, C, D, Timebase::Discrete { period_s: T }).unwrap()
}

fn one(x: f64) -> Mat {
    Mat::from_rows(&[&[x]])
}

fn path(name: &str, inputs: Vec<PathSignal>, system: StateSpace) -> Path {
    let anti_windup = vec![0.0; system.order()];
    Path { name: name.into(), inputs, system, anti_windup, scaling: Scaling::Fixed }
}

/// Feedback of order 3, heave feedforward of order 2 that scales, prefilter of order 1, bias.
fn parts() -> Parts {
    let mut parts = Parts::new(T, 10.0);
    parts.design_out_of_balance_kg_m = 150.0;
    parts.out_of_balance_range_kg_m = (-300.0, 300.0);
    parts.bias_v_per_kg_m = 0.019;
    parts.prefilter = Some(system(one(0.9), one(0.1), one(1.0), one(0.0)));
    let A = Mat::from_rows(&[&[1.0, 0.0, 0.0], &[0.0, 0.8, 0.3], &[0.0, -0.3, 0.8]]);
    let B = Mat::from_rows(&[&[1e-3, -1e-3], &[0.2, -0.1], &[0.05, 0.4]]);
    let C = Mat::from_rows(&[&[80.0, 1.0, -2.0]]);
    let mut feedback = path(
        "feedback",
        vec![PathSignal::Demand, PathSignal::HubRate],
        system(A, B, C, Mat::from_rows(&[&[3.0, -3.0]])),
    );
    feedback.anti_windup = vec![0.01, 0.0, 0.0];
    let A = Mat::from_rows(&[&[0.7, 0.1], &[-0.1, 0.7]]);
    let heave_system =
        system(A, Mat::from_rows(&[&[0.1], &[0.2]]), Mat::from_rows(&[&[0.3, -0.1]]), one(0.0));
    let mut heave = path("heave", vec![PathSignal::PlatformAcceleration], heave_system);
    heave.scaling = Scaling::WithOutOfBalance;
    parts.paths = vec![feedback, heave];
    parts
}

fn readings(k: usize) -> [f64; READINGS] {
    std::array::from_fn(|j| 0.01 * ((k * (2 * j + 3)) % 17) as f64 - 0.08)
}

#[test]
fn the_linear_part_gives_what_the_runner_gives() {
    let controller = Controller::new(parts()).unwrap();
    let mut runner = controller.runner();
    runner.set_out_of_balance(100.0);
    let linear = controller.linear(100.0).unwrap();
    assert_eq!(linear.order(), 6);
    let mut x = Mat::zeros(linear.order(), 1);
    for k in 0..200 {
        let u = Mat::col(&readings(k)[..counterpoise_controller::COMMON_READINGS]);
        let y = (&(&linear.C * &x) + &(&linear.D * &u))[(0, 0)] + 0.019 * 100.0;
        x = &(&linear.A * &x) + &(&linear.B * &u);
        assert!((runner.step_array(&readings(k)) - y).abs() < 1e-12, "sample {k}");
    }
}

#[test]
fn the_limiter_holds_and_anti_windup_lets_go() {
    let mut parts = parts();
    parts.limit_v = 2.0;
    let wound = |parts: Parts| {
        let mut runner = Controller::new(parts).unwrap().runner();
        let error = |e: f64| [e, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for _ in 0..2000 {
            assert!(runner.step_array(&error(5.0)).abs() <= 2.0);
        }
        (0..4000).position(|_| runner.step_array(&error(-5.0)) <= 0.0).unwrap()
    };
    let mut without = parts.clone();
    without.paths[0].anti_windup = vec![0.0; 3];
    assert!(wound(parts) * 4 < wound(without));
}

#[test]
fn a_changed_out_of_balance_makes_no_step_and_then_has_its_effect() {
    let mut parts = parts();
    parts.transfer_time_s = 0.05;
    let mut runner = Controller::new(parts.clone()).unwrap().runner();
    let still = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let before = (0..300).map(|_| runner.step_array(&still)).last().unwrap();
    runner.set_out_of_balance(75.0);
    let first = runner.step_array(&still);
    assert!((first - before).abs() < 1e-12, "{first} {before}");
    let after = (0..5000).map(|_| runner.step_array(&still)).last().unwrap();
    assert!((after - before / 2.0).abs() < 1e-9, "{after} {before}");
    runner.set_out_of_balance(1e9);
    let held = (0..5000).map(|_| runner.step_array(&still)).last().unwrap();
    assert!((held - before * 2.0).abs() < 1e-9, "the range holds: {held} {before}");
}

#[test]
fn reset_puts_every_state_back_the_out_of_balance_too() {
    let controller = Controller::new(parts()).unwrap();
    let (mut used, mut fresh) = (controller.runner(), controller.runner());
    for k in 0..50 {
        used.step_array(&readings(k));
    }
    used.set_out_of_balance(20.0);
    assert_ne!(used.states(), controller.runner().states());
    used.reset();
    assert_eq!(used.states(), controller.runner().states());
    fresh.set_out_of_balance(20.0);
    used.set_out_of_balance(20.0);
    assert_eq!(used.states(), fresh.states());
}

/// Over a displacement from rest Dahl's friction is F_c (1 - exp(-sigma x / F_c)); the implicit step is first order.
#[test]
fn the_friction_observer_follows_dahl() {
    let error = |period: f64| {
        let mut parts = Parts::new(period, 10.0);
        parts.observers = vec![FrictionObserver {
            name: "pivot".into(),
            rate: PathSignal::HubRate,
            law: ObserverLaw::Dahl,
            level: Vec::new(),
            coulomb_nm: 117.0,
            rest_stiffness_nm_rad: 2.4e5,
            volts_per_nm: 1e-3,
            viscous_v_s_rad: 0.0,
        }];
        let mut runner = Controller::new(parts).unwrap().runner();
        let samples = (0.1 / period).round() as usize;
        let volts =
            (0..samples).map(|_| runner.step_array(&[0.0, 0.005, 0.0, 0.0, 0.0, 0.0, 0.0])).last().unwrap();
        (volts - 0.117 * (1.0 - (-2.4e5 * 0.0005 / 117.0_f64).exp())).abs()
    };
    let (coarse, fine) = (error(1e-3), error(1e-4));
    assert!(coarse < 1e-3 && fine < coarse / 8.0, "{coarse} {fine}");
}

/// A machine whose control is 0.002 M (g + a) plus dry friction: the estimate finds M although friction biases the mean.
#[test]
fn the_estimator_finds_the_out_of_balance_under_friction() {
    let mut parts = Parts::new(T, 10.0);
    parts.design_out_of_balance_kg_m = 150.0;
    parts.out_of_balance_range_kg_m = (0.0, 400.0);
    let heave = path(
        "held",
        vec![PathSignal::Demand],
        system(Mat::zeros(0, 0), Mat::zeros(0, 1), Mat::zeros(1, 0), one(1.0)),
    );
    parts.paths = vec![heave];
    parts.estimator = Some(Estimator {
        gravity_m_s2: 9.81,
        rate: PathSignal::HubRate,
        half_rate_rad_s: 0.01,
        learning: Learning::Gradient { step: 0.05, scale: [0.1, 1.0, 1.0] },
        hold_band_kg_m: 0.0,
        follow_samples: 0,
        hold_samples: 0,
        volts_per_kg_m_s2: 0.002,
        rate_limit_kg_m_s: 50.0,
    });
    let controller = Controller::new(parts).unwrap();
    let mut runner = controller.runner();
    let place = controller.programs().states.iter().find(|g| g.name == "out_of_balance_kg_m").unwrap().first;
    for k in 0..40_000 {
        let t = k as f64 * T;
        let (rate, accel) = (0.1 * (3.0 * t).sin() + 0.05, 2.0 * (7.0 * t).sin());
        let volts = 0.002 * 90.0 * (9.81 + accel) + 0.6 * rate / (rate.abs() + 0.01) + 0.3 * rate;
        runner.step_array(&[volts, rate, 0.0, accel, 0.0, 0.0, 0.0]);
    }
    let found = runner.states()[place];
    assert!((found - 90.0).abs() < 1.0, "{found}");
}

#[test]
fn single_precision_stays_near_the_reference() {
    let controller = Controller::new(parts()).unwrap();
    let (mut reference, mut single) = (controller.runner(), controller.runner_in::<f32>());
    let largest = (0..500)
        .map(|k| (reference.step_array(&readings(k)) - single.step_array(&readings(k))).abs())
        .fold(0.0, f64::max);
    assert!(largest > 0.0 && largest < 1e-5, "{largest}");
}

#[test]
fn corrections_come_before_everything() {
    let mut parts = parts();
    let mut plain: Runner = Controller::new(parts.clone()).unwrap().runner();
    parts.corrections = vec![Correction { reading: 1, gain: 0.5, offset: 0.25 }];
    let mut corrected: Runner = Controller::new(parts).unwrap().runner();
    for k in 0..20 {
        let raw = readings(k);
        let mut mended = raw;
        mended[1] = 0.25 + 0.5 * raw[1];
        assert_eq!(corrected.step_array(&raw), plain.step_array(&mended));
    }
}

#[test]
fn what_cannot_run_is_refused() {
    type Corruption = fn(&mut Parts);
    let cases: [(&str, Corruption); 16] = [
        ("sample period", |p| p.sample_period_s = 0.0),
        ("control limit", |p| p.limit_v = f64::NAN),
        ("is used twice", |p| p.paths[1].name = "feedback".into()),
        ("lower-case letter", |p| p.paths[1].name = "Heave".into()),
        ("may hold only", |p| p.paths[1].name = "heave-path".into()),
        ("word of the target code", |p| p.paths[1].name = "double".into()),
        ("two things", |p| p.paths[1].name = "feedback_v".into()),
        ("is empty", |p| p.paths[1].name.clear()),
        ("inputs of the system", |p| p.paths[0].inputs = vec![PathSignal::Demand]),
        ("anti-windup gains", |p| p.paths[0].anti_windup = vec![0.0]),
        ("sample period is", |p| p.paths[0].system.timebase = Timebase::Continuous),
        ("must be finite", |p| p.paths[0].anti_windup[0] = f64::INFINITY),
        ("other than 0", |p| p.design_out_of_balance_kg_m = 0.0),
        ("inside the range", |p| p.design_out_of_balance_kg_m = 1e4),
        ("must increase", |p| {
            p.paths[1].scaling = Scaling::Scheduled { below_kg_m: Some(2.0), at_kg_m: 1.0, above_kg_m: None }
        }),
        ("outputs of the system", |p| {
            p.paths[1].system = system(one(0.0), one(1.0), Mat::zeros(2, 1), Mat::zeros(2, 1))
        }),
    ];
    for (expected, spoil) in cases {
        let mut spoiled = parts();
        spoil(&mut spoiled);
        let found: Error = Controller::new(spoiled).expect_err(expected);
        let text = format!("{found}").replace("controller's sample period is", "sample period is");
        assert!(text.contains(expected), "{text}: {expected}");
    }
}
