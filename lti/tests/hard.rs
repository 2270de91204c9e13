//! Systems for which margins, zeros and norms were once wrong, each with its closed form.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{
    Descriptor, Discretisation, StateSpace, Timebase, Zpk, c2d, h2norm, hinfnorm, linfnorm, linfnorm_bounds,
    margins, margins_with_delay, parallel, response_at, series, zeros,
};

fn zpk(zeros: &[f64], poles: &[f64], gain: f64) -> StateSpace {
    let real = |roots: &[f64]| roots.iter().map(|&r| C64::new(r, 0.0)).collect();
    let zpk = Zpk { zeros: real(zeros), poles: real(poles), gain, timebase: Timebase::Continuous };
    zpk.to_state_space().unwrap()
}

#[test]
fn gains_far_from_one_cross_far_from_the_roots() {
    for gain in [1e-9, 1e-3, 1e3, 1e7, 1e12] {
        // |L| = 1 at w^2 = (sqrt(1 + 4 k^2) - 1)/2.
        let found = margins(&zpk(&[], &[0.0, -1.0], gain)).unwrap();
        let square = 2.0 * gain * gain / (1.0 + (1.0 + 4.0 * gain * gain).sqrt());
        let crossing = found.phase_margin().unwrap();
        assert!((crossing.rate_rad_s / square.sqrt() - 1.0).abs() < 1e-12, "{gain:e}: {crossing:?}");
        assert!(found.delay_s.is_finite(), "{gain:e}");
    }
    let found = margins(&zpk(&[], &[-1.0], 1e4)).unwrap();
    assert!((found.phase_margin().unwrap().rate_rad_s / (1e8_f64 - 1.0).sqrt() - 1.0).abs() < 1e-12);
}

#[test]
fn a_fast_sampled_integrator_with_a_delay_has_its_crossing() {
    // k/(z (z - 1)): |L| = 1 at 2 sin(w T/2) = k, phase -pi/2 - 3 w T/2.
    let (k, period_s) = (0.2_f64, 1e-4);
    let A = Mat::from_rows(&[&[1.0, 0.0], &[1.0, 0.0]]);
    let g = StateSpace::new(
        A,
        Mat::col(&[k, 0.0]),
        Mat::row(&[0.0, 1.0]),
        Mat::zeros(1, 1),
        Timebase::Discrete { period_s },
    );
    let found = margins(&g.unwrap()).unwrap();
    let angle = 2.0 * (0.5 * k).asin();
    let crossing = found.phase_margin().unwrap();
    assert!((crossing.rate_rad_s * period_s / angle - 1.0).abs() < 1e-12, "{crossing:?}");
    let phase = std::f64::consts::FRAC_PI_2 - 1.5 * angle;
    assert!((crossing.deg.to_radians() / phase - 1.0).abs() < 1e-12);
    assert!((found.delay_s / (phase / crossing.rate_rad_s) - 1.0).abs() < 1e-12);
}

#[test]
fn a_zero_among_poles_of_other_sizes_is_the_only_one() {
    let found = zeros(&zpk(&[-200.0], &[-100.0, -0.1, -0.1, -0.1], 1.0)).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0].re / -200.0 - 1.0).abs() < 1e-12 && found[0].im == 0.0, "{found:?}");
    let found = zeros(&zpk(&[-1e-5, -3e6], &[-1e-6, -1e-2, -1e3, -1e6, -1e6], 1.0)).unwrap();
    assert_eq!(found.len(), 2, "{found:?}");
}

#[test]
fn an_integrator_in_hiding_has_no_finite_norm() {
    let A = Mat::from_rows(&[&[2.0, 2.0], &[-3.0, -3.0]]);
    let g = StateSpace::new(
        A,
        Mat::col(&[1.0, 0.0]),
        Mat::row(&[1.0, 0.0]),
        Mat::zeros(1, 1),
        Timebase::Continuous,
    );
    let g = g.unwrap();
    assert_eq!(h2norm(&g).unwrap(), f64::INFINITY);
    assert_eq!(hinfnorm(&g, 1e-8).unwrap().value, f64::INFINITY);
    assert_eq!(linfnorm(&g, 1e-8).unwrap().value, f64::INFINITY);
}

