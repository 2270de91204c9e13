//! Random systems, well and badly scaled, stable and not: answers pass their definitions or are refused, nothing panics.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg as linalg;
use counterpoise_linalg::{C64, CMat, Mat};
use counterpoise_lti::{
    Discretisation, StateSpace, Timebase, c2d, ctrb_gramian, feedback, frequency_response, h2norm,
    hankel_values, hinfnorm, is_stable, margins, obsv_gramian, parallel, poles, series, sigma, zeros,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Returns a system of random order, inputs and outputs whose states are scaled by up to 10^+-decades.
fn system(decades: i32, shift: f64) -> impl Strategy<Value = StateSpace> {
    (1_usize..12, 1_usize..4, 1_usize..4).prop_flat_map(move |(n, m, p)| {
        let entries = prop::collection::vec(-1.0_f64..1.0, n * n + n * m + p * n);
        let scales = prop::collection::vec(-decades..=decades, n);
        (entries, scales).prop_map(move |(e, scales)| {
            let T: Vec<f64> = scales.iter().map(|&k| 10.0_f64.powi(k)).collect();
            let A =
                Mat::from_fn(n, n, |i, j| (e[i * n + j] - if i == j { shift } else { 0.0 }) * T[j] / T[i]);
            let B = Mat::from_fn(n, m, |i, j| e[n * n + i * m + j] / T[i]);
            let C = Mat::from_fn(p, n, |i, j| e[n * n + n * m + i * n + j] * T[j]);
            StateSpace::new(A, B, C, Mat::zeros(p, m), Timebase::Continuous).unwrap()
        })
    })
}

/// C inv(s - A) B + D by a dense solve of the balanced system.
fn dense(g: &StateSpace, s: C64) -> CMat {
    let (g, _) = counterpoise_lti::scaling::balance(g);
    let M = CMat::eye(g.order()).scale(s) - g.A.to_complex();
    &(&g.C.to_complex() * &linalg::csolve(&M, &g.B.to_complex()).unwrap()) + &g.D.to_complex()
}

fn square(g: &StateSpace) -> StateSpace {
    g.select(&[0], &[0])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn responses_agree_with_a_dense_solve_whatever_the_units(g in system(8, 0.5), rate in 0.01_f64..50.0) {
        let found = frequency_response(&g, &[rate]).unwrap().remove(0);
        let expected = dense(&g, C64::new(0.0, rate));
        let near = poles(&g).unwrap().iter().map(|p| (p - C64::new(0.0, rate)).norm()).fold(f64::INFINITY, f64::min);
        let size = expected.norm_max() + g.C.norm_max() * g.B.norm_max() * 1e-16;
        prop_assert!((&found - &expected).norm_max() <= 1e-9 * size / near.min(1.0), "{found:?} {expected:?}");
    }

    #[test]
    fn a_zero_stops_its_signal(g in system(0, 0.5)) {
        let g = square(&g);
        for zero in zeros(&g).unwrap() {
            let matrix = Mat::from_blocks(&[&[&g.A, &g.B], &[&g.C, &g.D]]).to_complex();
            let mut shifted = matrix.clone();
            (0..g.order()).for_each(|i| shifted[(i, i)] -= zero);
            let values = linalg::csingular_values(&shifted).unwrap();
            let least = values.last().copied().unwrap();
            prop_assert!(least <= 1e-9 * (1.0 + zero.norm()), "{zero}: {least:e}");
        }
    }

    #[test]
    fn norms_bound_each_other(g in system(3, 4.0)) {
        prop_assume!(is_stable(&g).unwrap());
        let peak = hinfnorm(&g, 1e-8).unwrap();
        let hankel = hankel_values(&g).unwrap();
        prop_assert!(hankel[0] <= peak.value * (1.0 + 1e-6));
        prop_assert!(peak.value <= 2.0 * hankel.iter().sum::<f64>() * (1.0 + 1e-6));
        let rates: Vec<f64> = (0..200).map(|k| 10.0_f64.powf(-3.0 + 0.03 * f64::from(k))).collect();
        let largest = sigma(&g, &rates).unwrap().iter().map(|s| s[0]).fold(0.0, f64::max);
        prop_assert!(largest <= peak.value * (1.0 + 1e-6));
        prop_assert!(h2norm(&g).unwrap().is_finite());
    }

    #[test]
    fn gramians_solve_their_equations(g in system(0, 4.0)) {
        prop_assume!(is_stable(&g).unwrap());
        let (P, Q) = (ctrb_gramian(&g).unwrap(), obsv_gramian(&g).unwrap());
        let reach = &(&(&g.A * &P) + &(&P * &g.A.t())) + &(&g.B * &g.B.t());
        let see = &(&(&g.A.t() * &Q) + &(&Q * &g.A)) + &(&g.C.t() * &g.C);
        prop_assert!(reach.norm_max() <= 1e-11 * (1.0 + P.norm_max()) * (1.0 + g.A.norm_max()));
        prop_assert!(see.norm_max() <= 1e-11 * (1.0 + Q.norm_max()) * (1.0 + g.A.norm_max()));
    }

    #[test]
    fn sampling_maps_the_poles(g in system(4, 0.5), period_s in 0.001_f64..0.5) {
        let sampled = poles(&c2d(&g, period_s, Discretisation::ZeroOrderHold).unwrap()).unwrap();
        for pole in poles(&g).unwrap() {
            let image = (pole * period_s).exp();
            let distance = sampled.iter().map(|z| (z - image).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(distance <= 1e-6 * (1.0 + image.norm()), "{pole}: {distance:e}");
        }
    }

    #[test]
    fn margins_lie_where_the_closed_loop_meets_the_axis(g in system(0, 1.5), gain in 0.1_f64..20.0) {
        let g = square(&g).scale_io(&[gain], &[1.0]).unwrap();
        let found = margins(&g).unwrap();
        for margin in found.gain.iter().filter(|margin| margin.factor < 1e6 && margin.rate_rad_s.is_finite()) {
            let at_margin = StateSpace::gain(Mat::row(&[margin.factor]), Timebase::Continuous).unwrap();
            let closed = poles(&feedback(&g, &at_margin).unwrap()).unwrap();
            let target = C64::new(0.0, margin.rate_rad_s);
            let distance = closed.iter().map(|p| (p - target).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(distance <= 1e-5 * (1.0 + target.norm()), "{margin:?}: {distance:e}");
        }
    }

    #[test]
    fn crossings_are_as_many_as_brute_force_counts(g in system(0, 1.2), gain in 0.1_f64..20.0) {
        let g = square(&g).scale_io(&[gain], &[1.0]).unwrap();
        let rates: Vec<f64> = (0..6000).map(|k| 10.0_f64.powf(-4.0 + 8.0 * f64::from(k) / 5999.0)).collect();
        let values = frequency_response(&g, &rates).unwrap();
        let above = |k: usize| values[k][(0, 0)].norm() > 1.0;
        let count = (1..rates.len()).filter(|&k| above(k) != above(k - 1)).count();
        let within = |rate: f64| rate > rates[0] && rate < rates[5999];
        let found = margins(&g).unwrap();
        prop_assert!(found.phase.iter().filter(|margin| within(margin.rate_rad_s)).count() >= count);
    }

    #[test]
    fn connections_obey_their_algebra(g in system(2, 0.5), rate in 0.01_f64..10.0) {
        let (g, h) = (square(&g), square(&g).scale_io(&[2.0], &[1.0]).unwrap());
        let s = C64::new(0.0, rate);
        let (a, b) = (dense(&g, s)[(0, 0)], dense(&h, s)[(0, 0)]);
        let at = |x: &StateSpace| frequency_response(x, &[rate]).unwrap()[0][(0, 0)];
        let close = |x: C64, y: C64, size: f64| (x - y).norm() <= 1e-7 * (size + y.norm());
        prop_assert!(close(at(&series(&g, &h).unwrap()), a * b, (a * b).norm()));
        prop_assert!(close(at(&parallel(&g, &h).unwrap()), a + b, a.norm()));
        let closed = a / (1.0 + a * b);
        prop_assume!((1.0 + a * b).norm() > 1e-3);
        prop_assert!(close(at(&feedback(&g, &h).unwrap()), closed, closed.norm()));
    }
}
