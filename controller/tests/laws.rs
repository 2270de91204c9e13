//! Friction observers of every law against the law's own solution; the drive's curve; the three ways of learning.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::{
    Controller, Estimator, FrictionObserver, Learning, LevelLearning, ObserverLaw, Parts, Path, PathSignal,
    Scaling,
};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

const COULOMB: f64 = 117.0;
const STIFFNESS: f64 = 2.4e5;

fn observing(law: ObserverLaw, level: Vec<[f64; 2]>, period_s: f64) -> Controller {
    let mut parts = Parts::new(period_s, 1e4);
    parts.observers = vec![FrictionObserver {
        name: "pivot".into(),
        rate: PathSignal::HubRate,
        law,
        coulomb_nm: COULOMB,
        rest_stiffness_nm_rad: STIFFNESS,
        level,
        volts_per_nm: 1.0,
        viscous_v_s_rad: 0.0,
    }];
    Controller::new(parts).unwrap()
}

/// Returns the torque after so many samples at a constant rate.
fn torque(controller: &Controller, rate: f64, samples: usize) -> f64 {
    let mut runner = controller.runner();
    (0..samples).map(|_| runner.step_array(&[0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0])).last().unwrap()
}

/// From rest 1 - F/F_c falls as (1 + s)^-1 for i = 2, as ((1 - s/2)+)^2 for i = 1/2, with s = sigma x / F_c.
#[test]
fn dahl_with_an_exponent_has_its_closed_form() {
    let (rate, period) = (0.005, 1e-4);
    for (samples, x) in [(200, 1e-4), (1000, 5e-4)] {
        let s = STIFFNESS * x / COULOMB;
        for (exponent, left) in [(2.0, 1.0 / (1.0 + s)), (0.5, (1.0 - 0.5 * s).max(0.0).powi(2))] {
            let controller = observing(ObserverLaw::DahlPower { exponent }, Vec::new(), period);
            let found = torque(&controller, rate, samples) / COULOMB;
            assert!((found - (1.0 - left)).abs() < 0.02, "{exponent} {x}: {found} {}", 1.0 - left);
            let back = torque(&controller, -rate, samples) / COULOMB;
            assert_eq!(back, -found, "odd");
        }
    }
}

/// Steady LuGre friction is the level at the rate; so are Dahl's and the softened sign's.
#[test]
fn steady_friction_is_the_level_at_the_rate() {
    let level = vec![[0.0, 1.5], [0.01, 1.2], [0.02, 1.0]];
    let laws = [
        ObserverLaw::Dahl,
        ObserverLaw::DahlPower { exponent: 2.0 },
        ObserverLaw::Lugre { damping_nm_s_rad: 300.0 },
        ObserverLaw::Sliding { sign_rate_rad_s: 1e-3 },
    ];
    for law in laws {
        let controller = observing(law.clone(), level.clone(), 1e-3);
        for (rate, over) in [(0.005, 1.35), (-0.015, -1.1), (0.02, 1.0), (0.5, 1.0), (-3.0, -1.0)] {
            let found = torque(&controller, rate, 4000) / COULOMB;
            assert!((found - over).abs() < 0.02, "{law:?} at {rate}: {found}");
        }
    }
}

/// The bond carries static_ratio x its stretch, breaks at F_c and slides there; its damping acts only while it stretches.
#[test]
fn the_reset_integrator_breaks_away_above_its_sliding_level() {
    let law = ObserverLaw::ResetIntegrator { static_ratio: 1.4, damping_nm_s_rad: 0.0 };
    let controller = observing(law, Vec::new(), 1e-3);
    let mut runner = controller.runner();
    let run: Vec<f64> =
        (0..400).map(|_| runner.step_array(&[0.0, 0.005, 0.0, 0.0, 0.0, 0.0, 0.0]) / COULOMB).collect();
    let most = run.iter().copied().fold(0.0, f64::max);
    assert!((1.3..1.4).contains(&most), "{most}");
    assert!((run[399] - 1.0).abs() < 1e-12);
    let stretch = STIFFNESS * 0.005 * 1e-3 / COULOMB;
    assert!((run[0] - 1.4 * stretch).abs() < 1e-12);
    let law = ObserverLaw::ResetIntegrator { static_ratio: 1.0, damping_nm_s_rad: 200.0 };
    let damped = observing(law, Vec::new(), 1e-3);
    assert!((torque(&damped, 0.005, 1) - (STIFFNESS * 5e-6 + 1.0)).abs() < 1e-9);
    assert!((torque(&damped, 0.005, 400) - COULOMB).abs() < 1e-9);
}

