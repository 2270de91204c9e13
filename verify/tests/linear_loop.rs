//! The linear loop, by two ways that share nothing but the plant.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use counterpoise_lti::Response;
use counterpoise_models::plant::{Angles, FrictionLinearisation, OperatingPoint};
use counterpoise_verify::linear_loop::frequency::{Curves, compute_rejections};
use counterpoise_verify::linear_loop::plant::Resolver;
use counterpoise_verify::linear_loop::{
    ArrangedLoop, ClosedLoop, LoopCause, LoopEffect, SampledPlant, arrange_controller, simulate_disturbance,
    simulate_step,
};
use counterpoise_verify::signals::step_figures;
use counterpoise_verify::{Arrangement, HeaveAndPitch, Sine, Source, Step};
use num_complex::Complex64;
use support::{controller, plant, rig};

const ALL: [Arrangement; 3] = [Arrangement::Uncontrolled, Arrangement::Feedback, Arrangement::Compensated];

fn sampled_plant() -> SampledPlant {
    let plant = plant();
    let level = plant.equilibrium(&OperatingPoint::default());
    let linear = plant.linearise(&level, FrictionLinearisation::Viscous, Angles::Drop).unwrap();
    SampledPlant::new(&linear, &rig(), Resolver::Unread).unwrap()
}

fn close_loop(plant: &SampledPlant, arrangement: Arrangement) -> ClosedLoop {
    let controller = arrange_controller(&controller(), arrangement).unwrap();
    ClosedLoop::new(plant, controller.as_ref(), 151.67).unwrap()
}

/// The complex amplitude of the last `cycles` periods of a series.
fn tone(y: &[f64], frequency_hz: f64, period_s: f64, cycles: f64) -> Complex64 {
    let count = (cycles / frequency_hz / period_s).round() as usize;
    let first = y.len() - count;
    let angle = |k: usize| -std::f64::consts::TAU * frequency_hz * k as f64 * period_s;
    let sum: Complex64 = (first..y.len()).map(|k| y[k] * Complex64::from_polar(1.0, angle(k))).sum();
    2.0 * sum / count as f64
}

#[test]
fn the_rejection_ratio_is_what_a_time_history_shows() {
    let plant = sampled_plant();
    let sine = Sine { amplitude: 1.0, frequency_hz: 2.0 };
    for arrangement in ALL {
        let closed = close_loop(&plant, arrangement);
        let expected = compute_rejections(&plant, &closed, arrangement, &[2.0]).unwrap();
        for (source, ratio) in [(Source::Heave, &expected[0]), (Source::Pitch, &expected[1])] {
            let motion = |t: f64| match source {
                Source::Heave => HeaveAndPitch { heave_m_s2: sine.at(t), pitch_rate_rad_s: 0.0 },
                _ => HeaveAndPitch { heave_m_s2: 0.0, pitch_rate_rad_s: sine.at(t) },
            };
            let run = simulate_disturbance(&plant, &closed, source, arrangement, 40.0, motion).unwrap();
            let driven = run.motion(source);
            let found = tone(run.hub_rate_rad_s(), 2.0, 1e-3, 8.0) / tone(driven, 2.0, 1e-3, 8.0);
            let error = (found - ratio.response[0]).norm() / ratio.response[0].norm();
            assert!(error < 2e-4, "{arrangement:?} {source:?}: {found} {} {error:e}", ratio.response[0]);
        }
    }
}

#[test]
fn the_loop_is_stable_and_follows_a_step_without_error() {
    let plant = sampled_plant();
    let closed = close_loop(&plant, Arrangement::Compensated);
    assert!(closed.pole_radius() < 1.0, "{}", closed.pole_radius());
    let run = simulate_step(&plant, &closed, Step { rate_rad_s: 0.1, duration_s: 5.0 }).unwrap();
    let figures = step_figures(run.time_s(), run.hub_rate_rad_s(), 0.1).unwrap();
    assert!(figures.steady_state_error_percent < 1e-3, "{figures:?}");
    assert!(
        (run.control_v()[0] - plant.holding_v - 1.8).abs() < 1e-9,
        "the first control is kp times the step"
    );
    assert!((plant.holding_v - 2.88).abs() < 0.01, "{}", plant.holding_v);
}

