//! A base with six degrees of freedom: conservation of energy, equivalence of acceleration and gravity, and what the sensors read.
#![allow(clippy::unwrap_used)]

use counterpoise_models::{
    AccelerometerAxis, AmplifierDynamics, Friction, FrictionLaw, Gearbox, LumpedStructure, Parameters, Plant,
    Sensor, reference,
};
use counterpoise_simulate::{
    FurtherMotion, Initial, PlatformMotion, Playback, Scenario, Signal, Simulator, TimeHistory,
};

const G: f64 = 9.80665;

/// One inertia of 12 kg m^2 that nothing drives or brakes, nose-heavy by 1.5 kg m and with 0.4 kg m above its pivot.
fn free_machine() -> Parameters {
    let mut p = reference::rig();
    let lumped = LumpedStructure {
        out_of_balance_kg_m: 1.5,
        vertical_offset_kg_m: 0.4,
        ..LumpedStructure::rigid(12.0)
    };
    (p.beam, p.lumped, p.gearbox) = (None, Some(lumped), Gearbox::DIRECT);
    p.motor.inertia_kg_m2 = 0.0;
    p.amplifier.dynamics = AmplifierDynamics::TorqueCommand;
    p.motor_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    p.pivot_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    p
}

fn run(p: &Parameters, platform: PlatformMotion, hub_angle_rad: f64, duration_s: f64) -> TimeHistory {
    let scenario =
        Scenario { platform, initial: Initial::Rest { hub_angle_rad }, ..Scenario::at_rest(duration_s) };
    let zeros = vec![0.0; (duration_s * 1e3) as usize + 1];
    let plant = Plant::from_lumped(p).unwrap();
    Simulator::new(&plant).unwrap().run(&mut Playback::new(&zeros), &scenario).unwrap()
}

fn further_motion(surge: f64, roll: f64, yaw: f64) -> Option<FurtherMotion> {
    let [surge_m_s2, roll_rate_rad_s, yaw_rate_rad_s] = [surge, roll, yaw].map(Signal::Constant);
    Some(FurtherMotion { surge_m_s2, roll_rate_rad_s, yaw_rate_rad_s })
}

/// With constant surge, roll and yaw rates the motion has an integral: the energy of the axis in gravity, in the surge, and in the
/// centrifugal field of the rates.
#[test]
fn energy_is_conserved_without_friction() {
    let (surge, roll, yaw) = (2.5, 0.4, -0.5);
    let platform = PlatformMotion { further: further_motion(surge, roll, yaw), ..PlatformMotion::STILL };
    let found = run(&free_machine(), platform, 0.4, 20.0);
    let energy = |k: usize| {
        let (rate, (sin, cos)) = (found.truth.hub_rate_rad_s()[k], found.truth.hub_angle_rad()[k].sin_cos());
        let weight = 1.5 * (G * sin + surge * cos) + 0.4 * (G * cos - surge * sin);
        6.0 * rate * rate + weight + 6.0 * (roll * cos + yaw * sin).powi(2)
    };
    let travelled =
        found.truth.hub_angle_rad().iter().fold([f64::MAX, f64::MIN], |[l, h], a| [l.min(*a), h.max(*a)]);
    assert!(travelled[1] - travelled[0] > 1.0, "it swings: {travelled:?}");
    let worst = (0..found.len()).map(|k| (energy(k) - energy(0)).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-8 * 1.5 * G, "{worst} J");
}

/// A base that surges steadily is one whose gravity is tilted.
#[test]
fn surge_is_a_tilt_of_gravity() {
    let tilt = 0.3_f64;
    let surging = PlatformMotion {
        heave_m_s2: Signal::Constant(G * (tilt.cos() - 1.0)),
        further: further_motion(-G * tilt.sin(), 0.0, 0.0),
        ..PlatformMotion::STILL
    };
    let found = run(&free_machine(), surging, 0.5, 5.0);
    let tilted = run(&free_machine(), PlatformMotion::STILL, 0.5 - tilt, 5.0);
    for (a, b) in found.truth.hub_angle_rad().iter().zip(tilted.truth.hub_angle_rad()) {
        assert!((a - b - tilt).abs() < 1e-9, "{a} {b}");
    }
}

/// The same motion by the plant's own right-hand side and the classical Runge-Kutta method.
#[test]
fn the_integrator_solves_the_plant_s_own_equations() {
    let p = free_machine();
    let sine = |amplitude, rate| Signal::sine(amplitude, rate);
    let motion = FurtherMotion {
        surge_m_s2: sine(2.0, 5.0),
        roll_rate_rad_s: sine(0.8, 3.0),
        yaw_rate_rad_s: sine(-0.9, 4.0),
    };
    let platform =
        PlatformMotion { heave_m_s2: sine(1.5, 7.0), further: Some(motion.clone()), ..PlatformMotion::STILL };
    let found = run(&p, platform.clone(), 0.2, 4.0);
    let plant = Plant::from_lumped(&p).unwrap();
    let slope = |time_s: f64, x: &[f64]| {
        let at = counterpoise_models::Excitation {
            time_s,
            heave_m_s2: platform.heave_m_s2.at(time_s),
            surge_m_s2: motion.surge_m_s2.at(time_s),
            off_axis_rates_rad_s: [motion.roll_rate_rad_s.at(time_s), motion.yaw_rate_rad_s.at(time_s)],
            ..Default::default()
        };
        let mut dx = vec![0.0; x.len()];
        plant.derivative(x, &at, &mut dx);
        dx
    };
    let moved =
        |x: &[f64], d: &[f64], h: f64| -> Vec<f64> { x.iter().zip(d).map(|(a, b)| a + h * b).collect() };
    let mut x = Simulator::new(&plant).unwrap().rest(0.2, 0.0, 0.0).core;
    x.resize(plant.order(), 0.0);
    let (h, angle) = (1e-3, plant.hub_angle_row());
    for k in 0..4000 {
        let hub: f64 = angle.iter().zip(&x).map(|(c, v)| c * v).sum();
        assert!(
            (hub - found.truth.hub_angle_rad()[k]).abs() < 1e-8,
            "{k}: {hub} {}",
            found.truth.hub_angle_rad()[k]
        );
        let t = k as f64 * h;
        let first = slope(t, &x);
        let second = slope(t + 0.5 * h, &moved(&x, &first, 0.5 * h));
        let third = slope(t + 0.5 * h, &moved(&x, &second, 0.5 * h));
        let fourth = slope(t + h, &moved(&x, &third, h));
        for i in 0..x.len() {
            x[i] += h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
    }
}

/// An accelerometer on the elevated mass reads heave and surge as the out-of-balance feels them.
#[test]
fn an_elevated_accelerometer_reads_along_the_normal_of_the_beam() {
    let mut p = free_machine();
    p.sensors.platform_accelerometer = Sensor::IDEAL;
    let platform = PlatformMotion {
        heave_m_s2: Signal::Constant(1.0),
        further: further_motion(2.0, 0.0, 0.0),
        ..PlatformMotion::STILL
    };
    let vertical = run(&p, platform.clone(), 0.3, 0.5);
    assert!(vertical.readings.platform_accel_m_s2().iter().all(|reading| *reading == 1.0));
    p.sensors.accelerometer_axis = AccelerometerAxis::Elevated;
    let elevated = run(&p, platform, 0.3, 0.5);
    for (reading, angle) in elevated.readings.platform_accel_m_s2().iter().zip(elevated.truth.hub_angle_rad())
    {
        assert!((reading - (angle.cos() - 2.0 * angle.sin())).abs() < 1e-9, "{reading} at {angle}");
    }
}
