//! H2 and H-infinity synthesis against closed forms, printed figures and each other.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, append, h2norm, hinfnorm, series};
use counterpoise_synth::{
    Cause, Error, GeneralisedPlant, H2, HInfinity, HiddenDirection, ModeBlock, PlantCause, Weight, h2syn,
    hinfsyn,
};

fn rows(rows: &[&[f64]]) -> Mat {
    Mat::from_rows(rows)
}

fn generalised_plant(blocks: [&Mat; 4], controls: usize, measurements: usize) -> GeneralisedPlant {
    let [A, B, C, D] = blocks.map(Clone::clone);
    let system = StateSpace::new(A, B, C, D, Timebase::Continuous).unwrap();
    GeneralisedPlant::new(system, controls, measurements).unwrap()
}

fn h2(plant: &GeneralisedPlant) -> H2 {
    h2syn(plant).unwrap()
}

fn hinf(plant: &GeneralisedPlant, tolerance: f64) -> HInfinity {
    hinfsyn(plant, tolerance).unwrap()
}

fn check_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found}, not {expected}");
}

#[test]
fn the_cross_terms_of_octave_s_example() {
    let plant = generalised_plant(
        [
            &rows(&[&[-1.0]]),
            &rows(&[&[1.0, 1.0]]),
            &rows(&[&[1.0], &[1.0]]),
            &rows(&[&[0.0, 1.0], &[1.0, 0.0]]),
        ],
        1,
        1,
    );
    let solution = h2(&plant);
    let K = &solution.controller;
    assert!((K.A[(0, 0)] + 3.0).abs() < 1e-13 && (K.B[(0, 0)] * K.C[(0, 0)] + 1.0).abs() < 1e-13);
    assert!(solution.predicted_norm < 1e-7 && solution.achieved_norm < 1e-7);
}

#[test]
fn the_scalar_problem_has_its_closed_form() {
    for (a, expected) in [(-1.0, 1.708203932499_f64), (0.0, 4.0), (1.0, 11.708203932499)] {
        let (q, r, v) = (2.0, 1.0, 0.5);
        let plant = generalised_plant(
            [
                &rows(&[&[a]]),
                &rows(&[&[1.0, 0.0, 1.0]]),
                &rows(&[&[q], &[0.0], &[1.0]]),
                &rows(&[&[0.0, 0.0, 0.0], &[0.0, 0.0, r], &[0.0, v, 0.0]]),
            ],
            1,
            1,
        );
        let solution = h2(&plant);
        check_near(solution.predicted_norm.powi(2), expected, 1e-11);
        check_near(solution.achieved_norm.powi(2), expected, 1e-11);
    }
}

/// An aircraft or helicopter of the COMPleib collection with states disturbed, and noise of density s^2 added.
fn compleib(A: &Mat, inputs: (&Mat, &Mat), (C1, D12, C): (&Mat, &Mat, &Mat), s: f64) -> GeneralisedPlant {
    let (B1, B) = inputs;
    let (n, w, y, u) = (A.nrows(), B1.ncols(), C.nrows(), B.ncols());
    let D21 = Mat::zeros(y, w).hstack(&Mat::eye(y).scale(s));
    let D = Mat::from_blocks(&[&[&Mat::zeros(C1.nrows(), w + y), D12], &[&D21, &Mat::zeros(y, u)]]);
    let B = Mat::from_blocks(&[&[B1, &Mat::zeros(n, y), B]]);
    generalised_plant([A, &B, &C1.vstack(C), &D], u, y)
}

#[test]
fn aircraft_of_compleib_cost_what_the_collection_s_data_give() {
    let A = rows(&[
        &[-0.037, 0.0123, 0.00055, -1.0],
        &[0.0, 0.0, 1.0, 0.0],
        &[-6.37, 0.0, -0.23, 0.0618],
        &[1.25, 0.0, 0.016, -0.0457],
    ]);
    let B = rows(&[&[0.00084, 0.000236], &[0.0, 0.0], &[0.08, 0.804], &[-0.0862, -0.0665]]);
    let C1 = Mat::eye(4).vstack(&Mat::zeros(2, 4));
    let D12 = Mat::zeros(4, 2).vstack(&Mat::eye(2));
    let noises = [1.0, 0.1, 0.01, 0.001];
    let three = Mat::eye(4).block(1, 0, 3, 4);
    let cases = [
        (three, [15.4017431229, 12.7281840861, 12.4472404363, 12.4190332867]),
        (Mat::eye(4), [15.2212010713, 12.6031106255, 12.3279703828, 12.3012135658]),
    ];
    for (C, expected) in cases {
        for (noise, expected) in noises.into_iter().zip(expected) {
            let solution = h2(&compleib(&A, (&Mat::eye(4), &B), (&C1, &D12, &C), noise));
            check_near(solution.predicted_norm, expected, 1e-11);
            check_near(solution.achieved_norm, expected, 1e-11);
        }
    }
}

