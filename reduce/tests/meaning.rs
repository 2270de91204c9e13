//! The promises of each reduction: what is kept is kept, bounds hold, known orders are found, structures keep their modes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{
    Discretisation, StateSpace, Timebase, Zpk, c2d, dcgain, feedback, frequency_response, is_stable,
    parallel, poles, response_at, series,
};
use counterpoise_reduce::{
    BalancedSystem, Error, Method, Order, Residual, SecondOrder, Warning, balred, guyan, minimal_realisation,
    modal_basis, modal_truncation, reduce_controller, split_stable,
};

fn zpk(zeros: &[C64], poles: &[C64], gain: f64) -> StateSpace {
    let timebase = Timebase::Continuous;
    Zpk { zeros: zeros.to_vec(), poles: poles.to_vec(), gain, timebase }.to_state_space().unwrap()
}

fn re(x: f64) -> C64 {
    C64::new(x, 0.0)
}

/// Returns an integrator, an unstable pole, and eight lightly damped modes of falling size.
fn servo() -> StateSpace {
    let mut g = zpk(&[], &[re(0.0), re(0.7)], 3.0);
    for k in 1..=8 {
        let pole = C64::new(-0.03, 1.0) * 9.0 * f64::from(k);
        g = parallel(&g, &zpk(&[], &[pole, pole.conj()], 40.0 / f64::from(k * k))).unwrap();
    }
    g
}

#[test]
fn integrators_and_unstable_poles_are_kept_exactly() {
    let g = servo();
    for method in [Method::SquareRoot, Method::BalancingFree, Method::MatchDc] {
        let reduced = balred(&g, Order::States(8), method).unwrap();
        assert_eq!((reduced.untouched, reduced.kept, reduced.system.order()), (2, 6, 8));
        let kept = poles(&reduced.system).unwrap();
        assert!(kept.contains(&re(0.0)), "{kept:?}");
        assert!(kept.iter().any(|p| (p - 0.7).norm() < 1e-12));
        assert!(reduced.measured_error.value <= reduced.bound.unwrap() * (1.0 + 1e-6));
    }
    assert!(balred(&g, Order::States(1), Method::SquareRoot).is_err());
}

#[test]
fn the_order_can_be_asked_for_by_its_error() {
    let g = servo();
    let largest = 0.02;
    let reduced = balred(&g, Order::Error { largest }, Method::SquareRoot).unwrap();
    assert!(reduced.bound.unwrap() <= largest && reduced.measured_error.value <= largest);
    let fewer = balred(&g, Order::States(reduced.system.order() - 1), Method::SquareRoot).unwrap();
    assert!(fewer.bound.unwrap() > largest);
}

#[test]
fn both_projections_have_one_response_and_dc_matching_keeps_the_static_gain() {
    let g = split_stable(&servo()).unwrap().first;
    let make = |method| balred(&g, Order::States(7), method).unwrap();
    let (a, b, c) = (make(Method::SquareRoot), make(Method::BalancingFree), make(Method::MatchDc));
    for rate in [0.0, 5.0, 9.0, 40.0] {
        let (x, y) =
            (response_at(&a.system, rate).unwrap()[(0, 0)], response_at(&b.system, rate).unwrap()[(0, 0)]);
        assert!((x - y).norm() < 1e-11 * x.norm());
    }
    let (exact, kept) = (dcgain(&g).unwrap()[(0, 0)], dcgain(&c.system).unwrap()[(0, 0)]);
    assert!((kept / exact - 1.0).abs() < 1e-11);
    assert!(a.warnings.iter().any(|w| matches!(w, Warning::CutsPair { .. })), "{:?}", a.warnings);
}

#[test]
fn sampled_systems_are_reduced_likewise() {
    let g = c2d(&servo(), 0.01, Discretisation::Tustin { prewarp_rad_s: None }).unwrap();
    for method in [Method::SquareRoot, Method::MatchDc] {
        let reduced = balred(&g, Order::States(8), method).unwrap();
        assert_eq!(reduced.untouched, 2);
        assert!(reduced.measured_error.value <= reduced.bound.unwrap() * (1.0 + 1e-6));
    }
}

#[test]
fn the_parts_of_a_split_add_up() {
    let g = servo();
    let parts = split_stable(&g).unwrap();
    assert!(is_stable(&parts.first).unwrap() && parts.second.order() == 2);
    for rate in [0.3, 9.0, 71.0] {
        let (x, y) = (
            response_at(&g, rate).unwrap()[(0, 0)],
            response_at(&parts.sum().unwrap(), rate).unwrap()[(0, 0)],
        );
        assert!((x - y).norm() < 1e-12 * x.norm());
    }
}

