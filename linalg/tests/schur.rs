//! The Schur form passes its definition: similarity, orthogonality, standard blocks, the wanted order.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{RandomGenerator, difference};
use counterpoise_linalg::{Mat, Schur, balance, eigenvalues, schur};

fn defects(A: &Mat, form: &Schur) -> f64 {
    let n = A.nrows();
    let similarity = difference(&(&form.U * &form.T * form.U.t()), A);
    let orthogonality = (&form.U.t() * &form.U - Mat::eye(n)).norm_fro() / (n as f64).sqrt();
    similarity.max(orthogonality)
}

fn is_standard(T: &Mat) -> bool {
    let n = T.nrows();
    let below = (0..n).all(|j| (j + 2..n).all(|i| T[(i, j)] == 0.0));
    let blocks = (0..n.saturating_sub(1)).all(|k| {
        T[(k + 1, k)] == 0.0
            || (T[(k, k)] == T[(k + 1, k + 1)]
                && T[(k, k + 1)] * T[(k + 1, k)] < 0.0
                && (k + 2 == n || T[(k + 2, k + 1)] == 0.0))
    });
    below && blocks
}

#[test]
fn random_matrices_have_a_schur_form() {
    let mut random = RandomGenerator::new(1);
    for n in [1, 2, 3, 4, 5, 8, 13, 30, 60, 150] {
        let A = random.matrix(n, n);
        let form = schur(&A).unwrap();
        assert!(defects(&A, &form) < 2e-14, "n = {n}: {:e}", defects(&A, &form));
        assert!(is_standard(&form.T), "n = {n}");
    }
}

#[test]
fn reordering_keeps_the_form_and_sorts_it() {
    let mut random = RandomGenerator::new(2);
    for n in [2, 3, 4, 7, 12, 25, 60] {
        let A = random.matrix(n, n);
        let mut form = schur(&A).unwrap();
        let before = form.eigenvalues();
        let count = form.reorder(|l| l.re < 0.0).unwrap();
        let after = form.eigenvalues();
        assert_eq!(count, before.iter().filter(|l| l.re < 0.0).count());
        assert!(after.iter().enumerate().all(|(i, l)| (l.re < 0.0) == (i < count)));
        assert!(defects(&A, &form) < 1e-13, "n = {n}");
        assert!(is_standard(&form.T));
    }
}

#[test]
fn subspace_condition_of_a_known_case() {
    // [a c; 0 b]: separation |a - b|, projector sqrt(1 + (c / (a - b))^2).
    let form = Schur { T: Mat::from_rows(&[&[1.0, 30.0], &[0.0, 1.01]]), U: Mat::eye(2) };
    let condition = form.condition(1).unwrap();
    assert!((condition.separation / 0.01 - 1.0).abs() < 1e-12);
    assert!((condition.projector / 3000f64.hypot(1.0) - 1.0).abs() < 1e-12);
    // A normal matrix: the separation is the distance of the spectra, the projector orthogonal.
    let normal = Schur { T: Mat::diag(&[-3.0, -1.0, 2.0, 5.0]), U: Mat::eye(4) };
    let condition = normal.condition(2).unwrap();
    assert!((condition.separation / 3.0 - 1.0).abs() < 1e-2);
    assert!((condition.projector - 1.0).abs() < 1e-15);
    assert!(form.condition(3).is_err());
}

#[test]
fn cyclic_permutations_converge() {
    for n in [3, 4, 10, 31] {
        let A = Mat::from_fn(n, n, |i, j| if i == (j + 1) % n { 1.0 } else { 0.0 });
        let form = schur(&A).unwrap();
        assert!(defects(&A, &form) < 1e-13);
        assert!(form.eigenvalues().iter().all(|l| (l.norm() - 1.0).abs() < 1e-13));
    }
}

#[test]
fn defective_graded_and_zero_matrices_converge() {
    let jordan = Mat::from_fn(12, 12, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
    let graded = Mat::from_fn(20, 20, |i, j| 10f64.powi(-(i as i32)) * (1.0 + (i * j % 7) as f64));
    for A in [jordan, graded, Mat::zeros(5, 5), Mat::eye(6)] {
        let form = schur(&A).unwrap();
        assert!(defects(&A, &form) < 1e-13 || A.norm_fro() == 0.0);
    }
    assert!(schur(&Mat::zeros(0, 0)).unwrap().eigenvalues().is_empty());
}

#[test]
fn eigenvalues_are_sorted_and_right() {
    // Companion matrix of (s + 1)(s + 2)(s^2 + 4).
    let A = Mat::from_rows(&[
        &[-3.0, -6.0, -12.0, -8.0],
        &[1.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, 0.0, 0.0],
        &[0.0, 0.0, 1.0, 0.0],
    ]);
    let values = eigenvalues(&A).unwrap();
    let expected = [(-2.0, 0.0), (-1.0, 0.0), (0.0, -2.0), (0.0, 2.0)];
    for (value, (re, im)) in values.iter().zip(expected) {
        assert!((value.re - re).abs() < 1e-13 && (value.im - im).abs() < 1e-13, "{value}");
    }
}

#[test]
fn eigenvalues_are_those_of_the_schur_form_to_the_last_bit() {
    let mut random = RandomGenerator::new(5);
    for n in [1, 2, 3, 7, 30, 66, 90] {
        let A = random.matrix(n, n);
        let mut expected = schur(&balance(&A).unwrap().A).unwrap().eigenvalues();
        expected.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        assert_eq!(eigenvalues(&A).unwrap(), expected, "{n}");
    }
}

#[test]
fn balancing_is_exact_and_rescues_bad_units() {
    let mut random = RandomGenerator::new(3);
    let good = random.matrix(9, 9);
    let A = Mat::from_fn(9, 9, |i, j| good[(i, j)] * 2f64.powi(6 * (i as i32 - j as i32)));
    let balanced = balance(&A).unwrap();
    assert!(balanced.A.norm_fro() < 4.0 * good.norm_fro());
    let back = Mat::from_fn(9, 9, |i, j| balanced.scale[i] * balanced.A[(i, j)] / balanced.scale[j]);
    assert_eq!(back, A);
}

#[test]
fn bad_input_is_refused() {
    assert!(schur(&Mat::zeros(2, 3)).is_err());
    assert!(eigenvalues(&Mat::diag(&[1.0, f64::NAN])).is_err());
}
