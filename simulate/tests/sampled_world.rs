//! Clocks that jitter, miss and are late, converters with missing codes, and gyroscopes that drift.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common::controller;
use counterpoise_controller::{ProportionalIntegral, Readings, SampledController};
use counterpoise_models::{Clock, Drift, FeedbackSignal, Parameters, Plant, Sensor, reference};
use counterpoise_simulate::{Imperfections, PlatformMotion, Scenario, Signal, TimeHistory, run};

const SEED: u64 = 4;

/// A controller that counts its steps.
struct StepCounter {
    inner: ProportionalIntegral,
    steps: usize,
}

impl SampledController for StepCounter {
    fn reset(&mut self) {}

    fn step(&mut self, readings: &Readings) -> f64 {
        self.steps += 1;
        self.inner.step(readings)
    }
}

fn moving(duration_s: f64) -> Scenario {
    let sine = |amplitude: f64, hz: f64| Signal::sine(amplitude, std::f64::consts::TAU * hz);
    Scenario {
        demand_rad_s: sine(0.05, 0.7),
        platform: PlatformMotion {
            pitch_rate_rad_s: sine(0.2, 1.0),
            heave_m_s2: sine(1.0, 1.5),
            ..PlatformMotion::STILL
        },
        imperfections: Imperfections::NoiseAndQuantisation { seed: SEED },
        ..Scenario::at_rest(duration_s)
    }
}

fn history(change: impl FnOnce(&mut Parameters), scenario: &Scenario) -> TimeHistory {
    let mut rig = reference::rig();
    change(&mut rig);
    run(&Plant::from_lumped(&rig).unwrap(), &mut controller(), scenario).unwrap()
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = values.map(|v| v * v).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    rms(a.iter().zip(b).map(|(a, b)| a - b))
}

#[test]
fn jitter_reads_a_moving_platform_at_other_instants() {
    let jitter_s = 1e-4;
    let scenario = moving(4.0);
    let steady = history(|_| (), &scenario);
    let jittered = history(|p| p.interface.clock.jitter_s = jitter_s, &scenario);
    let found = difference(jittered.readings.platform_rate_rad_s(), steady.readings.platform_rate_rad_s());
    // the slope of 0.2 rad/s at 1 Hz, times the jitter; quantisation adds a fifth of a milliradian over ten thousand
    let expected = 0.2 * std::f64::consts::TAU * jitter_s / 2f64.sqrt();
    assert!((found / expected - 1.0).abs() < 0.25, "{found} {expected}");
}

#[test]
fn missed_samples_leave_the_control_as_it_is() {
    let mut rig = reference::rig();
    rig.interface.clock.missed_samples = 0.1;
    let mut counting = StepCounter { inner: controller(), steps: 0 };
    let history = run(&Plant::from_lumped(&rig).unwrap(), &mut counting, &moving(4.0)).unwrap();
    let share = 1.0 - counting.steps as f64 / 4000.0;
    assert!((share - 0.1).abs() < 0.02, "{share}");
    let repeated = history.readings.hub_rate_rad_s().windows(2).filter(|w| w[0] == w[1]).count();
    assert!(repeated >= 4000 - counting.steps);
}

#[test]
fn a_control_that_is_always_late_is_a_delay_of_one_sample() {
    let scenario = moving(1.0);
    let late = history(|p| p.interface.clock.late_samples = 1.0, &scenario);
    let delayed = history(|p| p.interface.output_delay_samples = 1, &scenario);
    assert_eq!(late.truth, delayed.truth);
    assert_eq!(late.readings, delayed.readings);
    let sometimes = history(|p| p.interface.clock.late_samples = 0.3, &scenario);
    assert_ne!(sometimes.truth, delayed.truth);
}

#[test]
fn missing_codes_widen_their_neighbours() {
    let scenario = Scenario { imperfections: Imperfections::Quantisation, ..moving(4.0) };
    let whole = history(|p| p.interface.input_bits = 12, &scenario);
    let gaps = history(
        |p| {
            p.interface.input_bits = 12;
            p.interface.missing_codes = 0.2;
        },
        &scenario,
    );
    let codes = |history: &TimeHistory| {
        let mut all: Vec<i64> = history
            .readings
            .platform_rate_rad_s()
            .iter()
            .map(|v| (v * 10.0 / (20.0 / 4096.0)).round() as i64)
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let (all, some) = (codes(&whole), codes(&gaps));
    assert!(some.iter().all(|code| all.contains(code) || all.contains(&(code + 1))));
    let share = 1.0 - some.len() as f64 / all.len() as f64;
    assert!((share - 0.2).abs() < 0.06, "{share}");
}

#[test]
fn a_gyroscope_drifts_and_an_ideal_world_changes_nothing() {
    let scenario = moving(4.0);
    let ideal = history(|_| (), &scenario);
    let same = history(
        |p| {
            p.interface.clock = Clock::IDEAL;
            p.sensors.platform_gyro.drift = Drift::NONE;
        },
        &scenario,
    );
    assert_eq!(ideal.readings, same.readings);
    let walk = Drift { angle_random_walk: 2e-5, ..Drift::NONE };
    let drifting = history(|p| p.sensors.platform_gyro.drift = walk, &scenario);
    let found = difference(drifting.readings.platform_rate_rad_s(), ideal.readings.platform_rate_rad_s());
    assert!((found / (2e-5 / 1e-3f64.sqrt()) - 1.0).abs() < 0.1, "{found}");
    let biased = Drift { rate_random_walk: 1e-3, ..Drift::NONE };
    let drifting = history(|p| p.sensors.hub_gyro.drift = biased, &scenario);
    let last = |h: &TimeHistory| {
        let from = h.truth.hub_rate_rad_s().len() - 500;
        h.truth.hub_rate_rad_s()[from..].iter().sum::<f64>() / 500.0
    };
    assert!((last(&drifting) - last(&ideal)).abs() > 2e-4, "the loop follows its drifting gyroscope");
}

/// The sum of differences telescopes: whatever they are rounded to, no angle is lost, which a rate rounded by itself would lose below half a step.
#[test]
fn a_differenced_encoder_loses_no_angle() {
    for every in [1, 4] {
        let step = 1e-3;
        let period_s = 1e-3 * every as f64;
        let differenced = |p: &mut Parameters| {
            p.sensors.measured = FeedbackSignal::RelativeRate;
            p.sensors.hub_gyro =
                Sensor { resolution: step, own_period_s: period_s, is_differenced: true, ..Sensor::IDEAL };
        };
        let found = history(differenced, &moving(4.0));
        let (angle, platform) = (found.truth.hub_angle_rad(), found.truth.platform_angle_rad());
        let relative = |k: usize| angle[k] - platform[k];
        let mut read = 0.0;
        for (k, rate) in found.readings.hub_rate_rad_s().iter().enumerate().step_by(every) {
            let counts = rate * period_s / step;
            assert!(
                (counts - counts.round()).abs() < 1e-6,
                "{counts} at {k}: whole steps between two readings"
            );
            read += rate * period_s;
            let moved = relative(k) - relative(0);
            let off = read - moved;
            assert!(off.abs() < 2.0 * step, "{off} rad at sample {k}");
        }
        let sensor = Sensor { own_period_s: period_s, is_differenced: true, ..Sensor::IDEAL };
        let late = 0.5 * every as f64 + 0.5 * (every - 1) as f64;
        assert_eq!(sensor.mean_delay_samples(1e-3), late);
    }
}
