//! Odd systems and structures never make a reduction panic: without states, inputs or outputs, of any scale, of shapes that do not fit,
//! and with entries that are not finite.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use std::ops::ControlFlow;

use crate::odd::{Call, assert_none_panics, judge, next_uniform, odd_matrix, panicking, size};

use counterpoise_linalg::{C64, Mat, sparse::Sparse};
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_reduce::*;

fn timebase(state: &mut u64) -> Timebase {
    if size(state, 2.0) == 0 { Timebase::Continuous } else { Timebase::Discrete { period_s: 0.1 } }
}

fn system(state: &mut u64) -> StateSpace {
    let (n, m, p) = (size(state, 6.0), size(state, 3.0), size(state, 3.0));
    let mut A = odd_matrix(state, n, n);
    if next_uniform(state) < 0.7 {
        A = A - Mat::eye(n).scale(2.0);
    }
    let mut g = StateSpace::new(
        A,
        odd_matrix(state, n, m),
        odd_matrix(state, p, n),
        odd_matrix(state, p, m),
        timebase(state),
    )
    .unwrap();
    // The matrices are public: a caller may write what the constructor refuses.
    if n * m > 0 && next_uniform(state) < 0.1 {
        g.B[(n - 1, 0)] = if next_uniform(state) < 0.5 { f64::NAN } else { f64::INFINITY };
    }
    g
}

fn structure(state: &mut u64) -> SecondOrder {
    let (n, m, p) = (size(state, 5.0), size(state, 3.0), size(state, 3.0));
    let mut square = |shift: f64| {
        let S = odd_matrix(state, n, n);
        (&S * &S.t()) + Mat::eye(n).scale(shift)
    };
    let (M, C, K) = (square(1.0), square(0.0), square(0.1));
    let more = usize::from(next_uniform(state) < 0.2);
    SecondOrder {
        M,
        C,
        K,
        F: odd_matrix(state, n + more, m),
        P: odd_matrix(state, p, n),
        V: odd_matrix(state, p, n),
    }
}

fn large(s: &SecondOrder) -> LargeStructure {
    let sparse = |A: &Mat| Sparse::from_dense(A);
    let (F, P, V) = (s.F.clone(), s.P.clone(), s.V.clone());
    LargeStructure { M: sparse(&s.M), C: sparse(&s.C), K: sparse(&s.K), F, P, V }
}

fn order(state: &mut u64) -> Order {
    let list = [0.0, -1.0, 0.5, 1e-9, f64::NAN, f64::INFINITY];
    let value = list[size(state, 6.0)];
    match size(state, 3.0) {
        0 => Order::States(size(state, 8.0)),
        1 => Order::Error { largest: value },
        _ => Order::Relative { share: value },
    }
}

fn method(state: &mut u64) -> Method {
    [Method::SquareRoot, Method::BalancingFree, Method::MatchDc][size(state, 3.0)]
}

/// Calls every routine; the names of those that panic.
fn call_all(seed: u64) -> Vec<&'static str> {
    let mut state = seed;
    let (g, h, w) = (system(&mut state), system(&mut state), system(&mut state));
    let (s, order, method) = (structure(&mut state), order(&mut state), method(&mut state));
    let big = large(&s);
    let count = size(&mut state, 6.0);
    let tolerance = [0.0, 1e-11, f64::NAN, 2.0][size(&mut state, 4.0)];
    let go_on = || |_| ControlFlow::Continue(());
    let calls: Vec<Call> = vec![
        ("balred", Box::new(|| judge(balred(&g, order, method)))),
        ("Balanced", Box::new(|| judge(BalancedSystem::of(&g).map(|b| b.reduce(count, method))))),
        ("from_factors", Box::new(|| judge(BalancedSystem::from_factors(g.clone(), h.B.clone(), h.C.t())))),
        ("minimal", Box::new(|| judge(minimal_realisation(&g, tolerance)))),
        ("split", Box::new(|| judge(split_stable(&g).map(|parts| parts.sum())))),
        ("split_by", Box::new(|| judge(split_by(&g, |pole: C64| pole.im > 0.0)))),
        ("modal_truncation", Box::new(|| judge(modal_truncation(&g, tolerance, Residual::MatchDc)))),
        ("error_norm", Box::new(|| judge(error_norm(&g, &h)))),
        (
            "weighted_balred",
            Box::new(|| judge(weighted_balred(&g, Weights { output: &h, input: &w }, order, method))),
        ),
        ("reduce_controller", Box::new(|| judge(reduce_controller(&g, &h, order, method)))),
        ("guyan", Box::new(|| judge(guyan(&s, &[0, count])))),
        ("modal_basis", Box::new(|| judge(modal_basis(&s, count)))),
        ("to_state_space", Box::new(|| judge(s.to_state_space()))),
        ("balred_large", Box::new(|| judge(balred_large(&big, order, &mut go_on())))),
        ("error_at", Box::new(|| judge(error_at(&big, &g, tolerance)))),
    ];
    panicking(&calls)
}

#[test]
fn no_odd_reduction_panics() {
    assert_none_panics(600, &call_all);
}
