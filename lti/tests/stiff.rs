//! Stiff structures with hardly any damping, and responses that doubles do not show: each against a value of 1000 bits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::Mat;
use counterpoise_lti::{
    Discretisation, StateSpace, Timebase, c2d, frequency_response, h2norm, linfnorm, linfnorm_bounds, margins,
};

/// w'' + D w' + K w = the force on one mass, and the position of one mass times a gain.
fn structure(K: &Mat, D: &Mat, force: (usize, f64), sensor: (usize, f64)) -> StateSpace {
    let k = K.nrows();
    let A = Mat::from_blocks(&[&[&Mat::zeros(k, k), &Mat::eye(k)], &[&-K, &-D]]);
    let B = Mat::from_fn(2 * k, 1, |i, _| if i == k + force.0 { force.1 } else { 0.0 });
    let C = Mat::from_fn(1, 2 * k, |_, j| if j == sensor.0 { sensor.1 } else { 0.0 });
    StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap()
}

#[test]
fn a_chain_damped_by_1e_11_has_a_finite_norm_and_all_its_digits() {
    // Rounding the norm of A moves the real part of the lowest mode by as much as itself; rounding the stiffnesses does not move it.
    let K = Mat::from_rows(&[
        &[5.003754139608609, -2.6391395629448198, 0.0, 0.0, 0.0],
        &[-2.5420964376279955, 810.3033506584785, -807.7612542208506, 0.0, 0.0],
        &[0.0, -1892.8741058228902, 1897.5681634588227, -4.6940576359324195, 0.0],
        &[0.0, 0.0, -13.159375734165522, 16.004951827704605, -2.8455760935390835],
        &[0.0, 0.0, 0.0, -1.8163646407844913, 1.8163646407844913],
    ]);
    let D = Mat::from_rows(&[
        &[1.0063352228510359e-10, -5.307733006279961e-11, 0.0, 0.0, 0.0],
        &[-5.1125637145499206e-11, 1.6296500191866422e-08, -1.6245374554720925e-08, 0.0, 0.0],
        &[0.0, -3.806873463333735e-08, 3.81631396621484e-08, -9.440502881105087e-11, 0.0],
        &[0.0, 0.0, -2.6465615500960277e-10, 3.2188525484813364e-10, -5.7229099838530897e-11],
        &[0.0, 0.0, 0.0, -3.6530006562344366e-11, 3.6530006562344366e-11],
    ]);
    let g = structure(&K, &D, (3, 0.7002040050597305), (9, 0.01));
    let found = h2norm(&g).unwrap();
    assert!((found / 168.55005777063383 - 1.0).abs() < 1e-11, "{found}");
    assert!(linfnorm_bounds(&g, 1e-10).unwrap().lower.value.is_finite());
}

#[test]
fn a_resonance_between_two_doubles_has_its_peak() {
    let K = Mat::from_rows(&[
        &[364.64055360662263, -0.37713056960043245, 0.0],
        &[-6.924721291592722, 3483.0618495577155, -3476.1371282661225],
        &[0.0, -7687.205132039226, 7687.205132039226],
    ]);
    let D = Mat::from_rows(&[
        &[7.14695804146098e-09, -7.39176246423299e-12, 0.0],
        &[-1.357245979096874e-10, 6.826804272971121e-08, -6.813231813180152e-08],
        &[0.0, -1.5066928785452026e-07, 1.5066928785452026e-07],
    ]);
    let g = structure(&K, &D, (0, 0.1034236403472182), (2, 0.01));
    let found = linfnorm(&g, 1e-10).unwrap().value;
    assert!((found / 67285.91418889455 - 1.0).abs() < 1e-10, "{found}");
}