/// T + tau dT/dt = T_c tanh(w / w0).
#[test]
fn walraths_friction_lags() {
    let law = ObserverLaw::Walrath { sign_rate_rad_s: 0.01, time_constant_s: 0.05 };
    let controller = observing(law, Vec::new(), 1e-4);
    for rate in [0.003, 0.01, -0.02, 0.2] {
        let steady = (rate / 0.01_f64).tanh();
        let after = torque(&controller, rate, 500) / COULOMB;
        let lagged = steady * (1.0 - (-1.0_f64).exp());
        assert!((after - lagged).abs() < 0.012, "{rate}: {after} {lagged}");
        assert!((torque(&controller, rate, 9000) / COULOMB - steady).abs() < 0.012);
    }
}

/// Whatever the rate, the friction stays inside its level: nothing overflows, nothing rings.
#[test]
fn no_law_exceeds_its_level_at_any_rate() {
    let laws = [
        ObserverLaw::Dahl,
        ObserverLaw::DahlPower { exponent: 0.5 },
        ObserverLaw::DahlPower { exponent: 3.0 },
        ObserverLaw::ResetIntegrator { static_ratio: 1.0, damping_nm_s_rad: 0.0 },
        ObserverLaw::Sliding { sign_rate_rad_s: 1e-3 },
        ObserverLaw::Walrath { sign_rate_rad_s: 1e-2, time_constant_s: 1e-3 },
    ];
    for law in laws {
        let mut runner = observing(law.clone(), vec![[0.0, 1.2], [0.1, 1.0]], 1e-3).runner();
        for k in 0..2000_i32 {
            let rate = f64::from(k) * 0.37;
            let volts =
                runner.step_array(&[0.0, 40.0 * rate.sin() * (0.1 * rate).cos(), 0.0, 0.0, 0.0, 0.0, 0.0]);
            assert!(volts.abs() <= 1.2 * COULOMB * (1.0 + 1e-12), "{law:?}: {volts}");
        }
    }
}

fn pass_through_parts() -> Parts {
    let timebase = Timebase::Discrete { period_s: 1e-3 };
    let through = Mat::from_rows(&[&[1.0]]);
    let system =
        StateSpace::new(Mat::zeros(0, 0), Mat::zeros(0, 1), Mat::zeros(1, 0), through, timebase).unwrap();
    let mut parts = Parts::new(1e-3, 10.0);
    let (inputs, scaling) = (vec![PathSignal::Demand], Scaling::Fixed);
    parts.paths = vec![Path { name: "through".into(), inputs, system, anti_windup: vec![], scaling }];
    parts
}

