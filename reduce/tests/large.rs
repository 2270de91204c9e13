//! Balanced truncation of structures with sparse matrices beside that of the same structures with dense ones.
#![allow(non_snake_case, clippy::unwrap_used)]

use std::ops::ControlFlow;

use counterpoise_linalg as linalg;
use counterpoise_linalg::{
    Mat, Sparse,
    sparse::{Entry, StageProgress},
};
use counterpoise_lti::{StateSpace, Timebase, response_at};
use counterpoise_reduce::{
    Error, LargeReduction, LargeStructure, Method, Order, Warning, balred, balred_large, error_at,
};

/// The origin of a chain's damping.
#[derive(Clone, Copy)]
enum Damping {
    /// alpha M + beta K.
    Proportional { of_mass: f64, of_stiffness: f64 },
    /// Proportional, and a dashpot between each hundredth mass and the ground.
    Dashpots { of_stiffness: f64, each: f64 },
}

/// Returns a chain of masses, with cross links, held at one end; two inputs, three outputs (one of a
/// velocity).
fn chain(n: usize, seed: u64, damping: Damping) -> LargeStructure {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut stiffness = vec![Entry { row: 0, col: 0, value: 4000.0 }];
    let mut spring = |i: usize, j: usize, k: f64| {
        for (row, col, value) in [(i, i, k), (j, j, k), (i, j, -k), (j, i, -k)] {
            stiffness.push(Entry { row, col, value });
        }
    };
    for i in 1..n {
        spring(i - 1, i, 1000.0 * (0.5 + random()));
        if i > 7 && i % 5 == 0 {
            spring(i - 7, i, 300.0 * random());
        }
    }
    let masses: Vec<f64> = (0..n).map(|_| 0.5 + random()).collect();
    let M = Sparse::from_dense(&Mat::diag(&masses));
    let K = Sparse::from_entries(n, n, &stiffness).unwrap();
    let scaled = |A: &Sparse, by: f64| A.map(|_, _, value| by * value);
    let C = match damping {
        Damping::Proportional { of_mass, of_stiffness } => {
            let more: Vec<Entry> = scaled(&M, of_mass).entries().collect();
            scaled(&K, of_stiffness).plus(&more).unwrap()
        }
        Damping::Dashpots { of_stiffness, each } => {
            let more: Vec<Entry> =
                (0..n).step_by(10).map(|i| Entry { row: i, col: i, value: each }).collect();
            scaled(&K, of_stiffness).plus(&more).unwrap()
        }
    };
    let unit = |i: usize, at: usize| if i == at { 1.0 } else { 0.0 };
    let F = Mat::from_fn(n, 2, |i, j| unit(i, [n - 1, n / 3][j]));
    let P = Mat::from_fn(3, n, |i, j| unit(j, [n - 1, n / 2, n][i]));
    let V = Mat::from_fn(3, n, |i, j| unit(j, [n, n, n / 4][i]));
    LargeStructure { M, C, K, F, P, V }
}

/// Returns the same structure in first-order form.
fn dense(g: &LargeStructure) -> StateSpace {
    let n = g.M.nrows();
    let by_mass = |A: &Mat| linalg::solve(&g.M.to_dense(), A).unwrap();
    let (K, C, F) = (by_mass(&g.K.to_dense()), by_mass(&g.C.to_dense()), by_mass(&g.F));
    let A = Mat::zeros(n, n).hstack(&Mat::eye(n)).vstack(&(-&K).hstack(&-&C));
    let B = Mat::zeros(n, g.F.ncols()).vstack(&F);
    StateSpace::new(A, B, g.P.hstack(&g.V), Mat::zeros(g.P.nrows(), g.F.ncols()), Timebase::Continuous)
        .unwrap()
}

