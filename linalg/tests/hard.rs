//! Problems at which the solvers once gave wrong answers or false refusals, each with its exact solution.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{RandomGenerator, solve_care, solved_discrete, solved_g};
use counterpoise_linalg::{
    Boundary, Error, Mat, Outcome, Reason, Riccati, boundary_eigenvalues, care, dare, dlyap, dlyap_factor,
    expm, expm_integral, inverse, lyap, lyap_factor, lyap_separation,
};

/// Every entry against the exact one, relative to the states' own sizes.
fn agrees(X: &Mat, exact: &Mat, tolerance: f64, what: &str) {
    for i in 0..exact.nrows() {
        for j in 0..exact.nrows() {
            let size = (exact[(i, i)] * exact[(j, j)]).abs().sqrt();
            let error = (X[(i, j)] - exact[(i, j)]).abs() / size;
            assert!(
                error <= tolerance,
                "{what}: entry ({i}, {j}) is {:e}, not {:e}",
                X[(i, j)],
                exact[(i, j)]
            );
        }
    }
}

#[test]
fn a_delay_line_behind_a_slow_lag_converges_state_by_state() {
    for e in [1e-4, 1e-7, 1e-10, 1e-12] {
        let (a, b, r) = (1.0 - e, e, 0.25);
        let mut A = Mat::from_fn(4, 4, |i, j| if i == j + 1 { 1.0 } else { 0.0 });
        A[(0, 0)] = a;
        let B = Mat::col(&[b, 0.0, 0.0, 0.0]);
        let found = solved_discrete(&A, &B, &Mat::diag(&[0.0, 0.0, 0.0, 1.0]), &Mat::eye(1).scale(r));
        // x b^2 - x (r (a^2 - 1) + b^2) - r = 0 for x11; the delay line holds ones.
        let term = r * (a + 1.0) * (a - 1.0) + b * b;
        let x = 0.5 * (term + (term * term + 4.0 * b * b * r).sqrt()) / (b * b);
        agrees(&found.X, &Mat::diag(&[x, 1.0, 1.0, 1.0]), 1e-13, &format!("lag {e:e}"));
        assert!(found.certificate.forward_error[(0, 0)] <= 1e-13 * x);
    }
}

#[test]
fn no_weight_on_the_input_is_solved_by_a_shift() {
    let A = Mat::from_rows(&[&[-1.0, 1.0], &[0.0, 2.0]]);
    let found = solved_discrete(&A, &Mat::col(&[0.0, 1.0]), &Mat::eye(2), &Mat::zeros(1, 1));
    // The first state obeys x+ = -x + u with u free: x11 - 1 is the golden ratio.
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    assert!((found.X[(0, 0)] - 1.0 - golden).abs() < 1e-15 * 10.0, "{:?}", found.X);
    assert!(found.closed_loop.iter().all(|pole| pole.norm() < 1.0));
}

#[test]
fn a_slow_stable_mode_is_not_taken_for_an_integrator() {
    for e in [1e-6, 1e-9, 1e-13, 1e-30] {
        let A = Mat::diag(&[1.0, -e]);
        let found = solve_care(&A, &Mat::col(&[1.0, 1.0]), &Mat::diag(&[1.0, 0.0]), &Mat::eye(1));
        assert!((found.X[(0, 0)] - (1.0 + 2f64.sqrt())).abs() < 1e-15 * 10.0, "{e:e}: {:?}", found.X);
        assert!(found.closed_loop.iter().all(|pole| pole.re < 0.0), "{e:e}");
    }
}

#[test]
fn two_equal_fast_unstable_modes_in_series() {
    let A = Mat::from_rows(&[&[1000.0, 0.0], &[1.0, 1000.0]]);
    let B = Mat::col(&[0.01, 0.0]);
    let found = solve_care(&A, &B, &Mat::diag(&[0.0, 1e-5]), &Mat::eye(1).scale(100.0));
    // Nearly minimum energy: X = 4 a r/b^2 [1 2a... ] in closed form for q = 0, changed by q in the 17th digit.
    let (a, g) = (1000.0, 1e-6);
    let exact = Mat::from_rows(&[&[4.0 * a / g, 4.0 * a * a / g], &[4.0 * a * a / g, 8.0 * a * a * a / g]]);
    agrees(&found.X, &exact, 1e-14, "series");
}

