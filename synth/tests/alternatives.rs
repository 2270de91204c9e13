//! LQR, Kalman, LQG/LTR, and the three designs side by side.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{rig, thesis_weights};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, h2norm, hinfnorm, poles, response::response_at, series};
use counterpoise_synth::{
    Alternative, Gain, SynthesisMethod, alternatives::generalised_plant, design_alternative, kalman, lqg_ltr,
    lqr,
};

fn double_integrator(timebase: Timebase) -> StateSpace {
    let A = match timebase {
        Timebase::Continuous => Mat::from_rows(&[&[0.0, 1.0], &[0.0, 0.0]]),
        Timebase::Discrete { period_s } => Mat::from_rows(&[&[1.0, period_s], &[0.0, 1.0]]),
    };
    let B = match timebase {
        Timebase::Continuous => Mat::col(&[0.0, 1.0]),
        Timebase::Discrete { period_s } => Mat::col(&[0.5 * period_s * period_s, period_s]),
    };
    StateSpace::new(A, B, Mat::row(&[1.0, 0.0]), Mat::zeros(1, 1), timebase).unwrap()
}

#[test]
fn a_double_integrator_has_its_closed_form() {
    let g = double_integrator(Timebase::Continuous);
    let q = 9.0_f64;
    let gain: Gain = lqr(&g, &Mat::diag(&[q, 0.0]), &Mat::eye(1), None).unwrap();
    let root = q.sqrt();
    assert!(
        (gain.gain[(0, 0)] - root).abs() < 1e-12 && (gain.gain[(0, 1)] - (2.0 * root).sqrt()).abs() < 1e-12
    );
    let filter = kalman(&g, &Mat::diag(&[0.0, q]), &Mat::eye(1)).unwrap();
    assert!(
        (filter.gain[(1, 0)] - root).abs() < 1e-12
            && (filter.gain[(0, 0)] - (2.0 * root).sqrt()).abs() < 1e-12
    );
}

#[test]
fn a_fast_sampled_regulator_tends_to_the_continuous_one() {
    let (Q, R) = (Mat::diag(&[9.0, 1.0]), Mat::eye(1));
    let exact = lqr(&double_integrator(Timebase::Continuous), &Q, &R, None).unwrap().gain;
    let mut last = f64::INFINITY;
    for period_s in [0.1, 0.01, 0.001] {
        let g = double_integrator(Timebase::Discrete { period_s });
        let sampled = lqr(&g, &Q.scale(period_s), &R.scale(period_s), None).unwrap();
        assert!(sampled.equation.spectrum.iter().all(|pole| pole.norm() < 1.0));
        let difference = (&sampled.gain - &exact).norm_fro();
        assert!(difference < 0.2 * last, "{period_s}: {difference}");
        last = difference;
    }
}

#[test]
fn recovery_brings_the_loop_to_its_target() {
    let plant = rig().system.select(&[0], &[0]);
    let shape = thesis_weights().feedback.error.realise().unwrap();
    let shape = series(&shape, &thesis_weights().feedback.control.realise_inverse().unwrap()).unwrap();
    let mut last = f64::INFINITY;
    for recovery in [1e2, 1e6, 1e10, 1e14] {
        let design = lqg_ltr(&plant, &shape, 1.0, recovery).unwrap();
        let open = series(&plant, &design.controller).unwrap();
        let at = |rate: f64| {
            let target = response_at(&design.target, rate).unwrap()[(0, 0)];
            (response_at(&open, rate).unwrap()[(0, 0)] + target).norm() / target.norm()
        };
        let worst = [3.0, 10.0, 20.0].map(at).into_iter().fold(0.0, f64::max);
        assert!(worst < 0.5 * last, "{recovery}: {worst} after {last}");
        last = worst;
    }
    assert!(last < 0.05, "{last}");
}

#[test]
fn the_joint_textbook_design_is_the_three_part_one() {
    let (plant, weights) = (rig(), thesis_weights().feedback);
    let made = |method| design_alternative(&plant, &weights, method).unwrap();
    let (three, joint) = (made(SynthesisMethod::ThreePart), made(SynthesisMethod::JointH2));
    for rate in [0.5, 5.0, 30.0, 200.0, 1000.0] {
        let [a, b] =
            [&three, &joint].map(|part: &Alternative| response_at(&part.controller, rate).unwrap()[(0, 1)]);
        assert!((a - b).norm() < 5e-3 * a.norm(), "at {rate}: {a} {b}");
    }
    assert!(
        (three.norm.unwrap() / joint.norm.unwrap() - 1.0).abs() < 1e-3,
        "{:?} {:?}",
        three.norm,
        joint.norm
    );
}

#[test]
fn every_method_makes_a_stable_loop_and_each_is_best_in_its_own_norm() {
    let (plant, weights) = (rig(), thesis_weights().feedback);
    let seen = plant.measured_plant().unwrap().select(&[0], &[0]);
    let methods = [
        SynthesisMethod::ThreePart,
        SynthesisMethod::JointH2,
        SynthesisMethod::LqgLtr,
        SynthesisMethod::HInfinity,
    ];
    for method in methods {
        let part = design_alternative(&plant, &weights, method).unwrap();
        let K = part.controller.select(&[0], &[0]);
        let open = series(&K, &seen).unwrap();
        let one = StateSpace::gain(Mat::eye(1), Timebase::Continuous).unwrap();
        let closed = counterpoise_lti::feedback(&open, &one).unwrap();
        let worst = poles(&closed).unwrap().iter().map(|pole| pole.re).fold(f64::NEG_INFINITY, f64::max);
        assert!(worst < 0.0, "{method:?}: {worst}");
    }
    let P = generalised_plant(&plant, &weights).unwrap();
    let two = counterpoise_synth::h2syn(&P).unwrap();
    let infinity = counterpoise_synth::hinfsyn(&P, 1e-2).unwrap();
    let [a, b] = [&two.controller, &infinity.controller].map(|K| P.close(K).unwrap());
    assert!(h2norm(&a).unwrap() <= h2norm(&b).unwrap());
    assert!(hinfnorm(&b, 1e-8).unwrap().value <= hinfnorm(&a, 1e-8).unwrap().value);
}
