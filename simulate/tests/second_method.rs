//! The integrator against a second method: the plant's right-hand side by small Runge-Kutta steps.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common::controller;
use counterpoise_controller::{ProportionalIntegral, Readings, SampledController};
use counterpoise_models::plant::{Body, BodyMode};
use counterpoise_models::{
    Excitation, Friction, FrictionLaw, LearnedElement, LearnedPlace, LearnedQuantity, OperatingPoint,
    Parameters, Plant, RegimeVariable, Ripple, reference,
};
use counterpoise_simulate::tolerance::TOLERANCE;
use counterpoise_simulate::{
    Imperfections, PlatformMotion, Playback, Scenario, Signal, Simulator, Sine, TimeHistory,
};

fn shaken(duration_s: f64) -> Scenario {
    let sine = |amplitude, hz: f64, phase_rad| Sine {
        amplitude,
        frequency_rad_s: std::f64::consts::TAU * hz,
        phase_rad,
    };
    Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.1, period_s: 1.0 },
        platform: PlatformMotion {
            pitch_rate_rad_s: Signal::Sines(vec![sine(0.1, 1.3, 0.3), sine(0.03, 4.0, 1.0)]),
            heave_m_s2: Signal::Sines(vec![sine(2.0, 2.1, 0.0)]),
            initial_angle_rad: 0.01,
            further: None,
        },
        ..Scenario::at_rest(duration_s)
    }
}

