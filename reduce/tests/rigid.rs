//! Free mechanisms in physical coordinates: the rigid body is split off whole and the flexible modes keep their values.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg as linalg;
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, frequency_response, hinfnorm, parallel};
use counterpoise_reduce::{Method, Order, balred, split_stable};

/// Returns a free chain of masses, damped in proportion to its stiffness, turned into coordinates in which nothing
/// is zero.
fn chain(masses: &[f64], stiffness: f64, damping: f64) -> StateSpace {
    let n = masses.len();
    let K = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 if i == 0 || i + 1 == n => stiffness,
        0 => 2.0 * stiffness,
        1 => -stiffness,
        _ => 0.0,
    });
    let by_mass = Mat::from_fn(n, n, |i, j| -K[(i, j)] / masses[i]);
    let A = Mat::from_blocks(&[&[&Mat::zeros(n, n), &Mat::eye(n)], &[&by_mass, &by_mass.scale(damping)]]);
    let (mut B, mut C) = (Mat::zeros(2 * n, 1), Mat::zeros(1, 2 * n));
    (B[(n, 0)], C[(0, n - 1)]) = (1.0 / masses[0], 1.0);
    let T = Mat::from_fn(2 * n, 2 * n, |i, j| if i == j { 2.0 } else { ((3 * i + 5 * j) % 7) as f64 / 7.0 });
    let back = linalg::inverse(&T).unwrap();
    StateSpace::new(&T * &A * &back, &T * &B, &C * &back, Mat::zeros(1, 1), Timebase::Continuous).unwrap()
}

#[test]
fn a_rigid_body_is_split_off_whole() {
    for stiffness in [1e2, 1e4, 1e6] {
        let g = chain(&[1.0, 2.0, 0.5, 1.5], stiffness, 1e-4);
        let parts = split_stable(&g).unwrap();
        assert_eq!((parts.first.order(), parts.second.order()), (6, 2), "{stiffness:e}");
        let rates = [0.3, 3.0, 30.0];
        let sum = frequency_response(&parts.sum().unwrap(), &rates).unwrap();
        for (ours, exact) in sum.iter().zip(frequency_response(&g, &rates).unwrap()) {
            let error = (ours[(0, 0)] - exact[(0, 0)]).norm() / exact[(0, 0)].norm();
            assert!(error < 1e-6, "{stiffness:e}: {error:e}");
        }
    }
}

#[test]
fn the_flexible_modes_of_a_free_mechanism_stay_above_rounding() {
    let g = chain(&[1.0, 2.0, 0.5, 1.5], 1e4, 1e-4);
    let found = balred(&g, Order::States(6), Method::SquareRoot).unwrap();
    assert_eq!((found.untouched, found.kept), (2, 4), "{:?}", found.hankel);
    let bound = found.bound.unwrap();
    assert!(found.measured_error.value <= 1.0001 * bound, "{} {bound}", found.measured_error.value);
    let first = split_stable(&g).unwrap().first;
    let error =
        hinfnorm(&parallel(&first, &split_stable(&found.system).unwrap().first.negate()).unwrap(), 1e-6)
            .unwrap();
    assert!(error.value <= 1.01 * bound, "{} {bound}", error.value);
}

#[test]
fn a_rigid_body_between_stiff_dashpots_is_not_split_in_two() {
    // Two masses in physical coordinates: the rows of the stiffness sum to zero exactly, and rounding splits the double pole by 1e-5.
    for (first, second, stiffness, damping) in
        [(0.02, 40.0, 5e5, 5e-4), (0.03, 0.7, 9e5, 1e-3), (3.0, 0.05, 2e4, 1e-5)]
    {
        let (a, b) = (stiffness / first, stiffness / second);
        let A = Mat::from_rows(&[
            &[0.0, 0.0, 1.0, 0.0],
            &[0.0, 0.0, 0.0, 1.0],
            &[-a, a, -damping * a, damping * a],
            &[b, -b, damping * b, -damping * b],
        ]);
        let (B, C) = (Mat::col(&[0.0, 0.0, 1.0 / first, 0.0]), Mat::from_rows(&[&[0.0, 1.0, 0.0, 0.0]]));
        let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
        assert_eq!(split_stable(&g).unwrap().second.order(), 2, "{first} {second}");
    }
}

#[test]
fn a_slow_mode_beside_a_fast_one_is_stable() {
    // Damping 1e-8 of the critical one at 0.01 rad/s, and a mode at 1e4 rad/s whose entries say nothing about it.
    let mode = |w: f64, zeta: f64| Mat::from_rows(&[&[0.0, 1.0], &[-w * w, -2.0 * zeta * w]]);
    let g = StateSpace::new(
        mode(0.01, 1e-8).block_diag(&mode(1e4, 1e-3)),
        Mat::col(&[0.0, 1.0, 0.0, 1.0]),
        Mat::row(&[1.0, 0.0, 1.0, 0.0]),
        Mat::zeros(1, 1),
        Timebase::Continuous,
    );
    let parts = split_stable(&g.unwrap()).unwrap();
    assert_eq!((parts.first.order(), parts.second.order()), (4, 0));
}

#[test]
fn hardly_damped_modes_keep_their_hankel_values() {
    // Force and displacement of one of two masses between three springs: 0.5/(s^2 + d w^2 s + w^2) for w^2 = 1 and 3, whose
    // Hankel values are 0.5/(2 d w^3), twice each, up to a share d.
    for damping in [f64::exp2(-20.0), f64::exp2(-30.0), f64::exp2(-36.0)] {
        let K = Mat::from_rows(&[&[-2.0, 1.0], &[1.0, -2.0]]);
        let A = Mat::from_blocks(&[&[&Mat::zeros(2, 2), &Mat::eye(2)], &[&K, &K.scale(damping)]]);
        let (B, C) = (Mat::col(&[0.0, 0.0, 1.0, 0.0]), Mat::row(&[1.0, 0.0, 0.0, 0.0]));
        let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
        let reduced = balred(&g, Order::States(2), Method::SquareRoot).unwrap();
        assert_eq!((reduced.untouched, reduced.kept), (0, 2));
        let slow = 0.25 / damping;
        let fast = slow / 27_f64.sqrt();
        for (found, exact) in reduced.hankel.iter().zip([slow, slow, fast, fast]) {
            assert!((found / exact - 1.0).abs() < 2.0 * damping + 1e-10, "{damping:e}: {found:e} {exact:e}");
        }
    }
}
