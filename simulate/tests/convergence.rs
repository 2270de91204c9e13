//! Error against step for every law of friction and for contact, against the classical Runge-Kutta method.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::{FrictionLaw, Parameters, StribeckCurve, reference};
use counterpoise_simulate::convergence::study;

const LEVEL: f64 = 117.0;

fn rig(law: FrictionLaw, static_ratio: f64) -> Parameters {
    let mut rig = reference::rig();
    rig.motor_friction.law = FrictionLaw::None;
    rig.pivot_friction.law = law;
    rig.pivot_friction.static_ratio = static_ratio;
    rig.pivot_friction.stribeck_rate_rad_s = 0.05;
    rig
}

/// The laws, with the control that sets the mechanism in motion, V, and the least order that its error must show where the second
/// method is exact enough to tell.
fn laws() -> Vec<(&'static str, Parameters, f64, f64)> {
    let coulomb_nm = LEVEL;
    let curve = |curve| rig(FrictionLaw::Stribeck { coulomb_nm, curve }, 1.3);
    let dahl = |exponent| FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: 2.4e5, exponent };
    let lugre =
        FrictionLaw::Lugre { coulomb_nm, bristle_stiffness_nm_rad: 2.4e5, bristle_damping_nm_s_rad: 500.0 };
    let reset = FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad: 5e-4, damping_nm_s_rad: 0.0 };
    let walrath = FrictionLaw::Walrath { coulomb_nm, time_constant_s: 0.02, smoothing_rate_rad_s: 0.02 };
    let karnopp = FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s: 1e-3 };
    let mut gap = rig(dahl(1.0), 1.0);
    gap.lumped.as_mut().unwrap().out_of_balance_kg_m = 2.0;
    vec![
        ("Coulomb", rig(FrictionLaw::Coulomb { coulomb_nm }, 1.0), 1.0, 1.9),
        ("Karnopp", rig(karnopp, 1.0), 1.0, 1.9),
        ("Tustin", curve(StribeckCurve::Tustin), 1.0, 1.9),
        ("Gaussian", curve(StribeckCurve::Gaussian), 1.0, 1.9),
        ("Lorentzian", curve(StribeckCurve::Lorentzian), 1.0, 1.9),
        ("exponential", curve(StribeckCurve::Exponential { exponent: 1.5 }), 1.0, 1.9),
        ("Dahl", rig(dahl(1.0), 1.0), 1.0, 1.9),
        ("Dahl, exponent 2", rig(dahl(2.0), 1.0), 1.0, 1.9),
        ("LuGre", rig(lugre, 1.3), 1.0, 1.9),
        ("reset integrator", rig(reset, 1.0), 1.0, 1.9),
        ("Walrath", rig(walrath, 1.0), 1.0, 1.9),
        ("contact", gap, -1.0, 0.0),
    ]
}

/// A sliding law starts and ends at rest, where the second method, which has no rest, errs by its step: there ours is within
/// what that method can tell.
#[test]
fn errors_fall_with_the_step_to_what_the_second_method_can_tell() {
    for (name, rig, control_v, least_order) in laws() {
        let found = study(&rig, control_v, 5).unwrap();
        println!("{name}: order {:.1}, second method {:.0e}", found.order(), found.second_method);
        println!("    steps {:?}\n    events {:?}", found.error, found.finding_events);
        assert!(found.order().is_nan() || found.order() > least_order, "{name}: {}", found.order());
        let (&last, &chosen) = (found.error.last().unwrap(), found.finding_events.last().unwrap());
        let allowed = 1e-6 + 3.0 * found.second_method;
        assert!(chosen < allowed, "{name}: {chosen:e} of {allowed:e}");
        assert!(last < 10.0 * allowed, "{name}: {last:e}");
    }
}
