//! Kinds of machine: closed forms of the rigid, the direct and the linear ones, and their limits.
#![allow(clippy::unwrap_used)]

use counterpoise_linalg::C64;
use counterpoise_lti::{Response, poles};
use counterpoise_models::plant::Body;
use counterpoise_models::plant::core::state;
use counterpoise_models::{
    AmplifierDynamics, Angles, AxisKind, Excitation, FeedbackSignal, Friction, FrictionLaw,
    FrictionLinearisation, Gearbox, LinearPlant, Link, LumpedStructure, OperatingPoint, Parameters, Plant,
    Ripple, Transmission, reference,
};
use std::f64::consts::TAU;

/// One inertia on a motor that takes a torque, 0.4 N m/V.
fn direct(inertia_kg_m2: f64) -> Parameters {
    let mut p = reference::rig();
    (p.beam, p.lumped, p.gearbox) = (None, Some(LumpedStructure::rigid(inertia_kg_m2)), Gearbox::DIRECT);
    p.motor.inertia_kg_m2 = 0.0;
    p.motor.torque_constant_nm_a = 1.0;
    p.amplifier.dynamics = AmplifierDynamics::TorqueCommand;
    p.amplifier.gain = 0.4;
    p.motor_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    p.pivot_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    p
}

fn linear(p: &Parameters, angles: Angles) -> LinearPlant {
    let plant = Plant::from_lumped(p).unwrap();
    let at = plant.equilibrium(&OperatingPoint::default());
    plant.linearise(&at, FrictionLinearisation::Viscous, angles).unwrap()
}

fn response(plant: &LinearPlant, rate: f64, (row, column): (usize, usize)) -> C64 {
    Response::of(&plant.system).unwrap().at(rate).unwrap()[(row, column)]
}

#[test]
fn one_inertia_with_viscous_friction_is_a_first_order_lag() {
    let mut p = direct(0.02);
    p.pivot_friction.viscous_nm_s_rad = 0.05;
    let found = linear(&p, Angles::Drop);
    assert_eq!(found.system.order(), 1, "{:?}", found.state_names);
    for rate in [0.1, 2.5, 40.0] {
        let expected = 0.4 / (C64::new(0.05, 0.02 * rate));
        let h = response(&found, rate, (LinearPlant::HUB_RATE, LinearPlant::CONTROL));
        assert!((h - expected).norm() < 1e-12 * expected.norm(), "{h} {expected}");
        // the platform drags by the friction alone
        let expected = 0.05 / C64::new(0.05, 0.02 * rate);
        let h = response(&found, rate, (LinearPlant::HUB_RATE, LinearPlant::PITCH_RATE));
        assert!((h - expected).norm() < 1e-12, "{h} {expected}");
    }
}

#[test]
fn a_rotor_on_the_platform_drags_a_rigid_hub_by_its_share_of_the_inertia() {
    // a rotor of 1e-3 behind a rigid gear of 5 on a load of 0.075: 0.1 kg m^2 in all, of which the gear drags 0.025
    for (coupling, dragged) in [(0.0, 0.25), (1.0, 0.25 - 0.05)] {
        let mut p = direct(0.075);
        (p.gearbox.ratio, p.motor.inertia_kg_m2, p.motor.platform_coupling) = (5.0, 1e-3, coupling);
        let plant = linear(&p, Angles::Drop);
        let h = response(&plant, 30.0, (LinearPlant::HUB_RATE, LinearPlant::PITCH_RATE));
        assert!((h - dragged).norm() < 1e-12, "{h}");
        let torque = response(&plant, 30.0, (LinearPlant::HUB_RATE, LinearPlant::CONTROL));
        assert!((torque - 5.0 * 0.4 / C64::new(0.0, 3.0)).norm() < 1e-12, "{torque}");
    }
}