#[test]
fn the_error_of_a_nearly_exact_copy_is_found_between_two_bounds() {
    // g - (1 + e) g with a lightly damped g: the norm is e times that of g.
    let (zeta, rate, e) = (1e-4, 30.0, 2f64.powi(-20));
    let pole = C64::new(-zeta, (1.0_f64 - zeta * zeta).sqrt()) * rate;
    let poles = vec![pole, pole.conj()];
    let g = Zpk { zeros: vec![], poles, gain: rate * rate, timebase: Timebase::Continuous }
        .to_state_space()
        .unwrap();
    let lag = series(&zpk(&[], &[-1e4], 1e4), &g).unwrap();
    let error = parallel(&lag, &lag.negate().scale_io(&[1.0 + e], &[1.0]).unwrap()).unwrap();
    let exact = e * linfnorm(&lag, 1e-12).unwrap().value;
    let found = linfnorm_bounds(&error, 1e-9).unwrap();
    assert!((found.lower.value / exact - 1.0).abs() < 1e-8, "{found:?} {exact:e}");
    assert!(found.upper >= found.lower.value);
    let bounds = linfnorm_bounds(&lag, 1e-9).unwrap();
    assert!(bounds.upper >= bounds.lower.value && bounds.upper < 1.001 * bounds.lower.value, "{bounds:?}");
}

#[test]
fn a_rotated_descriptor_of_index_three_keeps_its_derivatives() {
    // x1 = x2', x2 = x3', x3 = -u: x1 = -u''; rotated by two reflections, plus a lag.
    let n = 4;
    let reflection = |v: [f64; 4]| {
        let size: f64 = v.iter().map(|e| e * e).sum();
        Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / size)
    };
    let (U, V) = (reflection([1.0, 2.0, -1.0, 3.0]), reflection([2.0, -1.0, 1.0, 1.0]));
    let mut E = Mat::zeros(n, n);
    (E[(0, 1)], E[(1, 2)], E[(3, 3)]) = (1.0, 1.0, 1.0);
    let A = Mat::diag(&[1.0, 1.0, 1.0, -5.0]);
    let (B, C) = (Mat::col(&[0.0, 0.0, 1.0, 2.0]), Mat::row(&[1.0, 0.0, 0.0, 3.0]));
    let system =
        StateSpace::new(&U * &A * &V, &U * &B, &C * &V, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
    let found = Descriptor::new(&U * &E * &V, system).unwrap().reduce_index().unwrap();
    assert_eq!(found.system.order(), 1);
    assert!((found.system.A[(0, 0)] + 5.0).abs() < 1e-12);
    let gains: Vec<f64> = found.derivatives.iter().map(|M| M[(0, 0)]).collect();
    assert_eq!(gains.len(), 2, "{gains:?}");
    assert!(gains[0].abs() < 1e-12 && (gains[1] + 1.0).abs() < 1e-12, "{gains:?}");
}

#[test]
fn systems_without_inputs_or_states_are_answered() {
    for (n, m, p) in [(0, 0, 0), (0, 1, 1), (2, 0, 1), (2, 1, 0), (2, 0, 0)] {
        let A = Mat::diag(&vec![-1.0; n]);
        let g =
            StateSpace::new(A, Mat::zeros(n, m), Mat::zeros(p, n), Mat::zeros(p, m), Timebase::Continuous);
        let g = g.unwrap();
        assert_eq!(h2norm(&g).unwrap(), 0.0);
        assert_eq!(linfnorm(&g, 1e-8).unwrap().value, 0.0);
        assert!(zeros(&g).is_ok());
        let descriptor = Descriptor::new(Mat::zeros(n, n), g).unwrap();
        assert_eq!(descriptor.reduce_index().unwrap().system.order(), 0);
    }
}

