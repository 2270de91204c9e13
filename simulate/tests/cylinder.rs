//! A hydraulic cylinder with a servo valve, against closed forms, the balance of its oil, and the definition of the plant marched in small steps.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::parameters::cylinder::Lever;
use counterpoise_models::plant::core::state;
use counterpoise_models::{
    Excitation, Friction, FrictionLaw, Linkage, LumpedStructure, Parameters, Plant, reference,
};
use counterpoise_simulate::{Detail, Initial, Playback, Scenario, Simulator, TimeHistory};

const INERTIA: f64 = 4.0e3;
const PINS: Linkage = Linkage { arm_m: 0.6, arm_angle_rad: -0.3, anchor_m: 1.3, anchor_angle_rad: -1.7 };

/// An elevated mass with a cylinder of 25 cm^2 at 20 MPa.
fn machine(lever: Lever) -> Parameters {
    let mut p = reference::rig();
    let none = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    (p.motor_friction, p.pivot_friction) = (none.clone(), none);
    (p.beam, p.lumped) = (None, Some(LumpedStructure::rigid(INERTIA)));
    p.configurations.clear();
    p.gravity_m_s2 = 0.0;
    reference::put_cylinder(&mut p, lever);
    p
}

/// Runs a machine from rest at an angle under controls, one a sample.
fn run(p: &Parameters, angle_rad: f64, controls_v: &[f64]) -> TimeHistory {
    let plant = Plant::from_lumped(p).unwrap();
    let scenario = Scenario {
        initial: Initial::Rest { hub_angle_rad: angle_rad },
        detail: Detail::Everything,
        ..Scenario::at_rest(controls_v.len() as f64 * p.interface.sample_period_s)
    };
    Simulator::new(&plant).unwrap().run(&mut Playback::new(controls_v), &scenario).unwrap()
}

#[test]
fn a_valve_that_is_fully_open_moves_the_load_as_the_orifice_equation_says() {
    let mut p = machine(Lever::Constant(0.5));
    let viscous = 2.0e4;
    p.pivot_friction = Friction::with_viscous_part(FrictionLaw::None, viscous);
    for (control, overlap) in [(10.0_f64, 0.0), (-10.0, 0.05), (25.0, 0.05)] {
        p.cylinder.as_mut().unwrap().overlap_l_s = overlap;
        let history = run(&p, 0.0, &[control; 1500]);
        let rate = history.truth.hub_rate_rad_s().last().unwrap().abs();
        // A r w + C p = (o - o_0) sqrt(1 - p/p_s) with p = b w/(A r)
        let pressure = viscous * rate / (2500.0 * 0.5);
        let passes = (0.9 - overlap) * (1.0 - pressure / 20.0).sqrt();
        let taken = 2.5 * 0.5 * rate + 0.004 * pressure;
        assert!((taken / passes - 1.0).abs() < 1e-6, "{control}: {taken} {passes}");
        assert!(rate > 0.1 && pressure > 1.0, "{rate} {pressure}");
    }
}