#[test]
fn the_helicopter_of_compleib_costs_what_the_collection_s_data_give() {
    let A = rows(&[
        &[-0.0366, 0.0271, 0.0188, -0.4555],
        &[0.0482, -1.01, 0.0024, -4.0208],
        &[0.1002, 0.3681, -0.707, 1.42],
        &[0.0, 0.0, 1.0, 0.0],
    ]);
    let B1 = rows(&[&[4.678e-2, 0.0], &[4.572e-2, 9.88e-3], &[4.369e-2, 1.11e-3], &[-2.179e-2, 0.0]]);
    let B = rows(&[&[0.4422, 0.1761], &[3.5446, -7.5922], &[-5.52, 4.49], &[0.0, 0.0]]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let C1 = rows(&[&[2.0 * half, 0.0, 0.0, 0.0], &[0.0, half, 0.0, 0.0]]);
    let C = rows(&[&[0.0, 1.0, 0.0, 0.0]]);
    let D12 = Mat::eye(2).scale(half);
    for (noise, expected) in [(1.0, 1.00574404243), (0.1, 0.162908187158), (0.01, 0.0924739420148)] {
        let solution = h2(&compleib(&A, (&B1, &B), (&C1, &D12, &C), noise));
        check_near(solution.achieved_norm, expected, 1e-10);
    }
}

/// Skogestad and Postlethwaite's S/KS problem: w the disturbance at the output, z = (Wp (w + G u), Wu u), y = -(w + G u).
fn mixed_sensitivity() -> GeneralisedPlant {
    let real = |value: f64| C64::new(value, 0.0);
    let G = Weight::ZeroPoleGain {
        zeros: vec![],
        poles: vec![real(-0.1), real(-20.0), real(-20.0)],
        gain: 200.0 / 10.0 / (0.05 * 0.05),
    };
    let Wp = Weight::ZeroPoleGain { zeros: vec![real(-15.0)], poles: vec![real(-1e-3)], gain: 1.0 / 1.5 };
    let timebase = Timebase::Continuous;
    let gain = |D: &[&[f64]]| StateSpace::gain(rows(D), timebase).unwrap();
    let plant = append(&gain(&[&[1.0]]), &append(&G.realise().unwrap(), &gain(&[&[1.0]])).unwrap()).unwrap();
    let plant = series(&gain(&[&[1.0, 0.0], &[0.0, 1.0], &[0.0, 1.0]]), &plant).unwrap();
    let sums = series(&plant, &gain(&[&[1.0, 1.0, 0.0], &[0.0, 0.0, 1.0], &[-1.0, -1.0, 0.0]])).unwrap();
    let weights = append(&Wp.realise().unwrap(), &gain(&[&[1.0, 0.0], &[0.0, 1.0]])).unwrap();
    GeneralisedPlant::new(series(&sums, &weights).unwrap(), 1, 1).unwrap()
}

#[test]
fn the_mixed_sensitivity_example_reaches_its_printed_bound() {
    let plant = mixed_sensitivity();
    let solution = hinf(&plant, 1e-4);
    check_near(solution.achieved_norm, 1.3659, 2e-4);
    assert!(solution.unreachable < solution.achieved_norm * (1.0 + 1e-6));
    let closed = plant.close(&solution.controller).unwrap();
    check_near(hinfnorm(&closed, 1e-9).unwrap().value, solution.achieved_norm, 1e-6);
    assert!(solution.closed_loop.iter().all(|pole| pole.re < 0.0));
}

/// State x' = a x + w + u measured with noise: the H-infinity optimum tends to where both equations lose their solution.
#[test]
fn each_design_is_the_best_in_its_own_norm() {
    let A = rows(&[&[0.0, 1.0], &[-2.0, -0.1]]);
    let B = rows(&[&[0.0, 0.0, 0.0], &[1.0, 0.0, 1.0]]);
    let C = rows(&[&[1.0, 0.0], &[0.0, 0.0], &[1.0, 0.0]]);
    let D = rows(&[&[0.0, 0.0, 0.0], &[0.0, 0.0, 0.3], &[0.0, 0.2, 0.0]]);
    let plant = generalised_plant([&A, &B, &C, &D], 1, 1);
    let (two, infinity) = (h2(&plant), hinf(&plant, 1e-3));
    let loops = [&two.controller, &infinity.controller].map(|K| plant.close(K).unwrap());
    let [first, second] = loops.map(|g| (h2norm(&g).unwrap(), hinfnorm(&g, 1e-9).unwrap().value));
    assert!(first.0 < second.0 && first.1 > second.1, "{first:?} {second:?}");
    check_near(two.predicted_norm, first.0, 1e-11);
    assert!(infinity.achieved_norm / infinity.unreachable < 1.001);
}

#[test]
fn a_direct_path_from_control_to_measurement_is_taken_into_the_controller() {
    let A = rows(&[&[0.5, 1.0], &[0.0, -1.0]]);
    let B = rows(&[&[1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]]);
    let C = rows(&[&[1.0, 0.0], &[0.0, 0.0], &[1.0, 0.0]]);
    let with = |direct: f64| {
        let D = rows(&[&[0.0, 0.0, 0.0], &[0.0, 0.0, 1.0], &[0.0, 1.0, direct]]);
        generalised_plant([&A, &B, &C, &D], 1, 1)
    };
    let (without, direct) = (h2(&with(0.0)), h2(&with(0.7)));
    check_near(direct.achieved_norm, without.achieved_norm, 1e-10);
    check_near(hinf(&with(0.7), 1e-5).achieved_norm, hinf(&with(0.0), 1e-5).achieved_norm, 1e-4);
}

#[test]
fn broken_conditions_are_named() {
    let A = rows(&[&[-1.0]]);
    let (B, C) = (rows(&[&[1.0, 0.0, 1.0]]), rows(&[&[1.0], &[0.0], &[1.0]]));
    let D = |d12: f64, d21: f64, d11: f64| rows(&[&[d11, 0.0, 0.0], &[0.0, 0.0, d12], &[0.0, d21, 0.0]]);
    let cause =
        |D: &Mat| h2syn(&generalised_plant([&A, &B, &C, D], 1, 1)).unwrap_err().findings()[0].cause.clone();
    assert_eq!(cause(&D(0.0, 1.0, 0.0)), Cause::Plant(PlantCause::ControlUnweighed { control: 1 }));
    assert_eq!(cause(&D(1.0, 0.0, 0.0)), Cause::Plant(PlantCause::MeasurementNoiseless { measurement: 1 }));
    assert_eq!(cause(&D(1.0, 1.0, 0.5)), Cause::Plant(PlantCause::NoiseReachesCost { gain: 0.5 }));
    let unreachable =
        generalised_plant([&rows(&[&[1.0]]), &rows(&[&[1.0, 0.0, 0.0]]), &C, &D(1.0, 1.0, 0.0)], 1, 1);
    let outcome = h2syn(&unreachable).unwrap_err();
    let is_hidden = |error: &Error| match &error.findings()[0].cause {
        Cause::Plant(PlantCause::ModeHidden { mode, from: HiddenDirection::Control, block, .. }) => {
            (mode - 1.0).norm() < 1e-6 && *block == ModeBlock::State(1)
        }
        _ => false,
    };
    assert!(is_hidden(&outcome), "{outcome:?}");
    let at_any_bound = hinfsyn(&unreachable, 1e-3).unwrap_err();
    assert!(is_hidden(&at_any_bound), "{at_any_bound:?}");
}

/// z = x + u and y = x + w with x' = -x + w + u: the controller -1/(s + 3), python-control's example, leaves nothing of w.
#[test]
fn a_plant_whose_disturbance_can_be_cancelled_has_a_controller() {
    let system = StateSpace::new(
        Mat::from_rows(&[&[-1.0]]),
        Mat::from_rows(&[&[1.0, 1.0]]),
        Mat::from_rows(&[&[1.0], &[1.0]]),
        Mat::from_rows(&[&[0.0, 1.0], &[1.0, 0.0]]),
        Timebase::Continuous,
    );
    let found = hinf(&GeneralisedPlant::new(system.unwrap(), 1, 1).unwrap(), 1e-4);
    assert!(found.achieved_norm < 1e-9 && found.unreachable < 1e-9, "{found:?}");
    let pole = found.controller.A[(0, 0)];
    let gain = found.controller.B[(0, 0)] * found.controller.C[(0, 0)];
    assert!((pole + 3.0).abs() < 1e-8 && (gain + 1.0).abs() < 1e-8, "{pole} {gain}");
}

/// x' = a x + w + u, z = (q x, u), y = x + v.
fn scalar_level(a: f64, q: f64) -> GeneralisedPlant {
    let [A, B] = [rows(&[&[a]]), rows(&[&[1.0, 0.0, 1.0]])];
    let D = rows(&[&[0.0, 0.0, 0.0], &[0.0, 0.0, 1.0], &[0.0, 1.0, 0.0]]);
    generalised_plant([&A, &B, &rows(&[&[q], &[0.0], &[1.0]]), &D], 1, 1)
}

fn check_level(plant: &GeneralisedPlant, level: f64) {
    let found = hinf(plant, 1e-7);
    check_near(found.achieved_norm, level, 1e-6);
    assert!(found.achieved_norm >= level * (1.0 - 1e-9), "{} below {level}", found.achieved_norm);
    assert!(found.unreachable <= level * (1.0 + 1e-9), "{} above {level}", found.unreachable);
}

/// Both Riccati equations of Doyle, Glover, Khargonekar and Francis are quadratic in one unknown; at the least level the product of their solutions is
/// the level squared, which for q = 1 makes it a + sqrt(a^2 + 2), and for a = 0 sqrt(1 + q^2).
#[test]
fn the_least_level_of_scalar_plants_has_its_closed_form() {
    for a in [-30.0_f64, -1.0, 0.0, 0.3, 5.0, 1e3] {
        // Without the difference of two large numbers if a is negative.
        let level = if a < 0.0 { 2.0 / ((a * a + 2.0).sqrt() - a) } else { a + (a * a + 2.0).sqrt() };
        check_level(&scalar_level(a, 1.0), level);
    }
    for q in [1e-3_f64, 0.5, 7.0, 1e4] {
        check_level(&scalar_level(0.0, q), q.hypot(1.0));
    }
}

/// Two such plants side by side, inputs and outputs turned by a rational angle: the least level is the larger one.
#[test]
fn the_least_level_of_two_channels_is_that_of_the_worse_one() {
    let turn = rows(&[&[0.6, -0.8], &[0.8, 0.6]]);
    let A = &turn * &Mat::diag(&[-1.0, 2.0]) * turn.t();
    let none = Mat::zeros(2, 2);
    let one = Mat::eye(2);
    let B = Mat::from_blocks(&[&[&one, &none, &one]]);
    let C = Mat::from_blocks(&[&[&one], &[&none], &[&one]]);
    let D = Mat::from_blocks(&[&[&none, &none, &none], &[&none, &none, &one], &[&none, &one, &none]]);
    check_level(&generalised_plant([&A, &B, &C, &D], 2, 2), 2.0 + 6f64.sqrt());
}

#[test]
fn a_plant_in_units_over_eight_decades_stops_near_the_least_level() {
    // The least level is that of the two Riccati equations in 400 bits. Near it, rounding of the controller leaves the norm above its
    // bound, and the first bound that is kept is 0.4 per cent above the least one.
    let A = rows(&[
        &[2.5047264818749717, 0.00011994664865339436, -0.026833855386411337, -0.12250758222141372],
        &[-1268.9839291535359, 1.4451759813085951, 332.3973984109505, -817.41810909731],
        &[-4.790430430940576, 0.002794989140785037, 1.4056334916719737, -3.4913048508514],
        &[4.056241919194453, -6.238437706665957e-05, 0.35218827694328214, -2.2445962510972888],
    ]);
    let B = rows(&[
        &[-0.009723348086382524, 0.007721064682556368, 0.0, 0.007255078416986217],
        &[-38.96350580968938, -88.43011853850244, 0.0, 11.503948322745378],
        &[-0.08557713792778929, 0.008791137997828439, 0.0, -0.2866031540833367],
        &[0.07587345277538975, -0.11807953292524051, 0.0, 0.016856920291973918],
    ]);
    let C = rows(&[
        &[184.19858131379837, 0.003074843179103633, -10.546826227373145, 1.8266645457934865],
        &[101.00964817656273, -0.021128439157672863, 5.998208277845755, -5.179664030463447],
        &[0.0, 0.0, 0.0, 0.0],
        &[11.212451807909916, -0.010512852355798373, 4.379796562659649, -6.560470120073224],
    ]);
    let D = rows(&[&[0.0; 4], &[0.0; 4], &[0.0, 0.0, 0.0, 1.0], &[0.0, 0.0, 1.0, 0.0]]);
    let found = hinf(&generalised_plant([&A, &B, &C, &D], 1, 1), 1e-6);
    let level = 200278.3352591337;
    let above = found.achieved_norm / level - 1.0;
    assert!((-1e-9..5e-4).contains(&above), "{above}");
    assert!(found.achieved_norm <= found.bound * (1.0 + 1e-6) && found.unreachable <= level * (1.0 + 1e-6));
}
