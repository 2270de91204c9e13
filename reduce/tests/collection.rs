//! The model-reduction collection of Chahlaoui and Van Dooren: Hankel values against the reference ones, errors within
//! their bounds, responses against the reference magnitudes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

mod mat;

use std::collections::HashMap;
use std::path::PathBuf;

use counterpoise_linalg as linalg;
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{Descriptor, StateSpace, Timebase, frequency_response, is_stable, response_at};
use counterpoise_reduce::{BalancedSystem, Method, Order, balred};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/benchmarks/reduction")
}

fn load(name: &str) -> Option<(StateSpace, HashMap<String, Mat>)> {
    let path = folder().join(format!("{name}.mat"));
    assert!(path.exists(), "{} is missing", path.display());
    let found = mat::read(&path);
    let (A, B, C) = (found["A"].clone(), found["B"].clone(), found["C"].clone());
    let D = Mat::zeros(C.nrows(), B.ncols());
    Some((StateSpace::new(A, B, C, D, Timebase::Continuous).unwrap(), found))
}

/// The reference values themselves are good to 1e-12 to 1e-11 of the largest.
fn check(name: &str, order: usize, digits: f64) {
    let Some((g, found)) = load(name) else { return };
    let balanced = BalancedSystem::of(&g).unwrap();
    let reference = &found["hsv"];
    let largest = reference[(0, 0)];
    for (k, value) in balanced.hankel().iter().enumerate() {
        let error = (value - reference[(k, 0)]).abs() / largest;
        assert!(error < digits, "{name}: Hankel value {k}: {value:e} against {:e}", reference[(k, 0)]);
    }
    for method in [Method::SquareRoot, Method::BalancingFree, Method::MatchDc] {
        let reduced = balred(&g, Order::States(order), method).unwrap();
        let bound = reduced.bound.unwrap();
        let least = reduced.hankel[order];
        let error = reduced.measured_error.value;
        assert!(
            error <= bound * (1.0 + 1e-6) + 1e-12 * largest,
            "{name} {method:?}: {error:e} above {bound:e}"
        );
        assert!(
            error >= 0.5 * least,
            "{name} {method:?}: no system of order {order} can be this near: {error:e} {least:e}"
        );
        assert_eq!(reduced.system.order(), order);
    }
}

/// `mag` holds the magnitude of each entry of the response, a column an entry, column by column.
fn check_response(name: &str, digits: f64) {
    let Some((g, found)) = load(name) else { return };
    let (rates, magnitude) = (&found["w"], &found["mag"]);
    let responses = frequency_response(&g, rates.as_slice()).unwrap();
    let peak = magnitude.norm_max();
    for (k, H) in responses.iter().enumerate() {
        for (column, entry) in H.as_slice().iter().enumerate() {
            let reference = magnitude[(k, column)];
            let error = (entry.norm() - reference).abs();
            assert!(
                error < digits * (reference + 1e-6 * peak),
                "{name} at {}: {} {reference}",
                rates[(k, 0)],
                entry.norm()
            );
        }
    }
}

#[test]
fn building() {
    check("building", 10, 1e-11);
    check_response("building", 1e-8);
}

#[test]
fn cd_player() {
    check("cdplayer", 16, 1e-10);
    check_response("cdplayer", 1e-7);
}

#[test]
fn heat() {
    check("heat", 6, 1e-11);
    check_response("heat", 1e-8);
}

#[test]
fn pde() {
    check("pde", 5, 1e-12);
    check_response("pde", 1e-8);
}

/// The error of four states lies between frequencies at which a coarse search stops half a percent too low.
#[test]
fn pde_by_four_states() {
    let Some((g, _)) = load("pde") else { return };
    let reduced = balred(&g, Order::States(4), Method::SquareRoot).unwrap();
    assert!((reduced.measured_error.value / 4.9919e-5 - 1.0).abs() < 1e-5, "{:?}", reduced.measured_error);
}

#[test]
fn beam() {
    check("beam", 12, 1e-9);
    check_response("beam", 1e-8);
}

/// The circuit is a descriptor system of index two and more, with capacitors across its ports: an admittance with a
/// part proportional to s, which no reduction touches. Its outputs are its inputs' currents, C = B'.
#[test]
fn mna1() {
    let path = folder().join("mna1.mat");
    assert!(path.exists(), "{} is missing", path.display());
    let found = mat::read(&path);
    let (E, A, B) = (&found["E"], &found["A"], &found["B"]);
    let D = Mat::zeros(B.ncols(), B.ncols());
    let system = StateSpace::new(A.clone(), B.clone(), B.t(), D, Timebase::Continuous).unwrap();
    let circuit = Descriptor::new(E.clone(), system).unwrap().reduce_index().unwrap();
    let g = &circuit.system;
    assert_eq!((g.order(), circuit.derivatives.len()), (256, 1));
    assert!(is_stable(g).unwrap());
    for rate in [0.0, 1e5, 1e7, 1e9, 1e11, 1e13] {
        let s = C64::new(0.0, rate);
        let M = E.to_complex().scale(s) - A.to_complex();
        let expected = &B.t().to_complex() * &linalg::csolve(&M, &B.to_complex()).unwrap();
        let direct = circuit.derivatives[0].to_complex().scale(s);
        let error =
            (&(&response_at(g, rate).unwrap() + &direct) - &expected).norm_max() / expected.norm_max();
        assert!(error < 1e-7, "{rate:e} rad/s: {error:e}");
    }
    // Passive: the admittance at zero frequency and the capacitance are symmetric.
    let capacitance = &circuit.derivatives[0];
    assert!((capacitance - &capacitance.t()).norm_max() < 1e-9 * capacitance.norm_max());
    for method in [Method::SquareRoot, Method::BalancingFree, Method::MatchDc] {
        let reduced = balred(g, Order::States(40), method).unwrap();
        let (error, bound) = (reduced.measured_error.value, reduced.bound.unwrap());
        println!("{method:?}: {error:e} within {bound:e}, largest {:e}", reduced.hankel[0]);
        assert!(
            error <= bound * (1.0 + 1e-6) + 1e-9 * reduced.hankel[0],
            "{method:?}: {error:e} above {bound:e}"
        );
        assert!(is_stable(&reduced.system).unwrap());
    }
}
