//! Riccati equations by what they mean: closed forms, stability, agreement, and refusals that name the mode.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{RandomGenerator, difference};
use counterpoise_linalg::{Mat, Outcome, Reason, Riccati, care, care_g, dare, eigenvalues, expm_integral};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn residual(A: &Mat, B: &Mat, Q: &Mat, solution: &Riccati) -> f64 {
    let X = &solution.X;
    let (AX, term) = (A.t() * X, X * B * &solution.F);
    (&AX + &AX.t() - &term + Q).norm_fro() / (2.0 * AX.norm_fro() + term.norm_fro() + Q.norm_fro())
}

#[test]
fn scalar_closed_form() {
    // r^2 (a + sqrt(a^2 + q^2 / r^2)) for x' = a x + u, z = [q x; r u].
    let (q, r) = (2.0_f64, 1.0_f64);
    for a in [-1.0, 0.0, 1.0, 1e6, -1e6] {
        let number = |value: f64| Mat::from_rows(&[&[value]]);
        let solution =
            care(&number(a), &number(1.0), &number(q * q), &number(r * r), None).unwrap().solution().unwrap();
        let root = (a * a + q * q / (r * r)).sqrt();
        let expected = if a > 0.0 { r * r * (a + root) } else { q * q / (root - a) };
        assert!((solution.X[(0, 0)] / expected - 1.0).abs() < 4e-16, "a = {a}");
    }
}

#[test]
fn double_integrator_closed_form_in_any_units() {
    // x'' = u, Q = diag(1, 0), R = 1: X = [sqrt 2, 1; 1, sqrt 2]; then positions in 2^k m.
    for k in [0, 13, -27, 40] {
        let unit = 2f64.powi(k);
        let A = Mat::from_rows(&[&[0.0, unit], &[0.0, 0.0]]);
        let B = Mat::col(&[0.0, 1.0]);
        let Q = Mat::diag(&[1.0 / (unit * unit), 0.0]);
        let solution = care(&A, &B, &Q, &Mat::eye(1), None).unwrap().solution().unwrap();
        let root = 2f64.sqrt();
        let expected = Mat::from_rows(&[&[root / (unit * unit), 1.0 / unit], &[1.0 / unit, root]]);
        for (value, exact) in solution.X.as_slice().iter().zip(expected.as_slice()) {
            assert!((value / exact - 1.0).abs() < 1e-15, "unit {unit}");
        }
    }
}

#[test]
fn doyles_example() {
    // A = [1 1; 0 1], B = [0; 1], Q = q 1 1': F = f [1 1], f = 2 + sqrt(4 + q).
    let A = Mat::from_rows(&[&[1.0, 1.0], &[0.0, 1.0]]);
    for q in [1.0, 10.0, 1e4] {
        let Q = Mat::from_fn(2, 2, |_, _| q);
        let solution = care(&A, &Mat::col(&[0.0, 1.0]), &Q, &Mat::eye(1), None).unwrap().solution().unwrap();
        let f = 2.0 + (4.0 + q).sqrt();
        assert!(difference(&solution.F, &Mat::row(&[f, f])) < 1e-15);
    }
}

#[test]
fn cross_terms_are_honoured() {
    // With Q = S R^-1 S' and a stable A - B R^-1 S' the solution is zero and F = R^-1 S'.
    let mut random = RandomGenerator::new(8);
    let (A0, B, S) = (random.stable(6, 0.5), random.matrix(6, 2), random.matrix(6, 2));
    let R = Mat::diag(&[2.0, 0.5]);
    let F = Mat::diag(&[0.5, 2.0]) * S.t();
    let A = &A0 + &(&B * &F);
    let solution = care(&A, &B, &(&S * &F).symmetric_part(), &R, Some(&S)).unwrap().solution().unwrap();
    assert!(solution.X.norm_fro() < 1e-13);
    assert!(difference(&solution.F, &F) < 1e-13);
    assert!(solution.certificate.newton_steps <= 12);
}

#[test]
fn indefinite_equation_of_h_infinity() {
    // Scalar: 2 a x - (1 - 1/g^2) x^2 + 1 = 0.
    let (a, g) = (-1.0_f64, 1.2_f64);
    let c = 1.0 - 1.0 / (g * g);
    let number = |value: f64| Mat::from_rows(&[&[value]]);
    let solution = care_g(&number(a), &number(c), &number(1.0)).unwrap().solution().unwrap();
    assert!((solution.X[(0, 0)] - (a + (a * a + c).sqrt()) / c).abs() < 1e-15);
    // Below the norm (1 for a = -1) the Hamiltonian reaches the axis: 2 a x + (1/g^2 - 1) x^2 + 1 with 1/g^2 - 1 > 1.
    let outcome = care_g(&number(a), &number(1.0 - 1.0 / 0.36), &number(1.0)).unwrap();
    assert!(matches!(outcome, Outcome::Infeasible(Reason::OnBoundary { .. })), "{outcome:?}");
}

