//! The duties of every law, whichever it is.

use super::{assert_close, dahl, lugre, model, reset_integrator};
use counterpoise_models::friction::describing_function::sinusoidal_loop;
use counterpoise_models::friction::{FrictionConditions, FrictionModel};
use counterpoise_models::{Error, Friction, FrictionLaw, Ripple, StribeckCurve};

fn stribeck_model(curve: StribeckCurve) -> FrictionModel {
    model(FrictionLaw::Stribeck { coulomb_nm: 1.0, curve }, 1.5, 1e-3)
}

fn every_law() -> Vec<(&'static str, FrictionModel)> {
    let walrath = FrictionLaw::Walrath { coulomb_nm: 1.0, time_constant_s: 0.02, smoothing_rate_rad_s: 1e-4 };
    vec![
        ("coulomb", model(FrictionLaw::Coulomb { coulomb_nm: 1.0 }, 1.0, 1.0)),
        ("stiction", model(FrictionLaw::Coulomb { coulomb_nm: 1.0 }, 1.5, 1.0)),
        ("tustin", stribeck_model(StribeckCurve::Tustin)),
        ("exponential", stribeck_model(StribeckCurve::Exponential { exponent: 0.7 })),
        ("gaussian", stribeck_model(StribeckCurve::Gaussian)),
        ("lorentzian", stribeck_model(StribeckCurve::Lorentzian)),
        ("polynomial", stribeck_model(StribeckCurve::Polynomial { coefficients: [0.0, -1.5, 1.0] })),
        ("karnopp", model(FrictionLaw::Karnopp { coulomb_nm: 1.0, stick_rate_rad_s: 1e-5 }, 1.5, 1.0)),
        ("dahl", dahl(1.0, 1e4, 1.0)),
        ("dahl, exponent 2", dahl(1.0, 1e4, 2.0)),
        ("dahl with stribeck", model(stribeck_dahl(), 1.5, 1e-3)),
        ("walrath", model(walrath, 1.0, 1.0)),
        ("bristle", model(FrictionLaw::Bristle { coulomb_nm: 1.0, bristles: 25, bond_rad: 1e-4 }, 1.0, 1.0)),
        ("reset integrator", reset_integrator()),
        ("lugre", lugre()),
    ]
}

fn stribeck_dahl() -> FrictionLaw {
    FrictionLaw::Dahl { coulomb_nm: 1.0, rest_stiffness_nm_rad: 1e4, exponent: 1.0 }
}

#[test]
fn every_law_dissipates_over_a_closed_loop() {
    for (name, friction) in every_law() {
        for amplitude in [1e-5, 1e-4, 1e-2] {
            let looped = sinusoidal_loop(&friction, amplitude, 5.0);
            assert!(
                looped.lost_j > 0.0 || amplitude < 1e-4 && looped.lost_j > -1e-15,
                "{name} at {amplitude}: {}",
                looped.lost_j
            );
            let from_harmonic = std::f64::consts::PI * amplitude * amplitude * looped.stiffness_nm_rad.im;
            assert_close(looped.lost_j, from_harmonic, 1e-12 * (1.0 + looped.lost_j.abs()));
        }
    }
}

#[test]
fn every_law_settles_at_its_steady_curve_which_is_odd() {
    for (name, friction) in every_law() {
        for rate in [2e-3, 0.1] {
            assert_close(friction.steady_torque(-rate), -friction.steady_torque(rate), 1e-15);
            let mut states = vec![0.0; friction.states()];
            friction.advance(rate, 1e8, 1.0, &mut states);
            let mut mean = 0.0;
            let steps = 2000;
            for k in 0..steps {
                friction.advance(rate, 1e-3, 1.0, &mut states);
                mean += if k >= steps / 2 { friction.torque(rate, 1.0, &states) } else { 0.0 };
            }
            let tolerance = if name == "bristle" { 0.05 } else { 1e-6 };
            assert_close(mean / f64::from(steps / 2), friction.steady_torque(rate), tolerance);
        }
    }
}

#[test]
fn the_steady_slope_is_the_derivative_of_the_steady_curve() {
    for (name, friction) in every_law() {
        for rate in [-3e-3, 5e-4, 0.02] {
            let h = 1e-9;
            let difference =
                (friction.steady_torque(rate + h) - friction.steady_torque(rate - h)) / (2.0 * h);
            let slope = friction.steady_slope(rate);
            assert!(
                (slope - difference).abs() < 1e-4 * (1.0 + slope.abs()),
                "{name} {rate}: {slope} {difference}"
            );
        }
    }
}