#[test]
fn a_controller_is_reduced_so_that_its_loop_stays() {
    // A PI controller with a lead, two notches and fast roll-off, round a plant with two modes.
    let pole = C64::new(-0.6, 30.0);
    let g = series(&zpk(&[], &[re(-2.0), pole, pole.conj()], 2.0 * 900.0), &zpk(&[], &[re(-40.0)], 40.0))
        .unwrap();
    let (notch, filter) = (C64::new(-0.6, 30.0), C64::new(-20.0, 25.0));
    let (second, wide) = (C64::new(-3.0, 200.0), C64::new(-150.0, 150.0));
    let zeros = [re(-2.0), notch, notch.conj(), second, second.conj()];
    let all = [re(0.0), filter, filter.conj(), wide, wide.conj(), re(-900.0), re(-1500.0)];
    let K = zpk(&zeros, &all, 2.0 * 900.0 * 1500.0);
    let unit = StateSpace::gain(Mat::eye(1), Timebase::Continuous).unwrap();
    assert!(is_stable(&feedback(&series(&K, &g).unwrap(), &unit).unwrap()).unwrap());
    let found = reduce_controller(&g, &K, Order::States(4), Method::SquareRoot).unwrap();
    assert!(found.closed_loop_stable, "{found:?}");
    assert!(found.closed_loop_error.value < 0.02, "{:?}", found.closed_loop_error);
    assert!(poles(&found.reduction.system).unwrap().contains(&re(0.0)));
    let plain = balred(&K, Order::States(4), Method::SquareRoot).unwrap();
    let before = feedback(&series(&K, &g).unwrap(), &unit).unwrap();
    let after = feedback(&series(&plain.system, &g).unwrap(), &unit).unwrap();
    let rates: Vec<f64> = (0..300).map(|k| 10.0_f64.powf(-1.0 + f64::from(k) * 0.015)).collect();
    let (x, y) = (frequency_response(&before, &rates).unwrap(), frequency_response(&after, &rates).unwrap());
    let unweighted = x.iter().zip(&y).map(|(a, b)| (a[(0, 0)] - b[(0, 0)]).norm()).fold(0.0, f64::max);
    assert!(found.closed_loop_error.value < unweighted, "weights must help: {unweighted}");
}

#[test]
fn a_minimal_realisation_has_the_known_order_and_shows_its_gap() {
    let g = servo();
    // g - g + h: twice 18 states that cancel and two that stay; and a hidden block in series.
    let h = zpk(&[re(-3.0)], &[re(-1.0), re(-2.0)], 1.0);
    let twice = parallel(&h, &parallel(&h, &h).unwrap()).unwrap();
    let found = minimal_realisation(&twice, 1e-11).unwrap();
    assert_eq!((found.system.order(), found.unreachable), (2, 4));
    assert!(found.smallest_kept > 1e6 * found.largest_dropped && found.warnings.is_empty());
    let cancelled = series(&zpk(&[re(-5.0)], &[re(-1.0)], 1.0), &zpk(&[], &[re(-5.0)], 2.0)).unwrap();
    let found = minimal_realisation(&cancelled, 1e-11).unwrap();
    assert_eq!(found.system.order(), 1);
    let (a, b) =
        (response_at(&cancelled, 0.8).unwrap()[(0, 0)], response_at(&found.system, 0.8).unwrap()[(0, 0)]);
    assert!((a - b).norm() < 1e-14);
    assert_eq!(minimal_realisation(&g, 1e-11).unwrap().system.order(), g.order());
}

#[test]
fn more_states_than_rounding_leaves_are_refused_with_the_number_there_is() {
    // 1/(s + 1) twice in parallel: two states, one of them never reached.
    let lag = zpk(&[], &[re(-1.0)], 1.0);
    let balanced = BalancedSystem::of(&parallel(&lag, &lag).unwrap()).unwrap();
    assert_eq!(balanced.numerical_order(), 1);
    for method in [Method::SquareRoot, Method::BalancingFree, Method::MatchDc] {
        assert!(dcgain(&balanced.reduce(1, method).unwrap()).is_ok());
        assert_eq!(balanced.reduce(2, method).unwrap_err(), Error::Rounding { wanted: 2, largest: 1 });
        assert!(balanced.reduce(99, method).is_err());
    }
}

#[test]
fn an_order_in_doubt_is_said_to_be_in_doubt() {
    // A pole beside a zero: with 1e-9 between them the cut is clear, with 5e-3 a coarse tolerance cuts in a small gap.
    let near = |distance: f64| zpk(&[re(-5.0)], &[re(-1.0), re(-5.0 - distance)], 2.0);
    let clear = minimal_realisation(&near(1e-9), 1e-7).unwrap();
    assert!(clear.system.order() == 1 && clear.warnings.is_empty(), "{clear:?}");
    let doubtful = minimal_realisation(&near(5e-3), 1e-2).unwrap();
    assert_eq!(doubtful.system.order(), 1);
    assert!(matches!(doubtful.warnings[..], [Warning::SmallGap { .. }]), "{doubtful:?}");
    assert_eq!(minimal_realisation(&near(5e-3), 1e-7).unwrap().system.order(), 2);
}

