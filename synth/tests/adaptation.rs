//! Estimating the out-of-balance from signals whose truth is known.
#![allow(clippy::unwrap_used, non_snake_case)]

use counterpoise_controller::{
    Controller, Estimator, Learning, Parts, Path, PathSignal, Readings, Runner, SampledController, Scaling,
};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_synth::adaptation::{Curve, RecursiveLeastSquares, RecursiveSettings, Scale, WindowedMean};

const VOLTS: f64 = 1.0 / 516.0;
const PERIOD_S: f64 = 1e-3;

fn scale(gravity_m_s2: f64) -> Scale {
    Scale { volts_per_kg_m_s2: VOLTS, gravity_m_s2, curve: Curve::default() }
}

fn settings(gravity_m_s2: f64) -> RecursiveSettings {
    RecursiveSettings {
        scale: scale(gravity_m_s2),
        memory_s: 2.0,
        sample_period_s: PERIOD_S,
        dead_band_m_s2: 0.2,
        half_rate_rad_s: 1e-3,
        rate_limit_kg_m_s: 400.0,
        start_kg_m: 150.0,
        start_deviation_kg_m: 100.0,
        filter_s: 0.0,
        inertia_v_s2_rad: [0.0; 2],
    }
}

/// A controller whose control is the demand, with an estimator.
fn carrying(learning: Learning, gravity_m_s2: f64) -> Controller {
    let timebase = Timebase::Discrete { period_s: PERIOD_S };
    let gain = StateSpace::gain(Mat::eye(1), timebase).unwrap();
    let mut parts = Parts::new(PERIOD_S, 10.0);
    let (inputs, scaling) = (vec![PathSignal::Demand], Scaling::Fixed);
    parts.paths = vec![Path { name: "through".into(), inputs, system: gain, anti_windup: vec![], scaling }];
    parts.design_out_of_balance_kg_m = 150.0;
    parts.estimator = Some(Estimator {
        learning,
        gravity_m_s2,
        rate: PathSignal::RelativeRate,
        half_rate_rad_s: 1e-3,
        volts_per_kg_m_s2: VOLTS,
        rate_limit_kg_m_s: 400.0,
        hold_band_kg_m: 0.0,
        follow_samples: 0,
        hold_samples: 0,
    });
    Controller::new(parts).unwrap()
}

fn used_moment(controller: &Controller, runner: &Runner) -> f64 {
    let groups = &controller.programs().states;
    let group = groups.iter().find(|group| group.name == "out_of_balance_kg_m").unwrap();
    runner.states()[group.first]
}

/// The controller's own least squares, with the covariance in factors, and the plain ones are one estimator.
#[test]
fn the_controllers_estimator_and_the_plain_one_agree() {
    for (gravity, filter_s) in [(9.80665, 0.0), (0.0, 0.0), (0.0, 0.02)] {
        let inertia_v_s2_rad = [346.0 * VOLTS, 160.0 * VOLTS];
        let mut plain =
            RecursiveLeastSquares::new(RecursiveSettings { filter_s, inertia_v_s2_rad, ..settings(gravity) })
                .unwrap();
        let controller = carrying(
            Learning::Squares {
                forget: (-PERIOD_S / 2.0_f64).exp(),
                dead_band_m_s2: 0.2,
                deviation: [100.0 * VOLTS, 10.0, 10.0, 10.0],
                filter_s,
                inertia_v_s2_rad,
            },
            gravity,
        );
        let mut runner = controller.runner();
        for k in 0..20_000 {
            let truth = if k < 8_000 { 151.67 } else { 57.0 };
            let (readings, control) = sample(k, truth, gravity, if k > 15_000 { 0.05 } else { 1.0 });
            let estimate = plain.update(&readings, control);
            runner.step(&Readings { demand_rad_s: control, ..readings });
            let own = used_moment(&controller, &runner);
            assert!((own - estimate).abs() < 1e-6, "{gravity} {filter_s} sample {k}: {own} {estimate}");
        }
    }
}