#[test]
fn refusals_name_the_mode() {
    let A = Mat::diag(&[-1.0, 2.0, -3.0]);
    let B = Mat::col(&[1.0, 0.0, 1.0]);
    match care(&A, &B, &Mat::eye(3), &Mat::eye(1), None).unwrap() {
        Outcome::Infeasible(Reason::Uncontrollable { mode, .. }) => assert!((mode.re - 2.0).abs() < 1e-14),
        other => panic!("{other:?}"),
    }
    // An oscillator that the cost does not see.
    let A = Mat::from_rows(&[&[0.0, 5.0, 0.0], &[-5.0, 0.0, 0.0], &[0.0, 0.0, -1.0]]);
    let B = Mat::col(&[0.0, 1.0, 1.0]);
    let outcome = care(&A, &B, &Mat::diag(&[0.0, 0.0, 1.0]), &Mat::eye(1), None).unwrap();
    match outcome {
        Outcome::Infeasible(reason @ Reason::Unobservable { mode, .. }) => {
            assert!((mode.im - 5.0).abs() < 1e-14);
            assert!(reason.to_string().contains("5.000000j"), "{reason}");
        }
        other => panic!("{other:?}"),
    }
    // An integrator that the input does not reach.
    let A = Mat::diag(&[0.0, -1.0]);
    let outcome = care(&A, &Mat::col(&[0.0, 1.0]), &Mat::eye(2), &Mat::eye(1), None).unwrap();
    assert!(matches!(outcome, Outcome::Infeasible(Reason::Uncontrollable { .. })), "{outcome:?}");
    let outcome =
        dare(&Mat::diag(&[1.5, 0.2]), &Mat::col(&[0.0, 1.0]), &Mat::eye(2), &Mat::eye(1), None).unwrap();
    assert!(matches!(outcome, Outcome::Infeasible(Reason::Uncontrollable { .. })), "{outcome:?}");
    let singular = care(&Mat::eye(1), &Mat::eye(1), &Mat::eye(1), &Mat::zeros(1, 1), None).unwrap();
    assert!(matches!(singular, Outcome::Infeasible(Reason::SingularWeight { .. })));
}

#[test]
fn stable_modes_out_of_reach_and_sight_do_no_harm() {
    let A = Mat::diag(&[-1.0, 2.0, -3.0]);
    let B = Mat::col(&[0.0, 1.0, 0.0]);
    let solution =
        care(&A, &B, &Mat::diag(&[0.0, 1.0, 0.0]), &Mat::eye(1), None).unwrap().solution().unwrap();
    assert!((solution.X[(1, 1)] - (2.0 + 5f64.sqrt())).abs() < 1e-14);
    assert!(solution.X[(0, 0)].abs() < 1e-14 && solution.X[(2, 2)].abs() < 1e-14);
}

#[test]
fn discrete_tends_to_continuous() {
    let mut random = RandomGenerator::new(11);
    let (A, B, Q, R) = (random.matrix(5, 5), random.matrix(5, 2), Mat::eye(5), Mat::eye(2));
    let continuous = care(&A, &B, &Q, &R, None).unwrap().solution().unwrap();
    let mut errors = Vec::new();
    for h in [1e-3, 1e-4] {
        let (Phi, Gamma) = expm_integral(&A, &B, h).unwrap();
        let discrete = dare(&Phi, &Gamma, &Q.scale(h), &R.scale(h), None).unwrap().solution().unwrap();
        errors.push(difference(&discrete.X, &continuous.X));
    }
    assert!(errors[0] < 0.1 && errors[1] < 0.11 * errors[0], "{errors:?}");
}

#[test]
fn a_large_discrete_equation_is_that_of_its_parts() {
    // Ninety scalar equations in coordinates that a reflection mixes: the products of large problems are computed by halves.
    let n = 90;
    let v = Mat::from_fn(n, 1, |i, _| 1.0 + (i % 5) as f64);
    let reflection = Mat::eye(n) - (&v * v.t()).scale(2.0 / v.norm_fro().powi(2));
    let mixed = |d: &[f64]| (&reflection * &Mat::diag(d) * &reflection).symmetric_part();
    let poles: Vec<f64> = (0..n).map(|k| 0.2 + 1.5 * k as f64 / n as f64).collect();
    let scalar = |a: f64| 0.5 * (a * a + (a.powi(4) + 4.0).sqrt());
    let solution =
        dare(&mixed(&poles), &Mat::eye(n), &Mat::eye(n), &Mat::eye(n), None).unwrap().solution().unwrap();
    let exact = mixed(&poles.iter().map(|&a| scalar(a)).collect::<Vec<f64>>());
    let error = (&solution.X - &exact).norm_fro() / exact.norm_fro();
    assert!(error < 1e-14, "{error}");
    assert!(solution.certificate.relative_residual < 1e-15);
}