#[test]
fn an_integrator_with_delay_is_followed_until_its_gain_is_small() {
    // k exp(-s T)/s crosses the negative axis at w T = pi/2 + 2 pi m, where its gain is k/w.
    let (k, delay_s) = (16.6, 1.7);
    let found = margins_with_delay(&zpk(&[], &[0.0], k), delay_s).unwrap();
    let turns = (k / 1e-3 * delay_s - 0.5 * std::f64::consts::PI) / (2.0 * std::f64::consts::PI);
    let reached = found.margins.gain.iter().filter(|margin| margin.factor < 1e3).count();
    assert_eq!(reached, turns.floor() as usize + 1);
}

#[test]
fn a_flat_response_and_a_tiny_difference_keep_their_norms() {
    // (1 + e) / (s + 1) - 1 / (s + 1) with two poles that nearly cancel: e/(s+1) exactly, e = 2^-30.
    let e = f64::exp2(-30.0);
    let A = Mat::from_rows(&[&[-1.0, 0.0], &[0.0, -1.0]]);
    let (B, C) = (Mat::col(&[1.0, 1.0]), Mat::from_rows(&[&[1.0 + e, -1.0]]));
    let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
    let bounds = linfnorm_bounds(&g, 1e-10).unwrap();
    assert!((bounds.lower.value / e - 1.0).abs() < 1e-12 && bounds.upper / e < 1.0 + 1e-6, "{bounds:?}");
    // A hill of a millionth above the value at rest: a (s + 1) / (s^2 + 2 z s + 1) with z just below flat.
    let hill = zpk(&[-1.0], &[-0.5, -2.0], 1.0);
    let squared = |w: f64| (w * w + 1.0) / ((w * w + 0.25) * (w * w + 4.0));
    let peak = linfnorm(&hill, 1e-12).unwrap();
    let best = (0..200_000).map(|k| squared(k as f64 * 1e-5).sqrt()).fold(0.0, f64::max);
    assert!((peak.value / best - 1.0).abs() < 1e-9, "{peak:?} {best}");
}

#[test]
fn tustin_keeps_its_digits_in_any_units() {
    let plain = zpk(&[-3.0, -50.0], &[-2.0, -4.0, -2300.0, -2400.0], 1e6);
    let units = [1e6, 1e-6, 1e5, 1e-5].map(|unit: f64| unit.log2().round().exp2());
    let scaled = plain.scale_states(&units);
    let method = Discretisation::Tustin { prewarp_rad_s: None };
    let (a, b) = (c2d(&plain, 8e-4, method).unwrap(), c2d(&scaled, 8e-4, method).unwrap());
    for rate in [1.0, 12.0, 400.0] {
        let (x, y) = (response_at(&a, rate).unwrap()[(0, 0)], response_at(&b, rate).unwrap()[(0, 0)]);
        assert!(((x - y) / x).norm() < 1e-11, "{rate}: {x} {y}");
    }
}

#[test]
fn a_loop_by_the_bilinear_map_crosses_nothing_at_half_the_sampling_rate() {
    // Two zeros at half the sampling rate: the response vanishes there, and rounding changes the sign of its imaginary part.
    for period_s in [1e-4, 1e-3, 1e-2, 0.3] {
        let g = c2d(&zpk(&[], &[-1.0, -3.5], 40.0), period_s, Discretisation::Tustin { prewarp_rad_s: None })
            .unwrap();
        let found = margins(&g).unwrap();
        assert!(found.gain.is_empty(), "{period_s}: {:?}", found.gain);
        assert_eq!(found.phase.len(), 1);
        // The double integrator is real everywhere, and crosses nothing either.
        let g = c2d(&zpk(&[], &[0.0, 0.0], 4.0), period_s, Discretisation::Tustin { prewarp_rad_s: None })
            .unwrap();
        assert!(margins(&g).unwrap().gain.iter().all(|margin| margin.rate_rad_s == 0.0));
    }
}

#[test]
fn every_crossing_of_a_delay_line_is_found() {
    // k z^-8 meets the negative axis at odd multiples of pi/8, between which a grid at halves of the rate sees one phase only.
    let (n, period_s) = (8, 1e-3);
    let A = Mat::from_fn(n, n, |i, j| if i == j + 1 { 1.0 } else { 0.0 });
    let B = Mat::from_fn(n, 1, |i, _| if i == 0 { 0.4 } else { 0.0 });
    let C = Mat::from_fn(1, n, |_, j| if j + 1 == n { 1.0 } else { 0.0 });
    let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Discrete { period_s }).unwrap();
    let found = margins(&g).unwrap().gain;
    assert_eq!(found.len(), 4);
    for (k, margin) in found.iter().enumerate() {
        let rate = std::f64::consts::PI * (2 * k + 1) as f64 / 8.0 / period_s;
        assert!((margin.rate_rad_s / rate - 1.0).abs() < 1e-12 && (margin.factor - 2.5).abs() < 1e-12);
    }
}