#[test]
fn cheap_control_has_a_reason_or_a_solution() {
    // x11 = sqrt(q1 + 2 sqrt(q r)) ... in the limit of a small weight: 1 and its root.
    let A = Mat::from_rows(&[&[0.0, 1.0], &[0.0, 0.0]]);
    // The last one is a control that is weighed by 1e-12.
    for r in [1e-8, 1e-12, 1e-16, 1e-20, 1e-24] {
        let found = solve_care(&A, &Mat::col(&[0.0, 1.0]), &Mat::diag(&[1.0, 0.0]), &Mat::eye(1).scale(r));
        let root = r.sqrt().sqrt();
        let exact = Mat::from_rows(&[
            &[2f64.sqrt() * root, root * root],
            &[root * root, 2f64.sqrt() * root * root * root],
        ]);
        agrees(&found.X, &exact, 1e-14, &format!("weight {r:e}"));
    }
}

#[test]
fn a_reflected_diagonal_over_twelve_decades() {
    let V = Mat::from_fn(3, 3, |i, j| if i == j { 1.0 / 3.0 } else { -2.0 / 3.0 });
    let reflected = |d: [f64; 3]| (&V * &Mat::diag(&d) * &V).symmetric_part();
    for e in [3e7, 1e9, 1e12] {
        let A = reflected([e, 2.0 * e, 3.0 * e]);
        let found = solved_g(&A, &Mat::eye(3).scale(1.0 / e), &reflected([1.0 / e, 1.0, e]));
        let exact = |a: f64, q: f64| e * (a + (a * a + q / e).sqrt());
        let X = reflected([exact(e, 1.0 / e), exact(2.0 * e, 1.0), exact(3.0 * e, e)]);
        agrees(&found.X, &X, 1e-14, &format!("{e:e}"));
    }
}

#[test]
fn the_certificate_can_be_recomputed_in_the_callers_units() {
    let mut random = RandomGenerator::new(5);
    let unit: Vec<f64> = (0..5).map(|k| 10f64.powi(3 * k - 6)).collect();
    let A = random.matrix(5, 5);
    let A = Mat::from_fn(5, 5, |i, j| A[(i, j)] * unit[i] / unit[j]);
    let B = Mat::from_fn(5, 1, |i, _| unit[i]);
    let Riccati { X, F, certificate, .. } = solve_care(&A, &B, &Mat::diag(&[1.0; 5]), &Mat::eye(1));
    let terms = 2.0 * (A.t() * &X).norm_fro() + (&X * &B * &F).norm_fro() + 5f64.sqrt();
    assert!((certificate.term_norm / terms - 1.0).abs() < 1e-12);
    // Rounding X alone leaves this, since A'X and XB are small against their terms.
    let XB = X.map(f64::abs) * B.map(f64::abs);
    let rounding = f64::EPSILON * (A.t().map(f64::abs) * X.map(f64::abs) + &XB * XB.t()).norm_fro();
    assert!(certificate.residual_norm < 4.0 * rounding, "{:e} of {rounding:e}", certificate.residual_norm);
    for i in 0..5 {
        for j in 0..5 {
            let size = (X[(i, i)] * X[(j, j)]).sqrt();
            assert!(certificate.forward_error[(i, j)] < 1e-14 * size, "({i}, {j})");
        }
    }
    // The condition, from the closed loop's Lyapunov equation in these units; units alone make no solution sensitive.
    let half = A.t().map(f64::abs) * X.map(f64::abs);
    let k = F.map(f64::abs);
    let moduli = half.t() + half + Mat::eye(5) + k.t() * &k;
    let change = lyap(&(&A - &B * &F).t(), &moduli).unwrap();
    let mut condition = 0.0_f64;
    for i in 0..5 {
        for j in 0..5 {
            let ratio = certificate.data_error[(i, j)] / (f64::EPSILON * change[(i, j)].abs());
            assert!((ratio - 1.0).abs() < 1e-2, "({i}, {j}): {ratio}");
            condition = condition.max(change[(i, j)].abs() / (X[(i, i)] * X[(j, j)]).sqrt());
        }
    }
    assert!((certificate.condition / condition - 1.0).abs() < 1e-2, "{}", certificate.condition);
    assert!(!certificate.is_sensitive(), "{certificate}");
}

