//! Random systems, in states scaled by up to sixteen decades: bounds hold, what must stay stays, orders are found, loops are
//! kept or said to be lost; nothing panics.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{
    StateSpace, Timebase, append, feedback, hankel_values, hinfnorm, is_stable, parallel, poles, response_at,
    series,
};
use counterpoise_reduce::{Method, Order, Warning, balred, minimal_realisation, reduce_controller};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Entries of A, B and C and the decades of the states' units.
type Numbers = (usize, Vec<f64>, Vec<i32>);

fn numbers(order: std::ops::Range<usize>, decades: i32) -> impl Strategy<Value = Numbers> {
    order.prop_flat_map(move |n| {
        let entries = prop::collection::vec(-1.0_f64..1.0, n * n + 4 * n);
        (Just(n), entries, prop::collection::vec(-decades..=decades, n))
    })
}

/// Returns a stable system, two inputs and two outputs: the symmetric part of A is negative.
fn stable((n, e, _): &Numbers) -> StateSpace {
    let n = *n;
    let M = Mat::from_fn(n, n, |i, j| e[i * n + j]);
    let A = (&M - &M.t()).scale(3.0) - &M * M.t() - Mat::eye(n).scale(0.05);
    let B = Mat::from_fn(n, 2, |i, j| e[n * n + 2 * i + j]);
    let C = Mat::from_fn(2, n, |i, j| e[n * n + 2 * n + 2 * j + i]);
    StateSpace::new(A, B, C, Mat::zeros(2, 2), Timebase::Continuous).unwrap()
}

/// Returns the same system in other units.
fn in_units(g: &StateSpace, (_, _, decades): &Numbers) -> StateSpace {
    g.scale_states(&decades.iter().map(|&k| 10.0_f64.powi(k)).collect::<Vec<f64>>())
}

fn first_channel(g: &StateSpace) -> StateSpace {
    g.select(&[0], &[0])
}

fn lag(pole: f64) -> StateSpace {
    let one = |x: f64| Mat::diag(&[x]);
    StateSpace::new(one(pole), one(1.0), one(1.0), one(0.0), Timebase::Continuous).unwrap()
}