#[test]
fn partials_are_the_derivatives() {
    for (name, friction) in every_law() {
        let state = if name.starts_with("dahl") || name == "walrath" { 0.4 } else { 4e-5 };
        for rate in [-2e-3, 7e-4] {
            let Some(partials) = friction.partials(rate, 1.1, &[state]) else { continue };
            let slope = |w: f64, z: f64| {
                let mut slope = [0.0];
                friction.derivative(w, 1.1, &[z], &mut slope);
                slope[0]
            };
            let torque = |w: f64, z: f64| friction.torque(w, 1.1, &[z]);
            let by = |f: &dyn Fn(f64) -> f64, h: f64| (f(h) - f(-h)) / (2.0 * h);
            let (dw, dz) = (1e-8, 1e-5 * state);
            let pairs = [
                (partials.state_by_rate, by(&|h| slope(rate + h, state), dw)),
                (partials.state_by_state, by(&|h| slope(rate, state + h), dz)),
                (partials.torque_by_rate, by(&|h| torque(rate + h, state), dw)),
                (partials.torque_by_state, by(&|h| torque(rate, state + h), dz)),
            ];
            for (analytic, difference) in pairs {
                let error = (analytic - difference).abs();
                assert!(error < 1e-4 * (1.0 + analytic.abs()), "{name} {rate}: {analytic} {difference}");
            }
        }
    }
}

#[test]
fn the_level_follows_angle_load_and_time() {
    let plain = Friction::with_viscous_part(stribeck_dahl(), 0.0);
    let friction = FrictionModel::new(&Friction {
        position_ripple: Ripple { amplitude: 0.2, order: 3.0, phase_rad: 0.0 },
        load_coefficient: 0.05,
        warm_up: 0.3,
        warm_up_time_s: 100.0,
        ..plain.clone()
    })
    .unwrap();
    let at = FrictionConditions { angle_rad: 0.5, load_nm: -8.0, time_s: 50.0 };
    let expected = (1.0 + 0.2 * 1.5_f64.sin()) * (1.0 + 0.3 * ((-0.5_f64).exp() - 1.0)) + 0.4;
    assert_close(friction.level(&at), expected, 1e-14);
    assert_eq!(FrictionModel::new(&plain).unwrap().level(&at), 1.0);
}

#[test]
fn asymmetry_scales_each_direction() {
    let friction =
        FrictionModel::new(&Friction { asymmetry: 0.1, ..Friction::with_viscous_part(stribeck_dahl(), 0.5) })
            .unwrap();
    assert_close(friction.steady_torque(2.0), 1.1 + 1.0, 1e-14);
    assert_close(friction.steady_torque(-2.0), -0.9 - 1.0, 1e-14);
}

#[test]
fn viscous_friction_may_differ_between_the_directions() {
    let parameters =
        Friction { viscous_asymmetry: -0.25, ..Friction::with_viscous_part(FrictionLaw::None, 2.0) };
    let friction = FrictionModel::new(&parameters).unwrap();
    assert_close(friction.steady_torque(3.0), 4.5, 1e-14);
    assert_close(friction.steady_torque(-3.0), -7.5, 1e-14);
    assert_close(friction.steady_slope(-3.0), 2.5, 1e-14);
    for rate in [-3.0, 0.0, 3.0] {
        assert_close(2.0 * rate + parameters.drag_nm(rate), friction.steady_torque(rate), 1e-14);
    }
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let plain = Friction::with_viscous_part(stribeck_dahl(), 0.0);
    let cases = [
        (Friction { viscous_nm_s_rad: -1.0, ..plain.clone() }, "friction.viscous_nm_s_rad"),
        (Friction { asymmetry: 1.0, ..plain.clone() }, "friction.asymmetry"),
        (
            Friction { law: FrictionLaw::Coulomb { coulomb_nm: 1.0 }, static_ratio: 0.9, ..plain.clone() },
            "friction.static_ratio",
        ),
        (
            Friction {
                law: FrictionLaw::Dahl { coulomb_nm: 1.0, rest_stiffness_nm_rad: 0.0, exponent: 1.0 },
                ..plain.clone()
            },
            "friction.rest_stiffness_nm_rad",
        ),
        (
            Friction {
                law: FrictionLaw::Bristle { coulomb_nm: 1.0, bristles: 0, bond_rad: 1.0 },
                ..plain.clone()
            },
            "friction.bristles",
        ),
        (Friction { viscous_nm_s_rad: f64::NAN, ..plain }, "friction.viscous_nm_s_rad"),
    ];
    for (friction, name) in cases {
        match FrictionModel::new(&friction) {
            Err(Error::Parameter { parameter, .. }) => assert_eq!(parameter, name),
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn a_polynomial_that_turns_negative_is_refused() {
    let curve = StribeckCurve::Polynomial { coefficients: [0.0, -12.0, 12.0] };
    let law = FrictionLaw::Stribeck { coulomb_nm: 1.0, curve };
    assert!(
        FrictionModel::new(&Friction { static_ratio: 1.5, ..Friction::with_viscous_part(law, 0.0) }).is_err()
    );
}