#[test]
fn a_rigid_gear_is_the_limit_of_a_stiff_one() {
    let mut rigid = reference::rig();
    rigid.gearbox.backlash_rad = 0.0;
    rigid.motor.platform_coupling = 1.0;
    let stiff = |stiffness_nm_rad: f64| {
        let mut p = rigid.clone();
        p.gearbox.stiffness_nm_rad = stiffness_nm_rad;
        linear(&p, Angles::Drop)
    };
    let exact = stiff(f64::INFINITY);
    let error = |stiffness: f64, entry: (usize, usize), rate: f64| {
        let expected = response(&exact, rate, entry);
        (response(&stiff(stiffness), rate, entry) - expected).norm() / expected.norm()
    };
    for entry in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 2)] {
        for rate in [1.0, 20.0, 150.0] {
            let (coarse, fine) = (error(1e10, entry, rate), error(1e11, entry, rate));
            assert!(fine < 1e-3, "{entry:?} {rate}: {fine}");
            assert!(fine < 0.2 * coarse + 1e-8, "{entry:?} {rate}: {coarse} {fine}");
        }
    }
    assert_eq!(exact.system.order() + 2, stiff(1e10).system.order());
}

#[test]
fn a_rotor_added_to_a_modal_structure_is_a_rotor_added_to_its_hub() {
    let lumped = reference::rig().lumped.unwrap();
    let mut heavier = lumped.clone();
    heavier.hub_inertia_kg_m2 += 160.0;
    let (found, expected) =
        (Body::from_lumped(&lumped).with_hub_inertia(160.0).unwrap(), Body::from_lumped(&heavier));
    let (a, b) = (found.modes[0], expected.modes[0]);
    let sign = (a.hub_shape * b.hub_shape).signum();
    let pairs = [
        (found.inertia_kg_m2, expected.inertia_kg_m2),
        (a.frequency_rad_s, b.frequency_rad_s),
        (a.damping_ratio, b.damping_ratio),
        (sign * a.hub_shape, b.hub_shape),
        (sign * a.tip_shape, b.tip_shape),
        (sign * a.load_share_kg_m, b.load_share_kg_m),
    ];
    for (found, expected) in pairs {
        assert!((found - expected).abs() < 1e-10 * expected.abs(), "{found} {expected}");
    }
}

/// Three equal inertias on two equal springs: w^2 = K/J and 3 K/J, with the shapes (1, 0, -1) and (1, -2, 1).
#[test]
fn a_chain_has_the_modes_of_its_matrices() {
    let (inertia, stiffness) = (0.4, 900.0);
    let link = Link { inertia_kg_m2: inertia, stiffness_nm_rad: stiffness, damping_nm_s_rad: 0.5 };
    let mut three = LumpedStructure {
        stiffness_nm_rad: stiffness,
        damping_nm_s_rad: 0.5,
        ..LumpedStructure::rigid(inertia)
    };
    three.beam_inertia_kg_m2 = inertia;
    three.chain = vec![link];
    let body = Body::chain(&three).unwrap();
    assert!((body.inertia_kg_m2 - 3.0 * inertia).abs() < 1e-12 && body.modes.len() == 2);
    let expected =
        [(1.0, 1.0 / 2f64.sqrt(), -1.0 / 2f64.sqrt()), (3.0, 1.0 / 6f64.sqrt(), 1.0 / 6f64.sqrt())];
    for (mode, (multiple, hub, tip)) in body.modes.iter().zip(expected) {
        let frequency = (multiple * stiffness / inertia).sqrt();
        // equal springs and dampers: D = (0.5 / K) K in every mode
        let ratio = 0.5 * frequency * 0.5 / stiffness;
        assert!((mode.frequency_rad_s / frequency - 1.0).abs() < 1e-12, "{mode:?}");
        assert!((mode.damping_ratio / ratio - 1.0).abs() < 1e-9, "{mode:?}");
        assert!((mode.hub_shape * inertia.sqrt() - hub).abs() < 1e-12, "{mode:?}");
        assert!((mode.tip_shape * inertia.sqrt() - tip).abs() < 1e-12, "{mode:?}");
    }
}

