//! The feedforward part against a Wiener-Hopf solution of its own, its limits, and its linearity.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, poles, response::response_at};
use counterpoise_synth::{
    DesignPlant, DisturbanceChannel, DisturbanceKnowledge, FeedforwardBasis, FeedforwardWeights, Weight,
    design_feedforward,
};
use rustfft::num_complex::Complex;

/// A damped servo with one flexible mode; inputs [control, heave, pitch, pitch'], output the rate.
fn plant(out_of_balance: f64) -> DesignPlant {
    let A = Mat::from_rows(&[&[-1.0, -300.0, 0.5], &[1.0, 0.0, -1.0], &[0.5, 300.0, -1.5]]);
    let B = Mat::from_rows(&[
        &[4.0, -0.8 * out_of_balance, 1.0, -0.1],
        &[0.0; 4],
        &[0.0, -0.1 * out_of_balance, 0.0, 0.0],
    ]);
    let system =
        StateSpace::new(A, B, Mat::row(&[1.0, 0.0, 0.0]), Mat::zeros(1, 4), Timebase::Continuous).unwrap();
    DesignPlant { heave: vec![1], pitch: vec![2, 3], ..DesignPlant::ideal(system, 0, 0) }
}

fn weights(knowledge: DisturbanceKnowledge) -> FeedforwardWeights {
    FeedforwardWeights {
        error: Weight::Constant { gain: 20.0 },
        control: Weight::Quadratic { gain: 0.1, second_s2: 1e-3, first_s: 4e-2 },
        generator: Weight::Lag { gain: 2.0, time_s: 0.3 },
        knowledge,
        output: None,
        basis: FeedforwardBasis::OpenLoop,
    }
}

fn fft(data: &mut [Complex<f64>], inverse: bool) {
    let mut planner = rustfft::FftPlanner::new();
    if inverse { planner.plan_fft_inverse(data.len()) } else { planner.plan_fft_forward(data.len()) }
        .process(data);
}

/// Frequencies of the points z on the unit circle under s = c (1 - z)/(1 + z): the causal part in s is the causal part
/// in powers of z.
fn circle(count: usize, c: f64) -> Vec<f64> {
    (0..count).map(|k| -c * (std::f64::consts::PI * (k as f64 + 0.5) / count as f64).tan()).collect()
}

/// The powers of z from 0 on of a function given at z_k = exp(2 pi j (k + 1/2)/N): the half step keeps away from z = -1,
/// which is s at infinity.
fn powers(values: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let count = values.len() as f64;
    let mut data = values.to_vec();
    fft(&mut data, false);
    data.truncate(values.len() / 2);
    let turn = |m: usize| Complex::from_polar(1.0 / count, -std::f64::consts::PI * m as f64 / count);
    data.iter().enumerate().map(|(m, value)| value * turn(m)).collect()
}

/// The function with the given powers of z at the same points.
fn values(powers: &[Complex<f64>], count: usize) -> Vec<Complex<f64>> {
    let turn = |m: usize| Complex::from_polar(1.0, std::f64::consts::PI * m as f64 / count as f64);
    let mut data: Vec<Complex<f64>> = powers.iter().enumerate().map(|(m, power)| power * turn(m)).collect();
    data.resize(count, Complex::new(0.0, 0.0));
    fft(&mut data, true);
    data
}

/// The stable part of a function that vanishes at infinity: its powers of z, less what they leave at z = -1.
fn causal(function: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mut powers = powers(function);
    let sign = |m: usize| if m.is_multiple_of(2) { 1.0 } else { -1.0 };
    let far: Complex<f64> = powers.iter().enumerate().map(|(m, power)| power * sign(m)).sum();
    powers[0] -= far;
    values(&powers, function.len())
}

/// exp of the causal half of the logarithm of a power spectrum.
fn minimum_phase(logarithms: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mut powers = powers(logarithms);
    powers[0] *= 0.5;
    values(&powers, logarithms.len()).iter().map(|value| value.exp()).collect()
}

