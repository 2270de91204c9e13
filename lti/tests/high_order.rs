//! High order without expanded polynomials: poles, gains and responses of chains that lose them elsewhere.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, Zpk, append, dcgain, poles, response_at, series, zeros};

fn chain(roots: &[f64]) -> StateSpace {
    let poles = roots.iter().map(|&p| C64::new(-p, 0.0)).collect();
    let gain = roots.iter().product();
    Zpk { zeros: vec![], poles, gain, timebase: Timebase::Continuous }.to_state_space().unwrap()
}

/// The coefficients of (s+1)...(s+16) move its roots by more than they differ when they are rounded.
#[test]
fn a_transfer_function_of_order_sixteen_keeps_its_poles() {
    let roots: Vec<f64> = (1..=16).map(f64::from).collect();
    let g = chain(&roots);
    for (found, expected) in poles(&g).unwrap().iter().zip(roots.iter().rev()) {
        assert!((found + expected).norm() < 1e-13 * expected, "{found}, not -{expected}");
    }
    assert!((dcgain(&g).unwrap()[(0, 0)] - 1.0).abs() < 1e-13);
    for rate in [0.1, 1.0, 10.0, 100.0] {
        let exact: C64 = roots.iter().map(|p| p / C64::new(*p, rate)).product();
        let found = response_at(&g, rate).unwrap()[(0, 0)];
        assert!((found - exact).norm() < 1e-13 * exact.norm(), "{rate}: {found} {exact}");
    }
}

#[test]
fn a_pole_of_multiplicity_sixteen_is_no_circle_of_poles() {
    let g = chain(&[3.0; 16]);
    assert!(poles(&g).unwrap().iter().all(|pole| (pole + 3.0).norm() < 1e-14), "{:?}", poles(&g).unwrap());
}

#[test]
fn thirty_two_poles_over_sixteen_decades_stay_apart() {
    let roots: Vec<f64> = (0..32).map(|k| 10f64.powf(-8.0 + 0.5 * f64::from(k))).collect();
    let g = series(&chain(&roots[..16]), &chain(&roots[16..])).unwrap();
    for (found, expected) in poles(&g).unwrap().iter().zip(roots.iter().rev()) {
        assert!((found + expected).norm() < 1e-13 * expected, "{found}, not -{expected}");
    }
}

/// (s^2 + 2 d w s + w^2) of an antiresonance over that of the resonance above it.
fn section(rate: f64, damping: f64) -> StateSpace {
    let pair = |rate: f64| {
        let root = C64::new(-damping, (1.0 - damping * damping).sqrt()) * rate;
        vec![root, root.conj()]
    };
    let zpk = Zpk { zeros: pair(rate), poles: pair(1.25 * rate), gain: 1.0, timebase: Timebase::Continuous };
    zpk.to_state_space().unwrap()
}

/// As an aircraft with flutter modes in a benchmark of the literature: 55 states, two inputs and outputs that couple, and 52 zeros.
#[test]
fn all_fifty_two_zeros_of_two_coupled_flexible_channels_are_found() {
    let rate = |k: usize| 0.5 * 1.35f64.powi(k as i32);
    let damping = |k: usize| [0.003, 0.02, 0.1][k % 3];
    let channel = |from: usize, lags: &[f64]| {
        let sections = (from..26).step_by(2).map(|k| section(rate(k), damping(k)));
        sections.fold(chain(lags), |g, next| series(&g, &next).unwrap())
    };
    let both = append(&channel(0, &[3.0]), &channel(1, &[40.0, 900.0])).unwrap();
    let (left, right) =
        (Mat::from_rows(&[&[1.0, -0.5], &[0.25, 2.0]]), Mat::from_rows(&[&[1.0, 0.5], &[-3.0, 1.0]]));
    let g = StateSpace::new(both.A, both.B * right, left * both.C, Mat::zeros(2, 2), both.timebase).unwrap();
    assert_eq!(g.order(), 55);
    let found = zeros(&g).unwrap();
    assert_eq!(found.len(), 52);
    for k in 0..26 {
        let exact = C64::new(-damping(k), (1.0 - damping(k) * damping(k)).sqrt()) * rate(k);
        for exact in [exact, exact.conj()] {
            let distance = found.iter().map(|zero| (zero - exact).norm()).fold(f64::INFINITY, f64::min);
            assert!(distance < 1e-11 * exact.norm(), "{exact}: {distance:e}");
        }
    }
}
