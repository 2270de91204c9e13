//! The plant: equilibrium, linearisation against differences of the right-hand side, closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::plant::core::state;
use counterpoise_models::{
    Angles, Error, Excitation, FrictionLaw, FrictionLinearisation, LinearPlant, MapPoint, Mesh,
    OperatingPoint, Parameters, Plant, reference,
};

fn plant() -> Plant {
    Plant::from_lumped(&reference::rig()).unwrap()
}

fn at(hub: f64, platform: f64) -> OperatingPoint {
    OperatingPoint { hub_angle_rad: hub, platform_angle_rad: platform }
}

fn full_state(plant: &Plant, point: &OperatingPoint) -> Vec<f64> {
    let mut x = plant.equilibrium(point).core_state;
    x.resize(plant.order(), 0.0);
    x
}

fn excitation(plant: &Plant, point: &OperatingPoint) -> Excitation {
    Excitation {
        control_v: plant.equilibrium(point).control_v,
        platform_angle_rad: point.platform_angle_rad,
        ..Excitation::default()
    }
}

#[test]
fn the_first_modes_are_the_rigs() {
    let plant = plant();
    let pinned = plant.body().modes[0].frequency_rad_s / std::f64::consts::TAU;
    assert!((pinned - 37.9).abs() < 0.05, "{pinned}");
    let lumped = reference::rig().lumped.unwrap();
    let locked = (lumped.stiffness_nm_rad / lumped.beam_inertia_kg_m2).sqrt() / std::f64::consts::TAU;
    assert!((locked - 17.6).abs() < 0.05, "{locked}");
}

#[test]
fn the_motor_holds_the_out_of_balance_at_rest() {
    let plant = plant();
    let still = plant.equilibrium(&at(0.0, 0.0));
    // mu g / (N K_t 3 A/V), and the recording controller's bias
    let expected = 151.67 * 9.80665 / (200.0 * 0.86) * (0.8 / 30.0 + 0.3067);
    assert!((still.control_v - expected).abs() < 1e-12);
    assert!((still.control_v - 2.88).abs() < 0.005);
    for point in [at(0.0, 0.0), at(0.2, -0.1), at(-0.3, 0.05)] {
        let x = full_state(&plant, &point);
        let mut dx = vec![1.0; x.len()];
        plant.derivative(&x, &excitation(&plant, &point), &mut dx);
        assert!(dx.iter().all(|d| d.abs() < 1e-7), "{point:?} {dx:?}");
    }
}

#[test]
fn every_machine_rests_at_its_equilibrium() {
    let mut rig = reference::rig();
    let lumped = rig.lumped.as_mut().unwrap();
    lumped.position_stiffness_nm_rad = 900.0;
    lumped.position_stiffness_centre_rad = -0.04;
    lumped.vertical_offset_kg_m = 12.0;
    rig.motor.cogging = counterpoise_models::Ripple { amplitude: 0.16, order: 6.0, phase_rad: 0.7 };
    rig.amplifier.map =
        vec![MapPoint { input_v: 1.0, current_a: 1.2 }, MapPoint { input_v: 2.0, current_a: 6.0 }];
    rig.amplifier.dead_zone_v = 0.1;
    let plant = Plant::from_lumped(&rig).unwrap();
    let point = at(0.1, 0.02);
    let x = full_state(&plant, &point);
    let mut dx = vec![1.0; x.len()];
    plant.derivative(&x, &excitation(&plant, &point), &mut dx);
    assert!(dx.iter().all(|d| d.abs() < 1e-7), "{dx:?}");
}

type Perturbation<'a> = &'a dyn Fn(f64, &mut Vec<f64>, &mut Excitation);