/// T = - 1/(D W) { G* |Hq|^2 Gd W / D* }_+ with D*D = |Hq|^2 |G|^2 + |Hr|^2, all on the circle by FFT: D by the
/// cepstrum (after the known factor (1 + s/c)^2 of its growth is taken out), the causal part by its powers of z.
fn wiener_hopf(
    plant: &DesignPlant,
    weights: &FeedforwardWeights,
    rates: &[f64],
    c: f64,
) -> Vec<Complex<f64>> {
    let value = |z: C64| Complex::new(z.re, z.im);
    let at = |input: usize, rate: f64| value(response_at(&plant.system, rate).unwrap()[(0, input)]);
    let growth = |rate: f64| Complex::new(1.0, rate / c).powi(2);
    let logarithms: Vec<Complex<f64>> = rates
        .iter()
        .map(|&rate| {
            let power = (weights.error.magnitude(rate) * at(0, rate).norm()).powi(2)
                + weights.control.magnitude(rate).powi(2);
            Complex::new((power / growth(rate).norm_sqr()).ln(), 0.0)
        })
        .collect();
    let D: Vec<Complex<f64>> =
        minimum_phase(&logarithms).iter().zip(rates).map(|(value, &rate)| value * growth(rate)).collect();
    let W: Vec<Complex<f64>> = rates.iter().map(|&rate| value(weights.generator.response(rate))).collect();
    let inside: Vec<Complex<f64>> = (0..rates.len())
        .map(|k| {
            let rate = rates[k];
            at(0, rate).conj() * weights.error.magnitude(rate).powi(2) * at(1, rate) * W[k] / D[k].conj()
        })
        .collect();
    causal(&inside).iter().zip(&D).zip(&W).map(|((value, D), W)| -value / (D * W)).collect()
}

#[test]
fn the_module_is_the_wiener_hopf_solution() {
    let (plant, weights) = (plant(1.0), weights(DisturbanceKnowledge::Exact));
    let part = design_feedforward(&plant, &weights, DisturbanceChannel::Heave).unwrap();
    let c = 20.0;
    let rates = circle(1 << 14, c);
    let expected = wiener_hopf(&plant, &weights, &rates, c);
    let largest = expected.iter().map(|value| value.norm()).fold(0.0, f64::max);
    for k in (0..rates.len()).step_by(37).filter(|&k| rates[k].abs() < 1e4) {
        let found = response_at(&part.module, rates[k]).unwrap()[(0, 0)];
        let difference = (Complex::new(found.re, found.im) - expected[k]).norm();
        assert!(difference < 1e-9 * largest, "at {} rad/s: {found} and {}", rates[k], expected[k]);
    }
}

#[test]
fn predicted_cost_is_the_achieved_one() {
    let sensor = Weight::ZeroPoleGain {
        zeros: vec![],
        poles: vec![C64::new(-50.0, 60.0), C64::new(-50.0, -60.0)],
        gain: 6100.0,
    };
    for knowledge in [DisturbanceKnowledge::Exact, DisturbanceKnowledge::Measured { noise: 1e-3 }] {
        let mut plant = plant(1.0);
        plant.heave_sensor = Some(sensor.realise().unwrap());
        let part = design_feedforward(&plant, &weights(knowledge), DisturbanceChannel::Heave).unwrap();
        assert!(part.cost.relative_difference().unwrap() < 1e-9, "{knowledge:?}: {:?}", part.cost);
        assert!(part.sylvester_residual < 1e-12);
        assert!(poles(&part.module).unwrap().iter().all(|pole| pole.re < 0.0));
    }
}

#[test]
fn less_noise_costs_less_and_exact_knowledge_least() {
    let cost = |knowledge| {
        let part = design_feedforward(&plant(1.0), &weights(knowledge), DisturbanceChannel::Heave).unwrap();
        part.cost.predicted.unwrap()
    };
    let exact = cost(DisturbanceKnowledge::Exact);
    let noisy: Vec<f64> =
        [1e-9, 1e-3, 1.0, 1e6].map(|noise| cost(DisturbanceKnowledge::Measured { noise })).to_vec();
    assert!(
        exact < noisy[0] && noisy[0] < noisy[1] && noisy[1] < noisy[2] && noisy[2] < noisy[3],
        "{exact} {noisy:?}"
    );
    assert!((noisy[0] / exact - 1.0).abs() < 1e-2, "{exact} {noisy:?}");
}

