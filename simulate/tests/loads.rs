//! Equilibrator, stops, recoil and the limits of the drive, against closed forms and balances of energy and momentum.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::{Readings, SampledController};
use counterpoise_models::loads::equilibrator::{ATMOSPHERE_PA, Action, Equilibrator, Force, Gas};
use counterpoise_models::loads::{EndStops, Recoil};
use counterpoise_models::plant::core::state;
use counterpoise_models::{
    AmplifierDynamics, COPPER_PER_K, Friction, FrictionLaw, Gearbox, LumpedStructure, MotorHeat, Parameters,
    Plant, RESISTANCE_AT_K, reference,
};
use counterpoise_simulate::{Firing, Initial, Playback, Scenario, Simulator, TimeHistory};

const INERTIA: f64 = 40.0;

/// One rigid inertia without friction, driven by a torque, without weight.
fn body() -> Parameters {
    let mut p = reference::rig();
    let none = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    (p.motor_friction, p.pivot_friction) = (none.clone(), none);
    p.gearbox = Gearbox::DIRECT;
    p.motor.inertia_kg_m2 = 0.0;
    p.beam = None;
    p.lumped = Some(LumpedStructure::rigid(INERTIA));
    p.configurations.clear();
    p.gravity_m_s2 = 0.0;
    p.amplifier.dynamics = AmplifierDynamics::TorqueCommand;
    (p.amplifier.gain, p.motor.torque_constant_nm_a) = (1.0, 1.0);
    p.amplifier.map.clear();
    (p.amplifier.dead_zone_v, p.amplifier.input_limit_v) = (0.0, 10.0);
    p.amplifier.current_limit_a = f64::INFINITY;
    p
}

/// Runs a free body that starts at an angle with a rate.
fn run(p: &Parameters, angle_rad: f64, rate_rad_s: f64, duration_s: f64, control_v: f64) -> TimeHistory {
    let plant = Plant::from_lumped(p).unwrap();
    let mut simulator = Simulator::new(&plant).unwrap();
    let mut start = simulator.rest(angle_rad, 0.0, 0.0);
    start.core[state::RATE] = rate_rad_s;
    let initial = Initial::State(Box::new(start));
    let scenario = Scenario { initial, firing: Firing::Stated, ..Scenario::at_rest(duration_s) };
    simulator.run(&mut Playback::new(&[control_v]), &scenario).unwrap()
}

#[test]
fn a_stop_gives_back_what_its_closed_form_says() {
    for dissipation_s_rad in [0.0, 0.4, 1.5, 6.0] {
        for rate in [0.05_f64, 0.3, -0.8] {
            let stops =
                EndStops { lower_rad: -0.1, upper_rad: 0.1, stiffness_nm_rad: 5e5, dissipation_s_rad };
            let mut p = body();
            p.loads.end_stops = Some(stops);
            let history = run(&p, 0.09 * rate.signum(), rate, 0.05 + 0.02 / rate.abs(), 0.0);
            let turned = history.truth.hub_angle_rad();
            let (c, v) = (dissipation_s_rad, rate.abs());
            let w = -history.truth.hub_rate_rad_s().last().unwrap() * rate.signum();
            assert!(w > 0.0, "{c} {v}: it has not left the stop");
            if c == 0.0 {
                assert!((w / v - 1.0).abs() < 1e-6, "{v}: {w}");
                continue;
            }
            let (left, right) = (c * (v + w), ((1.0 + c * v) / (1.0 - c * w)).ln());
            assert!((left / right - 1.0).abs() < 1e-4, "{c} {v}: {left} {right}");
            let depth = (2.0 * INERTIA / (5e5 * c * c) * (c * v - (1.0 + c * v).ln())).sqrt();
            let deepest = turned.iter().fold(0.0_f64, |most, angle| most.max(angle.abs() - 0.1));
            // the deepest point lies between two samples: it may be missed by v w_n T / 8
            assert!((deepest / depth - 1.0).abs() < 0.01, "{c} {v}: {deepest} {depth}");
        }
    }
}

fn pins(force: Force) -> Equilibrator {
    Equilibrator { arm_m: 0.35, arm_angle_rad: 0.3, anchor_m: 0.8, anchor_angle_rad: 1.6, factor: 1.1, force }
}

const GAS: Force = Force::Gas(Gas {
    acts: Action::Pull,
    pressure_pa: 5e6,
    area_m2: 1e-3,
    volume_m3: 3e-3,
    length_m: 0.75,
    exponent: 1.3,
    charge_temperature_k: 293.0,
    temperature_k: 253.0,
});

/// Energy of an equilibrator at an angle: what has been done against its tension from a length on.
fn stored_energy(of: &Equilibrator, angle_rad: f64) -> f64 {
    let length = of.length_m(angle_rad);
    of.factor
        * match of.force {
            Force::Spring { stiffness_n_m, free_length_m } => {
                0.5 * stiffness_n_m * (length - free_length_m).max(0.0).powi(2)
            }
            Force::Gas(Gas { pressure_pa, area_m2, volume_m3, length_m, exponent, .. }) => {
                let volume = volume_m3 - area_m2 * (length - length_m);
                let warm = pressure_pa * 253.0 / 293.0;
                let of_gas =
                    warm * volume_m3 / (exponent - 1.0) * ((volume_m3 / volume).powf(exponent - 1.0) - 1.0);
                of_gas - ATMOSPHERE_PA * (volume_m3 - volume)
            }
        }
}