/// Returns what the drive has to give at a time: imbalance, dry and viscous friction, in a road-like motion.
fn sample(k: usize, out_of_balance: f64, gravity: f64, amplitude: f64) -> (Readings, f64) {
    let t = k as f64 * PERIOD_S;
    let accel = amplitude * ((9.0 * t).sin() + 0.6 * (17.3 * t + 1.0).sin());
    let rate = 0.1 * (5.1 * t).sin() + 0.05 * (11.7 * t + 0.4).sin();
    let angle = 0.02 * (5.1 * t).cos();
    let readings = Readings {
        hub_rate_rad_s: 0.0,
        platform_rate_rad_s: rate,
        platform_accel_m_s2: accel,
        hub_position_rad: angle,
        ..Readings::default()
    };
    let relative = -rate;
    let friction = 130.0 * relative / (relative.abs() + 1e-3) + 140.0 * relative;
    (readings, VOLTS * (out_of_balance * (gravity * angle.cos() + accel) + friction))
}

fn run(
    mut estimator: RecursiveLeastSquares,
    gravity: f64,
    amplitude: f64,
    truth: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let each = (0..20_000).map(|k| {
        let (readings, control) = sample(k, truth(k), gravity, amplitude);
        estimator.update(&readings, control)
    });
    each.collect()
}

#[test]
fn recursive_least_squares_follows_a_step_of_the_imbalance_through_friction() {
    let truth = |k: usize| if k < 8_000 { 151.67 } else { 57.0 };
    let found = run(RecursiveLeastSquares::new(settings(9.80665)).unwrap(), 9.80665, 1.0, truth);
    assert!((found[7_999] - 151.67).abs() < 0.5, "{}", found[7_999]);
    assert!((found[19_999] - 57.0).abs() < 1.0, "{}", found[19_999]);
}

#[test]
fn without_gravity_the_lateral_acceleration_is_enough_and_without_either_nothing_moves() {
    let found = run(RecursiveLeastSquares::new(settings(0.0)).unwrap(), 0.0, 1.0, |_| 90.0);
    assert!((found[19_999] - 90.0).abs() < 0.5, "{}", found[19_999]);
    let still = run(RecursiveLeastSquares::new(settings(0.0)).unwrap(), 0.0, 0.01, |_| 90.0);
    assert!(still.iter().all(|estimate| *estimate == 150.0));
}

#[test]
fn the_estimate_moves_no_faster_than_its_limit() {
    let limited = RecursiveSettings { rate_limit_kg_m_s: 10.0, ..settings(9.80665) };
    let found = run(RecursiveLeastSquares::new(limited).unwrap(), 9.80665, 1.0, |_| 20.0);
    assert!(found.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 10.0 * PERIOD_S * (1.0 + 1e-9)));
}

#[test]
fn the_windowed_mean_is_right_over_whole_motions_and_needs_gravity() {
    let mut mean = WindowedMean::new(scale(9.80665), 10_000).unwrap();
    let mut estimates = Vec::new();
    for k in 0..20_000 {
        let (readings, control) = sample(k, 151.67, 9.80665, 1.0);
        estimates.extend(mean.update(&readings, control));
    }
    assert_eq!(estimates.len(), 2);
    assert!(estimates.iter().all(|estimate| (estimate / 151.67 - 1.0).abs() < 0.02), "{estimates:?}");
    assert!(WindowedMean::new(scale(0.0), 10_000).is_err());
}

#[test]
fn a_curved_drive_is_seen_through_its_curve() {
    let curve = Curve { points: vec![(-10.0, -8.0), (0.0, 0.0), (10.0, 12.0)] };
    assert_eq!((curve.at(-12.0), curve.at(-5.0), curve.at(5.0), curve.at(11.0)), (-10.0, -4.0, 6.0, 13.0));
    let mut with = settings(9.80665);
    with.scale.curve = Curve { points: vec![(0.0, 0.0), (2.0, 1.0), (4.0, 4.0)] };
    let mut estimator = RecursiveLeastSquares::new(with).unwrap();
    let inverse = |volts: f64| if volts < 1.0 { 2.0 * volts } else { 2.0 + (volts - 1.0) / 1.5 };
    for k in 0..20_000 {
        let (readings, volts) = sample(k, 151.67, 9.80665, 1.0);
        estimator.update(&readings, inverse(volts));
    }
    assert!((estimator.estimate_kg_m() - 151.67).abs() < 0.5, "{}", estimator.estimate_kg_m());
}