fn reduce_structure(g: &LargeStructure, order: Order) -> LargeReduction {
    balred_large(g, order, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn hankel_values_are_those_of_the_dense_balancing() {
    let light = Damping::Proportional { of_mass: 0.02, of_stiffness: 2e-4 };
    let uneven = Damping::Dashpots { of_stiffness: 1e-4, each: 0.4 };
    // Dashpots so strong that the masses there creep.
    let creeping = Damping::Dashpots { of_stiffness: 2e-3, each: 400.0 };
    for (damping, seed) in [(light, 1), (uneven, 2), (creeping, 3), (light, 4)] {
        let g = chain(60, seed, damping);
        let ours = reduce_structure(&g, Order::States(12));
        let theirs = balred(&dense(&g), Order::States(12), Method::SquareRoot).unwrap();
        let is_unfinished = |warning: &Warning| matches!(warning, Warning::GramiansUnfinished { .. });
        assert!(!ours.warnings.iter().any(is_unfinished), "{:?}", ours.warnings);
        for (k, (a, b)) in ours.hankel.iter().zip(&theirs.hankel).enumerate() {
            assert!((a - b).abs() < 1e-8 * theirs.hankel[0], "seed {seed}, value {k}: {a} {b}");
        }
        assert!((ours.estimated_bound / theirs.bound.unwrap() - 1.0).abs() < 1e-5);
        for rate in [0.1, 1.0, 5.0, 20.0, 60.0] {
            let whole = response_at(&dense(&g), rate).unwrap();
            let small = response_at(&ours.system, rate).unwrap();
            let error = (&whole - &small).norm_fro();
            assert!(error <= ours.estimated_bound * 1.5, "{error} {}", ours.estimated_bound);
            let direct = error_at(&g, &ours.system, rate).unwrap();
            assert!(direct <= error * (1.0 + 1e-6) + 1e-12 && direct > 0.5 * error - 1e-12);
        }
    }
}

#[test]
fn an_order_follows_from_an_error() {
    let g = chain(150, 7, Damping::Proportional { of_mass: 0.05, of_stiffness: 1e-3 });
    let ours = reduce_structure(&g, Order::Error { largest: 1e-4 });
    assert!(ours.estimated_bound <= 1e-4 && ours.kept < 150);
    let worst =
        (0..40).map(|k| error_at(&g, &ours.system, 0.05 * 1.25_f64.powi(k)).unwrap()).fold(0.0, f64::max);
    assert!(worst <= 1e-4, "{worst}");
}

#[test]
fn structures_without_a_balance_are_refused() {
    let quiet = &mut |_: StageProgress| ControlFlow::Continue(());
    let damping = Damping::Proportional { of_mass: 0.02, of_stiffness: 2e-4 };
    let mut undamped = chain(40, 1, damping);
    undamped.C = undamped.C.map(|_, _, _| 0.0);
    let answer = balred_large(&undamped, Order::States(4), quiet);
    assert!(matches!(answer, Err(Error::Matrix { .. })), "{answer:?}");
    let mut free = chain(40, 1, damping);
    let held = free.K.at(0, 0) - 4000.0;
    free.K = free.K.map(|i, j, value| if (i, j) == (0, 0) { held } else { value });
    let answer = balred_large(&free, Order::States(4), quiet);
    assert!(answer.is_err(), "{answer:?}");
    let mut wrong = chain(40, 1, damping);
    wrong.P = Mat::zeros(3, 39);
    assert!(balred_large(&wrong, Order::States(4), quiet).is_err());
    let stop = &mut |_: StageProgress| ControlFlow::Break(());
    assert!(balred_large(&chain(40, 1, damping), Order::States(4), stop).is_err());
    let empty = LargeStructure {
        M: Sparse::from_dense(&Mat::zeros(0, 0)),
        C: Sparse::from_dense(&Mat::zeros(0, 0)),
        K: Sparse::from_dense(&Mat::zeros(0, 0)),
        F: Mat::zeros(0, 1),
        P: Mat::zeros(1, 0),
        V: Mat::zeros(1, 0),
    };
    let _ = balred_large(&empty, Order::States(4), quiet);
    let mut silent = chain(40, 1, damping);
    silent.F = Mat::zeros(40, 2);
    assert_eq!(reduce_structure(&silent, Order::States(4)).kept, 0);
}

#[test]
fn odd_structures_are_answered_without_a_panic() {
    let quiet = &mut |_: StageProgress| ControlFlow::Continue(());
    let damping = Damping::Proportional { of_mass: 0.02, of_stiffness: 2e-4 };
    for n in [1, 2, 3, 9] {
        for factor in [0.0, -1.0, 1e-300, 1e300, 5e-324, f64::NAN, f64::INFINITY] {
            for which in 0..4 {
                let mut g = chain(n.max(2), 1, damping);
                let scaled = |A: &Sparse| A.map(|_, _, value| factor * value);
                match which {
                    0 => g.M = scaled(&g.M),
                    1 => g.C = scaled(&g.C),
                    2 => g.K = scaled(&g.K),
                    _ => g.F = g.F.scale(factor),
                }
                if let Ok(found) = balred_large(&g, Order::States(n), quiet) {
                    assert!(found.system.A.is_finite(), "n = {n}, {factor}, {which}");
                }
            }
        }
    }
    let mut skew = chain(20, 1, damping);
    skew.C = skew.C.map(|i, j, value| if i < j { value + 1.0 } else { value });
    assert!(balred_large(&skew, Order::States(4), quiet).is_err());
    let mut massless = chain(20, 1, damping);
    massless.M = massless.M.map(|i, _, value| if i == 3 { 0.0 } else { value });
    assert!(matches!(balred_large(&massless, Order::States(4), quiet), Err(Error::Range { .. })));
    let mut half = chain(20, 1, damping);
    let lower: Vec<Entry> = half.K.entries().filter(|e| e.row >= e.col).collect();
    half.K = Sparse::from_entries(20, 20, &lower).unwrap();
    assert!(balred_large(&half, Order::States(4), quiet).is_err());
    // A place that is stored on one side of the diagonal alone, with the value zero.
    let mut lopsided = chain(20, 1, damping);
    lopsided.K = lopsided.K.plus(&[Entry { row: 17, col: 2, value: 0.0 }]).unwrap();
    let plain = chain(20, 1, damping);
    let (a, b) = (reduce_structure(&lopsided, Order::States(4)), reduce_structure(&plain, Order::States(4)));
    assert!((a.hankel[0] / b.hankel[0] - 1.0).abs() < 1e-9);
}
