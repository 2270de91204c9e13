//! Tests of the weights.
#![allow(clippy::unwrap_used)]
use super::*;
use counterpoise_lti::response::response_at;

fn all() -> Vec<Weight> {
    vec![
        Weight::Constant { gain: 3.0 },
        Weight::Integral { gain: 2.0, time_s: 0.5 },
        Weight::Lag { gain: 2.0, time_s: 0.5 },
        Weight::Lead { gain: 0.2, time_s: 0.01 },
        Weight::Quadratic { gain: 0.1, second_s2: 1e-4, first_s: 0.03 },
        Weight::QuadraticFreeAtZero { gain: 0.1, second_s2: 1e-4, first_s: 0.03 },
        Weight::Shelf { low: 10.0, high: 0.1, corner_rad_s: 3.0 },
        Weight::Notch { gain: 2.0, centre_rad_s: 100.0, width: 0.1, factor: 0.01 },
    ]
}

#[test]
fn realisations_have_the_modulus_of_the_weight() {
    for weight in all() {
        for rate in [0.1, 3.0, 100.0, 4000.0] {
            let expected = weight.magnitude(rate);
            if let Ok(system) = weight.realise() {
                let found = response_at(&system, rate).unwrap()[(0, 0)].norm();
                assert!((found / expected - 1.0).abs() < 1e-12, "{weight} at {rate}: {found} {expected}");
            }
            if let Ok(system) = weight.realise_inverse() {
                let found = response_at(&system, rate).unwrap()[(0, 0)].norm();
                assert!((found * expected - 1.0).abs() < 1e-12, "1/({weight}) at {rate}");
            }
        }
    }
}

#[test]
fn improper_weights_have_an_inverse_of_their_own_order_and_no_other() {
    let weight = Weight::Quadratic { gain: 0.1, second_s2: 1e-4, first_s: 0.03 };
    assert!(weight.realise().is_err());
    let inverse = weight.realise_inverse().unwrap();
    assert_eq!((inverse.order(), inverse.D[(0, 0)]), (2, 0.0));
    assert!(Weight::Lag { gain: 1.0, time_s: 1.0 }.realise_inverse().is_err());
    assert!(Weight::Constant { gain: 0.0 }.realise_inverse().is_err());
    assert!(Weight::Lag { gain: 1.0, time_s: f64::NAN }.realise().is_err());
}

#[test]
fn corners_are_where_they_are_said_to_be() {
    let shelf = Weight::Shelf { low: 10.0, high: 0.1, corner_rad_s: 3.0 };
    assert!((shelf.magnitude(0.0) - 10.0).abs() < 1e-12);
    assert!((shelf.magnitude(3.0) - 1.0).abs() < 1e-12);
    let notch = Weight::Notch { gain: 2.0, centre_rad_s: 100.0, width: 0.1, factor: 0.01 };
    assert!((notch.magnitude(100.0) - 0.02).abs() < 1e-12);
    assert!((notch.magnitude(0.0) - 2.0).abs() < 1e-12);
}

#[test]
fn right_half_plane_roots_are_mirrored() {
    let poles = [C64::new(0.3, 0.0)];
    let weight = Weight::ZeroPoleGain { zeros: vec![], poles: poles.to_vec(), gain: 2.0 };
    let system = weight.realise().unwrap();
    assert_eq!(system.A[(0, 0)], -0.3);
}

#[test]
fn a_table_is_the_function_that_comes_nearest() {
    let lag = |rate: f64| 30.0 / (1.0 + (rate / 2.0).powi(2)).sqrt() + 0.5;
    let points: Vec<[f64; 2]> =
        (0..12).map(|k| 0.05 * 2.5_f64.powi(k)).map(|rate| [rate, lag(rate)]).collect();
    let table = Weight::table(&points, 2).unwrap();
    assert!(table.worst_db() < 0.5, "{}", table.worst_db());
    assert!(table.realise().is_ok() && table.to_string().contains("table of 12 points"), "{table}");
    assert!(Weight::table(&points[..3], 2).is_err());
}
