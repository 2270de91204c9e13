//! The tables of free functions: through their points, smooth, flat outside, and repeating over a turn.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use counterpoise_models::plant::LearnedTable;
use counterpoise_models::{Interpolation, LearnedElement, RegimeVariable};

fn element(variable: RegimeVariable, points: &[f64], of: impl Fn(f64) -> f64) -> LearnedElement {
    let values = points.iter().map(|x| of(*x)).collect();
    LearnedElement { variable, points: points.to_vec(), values, ..LearnedElement::default() }
}

fn even(count: usize, low: f64, high: f64) -> Vec<f64> {
    (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
}

#[test]
fn a_table_passes_its_points_is_smooth_between_them_and_flat_outside() {
    let uneven: Vec<f64> = even(30, 0.0, 1.0).iter().map(|x| x * (0.5 + 0.5 * x) * 3.0).collect();
    for points in [even(30, 0.0, 3.0), uneven] {
        let table = LearnedTable::new(&element(RegimeVariable::Angle, &points, f64::sin)).unwrap();
        for k in 0..300 {
            let x = 0.4 + 0.008 * f64::from(k);
            assert!((table.at(x) - x.sin()).abs() < 2e-4, "{x}");
            assert!((table.slope_at(x) - x.cos()).abs() < 5e-3, "{x}");
        }
        points.iter().for_each(|x| assert!((table.at(*x) - x.sin()).abs() < 1e-12));
        assert_eq!((table.at(-5.0), table.at(9.0)), (points[0].sin(), points[29].sin()));
    }
}

#[test]
fn a_function_over_a_turn_repeats_without_a_kink() {
    let points: Vec<f64> = (0..24).map(|k| 0.1 + TAU * f64::from(k) / 24.0).collect();
    let table = LearnedTable::new(&element(RegimeVariable::Turn, &points, |x| (2.0 * x).cos())).unwrap();
    for k in -400..400 {
        let x = 0.05 * f64::from(k);
        assert!((table.at(x) - (2.0 * x).cos()).abs() < 1e-3, "{x}");
        assert!((table.at(x) - table.at(x + TAU)).abs() < 1e-12);
    }
    let seam = table.slope_at(0.1 - 1e-9) - table.slope_at(0.1 + 1e-9);
    assert!(seam.abs() < 1e-4, "{seam}");
}

#[test]
fn one_point_is_a_constant_and_straight_lines_stay_straight() {
    let one = LearnedTable::new(&element(RegimeVariable::Rate, &[2.0], |_| 7.0)).unwrap();
    assert_eq!([one.at(-1.0), one.at(2.0), one.at(5.0)], [7.0; 3]);
    let mut steps = element(RegimeVariable::Rate, &[-1.0, 0.0, 1.0], f64::abs);
    steps.interpolation = Interpolation::Linear;
    let table = LearnedTable::new(&steps).unwrap();
    assert_eq!([table.at(-0.25), table.at(0.75)], [0.25, 0.75]);
}
