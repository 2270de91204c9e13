//! The parametric and the large examples of CAREX (Abels and Benner, SLICOT working note 1999-14) and DAREX (1999-16), built
//! from their formulas and driven towards the limit where they become singular.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{difference, solve_care, solved_discrete, solved_g, within_data};
use counterpoise_linalg::{Mat, Outcome, Reason, care, care_g};

#[test]
fn carex_2_1_almost_unstabilisable() {
    for e in [1.0, 1e-3, 1e-6] {
        let (A, B) = (Mat::diag(&[1.0, -2.0]), Mat::col(&[e, 0.0]));
        let solution = solve_care(&A, &B, &Mat::from_fn(2, 2, |_, _| 1.0), &Mat::eye(1));
        let root = (1.0 + e * e).sqrt();
        let (x12, x22) = (1.0 / (2.0 + root), 0.25 * (1.0 - e * e / (2.0 + root).powi(2)));
        let exact = Mat::from_rows(&[&[(1.0 + root) / (e * e), x12], &[x12, x22]]);
        within_data(&solution, &exact, &format!("2.1, {e:e}"));
        // Entry by entry, although they differ by twelve decades.
        for (value, entry) in solution.X.as_slice().iter().zip(exact.as_slice()) {
            assert!((value / entry - 1.0).abs() < 1e-8);
        }
    }
    let limit =
        care(&Mat::diag(&[1.0, -2.0]), &Mat::col(&[0.0, 0.0]), &Mat::eye(2), &Mat::eye(1), None).unwrap();
    assert!(matches!(limit, Outcome::Infeasible(Reason::Uncontrollable { mode, .. }) if mode.re == 1.0));
}

#[test]
fn carex_2_3_ill_conditioned_for_large_e() {
    for e in [1e-6, 1.0, 1e6] {
        let A = Mat::from_rows(&[&[0.0, e], &[0.0, 0.0]]);
        let solution = solve_care(&A, &Mat::col(&[0.0, 1.0]), &Mat::eye(2), &Mat::eye(1));
        let root = (1.0 + 2.0 * e).sqrt();
        within_data(&solution, &Mat::from_rows(&[&[root / e, 1.0], &[1.0, root]]), &format!("2.3, {e:e}"));
    }
}

#[test]
fn carex_2_4_hamiltonian_near_the_axis() {
    for e in [1.0, 1e-3, 1e-7] {
        let A = Mat::from_rows(&[&[e + 1.0, 1.0], &[1.0, e + 1.0]]);
        let solution = solved_g(&A, &Mat::eye(2), &Mat::eye(2).scale(e * e));
        let x11 = 0.5 * (2.0 * (e + 1.0) + (2.0 * (e + 1.0).powi(2) + 2.0).sqrt() + 2f64.sqrt() * e);
        let x12 = x11 / (x11 - (e + 1.0));
        within_data(&solution, &Mat::from_rows(&[&[x11, x12], &[x12, x11]]), &format!("2.4, {e:e}"));
    }
}

#[test]
fn carex_2_5_h_infinity_near_the_axis() {
    for e in [1.0, 1e-2, 1e-5] {
        let A = Mat::from_rows(&[&[3.0 - e, 1.0], &[4.0, 2.0 - e]]);
        let Q = Mat::from_rows(&[&[4.0 * e - 11.0, 2.0 * e - 5.0], &[2.0 * e - 5.0, 2.0 * e - 2.0]]);
        let solution = solve_care(&A, &Mat::col(&[1.0, 1.0]), &Q, &Mat::eye(1));
        within_data(&solution, &Mat::from_rows(&[&[2.0, 1.0], &[1.0, 1.0]]), &format!("2.5, {e:e}"));
    }
}

/// `V diag V` with the reflection `V = I - (2/3) 1 1'`.
fn reflect_diagonal(diagonal: [f64; 3]) -> Mat {
    let V = Mat::from_fn(3, 3, |i, j| if i == j { 1.0 / 3.0 } else { -2.0 / 3.0 });
    (&V * &Mat::diag(&diagonal) * &V).symmetric_part()
}

