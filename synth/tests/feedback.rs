//! The feedback part against closed forms, printed figures, and a cost found in the frequency domain.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, poles, response::response_at};
use counterpoise_synth::{
    DesignPlant, Feedback, FeedbackWeights, LightModes, Reference, Weight, design_feedback,
};

fn system(A: &[&[f64]], B: &[&[f64]], C: &[&[f64]]) -> StateSpace {
    let (A, B, C) = (Mat::from_rows(A), Mat::from_rows(B), Mat::from_rows(C));
    let D = Mat::zeros(C.nrows(), B.ncols());
    StateSpace::new(A, B, C, D, Timebase::Continuous).unwrap()
}

fn constant(gain: f64) -> Weight {
    Weight::Constant { gain }
}

/// A servo with one flexible mode, a sensor and a delay; inputs [control, torque], outputs [rate, tip rate].
fn servo() -> DesignPlant {
    let plant = system(
        &[&[-1.0, -3000.0, 0.5], &[1.0, 0.0, -1.0], &[0.5, 3000.0, -1.5]],
        &[&[4.0, 1.0], &[0.0, 0.0], &[0.0, 0.3]],
        &[&[1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]],
    );
    let sensor = Weight::ZeroPoleGain {
        zeros: vec![],
        poles: vec![C64::new(-260.0, 270.0), C64::new(-260.0, -270.0)],
        gain: 260.0 * 260.0 + 270.0 * 270.0,
    };
    DesignPlant {
        hub_sensor: Some(sensor.realise().unwrap()),
        delay_s: 1e-3,
        pade_order: 2,
        ..DesignPlant::ideal(plant, 0, 0)
    }
}

fn weights() -> FeedbackWeights {
    FeedbackWeights {
        error: Weight::Integral { gain: 30.0, time_s: 1.0 },
        control: Weight::Quadratic { gain: 1.0, second_s2: 1e-4, first_s: 2e-2 },
        combination: vec![],
        measurement_noise: 1e-4,
        disturbances: vec![VectorEntry::new(1, 1.0)],
        loop_recovery: 0.01,
        modes: LightModes::Kept,
    }
}

#[test]
fn the_scalar_problem_has_its_closed_form() {
    for (a, expected) in [(-1.0, 1.708203932499), (0.0, 4.0), (1.0, 11.708203932499)] {
        let plant = DesignPlant::ideal(system(&[&[a]], &[&[1.0, 1.0]], &[&[1.0]]), 0, 0);
        let weights = FeedbackWeights {
            error: constant(2.0),
            control: constant(1.0),
            combination: vec![],
            measurement_noise: 0.25,
            disturbances: vec![VectorEntry::new(1, 1.0)],
            loop_recovery: 0.0,
            modes: LightModes::Kept,
        };
        let part = design_feedback(&plant, &weights, Reference::Error).unwrap();
        for cost in [part.cost.predicted, part.cost.achieved] {
            assert!((cost.unwrap() / expected - 1.0).abs() < 1e-11, "a = {a}: {cost:?}, not {expected}");
        }
    }
}