#[test]
fn a_crossing_below_a_direct_path_of_1e8_is_found() {
    // Lags in series whose gain at the crossing is 1e-8 of the direct path: rounding changes the response by more than itself.
    let A = Mat::from_rows(&[
        &[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        &[9999.0, -1.0, 0.0, 0.0, 0.0, 0.0],
        &[9999.0, 1.0, -0.001, 0.0, 0.0, 0.0],
        &[9999.0, 1.0, -0.000998, -1.0, 0.0, 0.0],
        &[9999.0, 1.0, -0.000998, -2.0, -10000.0, 0.0],
        &[9999.0, 1.0, -0.000998, -2.0, -10000.0001, -1000000.0],
    ]);
    let C = Mat::row(&[
        999900000000.0,
        100000000.0,
        -99800.0,
        -200000000.0,
        -1000000009999.9999,
        -100000000001000.0,
    ]);
    let (B, D) = (Mat::col(&[1.0; 6]), Mat::row(&[1e8]));
    let found = margins(&StateSpace::new(A, B, C, D, Timebase::Continuous).unwrap()).unwrap();
    assert_eq!(found.phase.len(), 1, "{:?}", found.phase);
    assert!((found.phase[0].rate_rad_s / 0.0708729253625258 - 1.0).abs() < 1e-9, "{:?}", found.phase);
}

#[test]
fn a_flat_top_is_found_where_rounding_raises_another_place() {
    // s / ((s + 1e6)(s + 1e-5)): flat to 1e-10 from 1e-3 to 10 rad/s; in doubles the response at 2e-5 rad/s is too high by 1e-6.
    let A = Mat::from_rows(&[&[-1e6, 0.0], &[-1e6, -1e-5]]);
    let g = StateSpace::new(
        A,
        Mat::col(&[1.0, 1.0]),
        Mat::row(&[0.0, 1.0]),
        Mat::zeros(1, 1),
        Timebase::Continuous,
    );
    let found = linfnorm(&g.unwrap(), 1e-10).unwrap().value;
    assert!((found / 9.999999999999716e-07 - 1.0).abs() < 1e-10, "{found}");
}

#[test]
fn tustins_method_keeps_the_response_in_units_over_five_decades() {
    let A = Mat::from_rows(&[
        &[-1.0923480022221712, 5.892650927310835e-06],
        &[450177.07329646545, -2.4994502949875472],
    ]);
    let (B, C) = (
        Mat::col(&[-0.2988014905661805, -109678.04677298409]),
        Mat::row(&[-1.4562108679159806, -6.047262276785868e-06]),
    );
    let g = StateSpace::new(A, B, C, Mat::row(&[-0.004614268518955974]), Timebase::Continuous).unwrap();
    let period_s = 0.0002021080880876994;
    let sampled = c2d(&g, period_s, Discretisation::Tustin { prewarp_rad_s: None }).unwrap();
    for angle in [0.01_f64, 0.3, 1.0, 2.0, 3.0] {
        let response = |g: &StateSpace, rate: f64| frequency_response(g, &[rate]).unwrap()[0][(0, 0)];
        let exact = response(&g, 2.0 / period_s * (0.5 * angle).tan());
        let found = response(&sampled, angle / period_s);
        assert!(((found - exact) / exact).norm() < 1e-10, "{angle}: {found} {exact}");
    }
}

#[test]
fn the_norm_at_the_end_of_a_ladder_has_the_closed_form() {
    // n lags, each driven by a share c of the one before, which sees b of it: c^(n-1) / (s + 1)^n but for c b. The square of the norm of 1 / (s + 1)^n is
    // C(2n - 2, n - 1) / 2^(2n - 1). In scaled units the last state is 1e-33 of the first one, and its digits were those of rounding.
    let (n, c, b) = (6, 1e-4, 1e-9);
    let A = Mat::from_fn(n, n, |i, j| match (i == j, i == j + 1, j == i + 1) {
        (true, ..) => -1.0,
        (_, true, _) => c,
        (_, _, true) => b,
        _ => 0.0,
    });
    let unit = Mat::eye(n);
    let (B, C) = (unit.block(0, 0, n, 1), unit.block(n - 1, 0, 1, n));
    let g = StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
    let exact = c.powi(5) * (252.0_f64 / 2048.0).sqrt();
    assert!((h2norm(&g).unwrap() / exact - 1.0).abs() < 1e-11);
}