#[test]
fn carex_2_6_badly_scaled() {
    for e in [1.0, 1e3, 1e6] {
        let A = reflect_diagonal([e, 2.0 * e, 3.0 * e]);
        let (G, Q) = (Mat::eye(3).scale(1.0 / e), reflect_diagonal([1.0 / e, 1.0, e]));
        let exact = |a: f64, q: f64| e * (a + (a * a + q / e).sqrt());
        let X = reflect_diagonal([exact(e, 1.0 / e), exact(2.0 * e, 1.0), exact(3.0 * e, e)]);
        within_data(&solved_g(&A, &G, &Q), &X, &format!("2.6, {e:e}"));
    }
}

#[test]
fn carex_2_8_closed_loop_near_the_axis() {
    for e in [1e-2, 1e-4, 1e-6] {
        let A = Mat::from_rows(&[
            &[-e, 1.0, 0.0, 0.0],
            &[-1.0, -e, 0.0, 0.0],
            &[0.0, 0.0, e, 1.0],
            &[0.0, 0.0, -1.0, e],
        ]);
        let ones = Mat::from_fn(4, 4, |_, _| 1.0);
        match care_g(&A, &ones, &ones).unwrap() {
            Outcome::Solved(solution) => {
                assert!(solution.certificate.relative_residual < 1e-14, "2.8, {e:e}")
            }
            Outcome::Infeasible(reason) => panic!("2.8, {e:e}: {reason}"),
        }
    }
}

/// N vehicles: velocities and the distances between them.
fn vehicles(count: usize) -> (Mat, Mat, Mat) {
    let n = 2 * count - 1;
    let mut A = Mat::zeros(n, n);
    for k in 0..count {
        A[(2 * k, 2 * k)] = -1.0;
    }
    for k in 0..count - 1 {
        A[(2 * k + 1, 2 * k)] = 1.0;
        A[(2 * k + 1, 2 * k + 2)] = -1.0;
    }
    let B = Mat::from_fn(n, count, |i, j| if i == 2 * j { 1.0 } else { 0.0 });
    let Q: Vec<f64> = (0..n).map(|i| if i % 2 == 1 { 10.0 } else { 0.0 }).collect();
    (A, B, Mat::diag(&Q))
}

#[test]
fn carex_3_1_string_of_vehicles() {
    for count in [3, 20, 60] {
        let (A, B, Q) = vehicles(count);
        let solution = solve_care(&A, &B, &Q, &Mat::eye(count));
        assert!(solution.certificate.relative_residual < 1e-15, "{count} vehicles");
        // The distances sum to nothing that the cost sees: the mean velocity keeps its own pole at -1.
        assert!(solution.closed_loop.iter().any(|l| (l - (-1.0)).norm() < 1e-9));
    }
}

#[test]
fn carex_3_2_circulant() {
    let n = 64;
    let A = Mat::from_fn(n, n, |i, j| match (i + n - j) % n {
        0 => -2.0,
        1 => 1.0,
        d if d == n - 1 => 1.0,
        _ => 0.0,
    });
    let solution = solved_g(&A, &Mat::eye(n), &Mat::eye(n));
    let wave = |k: usize| 2.0 * std::f64::consts::PI * k as f64 / n as f64;
    let entry = |d: usize| {
        let term = |k: usize| {
            let a = -2.0 + 2.0 * wave(k).cos();
            (a + (a * a + 1.0).sqrt()) * wave(k * d % n).cos() / n as f64
        };
        (0..n).map(term).sum::<f64>()
    };
    let exact = Mat::from_fn(n, n, |i, j| entry((i + n - j) % n));
    assert!(difference(&solution.X, &exact) < 4e-15);
}

#[test]
fn carex_4_1_chain_of_integrators() {
    // Known: the entry (1, n) is sqrt(q r); the other entries grow like binomial coefficients.
    for (n, q, r) in [(5, 1.0, 1.0), (21, 1.0, 1.0), (12, 100.0, 0.01)] {
        let A = Mat::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
        let B = Mat::from_fn(n, 1, |i, _| if i == n - 1 { 1.0 } else { 0.0 });
        let Q = Mat::from_fn(n, n, |i, j| if i + j == 0 { q } else { 0.0 });
        let X = solve_care(&A, &B, &Q, &Mat::eye(1).scale(r)).X;
        let expected: f64 = (q * r).sqrt();
        assert!(
            (X[(0, n - 1)] / expected - 1.0).abs() < 1e-9,
            "n = {n}: {:e}",
            X[(0, n - 1)] / expected - 1.0
        );
    }
}