#[test]
fn an_equilibrator_conserves_energy() {
    for force in [Force::Spring { stiffness_n_m: 4e3, free_length_m: 0.45 }, GAS] {
        let mut p = body();
        p.gravity_m_s2 = 9.80665;
        let structure = p.lumped.as_mut().unwrap();
        structure.out_of_balance_kg_m = 60.0;
        p.loads.equilibrator = Some(pins(force));
        let of = p.loads.equilibrator.clone().unwrap();
        let plant = Plant::from_lumped(&p).unwrap();
        let control = plant.equilibrium(&counterpoise_models::OperatingPoint::default());
        // the torque that holds the start is left out: the body swings
        assert!(control.current_a.abs() > 1.0, "{control:?}");
        let history = run(&p, 0.0, 0.2, 6.0, 0.0);
        let energy = |k: usize| {
            let (angle, rate) = (history.truth.hub_angle_rad()[k], history.truth.hub_rate_rad_s()[k]);
            0.5 * INERTIA * rate * rate + 60.0 * 9.80665 * angle.sin() + stored_energy(&of, angle)
        };
        let swing = history.truth.hub_angle_rad().iter().fold(0.0_f64, |most, angle| most.max(angle.abs()));
        assert!(swing > 0.2, "{swing}");
        for k in (0..history.len()).step_by(50) {
            assert!((energy(k) - energy(0)).abs() < 1e-6 * 60.0 * 9.8, "{k}: {} {}", energy(k), energy(0));
        }
    }
}

fn recoil() -> Recoil {
    Recoil {
        shots_s: vec![0.0205, 0.5],
        impulse_ns: 800.0,
        shot_time_s: 0.006,
        mass_kg: 50.0,
        length_m: 0.25,
        run_out_s: 0.2,
        height_m: 0.03,
        bore_offset_m: 0.01,
        ahead_m: 0.0,
    }
}

/// Every shot gives the angular momentum (e + o) I, apart from what the mass that moves takes from the inertia.
#[test]
fn a_shot_gives_its_impulse() {
    let mut p = body();
    p.lumped = Some(LumpedStructure::rigid(1e5));
    p.loads.recoil = Some(recoil());
    let history = run(&p, 0.0, 0.0, 1.0, 0.0);
    let momentum = |time_s: f64| 1e5 * history.truth.hub_rate_rad_s()[(1e3 * time_s) as usize];
    let expected = 0.04 * 800.0;
    assert!((momentum(0.45) / expected - 1.0).abs() < 1e-4, "{} {expected}", momentum(0.45));
    assert!((momentum(0.99) / (2.0 * expected) - 1.0).abs() < 1e-4, "{}", momentum(0.99));
    let plant = Plant::from_lumped(&p).unwrap();
    let silent =
        Simulator::new(&plant).unwrap().run(&mut Playback::new(&[0.0]), &Scenario::at_rest(1.0)).unwrap();
    assert!(silent.truth.hub_rate_rad_s().iter().all(|rate| *rate == 0.0));
}

/// The mass that moves back lightens the nose: over a shot, weight x way of the mass acts beside the impulse.
#[test]
fn the_recoiling_mass_takes_its_weight_with_it() {
    let mut p = body();
    p.lumped = Some(LumpedStructure::rigid(1e5));
    p.gravity_m_s2 = 9.80665;
    let flat = Recoil { height_m: 0.0, bore_offset_m: 0.0, shots_s: vec![0.0205], ..recoil() };
    p.loads.recoil = Some(flat.clone());
    let history = run(&p, 0.0, 0.0, 0.4, 0.0);
    let way: f64 = (0..400_000).map(|k| flat.at(1e-6 * f64::from(k)).way_m * 1e-6).sum();
    let expected = 50.0 * 9.80665 * way;
    let momentum = 1e5 * history.truth.hub_rate_rad_s().last().unwrap();
    assert!((momentum / expected - 1.0).abs() < 1e-3, "{momentum} {expected}");
}

/// A control of one value at every sample.
struct Constant(f64);

impl SampledController for Constant {
    fn reset(&mut self) {}

    fn step(&mut self, _: &Readings) -> f64 {
        self.0
    }
}

