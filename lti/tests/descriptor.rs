//! Descriptor systems: index reduction against the transfer function C inv(s E - A) B + D itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg as linalg;
use counterpoise_linalg::{C64, CMat, Mat};
use counterpoise_lti::{Descriptor, Error, StateSpace, Timebase, poles, response_at, zeros};

fn descriptor(E: Mat, A: Mat, B: Mat, C: Mat) -> Descriptor {
    let D = Mat::zeros(C.nrows(), B.ncols());
    Descriptor::new(E, StateSpace::new(A, B, C, D, Timebase::Continuous).unwrap()).unwrap()
}

fn direct(g: &Descriptor, rate: f64) -> CMat {
    let s = C64::new(0.0, rate);
    let M = g.E.to_complex().scale(s) - g.system.A.to_complex();
    &g.system.C.to_complex() * &linalg::csolve(&M, &g.system.B.to_complex()).unwrap()
}

/// Returns a mass on a spring pulled along by a massless lever and a damper: index one.
fn lever() -> Descriptor {
    let E = Mat::diag(&[1.0, 2.0, 0.0]);
    let A = Mat::from_rows(&[&[0.0, 1.0, 0.0], &[-3.0, -0.5, 1.0], &[-1.0, 0.0, -4.0]]);
    descriptor(E, A, Mat::col(&[0.0, 0.0, 1.0]), Mat::row(&[1.0, 0.0, 1.0]))
}

/// Returns two masses (m, M) held together by a constraint q1 = q2, its force a variable: index three.
fn glued_masses(m: f64, M: f64) -> Descriptor {
    let E = Mat::diag(&[1.0, 1.0, m, M, 0.0]);
    let A = Mat::from_rows(&[
        &[0.0, 0.0, 1.0, 0.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0, 0.0],
        &[-5.0, 0.0, -0.2, 0.0, 1.0],
        &[0.0, 0.0, 0.0, -0.1, -1.0],
        &[1.0, -1.0, 0.0, 0.0, 0.0],
    ]);
    descriptor(E, A, Mat::col(&[0.0, 0.0, 1.0, 0.0, 0.0]), Mat::row(&[0.0, 1.0, 0.0, 0.0, 0.0]))
}

#[test]
fn an_algebraic_variable_leaves_a_direct_path() {
    let g = lever();
    let found = g.reduce_index().unwrap();
    assert_eq!((found.system.order(), found.rounds, found.derivatives.len()), (2, 1, 0));
    assert!((found.system.D[(0, 0)] - 0.25).abs() < 1e-15);
    for rate in [0.0, 0.7, 30.0] {
        let error = response_at(&found.system, rate).unwrap()[(0, 0)] - direct(&g, rate)[(0, 0)];
        assert!(error.norm() < 1e-14, "{rate}: {error}");
    }
}

#[test]
fn a_rigid_constraint_of_index_three_gives_the_rigid_body() {
    // (m + M) q'' + 0.3 q' + 5 q = u, also where the masses differ by sixteen decades.
    for (m, M) in [(1.0, 2.0), (1e-8, 1e8), (1e8, 1e-8)] {
        let system = glued_masses(m, M).to_state_space().unwrap();
        assert_eq!(system.order(), 2);
        for rate in [0.0, 1e-4, 1.0, 1e4] {
            let exact = 1.0 / C64::new(5.0 - (m + M) * rate * rate, 0.3 * rate);
            let found = response_at(&system, rate).unwrap()[(0, 0)];
            assert!((found - exact).norm() < 1e-13 * exact.norm(), "{m}, {M}, {rate}: {found} {exact}");
        }
        assert!(poles(&system).unwrap().iter().all(|pole| pole.re < 0.0));
    }
}

#[test]
fn a_differentiator_is_named() {
    // x1 = u, y = x1': the transfer function is s.
    let E = Mat::from_rows(&[&[0.0, 1.0], &[0.0, 0.0]]);
    let g = descriptor(E, Mat::eye(2), Mat::col(&[0.0, -1.0]), Mat::row(&[1.0, 0.0]));
    assert_eq!(g.to_state_space(), Err(Error::Improper { output: 0, input: 0, derivative: 1 }));
    let found = g.reduce_index().unwrap();
    assert_eq!((found.system.order(), found.derivatives), (0, vec![Mat::eye(1)]));
}

#[test]
fn a_pencil_without_a_transfer_function_is_refused() {
    let E = Mat::diag(&[1.0, 0.0]);
    let g = descriptor(E, Mat::diag(&[-1.0, 0.0]), Mat::col(&[1.0, 1.0]), Mat::row(&[1.0, 1.0]));
    assert_eq!(g.reduce_index(), Err(Error::SingularPencil { equations: 1 }));
}

#[test]
fn an_invertible_mass_is_divided_out() {
    let (E, A) = (Mat::diag(&[1e-8, 1e8]), Mat::from_rows(&[&[-1e-8, 1e-8], &[0.0, -3e8]]));
    let g = descriptor(E, A, Mat::col(&[0.0, 1e8]), Mat::row(&[1.0, 1.0]));
    let found = g.reduce_index().unwrap();
    assert_eq!(found.rounds, 0);
    // 1/((s+1)(s+3)) + 1/(s+3) has its zero at -2.
    assert!((zeros(&found.system).unwrap()[0] - (-2.0)).norm() < 1e-13);
    let none = descriptor(Mat::zeros(0, 0), Mat::zeros(0, 0), Mat::zeros(0, 1), Mat::zeros(1, 0));
    assert_eq!(none.to_state_space().unwrap().order(), 0);
}