#[test]
fn the_drive_gets_the_control_that_its_curve_needs() {
    let mut parts = pass_through_parts();
    parts.drive_curve = vec![[0.2, 0.5], [0.5, 0.8], [3.0, 3.0]];
    let controller = Controller::new(parts).unwrap();
    let mut runner = controller.runner();
    let mut control = |volts: f64| runner.step_array(&[volts, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for (volts, expected) in [
        (0.0, 0.0),
        (0.1, 0.25),
        (0.2, 0.5),
        (0.35, 0.65),
        (0.5, 0.8),
        (-0.35, -0.65),
        (1.75, 1.9),
        (50.0, 10.0),
    ] {
        let found = control(volts);
        assert!((found - expected).abs() < 1e-12, "{volts}: {found}");
    }
    assert_eq!(control(-50.0), -10.0);
    let mut parts = pass_through_parts();
    parts.drive_curve = vec![[0.5, 0.5], [0.4, 0.8]];
    assert!(Controller::new(parts).unwrap_err().to_string().contains("above the one before"));
}

fn estimating(learning: Learning, gravity_m_s2: f64) -> Controller {
    let mut parts = pass_through_parts();
    parts.design_out_of_balance_kg_m = 150.0;
    parts.out_of_balance_range_kg_m = (0.0, 400.0);
    parts.estimator = Some(Estimator {
        learning,
        gravity_m_s2,
        rate: PathSignal::HubRate,
        half_rate_rad_s: 0.01,
        volts_per_kg_m_s2: 0.002,
        rate_limit_kg_m_s: f64::INFINITY,
        hold_band_kg_m: 0.0,
        follow_samples: 0,
        hold_samples: 0,
    });
    Controller::new(parts).unwrap()
}

fn used_moment(controller: &Controller, states: &[f64]) -> f64 {
    let groups = &controller.programs().states;
    states[groups.iter().find(|group| group.name == "out_of_balance_kg_m").unwrap().first]
}

/// Returns readings of a machine of 90 kg m whose control holds the imbalance, friction and a constant.
fn machine(k: usize, gravity: f64, constant: f64) -> [f64; 7] {
    let t = k as f64 * 1e-3;
    let (rate, accel) = (0.1 * (3.0 * t).sin() + 0.05, 2.0 * (7.0 * t).sin());
    let angle = 0.2 * t.sin();
    let volts =
        0.002 * 90.0 * (gravity * angle.cos() + accel) + 0.6 * rate / (rate.abs() + 0.01) + 0.3 * rate;
    [volts + constant, rate, 0.0, accel, 0.0, angle, 0.0]
}

/// Least squares find the imbalance exactly, with gravity and without: there a constant is told from it.
#[test]
fn least_squares_find_the_out_of_balance_exactly() {
    for (gravity, constant, filter_s) in [(9.81, 0.0, 0.0), (0.0, 0.4, 0.0), (0.0, 0.4, 0.02)] {
        let deviation = [0.3, 10.0, 10.0, 10.0];
        let (filter_s, inertia_v_s2_rad) = (filter_s, [0.0, 0.05]);
        let learning =
            Learning::Squares { forget: 0.9995, dead_band_m_s2: 0.2, deviation, filter_s, inertia_v_s2_rad };
        let controller = estimating(learning, gravity);
        let (mut double, mut single) = (controller.runner(), controller.runner_in::<f32>());
        for k in 0..20_000 {
            let mut readings = machine(k, gravity, constant);
            if filter_s > 0.0 {
                readings[0] += 0.05 * 0.3 * (3e-3 * k as f64).cos();
            }
            double.step_array(&readings);
            single.step_array(&readings);
        }
        let (found, small) =
            (used_moment(&controller, &double.states()), used_moment(&controller, &single.states()));
        assert!((found - 90.0).abs() < 0.02, "{found}");
        assert!((small - 90.0).abs() < 0.1, "single precision: {small}");
    }
}

/// A load that leaves the hold band is followed until the estimate has settled, and not to the edge of the band; one that stays within the
/// band is not followed at all.
#[test]
fn an_estimate_that_leaves_the_hold_band_is_followed_until_it_settles() {
    let learning = Learning::Squares {
        forget: 0.999,
        dead_band_m_s2: 0.2,
        deviation: [0.3, 10.0, 10.0, 10.0],
        filter_s: 0.0,
        inertia_v_s2_rad: [0.0; 2],
    };
    let held = |follow_samples| {
        let band = |parts: &mut Parts| {
            let estimator = parts.estimator.as_mut().unwrap();
            (estimator.hold_band_kg_m, estimator.follow_samples) = (6.0, follow_samples);
        };
        estimating(learning.clone(), 9.81).with(band).unwrap()
    };
    let (settles, to_the_edge) = (held(2000), held(0));
    let mut runners = [settles.runner(), to_the_edge.runner()];
    let mut used = Vec::new();
    for (part, load) in [90.0, 93.0, 105.0, 90.0].into_iter().enumerate() {
        for k in 0..15_000 {
            let mut readings = machine(15_000 * part + k, 9.81, 0.0);
            let lift = 9.81 * readings[5].cos() + readings[3];
            readings[0] += 0.002 * (load - 90.0) * lift;
            for runner in &mut runners {
                runner.step_array(&readings);
            }
        }
        let controllers = [&settles, &to_the_edge];
        used.push([0, 1].map(|i| used_moment(controllers[i], &runners[i].states()) - load));
    }
    let expected = [[0.0, 6.0], [-3.0, 3.0], [0.0, -6.0], [0.0, 6.0]];
    for (found, expected) in used.iter().zip(expected) {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 0.2, "{used:?}");
        }
    }
}

/// Without excitation in azimuth the estimate stands still, and nothing winds up for an hour of samples.
#[test]
fn inside_the_dead_band_least_squares_stand_still() {
    let (deviation, filter_s, inertia_v_s2_rad) = ([0.3, 10.0, 10.0, 10.0], 0.0, [0.0; 2]);
    let learning =
        Learning::Squares { forget: 0.999, dead_band_m_s2: 0.2, deviation, filter_s, inertia_v_s2_rad };
    let controller = estimating(learning, 0.0);
    let mut runner = controller.runner();
    for k in 0..200_000 {
        let noise = 0.01 * (f64::from(k) * 1.7).sin();
        runner.step_array(&[0.5 + noise, 0.1, 0.0, noise, 0.0, 0.0, 0.0]);
    }
    assert_eq!(used_moment(&controller, &runner.states()), 150.0);
    assert!(runner.states().iter().all(|state| state.abs() < 2e3));
}