/// A chain whose last part is next to nothing is the two inertias before it, and one whose first spring is rigid has them as one body.
#[test]
fn a_chain_with_one_part_less_is_the_structure_without_it() {
    let two = reference::rig().lumped.unwrap();
    let light = Link { inertia_kg_m2: 1e-9, stiffness_nm_rad: 1e3, damping_nm_s_rad: 0.0 };
    let three = Body::chain(&LumpedStructure { chain: vec![light], ..two.clone() }).unwrap();
    let (found, expected) = (three.modes[0], Body::from_lumped(&two).modes[0]);
    for (found, expected) in [
        (found.frequency_rad_s, expected.frequency_rad_s),
        (found.damping_ratio, expected.damping_ratio),
        (found.hub_shape, expected.hub_shape),
        (found.tip_shape, expected.tip_shape),
        (found.load_share_kg_m, expected.load_share_kg_m),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
    let beam = Link {
        inertia_kg_m2: two.beam_inertia_kg_m2,
        stiffness_nm_rad: two.stiffness_nm_rad,
        damping_nm_s_rad: two.damping_nm_s_rad,
    };
    let hub_alone = LumpedStructure {
        beam_inertia_kg_m2: 0.0,
        stiffness_nm_rad: f64::INFINITY,
        damping_nm_s_rad: 0.0,
        chain: vec![beam],
        ..two.clone()
    };
    let (a, b) = (Body::chain(&hub_alone).unwrap().modes[0], expected);
    assert!(
        (a.frequency_rad_s / b.frequency_rad_s - 1.0).abs() < 1e-9
            && (a.tip_shape / b.tip_shape - 1.0).abs() < 1e-9
    );
}

#[test]
fn a_torque_sensor_shows_what_accelerates_and_holds_the_load() {
    // torque = J w' + c w + k theta of the load, whatever drives it; the spring is among the states only where it acts
    for spring in [0.0, 30.0] {
        let mut p = direct(0.4);
        p.gearbox =
            Gearbox { ratio: 20.0, stiffness_nm_rad: 900.0, damping_nm_s_rad: 0.7, ..Gearbox::DIRECT };
        (p.motor.inertia_kg_m2, p.pivot_friction.viscous_nm_s_rad) = (1e-4, 1.5);
        p.lumped.as_mut().unwrap().position_stiffness_nm_rad = spring;
        p.sensors.measured = FeedbackSignal::Torque;
        let plant = Plant::from_lumped(&p).unwrap();
        let found = linear(&p, plant.angles());
        assert_eq!(plant.angles(), if spring == 0.0 { Angles::Drop } else { Angles::Relative });
        for rate in [0.3, 7.0, 60.0, 900.0] {
            let s = C64::new(0.0, rate);
            let at = |row: usize| response(&found, rate, (row, LinearPlant::CONTROL));
            let expected = at(LinearPlant::HUB_RATE) * (s * 0.4 + 1.5 + spring / s);
            let torque = at(found.measured);
            assert!((torque - expected).norm() < 1e-9 * expected.norm(), "{rate}: {torque} {expected}");
        }
    }
}

#[test]
fn a_current_sensor_shows_the_armature_behind_its_inductance() {
    let mut p = direct(0.01);
    p.amplifier.dynamics = AmplifierDynamics::Modelled;
    (p.amplifier.gain, p.amplifier.current_feedback_v_a, p.amplifier.time_constant_s) = (2.0, 0.0, 0.0);
    (p.motor.torque_constant_nm_a, p.motor.back_emf_v_s_rad) = (0.1, 0.1);
    (p.motor.resistance_ohm, p.motor.inductance_h) = (4.0, 3e-3);
    p.sensors.measured = FeedbackSignal::Current;
    let found = linear(&p, Angles::Drop);
    for rate in [0.5, 20.0, 3000.0] {
        let s = C64::new(0.0, rate);
        // u = (L s + R + K^2 / (J s)) i
        let expected = 2.0 / (s * 3e-3 + 4.0 + 0.1 * 0.1 / (s * 0.01));
        let h = response(&found, rate, (found.measured, LinearPlant::CONTROL));
        assert!((h - expected).norm() < 1e-9 * expected.norm(), "{rate}: {h} {expected}");
    }
}

#[test]
fn a_pendulum_swings_at_its_own_frequency() {
    // 0.3 kg at 0.2 m, hanging straight down: the mean angle of a level mechanism is 0, so it hangs at -90 degrees
    let mut p = direct(0.3 * 0.2 * 0.2);
    p.lumped.as_mut().unwrap().out_of_balance_kg_m = 0.3 * 0.2;
    p.sensors.measured = FeedbackSignal::HubPosition;
    let plant = Plant::from_lumped(&p).unwrap();
    let down = OperatingPoint { hub_angle_rad: -0.25 * TAU, platform_angle_rad: 0.0 };
    let at = plant.equilibrium(&down);
    let found = plant.linearise(&at, FrictionLinearisation::Viscous, plant.angles()).unwrap();
    let expected = (p.gravity_m_s2 / 0.2).sqrt();
    for pole in poles(&found.system).unwrap() {
        assert!(pole.re.abs() < 1e-9 && (pole.im.abs() - expected).abs() < 1e-9, "{pole} {expected}");
    }
}

#[test]
fn a_ball_screw_resonates_as_two_masses_do() {
    let mut p = direct(40.0);
    p.axis = AxisKind::Linear;
    let lead = 0.01;
    let ratio = TAU / lead;
    p.gearbox = Gearbox {
        kind: Transmission::BallScrew { lead_m: lead },
        ratio,
        stiffness_nm_rad: 5e7,
        ..Gearbox::DIRECT
    };
    p.motor.inertia_kg_m2 = 6e-4;
    let found = linear(&p, Angles::Drop);
    let rotor_kg = 6e-4 * ratio * ratio;
    let expected = (5e7_f64 * (1.0 / 40.0 + 1.0 / rotor_kg)).sqrt();
    let highest = poles(&found.system).unwrap().iter().map(|p| p.im).fold(0.0, f64::max);
    assert!((highest - expected).abs() < 1e-6 * expected, "{highest} {expected}");
}

#[test]
fn an_armature_without_inductance_brakes_by_its_back_emf() {
    let mut p = direct(0.01);
    p.amplifier.dynamics = AmplifierDynamics::Modelled;
    (p.amplifier.gain, p.amplifier.current_feedback_v_a, p.amplifier.time_constant_s) = (2.0, 0.0, 0.0);
    (p.motor.torque_constant_nm_a, p.motor.back_emf_v_s_rad) = (0.1, 0.1);
    (p.motor.resistance_ohm, p.motor.inductance_h) = (4.0, 0.0);
    let found = linear(&p, Angles::Drop);
    assert_eq!(found.system.order(), 1);
    let h = response(&found, 3.0, (LinearPlant::HUB_RATE, LinearPlant::CONTROL));
    let expected = (0.1 * 2.0 / 4.0) / C64::new(0.1 * 0.1 / 4.0, 0.03);
    assert!((h - expected).norm() < 1e-12, "{h} {expected}");
    // the same with states that are nearly gone
    (p.motor.inductance_h, p.amplifier.time_constant_s) = (1e-7, 1e-8);
    let nearly = linear(&p, Angles::Drop);
    let near = response(&nearly, 3.0, (LinearPlant::HUB_RATE, LinearPlant::CONTROL));
    assert_eq!(nearly.system.order(), 3);
    assert!((near - h).norm() < 1e-6 * h.norm(), "{near} {h}");
}

#[test]
fn every_kind_rests_at_its_equilibrium_and_linearises_as_it_moves() {
    let mut harmonic = reference::rig();
    harmonic.gearbox = Gearbox {
        kind: Transmission::HarmonicDrive,
        kinematic_error: Ripple { amplitude: 1e-4, order: 2.0, phase_rad: 0.3 },
        hysteresis_nm: 20.0,
        hysteresis_stiffness_nm_rad: 3e5,
        backlash_rad: 0.0,
        ..harmonic.gearbox
    };
    let mut rigid = reference::rig();
    (rigid.gearbox.stiffness_nm_rad, rigid.gearbox.backlash_rad) = (f64::INFINITY, 0.0);
    let mut quick = rigid.clone();
    (quick.motor.inductance_h, quick.amplifier.time_constant_s) = (0.0, 0.0);
    quick.amplifier.bus_voltage_v = f64::INFINITY;
    let mut slide = direct(12.0);
    (slide.axis, slide.amplifier.gain) = (AxisKind::Linear, 100.0);
    slide.lumped.as_mut().unwrap().out_of_balance_kg_m = 12.0;
    for p in [harmonic, rigid, quick, slide] {
        let plant = Plant::from_lumped(&p).unwrap();
        for hub in [0.0, 0.2] {
            let point = OperatingPoint { hub_angle_rad: hub, platform_angle_rad: 0.0 };
            let at = plant.equilibrium(&point);
            let mut x = at.core_state.clone();
            x.resize(plant.order(), 0.0);
            let excitation = Excitation { control_v: at.control_v, ..Excitation::default() };
            let mut dx = vec![1.0; x.len()];
            plant.derivative(&x, &excitation, &mut dx);
            assert!(dx.iter().all(|d| d.abs() < 1e-6), "{} {point:?} {dx:?}", p.gearbox.is_rigid());
        }
    }
}

#[test]
fn power_passes_a_wavy_mesh_without_loss() {
    let mut p = reference::rig();
    (p.gearbox.backlash_rad, p.gearbox.damping_nm_s_rad) = (0.0, 0.0);
    p.gearbox.kinematic_error = Ripple { amplitude: 2e-4, order: 2.0, phase_rad: 0.0 };
    let plant = Plant::from_lumped(&p).unwrap();
    let (wind_up, angle, motor_rate, hub_rate) = (3e-4, 0.7, 11.0, 0.04);
    let mesh = plant.mesh_torque_nm(wind_up, hub_rate, motor_rate, 0.0);
    let added = plant.kinematic_error_nm(mesh, angle, motor_rate);
    let motor_nm = -mesh / p.gearbox.ratio + added.motor_nm;
    let power = motor_nm * motor_rate + (mesh + added.hub_nm) * hub_rate;
    // what is not passed on bends the spring: K s s' with s = wind-up + e
    let e = p.gearbox.kinematic_error;
    let stretch = wind_up + e.at(angle);
    let stretching = motor_rate / p.gearbox.ratio - hub_rate + e.slope_at(angle) * motor_rate;
    let stored = p.gearbox.stiffness_nm_rad * stretch * stretching;
    assert!((power + stored).abs() < 1e-9 * stored.abs(), "{power} {stored}");
}

#[test]
fn what_needs_a_mesh_that_gives_says_so() {
    let mut p = direct(0.02);
    p.gearbox.backlash_rad = 1e-3;
    let told = Plant::from_lumped(&p).unwrap_err().to_string();
    assert!(told.contains("gearbox.backlash_rad") && told.contains("gearbox.stiffness"), "{told}");
    let mut p = direct(0.02);
    p.motor_friction = Friction::with_viscous_part(FrictionLaw::Coulomb { coulomb_nm: 0.1 }, 0.0);
    p.pivot_friction = p.motor_friction.clone();
    assert!(Plant::from_lumped(&p).unwrap_err().to_string().contains("truly sticks"));
}

#[test]
fn a_dead_state_stays_out_of_linear_models_and_at_rest() {
    let plant = Plant::from_lumped(&direct(0.02)).unwrap();
    for index in [state::VOLTAGE, state::CURRENT, state::MOTOR, state::WINDUP] {
        assert!(!plant.has_state(index));
    }
    assert!(plant.has_state(state::ANGLE) && plant.has_state(state::RATE));
}
