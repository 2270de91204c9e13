//! True stick in mechanisms of one and two masses.

use super::{assert_close, model};
use counterpoise_models::FrictionLaw;
use counterpoise_models::friction::{FrictionModel, Joint, contact_torques};
use nalgebra::{Matrix1, Matrix2};

fn coulomb(coulomb_nm: f64, static_ratio: f64) -> FrictionModel {
    model(FrictionLaw::Coulomb { coulomb_nm }, static_ratio, 1.0)
}

/// A unit mass pulled by a spring of 2 N/m at 0.1 m/s: times at which it starts to slip, and its highest rate.
fn pull_mass(friction: &FrictionModel, h: f64, duration: f64) -> (Vec<f64>, f64) {
    let (mut stretch, mut rate, mut starts, mut fastest) = (0.0, 0.0_f64, Vec::new(), 0.0_f64);
    for k in 0..(duration / h) as usize {
        let middle = stretch + 0.5 * h * (0.1 - rate);
        let free = rate + h * 2.0 * middle;
        let joint = Joint { friction, level: 1.0, rate_rad_s: rate, free_rate_rad_s: free };
        let next = contact_torques(&[joint], &Matrix1::new(h)).rate_rad_s[0];
        if rate == 0.0 && next != 0.0 {
            starts.push(k as f64 * h);
        }
        stretch += h * (0.1 - 0.5 * (rate + next));
        rate = next;
        fastest = fastest.max(rate);
    }
    (starts, fastest)
}

#[test]
fn a_pulled_mass_has_the_closed_form_period_with_steps_of_a_millisecond() {
    let (starts, fastest) = pull_mass(&coulomb(1.0, 1.5), 1e-3, 40.0);
    let omega = 2.0_f64.sqrt();
    let slip = 2.0 / omega * (std::f64::consts::PI - 0.25_f64.atan2(0.1 / omega));
    assert_close(starts[3] - starts[2], 5.0 + slip, 5e-3);
    assert_close(fastest, 0.467423461, 1e-3);
    assert_eq!(starts.len(), 5);
}

#[test]
fn the_period_converges_with_the_step() {
    let exact = 7.611259254;
    let error = |h: f64| {
        let (starts, _) = pull_mass(&coulomb(1.0, 1.5), h, 40.0);
        ((starts[4] - starts[1]) / 3.0 - exact).abs()
    };
    assert!(error(1e-4) < 5e-4 && error(1e-5) < 5e-5, "{} {}", error(1e-4), error(1e-5));
}

#[test]
fn a_load_below_breakaway_is_held_to_the_last_bit() {
    let friction = coulomb(2.0, 1.2);
    let (mut rate, h) = (0.0, 1e-3);
    for _ in 0..100_000 {
        let joint =
            Joint { friction: &friction, level: 1.0, rate_rad_s: rate, free_rate_rad_s: rate + h * 2.39 };
        let held = contact_torques(&[joint], &Matrix1::new(h));
        rate = held.rate_rad_s[0];
        assert!(rate == 0.0 && (held.torque_nm[0] - 2.39).abs() < 1e-12);
    }
    let joint = Joint { friction: &friction, level: 1.0, rate_rad_s: 0.0, free_rate_rad_s: h * 2.41 };
    assert!(contact_torques(&[joint], &Matrix1::new(h)).rate_rad_s[0] > 0.0);
}

/// Two joints on coupled inertias: each of the nine cases obeys the complementarity.
#[test]
fn two_joints_obey_the_complementarity_in_every_case() {
    let (first, second) = (coulomb(1.0, 1.0), coulomb(0.4, 1.0));
    let mobility = Matrix2::new(2e-3, 1.2e-3, 1.2e-3, 3e-3);
    let mut cases = std::collections::BTreeSet::new();
    for a in -12..=12 {
        for b in -12..=12 {
            let free = [f64::from(a) * 4e-4, f64::from(b) * 4e-4];
            let joint =
                |friction, free_rate_rad_s| Joint { friction, level: 1.0, rate_rad_s: 0.0, free_rate_rad_s };
            let found = contact_torques(&[joint(&first, free[0]), joint(&second, free[1])], &mobility);
            let mut case = [0; 2];
            for (i, limit) in [1.0, 0.4].into_iter().enumerate() {
                let (t, w) = (found.torque_nm[i], found.rate_rad_s[i]);
                let expected =
                    free[i] - mobility[(i, 0)] * found.torque_nm[0] - mobility[(i, 1)] * found.torque_nm[1];
                assert_close(w, expected, 1e-15);
                assert!(t.abs() <= limit);
                assert!(
                    w == 0.0 || (t - limit * w.signum()).abs() < 1e-12 || w.abs() < 1e-15,
                    "{free:?} {found:?}"
                );
                case[i] = if w.abs() < 1e-15 { 0 } else { w.signum() as i32 };
            }
            cases.insert(case);
        }
    }
    assert_eq!(cases.len(), 9);
}

#[test]
fn two_rubbing_masses_lose_energy_and_come_to_rest() {
    let (first, second) = (coulomb(0.3, 1.3), coulomb(0.2, 1.0));
    let (h, masses, stiffness) = (1e-3, [1.0, 0.5], 40.0);
    let mut x = [0.1, -0.05];
    let mut w = [0.0; 2];
    let energy = |x: &[f64; 2], w: &[f64; 2]| {
        0.5 * stiffness * (x[0] - x[1]).powi(2) + (0..2).map(|i| 0.5 * masses[i] * w[i] * w[i]).sum::<f64>()
    };
    let start = energy(&x, &w);
    let mut last = start;
    for _ in 0..20_000 {
        let spring = stiffness * (x[0] - x[1] + 0.5 * h * (w[0] - w[1]));
        let free = [w[0] - h * spring / masses[0], w[1] + h * spring / masses[1]];
        let joint =
            |friction, i: usize| Joint { friction, level: 1.0, rate_rad_s: w[i], free_rate_rad_s: free[i] };
        let mobility = Matrix2::new(h / masses[0], 0.0, 0.0, h / masses[1]);
        let next = contact_torques(&[joint(&first, 0), joint(&second, 1)], &mobility).rate_rad_s;
        (0..2).for_each(|i| x[i] += 0.5 * h * (w[i] + next[i]));
        w = next;
        assert!(energy(&x, &w) <= last + 1e-4 * start);
        last = energy(&x, &w);
    }
    assert_eq!(w, [0.0, 0.0]);
    assert!(stiffness * (x[0] - x[1]).abs() < 0.2 && last < 0.01 * start);
}

#[test]
fn laws_that_do_not_stick_take_no_part() {
    let friction = super::dahl(1.0, 1e3, 1.0);
    let joint = Joint { friction: &friction, level: 1.0, rate_rad_s: 0.1, free_rate_rad_s: 0.2 };
    let found = contact_torques(&[joint], &Matrix1::new(1e-3));
    assert_eq!((found.torque_nm, found.rate_rad_s), ([0.0], [0.2]));
}