#[test]
fn bad_input_is_an_error() {
    let (A, B, I) = (Mat::eye(2), Mat::col(&[1.0, 1.0]), Mat::eye(1));
    assert!(care(&A, &B, &Mat::eye(3), &I, None).is_err());
    assert!(care(&A, &B, &Mat::from_rows(&[&[1.0, 2.0], &[0.0, 1.0]]), &I, None).is_err());
    assert!(care(&A, &B.scale(f64::NAN), &A, &I, None).is_err());
    assert!(dare(&A, &B, &A, &Mat::eye(2), None).is_err());
}

/// The dimensions of a random problem.
#[derive(Debug, Clone)]
struct Case {
    seed: u64,
    n: usize,
    m: usize,
    shift: f64,
    spread: f64,
    reach: f64,
}

fn cases() -> impl Strategy<Value = Case> {
    (
        any::<u32>(),
        1..14_usize,
        1..4_usize,
        -2.0..2.0_f64,
        0.0..8.0_f64,
        prop_oneof![Just(0.0), -14.0..0.0_f64],
    )
        .prop_map(|(seed, n, m, shift, spread, reach)| Case {
            seed: seed.into(),
            n,
            m,
            shift,
            spread,
            reach,
        })
}

impl Case {
    /// Returns whether a refusal can be right: a mode that the input hardly reaches, or many unstable modes to one input.
    fn is_hard(&self) -> bool {
        self.reach < -3.0 || (self.n >= 8 * self.m && self.shift.abs() > 0.5)
    }

    /// A random system in units spread over `10^(+-spread)`, one mode reached only by `10^reach`.
    fn system(&self) -> (Mat, Mat, Mat) {
        let mut random = RandomGenerator::new(self.seed);
        let (n, m) = (self.n, self.m);
        let mut A = random.matrix(n, n).scale(1.0 / (n as f64).sqrt()) + Mat::eye(n).scale(self.shift);
        let mut B = random.matrix(n, m);
        for j in 0..n.saturating_sub(1) {
            A[(n - 1, j)] *= 10f64.powf(self.reach);
        }
        (0..m).for_each(|j| B[(n - 1, j)] *= 10f64.powf(self.reach));
        let unit: Vec<f64> =
            (0..n).map(|_| 10f64.powf(self.spread * (2.0 * random.uniform() - 1.0))).collect();
        let C = random.matrix(2, n);
        let A = Mat::from_fn(n, n, |i, j| A[(i, j)] * unit[i] / unit[j]);
        let B = Mat::from_fn(n, m, |i, j| B[(i, j)] * unit[i]);
        let C = Mat::from_fn(2, n, |i, j| C[(i, j)] / unit[j]);
        (A, B, (C.t() * &C).symmetric_part())
    }
}

/// A small residual, or one that is due to the rounding of the solution alone.
fn is_certified(solution: &Riccati) -> bool {
    solution.certificate.relative_residual < 1e-9 || solution.certificate.backward_error < 1e-14
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn continuous_answers_pass_their_definition(case in cases()) {
        let (A, B, Q) = case.system();
        match care(&A, &B, &Q, &Mat::eye(case.m), None).unwrap() {
            Outcome::Solved(solution) => {
                prop_assert!(is_certified(&solution));
                prop_assert!(solution.closed_loop.iter().all(|l| l.re < 0.0));
                prop_assert_eq!(&solution.X, &solution.X.t());
                let tame = case.spread == 0.0 && solution.certificate.condition < 1e8;
                prop_assert!(!tame || residual(&A, &B, &Q, &solution) < 1e-12);
            }
            Outcome::Infeasible(reason) => {
                prop_assert!(case.is_hard(), "{}", reason);
                prop_assert!(reason.to_string().contains("reach"), "{}", reason);
            }
        }
    }

    #[test]
    fn discrete_answers_pass_their_definition(case in cases()) {
        let (A, B, Q) = case.system();
        match dare(&A, &B, &Q, &Mat::eye(case.m), None).unwrap() {
            Outcome::Solved(solution) => {
                prop_assert!(is_certified(&solution));
                prop_assert!(solution.closed_loop.iter().all(|l| l.norm() < 1.0));
            }
            Outcome::Infeasible(reason) => {
                prop_assert!(case.is_hard(), "{}", reason);
                prop_assert!(reason.to_string().contains("reach"), "{}", reason);
            }
        }
    }

    #[test]
    fn eigenvalues_keep_trace_and_pairs(case in cases()) {
        let (A, _, _) = case.system();
        let values = eigenvalues(&A).unwrap();
        let sum: f64 = values.iter().map(|l| l.re).sum();
        let size: f64 = values.iter().map(|l| l.norm()).sum();
        prop_assert!((sum - A.trace()).abs() < 1e-12 * size.max(1e-300));
        prop_assert!(values.iter().map(|l| l.im).sum::<f64>().abs() < 1e-12 * size);
    }
}
