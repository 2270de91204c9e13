//! Misaligned gyroscopes and a tilted accelerometer in recordings: each is found again from a model whose sensors are aligned.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::controller;
use counterpoise_diagnose::fitting::output_error::{FitSelection, Problem};
use counterpoise_diagnose::library::{Component, EffectName, find_effects};
use counterpoise_diagnose::recording::instrument_faults::{FaultKind, find_instrument_faults};
use counterpoise_diagnose::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use counterpoise_models::{FeedbackSignal, Parameters, Plant, Sensor, reference};
use counterpoise_pool::Serial;
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::ReplayLoop;
use counterpoise_simulate::{
    Detail, FurtherMotion, Imperfections, PlatformMotion, Scenario, Signal, Simulator, Sine,
};

/// Control that holds the rig's weight, V.
const BIAS_V: f64 = 2.88;
const PERIOD_S: f64 = 1e-3;
const DURATION_S: f64 = 8.0;

fn sines(amplitudes: [f64; 2], rates_rad_s: [f64; 2]) -> Signal {
    let sine = |k: usize| Sine {
        amplitude: amplitudes[k],
        frequency_rad_s: rates_rad_s[k],
        phase_rad: 0.7 * k as f64,
    };
    Signal::Sines(vec![sine(0), sine(1)])
}

/// Motion of a platform in five degrees of freedom; each recording has frequencies of its own.
fn platform(of: f64) -> PlatformMotion {
    PlatformMotion {
        pitch_rate_rad_s: sines([0.08, 0.05], [3.0 * of, 11.0 * of]),
        heave_m_s2: sines([0.8, 0.6], [5.0 * of, 13.0 * of]),
        initial_angle_rad: 0.0,
        further: Some(FurtherMotion {
            surge_m_s2: sines([1.6, 1.0], [4.0 * of, 9.0 * of]),
            roll_rate_rad_s: sines([0.25, 0.15], [6.0 * of, 15.0 * of]),
            yaw_rate_rad_s: sines([0.2, 0.15], [2.0 * of, 8.0 * of]),
        }),
    }
}

fn recording(machine: &Parameters, seed: u64) -> Recording {
    let mut simulator = Simulator::new(&Plant::from_lumped(machine).unwrap()).unwrap();
    let platform = platform(1.0 + 0.17 * seed as f64);
    let further = platform.further.clone().unwrap();
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.1, period_s: 1.5 + 0.3 * seed as f64 },
        platform,
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        ..Scenario::at_rest(DURATION_S)
    };
    let history = simulator.run(&mut controller(BIAS_V), &scenario).unwrap();
    let name = format!("moving {seed}");
    let recorded = history.readings.recording(&name, PERIOD_S);
    let column =
        |signal: &Signal| (0..recorded.len()).map(|k| signal.at(PERIOD_S * k as f64)).collect::<Vec<f64>>();
    let (roll, yaw) = (column(&further.roll_rate_rad_s), column(&further.yaw_rate_rad_s));
    recorded.with(Channel::PlatformRoll, roll).with(Channel::PlatformYaw, yaw)
}

/// The reference rig with a second accelerometer.
fn rig() -> Parameters {
    let mut p = reference::rig();
    let heave: Sensor = p.sensors.platform_accelerometer.clone();
    p.sensors.surge_accelerometer = Some(heave);
    p
}

/// Returns the values of an effect's parameters that recordings of a machine give, fitted from the aligned model.
fn fitted_values(component: Component, effect: EffectName, change: impl FnOnce(&mut Parameters)) -> Vec<f64> {
    let (model, mut machine) = (rig(), rig());
    change(&mut machine);
    let recordings = [recording(&machine, 1), recording(&machine, 2)];
    let prepared = PreparedRecordings::new(&recordings, &model);
    let simulator = RecordingReplays::new(&model, &ReplayLoop::from(&controller(BIAS_V)), &prepared).unwrap();
    let effects: Vec<_> = find_effects(component, effect).collect();
    let start = effects[0].values(&model);
    let selection = FitSelection::all(recordings.len());
    let problem = Problem {
        simulator: &simulator,
        pool: &Serial,
        selection: &selection,
        base: &model,
        effects: effects.clone(),
        assessments: &[],
        preferences: &[],
    };
    let fit = problem.fit(&start).unwrap();
    effects[0].values(&fit.parameters)
}

fn check_near(found: &[f64], truth: &[f64], off: f64) {
    let is_near = found.iter().zip(truth).all(|(found, truth)| (found - truth).abs() < off);
    assert!(found.len() == truth.len() && is_near, "{found:?} {truth:?}");
}

#[test]
fn the_misalignment_of_the_hub_gyroscope_is_found() {
    let values = fitted_values(Component::HubGyro, EffectName::Misalignment, |p| {
        p.sensors.hub_gyro.alignment.roll_sensitivity = 0.03;
        p.sensors.hub_gyro.alignment.yaw_sensitivity = -0.02;
    });
    check_near(&values, &[0.03, -0.02], 2e-3);
}

#[test]
fn the_misalignment_of_the_platform_gyroscope_is_found() {
    let values = fitted_values(Component::PlatformGyro, EffectName::Misalignment, |p| {
        p.sensors.platform_gyro.alignment.roll_sensitivity = -0.06;
        p.sensors.platform_gyro.alignment.yaw_sensitivity = 0.05;
    });
    check_near(&values, &[-0.06, 0.05], 6e-3);
}

#[test]
fn the_tilt_of_the_accelerometer_is_found() {
    let values = fitted_values(Component::PlatformAccelerometer, EffectName::Tilt, |p| {
        p.sensors.platform_accelerometer.alignment.tilt_rad = 0.08;
    });
    check_near(&values, &[0.08], 0.01);
}

#[test]
fn a_sensor_that_is_stated_to_be_slower_has_no_fault() {
    let mut machine = rig();
    machine.sensors.platform_gyro.own_period_s = 5.0 * PERIOD_S;
    machine.sensors.hub_resolver.as_mut().unwrap().own_period_s = 4.0 * PERIOD_S;
    let recordings = [recording(&machine, 2)];
    let control = ReplayLoop::from(&controller(BIAS_V));
    let stated = find_instrument_faults(&machine, &control, &recordings);
    assert!(stated.faults.is_empty(), "{:?}", stated.faults);
    let not_stated = find_instrument_faults(&rig(), &control, &recordings);
    let held = |samples| not_stated.faults.iter().any(|fault| fault.kind == FaultKind::Held { samples });
    assert!(held(5) && held(4), "{:?}", not_stated.faults);
}

#[test]
fn a_control_that_rests_with_a_loop_of_position_is_not_stuck() {
    let mut resting = recording(&rig(), 2);
    resting.samples_mut(Channel::Control).unwrap()[..1200].fill(0.0);
    let control = ReplayLoop::Open;
    let is_stuck = |machine: &Parameters| {
        let found = find_instrument_faults(machine, &control, std::slice::from_ref(&resting));
        found.faults.iter().any(|fault| matches!(fault.kind, FaultKind::Stuck { .. }))
    };
    // Behind a gyroscope, whose noise never rests, it is.
    assert!(is_stuck(&rig()));
    let mut of_position = rig();
    of_position.sensors.measured = FeedbackSignal::HubPosition;
    assert!(!is_stuck(&of_position));
}