#[test]
fn the_broken_loop_is_the_controller_times_the_held_plant() {
    let plant = sampled_plant();
    let loops: Vec<_> =
        ALL.map(|arrangement| ArrangedLoop { arrangement, closed: close_loop(&plant, arrangement) }).into();
    let curves = Curves::of(&plant, &loops).unwrap();
    let gyro = |s: Complex64| 377.0 * 377.0 / (s * s + 2.0 * 0.7 * 377.0 * s + 377.0 * 377.0);
    for (k, f) in curves.frequency_hz.iter().enumerate().filter(|(_, f)| **f < 20.0) {
        let s = Complex64::new(0.0, std::f64::consts::TAU * f);
        let z = (s * 1e-3).exp();
        let pi = 18.0 + 0.08 / (z - 1.0);
        let hold = (1.0 - 1.0 / z) / (s * 1e-3);
        let expected = pi * hold * curves.plant[0].response[k] * gyro(s);
        let error = (curves.broken.response[k] - expected).norm() / expected.norm();
        assert!(error < 0.01, "{f} Hz: {error}");
    }
    assert_eq!(curves.controller[1].response[0].re, curves.controller[1].response[600].re);
    assert_eq!(curves.rejection.len(), 6);
}

/// The reading of a gyroscope that is late by a part of a sample turns the loop by that part.
#[test]
fn a_late_reading_turns_the_loop_by_its_delay() {
    let with_delay = |delay_s: f64| {
        let mut late = rig();
        late.sensors.hub_gyro.delay_s = delay_s;
        let level = plant().equilibrium(&OperatingPoint::default());
        let linear = plant().linearise(&level, FrictionLinearisation::Viscous, Angles::Drop).unwrap();
        let sampled = SampledPlant::new(&linear, &late, Resolver::Unread).unwrap();
        let arrangement = Arrangement::Compensated;
        let loops = vec![ArrangedLoop { arrangement, closed: close_loop(&sampled, arrangement) }];
        Curves::of(&sampled, &loops).unwrap()
    };
    let prompt = with_delay(0.0);
    for delay_s in [2e-6, 0.25e-3, 0.5e-3, 0.99e-3, 1e-3, 1.4e-3, 2.0001e-3, 17.7e-3] {
        let late = with_delay(delay_s);
        for (k, f) in late.frequency_hz.iter().enumerate().filter(|(_, f)| **f < 100.0) {
            let expected =
                prompt.broken.response[k] * Complex64::from_polar(1.0, -std::f64::consts::TAU * f * delay_s);
            let error = (late.broken.response[k] - expected).norm() / expected.norm();
            assert!(error < 3e-3, "{delay_s} s, {f} Hz: {error}");
        }
    }
}

#[test]
fn the_responses_of_the_closed_loop_are_those_of_the_sampled_system() {
    let plant = sampled_plant();
    let loops: Vec<_> =
        ALL.map(|arrangement| ArrangedLoop { arrangement, closed: close_loop(&plant, arrangement) }).into();
    let curves = Curves::of(&plant, &loops).unwrap();
    let of = |cause, effect| {
        let found = curves.loop_responses.iter().find(|r| (r.cause, r.effect) == (cause, effect));
        &found.unwrap().response
    };
    let follows = of(LoopCause::Demand, LoopEffect::Hub);
    let asks = of(LoopCause::Demand, LoopEffect::Control);
    let noise = of(LoopCause::Noise(1), LoopEffect::Control);
    let disturbed = of(LoopCause::Control, LoopEffect::Hub);
    let system = Response::of(&loops[2].closed.system).unwrap();
    for (k, f) in curves.frequency_hz.iter().enumerate().filter(|(_, f)| **f < 20.0) {
        let sampled = system.at(std::f64::consts::TAU * f).unwrap();
        // below 20 Hz the aliases of a loop at 1 kHz are worth less than a thousandth
        let error = |found: Complex64, expected: Complex64| (found - expected).norm() / expected.norm();
        assert!(error(follows[k], sampled[(0, 0)]) < 3e-3, "{f} Hz: {} {}", follows[k], sampled[(0, 0)]);
        assert!(error(asks[k], sampled[(4, 0)]) < 1e-9, "{f} Hz: {} {}", asks[k], sampled[(4, 0)]);
        // the controller takes demand less reading: noise drives the control as the demand does, with the other sign
        assert!(error(-noise[k], asks[k]) < 1e-9, "{f} Hz");
        let (S, T) = (curves.sensitivities[0].response[k], curves.sensitivities[1].response[k]);
        assert!(error(disturbed[k] * asks[k], follows[k] * S) < 1e-9, "{f} Hz: P S * C S = (P C S) S");
        assert!((S + T - 1.0).norm() < 1e-12);
    }
    assert_eq!(curves.loop_responses.len(), 4, "one sensor is read");
}