#[test]
fn the_linearisation_is_the_slope_of_the_right_hand_side() {
    let mut rig = reference::rig();
    rig.motor.platform_coupling = -1.0;
    rig.lumped.as_mut().unwrap().vertical_offset_kg_m = 30.0;
    rig.lumped.as_mut().unwrap().position_stiffness_nm_rad = 900.0;
    let plant = Plant::from_lumped(&rig).unwrap();
    let point = at(0.15, 0.0);
    let equilibrium = plant.equilibrium(&point);
    let linear = plant.linearise(&equilibrium, FrictionLinearisation::Viscous, Angles::Keep).unwrap();
    let (x, u) = (full_state(&plant, &point), excitation(&plant, &point));
    let slope = |change: &dyn Fn(f64, &mut Vec<f64>, &mut Excitation), step: f64| {
        let ends = [-step, step].map(|s| {
            let (mut xs, mut us) = (x.clone(), u);
            change(s, &mut xs, &mut us);
            let mut dx = vec![0.0; xs.len()];
            plant.derivative(&xs, &us, &mut dx);
            dx
        });
        ends[1].iter().zip(&ends[0]).map(|(b, a)| (b - a) / (2.0 * step)).collect::<Vec<_>>()
    };
    let n = plant.core_order();
    let scale = linear.system.A.norm_max();
    for j in 0..n {
        let column = slope(&|s, xs, _| xs[j] += s, 1e-6);
        for i in 0..n {
            // the hub angle moves the relative angle too
            let mut expected = linear.system.A[(i, j)];
            expected += linear.system.A[(i, n)] * plant.hub_angle_row()[j];
            // friction's own states are not in the linear plant, but its torque at rest is zero
            assert!((column[i] - expected).abs() < 1e-7 * scale, "A[{i},{j}] {} {expected}", column[i]);
        }
    }
    let inputs: [Perturbation; 3] =
        [&|s, _, us| us.control_v += s, &|s, _, us| us.heave_m_s2 += s, &|s, _, us| {
            us.platform_rate_rad_s += s
        }];
    for (j, change) in inputs.iter().enumerate() {
        let column = slope(change, 1e-5);
        for i in 0..n {
            let expected = linear.system.B[(i, j)];
            assert!((column[i] - expected).abs() < 1e-6 * linear.system.B.norm_max(), "B[{i},{j}]");
        }
    }
}

#[test]
fn without_angles_the_plant_has_no_free_integrator() {
    let plant = plant();
    let equilibrium = plant.equilibrium(&at(0.0, 0.0));
    let linear = plant.linearise(&equilibrium, FrictionLinearisation::Viscous, Angles::Drop).unwrap();
    assert_eq!(linear.system.order(), 7);
    assert_eq!(linear.state_names.len(), 7);
    // static hub rate per volt: all of the torque goes into viscous friction and back-EMF
    let state_matrix = &linear.system.A;
    let gain = counterpoise_linalg::solve(state_matrix, &linear.system.B).unwrap();
    let hub = -(&linear.system.C * &gain)[(LinearPlant::HUB_RATE, LinearPlant::CONTROL)];
    // volts to hub rate: N K_t 3 / (F_vp + N^2 (F_vm + 3 ... back-EMF))
    let stall = 30.0 / (0.8 + 30.0 * 0.3067);
    let back = 0.86 / (0.8 + 30.0 * 0.3067);
    let expected = 200.0 * 0.86 * stall / (60.0 + 200.0 * 200.0 * (0.002 + 0.86 * back));
    assert!((hub / expected - 1.0).abs() < 1e-9, "{hub} {expected}");
}

#[test]
fn dahls_describing_function_dissipates_the_closed_forms_energy() {
    let plant = plant();
    let equilibrium = plant.equilibrium(&at(0.0, 0.0));
    let (amplitude, frequency) = (2e-3, 5.0);
    let choice = FrictionLinearisation::DescribingFunction {
        hub_amplitude_rad: amplitude,
        frequency_rad_s: frequency,
    };
    let viscous = plant.linearise(&equilibrium, FrictionLinearisation::Viscous, Angles::Keep).unwrap();
    let dry = plant.linearise(&equilibrium, choice, Angles::Keep).unwrap();
    let change = &dry.system.A - &viscous.system.A;
    let damping = -change[(state::MOTOR, state::MOTOR)] * 4.0e-3;
    let (level, stiffness, travel) = (0.065, 1.3, 200.0 * amplitude);
    let energy: f64 = 4.0 * level * (travel - level / stiffness * (stiffness * travel / level).tanh());
    let expected = energy / (std::f64::consts::PI * frequency * travel * travel);
    assert!((damping / expected - 1.0).abs() < 1e-4, "{damping} {expected}");
    assert!(change[(state::MOTOR, state::WINDUP)] < 0.0);
}