#[test]
fn an_integrator_in_hiding_makes_the_lyapunov_equation_singular() {
    let A = Mat::from_rows(&[&[2.0, 2.0], &[-3.0, -3.0]]);
    assert!(matches!(lyap(&A, &Mat::eye(2)), Err(Error::CommonEigenvalue { .. })));
    assert!(matches!(lyap_factor(&A, &Mat::eye(2)), Err(Error::NotStable { .. })));
    assert!(boundary_eigenvalues(&A, Boundary::ImaginaryAxis).unwrap().len() == 1);
    let A = Mat::from_rows(&[&[0.0, 1.0], &[-1.0, -1.0]]);
    assert!(matches!(dlyap(&A, &Mat::eye(2)), Err(Error::CommonEigenvalue { .. })));
}

#[test]
fn a_slow_mode_beside_a_fast_one_keeps_its_digits() {
    let A = Mat::from_rows(&[&[-1e12, 1.0], &[0.0, -1e-6]]);
    let X = lyap(&A, &Mat::eye(2)).unwrap();
    assert!((X[(1, 1)] / 5e5 - 1.0).abs() < 1e-14, "{:?}", X);
    // The separation is that of the slow mode.
    assert!((lyap_separation(&Mat::diag(&[-1e6, -1e-3])).unwrap() / 2e-3 - 1.0).abs() < 1e-10);
}

#[test]
fn a_nearly_defective_equation_is_refined() {
    // exp(A t) of a Jordan block in closed form; 1e-4 from the axis the solution grows to 1e19.
    let a = 1e-4;
    let A = Mat::from_fn(3, 3, |i, j| {
        if i == j {
            -a
        } else if j == i + 1 {
            1.0
        } else {
            0.0
        }
    });
    let mut Q = Mat::zeros(3, 3);
    Q[(2, 2)] = 1.0;
    let X = lyap(&A, &Q).unwrap();
    // x33 = 1/(2a), x23 = x33/(2a), x22 = 2 x23/(2a), x13 = x23/(2a), x12 = (x22 + x13)/(2a), x11 = 2 x12/(2a).
    let h = 0.5 / a;
    let exact = [h, h * h, 2.0 * h.powi(3), h.powi(3), 3.0 * h.powi(4), 6.0 * h.powi(5)];
    let found = [X[(2, 2)], X[(1, 2)], X[(1, 1)], X[(0, 2)], X[(0, 1)], X[(0, 0)]];
    for (x, e) in found.iter().zip(exact) {
        assert!((x / e - 1.0).abs() < 1e-12, "{x:e} {e:e}");
    }
}

#[test]
fn empty_problems_have_empty_solutions() {
    let none = Mat::zeros(0, 0);
    for m in 0..3 {
        let (B, R) = (Mat::zeros(0, m), Mat::eye(m));
        assert_eq!(care(&none, &B, &none, &R, None).unwrap().solution().unwrap().F.shape(), (m, 0));
        assert_eq!(dare(&none, &B, &none, &R, None).unwrap().solution().unwrap().F.shape(), (m, 0));
    }
    let A = Mat::diag(&[-1.0, -2.0]);
    let found = care(&A, &Mat::zeros(2, 0), &Mat::eye(2), &none, None).unwrap().solution().unwrap();
    assert!((found.X[(0, 0)] - 0.5).abs() < 1e-15);
    assert_eq!(inverse(&none).unwrap().shape(), (0, 0));
}

#[test]
fn a_mode_out_of_reach_is_refused_quickly_by_name() {
    let n = 40;
    let mut random = RandomGenerator::new(3);
    let mut A = random.matrix(n, n);
    (0..n - 1).for_each(|j| A[(n - 1, j)] = 0.0);
    A[(n - 1, n - 1)] = 0.5;
    let mut B = random.matrix(n, 2);
    (B[(n - 1, 0)], B[(n - 1, 1)]) = (0.0, 0.0);
    match care(&A, &B, &Mat::eye(n), &Mat::eye(2), None).unwrap() {
        Outcome::Infeasible(Reason::Uncontrollable { mode, .. }) => {
            assert!((mode.re - 0.5).abs() < 1e-9, "{mode}")
        }
        other => panic!("{other:?}"),
    }
    let why: Box<dyn std::error::Error> = Box::new(Reason::NoGraph);
    assert!(!why.to_string().is_empty());
}