#[test]
fn doyle_s_gain_margins_are_as_printed() {
    let table = [
        (1.0, 0.92084409, 1.05572809),
        (10.0, 0.91410230, 1.03033370),
        (100.0, 0.93807177, 1.00672078),
        (1e3, 0.97295614, 1.00088126),
        (1e4, 0.99048622, 1.00009608),
    ];
    for (q, low, high) in table {
        let plant = DesignPlant::ideal(
            system(&[&[1.0, 1.0], &[0.0, 1.0]], &[&[0.0, 1.0], &[1.0, 1.0]], &[&[1.0, 0.0]]),
            0,
            0,
        );
        // Q = q [1 1]'[1 1] is a further output, [1 1] x; the error itself is not weighed but for rounding.
        let mut plant = plant;
        plant.system.C = Mat::from_rows(&[&[1.0, 0.0], &[1.0, 1.0]]);
        plant.system.D = Mat::zeros(2, 2);
        let weights = FeedbackWeights {
            error: constant(1e-12),
            control: constant(1.0),
            combination: vec![VectorEntry::new(1, f64::sqrt(q))],
            measurement_noise: 1.0,
            disturbances: vec![VectorEntry::new(1, q)],
            loop_recovery: 0.0,
            modes: LightModes::Kept,
        };
        let part = design_feedback(&plant, &weights, Reference::Error).unwrap();
        let d = 2.0 + (4.0 + q).sqrt();
        assert!((part.F[(0, 0)] - d).abs() < 1e-9 * d && (part.L[(0, 0)] - d).abs() < 1e-9 * d);
        let edges = [(low, true), (high, false)];
        for (edge, below) in edges {
            let (inside, outside) = if below { (1e-8, -1e-8) } else { (-1e-8, 1e-8) };
            assert!(loop_is_stable(&plant, &part, edge + inside), "q = {q}, edge {edge}");
            assert!(!loop_is_stable(&plant, &part, edge + outside), "q = {q}, edge {edge}");
        }
    }
}

fn loop_is_stable(plant: &DesignPlant, part: &Feedback, gain: f64) -> bool {
    let P = plant.system.select(&[0], &[0]).scale_io(&[gain], &[1.0]).unwrap();
    let K = part.controller.select(&[0], &[1]).negate();
    let closed = counterpoise_lti::feedback(&P, &K).unwrap();
    poles(&closed).unwrap().iter().all(|pole| pole.re < 0.0)
}

#[test]
fn predicted_cost_is_the_achieved_one_with_every_kind_of_weight() {
    let errors = [
        Weight::Integral { gain: 30.0, time_s: 1.0 },
        Weight::Lag { gain: 30.0, time_s: 0.4 },
        constant(3.0),
        Weight::Shelf { low: 40.0, high: 0.5, corner_rad_s: 8.0 },
    ];
    let controls = [
        constant(1.0),
        Weight::Lead { gain: 1.0, time_s: 0.01 },
        Weight::Quadratic { gain: 1.0, second_s2: 1e-4, first_s: 2e-2 },
        Weight::QuadraticFreeAtZero { gain: 1.0, second_s2: 1e-4, first_s: 2e-2 },
    ];
    for error in &errors {
        for control in &controls {
            let weights = FeedbackWeights { error: error.clone(), control: control.clone(), ..weights() };
            let part = design_feedback(&servo(), &weights, Reference::Error).unwrap();
            let difference = part.cost.relative_difference().unwrap();
            assert!(difference < 1e-8, "{error}, {control}: {:?}", part.cost);
            assert!(part.regulator.relative_residual < 1e-10 && part.filter.relative_residual < 1e-10);
            assert!(part.closed_loop.iter().all(|pole| pole.re < 0.0));
        }
    }
}

#[test]
fn the_closed_loop_has_the_regulator_s_and_the_filter_s_poles() {
    let part = design_feedback(&servo(), &weights(), Reference::Error).unwrap();
    let expected: Vec<C64> = [part.regulator.spectrum.clone(), part.filter.spectrum.clone()].concat();
    assert_eq!(part.closed_loop.len(), expected.len());
    for pole in &part.closed_loop {
        let nearest = expected.iter().map(|other| (other - pole).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-6 * pole.norm(), "{pole} is {nearest} from the separated poles");
    }
}

#[test]
fn the_weighted_control_is_the_weight_times_the_control_that_the_controller_gives() {
    let weights = weights();
    let part = design_feedback(&servo(), &weights, Reference::Error).unwrap();
    for rate in [0.5, 20.0, 300.0] {
        let K = response_at(&part.controller, rate).unwrap();
        let (u, v) = (K[(0, 1)], K[(1, 1)]);
        let expected = u * weights.control.response(rate);
        assert!((v - expected).norm() < 1e-9 * v.norm(), "at {rate}: {v} and {expected}");
    }
}

