//! Root loci of loops whose poles are known in closed form, and the path of a resonance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{Response, StateSpace, Timebase};
use counterpoise_verify::linear_loop::frequency::grid_hz;
use counterpoise_verify::linear_loop::loop_shape::loop_path;
use counterpoise_verify::linear_loop::root_locus::continuous_equivalent;
use counterpoise_verify::linear_loop::{LoopPath, RootLocus, root_locus};

fn sampled_system(A: Mat, B: Mat, C: Mat, D: f64) -> StateSpace {
    let D = Mat::from_rows(&[[D]]);
    StateSpace::new(A, B, C, D, Timebase::Discrete { period_s: 0.01 }).unwrap()
}

fn is_near(branches: &RootLocus, k: usize, expected: C64) -> bool {
    branches.branches.iter().any(|branch| (branch[k] - expected).norm() < 1e-9)
}

#[test]
fn two_integrators_leave_along_the_roots_of_their_polynomial() {
    // L = k (z - 0.5) / (z - 1)^2, so (z - 1)^2 + k (z - 0.5) = 0
    let L = sampled_system(
        Mat::from_rows(&[[2.0, -1.0], [1.0, 0.0]]),
        Mat::from_rows(&[[1.0], [0.0]]),
        Mat::from_rows(&[[1.0, -0.5]]),
        0.0,
    );
    let locus = root_locus(&L, 0.01).unwrap();
    assert!(locus.gains.contains(&1.0));
    assert!(locus.gains.windows(2).all(|pair| pair[0] < pair[1]));
    for (k, gain) in locus.gains.iter().enumerate() {
        let (b, c) = (gain - 2.0, 1.0 - 0.5 * gain);
        let root = C64::new(b * b - 4.0 * c, 0.0).sqrt();
        assert!(is_near(&locus, k, 0.5 * (-root - b)), "{gain}");
        assert!(is_near(&locus, k, 0.5 * (root - b)), "{gain}");
    }
    assert!((locus.open_zeros[0] - 0.5).norm() < 1e-12 && locus.open_zeros.len() == 1);
    // branches do not jump: only near the point where the two meet do they move fast
    for branch in &locus.branches {
        let jumps =
            branch.windows(2).filter(|pair| (pair[1] - pair[0]).norm() > 0.5 * pair[0].norm().max(1.0));
        assert_eq!(jumps.count(), 0);
    }
}

#[test]
fn a_direct_path_is_part_of_the_loop() {
    // L = k (0.5 + 1 / (z - 0.9)): the pole is at 0.9 - k / (1 + 0.5 k)
    let one = |value: f64| Mat::from_rows(&[[value]]);
    let locus = root_locus(&sampled_system(one(0.9), one(1.0), one(1.0), 0.5), 0.01).unwrap();
    for (gain, pole) in locus.gains.iter().zip(&locus.branches[0]) {
        assert!((pole - (0.9 - gain / (1.0 + 0.5 * gain))).norm() < 1e-12);
    }
}

#[test]
fn a_pole_has_its_equivalent_in_continuous_time() {
    let s = C64::new(-3.0, 40.0);
    let found = continuous_equivalent((s * 0.01).exp(), 0.01).unwrap();
    assert!((found - s).norm() < 1e-9);
    assert_eq!(continuous_equivalent(C64::new(0.0, 0.0), 0.01), None);
}

fn farthest(path: &LoopPath) -> f64 {
    let steps = path.response.windows(2).filter(|pair| (pair[0] + 1.0).norm() < 3.0);
    steps.map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max)
}

#[test]
fn a_resonance_of_a_thousandth_of_damping_is_drawn_as_a_circle() {
    // 1 / (s^2 / w^2 + 2 d s / w + 1) / 400 at 7 Hz, d = 0.001, sampled exactly by its impulse response
    let (w, T, damping) = (std::f64::consts::TAU * 7.0, 0.01, 0.001);
    let pole = C64::new(-damping * w, w * (1.0_f64 - damping * damping).sqrt());
    let z = (pole * T).exp();
    let A = Mat::from_rows(&[[2.0 * z.re, -z.norm_sqr()], [1.0, 0.0]]);
    let size = w * T * (-damping * w * T).exp() * (pole.im * T).sin() / 400.0;
    let L = sampled_system(A, Mat::from_rows(&[[1.0], [0.0]]), Mat::from_rows(&[[0.0, size]]), 0.0);
    let response = Response::of(&L).unwrap();
    let frequency_hz = grid_hz(T);
    let at = |hz: &f64| response.at(std::f64::consts::TAU * hz).unwrap()[(0, 0)];
    let coarse = LoopPath { response: frequency_hz.iter().map(at).collect(), frequency_hz };
    let path = loop_path(&L, &coarse).unwrap();
    let largest = path.response.iter().map(|L| L.norm()).fold(0.0, f64::max);
    assert!((largest - 1.25).abs() < 0.01, "the peak 1 / (2 d 400): {largest}");
    assert!(farthest(&path) < 0.15, "{}", farthest(&path));
    assert!(path.response.len() < 3000);
}