#[test]
fn what_flows_in_is_displaced_compressed_or_leaks() {
    let mut p = machine(Lever::Linkage(PINS));
    p.gravity_m_s2 = 9.80665;
    p.lumped.as_mut().unwrap().out_of_balance_kg_m = 1200.0;
    let period = p.interface.sample_period_s;
    let controls: Vec<f64> = (0..2000).map(|k| 6.0 * (1.57 * k as f64 * period).sin()).collect();
    let history = run(&p, 0.1, &controls);
    let (truth, cylinder) = (&history.truth, p.cylinder.as_ref().unwrap());
    let n = truth.current_a().len();
    // Simpson's rule over the samples, in which nothing jumps but the control, which the spool smooths
    let integral = |f: &dyn Fn(usize) -> f64| {
        let weight = |k: usize| {
            if k == 0 || k == n - 2 {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        (0..n - 1).map(|k| weight(k) * f(k)).sum::<f64>() * period / 3.0
    };
    let inflow = integral(&|k| cylinder.flow_l_s(truth.voltage_v()[k], truth.current_a()[k]));
    let passed = integral(&|k| cylinder.flow_l_s(truth.voltage_v()[k], truth.current_a()[k]).abs());
    let leaked = integral(&|k| 0.004 * truth.current_a()[k]);
    let travel = |k: usize| cylinder.lever.at(truth.hub_angle_rad()[k]).travel_m;
    let displaced = 2.5 * (travel(n - 2) - travel(0));
    let compressed = p.motor.inductance_h * (truth.current_a()[n - 2] - truth.current_a()[0]);
    let lost = inflow - displaced - compressed - leaked;
    assert!(lost.abs() < 1e-5 * passed, "{inflow} {displaced} {compressed} {leaked}: {lost}");
    assert!(displaced.abs() > 0.02 && leaked > 1e-4, "{displaced} {leaked}");
    let arms = [0, n / 3, n - 2].map(|k| cylinder.lever.at(truth.hub_angle_rad()[k]).arm_m);
    assert!((arms[0] / arms[1] - 1.0).abs() > 0.02, "{arms:?}");
}

/// Marches the definition of the plant with Runge and Kutta's method.
fn march_plant(plant: &Plant, start: &[f64], controls: &[f64], period_s: f64) -> Vec<Vec<f64>> {
    let parts = 40;
    let h = period_s / f64::from(parts);
    let mut x = start.to_vec();
    x.resize(plant.order(), 0.0);
    let slope = |x: &[f64], control_v: f64| {
        let mut dx = vec![0.0; x.len()];
        plant.derivative(x, &Excitation { control_v, ..Excitation::default() }, &mut dx);
        dx
    };
    let ahead = |x: &[f64], d: &[f64], h: f64| x.iter().zip(d).map(|(x, d)| x + h * d).collect::<Vec<f64>>();
    let mut all = Vec::new();
    for &control in controls {
        all.push(x.clone());
        for _ in 0..parts {
            let a = slope(&x, control);
            let b = slope(&ahead(&x, &a, 0.5 * h), control);
            let c = slope(&ahead(&x, &b, 0.5 * h), control);
            let d = slope(&ahead(&x, &c, h), control);
            for i in 0..x.len() {
                x[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
        }
    }
    all
}

#[test]
fn the_simulator_solves_the_definition_of_the_plant() {
    let mut p = machine(Lever::Linkage(PINS));
    p.gravity_m_s2 = 9.80665;
    p.lumped.as_mut().unwrap().out_of_balance_kg_m = 1200.0;
    p.cylinder.as_mut().unwrap().overlap_l_s = 0.02;
    let seals = FrictionLaw::Dahl { coulomb_nm: 900.0, rest_stiffness_nm_rad: 3e6, exponent: 1.0 };
    p.motor_friction = Friction::with_viscous_part(seals, 2500.0);
    let plant = Plant::from_lumped(&p).unwrap();
    let period = p.interface.sample_period_s;
    let controls: Vec<f64> = (0..800)
        .map(|k| 5.0 * (9.0 * k as f64 * period).sin() + 0.8)
        .map(|v: f64| (v * 2048.0).round() / 2048.0)
        .collect();
    let scenario_start = Simulator::new(&plant).unwrap().rest(0.15, 0.0, 0.0);
    let history = run(&p, 0.15, &controls);
    let second = march_plant(&plant, &scenario_start.core, &controls, period);
    let truth = &history.truth;
    let largest = |of: &dyn Fn(usize) -> f64| (0..800).map(|k| of(k).abs()).fold(0.0, f64::max);
    let rate_off = largest(&|k| truth.hub_rate_rad_s()[k] - second[k][state::RATE]);
    let pressure_off = largest(&|k| truth.current_a()[k] - second[k][state::CURRENT]);
    let opening_off = largest(&|k| truth.voltage_v()[k] - second[k][state::VOLTAGE]);
    let rate = largest(&|k| truth.hub_rate_rad_s()[k]);
    let pressure = largest(&|k| truth.current_a()[k]);
    assert!(
        rate_off < 2e-4 * rate && pressure_off < 2e-4 * pressure,
        "{rate_off} of {rate}, {pressure_off} of {pressure}"
    );
    assert!(opening_off < 1e-6, "{opening_off}");
}

#[test]
fn a_mass_at_rest_stays_where_the_valve_passes_what_leaks() {
    let mut p = machine(Lever::Linkage(PINS));
    p.gravity_m_s2 = 9.80665;
    p.lumped.as_mut().unwrap().out_of_balance_kg_m = 1200.0;
    p.cylinder.as_mut().unwrap().overlap_l_s = 0.03;
    for angle in [-0.2, 0.0, 0.4] {
        let plant = Plant::from_lumped(&p).unwrap();
        let at = plant.equilibrium(&counterpoise_models::OperatingPoint {
            hub_angle_rad: angle,
            platform_angle_rad: 0.0,
        });
        let arm = p.cylinder.as_ref().unwrap().lever.at(angle).arm_m;
        let pressure = 1200.0 * 9.80665 * angle.cos() / (2500.0 * arm);
        assert!((at.current_a / pressure - 1.0).abs() < 1e-12, "{} {pressure}", at.current_a);
        let history = run(&p, angle, &vec![at.control_v; 300]);
        let moved = history.truth.hub_angle_rad().iter().fold(0.0_f64, |most, a| most.max((a - angle).abs()));
        assert!(moved < 2e-5, "{angle}: {moved}");
    }
}