/// A triple pole at 0 of which one is out of reach: rounding moves the poles by 7e-6, so that no eigenvalue tells, and Newton's method in
/// doubles ends at something with a residual of a seventh. It is refused.
#[test]
fn a_multiple_pole_that_is_out_of_reach_is_refused() {
    let A = Mat::from_rows(&[
        &[-3.0, -4.0, -2.0, 0.0],
        &[1.0, 2.0, 1.0, 0.0],
        &[1.0, -3.0, -1.0, -1.0],
        &[-4.0, -3.0, -2.0, 1.0],
    ]);
    let B = Mat::col(&[-1.0, -1.0, 2.0, 1.0]);
    let answer = care(&A, &B, &Mat::eye(4), &Mat::eye(1), None).unwrap();
    assert!(matches!(answer, Outcome::Infeasible(_)), "{answer:?}");
}

#[test]
fn a_chain_damped_by_1e_9_has_a_covariance() {
    // In doubles the lowest mode may lie on the axis: rounding the norm of A moves it by as much as its damping.
    let K = Mat::from_rows(&[
        &[704.5318426690519, -281.2458331034471, 0.0, 0.0, 0.0],
        &[-76.81887120327058, 84.35544953909735, -7.536578335826765, 0.0, 0.0],
        &[0.0, -15.571752987854884, 152532.81433280624, -152517.24257981838, 0.0],
        &[0.0, 0.0, -157598.79656165818, 196939.93352468158, -39341.136963023404],
        &[0.0, 0.0, 0.0, -3095.630330702293, 3095.630330702293],
    ]);
    let D = Mat::from_rows(&[
        &[4.637174871707827e-08, -1.851138630014299e-08, 0.0, 0.0, 0.0],
        &[-5.056159532367638e-09, 5.5522113721986766e-09, -4.960518398310381e-10, 0.0, 0.0],
        &[0.0, -1.0249209090417437e-09, 1.0039593541369897e-05, -1.0038568620460855e-05, 0.0],
        &[0.0, 0.0, -1.0373032629135668e-05, 1.2962436268554191e-05, -2.5894036394185227e-06],
        &[0.0, 0.0, 0.0, -2.0375202811624228e-07, 2.0375202811624228e-07],
    ]);
    let k = K.nrows();
    let A = Mat::from_blocks(&[&[&Mat::zeros(k, k), &Mat::eye(k)], &[&-K, &-D]]);
    let Q = Mat::from_fn(2 * k, 2 * k, |i, j| if i == j && i == 8 { 31.42564553468977 } else { 0.0 });
    assert!(boundary_eigenvalues(&A, Boundary::ImaginaryAxis).unwrap().is_empty());
    let X = lyap(&A, &Q).unwrap();
    let exact = [
        4074306.3163910448,
        25498042.203441624,
        1247007576.0784266,
        1247210498.060487,
        1247964277.5545971,
        3886186.0901009934,
        24254650.012649182,
        1168263492.0722132,
        1168006956.2963543,
        1167039019.3967726,
    ];
    for (i, exact) in exact.into_iter().enumerate() {
        assert!((X[(i, i)] / exact - 1.0).abs() < 1e-10, "{i}: {:e} {exact:e}", X[(i, i)]);
    }
}

#[test]
fn a_free_body_beside_a_light_mass_has_a_double_pole_on_the_boundary() {
    // Rounding the norm of A splits it by 5e-6; the pole of the entries as they are given lies on the axis.
    let K = Mat::from_rows(&[
        &[1428.5747373532624, -1428.5747373532624, 0.0, 0.0],
        &[-186.5553072963756, 272.7360417363857, -86.18073444001008, 0.0],
        &[0.0, -9467.666740468647, 21231.287631698986, -11763.62089123034],
        &[0.0, 0.0, -262534.8155352317, 262534.8155352317],
    ]);
    let D = Mat::from_rows(&[
        &[0.016299705113696442, -0.016299705113696442, 0.0, 0.0],
        &[-0.002128552617386798, 0.003111854730412043, -0.0009833021130252451, 0.0],
        &[0.0, -0.10802387298987337, 0.24224404823364049, -0.13422017524376711],
        &[0.0, 0.0, -2.995461114782954, 2.995461114782954],
    ]);
    let A = Mat::from_blocks(&[&[&Mat::zeros(4, 4), &Mat::eye(4)], &[&-K, &-D]]);
    assert_eq!(boundary_eigenvalues(&A, Boundary::ImaginaryAxis).unwrap().len(), 2);
}