#[test]
fn pitch_uses_the_derivative_through_a_smooth_generator() {
    let generator = Weight::ZeroPoleGain {
        zeros: vec![],
        poles: vec![C64::new(-3.0, 4.0), C64::new(-3.0, -4.0)],
        gain: 10.0,
    };
    let free = Weight::QuadraticFreeAtZero { gain: 0.1, second_s2: 1e-3, first_s: 4e-2 };
    let weights = FeedforwardWeights {
        generator,
        control: free,
        ..weights(DisturbanceKnowledge::Measured { noise: 1e-4 })
    };
    let part = design_feedforward(&plant(1.0), &weights, DisturbanceChannel::Pitch).unwrap();
    assert!(part.cost.relative_difference().unwrap() < 1e-9, "{:?}", part.cost);
    // Steady control is free, so drag is cancelled, but for what filter and generator make of a signal that lasts.
    let at = |input: usize| response_at(&plant(1.0).system, 0.0).unwrap()[(0, input)].re;
    let perfect = -at(2) / at(0);
    assert!((part.dc_gain / perfect - 1.0).abs() < 0.02, "{} and {perfect}", part.dc_gain);
    let exact = FeedforwardWeights { knowledge: DisturbanceKnowledge::Exact, ..weights };
    let part = design_feedforward(&plant(1.0), &exact, DisturbanceChannel::Pitch).unwrap();
    assert!(part.cost.relative_difference().unwrap() < 1e-9, "{:?}", part.cost);
    assert!((part.dc_gain / perfect - 1.0).abs() < 2e-3, "{} and {perfect}", part.dc_gain);
}

#[test]
fn steady_heave_is_held_exactly_as_the_control_weight_goes_to_zero() {
    let at = |input: usize| response_at(&plant(1.0).system, 0.0).unwrap()[(0, input)].re;
    let perfect = -at(1) / at(0);
    let mut last = f64::INFINITY;
    for gain in [1.0, 1e-1, 1e-2, 1e-3, 1e-4] {
        let control = Weight::Quadratic { gain, second_s2: 1e-3, first_s: 4e-2 };
        let weights = FeedforwardWeights { control, ..weights(DisturbanceKnowledge::Exact) };
        let part = design_feedforward(&plant(1.0), &weights, DisturbanceChannel::Heave).unwrap();
        let difference = (part.dc_gain / perfect - 1.0).abs();
        assert!(difference < last, "{gain}: {difference} after {last}");
        last = difference;
    }
    assert!(last < 2e-5, "{last}");
}

#[test]
fn the_module_is_linear_in_the_out_of_balance() {
    for knowledge in [DisturbanceKnowledge::Exact, DisturbanceKnowledge::Measured { noise: 1e-3 }] {
        let part =
            |m: f64| design_feedforward(&plant(m), &weights(knowledge), DisturbanceChannel::Heave).unwrap();
        let (one, half) = (part(1.0), part(0.37));
        for rate in [0.0, 1.0, 10.0, 100.0] {
            let (a, b) = (
                response_at(&one.module, rate).unwrap()[(0, 0)],
                response_at(&half.module, rate).unwrap()[(0, 0)],
            );
            assert!((a * 0.37 - b).norm() < 1e-12 * a.norm(), "at {rate}: {a} {b}");
        }
    }
}

#[test]
fn a_disturbance_that_reaches_the_rate_directly_is_opposed_too() {
    // A rotor on a rigid transmission: the base drags a part of its motion along.
    let mut plant = plant(1.0);
    plant.system.D[(0, 1)] = 0.3;
    let weights = weights(DisturbanceKnowledge::Exact);
    let part = design_feedforward(&plant, &weights, DisturbanceChannel::Heave).unwrap();
    let c = 20.0;
    let rates = circle(1 << 14, c);
    let expected = wiener_hopf(&plant, &weights, &rates, c);
    let largest = expected.iter().map(|value| value.norm()).fold(0.0, f64::max);
    for k in (0..rates.len()).step_by(37).filter(|&k| rates[k].abs() < 30.0) {
        let found = response_at(&part.module, rates[k]).unwrap()[(0, 0)];
        let difference = (Complex::new(found.re, found.im) - expected[k]).norm();
        assert!(difference < 0.02 * largest, "at {} rad/s: {found} and {}", rates[k], expected[k]);
    }
}
