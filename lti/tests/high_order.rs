//! High order without expanded polynomials: poles, gains and responses of chains that lose them elsewhere.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::C64;
use counterpoise_lti::{StateSpace, Timebase, Zpk, dcgain, poles, response_at, series};

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
