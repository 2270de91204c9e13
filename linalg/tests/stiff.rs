//! Exponentials and their integrals of stiff matrices: what fast states leave of slow ones.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{
    Error, Mat, expm, expm_integral, van_loan_accumulated, van_loan_cost, van_loan_noise,
};

use crate::common::RandomGenerator;

fn relative(found: f64, exact: f64) -> f64 {
    (found / exact - 1.0).abs()
}

#[test]
fn a_slow_lag_beside_a_fast_one_keeps_its_digits() {
    for decade in 0..=14 {
        for (fast, slow, h) in [(1.0, 1.0, 1.0), (3.0, 0.7, 0.5), (1.0, 1e-3, 100.0), (7.0, 1e-6, 1e-2)] {
            let f = fast * 10f64.powi(decade);
            for coupling in [0.0, 1.0] {
                let A = Mat::from_rows(&[&[-f, coupling], &[0.0, -slow]]);
                let (Phi, Gamma) = expm_integral(&A, &Mat::col(&[1.0, 1.0]), h).unwrap();
                let (_, W) = van_loan_cost(&A, &Mat::diag(&[0.0, 1.0]), h).unwrap();
                let (_, N) = van_loan_noise(&A, &Mat::diag(&[0.0, 1.0]), h).unwrap();
                let P = van_loan_accumulated(&A, &Mat::diag(&[0.0, 1.0]), h).unwrap();
                let x = slow * h;
                let held = -(-x).exp_m1() / slow;
                let square = -(-2.0 * x).exp_m1() / (2.0 * slow);
                let sum = if x > 0.1 {
                    (h - square) / (2.0 * slow)
                } else {
                    0.5 * h * h * (1.0 - 2.0 * x / 3.0 + x * x / 3.0 - 2.0 * x * x * x / 15.0)
                };
                let found =
                    [expm(&A.scale(h)).unwrap()[(1, 1)], Phi[(1, 1)], Gamma[(1, 0)], W[(1, 1)], N[(1, 1)]];
                let exact = [(-x).exp(), (-x).exp(), held, square, square];
                for (k, (found, exact)) in found.into_iter().zip(exact).enumerate() {
                    assert!(
                        relative(found, exact) < 3e-14,
                        "{k}: {f:e} {slow} {h} {coupling}: {found:e} {exact:e}"
                    );
                }
                let tolerance = if x > 0.1 { 3e-14 / x } else { 0.1 * x.powi(4) + 3e-14 };
                assert!(
                    relative(P[(1, 1)], sum) < tolerance,
                    "sum: {f:e} {slow} {h}: {:e} {sum:e}",
                    P[(1, 1)]
                );
            }
        }
    }
}

#[test]
fn a_lag_that_a_fast_one_feeds_back_to_keeps_its_digits() {
    // [-f a; b -1]: the slow eigenvalue is the determinant over the fast one.
    for decade in 1..=14 {
        for (a, b, h) in [(1.0, 1.0, 1.0), (0.5, -2.0, 3.0), (1e3, 1e-3, 1.0), (1e-4, 1e4, 2.0)] {
            let f = 2.0 * 10f64.powi(decade);
            let (sum, difference) = (f + 1.0, f - 1.0);
            let fast = -0.5 * (sum + (difference * difference + 4.0 * a * b).sqrt());
            let slow = (f - a * b) / fast;
            let (e, gap) = ((slow * h).exp(), slow - fast);
            let A = Mat::from_rows(&[&[-f, a], &[b, -1.0]]);
            let found = expm(&A.scale(h)).unwrap();
            // The fast part has decayed but for the lowest decade.
            let last = (fast * h).exp();
            let exact = [
                (0, 1, a * (e - last) / gap),
                (1, 0, b * (e - last) / gap),
                (1, 1, (e * (-1.0 - fast) - last * (-1.0 - slow)) / gap),
            ];
            for (i, j, exact) in exact {
                assert!(
                    relative(found[(i, j)], exact) < 5e-14,
                    "{f:e} {a} {b} {h} {i} {j}: {:e} {exact:e}",
                    found[(i, j)]
                );
            }
        }
    }
}

/// Returns an upper triangle with eigenvalues that are negative powers of two, the fastest first or last, its exponential, and the sums of the moduli of what that is made of. The eigenvectors and their inverse hold small integers,
/// so that every entry is exact.
fn triangle(random: &mut RandomGenerator, n: usize, bits: f64) -> [Mat; 3] {
    let mut T = Mat::eye(n);
    for j in 0..n {
        (0..j).for_each(|i| T[(i, j)] = (6.0 * random.uniform() - 3.0).round());
    }
    let inverse = counterpoise_linalg::inverse(&T).unwrap().map(f64::round);
    let mut rates: Vec<f64> = (0..n).map(|_| -(bits * random.uniform()).round().exp2()).collect();
    rates.sort_by(f64::total_cmp);
    if random.uniform() < 0.5 {
        rates.reverse();
    }
    let decay: Vec<f64> = rates.iter().map(|r| r.exp()).collect();
    let of = |values: &[f64]| &T * &(&Mat::diag(values) * &inverse);
    let sizes = &T.map(f64::abs) * &(&Mat::diag(&decay) * &inverse.map(f64::abs));
    [of(&rates), of(&decay), sizes]
}

#[test]
fn triangles_of_many_rates_keep_the_digits_that_their_entries_determine() {
    let mut random = RandomGenerator::new(20);
    for n in 2..=6 {
        for bits in [4.0, 10.0, 20.0, 30.0, 4.0, 10.0, 20.0, 30.0] {
            let [A, exact, sizes] = triangle(&mut random, n, bits);
            let found = expm(&A).unwrap();
            // What a share of 1e-7 of each entry changes, over that share.
            let mut condition = found.map(f64::abs);
            for _ in 0..4 {
                let changed = expm(&A.map(|a| a * (1.0 + 1e-7 * (random.uniform() - 0.5).signum()))).unwrap();
                let change = (&changed - &found).map(|d| d.abs() / 1e-7);
                condition = Mat::from_fn(n, n, |i, j| condition[(i, j)].max(change[(i, j)]));
            }
            for j in 0..n {
                for i in 0..=j {
                    let error = (found[(i, j)] - exact[(i, j)]).abs();
                    let limit = 1e-14 * condition[(i, j)] + 1e-15 * sizes[(i, j)] + 1e-250;
                    assert!(error <= limit, "{n} {bits} {i} {j}: {error:e} {:e}", condition[(i, j)]);
                }
            }
        }
    }
}

#[test]
fn a_matrix_beyond_the_range_of_numbers_is_refused_at_once() {
    let A = Mat::from_rows(&[&[0.0, 1.0], &[0.0, -1.0]]);
    let B = Mat::col(&[0.0, 1.0]);
    for h in [9e307, 1e308, f64::MAX] {
        assert!(expm(&A.scale(h)).is_err());
        assert!(expm_integral(&A, &B, h).is_err());
        assert!(van_loan_cost(&A.scale(10.0), &Mat::eye(2), h).is_err());
        assert!(van_loan_accumulated(&A.scale(10.0), &Mat::eye(2), h).is_err());
    }
    let full = Mat::from_fn(2, 2, |_, _| f64::MAX);
    assert!(matches!(expm(&full), Err(Error::OutOfRange { .. })), "{:?}", expm(&full));
    for answer in [expm(&Mat::diag(&[f64::NAN])), expm(&Mat::diag(&[f64::INFINITY]))] {
        assert!(matches!(answer, Err(Error::NotFinite { .. })), "{answer:?}");
    }
}