#[test]
fn an_undamped_structure_crosses_nothing_at_its_poles_and_zeros() {
    // Two masses, the force and the rate at the first one: through poles and zeros on the axis the response jumps to the other side.
    let A = Mat::from_rows(&[
        &[0.0, 0.0, 1.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0],
        &[-7.0, 3.0, 0.0, 0.0],
        &[2.0, -2.0, 0.0, 0.0],
    ]);
    let (B, C) = (Mat::col(&[0.0, 0.0, 1.0, 0.0]), Mat::row(&[1.0, 0.0, 0.03, 0.0]));
    let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
    assert!(margins(&g).unwrap().gain.is_empty());
}

#[test]
fn a_gain_that_approaches_one_from_above_crosses_it_beyond_the_grid() {
    // k (s + 2)/(s + 1) falls from 2 k to k, below one; k (s + 1)/(s + 2) stays below one.
    let below = margins(&zpk(&[-2.0], &[-1.0], 1.0 - 1e-9)).unwrap();
    let [only] = below.phase.as_slice() else { panic!("{:?}", below.phase) };
    // |L|^2 = k^2 (w^2 + 4)/(w^2 + 1) is one at w^2 = (4 k^2 - 1)/(1 - k^2).
    let k2 = (1.0 - 1e-9_f64).powi(2);
    assert!((only.rate_rad_s / ((4.0 * k2 - 1.0) / (1.0 - k2)).sqrt() - 1.0).abs() < 1e-6);
    assert!(margins(&zpk(&[-1.0], &[-2.0], 1.0 - 1e-9)).unwrap().phase.is_empty());
}

#[test]
fn a_small_zero_beside_large_ones_keeps_its_digits() {
    // Of the numbers from which the coupling for the zero at 1e-5 is summed, one part in 1e12 is left.
    let g = zpk(&[-2e4, -200.0, 1e5, 1.0, 1e-5, -2e-6], &[-1e6, -1e4, -0.1, -1e-5, -1e-6, -1e-6], 1e-3);
    let found = zeros(&g).unwrap();
    let nearest = found.iter().map(|z| (z - 1e-5).norm()).fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-7, "{found:?}");
}

#[test]
fn a_loop_that_is_zero_at_rest_has_no_margin_there() {
    // 1e6 s/((s + 1)(s + 2)), whose phase never reaches -180 degrees, in rotated coordinates: the response at rest is rounding.
    let plain = zpk(&[0.0], &[-1.0, -2.0], 1e6);
    for turn in 1..60 {
        let (sin, cos) = (f64::from(turn) * 0.1).sin_cos();
        let T = Mat::from_rows(&[&[cos, -sin], &[sin, cos]]);
        let turned = StateSpace::new(
            &(&T.t() * &plain.A) * &T,
            &T.t() * &plain.B,
            &plain.C * &T,
            plain.D.clone(),
            Timebase::Continuous,
        );
        let turned = turned.unwrap();
        assert!(margins(&turned).unwrap().gain.is_empty(), "{turn}");
        let delayed = turned.scale_io(&[1e-5], &[1.0]).unwrap();
        let delayed = margins_with_delay(&delayed, 1e-2).unwrap().margins;
        assert!(delayed.gain.iter().all(|margin| margin.rate_rad_s > 1.0), "{turn}: {:?}", delayed.gain);
    }
}