/// Returns the largest difference of two responses at a few frequencies.
fn largest_difference(g: &StateSpace, h: &StateSpace) -> f64 {
    let rates = [0.01, 0.3, 1.0, 4.0, 30.0];
    let at = |rate: &f64| (response_at(g, *rate).unwrap() - response_at(h, *rate).unwrap()).norm_max();
    rates.iter().map(at).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn the_error_stays_within_the_bound_whatever_the_units(e in numbers(3..11, 8), share in 0.1_f64..0.9) {
        let plain = stable(&e);
        let g = in_units(&plain, &e);
        let hankel = hankel_values(&plain).unwrap();
        let r = 1 + (share * (g.order() - 1) as f64) as usize;
        for method in [Method::SquareRoot, Method::BalancingFree, Method::MatchDc] {
            let reduced = balred(&g, Order::States(r), method).unwrap();
            let rounding = 1e-10 * hankel[0];
            for (a, b) in reduced.hankel.iter().zip(&hankel) {
                prop_assert!((a - b).abs() < rounding, "{a:e} {b:e}");
            }
            let bound = reduced.bound.unwrap();
            prop_assert!(reduced.measured_error.value <= bound * (1.0 + 1e-6) + rounding, "{reduced:?}");
            let error = hinfnorm(&parallel(&g, &reduced.system.negate()).unwrap(), 1e-6).unwrap().value;
            prop_assert!(error <= bound * (1.0 + 1e-6) + rounding, "{error:e} {bound:e}");
            prop_assert!(is_stable(&reduced.system).unwrap());
        }
    }

    #[test]
    fn integrators_and_unstable_poles_stay_where_they_are(e in numbers(3..9, 6), pole in 0.05_f64..3.0) {
        let all = parallel(&first_channel(&stable(&e)), &parallel(&lag(0.0), &lag(pole)).unwrap()).unwrap();
        let mut scale: Vec<f64> = e.2.iter().map(|&k| 10.0_f64.powi(k)).collect();
        scale.extend([1e5, 1e-4]);
        let g = all.scale_states(&scale);
        let reduced = balred(&g, Order::States(4), Method::SquareRoot).unwrap();
        let kept = poles(&reduced.system).unwrap();
        prop_assert_eq!(reduced.untouched, 2);
        for wanted in [0.0, pole] {
            let distance = kept.iter().map(|p| (p - wanted).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(distance < 1e-9, "{} {:?}", wanted, kept);
        }
        let largest = reduced.hankel[0];
        prop_assert!(reduced.measured_error.value <= reduced.bound.unwrap() * (1.0 + 1e-6) + 1e-9 * largest);
    }

    #[test]
    fn a_state_that_is_hardly_reached_costs_no_digits(e in numbers(3..8, 0), reach in -15_i32..-5) {
        let mut hidden = lag(-0.7);
        hidden.B = hidden.B.scale(10.0_f64.powi(reach));
        let g = parallel(&first_channel(&stable(&e)), &hidden).unwrap();
        let all = g.order();
        for method in [Method::SquareRoot, Method::BalancingFree] {
            let reduced = balred(&g, Order::States(all), method).unwrap();
            let fewer = reduced.warnings.iter().any(|w| matches!(w, Warning::FewerThanAsked { .. }));
            prop_assert!(fewer || reduced.kept == all, "{:?}", reduced.warnings);
            prop_assert!(largest_difference(&g, &reduced.system) < 1e-8 * reduced.hankel[0], "{:?}", reduced.warnings);
        }
    }

    #[test]
    fn a_realisation_loses_what_is_not_reached_or_not_seen_and_nothing_else(e in numbers(2..7, 0), h in numbers(1..4, 0)) {
        let (g, other) = (stable(&e), stable(&h));
        // The other system twice: not driven, and not seen.
        let (mut undriven, mut unseen) = (other.clone(), other);
        undriven.B = Mat::zeros(undriven.order(), 2);
        unseen.C = Mat::zeros(2, unseen.order());
        let both = parallel(&g, &parallel(&undriven, &unseen).unwrap()).unwrap();
        let found = minimal_realisation(&both, 1e-11).unwrap();
        let clear = found.warnings.is_empty();
        prop_assert!(!clear || found.system.order() == g.order(), "{found:?}");
        prop_assert!(largest_difference(&g, &found.system) < 1e-8 * (1.0 + g.B.norm_fro() * g.C.norm_fro()));
    }

    #[test]
    fn a_reduced_controller_keeps_its_loop_or_says_that_it_does_not(e in numbers(3..6, 0), k in numbers(5..9, 0), r in 2_usize..5) {
        let (g, controller) = (first_channel(&stable(&e)), first_channel(&stable(&k)));
        let unit = StateSpace::gain(Mat::eye(1), Timebase::Continuous).unwrap();
        let gain = 0.5 / (hinfnorm(&g, 1e-4).unwrap().value * hinfnorm(&controller, 1e-4).unwrap().value);
        // A loop gain of a half: the loop is stable.
        let mut K = controller;
        K.C = K.C.scale(gain);
        let loop_of = |K: &StateSpace| feedback(&series(K, &g).unwrap(), &unit).unwrap();
        let found = reduce_controller(&g, &K, Order::States(r), Method::SquareRoot).unwrap();
        let stays = is_stable(&loop_of(&found.reduction.system)).unwrap();
        prop_assert_eq!(stays, found.closed_loop_stable);
        if stays {
            let error = hinfnorm(&parallel(&loop_of(&K), &loop_of(&found.reduction.system).negate()).unwrap(), 1e-5).unwrap().value;
            prop_assert!((error - found.closed_loop_error.value).abs() <= 1e-3 * error + 1e-9, "{error:e} {found:?}");
        } else {
            let said = found.reduction.warnings.iter().any(|w| matches!(w, Warning::LoopUnstable { .. }));
            prop_assert!(said, "{found:?}");
        }
        let whole = reduce_controller(&g, &K, Order::States(K.order()), Method::BalancingFree).unwrap();
        prop_assert!(whole.closed_loop_stable && whole.closed_loop_error.value < 1e-7, "{whole:?}");
    }

    #[test]
    fn independent_systems_have_the_values_of_both(e in numbers(2..6, 4), h in numbers(2..6, 4)) {
        let (g, other) = (in_units(&stable(&e), &e), in_units(&stable(&h), &h));
        let mut expected = [hankel_values(&g).unwrap(), hankel_values(&other).unwrap()].concat();
        expected.sort_by(|a, b| b.total_cmp(a));
        let found = hankel_values(&append(&g, &other).unwrap()).unwrap();
        for (a, b) in found.iter().zip(&expected) {
            prop_assert!((a - b).abs() < 1e-11 * expected[0], "{a:e} {b:e}");
        }
    }
}

#[test]
fn the_worst_units_change_nothing() {
    let chain = |scale: f64| {
        let pole = C64::new(-0.2, 5.0);
        let A = Mat::from_rows(&[&[pole.re, pole.im * scale], &[-pole.im / scale, pole.re]]);
        let (B, C) = (Mat::col(&[0.0, 1.0 / scale]), Mat::row(&[1.0, 0.0]));
        StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap()
    };
    let plain = hankel_values(&chain(1.0)).unwrap();
    for scale in [1e-8, 1e-4, 1e4, 1e8] {
        let found = hankel_values(&chain(scale)).unwrap();
        assert!(
            found.iter().zip(&plain).all(|(a, b)| (a / b - 1.0).abs() < 1e-12),
            "{scale:e}: {found:?} {plain:?}"
        );
    }
}
