//! A drive so stiff that it moves as one mass: simulation and replay against Euler's method on that mass.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::{Friction, FrictionLaw, LumpedStructure, Parameters, Plant, Sensor, reference};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::{Playback, ReplayLoop, Scenario, Simulator, replay};

const MASS: f64 = 95.109;
const COULOMB: f64 = 20.394;
const VISCOUS: f64 = 203.5;
const FORCE_PER_VOLT: f64 = 35.15;
const LAG_S: f64 = 1e-4;

/// A carriage on a ball screw: 2e8 N/m between two halves of the mass, and no resolver.
fn carriage(law: FrictionLaw) -> Parameters {
    let mut p = reference::rig();
    p.lumped = Some(LumpedStructure {
        hub_inertia_kg_m2: 45.0,
        beam_inertia_kg_m2: 0.109,
        stiffness_nm_rad: 1e6,
        damping_nm_s_rad: 300.0,
        out_of_balance_kg_m: 0.0,
        ..p.lumped.unwrap()
    });
    p.gearbox.ratio = 1.0;
    p.gearbox.stiffness_nm_rad = 2e8;
    p.gearbox.damping_nm_s_rad = 3e4;
    p.gearbox.backlash_rad = 0.0;
    p.motor.inertia_kg_m2 = 50.0;
    p.motor.torque_constant_nm_a = FORCE_PER_VOLT;
    p.motor.back_emf_v_s_rad = 0.0;
    p.motor.resistance_ohm = 1.0;
    p.motor.inductance_h = LAG_S;
    p.motor.platform_coupling = 0.0;
    p.amplifier.gain = 1.0;
    p.amplifier.current_feedback_v_a = 0.0;
    p.amplifier.time_constant_s = LAG_S;
    p.amplifier.bus_voltage_v = 10.0;
    p.interface.output_bits = 24;
    p.motor_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    p.pivot_friction = Friction::with_viscous_part(law, VISCOUS);
    p.sensors.hub_gyro = Sensor { scale_v_unit: 50.0, noise_rms: 5e-5, ..Sensor::IDEAL };
    p
}

/// Volts that move it to and fro, let it stick for a while, and pulse.
fn volts(samples: usize) -> Vec<f64> {
    let at = |k: usize| {
        let t = k as f64 * 1e-3;
        let swing = 1.5 * (2.1 * t).sin() + 0.6 * (5.3 * t).sin();
        let pulse = if (k / 700).is_multiple_of(3) { 0.0 } else { 0.4 };
        if (2.0..2.6).contains(&t) { 0.3 } else { swing + pulse }
    };
    (0..samples).map(at).collect()
}

/// One mass under sgn's friction, 2000 steps a sample: it stops where friction would turn it round.
fn euler(volts: &[f64]) -> Vec<f64> {
    let (mut rate, mut voltage, mut current) = (0.0_f64, 0.0_f64, 0.0_f64);
    let h = 1e-3 / 2000.0;
    let brake = h * COULOMB / MASS;
    let mut rates = Vec::with_capacity(volts.len());
    for volt in volts {
        rates.push(rate);
        for _ in 0..2000 {
            voltage += h / LAG_S * (volt - voltage);
            current += h / LAG_S * (voltage - current);
            let free = rate + h / MASS * (FORCE_PER_VOLT * current - VISCOUS * rate);
            rate = free - free.clamp(-brake, brake);
        }
    }
    rates
}

fn largest_difference(found: &[f64], expected: &[f64]) -> f64 {
    found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

const LAWS: [FrictionLaw; 3] = [
    FrictionLaw::Coulomb { coulomb_nm: COULOMB },
    FrictionLaw::Dahl { coulomb_nm: COULOMB, rest_stiffness_nm_rad: 2e6, exponent: 1.0 },
    FrictionLaw::Dahl { coulomb_nm: COULOMB, rest_stiffness_nm_rad: 5e5, exponent: 1.0 },
];

#[test]
fn a_stiff_drive_slides_and_sticks_as_one_mass() {
    let volts = volts(4000);
    let expected = euler(&volts);
    let resting = expected.iter().filter(|rate| **rate == 0.0).count();
    assert!(resting > 300, "{resting} samples at rest");
    for (law, allowed) in LAWS.into_iter().zip([1e-3, 4e-3, 8e-3]) {
        let plant = Plant::from_lumped(&carriage(law.clone())).unwrap();
        let mut simulator = Simulator::new(&plant).unwrap();
        let history = simulator.run(&mut Playback::new(&volts), &Scenario::at_rest(4.0)).unwrap();
        let worst = largest_difference(history.truth.hub_rate_rad_s(), &expected);
        println!("{law:?}: {worst:.1e} m/s");
        assert!(worst < allowed, "{law:?}: {worst:e}");
    }
}

/// Nothing in the recording shows the angle: the fit of the start must leave it where it is. At 1e10 rad a
/// displacement of a micrometre is below the last bit, and friction no longer reverses.
#[test]
fn a_recording_without_an_angle_replays_from_a_start_nearby() {
    let control = volts(6000);
    let recorded = euler(&control);
    for law in LAWS {
        // several starts: the fault came and went with the rounding
        for cut in [0, 37, 411] {
            let recording = Recording::new("carriage", 1e-3)
                .with(Channel::Control, control[cut..].to_vec())
                .with(Channel::HubRate, recorded[cut..].to_vec());
            let replayed = replay(&carriage(law.clone()), &recording, &ReplayLoop::Open).unwrap();
            let angle = replayed.start.core[counterpoise_models::plant::core::state::ANGLE];
            assert!(angle.abs() < 1e-3, "{law:?} from {cut}: {angle:e} rad");
            let vaf = replayed.channels[0].vaf;
            println!("{law:?} from {cut}: {vaf:.4} %");
            assert!(vaf > 99.9, "{law:?} from {cut}: {vaf}");
        }
    }
}

#[test]
fn an_angle_beyond_all_measure_is_refused() {
    let plant = Plant::from_lumped(&carriage(LAWS[0].clone())).unwrap();
    let mut simulator = Simulator::new(&plant).unwrap();
    let mut start = simulator.rest(0.0, 0.0, 0.0);
    start.core[counterpoise_models::plant::core::state::ANGLE] = 2e10;
    let initial = counterpoise_simulate::Initial::State(Box::new(start));
    let scenario = Scenario { initial, ..Scenario::at_rest(0.1) };
    assert!(simulator.run(&mut Playback::new(&[0.0]), &scenario).is_err());
}