#[test]
fn the_far_corner_of_the_exponential_of_a_chain_keeps_its_digits() {
    // exp(h J) of a Jordan block with the eigenvalue -1 holds exp(-h) h^d / d! on the diagonal d.
    for (n, h) in [(5, 1e-3), (9, 3e-4), (12, 1e-6), (12, 0.5), (40, 1e-2), (90, 1.0)] {
        let J = Mat::from_fn(n, n, |i, j| match (i == j, j == i + 1) {
            (true, _) => -h,
            (_, true) => h,
            _ => 0.0,
        });
        let E = expm(&J).unwrap();
        let mut exact = (-h).exp();
        for d in 0..n {
            assert!((E[(0, d)] / exact - 1.0).abs() < 1e-11, "{n} {h} {d}: {:e} {exact:e}", E[(0, d)]);
            exact *= h / (d + 1) as f64;
        }
    }
}

#[test]
fn rounding_errors_in_place_of_zeros_are_no_couplings() {
    // Entries of 2^-57 below the diagonal, as a rotation leaves them: balanced against the large ones above, they were taken for couplings, and the
    // solution was wrong by 19 decades. It is that of the triangular matrix, by substitution from the last row up.
    let e = f64::exp2(-57.0);
    let A = Mat::from_rows(&[&[-4.0, -6.0, -8.0], &[-e, -4.0, -5.0], &[0.0, e, -4.0]]);
    let b = Mat::col(&[2.0, -2.0, -2.0]);
    let Q = &b * &b.t();
    let exact = Mat::from_rows(&[
        &[3.0419921875, -0.173828125, -1.140625],
        &[-0.173828125, 0.265625, 0.1875],
        &[-1.140625, 0.1875, 0.5],
    ]);
    agrees(&lyap(&A, &Q).unwrap(), &exact, 1e-14, "solution");
    let factor = lyap_factor(&A, &b).unwrap();
    agrees(&(&factor * &factor.t()), &exact, 1e-14, "factor");
    let small = A.scale(0.125);
    let (mut sum, mut power) = (Q.clone(), small.clone());
    for _ in 0..10 {
        sum = &sum + &(&power * &sum * &power.t());
        power = &power * &power;
    }
    agrees(&dlyap(&small, &Q).unwrap(), &sum, 1e-14, "sampled solution");
    let factor = dlyap_factor(&small, &b).unwrap();
    agrees(&(&factor * &factor.t()), &sum, 1e-14, "sampled factor");
    // exp of the triangular matrix: exp(-h) times the finite series of its nilpotent part.
    let h = f64::exp2(-10.0);
    let N = Mat::from_rows(&[&[0.0, -6.0 * h, -8.0 * h], &[0.0, 0.0, -5.0 * h], &[0.0, 0.0, 0.0]]);
    let series = (Mat::eye(3) + &N + (&N * &N).scale(0.5)).scale((-4.0 * h).exp());
    let found = expm(&A.scale(h)).unwrap();
    for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
        assert!((found[(i, j)] / series[(i, j)] - 1.0).abs() < 1e-15, "{i} {j}: {:e}", found[(i, j)]);
    }
}

#[test]
fn the_last_entries_of_long_chains_keep_their_digits() {
    // n equal lags: exp(-x) x^d / d! after d steps. The approximant of Pade had an error of 2^d roundings there, 2e-9 after 24.
    for (n, x) in [(10, 1e-3), (24, 1e-3), (25, 0.7), (40, 1e-2), (60, 0.3)] {
        let A = Mat::from_fn(n, n, |i, j| match i.checked_sub(j) {
            Some(0) => -x,
            Some(1) => x,
            _ => 0.0,
        });
        let mut B = Mat::zeros(n, 1);
        B[(0, 0)] = x;
        let (Phi, Gamma) = expm_integral(&A, &B, 1.0).unwrap();
        let E = expm(&A).unwrap();
        let mut exact = (-x).exp();
        for d in 0..n {
            for found in [E[(d, 0)], Phi[(n - 1, n - 1 - d)]] {
                assert!((found / exact - 1.0).abs() < 2e-14, "{n} {x} {d}: {found} {exact}");
            }
            exact *= x / (d + 1) as f64;
            // Gamma is the probability of more than d events of a Poisson process.
            let (mut term, mut tail) = (exact, exact);
            for k in d + 2..d + 60 {
                term *= x / k as f64;
                tail += term;
            }
            assert!((Gamma[(d, 0)] / tail - 1.0).abs() < 2e-14, "{n} {x} {d}: {} {tail}", Gamma[(d, 0)]);
        }
    }
}