#[test]
fn a_margin_at_rest_is_found_where_an_integrator_meets_a_zero_there() {
    // The zero at z = 1 of the plant and the controller's integrators cancel: L(1) = -0.354, which a gain of 2.82 takes to -1.
    let timebase = Timebase::Discrete { period_s: 1e-3 };
    let sampled = |zeros: &[f64], poles: &[f64], gain: f64| {
        let real = |roots: &[f64]| roots.iter().map(|&r| C64::new(r, 0.0)).collect();
        Zpk { zeros: real(zeros), poles: real(poles), gain, timebase }.to_state_space().unwrap()
    };
    let plant = sampled(&[1.0], &[0.99, 0.98], 2e-4);
    let loop_gain = series(&plant, &sampled(&[], &[1.0], -0.354)).unwrap();
    let found = margins(&loop_gain).unwrap();
    let at_rest = found.gain.iter().find(|margin| margin.rate_rad_s == 0.0).unwrap();
    assert!((at_rest.factor * 0.354 - 1.0).abs() < 1e-9, "{at_rest:?}");
    // integrators that nothing cancels leave no margin there
    let two = margins(&zpk(&[-1.0], &[0.0, 0.0, -100.0], 50.0)).unwrap();
    assert!(two.gain.iter().all(|margin| margin.rate_rad_s > 0.0), "{two:?}");
}

#[test]
fn two_equal_zeros_of_a_chain_keep_their_digits() {
    // A force on the last mass is seen at the first through two springs with a dashpot each: a zero at -k/c of each, equal up to rounding.
    let (k, c): ([f64; 2], [f64; 2]) = ([4.084096, 154.1068], [1.693534e-8, 6.390278e-7]);
    let share = c[0] / k[0];
    for c in [c, k.map(|k| share * k)] {
        let rows = |u: [f64; 2]| {
            Mat::from_rows(&[&[-3.0 * u[0], u[0], 0.0], &[u[0], -u[0] - u[1], u[1]], &[0.0, u[1], -u[1]]])
        };
        let A = Mat::from_blocks(&[&[&Mat::zeros(3, 3), &Mat::eye(3)], &[&rows(k), &rows(c)]]);
        let (mut B, mut C) = (Mat::zeros(6, 1), Mat::zeros(1, 6));
        (B[(5, 0)], C[(0, 0)]) = (0.4, 100.0);
        let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
        let found = zeros(&g).unwrap();
        let mut exact = [-k[0] / c[0], -k[1] / c[1]];
        exact.sort_by(f64::total_cmp);
        assert_eq!(found.len(), 2, "{found:?}");
        for (zero, exact) in found.iter().zip(exact) {
            assert!((zero - exact).norm() <= 1e-14 * exact.abs(), "{zero} {exact}");
        }
    }
}

#[test]
fn the_end_of_a_long_chain_of_lags_keeps_its_digits_when_sampled() {
    // The hold of n equal lags: state k after the first takes the integral of exp(-t) t^k / k!, its series here.
    let hold = |k: i32, h: f64| {
        let term = |j: i32| (1..=k + j).fold(1.0, |p, i| p * h / f64::from(i)) * h / f64::from(k + 1 + j);
        let choose = |j: i32| (1..=j).fold(1.0, |p, i| p * f64::from(k + i) / f64::from(i));
        (0..24).map(|j| if j % 2 == 0 { 1.0 } else { -1.0 } * choose(j) * term(j)).sum::<f64>()
    };
    for (n, h) in [(9, 3e-4), (9, 0.02), (9, 0.2), (6, 0.05)] {
        let A = Mat::from_fn(n, n, |i, j| match (i == j, i == j + 1) {
            (true, _) => -1.0,
            (_, true) => 1.0,
            _ => 0.0,
        });
        let B = Mat::from_fn(n, 1, |i, _| if i == 0 { 1.0 } else { 0.0 });
        let g = StateSpace::new(A, B, Mat::eye(n), Mat::zeros(n, 1), Timebase::Continuous).unwrap();
        let sampled = c2d(&g, h, Discretisation::ZeroOrderHold).unwrap();
        for k in 0..n {
            let exact = hold(k as i32, h);
            let found = sampled.B[(k, 0)];
            assert!((found / exact - 1.0).abs() < 1e-12, "{n} {h} {k}: {found:e} {exact:e}");
        }
    }
}