#[test]
fn a_drive_folds_its_current_back_to_the_lasting_one() {
    let mut p = body();
    p.lumped = Some(LumpedStructure::rigid(1e6));
    p.amplifier.current_limit_a = 9.0;
    (p.drive_limits.continuous_current_a, p.drive_limits.overload_time_s) = (4.0, 2.0);
    let plant = Plant::from_lumped(&p).unwrap();
    let history = Simulator::new(&plant).unwrap().run(&mut Constant(8.0), &Scenario::at_rest(20.0)).unwrap();
    let average = history.truth.overload_a2();
    // until it folds back, the average of the square is that of a constant current
    for k in [100, 300, 450] {
        let expected = 64.0 * (1.0 - (-1e-3 * k as f64 / 2.0).exp());
        assert!((average[k] / expected - 1.0).abs() < 1e-9, "{k}: {} {expected}", average[k]);
    }
    let last = *history.truth.highest_current_a().last().unwrap();
    assert!((4.0..4.2).contains(&last), "{last}");
    assert!(average.iter().all(|square| *square <= 16.0 + 1e-9));
    // the torque that arrives is that current's: over the last seconds the body gains it times the time
    let rates = history.truth.hub_rate_rad_s();
    let gained = 1e6 * (rates[19_900] - rates[19_400]) / 0.5;
    assert!((gained / last - 1.0).abs() < 1e-3, "{gained} {last}");
}

/// The winding on a housing that hardly warms: C T' = R (1 + a (T - 25 deg C)) i^2 - (T - T_h)/R_w is linear in T.
#[test]
fn a_winding_warms_by_its_closed_form_and_holds_its_limit() {
    let heat = MotorHeat {
        winding_k_w: 0.5,
        housing_k_w: 1.0,
        winding_time_s: 5.0,
        housing_time_s: 1e9,
        ambient_k: 293.15,
        start_k: 293.15,
        limit_k: 390.0,
    };
    let mut p = body();
    p.lumped = Some(LumpedStructure::rigid(1e6));
    p.motor.resistance_ohm = 2.0;
    p.drive_limits.heat = Some(heat);
    p.amplifier.current_limit_a = 9.0;
    let plant = Plant::from_lumped(&p).unwrap();
    let mut simulator = Simulator::new(&plant).unwrap();
    let history = simulator.run(&mut Constant(6.0), &Scenario::at_rest(8.0)).unwrap();
    let (loss, rise) = (2.0 * 36.0, 293.15 - RESISTANCE_AT_K);
    let decay = 1.0 / 5.0 - loss * COPPER_PER_K * 0.5 / 5.0;
    let drive = loss * (1.0 + COPPER_PER_K * rise) * 0.5 / 5.0;
    for k in [500, 2500, 7500] {
        let expected = 293.15 + drive / decay * (1.0 - (-decay * 1e-3 * k as f64).exp());
        let found = history.truth.winding_k()[k];
        assert!((found - expected).abs() < 1e-5, "{k}: {found} {expected}");
    }
    let hotter = MotorHeat { housing_time_s: 20.0, ..heat };
    p.drive_limits.heat = Some(hotter);
    let plant = Plant::from_lumped(&p).unwrap();
    let history = Simulator::new(&plant).unwrap().run(&mut Constant(9.0), &Scenario::at_rest(200.0)).unwrap();
    let last = *history.truth.winding_k().last().unwrap();
    assert!((380.0..=390.0).contains(&last), "{last}");
    assert!(history.truth.winding_k().iter().all(|winding| *winding <= 391.0));
    let lasting = hotter.lasting_current_a(2.0);
    let current = *history.truth.highest_current_a().last().unwrap();
    assert!(current >= lasting && current < 1.1 * lasting, "{current} {lasting}");
}

#[test]
fn speed_power_and_slew_are_limited() {
    let mut p = body();
    p.drive_limits.motor_rate_rad_s = 0.5;
    let plant = Plant::from_lumped(&p).unwrap();
    let history = Simulator::new(&plant).unwrap().run(&mut Constant(8.0), &Scenario::at_rest(6.0)).unwrap();
    let fastest = history.truth.hub_rate_rad_s().iter().fold(0.0_f64, |most, rate| most.max(*rate));
    assert!((0.475..0.526).contains(&fastest), "{fastest}");
    let mut p = body();
    (p.motor.back_emf_v_s_rad, p.motor.resistance_ohm) = (1.0, 2.0);
    p.drive_limits.supply_power_w = 20.0;
    let plant = Plant::from_lumped(&p).unwrap();
    let history = Simulator::new(&plant).unwrap().run(&mut Constant(8.0), &Scenario::at_rest(3.0)).unwrap();
    for k in [0, 500, 2500] {
        let (rate, current) = (history.truth.hub_rate_rad_s()[k], history.truth.highest_current_a()[k]);
        let power = 2.0 * current * current + rate * current;
        assert!((power - 20.0).abs() < 1e-6, "{k}: {power}");
    }
    let mut p = body();
    p.drive_limits.slew_v_s = 4.0;
    let plant = Plant::from_lumped(&p).unwrap();
    let history = Simulator::new(&plant).unwrap().run(&mut Constant(3.0), &Scenario::at_rest(1.0)).unwrap();
    // the torque rises by 4 N m/s until it is 3 N m: the momentum is 2 t^2, then 3 t
    let momentum = |k: usize| INERTIA * history.truth.hub_rate_rad_s()[k];
    assert!((momentum(500) / 0.5 - 1.0).abs() < 5e-3, "{}", momentum(500));
    assert!(((momentum(950) - momentum(850)) / 0.3 - 1.0).abs() < 1e-6, "{}", momentum(950));
}