#[test]
fn slow_modes_stay_and_the_gain_of_the_fast_ones_can_be_kept() {
    let g = servo();
    let dropped = modal_truncation(&g, 40.0, Residual::Drop).unwrap();
    assert_eq!(dropped.system.order(), 2 + 8);
    assert!(dropped.measured_error.value <= dropped.bound.unwrap() * (1.0 + 1e-6));
    let matched = modal_truncation(&g, 40.0, Residual::MatchDc).unwrap();
    let slow = 0.01;
    let error = |h: &StateSpace| {
        (response_at(&g, slow).unwrap()[(0, 0)] - response_at(h, slow).unwrap()[(0, 0)]).norm()
    };
    assert!(error(&matched.system) < 1e-3 * error(&dropped.system));
}

/// Returns a chain of n masses between springs, fixed at one end.
fn chain(n: usize) -> SecondOrder {
    let K = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 if i + 1 == n => 1e5,
        0 => 2e5,
        1 => -1e5,
        _ => 0.0,
    });
    let (mut F, mut P) = (Mat::zeros(n, 1), Mat::zeros(1, n));
    F[(0, 0)] = 1.0;
    P[(0, n - 1)] = 1.0;
    SecondOrder { M: Mat::eye(n).scale(0.1), C: K.scale(1e-5), K, F, P, V: Mat::zeros(1, n) }
}

#[test]
fn condensation_keeps_statics_and_bounds_frequencies_from_above() {
    let full = chain(24);
    let masters = [2, 5, 8, 11, 14, 17, 20, 23];
    let found = guyan(&full, &masters).unwrap();
    for (exact, above) in found.rates_rad_s.iter().zip(&found.reduced_rates_rad_s) {
        assert!(*above >= *exact * (1.0 - 1e-12));
    }
    assert!((found.reduced_rates_rad_s[0] / found.rates_rad_s[0] - 1.0).abs() < 5e-3);
    // Closed form: the k-th rate of the chain is 2 sqrt(k/m) sin((2k-1) pi / (2 (2n+1))).
    let closed = 2.0 * 1e6_f64.sqrt() * (std::f64::consts::PI / 98.0).sin();
    assert!((found.rates_rad_s[0] / closed - 1.0).abs() < 1e-11);
    // A force at a master gives the same static displacement at a master.
    let mut pushed = full.clone();
    pushed.F = Mat::from_fn(24, 1, |i, _| if i == 5 { 1.0 } else { 0.0 });
    let condensed = guyan(&pushed, &masters).unwrap().structure;
    let gain = |s: &SecondOrder| dcgain(&s.to_state_space().unwrap()).unwrap()[(0, 0)];
    assert!((gain(&condensed) / gain(&pushed) - 1.0).abs() < 1e-10);
    assert!(guyan(&full, &[3, 3]).is_err());
}

#[test]
fn a_modal_basis_keeps_its_frequencies() {
    let full = chain(24);
    let found = modal_basis(&full, 5).unwrap();
    assert!(found.measured_error < 1e-10, "{}", found.measured_error);
    assert!((&found.structure.M - &Mat::eye(5)).norm_max() < 1e-12);
    let (a, b) = (full.to_state_space().unwrap(), found.structure.to_state_space().unwrap());
    let rate = found.rates_rad_s[1];
    let (x, y) = (response_at(&a, rate).unwrap()[(0, 0)], response_at(&b, rate).unwrap()[(0, 0)]);
    assert!((x - y).norm() < 0.01 * x.norm());
}

#[test]
fn states_that_the_input_hardly_reaches_leave_the_hankel_values_right() {
    // Four poles at -1 and two at -4 in rotated whole numbers; what the input does to two states is 2^-28 of the rest. A rotation leaves rounding errors
    // below the diagonal, which balancing took for couplings: the values were wrong in the third digit. They are known from 300 digits.
    let A = Mat::from_rows(&[
        &[6.0, 3.0, -21.0, 13.0, -1.0, -7.0],
        &[11.0, 2.0, -28.0, 17.0, -5.0, -11.0],
        &[-2.0, 0.0, 3.0, -2.0, 2.0, 2.0],
        &[-6.0, -3.0, 19.0, -13.0, 0.0, 6.0],
        &[-1.0, 0.0, 1.0, -1.0, 0.0, 1.0],
        &[9.0, 0.0, -17.0, 9.0, -9.0, -10.0],
    ]);
    let e = f64::exp2(-30.0);
    let B = Mat::col(&[-3.0 - 6.0 * e, -3.0 - 12.0 * e, 1.5, 6.0 + e, 1.5 + 5.0 * e, -10.0 * e]);
    let C = Mat::row(&[-18.65625, -2.453125, 42.640625, -23.609375, 10.578125, 17.03125]);
    let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
    let reduced = balred(&g, Order::States(2), Method::SquareRoot).unwrap();
    let exact = [3.009282498604143, 0.250704410327737, 0.01978586481184198, 0.0033952766955067854];
    for (found, exact) in reduced.hankel.iter().zip(exact) {
        assert!((found - exact).abs() < 1e-12 * 3.0, "{found} {exact}");
    }
}