/// The cost as an integral of the spectra over frequency: no equation of the design enters.
#[test]
fn the_cost_is_the_integral_of_the_weighted_spectra() {
    let (plant, weights) = (servo(), weights());
    let part = design_feedback(&plant, &weights, Reference::Error).unwrap();
    let seen = plant.measured_plant().unwrap().select(&[0], &[0, 1]);
    let K = part.controller.select(&[0], &[1]);
    let spectrum = |rate: f64| {
        let (G, K) = (response_at(&seen, rate).unwrap(), response_at(&K, rate).unwrap()[(0, 0)]);
        let S = C64::ONE / (C64::ONE - G[(0, 0)] * K);
        let noises = [(G[(0, 1)], 1.0), (C64::ONE, 1e-4), (G[(0, 0)], 0.01)];
        let each = noises.iter().map(|(path, density)| {
            let (y, u) = ((S * path).norm_sqr(), (S * path * K).norm_sqr());
            density
                * (weights.error.magnitude(rate).powi(2) * y + weights.control.magnitude(rate).powi(2) * u)
        });
        each.sum::<f64>()
    };
    // Trapezoids in ln(w), which converge fast; 1/(2 pi) over both signs of w.
    let (low, high, count) = (1e-5_f64.ln(), 1e6_f64.ln(), 12000);
    let step = (high - low) / f64::from(count);
    let sum: f64 = (0..=count).map(|k| (low + step * f64::from(k)).exp()).map(|w| w * spectrum(w)).sum();
    let integral = sum * step / std::f64::consts::PI;
    let predicted = part.cost.predicted.unwrap();
    assert!((integral / predicted - 1.0).abs() < 1e-4, "{integral} and {predicted}");
}

#[test]
fn integral_action_leaves_no_steady_error_even_when_the_plant_is_not_as_modelled() {
    let (plant, weights) = (servo(), weights());
    for reference in [Reference::Error, Reference::WeightOnly] {
        let part = design_feedback(&plant, &weights, reference).unwrap();
        let seen = plant.measured_plant().unwrap().select(&[0], &[0]).scale_io(&[1.2], &[1.0]).unwrap();
        let K = part.controller.select(&[0], &[0, 1]);
        let (G, K) = (response_at(&seen, 1e-6).unwrap()[(0, 0)], response_at(&K, 1e-6).unwrap());
        let closed = G * K[(0, 0)] / (C64::ONE - G * K[(0, 1)]);
        assert!((closed - C64::ONE).norm() < 1e-5, "{reference:?}: {closed}");
    }
}

#[test]
fn a_feedback_for_stiff_modes_is_that_of_the_plant_whose_modes_are_elsewhere() {
    let (plant, kept) = (servo(), weights());
    let stiffened = FeedbackWeights { modes: LightModes::Stiffened, ..kept.clone() };
    let stiff = plant.with_stiff_modes().unwrap();
    let slowest_light = |plant: &DesignPlant| {
        let light = |pole: &C64| pole.im != 0.0 && pole.re.abs() < 0.3 * pole.norm();
        poles(&plant.system)
            .unwrap()
            .into_iter()
            .filter(light)
            .map(|pole| pole.norm())
            .fold(f64::INFINITY, f64::min)
    };
    assert!(slowest_light(&plant) < 80.0 && slowest_light(&stiff).is_infinite());
    // Far below its mode the plant stays what it is.
    let [before, after] = [&plant, &stiff].map(|plant| response_at(&plant.system, 0.5).unwrap()[(0, 0)]);
    assert!((after / before - C64::ONE).norm() < 1e-2, "{before} {after}");
    let design = |plant: &DesignPlant, weights: &FeedbackWeights| {
        design_feedback(plant, weights, Reference::Error).unwrap().controller
    };
    assert_eq!(design(&plant, &stiffened), design(&stiff, &kept));
    assert_ne!(design(&plant, &stiffened), design(&plant, &kept));
}