#[test]
fn a_far_zero_stays_as_long_as_the_data_determine_it() {
    // 1/(s + 1) - (1 - e)/(s + 2) has the zero -(1 + e)/e; and with a third lag that sums to as little.
    for decade in 3..=12 {
        let c = -1.0 + 10f64.powi(-decade);
        let e = 1.0 + c;
        for bits in [0, 20, -33] {
            let unit = f64::from(bits).exp2();
            let (A, B) = (Mat::diag(&[-1.0, -2.0]), Mat::col(&[1.0, unit]));
            let C = Mat::row(&[1.0, c / unit]);
            let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
            let found = zeros(&g).unwrap();
            assert_eq!(found.len(), 1, "{decade} {bits}");
            assert!((found[0].re * -e / (1.0 + e) - 1.0).abs() < 1e-12, "{decade} {bits}: {}", found[0]);
        }
        // 1/(s + 1) + (e - 2)/(s + 2) + 1/(s + 3) has the numerator e s^2 + 4 e s + 2 + 3 e.
        let g = StateSpace::new(
            Mat::diag(&[-1.0, -2.0, -3.0]),
            Mat::from_fn(3, 1, |_, _| 1.0),
            Mat::row(&[1.0, e - 2.0, 1.0]),
            Mat::zeros(1, 1),
            Timebase::Continuous,
        );
        let found = zeros(&g.unwrap()).unwrap();
        let e = (e - 2.0) + 2.0;
        assert_eq!(found.len(), 2, "{decade}");
        let exact = (2.0 + 3.0 * e) / e;
        let (product, sum) = (found[0] * found[1], found[0] + found[1]);
        // The data determine e to their rounding over it.
        let errors = [product.re / exact - 1.0, sum.re / -4.0 - 1.0];
        assert!(errors.iter().all(|error| error.abs() < 1e-14 / e), "{found:?}");
    }
}

#[test]
fn a_gain_of_one_at_all_frequencies_crosses_nothing_and_leaves_no_delay() {
    let all_pass = |A: f64, B: f64, C: f64, D: f64, timebase| {
        let of = |x: f64| Mat::from_rows(&[&[x]]);
        StateSpace::new(of(A), of(B), of(C), of(D), timebase).unwrap()
    };
    let sampled = Timebase::Discrete { period_s: 1.0 };
    let loops = [
        all_pass(0.0, 1.0, 1.0, 0.0, sampled),
        all_pass(-1.0, 1.0, -2.0, 1.0, Timebase::Continuous),
        all_pass(-1e3, 1.0, -2e3, 1.0, Timebase::Continuous),
        all_pass(0.5, 1.0, 0.75, -0.5, sampled),
    ];
    for g in loops {
        let found = margins(&g).unwrap();
        assert!(found.is_all_pass && found.phase.is_empty(), "{g:?}: {:?}", found.phase);
        assert!(found.delay_s < 0.01, "{g:?}: {}", found.delay_s);
    }
    assert!(!margins(&zpk(&[], &[-1.0], 1.0)).unwrap().is_all_pass);
}

#[test]
fn a_sampled_mode_that_is_inside_by_its_own_entry_has_a_finite_norm() {
    for below in [1e-9, 1e-12, 1e-14, 1e-15, 5e-16] {
        let a: f64 = 1.0 - below;
        for coupling in [0.0, 0.3] {
            let A = Mat::from_rows(&[&[a, 0.0], &[coupling, 0.25]]);
            let (B, C) = (Mat::col(&[1.0, 0.0]), Mat::row(&[1.0, 0.0]));
            let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Discrete { period_s: 1.0 }).unwrap();
            let exact = 1.0 / ((1.0 - a) * (1.0 + a)).sqrt();
            let found = h2norm(&g).unwrap();
            assert!((found / exact - 1.0).abs() < 1e-12, "{below}: {found} {exact}");
        }
    }
    let on = StateSpace::new(
        Mat::diag(&[1.0, 0.5]),
        Mat::col(&[1.0, 1.0]),
        Mat::row(&[1.0, 1.0]),
        Mat::zeros(1, 1),
        Timebase::Discrete { period_s: 1.0 },
    );
    assert!(!h2norm(&on.unwrap()).unwrap().is_finite());
}