#[test]
fn carex_4_3_string_of_masses() {
    let (l, mass, damping, stiffness) = (30, 4.0, 4.0, 1.0);
    let K = Mat::from_fn(l, l, |i, j| match (i as i64 - j as i64).abs() {
        0 if i == 0 || i == l - 1 => stiffness,
        0 => 2.0 * stiffness,
        1 => -stiffness,
        _ => 0.0,
    });
    let (I, O) = (Mat::eye(l), Mat::zeros(l, l));
    let A = Mat::from_blocks(&[&[&O, &I], &[&K.scale(-1.0 / mass), &I.scale(-damping / mass)]]);
    let mut B = Mat::zeros(2 * l, 2);
    (B[(l, 0)], B[(2 * l - 1, 1)]) = (1.0 / mass, -1.0 / mass);
    let solution = solve_care(&A, &B, &Mat::eye(2 * l), &Mat::eye(2));
    assert!(solution.certificate.relative_residual < 1e-15);
}

#[test]
fn darex_2_1_singular_weight() {
    let A = Mat::from_rows(&[&[4.0, 3.0], &[-4.5, -3.5]]);
    let Q = Mat::from_rows(&[&[9.0, 6.0], &[6.0, 4.0]]);
    for r in [1e6, 1.0, 1e-6, 0.0] {
        let solution = solved_discrete(&A, &Mat::col(&[1.0, -1.0]), &Q, &Mat::eye(1).scale(r));
        let exact = Q.scale(0.5 * (1.0 + (1.0 + 4.0 * r).sqrt()));
        within_data(&solution, &exact, &format!("2.1, {r:e}"));
    }
}

#[test]
fn darex_2_2_ill_conditioned_weight() {
    let A = Mat::diag(&[0.9512, 0.9048]);
    let B = Mat::from_rows(&[&[4.877, 4.877], &[-1.1895, 3.569]]);
    for e in [1.0, 1e-3, 1e-6] {
        let R = Mat::diag(&[1.0 / (3.0 * e), 3.0 * e]);
        let solution = solved_discrete(&A, &B, &Mat::diag(&[0.005, 0.02]), &R);
        assert!(solution.certificate.relative_residual < 1e-13, "2.2, {e:e}: {}", solution.certificate);
    }
}

#[test]
fn darex_2_3_large_entry() {
    for e in [1e-3, 1.0, 1e6] {
        let A = Mat::from_rows(&[&[0.0, e], &[0.0, 0.0]]);
        let solution = solved_discrete(&A, &Mat::col(&[0.0, 1.0]), &Mat::eye(2), &Mat::eye(1));
        within_data(&solution, &Mat::diag(&[1.0, 1.0 + e * e]), &format!("2.3, {e:e}"));
    }
}

#[test]
fn darex_2_5_reflected_diagonal() {
    for r in [1e-6, 1.0, 1e6] {
        let weight = Mat::eye(3).scale(r);
        let solution = solved_discrete(
            &reflect_diagonal([0.0, 1.0, 3.0]),
            &Mat::eye(3).scale(1.0 / r.sqrt()),
            &weight,
            &weight,
        );
        assert!(solution.certificate.relative_residual < 1e-14, "2.5, {r:e}");
        let unit =
            solved_discrete(&reflect_diagonal([0.0, 1.0, 3.0]), &Mat::eye(3), &Mat::eye(3), &Mat::eye(3));
        let exact = reflect_diagonal([1.0, 0.5 * (1.0 + 5f64.sqrt()), 0.5 * (9.0 + 85f64.sqrt())]);
        within_data(&unit, &exact, "2.5");
    }
}

#[test]
fn darex_4_1_shift_register() {
    for n in [10, 100] {
        let A = Mat::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
        let B = Mat::from_fn(n, 1, |i, _| if i == n - 1 { 1.0 } else { 0.0 });
        let solution = solved_discrete(&A, &B, &Mat::eye(n), &Mat::eye(1));
        let exact: Vec<f64> = (1..=n).map(|k| k as f64).collect();
        within_data(&solution, &Mat::diag(&exact), &format!("4.1, n = {n}"));
    }
}
