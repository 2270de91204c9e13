//! The effects of friction act on a machine whatever the law of its friction is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::ProportionalIntegral;
use counterpoise_diagnose::library::{Component, EffectName, find_effects};
use counterpoise_models::{Friction, FrictionLaw, Parameters, Plant, StribeckCurve, reference};
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

const COULOMB_NM: f64 = 117.0;
const GROWTH: f64 = 1.4;

fn every_law() -> [(&'static str, FrictionLaw); 8] {
    let coulomb_nm = COULOMB_NM;
    let deflection_rad = 5e-4;
    let stiffness = coulomb_nm / deflection_rad;
    [
        ("Dahl", FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: stiffness, exponent: 1.0 }),
        (
            "LuGre",
            FrictionLaw::Lugre {
                coulomb_nm,
                bristle_stiffness_nm_rad: stiffness,
                bristle_damping_nm_s_rad: 2e-3 * stiffness,
            },
        ),
        ("Coulomb", FrictionLaw::Coulomb { coulomb_nm }),
        ("Stribeck", FrictionLaw::Stribeck { coulomb_nm, curve: StribeckCurve::Tustin }),
        ("Karnopp", FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s: 1e-4 }),
        ("Walrath", FrictionLaw::Walrath { coulomb_nm, time_constant_s: 0.02, smoothing_rate_rad_s: 4e-3 }),
        (
            "reset integrator",
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, damping_nm_s_rad: 0.0 },
        ),
        ("bristles", FrictionLaw::Bristle { coulomb_nm, bristles: 12, bond_rad: 2.0 * deflection_rad }),
    ]
}

/// The reference rig with a law at its pivot, and the same law at a motor whose level is that of the rig.
fn machine(law: &FrictionLaw) -> Parameters {
    let mut rig = reference::rig();
    let motor_nm = rig.motor_friction.coulomb_nm();
    rig.pivot_friction = Friction::with_viscous_part(law.clone(), rig.pivot_friction.viscous_nm_s_rad);
    rig.motor_friction.law = law.clone();
    rig.motor_friction.law.set_coulomb_nm(motor_nm);
    rig
}

/// The control of the rig's test controller under a triangle of demand.
fn control_v(machine: &Parameters) -> Vec<f64> {
    let plant = Plant::from_lumped(machine).unwrap();
    let mut controller = ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v: plant.equilibrium(&Default::default()).control_v,
        sample_period_s: machine.interface.sample_period_s,
        ..ProportionalIntegral::default()
    };
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.15, period_s: 0.4 },
        imperfections: Imperfections::None,
        detail: Detail::Recording,
        ..Scenario::at_rest(0.4)
    };
    Simulator::new(&plant).unwrap().run(&mut controller, &scenario).unwrap().readings.control_v().to_vec()
}

/// The torque that a volt of control makes at a joint at rest, N m/V.
fn torque_per_volt_nm(machine: &Parameters, component: Component) -> f64 {
    let motor = machine.motor.torque_constant_nm_a * machine.amplifier.stall_gain_a_v(&machine.motor);
    if component == Component::Motor { motor } else { machine.gearbox.ratio * motor }
}

#[test]
fn another_coulomb_level_is_an_effect_on_machines_of_every_law() {
    for component in [Component::Pivot, Component::Motor] {
        let effect = find_effects(component, EffectName::Coulomb).next().unwrap();
        for (name, law) in every_law() {
            let model = machine(&law);
            let level = effect.values(&model)[0];
            let changed = effect.apply_to(&model, &[GROWTH * level]);
            assert_eq!(effect.values(&changed), [GROWTH * level], "{component:?}, {name}");
            let (before, after) = (control_v(&model), control_v(&changed));
            let apart = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let expected = (GROWTH - 1.0) * level / torque_per_volt_nm(&model, component);
            println!("{component:?}, {name}: {apart:.3} V, level alone {expected:.3} V");
            assert!(
                apart > 0.5 * expected,
                "{component:?}, {name}: {apart} V in place of about {expected} V"
            );
        }
    }
}

#[test]
fn another_presliding_stiffness_is_an_effect_on_machines_with_presliding() {
    let effect = find_effects(Component::Pivot, EffectName::PreslidingStiffness).next().unwrap();
    for (name, law) in every_law() {
        let model = machine(&law);
        let stiffness = effect.values(&model)[0];
        let changed = effect.apply_to(&model, &[2.0 * stiffness]);
        if model.pivot_friction.presliding_stiffness_nm_rad().is_some() {
            let read = effect.values(&changed)[0];
            assert!((read / (2.0 * stiffness) - 1.0).abs() < 1e-14, "{name}: {read}");
            assert_ne!(control_v(&model), control_v(&changed), "{name}");
        } else {
            assert_eq!((stiffness, &changed), (0.0, &model), "{name}");
        }
    }
}