#[test]
fn the_ends_of_a_rod_whose_dampers_are_a_shorter_way_than_its_springs_keep_their_digits() {
    // Thirty-two masses between springs and dashpots: the entries from one end to the other are reached in half as many steps through the dashpots, but the largest
    // terms are those of the springs. The series ended before them, and the entries were off by two millionths. Exact to 1200 bits (python-flint).
    let k = 32;
    let stiffness = Mat::from_fn(k, k, |i, j| match i.abs_diff(j) {
        0 => -2.0,
        1 => 1.0,
        _ => 0.0,
    });
    let A = Mat::from_blocks(&[&[&Mat::zeros(k, k), &Mat::eye(k)], &[&stiffness, &stiffness.scale(0.02)]]);
    let E = expm(&A.scale(0.3)).unwrap();
    for (row, column, exact) in [
        (0, 63, 5.667816260053641e-101),
        (0, 31, 2.07397188082622e-99),
        (32, 63, 7.613187705191067e-99),
        (40, 20, 4.1658723111268106e-31),
    ] {
        assert!((E[(row, column)] / exact - 1.0).abs() < 1e-12, "{row} {column} {}", E[(row, column)]);
    }
}

#[test]
fn the_factor_of_a_nearly_defective_pair_is_that_of_the_solution() {
    // Eigenvalues -5, -3, -3, -1, -1 in integer coordinates, of which the input reaches three: the factor of a pair is singular, and its phase was that of rounding.
    let A = Mat::from_rows(&[
        &[-2.0, 2.0, 3.0, 0.0, 2.0],
        &[-8.0, -11.0, -8.0, 3.0, -3.0],
        &[19.0, 18.0, 14.0, -8.0, 6.0],
        &[-5.0, -4.0, -1.0, 0.0, 1.0],
        &[-33.0, -32.0, -29.0, 15.0, -14.0],
    ]);
    let e = f64::exp2(-31.0);
    let B = Mat::col(&[-0.5, -e, 3.0 + e, 2.0 + e, -3.0 + 2.0 * e]);
    let factor = lyap_factor(&A, &B).unwrap();
    agrees(&(&factor * &factor.t()), &lyap(&A, &(&B * &B.t())).unwrap(), 1e-12, "factor");
}

#[test]
fn the_exponential_of_a_triangle_with_rounding_errors_below_it_is_that_of_the_series() {
    // Balanced, the rounding errors make the entries above the diagonal so uneven that the way through all states is the largest one from the last
    // to the first; an approximant of low degree lacks it.
    let e = -2.5e-17;
    let A = Mat::from_rows(&[
        &[-4e-3, -0.09, -0.12, 0.0, -0.06, 0.03, -4e-4, 0.0],
        &[e, -4e-3, 0.04, -0.12, -0.03, -0.12, 2e-3, 0.0],
        &[0.0, 0.0, -4e-3, 0.1, -0.01, -0.09, 1e-3, 0.0],
        &[0.0, 0.0, e, -4e-3, 0.07, -0.04, 2e-3, 0.0],
        &[0.0, 0.0, 0.0, 0.0, -4e-3, 0.12, -4e-4, 0.0],
        &[0.0, 0.0, 0.0, 0.0, 0.0, -4e-3, 2e-3, 0.0],
        &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        &[0.0; 8],
    ]);
    let (mut sum, mut term) = (Mat::eye(8), Mat::eye(8));
    for k in 1..30 {
        term = (&term * &A).scale(1.0 / f64::from(k));
        sum = &sum + &term;
    }
    let found = expm(&A).unwrap();
    for i in 0..8 {
        for j in 0..8 {
            let (a, b) = (found[(i, j)], sum[(i, j)]);
            assert!((a - b).abs() <= 1e-12 * b.abs(), "{i} {j}: {a:e} {b:e}");
        }
    }
}