/// The windowed mean: one window of a control that holds 90 kg m at a tilt gives 90 kg m, and not before its end.
#[test]
fn the_mean_of_a_window_gives_the_out_of_balance_at_its_end() {
    let controller = estimating(Learning::Mean { window_samples: 500 }, 9.81);
    let mut runner = controller.runner();
    let readings = [0.002 * 90.0 * 9.81 * 0.3_f64.cos(), 0.0, 0.0, 0.0, 0.0, 0.3, 0.0];
    for k in 1..=1200 {
        runner.step_array(&readings);
        let now = used_moment(&controller, &runner.states());
        let expected = if k < 500 { 150.0 } else { 90.0 };
        assert!((now - expected).abs() < 1e-4, "{k}: {now}");
    }
    let without = std::panic::catch_unwind(|| estimating(Learning::Mean { window_samples: 500 }, 0.0));
    assert!(without.is_err(), "there is nothing to go by without gravity");
}

/// While it is held the estimate is made and not used.
#[test]
fn a_held_estimate_is_used_only_after_its_time() {
    let controller = estimating(Learning::Mean { window_samples: 100 }, 9.81);
    let controller = controller.with(|parts| parts.estimator.as_mut().unwrap().hold_samples = 1000).unwrap();
    let mut runner = controller.runner();
    for k in 1..=1100 {
        runner.step_array(&[0.002 * 90.0 * 9.81, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let expected = if k <= 1000 { 150.0 } else { 90.0 };
        assert!((used_moment(&controller, &runner.states()) - expected).abs() < 1e-6, "{k}");
    }
}

/// A machine whose rate is given and whose friction the feedback has to overcome: what the observers do not cancel stands in the feedback, beside a part that
/// follows the rate and a constant one.
fn learn_level(true_level: f64, samples: usize) -> (f64, Vec<f64>) {
    let period_s = 1e-3;
    let mut parts = Parts::new(period_s, 1e4);
    parts.observers = observing(ObserverLaw::Dahl, Vec::new(), period_s).parts().observers.clone();
    parts.level_learning = Some(LevelLearning {
        lowest: 0.5,
        highest: 2.0,
        cancelled: 0.95,
        gain_per_s: 3.0,
        volts: COULOMB,
        sliding_rate_rad_s: 0.01,
        rate_scale_rad_s: 0.05,
    });
    let timebase = Timebase::Discrete { period_s };
    // The feedback passes the demand less the rate on, so that the demand can be what the feedback shall give.
    let through = StateSpace::gain(Mat::row(&[1.0]), timebase).unwrap();
    parts.paths = vec![Path {
        name: "feedback".into(),
        inputs: vec![PathSignal::RateError],
        system: through,
        anti_windup: Vec::new(),
        scaling: Scaling::Fixed,
    }];
    let mut runner = Controller::new(parts).unwrap().runner();
    let mut whole = observing(ObserverLaw::Dahl, Vec::new(), period_s).runner();
    let (mut cancelled, mut levels) = (0.0, Vec::new());
    for k in 0..samples {
        let t = k as f64 * period_s;
        let rate = 0.1 * (3.0 * t).sin() + 0.05 * (7.3 * t + 1.0).sin();
        let friction = whole.step_array(&[0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let feedback = true_level * friction - cancelled + 40.0 * rate + 7.0;
        let volts = runner.step_array(&[feedback + rate, rate, 0.0, 0.0, 0.0, 0.0, 0.0]);
        cancelled = volts - feedback;
        if friction.abs() > 0.9 * COULOMB {
            levels.push(cancelled / 0.95 / friction);
        }
    }
    (*levels.last().unwrap(), levels)
}

#[test]
fn the_level_of_friction_is_learnt_beside_what_follows_the_rate_and_stays_in_its_range() {
    for true_level in [0.6, 1.0, 1.8] {
        let (learnt, levels) = learn_level(true_level, 60_000);
        assert!((levels[0] - 0.5).abs() < 0.02, "it starts at the lowest: {}", levels[0]);
        assert!((learnt / true_level - 1.0).abs() < 0.02, "{learnt} for {true_level}");
    }
    for (true_level, kept) in [(0.2, 0.5), (5.0, 2.0)] {
        let (learnt, levels) = learn_level(true_level, 60_000);
        assert!((learnt / kept - 1.0).abs() < 0.1, "{learnt} for {true_level}");
        assert!(levels.iter().all(|level| (0.48..2.02).contains(level)), "{true_level}");
    }
}
