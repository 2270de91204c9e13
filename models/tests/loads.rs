//! Loads beside the weight: torques against their energies, the recoil against Newton's second law.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::loads::equilibrator::{Action, Equilibrator, Force, Gas};
use counterpoise_models::loads::{EndStops, Recoil};
use counterpoise_models::plant::{Angles, FrictionLinearisation, OperatingPoint, Plant};
use counterpoise_models::{Parameters, reference};

fn recoil() -> Recoil {
    Recoil {
        shots_s: vec![1.0],
        impulse_ns: 8000.0,
        shot_time_s: 0.01,
        mass_kg: 460.0,
        length_m: 1.2,
        run_out_s: 1.0,
        height_m: 0.05,
        bore_offset_m: 0.02,
        ahead_m: 0.4,
    }
}

#[test]
fn the_recoil_obeys_newton_and_returns() {
    let of = recoil();
    let step = 1e-6;
    let (mut shot, mut cradle, mut furthest) = (0.0, 0.0, 0.0_f64);
    let mut last = of.at(1.0);
    for k in 1..2_300_000 {
        let now = of.at(1.0 + step * f64::from(k));
        shot += now.shot_n * step;
        cradle += now.cradle_n * step;
        furthest = furthest.max(now.way_m);
        // m v' = B - K and x' = v between neighbours; the run-out ends where nothing moves
        let pushed = (now.rate_m_s - last.rate_m_s) / step * of.mass_kg;
        let force = 0.5 * (now.shot_n + last.shot_n - now.cradle_n - last.cradle_n);
        let size = of.impulse_ns / of.shot_time_s;
        assert!((pushed - force).abs() < 1e-3 * size, "{k}: {pushed} {force}");
        let moved = (now.way_m - last.way_m) / step - 0.5 * (now.rate_m_s + last.rate_m_s);
        assert!(moved.abs() < 1e-3, "{k}: {moved}");
        last = now;
    }
    assert!((shot / of.impulse_ns - 1.0).abs() < 1e-6, "{shot}");
    assert!((cradle / of.impulse_ns - 1.0).abs() < 1e-6, "{cradle}");
    assert!((furthest / of.length_m - 1.0).abs() < 1e-9, "{furthest}");
    assert_eq!(last.way_m, 0.0);
    assert_eq!(of.at(0.999), of.at(9.0));
}

fn equilibrators() -> Vec<Equilibrator> {
    let pins = |anchor_angle_rad: f64, force: Force| Equilibrator {
        arm_m: 0.35,
        arm_angle_rad: -0.3,
        anchor_m: 0.8,
        anchor_angle_rad,
        factor: 1.1,
        force,
    };
    let gas = |acts: Action| {
        Force::Gas(Gas {
            acts,
            pressure_pa: 5e6,
            area_m2: 1e-3,
            volume_m3: 3e-3,
            length_m: 0.75,
            exponent: 1.3,
            charge_temperature_k: 293.0,
            temperature_k: 313.0,
        })
    };
    vec![
        pins(1.6, Force::Spring { stiffness_n_m: 4e3, free_length_m: 0.45 }),
        pins(1.6, gas(Action::Pull)),
        pins(-1.6, gas(Action::Push)),
    ]
}

#[test]
fn torque_and_stiffness_are_slopes() {
    let h = 1e-5;
    for of in equilibrators() {
        for angle in [-0.3, 0.0, 0.4, 1.0] {
            let slope = (of.length_m(angle + h) - of.length_m(angle - h)) / (2.0 * h);
            let work = -of.tension_n(angle) * slope;
            assert!((of.torque_nm(angle) / work - 1.0).abs() < 1e-7, "{angle}: {of:?}");
            assert!(of.torque_nm(angle) > 0.0, "it lifts: {angle} {of:?}");
            let stiffness = -(of.torque_nm(angle + h) - of.torque_nm(angle - h)) / (2.0 * h);
            let found = of.stiffness_nm_rad(angle);
            assert!((found - stiffness).abs() < 1e-5 * of.torque_nm(angle), "{angle}: {found} {stiffness}");
        }
    }
}

/// A gas whose charge is isothermal at another temperature has p t_0/t of the force.
#[test]
fn a_cold_gas_lifts_less() {
    let Some(mut of) = equilibrators().into_iter().nth(1) else { panic!() };
    let warm = of.torque_nm(0.2);
    if let Force::Gas(Gas { temperature_k, .. }) = &mut of.force {
        *temperature_k = 253.0;
    }
    assert!((of.torque_nm(0.2) / warm - 253.0 / 313.0).abs() < 0.02);
}

fn rig(change: impl FnOnce(&mut Parameters)) -> Plant {
    let mut p = reference::rig();
    change(&mut p);
    Plant::from_lumped(&p).unwrap()
}

#[test]
fn the_motor_holds_what_the_equilibrator_leaves() {
    let bare = rig(|_| {});
    let point = OperatingPoint { hub_angle_rad: 0.2, platform_angle_rad: 0.05 };
    for of in equilibrators() {
        let torque = of.torque_nm(0.15);
        let plant = rig(|p| p.loads.equilibrator = Some(of.clone()));
        let [with, without] = [&plant, &bare].map(|plant| plant.equilibrium(&point).mesh_torque_nm);
        assert!((with - (without - torque)).abs() < 1e-9 * torque, "{with} {without} {torque}");
        // the linear plant that keeps its angles has the slope of the torque as a spring
        let of_spring = rig(|p| {
            let structure = p.lumped.as_mut().unwrap();
            structure.position_stiffness_nm_rad = of.stiffness_nm_rad(0.15);
            structure.position_stiffness_centre_rad = 0.15 + torque / of.stiffness_nm_rad(0.15);
        });
        let [a, b] = [&plant, &of_spring].map(|plant| {
            let at = plant.equilibrium(&point);
            plant.linearise(&at, FrictionLinearisation::Viscous, Angles::Keep).unwrap().system.A
        });
        let apart = (&a - &b).norm_max();
        assert!(apart < 1e-9 * a.norm_max(), "{apart}");
    }
}

#[test]
fn what_makes_no_load_is_refused() {
    let refused = |change: &dyn Fn(&mut Parameters)| {
        let mut p = reference::rig();
        change(&mut p);
        Plant::from_lumped(&p).unwrap_err().to_string()
    };
    let stops = EndStops { lower_rad: 0.1, upper_rad: 0.1, stiffness_nm_rad: 1.0, dissipation_s_rad: 0.0 };
    assert!(refused(&|p| p.loads.end_stops = Some(stops)).contains("end_stops.upper"));
    let short = Recoil { length_m: 0.01, ..recoil() };
    assert!(refused(&|p| p.loads.recoil = Some(short.clone())).contains("recoil.length"));
    let quick = Recoil { shots_s: vec![0.0, 0.5], ..recoil() };
    assert!(refused(&|p| p.loads.recoil = Some(quick.clone())).contains("recoil.shots"));
    let mut small = equilibrators()[1].clone();
    if let Force::Gas(Gas { volume_m3, .. }) = &mut small.force {
        *volume_m3 = 2e-4;
    }
    assert!(refused(&|p| p.loads.equilibrator = Some(small.clone())).contains("equilibrator.gas.volume"));
    assert!(refused(&|p| p.drive_limits.slew_v_s = 0.0).contains("slew"));
}