#[test]
fn the_gap_passes_no_torque() {
    let plant = plant();
    assert_eq!(plant.mesh(0.2e-3), (Mesh::Free, 0.0));
    assert_eq!(plant.mesh_torque_nm(0.2e-3, 0.1, 3.0, 0.0), 0.0);
    let beyond = plant.mesh_torque_nm(0.35e-3, 0.0, 0.0, 0.0);
    assert!((beyond - 2.4e6 * 0.1e-3).abs() < 1e-9);
    assert!((plant.mesh_torque_nm(-0.35e-3, 0.0, 0.0, 0.0) + beyond).abs() < 1e-9);
}

#[test]
fn the_amplifier_map_and_its_inverse_agree() {
    let mut rig = reference::rig();
    rig.amplifier.dead_zone_v = 0.05;
    rig.amplifier.map =
        vec![MapPoint { input_v: 0.5, current_a: 0.9 }, MapPoint { input_v: 2.0, current_a: 6.0 }];
    for control in [-3.0, -1.2, -0.3, 0.2, 0.55, 0.9, 2.5] {
        let drive = rig.amplifier.drive_v(control, &rig.motor);
        let back = rig.amplifier.control_v(drive, &rig.motor);
        assert!((back - control).abs() < 1e-12, "{control} {drive} {back}");
    }
    assert_eq!(rig.amplifier.drive_v(0.04, &rig.motor), 0.0);
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    type Change = fn(&mut Parameters);
    let cases: [(&str, Change); 7] = [
        ("lumped.hub_inertia_kg_m2", |p| p.lumped.as_mut().unwrap().hub_inertia_kg_m2 = 0.0),
        ("gearbox.backlash_rad", |p| p.gearbox.backlash_rad = -1e-3),
        ("motor.inductance_h", |p| p.motor.inductance_h = f64::NAN),
        ("amplifier.map[0].input_v", |p| {
            p.amplifier.map = vec![MapPoint { input_v: -1.0, current_a: 1.0 }];
        }),
        ("pivot_friction.asymmetry", |p| p.pivot_friction.asymmetry = 1.5),
        ("interface.input_bits", |p| p.interface.input_bits = 0),
        ("motor_friction.rest_stiffness_nm_rad", |p| {
            p.motor_friction.law =
                FrictionLaw::Dahl { coulomb_nm: 1.0, rest_stiffness_nm_rad: 0.0, exponent: 1.0 };
        }),
    ];
    for (path, change) in cases {
        let mut rig = reference::rig();
        change(&mut rig);
        match Plant::from_lumped(&rig) {
            Err(Error::Parameter { parameter, .. }) => assert_eq!(parameter, path),
            other => panic!("{path}: {other:?}"),
        }
    }
    let rig = Parameters { lumped: None, ..reference::rig() };
    assert!(matches!(Plant::from_lumped(&rig), Err(Error::NoStructure)));
}

#[test]
fn an_ideal_current_source_drives_its_current_whatever_the_speed() {
    let mut p = reference::rig();
    p.amplifier.dynamics = counterpoise_models::AmplifierDynamics::IdealCurrent;
    let (modelled, ideal) = (Plant::from_lumped(&reference::rig()).unwrap(), Plant::from_lumped(&p).unwrap());
    let point = OperatingPoint::default();
    let (a, b) = (modelled.equilibrium(&point), ideal.equilibrium(&point));
    assert_eq!((a.control_v, a.current_a), (b.control_v, b.current_a), "the static gain is the same");
    // with no friction the motor's back-EMF and the armature's lag are all that a step of control feels
    let linear = ideal.linearise(&b, FrictionLinearisation::Viscous, Angles::Drop).unwrap().system;
    let current = linear.A.column(1);
    let held: Vec<f64> = (0..linear.order()).filter(|&j| j != 1).map(|j| linear.A[(1, j)]).collect();
    assert!(held.iter().all(|a| *a == 0.0), "nothing but its input moves the current: {held:?}");
    assert!(current[1] <= -9e4);
    let gain = linear.B[(1, LinearPlant::CONTROL)] / -current[1];
    assert!((gain / p.amplifier.stall_gain_a_v(&p.motor) - 1.0).abs() < 1e-12);
}
