#![allow(clippy::unwrap_used)]
use super::*;
use counterpoise_lti::{Timebase, frequency_response};

fn discrete(A: Mat, B: Mat, C: Mat) -> StateSpace {
    let D = Mat::zeros(C.nrows(), B.ncols());
    StateSpace::new(A, B, C, D, Timebase::Discrete { period_s: 1e-3 }).unwrap()
}

fn largest_difference(a: &StateSpace, b: &StateSpace) -> f64 {
    let rates: Vec<f64> = (0..60).map(|k| 1.0 * 1.14_f64.powi(k)).collect();
    let (ga, gb) = (frequency_response(a, &rates).unwrap(), frequency_response(b, &rates).unwrap());
    ga.iter().zip(&gb).map(|(x, y)| (x - y).norm_max() / x.norm_max()).fold(0.0, f64::max)
}

/// Returns a companion form with integrator, real pole and two lightly damped pairs: an ill-conditioned realisation.
fn companion(poles: &[C64]) -> StateSpace {
    let mut polynomial = vec![C64::new(1.0, 0.0)];
    for pole in poles {
        let shifted: Vec<C64> = polynomial.iter().map(|c| -pole * c).collect();
        polynomial.push(C64::new(0.0, 0.0));
        for (k, s) in shifted.iter().enumerate() {
            polynomial[k + 1] += s;
        }
    }
    let n = poles.len();
    let A = Mat::from_fn(n, n, |i, j| match i {
        0 => -polynomial[j + 1].re,
        _ => f64::from(i == j + 1),
    });
    let B = Mat::from_fn(n, 1, |i, _| f64::from(i == 0));
    discrete(A, B, Mat::from_fn(1, n, |_, j| 1.0 / (1.0 + j as f64)))
}

#[test]
fn a_companion_form_becomes_sections_of_first_and_second_order() {
    let pair = |r: f64, phi: f64| [C64::from_polar(r, phi), C64::from_polar(r, -phi)];
    let poles = [vec![C64::new(1.0, 0.0), C64::new(0.3, 0.0)], pair(0.98, 0.7).into(), pair(0.9, 2.0).into()];
    let given = companion(&poles.concat());
    let found = modal_form(&given).unwrap();
    let mut sizes = found.blocks.clone();
    sizes.sort_unstable();
    assert_eq!(sizes, [1, 1, 2, 2]);
    assert!(found.residual < 1e-14, "{}", found.residual);
    assert!(largest_difference(&given, &found.system) < 1e-11);
    assert!(count_coefficients(&found.system) <= 22);
}

#[test]
fn a_double_pole_stays_in_one_block() {
    let poles = [0.9, 0.9, 0.5, 0.1].map(|p| C64::new(p, 0.0));
    let given = companion(&poles);
    let found = modal_form(&given).unwrap();
    assert!(found.blocks.contains(&2), "{:?}", found.blocks);
    assert!(found.condition < MODAL_CONDITION);
    assert!(largest_difference(&given, &found.system) < 1e-10);
}

#[test]
fn a_system_without_states_stays_a_gain() {
    let gain = StateSpace::gain(Mat::eye(1), Timebase::Discrete { period_s: 1e-3 }).unwrap();
    assert_eq!(modal_form(&gain).unwrap().system, gain);
}
