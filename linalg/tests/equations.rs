//! Sylvester and Lyapunov equations and the exponential: definitions, closed forms, two methods agree.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{RandomGenerator, difference};
use counterpoise_linalg::{
    Error, Mat, balance, dlyap, dlyap_factor, dsylvester, expm, expm_integral, gsylvester, inverse, lyap,
    lyap_factor, lyap_factors, sylvester, van_loan_accumulated, van_loan_cost, van_loan_noise,
};

#[test]
fn sylvester_passes_its_definition() {
    let mut random = RandomGenerator::new(1);
    for (m, n) in [(1, 1), (1, 2), (3, 2), (7, 5), (20, 40), (50, 33)] {
        let (A, B, C) = (random.stable(m, 0.3), random.stable(n, 0.3), random.matrix(m, n));
        let X = sylvester(&A, &B, &C).unwrap();
        let scale = A.norm_fro() * X.norm_fro() + B.norm_fro() * X.norm_fro() + C.norm_fro();
        assert!((&A * &X + &X * &B - &C).norm_fro() < 1e-14 * scale, "{m} x {n}");
        let X = dsylvester(&A, &B, &C).unwrap();
        let scale = A.norm_fro() * X.norm_fro() * B.norm_fro() + X.norm_fro() + C.norm_fro();
        assert!((&A * &X * &B - &X + &C).norm_fro() < 1e-14 * scale, "{m} x {n} discrete");
    }
}

#[test]
fn generalised_sylvester_passes_its_definition() {
    let mut random = RandomGenerator::new(12);
    for (m, n) in [(1, 1), (4, 3), (12, 20)] {
        let (A, C, B, D) =
            (random.matrix(m, m), random.matrix(m, m), random.matrix(n, n), random.matrix(n, n));
        let E = random.matrix(m, n);
        for (A, D) in [(A.clone(), D.clone()), (A.scale(1e8), D.scale(1e-7)), (Mat::zeros(m, m), D.clone())] {
            let X = gsylvester(&A, &B, &C, &D, &E).unwrap();
            let (first, second) = (&A * &X * &B, &C * &X * &D);
            let scale = first.norm_fro() + second.norm_fro() + E.norm_fro();
            let cancelled = X.norm_fro() * (A.norm_fro() * B.norm_fro() + C.norm_fro() * D.norm_fro());
            assert!((first + second - &E).norm_fro() < 1e-15 * (scale + cancelled), "{m} x {n}");
        }
    }
    let zero = Mat::zeros(2, 2);
    assert!(gsylvester(&zero, &zero, &zero, &zero, &Mat::eye(2)).is_err());
}

#[test]
fn equations_without_a_unique_solution_name_the_eigenvalues() {
    let A = Mat::diag(&[1.0, 2.0]);
    let B = Mat::diag(&[-2.0, 5.0]);
    match sylvester(&A, &B, &Mat::eye(2)) {
        Err(Error::CommonEigenvalue { first, second, .. }) => assert_eq!((first.re, second.re), (2.0, -2.0)),
        other => panic!("{other:?}"),
    }
    assert!(matches!(dlyap(&Mat::diag(&[0.5, 2.0]), &Mat::eye(2)), Err(Error::CommonEigenvalue { .. })));
}

#[test]
fn lyapunov_passes_its_definition_and_is_symmetric() {
    let mut random = RandomGenerator::new(2);
    for n in [1, 2, 5, 16, 17, 45, 90] {
        let A = random.stable(n, 0.1);
        let B = random.matrix(n, 2);
        let Q = &B * B.t();
        let X = lyap(&A, &Q.symmetric_part()).unwrap();
        assert_eq!(X, X.t());
        let residual = (&A * &X + &X * A.t() + &Q).norm_fro();
        assert!(residual < 1e-13 * A.norm_fro() * X.norm_fro(), "n = {n}");
        let L = lyap_factor(&A, &B).unwrap();
        assert!(difference(&(&L * L.t()), &X) < 1e-11, "n = {n}: {:e}", difference(&(&L * L.t()), &X));
        assert!((0..n).all(|j| (0..j).all(|i| L[(i, j)] == 0.0)));
    }
}

#[test]
fn discrete_lyapunov_passes_its_definition() {
    let mut random = RandomGenerator::new(3);
    for n in [1, 2, 6, 21, 50] {
        let A = expm(&random.stable(n, 0.1).scale(0.7)).unwrap();
        let B = random.matrix(n, 3);
        let Q = (&B * B.t()).symmetric_part();
        let X = dlyap(&A, &Q).unwrap();
        let residual = (&A * &X * A.t() - &X + &Q).norm_fro();
        assert!(residual < 1e-13 * X.norm_fro() * (1.0 + A.norm_fro().powi(2)), "n = {n}");
        let L = dlyap_factor(&A, &B).unwrap();
        assert!(difference(&(&L * L.t()), &X) < 1e-11, "n = {n}");
    }
}

