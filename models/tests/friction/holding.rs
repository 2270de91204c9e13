//! The laws that hold under a constant torque, those that creep, and those that drift under dither.

use super::{Mass, assert_close, dahl, lugre, model, reset_integrator};
use counterpoise_models::friction::FrictionModel;
use counterpoise_models::{Friction, FrictionLaw, StribeckCurve};

/// Positions at the end of the first tenth and at the end of a run under a force.
fn held_positions(
    friction: &FrictionModel,
    duration_s: f64,
    h: f64,
    force: impl Fn(f64) -> f64,
) -> (f64, f64) {
    let mut mass = Mass::new(friction);
    let steps = (duration_s / h).round() as usize;
    let mut early = 0.0;
    for k in 0..steps {
        mass.step(h, &|t, _| force(t));
        if k + 1 == steps / 10 {
            early = mass.state[0];
        }
    }
    (early, mass.state[0])
}

#[test]
fn dahl_holds_at_its_elastic_offset() {
    let law = FrictionLaw::Dahl { coulomb_nm: 2.0, rest_stiffness_nm_rad: 1e3, exponent: 1.0 };
    let friction = FrictionModel::new(&Friction::with_viscous_part(law, 5.0)).unwrap();
    let (early, late) = held_positions(&friction, 1e4, 1e-2, |t| -1.2 * (-t / 20.0).exp_m1());
    assert_close(late, early, 1e-12);
    let offset = -2e-3 * (1.0 - 1.2 / 2.0_f64).ln();
    assert_close(late / offset, 1.0, 1e-3);
}

#[test]
fn lugre_and_the_reset_integrator_hold() {
    for (friction, stiffness) in [(lugre(), 1e5), (reset_integrator(), 1.5e4)] {
        let (early, late) = held_positions(&friction, 200.0, 1e-3, |t| 0.5 * t.min(1.0));
        assert_close(late, early, 1e-10);
        assert!(late < 2.0 * 0.5 / stiffness, "{late}");
    }
}

#[test]
fn lugre_and_dahl_drift_under_dither_and_the_reset_integrator_does_not() {
    let dithered = |t: f64| 0.5 * t.min(1.0) + 0.3 * (std::f64::consts::TAU * t).sin();
    let drift = |friction: &FrictionModel| {
        let (early, late) = held_positions(friction, 100.0, 1e-3, dithered);
        late - early
    };
    assert!(drift(&lugre()) > 1e-5);
    assert!(drift(&dahl(1.0, 1e5, 1.0)) > 1e-5);
    assert_close(drift(&reset_integrator()), 0.0, 1e-9);
}

#[test]
fn walrath_creeps_at_the_rate_that_it_documents() {
    let law = FrictionLaw::Walrath { coulomb_nm: 1.0, time_constant_s: 0.05, smoothing_rate_rad_s: 1e-3 };
    let (early, late) = held_positions(&model(law, 1.0, 1.0), 100.0, 1e-3, |_| 0.5);
    assert_close((late - early) / 90.0 / (1e-3 * 0.5_f64.atanh()), 1.0, 0.01);
}

#[test]
fn laws_without_a_state_hold_up_to_breakaway_in_each_direction() {
    let laws = [
        FrictionLaw::Coulomb { coulomb_nm: 2.0 },
        FrictionLaw::Karnopp { coulomb_nm: 2.0, stick_rate_rad_s: 1e-4 },
        FrictionLaw::Stribeck { coulomb_nm: 2.0, curve: StribeckCurve::Tustin },
    ];
    for law in laws {
        let stick = model(law, 1.5, 0.01).stick(1.0).unwrap();
        assert!(stick.holds(2.99) && stick.holds(-2.99) && !stick.holds(3.01) && !stick.holds(-3.01));
        assert_eq!(
            (stick.holding_torque_nm(1.0), stick.holding_torque_nm(5.0), stick.holding_torque_nm(-5.0)),
            (1.0, 3.0, -3.0)
        );
    }
}
