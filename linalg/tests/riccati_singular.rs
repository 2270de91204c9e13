//! The large and the nearly singular examples of CAREX (Abels and Benner, SLICOT working note 1999-14) and DAREX
//! (1999-16) that `riccati_parametric` leaves out, built from their formulas.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{difference, solve_care, solved_discrete};
use counterpoise_linalg::{Mat, Riccati, cond, solve};

/// A certified answer: small residual, every pole of the loop in the left half plane.
fn check_certificate(solution: &Riccati, largest_residual: f64, what: &str) {
    assert!(solution.certificate.relative_residual < largest_residual, "{what}: {}", solution.certificate);
    assert!(solution.closed_loop.iter().all(|pole| pole.re < 0.0), "{what}: {:?}", solution.closed_loop);
}

#[test]
fn carex_2_2_weight_tends_to_a_singular_one() {
    let (A, B) = (Mat::diag(&[-0.1, -0.02]), Mat::from_rows(&[&[0.1, 0.0], &[0.001, 0.01]]));
    let Q = Mat::from_rows(&[&[100.0, 1000.0], &[1000.0, 10000.0]]);
    for e in [1.0, 1e-4, 1e-8, 1e-12] {
        let R = Mat::from_rows(&[&[1.0 + e, 1.0], &[1.0, 1.0]]);
        let solution = solve_care(&A, &B, &Q, &R);
        // X rounded to double leaves this residual, since the gain divides it by R.
        check_certificate(&solution, f64::EPSILON * cond(&R).unwrap().max(100.0), &format!("2.2, {e:e}"));
        // R F = B'X, the gain being as large as the inverse of R.
        let (left, right) = (&R * &solution.F, B.t() * &solution.X);
        let rounding = f64::EPSILON * R.norm_fro() * solution.F.norm_fro();
        assert!((&left - &right).norm_fro() < 10.0 * rounding + 1e-14 * right.norm_fro(), "{e:e}");
    }
}

#[test]
fn carex_2_7_magnetic_tape_with_a_fast_amplifier() {
    for e in [1.0, 1e-3, 1e-6, 1e-9] {
        let A = Mat::from_rows(&[
            &[0.0, 0.4, 0.0, 0.0],
            &[0.0, 0.0, 0.345, 0.0],
            &[0.0, -0.524 / e, -0.465 / e, 0.262 / e],
            &[0.0, 0.0, 0.0, -1.0 / e],
        ]);
        let B = Mat::col(&[0.0, 0.0, 0.0, 1.0 / e]);
        let solution = solve_care(&A, &B, &Mat::diag(&[1.0, 0.0, 1.0, 0.0]), &Mat::eye(1));
        check_certificate(&solution, 1e-14, &format!("2.7, {e:e}"));
    }
}

/// Heat in a rod by n linear finite elements; control and measurement act on parts of it.
fn heat(n: usize, conductivity: f64, actuator: (f64, f64), sensor: (f64, f64)) -> (Mat, Mat, Mat) {
    let h = 1.0 / (n as f64 + 1.0);
    let band = |main: f64, side: f64| {
        Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => main,
            1 => side,
            _ => 0.0,
        })
    };
    let (mass, stiffness) = (band(4.0 * h / 6.0, h / 6.0), band(-2.0 / h, 1.0 / h).scale(conductivity));
    // The integral of the hat function at i h over an interval.
    let hat = |i: usize, (from, to): (f64, f64)| {
        let part = |x: f64| {
            let t = (x / h - i as f64).clamp(-1.0, 1.0);
            h * (if t < 0.0 { 0.5 * (1.0 + t).powi(2) } else { 1.0 - 0.5 * (1.0 - t).powi(2) })
        };
        part(to) - part(from)
    };
    let b = Mat::from_fn(n, 1, |i, _| hat(i + 1, actuator));
    let C = Mat::from_fn(1, n, |_, j| hat(j + 1, sensor));
    (solve(&mass, &stiffness).unwrap(), solve(&mass, &b).unwrap(), C)
}

#[test]
fn carex_4_2_heat_flow() {
    for (n, conductivity, place) in [(20, 0.01, 0.2), (100, 0.01, 0.2), (100, 1e-6, 0.2), (200, 1.0, 0.85)] {
        let (A, B, C) = heat(n, conductivity, (place, place + 0.1), (0.2, 0.3));
        let solution = solve_care(&A, &B, &(C.t() * &C), &Mat::eye(1));
        // sb02md leaves 9e-12, 5e-9, 9e-13 and 7e-6.
        check_certificate(&solution, 1e-13, &format!("4.2, {n}, {conductivity:e}"));
    }
}

#[test]
fn carex_4_3_long_string_of_masses() {
    for (l, mass, damping, stiffness) in [(50, 4.0, 4.0, 1.0), (100, 1.0, 1e-3, 1e4)] {
        let K = Mat::from_fn(l, l, |i, j| match i.abs_diff(j) {
            0 if i == 0 || i == l - 1 => stiffness,
            0 => 2.0 * stiffness,
            1 => -stiffness,
            _ => 0.0,
        });
        let (I, O) = (Mat::eye(l), Mat::zeros(l, l));
        let A = Mat::from_blocks(&[&[&O, &I], &[&K.scale(-1.0 / mass), &I.scale(-damping / mass)]]);
        let mut B = Mat::zeros(2 * l, 2);
        (B[(l, 0)], B[(2 * l - 1, 1)]) = (1.0 / mass, -1.0 / mass);
        check_certificate(&solve_care(&A, &B, &Mat::eye(2 * l), &Mat::eye(2)), 1e-14, &format!("4.3, {l}"));
    }
}

