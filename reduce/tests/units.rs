//! The minimal part of a system does not depend on the units of its states, inputs and outputs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{Mat, qr_full_q};
use counterpoise_lti::{StateSpace, Timebase, response_at};
use counterpoise_reduce::{MinimalRealisation, minimal_realisation};

use crate::random::RandomGenerator;

fn system(A: Mat, B: Mat, C: Mat) -> StateSpace {
    let D = Mat::zeros(C.nrows(), B.ncols());
    StateSpace::new(A, B, C, D, Timebase::Continuous).unwrap()
}

/// Returns a system with the given order of its minimal part: modes of their own, some out of reach, some out of sight, some both, some with the pole of another.
fn modes(random: &mut RandomGenerator, near: f64) -> (StateSpace, usize) {
    let (mut poles, mut b, mut c) = (Vec::new(), Vec::new(), Vec::new());
    let seen = 1 + (4.0 * random.uniform()) as usize;
    let size = |random: &mut RandomGenerator| 0.5 + 1.5 * random.uniform();
    for k in 0..seen {
        poles.push(-(1.0 + k as f64 + 0.5 * random.uniform()));
        b.push(size(random));
        c.push(-size(random));
    }
    for _ in 0..(4.0 * random.uniform()) as usize {
        let kind = (3.0 * random.uniform()) as usize;
        poles.push(if random.uniform() < 0.5 { poles[0] * (1.0 + near) } else { -9.0 * random.uniform() });
        b.push(if kind == 0 { size(random) } else { 0.0 });
        c.push(if kind == 1 { size(random) } else { 0.0 });
    }
    (system(Mat::diag(&poles), Mat::col(&b), Mat::row(&c)), seen)
}

/// Returns the same with coupled oscillators and a chain behind it, which adds `2 + count` to the order.
fn with_chain(g: &StateSpace, random: &mut RandomGenerator) -> (StateSpace, usize) {
    let count = 1 + (3.0 * random.uniform()) as usize;
    let n = 2 + count;
    let mut A = Mat::zeros(n, n);
    (A[(0, 1)], A[(1, 0)], A[(1, 1)]) = (3.0, -3.0, -0.2);
    for i in 2..n {
        (A[(i, i - 1)], A[(i, i)]) = (1.0, -0.3 - 0.2 * i as f64 - 0.1 * random.uniform());
    }
    let (mut B, mut C) = (Mat::zeros(n, 1), Mat::zeros(1, n));
    (B[(1, 0)], C[(0, n - 1)]) = (1.0, 1.0);
    let chain = system(A, B, C);
    (counterpoise_lti::parallel(g, &chain).unwrap(), n)
}

fn rotate(g: &StateSpace, random: &mut RandomGenerator) -> StateSpace {
    let n = g.order();
    let U = qr_full_q(&random.matrix(n, n)).unwrap();
    system(&U.t() * &(&g.A * &U), &U.t() * &g.B, &g.C * &U)
}

/// Returns the system in units that are powers of ten, as an engineer chooses them: every entry is rounded.
fn in_other_units(g: &StateSpace, decades: f64, random: &mut RandomGenerator) -> StateSpace {
    let mut unit = || 10f64.powi((decades * (2.0 * random.uniform() - 1.0)).round() as i32);
    let d: Vec<f64> = (0..g.order()).map(|_| unit()).collect();
    let (input, output) = (unit(), unit());
    let n = g.order();
    system(
        Mat::from_fn(n, n, |i, j| g.A[(i, j)] * d[i] / d[j]),
        Mat::from_fn(n, 1, |i, _| g.B[(i, 0)] * d[i] * input),
        Mat::from_fn(1, n, |_, j| g.C[(0, j)] / d[j] * output),
    )
}

fn check(g: &StateSpace, order: usize, what: &str) -> MinimalRealisation {
    let found = minimal_realisation(g, 1e-11).unwrap();
    assert_eq!(
        found.system.order(),
        order,
        "{what}: {} {} {g:?}",
        found.smallest_kept,
        found.largest_dropped
    );
    assert_eq!(found.unreachable + found.unobservable + order, g.order(), "{what}");
    for rate in [0.0, 0.7, 3.0, 20.0] {
        let (a, b) =
            (response_at(g, rate).unwrap()[(0, 0)], response_at(&found.system, rate).unwrap()[(0, 0)]);
        assert!((a - b).norm() <= 1e-6 * a.norm(), "{what} {rate}: {a} {b}");
    }
    found
}

#[test]
fn units_over_twelve_decades_change_no_order() {
    let mut random = RandomGenerator::new(7);
    for trial in 0..48 {
        let near = [0.0, 1e-3, 0.3][trial % 3];
        let (mut g, mut order) = modes(&mut random, near);
        if trial % 2 == 1 {
            let (both, more) = with_chain(&g, &mut random);
            (g, order) = (both, order + more);
        }
        check(&g, order, &format!("given {trial}"));
        for decades in [3.0, 12.0] {
            check(&in_other_units(&g, decades, &mut random), order, &format!("units {trial} {decades}"));
        }
        // In rotated coordinates no hidden part is a zero, and rounding decides what is: each stair magnifies it, so that chains are left out.
        if trial % 2 == 1 {
            continue;
        }
        let turned = rotate(&g, &mut random);
        check(&turned, order, &format!("rotated {trial}"));
        check(&in_other_units(&turned, 6.0, &mut random), order, &format!("rotated in units {trial}"));
    }
}

#[test]
fn a_mode_that_rounding_alone_reaches_is_none_in_any_units() {
    let mut random = RandomGenerator::new(11);
    for (b, c) in [(1e-16, 1.0), (1.0, 3e-16), (1e-8, 1e-8), (1e4, 1e-20)] {
        let g = system(Mat::diag(&[-1.0, -2.0]), Mat::col(&[1.0, b]), Mat::row(&[1.0, c]));
        for _ in 0..20 {
            let found = minimal_realisation(&in_other_units(&g, 12.0, &mut random), 1e-11).unwrap();
            assert_eq!(found.system.order(), 1, "{b} {c}");
            assert!(found.warnings.is_empty() && found.largest_dropped > 0.0);
        }
    }
}

#[test]
fn what_little_a_system_passes_is_all_it_passes() {
    // A chain whose couplings are small passes little, and loses nothing.
    let A = Mat::from_rows(&[&[-1.0, 0.0, 0.0], &[1e-9, -2.0, 0.0], &[0.0, 1e-9, -3.0]]);
    check(&system(A, Mat::col(&[1e-6, 0.0, 0.0]), Mat::row(&[0.0, 0.0, 1e-3])), 3, "weak chain");
    for (b, c) in [(1e12, 1e-12), (1e10, 1e-12), (1e-12, 1e12), (1e-150, 1e150)] {
        check(&system(Mat::diag(&[-1.0, -2.0]), Mat::col(&[1.0, b]), Mat::row(&[1.0, c])), 2, "lags");
        let A = Mat::from_rows(&[&[-1.0, c], &[0.0, -2.0]]);
        check(&system(A, Mat::col(&[0.0, b]), Mat::row(&[1.0, 0.0])), 2, "series");
    }
}