/// The same loop by the classical Runge-Kutta method with `substeps` steps a sample; hub rates at the samples.
fn runge_kutta(plant: &Plant, scenario: &Scenario, substeps: usize) -> Vec<f64> {
    let mut control = controller();
    let gyro = &plant.parameters().sensors.hub_gyro;
    let (w, z) = (gyro.natural_frequency_rad_s, gyro.damping_ratio);
    let simulator = Simulator::new(plant).unwrap();
    let rate0 = scenario.platform.pitch_rate_rad_s.at(0.0);
    let start = simulator.rest(0.0, scenario.platform.initial_angle_rad, rate0);
    let n = plant.core_order();
    // [core, friction, gyro, its derivative, platform angle]
    let mut x = start.core.clone();
    x.extend([0.0, 0.0, rate0, 0.0, scenario.platform.initial_angle_rad]);
    let rows = plant.hub_rate_row();
    let hub_rate = |x: &[f64]| rows.iter().zip(x).map(|(c, v)| c * v).sum::<f64>();
    let slope = |t: f64, x: &[f64], u: f64| {
        let platform_rate = scenario.platform.pitch_rate_rad_s.at(t);
        let excitation = Excitation {
            time_s: t,
            control_v: u,
            heave_m_s2: scenario.platform.heave_m_s2.at(t),
            platform_angle_rad: x[n + 4],
            platform_rate_rad_s: platform_rate,
            ..Excitation::default()
        };
        let mut dx = vec![0.0; n + 5];
        plant.derivative(&x[..n + 2], &excitation, &mut dx[..n + 2]);
        dx[n + 2] = x[n + 3];
        dx[n + 3] = w * w * (hub_rate(x) - x[n + 2]) - 2.0 * z * w * x[n + 3];
        dx[n + 4] = platform_rate;
        dx
    };
    let step = |x: &[f64], d: &[f64], h: f64| x.iter().zip(d).map(|(a, b)| a + h * b).collect::<Vec<f64>>();
    let mut rates = Vec::new();
    for k in 0..(scenario.duration_s * 1e3).round() as usize {
        let t0 = k as f64 * 1e-3;
        rates.push(hub_rate(&x));
        let readings = Readings {
            hub_rate_rad_s: x[n + 2],
            demand_rad_s: scenario.demand_rad_s.at(t0),
            ..Readings::default()
        };
        let u = control.step(&readings);
        let h = 1e-3 / substeps as f64;
        for s in 0..substeps {
            let t = t0 + s as f64 * h;
            let k1 = slope(t, &x, u);
            let k2 = slope(t + 0.5 * h, &step(&x, &k1, 0.5 * h), u);
            let k3 = slope(t + 0.5 * h, &step(&x, &k2, 0.5 * h), u);
            let k4 = slope(t + h, &step(&x, &k3, h), u);
            for i in 0..x.len() {
                x[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
            }
        }
    }
    rates
}

fn simulate_plant(plant: &Plant, scenario: &Scenario, tolerance: f64) -> TimeHistory {
    Simulator::with_tolerance(plant, tolerance).unwrap().run(&mut controller(), scenario).unwrap()
}

fn error(found: &[f64], expected: &[f64]) -> f64 {
    let scale = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    found.iter().zip(expected).fold(0.0_f64, |a, (f, e)| a.max((f - e).abs())) / scale
}

type Change = fn(&mut Parameters);

fn machine(change: Change) -> Plant {
    let mut rig = reference::rig();
    change(&mut rig);
    Plant::from_lumped(&rig).unwrap()
}

fn lugre(rig: &mut Parameters) {
    rig.pivot_friction.static_ratio = 1.3;
    rig.pivot_friction.law = FrictionLaw::Lugre {
        coulomb_nm: 117.0,
        bristle_stiffness_nm_rad: 2.4e5,
        bristle_damping_nm_s_rad: 500.0,
    };
}

fn reset(rig: &mut Parameters) {
    rig.pivot_friction.law =
        FrictionLaw::ResetIntegrator { coulomb_nm: 117.0, deflection_rad: 5e-4, damping_nm_s_rad: 0.0 };
}

fn everything(rig: &mut Parameters) {
    rig.motor.cogging = Ripple { amplitude: 0.16, order: 6.0, phase_rad: 0.7 };
    rig.motor.torque_ripple = Ripple { amplitude: 0.02, order: 12.0, phase_rad: 0.0 };
    rig.motor.platform_coupling = 1.0;
    rig.gearbox.mesh_ripple = Ripple { amplitude: 10.0, order: 20.0, phase_rad: 0.0 };
    rig.pivot_friction.asymmetry = 0.1;
    rig.pivot_friction.quadratic_nm_s2_rad2 = 200.0;
    rig.pivot_friction.load_coefficient = 0.01;
    rig.pivot_friction.warm_up = 0.2;
    let lumped = rig.lumped.as_mut().unwrap();
    lumped.vertical_offset_kg_m = 20.0;
    lumped.position_stiffness_nm_rad = 900.0;
}

/// Free functions at every place, curved and of every kind.
fn free_functions(rig: &mut Parameters) {
    use LearnedPlace::{Gearbox, Motor, Pivot};
    use LearnedQuantity::{Damping, FrictionLevel, Stiffness, Torque, TorqueConstant};
    use RegimeVariable::{Angle, Control, Load, Rate, Time, Turn};
    let mut add = |place, quantity, variable, reach: f64, of: fn(f64) -> f64| {
        let points: Vec<f64> = (0..25).map(|k| reach * f64::from(k - 12) / 12.0).collect();
        let points = if variable == Turn { points.iter().map(|x| 3.1 + 0.25 * x).collect() } else { points };
        let values = points.iter().map(|x| of(x / reach)).collect();
        rig.learned
            .push(LearnedElement { values, ..LearnedElement::neutral(place, quantity, variable, points) });
    };
    add(Pivot, FrictionLevel, Angle, 0.1, |x| 1.0 + 0.4 * (-9.0 * x * x).exp());
    add(Pivot, Torque, Rate, 0.2, |x| -60.0 * x * x * x);
    add(Pivot, Torque, Angle, 0.1, |x| 80.0 * (4.0 * x).sin());
    add(Motor, FrictionLevel, Load, 20.0, |x| 1.0 + 0.2 * x * x);
    add(Motor, Torque, Turn, 12.0, |x| 0.1 * (std::f64::consts::TAU * 12.0 * x).sin());
    add(Motor, TorqueConstant, Control, 8.0, |x| 1.0 - 0.1 * x * x);
    add(Motor, Damping, Time, 1.0, |x| 1.0 + 0.3 * x);
    add(Gearbox, Stiffness, Load, 4000.0, |x| 1.0 + 0.2 * x);
}

#[test]
fn every_friction_agrees_with_small_runge_kutta_steps() {
    let machines: [(&str, Change, f64); 6] = [
        ("Dahl", |_| {}, 1e-7),
        (
            "Dahl with a Stribeck level",
            |rig| {
                rig.pivot_friction.static_ratio = 1.55;
                rig.pivot_friction.stribeck_rate_rad_s = 0.012;
            },
            2e-6,
        ),
        ("LuGre", lugre, 1e-5),
        // the second method overshoots the bond's limit by up to a step, which costs it an error of first order
        ("reset integrator", reset, 2e-5),
        ("everything", everything, 1e-4),
        ("free functions", free_functions, 1e-4),
    ];
    for (name, change, allowed) in machines {
        let plant = machine(change);
        let scenario = shaken(1.0);
        let substeps = if name.starts_with("reset") { 200 } else { 40 };
        let expected = runge_kutta(&plant, &scenario, substeps);
        let found = simulate_plant(&plant, &scenario, TOLERANCE);
        let error = error(found.truth.hub_rate_rad_s(), &expected);
        println!("{name}: {error:.1e} {:?}", found.effort);
        assert!(error < allowed, "{name}: {error:e}");
    }
}

/// Nearly balanced, the teeth part and meet dozens of times: the second method needs short steps, for it does not
/// find the instants.
#[test]
fn contact_agrees_with_very_small_runge_kutta_steps() {
    let plant = machine(|rig| rig.lumped.as_mut().unwrap().out_of_balance_kg_m = 2.0);
    let scenario = shaken(1.0);
    let found = simulate_plant(&plant, &scenario, TOLERANCE).truth;
    assert!(found.contact().windows(2).filter(|w| w[0] != w[1]).count() > 10);
    let coarse = error(found.hub_rate_rad_s(), &runge_kutta(&plant, &scenario, 50));
    let fine = error(found.hub_rate_rad_s(), &runge_kutta(&plant, &scenario, 400));
    println!("contact: {coarse:.1e} against 50, {fine:.1e} against 400 steps a sample");
    assert!(fine < 1e-4 && fine < coarse);
}

/// The hub rate after 0.2 s under a constant control with a sample period of `period_ms`, one step a sample.
fn coasting_rate(change: Change, period_s: f64) -> f64 {
    let mut rig = reference::rig();
    change(&mut rig);
    rig.interface.sample_period_s = period_s;
    let plant = Plant::from_lumped(&rig).unwrap();
    let scenario = Scenario { platform: shaken(1.0).platform, ..Scenario::at_rest(0.2) };
    let scenario = Scenario {
        platform: PlatformMotion { pitch_rate_rad_s: Signal::Constant(-0.05), ..scenario.platform },
        ..scenario
    };
    let control = [6.0];
    let mut playback = Playback::new(&control);
    let history = Simulator::with_tolerance(&plant, 1e9).unwrap().run(&mut playback, &scenario).unwrap();
    let rows = plant.hub_rate_row();
    rows.iter().zip(&history.final_state.core).map(|(c, x)| c * x).sum()
}

#[test]
fn the_order_of_convergence_is_that_of_the_nodes() {
    let machines: [(&str, Change, f64); 2] = [("Dahl", |_| {}, 4.5), ("LuGre", lugre, 1.9)];
    for (name, change, order) in machines {
        let exact = coasting_rate(change, 0.125e-3);
        let errors = [8e-3, 4e-3, 2e-3].map(|period| (coasting_rate(change, period) - exact).abs());
        let observed = (errors[0] / errors[2]).log2() / 2.0;
        println!("{name}: {errors:?} order {observed:.2}");
        assert!(observed > order, "{name}: {observed} {errors:?}");
    }
}

/// What the motor does is stored or lost, with and without friction and backlash, to 0.1 percent of what it does to and fro; the
/// integrals are sums over the samples, whose own error that is.
#[test]
fn energy_balances() {
    let frictionless: Change = |rig| {
        rig.motor_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
        rig.pivot_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    };
    let coulomb: Change = |rig| {
        rig.motor_friction.law = FrictionLaw::Coulomb { coulomb_nm: 0.065 };
        rig.pivot_friction.law = FrictionLaw::Coulomb { coulomb_nm: 117.0 };
    };
    for change in [(|_| {}) as Change, frictionless, coulomb, lugre] {
        for backlash_rad in [0.0, 5e-4] {
            let plant = machine(|rig| rig.lumped.as_mut().unwrap().out_of_balance_kg_m = 0.0);
            let mut rig = plant.parameters().clone();
            change(&mut rig);
            rig.gearbox.backlash_rad = backlash_rad;
            energy_balances_of(&Plant::from_lumped(&rig).unwrap());
        }
    }
}

fn energy_balances_of(plant: &Plant) {
    let rig = plant.parameters();
    let lumped = rig.lumped.as_ref().unwrap();
    let scenario = Scenario { demand_rad_s: Signal::sine(0.1, 6.0), ..Scenario::at_rest(2.0) };
    let mut controller = ProportionalIntegral { bias_v: 0.0, ..controller() };
    let truth = Simulator::new(plant).unwrap().run(&mut controller, &scenario).unwrap().truth;
    let last = truth.hub_rate_rad_s().len() - 1;
    let (mut twist, mut worked, mut supplied) = (0.0, 0.0, 0.0);
    let power = |k: usize| {
        let (motor, hub, tip) =
            (truth.motor_rate_rad_s()[k], truth.hub_rate_rad_s()[k], truth.tip_rate_rad_s()[k]);
        let shaft = rig.motor.torque_constant_nm_a * truth.current_a()[k] * motor;
        let gear = if truth.contact()[k] == 0.0 { 0.0 } else { motor / rig.gearbox.ratio - hub };
        let lost = truth.motor_friction_nm()[k] * motor
            + rig.motor_friction.viscous_nm_s_rad * motor * motor
            + truth.pivot_friction_nm()[k] * hub
            + rig.pivot_friction.viscous_nm_s_rad * hub * hub
            + rig.gearbox.damping_nm_s_rad * gear * gear
            + lumped.damping_nm_s_rad * (hub - tip).powi(2);
        (shaft - lost, shaft.abs())
    };
    for k in 0..last {
        let (here, there) = (power(k), power(k + 1));
        worked += 0.5e-3 * (here.0 + there.0);
        supplied += 0.5e-3 * (here.1 + there.1);
        let slip = |k: usize| truth.hub_rate_rad_s()[k] - truth.tip_rate_rad_s()[k];
        twist += 0.5e-3 * (slip(k) + slip(k + 1));
    }
    let gap = (truth.wind_up_rad()[last].abs() - 0.5 * rig.gearbox.backlash_rad).max(0.0);
    let stored = 0.5
        * (rig.motor.inertia_kg_m2 * truth.motor_rate_rad_s()[last].powi(2)
            + lumped.hub_inertia_kg_m2 * truth.hub_rate_rad_s()[last].powi(2)
            + lumped.beam_inertia_kg_m2 * truth.tip_rate_rad_s()[last].powi(2)
            + rig.gearbox.stiffness_nm_rad * gap * gap
            + lumped.stiffness_nm_rad * twist * twist);
    println!("stored {stored:.6} J, worked {worked:.6} J of {supplied:.3} J supplied");
    assert!((stored - worked).abs() < 1e-3 * supplied);
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_does_not() {
    let plant = machine(|_| {});
    let noisy = |seed| {
        let imperfections = Imperfections::NoiseAndQuantisation { seed };
        simulate_plant(&plant, &Scenario { imperfections, ..shaken(0.3) }, TOLERANCE)
    };
    assert_eq!(noisy(3), noisy(3));
    assert_ne!(noisy(3).readings, noisy(4).readings);
}

/// The FE and the lumped structure differ in the weight's share on the modes only: at rest both stay at rest.
#[test]
fn a_plant_of_many_modes_rests_and_moves() {
    let rig = reference::rig();
    let mut body = Body::from_lumped(rig.lumped.as_ref().unwrap());
    for k in 2..14_i32 {
        body.modes.push(BodyMode {
            frequency_rad_s: 240.0 * f64::from(k * k),
            damping_ratio: 0.01,
            hub_shape: 0.05 / f64::from(k),
            tip_shape: -0.05,
            load_share_kg_m: 0.1 / f64::from(k),
        });
    }
    let plant = Plant::with_body(&rig, body).unwrap();
    let held = plant.equilibrium(&OperatingPoint::default()).control_v;
    let controller = ProportionalIntegral { bias_v: held, ..controller() };
    let still =
        Simulator::new(&plant).unwrap().run(&mut controller.clone(), &Scenario::at_rest(0.5)).unwrap();
    assert!(still.truth.hub_rate_rad_s().iter().all(|w| w.abs() < 1e-9));
    let scenario = shaken(0.5);
    let found = simulate_plant(&plant, &scenario, TOLERANCE);
    let expected = runge_kutta(&plant, &scenario, 200);
    let error = error(found.truth.hub_rate_rad_s(), &expected);
    assert!(error < 1e-5, "{error:e}");
}

#[test]
fn coulomb_friction_holds_an_imbalance_without_creep_and_slides_at_its_level() {
    for ratio in [1.0, 1.4] {
        let plant = machine(|rig| {
            rig.pivot_friction.law = FrictionLaw::Coulomb { coulomb_nm: 117.0 };
            rig.motor_friction.law = FrictionLaw::Karnopp { coulomb_nm: 0.065, stick_rate_rad_s: 0.05 };
        });
        let mut rig = plant.parameters().clone();
        rig.pivot_friction.static_ratio = ratio;
        let plant = Plant::from_lumped(&rig).unwrap();
        // 0.1 V is 52 N m at the hub: friction carries it
        let held = plant.equilibrium(&OperatingPoint::default()).control_v + 0.1;
        let still = Simulator::new(&plant)
            .unwrap()
            .run(&mut Playback::new(&[held]), &Scenario::at_rest(10.0))
            .unwrap();
        // the stick may swing within its own deflection of a microradian, but it goes nowhere in ten seconds
        let mean = |range: std::ops::Range<usize>| {
            let part = &still.truth.hub_angle_rad()[range];
            part.iter().sum::<f64>() / part.len() as f64
        };
        let drift = mean(8000..10_000) - mean(2000..4000);
        assert!(drift.abs() < 1e-6, "{drift:e}");
        assert!(still.truth.hub_angle_rad().iter().all(|angle| angle.abs() < 1e-5));
        let moving = Simulator::new(&plant)
            .unwrap()
            .run(&mut Playback::new(&[held + 0.9]), &Scenario::at_rest(1.0))
            .unwrap();
        assert!(moving.truth.hub_rate_rad_s()[999] > 0.01);
        assert!((moving.truth.pivot_friction_nm()[999] - 117.0).abs() < 1e-6);
        assert!((moving.truth.motor_friction_nm()[999] - 0.065).abs() < 1e-9);
    }
}