#[test]
fn carex_4_1_longest_chain_that_double_holds() {
    // The entries of X span the binomial coefficients of 2n: 1e11 at n = 21, the size of the collection.
    let n = 21;
    for (q, r) in [(1.0_f64, 1.0), (1e-4, 1e4), (1e6, 1e-6)] {
        let A = Mat::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
        let B = Mat::from_fn(n, 1, |i, _| if i == n - 1 { 1.0 } else { 0.0 });
        let Q = Mat::from_fn(n, n, |i, j| if i + j == 0 { q } else { 0.0 });
        let solution = solve_care(&A, &B, &Q, &Mat::eye(1).scale(r));
        check_certificate(&solution, 1e-14, &format!("4.1, {q:e}, {r:e}"));
        // The loop has Butterworth's poles: the 2n-th roots of q/r with sign, all of one modulus.
        let radius = (q / r).powf(0.5 / n as f64);
        for pole in &solution.closed_loop {
            assert!((pole.norm() / radius - 1.0).abs() < 1e-4, "{q:e}: {pole} {radius}");
        }
    }
}

#[test]
fn darex_2_4_scaled_reflection() {
    let V = Mat::from_fn(3, 3, |i, j| if i == j { 1.0 / 3.0 } else { -2.0 / 3.0 });
    let reflected = |d: [f64; 3]| (&V * &Mat::diag(&d) * &V).symmetric_part();
    for e in [1e-8, 1e-3, 1.0, 1e6] {
        let weight = Mat::eye(3).scale(e);
        let solution = solved_discrete(&reflected([0.0, 1.0, 3.0]), &Mat::eye(3), &weight, &weight);
        let roots = [1.0, 0.5 * (1.0 + 5f64.sqrt()), 0.5 * (9.0 + 85f64.sqrt())];
        let error = difference(&solution.X, &reflected(roots).scale(e));
        assert!(error < 1e-14, "{e:e}: {error:e}");
    }
}

#[test]
fn darex_2_5_paper_machine_with_a_slow_pole() {
    // A delay line behind a lag with time constant tau: X = diag(x, 1, 1, 1), x in closed form.
    let (period, gain, r): (f64, f64, f64) = (1.0, 1.0, 0.25);
    for tau in [1e2, 1e5, 1e8] {
        let (share, beta) = (period / tau, gain * period / tau);
        let alpha = 1.0 - share;
        let mut A = Mat::from_fn(4, 4, |i, j| if i == j + 1 { 1.0 } else { 0.0 });
        A[(0, 0)] = alpha;
        let Q = Mat::diag(&[0.0, 0.0, 0.0, 1.0]);
        let solution = solved_discrete(&A, &Mat::col(&[beta, 0.0, 0.0, 0.0]), &Q, &Mat::eye(1).scale(r));
        let term = r * (alpha + 1.0) * (alpha - 1.0) + beta * beta;
        let x = 0.5 * (term + (term * term + 4.0 * beta * beta * r).sqrt()) / (beta * beta);
        let exact = Mat::diag(&[x, 1.0, 1.0, 1.0]);
        let error = difference(&solution.X, &exact);
        assert!(error < 1e-14, "{tau:e}: error {error:e}");
    }
}

#[test]
fn darex_4_1_longest_shift_register() {
    let n = 300;
    let A = Mat::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
    let B = Mat::from_fn(n, 1, |i, _| if i == n - 1 { 1.0 } else { 0.0 });
    let exact: Vec<f64> = (1..=n).map(|k| k as f64).collect();
    assert!(difference(&solved_discrete(&A, &B, &Mat::eye(n), &Mat::eye(1)).X, &Mat::diag(&exact)) < 1e-13);
}

#[test]
fn the_smallest_problems_and_the_widest_units() {
    // Scalars over 32 decades: x = r (a + sqrt(a^2 + q/r)).
    for a in [-1e8, -1e-8, 0.0, 1e-8, 1e8] {
        for q in [1e-8, 1.0, 1e8] {
            for r in [1e-8, 1.0, 1e8] {
                let one = |x: f64| Mat::diag(&[x]);
                let solution = solve_care(&one(a), &one(1.0), &one(q), &one(r));
                let root = (a * a + q / r).sqrt();
                let exact = if a > 0.0 { r * (a + root) } else { q / (root - a) };
                let found = solution.X[(0, 0)];
                assert!((found / exact - 1.0).abs() < 1e-13, "{a:e} {q:e} {r:e}: {found:e} {exact:e}");
            }
        }
    }
    let (none, inputs) = (Mat::zeros(0, 0), Mat::zeros(0, 1));
    assert_eq!(solve_care(&none, &inputs, &none, &Mat::eye(1)).F.shape(), (1, 0));
}
