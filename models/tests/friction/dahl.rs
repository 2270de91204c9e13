use super::{assert_close, dahl, model};
use counterpoise_models::FrictionLaw;
use counterpoise_models::friction::describing_function::{describing_function, sinusoidal_loop};

#[test]
fn the_steady_loop_has_its_closed_form() {
    let friction = dahl(2.0, 1e3, 1.0);
    let looped = sinusoidal_loop(&friction, 1.5e-3, 10.0);
    let highest = looped.torque_nm.iter().fold(0.0_f64, |a, &b| a.max(b));
    assert_close(highest, 1.270298, 1e-6);
    assert_close(highest, 2.0 * 0.75_f64.tanh(), 1e-5);
    assert_close(looped.lost_j, 1.8376e-3, 2e-8);
    let lost = 4.0 * 2.0 * (1.5e-3 - 2e-3 * 0.75_f64.tanh());
    assert_close(looped.lost_j / lost, 1.0, 1e-5);
    let damping = looped.stiffness_nm_rad.im / 10.0;
    assert_close(damping / (lost / (std::f64::consts::PI * 10.0 * 1.5e-3 * 1.5e-3)), 1.0, 1e-5);
}

#[test]
fn other_exponents_reach_their_published_torque() {
    for (exponent, expected) in [(0.5, 0.69527), (1.0, 0.63515), (1.5, 0.58121), (2.0, 0.53518)] {
        let looped = sinusoidal_loop(&dahl(2.0, 1e3, exponent), 1.5e-3, 1.0);
        assert_close(looped.torque_nm.iter().fold(0.0_f64, |a, &b| a.max(b)) / 2.0, expected, 1e-5);
    }
}

#[test]
fn the_loop_does_not_depend_on_the_frequency() {
    let friction = dahl(2.0, 1e3, 1.0);
    let slow = describing_function(&friction, 1e-3, 0.1);
    let fast = describing_function(&friction, 1e-3, 1e3);
    assert_close((slow - fast).norm() / slow.norm(), 0.0, 1e-12);
}

#[test]
fn small_motion_sees_the_rest_stiffness_and_large_motion_coulomb() {
    let friction = dahl(2.0, 1e3, 1.0);
    assert_close(describing_function(&friction, 1e-7, 1.0).re / friction.rest_stiffness_nm_rad(), 1.0, 1e-3);
    let large = describing_function(&friction, 10.0, 1.0).im;
    assert_close(large / (4.0 * 2.0 / (std::f64::consts::PI * 10.0)), 1.0, 1e-3);
}

#[test]
fn a_stribeck_level_replaces_the_coulomb_level() {
    let law = FrictionLaw::Dahl { coulomb_nm: 117.0, rest_stiffness_nm_rad: 2.4e5, exponent: 1.0 };
    let friction = model(law, 1.55, 0.012);
    let (rate, torque) = (0.009_f64, 60.0);
    let level = 117.0 * (1.0 + 0.55 * (-(rate / 0.012).powi(2)).exp());
    let mut slope = [0.0];
    friction.derivative(rate, 1.0, &[torque], &mut slope);
    assert_close(slope[0], 2.4e5 * rate * (1.0 - torque / level), 1e-9);
    assert_close(friction.steady_torque(-rate), -level, 1e-12);
}
