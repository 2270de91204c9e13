//! The exact derivatives of a recording's residuals are those that differences of replays show.

use crate::common;

use common::controller;
use counterpoise_diagnose::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use counterpoise_diagnose::simulator_access::{
    ChannelResidual, MechanismVariant, SimulatorAccess, Span, VariantDirection,
};
use counterpoise_models::{
    LearnedElement, LearnedPlace, LearnedQuantity, Parameters, Plant, RegimeVariable, reference,
};
use counterpoise_simulate::replay::{ReplayLoop, START_FREEDOMS};
use counterpoise_simulate::sensitivity::Side;
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

/// Control that holds the rig's weight, V.
const BIAS_V: f64 = 2.88;

type Change = fn(&mut MechanismVariant, f64);

/// Parameters in units of a thousandth, and freedoms of the start.
const CHANGES: [Change; 7] = [
    |variant, by| variant.parameters.pivot_friction.viscous_nm_s_rad *= 1.0 + 1e-3 * by,
    |variant, by| variant.parameters.lumped.as_mut().unwrap().out_of_balance_kg_m *= 1.0 + 1e-3 * by,
    |variant, by| variant.parameters.gearbox.stiffness_nm_rad *= 1.0 + 1e-3 * by,
    |variant, by| variant.parameters.sensors.hub_gyro.gain *= 1.0 + 1e-3 * by,
    |variant, by| variant.shift[1] += by,
    |variant, by| variant.shift[4] += by,
    |variant, by| variant.shift[7] += by,
];

/// Values of sensors' errors.
const ERRORS: [Change; 4] = [
    |variant, by| variant.parameters.learned[0].values[5] += 1e-4 * by,
    |variant, by| variant.parameters.learned[1].values[4] += 1e-4 * by,
    |variant, by| variant.parameters.learned[2].values[3] += 1e-2 * by,
    |variant, by| variant.parameters.sensors.hub_gyro.gain *= 1.0 + 1e-3 * by,
];

#[test]
fn exact_slopes_of_residuals_are_those_of_differences() {
    compare(&reference::rig(), &CHANGES);
}

#[test]
fn exact_slopes_hold_with_errors_of_the_sensors() {
    let mut base = reference::rig();
    let error = |place, variable, reach: f64, size: f64| {
        let points: Vec<f64> = (-5..=5).map(|k| 0.2 * reach * f64::from(k)).collect();
        let values = points.iter().map(|x| size * (4.0 * x / reach).sin()).collect();
        let neutral = LearnedElement::neutral(place, LearnedQuantity::Error, variable, points);
        LearnedElement { values, ..neutral }
    };
    base.learned = vec![
        error(LearnedPlace::LoopSensor, RegimeVariable::Reading, 0.15, 5e-3),
        error(LearnedPlace::LoopSensor, RegimeVariable::Angle, 0.1, 3e-3),
        error(LearnedPlace::MotorTachometer, RegimeVariable::Reading, 25.0, 0.5),
    ];
    compare(&base, &ERRORS);
}

/// Compares derivatives along changes with differences, on a recording of the machine itself.
fn compare(base: &Parameters, changes: &[Change]) {
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.1, period_s: 1.6 },
        imperfections: Imperfections::NoiseAndQuantisation { seed: 5 },
        detail: Detail::Recording,
        ..Scenario::at_rest(4.0)
    };
    let mut simulator = Simulator::new(&Plant::from_lumped(base).unwrap()).unwrap();
    let history = simulator.run(&mut controller(BIAS_V), &scenario).unwrap();
    let recordings = [history.readings.recording("triangle", 1e-3)];
    let prepared = PreparedRecordings::new(&recordings, base);
    let control = ReplayLoop::from(&controller(BIAS_V));
    let replays = RecordingReplays::new(base, &control, &prepared).unwrap();
    let near = replays.assess(base, 0).unwrap();
    let variant = |parameters: &Parameters| MechanismVariant {
        parameters: parameters.clone(),
        shift: [0.0; START_FREEDOMS],
    };
    let members: Vec<_> = changes
        .iter()
        .map(|change| {
            move |by: f64| {
                let mut moved = variant(base);
                change(&mut moved, by);
                moved
            }
        })
        .collect();
    let directions: Vec<VariantDirection> =
        members.iter().map(|member| VariantDirection { member, side: Side::Both }).collect();
    let found = replays.residual_slopes(&variant(base), &directions, 0, Span::Head, &near).unwrap();
    for (k, member) in members.iter().enumerate() {
        let by = 0.3;
        let at = |by: f64| replays.residuals_of(&member(by), 0, Span::Head, &near).unwrap();
        let (below, above): (Vec<ChannelResidual>, Vec<ChannelResidual>) = (at(-by), at(by));
        for (channel, exact) in found[k].iter().enumerate() {
            let pairs = above[channel].residual.iter().zip(&below[channel].residual);
            let differences: Vec<f64> = pairs.map(|(a, b)| (a - b) / (2.0 * by)).collect();
            let size: f64 = differences.iter().map(|d| d * d).sum();
            let apart: f64 = differences.iter().zip(&exact.residual).map(|(a, b)| (a - b) * (a - b)).sum();
            println!("{k} {}: {:.1e} of {size:.1e}", exact.channel.name(), (apart / size).sqrt());
            assert!(apart <= 1e-4 * size + 1e-9, "{k}: {}", (apart / size).sqrt());
        }
    }
}