#[test]
fn a_lyapunov_factor_needs_a_stable_matrix() {
    match lyap_factor(&Mat::diag(&[-1.0, 0.25]), &Mat::eye(2)) {
        Err(Error::NotStable { eigenvalue, .. }) => assert_eq!(eigenvalue.re, 0.25),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_factor_keeps_small_values_that_the_product_loses() {
    // A = -diag, B = b: P_ij = b_i b_j / (a_i + a_j), so that b = 1e-12 must survive in L.
    let A = Mat::diag(&[-1.0, -2.0]);
    let L = lyap_factor(&A, &Mat::col(&[1.0, 1e-12])).unwrap();
    let determinant = L[(0, 0)] * L[(1, 1)];
    let exact = 1e-12 * (0.5_f64 * 0.25 - 1.0 / 9.0).sqrt();
    assert!((determinant.abs() / exact - 1.0).abs() < 1e-12);
}

#[test]
fn factors_of_slender_and_nearly_double_pairs_pass_their_definition() {
    // [a b; c a]: a rotation, two slender pairs, one whose eigenvalues are equal to 1e-8, and one hardly damped.
    let pairs = [
        (-1.0, 2.0, -2.0),
        (-0.5, 300.0, -0.01),
        (-2.0, -0.02, 500.0),
        (-1.0, 1.0, -1e-16),
        (-1e-6, 40.0, -40.0),
    ];
    let n = 2 * pairs.len() + 1;
    let mut A =
        Mat::from_fn(n, n, |i, j| if i / 2 < j / 2 { ((2 * i + 3 * j) % 5) as f64 / 5.0 - 0.4 } else { 0.0 });
    A[(n - 1, n - 1)] = -0.7;
    for (k, (a, b, c)) in pairs.into_iter().enumerate() {
        A.set_block(2 * k, 2 * k, &Mat::from_rows(&[&[a, b], &[c, a]]));
    }
    for m in [1, 3, 20] {
        let B = Mat::from_fn(n, m, |i, j| ((i + 3 * j) % 4) as f64 - 1.3);
        let (R, L) = lyap_factors(&A, &B, &B.t()).unwrap();
        let (P, Q) = (&R * R.t(), &L * L.t());
        let reached = (&A * &P + &P * A.t() + &B * B.t()).norm_fro();
        let seen = (A.t() * &Q + &Q * &A + &B * B.t()).norm_fro();
        let size = |X: &Mat| 1e-14 * A.norm_fro() * X.norm_fro();
        assert!(reached < size(&P) && seen < size(&Q), "m = {m}: {reached:e}, {seen:e}");
    }
}

#[test]
fn exponential_closed_forms() {
    let (w, h) = (3.0_f64, 0.7_f64);
    let oscillator = Mat::from_rows(&[&[0.0, w], &[-w, 0.0]]);
    let E = expm(&oscillator.scale(h)).unwrap();
    let expected = Mat::from_rows(&[&[(w * h).cos(), (w * h).sin()], &[-(w * h).sin(), (w * h).cos()]]);
    assert!(difference(&E, &expected) < 4e-16);
    let nilpotent = Mat::from_rows(&[&[0.0, 1.0, 2.0], &[0.0, 0.0, 3.0], &[0.0, 0.0, 0.0]]);
    let expected = Mat::from_rows(&[&[1.0, 1.0, 3.5], &[0.0, 1.0, 3.0], &[0.0, 0.0, 1.0]]);
    assert!(difference(&expm(&nilpotent).unwrap(), &expected) < 1e-15);
}

#[test]
fn exponential_and_its_inverse() {
    let mut random = RandomGenerator::new(4);
    for (n, size) in [(3, 1e-3), (5, 0.2), (9, 1.0), (20, 2.0), (40, 8.0)] {
        let A = random.matrix(n, n).scale(size / (n as f64).sqrt());
        let (E, inverse) = (expm(&A).unwrap(), expm(&-&A).unwrap());
        let rounding = 1e-15 * E.norm_fro() * inverse.norm_fro();
        assert!((E * inverse - Mat::eye(n)).norm_fro() < rounding, "n = {n}");
    }
}

#[test]
fn hold_of_a_double_integrator() {
    let A = Mat::from_rows(&[&[0.0, 1.0], &[0.0, 0.0]]);
    let (Phi, Gamma) = expm_integral(&A, &Mat::col(&[0.0, 2.0]), 0.1).unwrap();
    assert!(difference(&Phi, &Mat::from_rows(&[&[1.0, 0.1], &[0.0, 1.0]])) < 1e-15);
    assert!(difference(&Gamma, &Mat::col(&[0.01, 0.2])) < 1e-15);
}

#[test]
fn sampled_cost_agrees_with_the_lyapunov_solution() {
    // integral to h = P - Phi' P Phi with A'P + PA + Q = 0.
    let mut random = RandomGenerator::new(5);
    for (n, h) in [(4, 0.05), (8, 3.0), (6, 40.0)] {
        let A = random.stable(n, 0.2);
        let Q = Mat::eye(n);
        let (Phi, W) = van_loan_cost(&A, &Q, h).unwrap();
        let P = lyap(&A.t(), &Q).unwrap();
        assert!(difference(&W, &(&P - &(Phi.t() * &P * &Phi))) < 1e-12, "h = {h}");
        let (Phi, W) = van_loan_noise(&A, &Q, h).unwrap();
        let P = lyap(&A, &Q).unwrap();
        assert!(difference(&W, &(&P - &(&Phi * &P * Phi.t()))) < 1e-12, "h = {h}");
    }
}

#[test]
fn wrong_shapes_are_refused() {
    assert!(matches!(lyap(&Mat::eye(2), &Mat::eye(3)), Err(Error::Shape { what: "Q", .. })));
    assert!(sylvester(&Mat::eye(2), &Mat::eye(3), &Mat::zeros(3, 2)).is_err());
    assert!(matches!(expm(&Mat::diag(&[f64::INFINITY])), Err(Error::NotFinite { .. })));
    assert!(matches!(expm(&Mat::diag(&[1e6])), Err(Error::NotFinite { .. })));
}

#[test]
fn accumulated_cost_of_a_lag_has_its_closed_form() {
    // W(t) = q (1 - exp(-2 a t)) / (2 a), its integral from 0 to h: q (h - W(h) / q) / (2 a).
    let (a, q): (f64, f64) = (3.0, 2.0);
    for h in [1e-3, 0.1, 40.0] {
        let P = van_loan_accumulated(&Mat::diag(&[-a]), &Mat::diag(&[q]), h).unwrap()[(0, 0)];
        let lag = -(-2.0 * a * h).exp_m1() / (2.0 * a);
        let expected = q * (h - lag) / (2.0 * a);
        assert!((P / expected - 1.0).abs() < 1e-11, "{h}: {P} {expected}");
    }
}

#[test]
fn a_magnified_solution_is_right_entry_by_entry() {
    // A = T N T^-1 and X = T T' with small fractions of powers of two, so that Q is exact. T is far from orthogonal, and the solution hundreds of
    // times larger than the data.
    let T = Mat::from_rows(&[
        &[1.0, 0.0, 0.0, 0.0],
        &[5.0, 1.0, 0.0, 0.0],
        &[-7.0, 6.0, 1.0, 0.0],
        &[3.0, -4.0, 8.0, 1.0],
    ]);
    let T_inverse = inverse(&T).unwrap().map(f64::round);
    assert_eq!(&T * &T_inverse, Mat::eye(4));
    let near = 1.0 - f64::exp2(-10.0);
    let A = &T * Mat::diag(&[near, -near, near, 0.5]) * &T_inverse;
    let X = &T * T.t();
    let Q = &X - &(&A * &X * A.t());
    let found = dlyap(&A, &Q).unwrap();
    for j in 0..4 {
        for i in 0..4 {
            let error = (found[(i, j)] - X[(i, j)]).abs() / (X[(i, i)] * X[(j, j)]).sqrt();
            assert!(error < 2.0 * f64::EPSILON, "{i} {j} {error:e}");
        }
    }
}

#[test]
fn what_may_be_rounding_is_not_balanced_for_eigenvalues() {
    // 3e-11 beside a rate of 1e4 is what a subtraction of 2.5e5 leaves: made as large as 2.5e5, it would move the eigenvalues.
    let A = Mat::from_rows(&[&[-1.0, 2.5e5], &[-3e-11, -1e4]]);
    assert_eq!(balance(&A).unwrap().scale, [1.0, 1.0]);
    let A = Mat::from_rows(&[&[-1.0, 2.5e5], &[-3e-3, -1e4]]);
    assert!(balance(&A).unwrap().scale[0] > balance(&A).unwrap().scale[1]);
}

#[test]
fn units_are_balanced_also_beside_a_far_larger_diagonal() {
    // One entry of a row is 2e-9 of its diagonal: without balancing, the rounding of the other is larger than this one.
    let A = Mat::from_rows(&[
        &[-0.5402935339585326, -1.1554885890949275e-9],
        &[17018872.25596792, -0.5264552118136085],
    ]);
    let Q = Mat::from_rows(&[
        &[6.758358585042536e-8, -0.43228450150036424],
        &[-0.43228450150036424, 2765018.870868959],
    ]);
    let X = lyap(&A, &Q).unwrap();
    let expected =
        [(X[(0, 0)], 6.136372872753231e-8), (X[(0, 1)], 0.5515996264755441), (X[(1, 1)], 20457795.408196237)];
    for (found, exact) in expected {
        assert!((found / exact - 1.0).abs() < 1e-13, "{found} {exact}");
    }
}
