//! The common properties of the laws: their Coulomb level, presliding stiffness and state at a torque, read and written.

use super::assert_close;
use counterpoise_models::friction::describing_function::sinusoidal_loop;
use counterpoise_models::friction::{FrictionModel, Similarity};
use counterpoise_models::{Friction, FrictionLaw, StribeckCurve};

const COULOMB_NM: f64 = 2.0;
const STATIC_RATIO: f64 = 1.5;

/// Every law with a breakaway level above its sliding level.
fn every_law() -> Vec<(&'static str, Friction)> {
    let coulomb_nm = COULOMB_NM;
    let laws = [
        ("Dahl", FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: 1e4, exponent: 1.0 }),
        (
            "LuGre",
            FrictionLaw::Lugre { coulomb_nm, bristle_stiffness_nm_rad: 1e4, bristle_damping_nm_s_rad: 1.0 },
        ),
        ("Coulomb", FrictionLaw::Coulomb { coulomb_nm }),
        ("Gaussian", FrictionLaw::Stribeck { coulomb_nm, curve: StribeckCurve::Gaussian }),
        (
            "polynomial",
            FrictionLaw::Stribeck {
                coulomb_nm,
                curve: StribeckCurve::Polynomial { coefficients: [-0.8, 0.4, -0.1] },
            },
        ),
        ("Karnopp", FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s: 1e-5 }),
        ("Walrath", FrictionLaw::Walrath { coulomb_nm, time_constant_s: 0.02, smoothing_rate_rad_s: 1e-4 }),
        (
            "reset integrator",
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad: 3e-4, damping_nm_s_rad: 0.5 },
        ),
        ("bristles", FrictionLaw::Bristle { coulomb_nm, bristles: 25, bond_rad: 4e-4 }),
    ];
    let shared = |law| Friction {
        static_ratio: STATIC_RATIO,
        stribeck_rate_rad_s: 1e-3,
        ..Friction::with_viscous_part(law, 0.0)
    };
    laws.into_iter().map(|(name, law)| (name, shared(law))).collect()
}

fn model(friction: &Friction) -> FrictionModel {
    FrictionModel::new(friction).unwrap()
}

/// The largest torque on the way from rest to sliding at a slow rate, N m.
fn breakaway_nm(friction: &FrictionModel) -> f64 {
    if let Some(stick) = friction.stick(1.0) {
        return stick.positive_nm;
    }
    let mut states = vec![0.0; friction.states()];
    let mut peak = 0.0_f64;
    for _ in 0..20_000 {
        friction.advance(1e-6, 0.5, 1.0, &mut states);
        peak = peak.max(friction.torque(1e-6, 1.0, &states));
    }
    peak
}

#[test]
fn setting_the_coulomb_level_scales_sliding_and_breakaway_alike() {
    for (name, friction) in every_law() {
        let mut changed = friction.clone();
        changed.law.set_coulomb_nm(3.0 * COULOMB_NM);
        assert_eq!(changed.coulomb_nm(), 3.0 * COULOMB_NM, "{name}");
        let (before, after) = (model(&friction), model(&changed));
        assert_close(after.steady_torque(1.0), 3.0 * before.steady_torque(1.0), 1e-12);
        assert_close(breakaway_nm(&after) / breakaway_nm(&before), 3.0, 1e-3);
        let mut scaled = friction.clone();
        scaled.law.scale_coulomb(3.0);
        assert_eq!(scaled, changed, "{name}");
    }
}

#[test]
fn the_sliding_level_at_speed_is_the_coulomb_level() {
    for (name, friction) in every_law() {
        // the polynomial ends at its own value at the Stribeck rate
        let expected = if name == "polynomial" { COULOMB_NM * (STATIC_RATIO - 0.5) } else { COULOMB_NM };
        assert_close(model(&friction).steady_torque(1.0), expected, 1e-12);
    }
}

#[test]
fn a_law_without_dry_friction_gains_some_only_when_asked() {
    let mut law = FrictionLaw::None;
    law.set_coulomb_nm(2.0);
    law.scale_coulomb(2.0);
    law.set_or_add_coulomb_nm(0.0);
    assert_eq!(law, FrictionLaw::None);
    law.set_or_add_coulomb_nm(2.0);
    assert_eq!(law, FrictionLaw::Coulomb { coulomb_nm: 2.0 });
    law.scale_coulomb(0.0);
    assert_eq!(law, FrictionLaw::None);
}

#[test]
fn at_the_same_deflection_the_loop_keeps_its_shape() {
    for (name, friction) in every_law() {
        let mut changed = friction.clone();
        changed.law.set_coulomb_at_same_deflection_nm(0.5 * COULOMB_NM);
        assert_eq!(changed.coulomb_nm(), 0.5 * COULOMB_NM, "{name}");
        for amplitude in [1e-4, 1e-2] {
            let stiffness = |f: &Friction| sinusoidal_loop(&model(f), amplitude, 5.0).stiffness_nm_rad;
            let (before, after) = (stiffness(&friction), stiffness(&changed));
            assert_close((after - before * 0.5).norm() / before.norm(), 0.0, 1e-9);
        }
    }
}

#[test]
fn the_presliding_stiffness_is_the_models_and_can_be_set() {
    for (name, friction) in every_law() {
        let own = model(&friction).rest_stiffness_nm_rad();
        let Some(stiffness) = friction.presliding_stiffness_nm_rad() else {
            assert!(own == 0.0 || friction.law.has_true_stick() && own.is_infinite(), "{name}: {own}");
            continue;
        };
        assert_close(stiffness / own, 1.0, 1e-14);
        let mut changed = friction.clone();
        changed.set_presliding_stiffness_nm_rad(7.0 * stiffness);
        assert_close(model(&changed).rest_stiffness_nm_rad() / (7.0 * own), 1.0, 1e-14);
        assert_eq!(changed.coulomb_nm(), COULOMB_NM, "{name}");
    }
}

#[test]
fn a_state_that_carries_a_torque_carries_it() {
    for (name, friction) in every_law() {
        let model = model(&friction);
        let state = friction.state_at_torque(0.7);
        if model.states() != 1 {
            assert_eq!(state, 0.0, "{name}");
            continue;
        }
        assert_close(friction.torque_at_state_nm(state), 0.7, 1e-14);
        assert_close(model.torque(0.0, 1.0, &[state]), 0.7, 1e-14);
        assert!(friction.breakaway_nm() >= 0.7);
    }
}

#[test]
fn a_similar_friction_has_a_similar_loop() {
    let by = Similarity { torque: 1e-3, angle: 0.1 };
    for (_, friction) in every_law() {
        let similar = friction.scale_similarly(by);
        let loops =
            |f: &Friction, amplitude: f64| sinusoidal_loop(&model(f), amplitude, 5.0).stiffness_nm_rad;
        let (own, scaled) = (loops(&friction, 1e-3), loops(&similar, 1e-4));
        assert_close((scaled - own * (by.torque / by.angle)).norm() / scaled.norm(), 0.0, 1e-9);
    }
}
