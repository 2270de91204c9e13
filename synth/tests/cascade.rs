//! The cascade as it runs is a proportional loop of the position around the rate loop, written down by hand.
#![allow(non_snake_case, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::{Readings, SampledController};
use counterpoise_linalg::Mat;
use counterpoise_lti::{Discretisation, StateSpace, Timebase, c2d, margins};
use counterpoise_synth::cascade::difference_lag;
use counterpoise_synth::{
    Assembly, Circumstances, ControlLimit, DesignPlant, FeedbackWeights, LightModes, RateLoop, Reference,
    RequiredMargins, Sampling, Specification, UsualPlants, UsualReading, Weight, design, discretise,
    first_design,
};

const PERIOD_S: f64 = 1e-3;
const GAIN: f64 = 12.0;
/// Rounding of the form in which the controller runs, V. The integral takes about 1e-11 of the difference quotient's gain with the
/// position in every sample: here 1e-7 V after forty.
const ROUNDING: f64 = 1e-6;

/// An inertia with drag whose position is measured: rate' = -drag rate + gain u, position' = rate.
fn machine() -> DesignPlant {
    let (drag, gain) = (0.3, 4.0);
    let system = |A: Mat, B: Mat, C: Mat| StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous);
    let position = system(
        Mat::from_rows(&[&[0.0, 1.0], &[0.0, -drag]]),
        Mat::from_rows(&[&[0.0], &[gain]]),
        Mat::from_rows(&[&[1.0, 0.0]]),
    );
    let rate = system(Mat::from_rows(&[&[-drag]]), Mat::from_rows(&[&[gain]]), Mat::eye(1));
    let delay = |plant: DesignPlant| DesignPlant { delay_s: PERIOD_S, pade_order: 2, ..plant };
    let inner = DesignPlant {
        hub_sensor: Some(difference_lag(PERIOD_S).unwrap()),
        ..delay(DesignPlant::ideal(rate.unwrap(), 0, 0))
    };
    let rate_loop = Some(Box::new(RateLoop { plant: inner, period_s: PERIOD_S }));
    DesignPlant { rate_loop, ..delay(DesignPlant::ideal(position.unwrap(), 0, 0)) }
}

fn specification() -> Specification {
    Specification {
        feedback: FeedbackWeights {
            error: Weight::ZeroPoleGain {
                zeros: vec![counterpoise_linalg::C64::new(-8.0, 0.0)],
                poles: vec![counterpoise_linalg::C64::ZERO],
                gain: 15.0,
            },
            control: Weight::Lead { gain: 1.0, time_s: 0.004 },
            combination: Vec::new(),
            measurement_noise: 1e-8,
            disturbances: Vec::new(),
            loop_recovery: 1e-4,
            modes: LightModes::Kept,
        },
        heave: None,
        pitch: None,
        assembly: Assembly::SimpleAdd,
        reference: Reference::Error,
        position_gain: Some(GAIN),
    }
}

#[test]
fn the_controller_that_runs_is_the_two_loops_written_by_hand() {
    let designed = design(&machine(), &specification()).unwrap();
    let sampled = discretise(&designed, &Sampling::new(PERIOD_S, 10.0)).unwrap();
    assert!(margins(&sampled.loop_gain).unwrap().closed_loop_stable);
    let tustin = Discretisation::Tustin { prewarp_rad_s: None };
    let inner = c2d(&designed.feedback.controller.select(&[0], &[0, 1]), PERIOD_S, tustin).unwrap();
    let mut runner = sampled.controller.runner();
    let (mut x, mut before) = (Mat::zeros(inner.order(), 1), 0.0);
    for k in 0..80 {
        // small enough that the limiter stays open
        let demand = 1e-3 * (0.02 * f64::from(k)).sin();
        let position = 8e-4 * (0.02 * f64::from(k) - 0.3).sin() + 8e-4 * 0.3f64.sin();
        let seen = Mat::col(&[GAIN * (demand - position), (position - before) / PERIOD_S]);
        let by_hand = (&(&inner.C * &x) + &(&inner.D * &seen))[(0, 0)];
        x = &(&inner.A * &x) + &(&inner.B * &seen);
        before = position;
        let readings = Readings { demand_rad_s: demand, hub_rate_rad_s: position, ..Readings::default() };
        let control = runner.step(&readings);
        assert!((control - by_hand).abs() < ROUNDING, "sample {k}: {control} and {by_hand}");
        assert!(control.abs() < 9.0, "the limiter acts: {control}");
    }
}

#[test]
fn a_cascade_without_the_gain_of_its_position_loop_is_refused() {
    let without = Specification { position_gain: None, ..specification() };
    let error = design(&machine(), &without).unwrap_err().to_string();
    assert!(error.contains("gain of the position loop"), "{error}");
}

#[test]
fn a_first_design_chooses_both_loops_and_the_whole_keeps_the_margins() {
    let sampling = Sampling { delay_samples: 1, ..Sampling::new(PERIOD_S, 10.0) };
    let given = Circumstances {
        plant: machine(),
        others: Vec::new(),
        within_tolerances: Vec::new(),
        known_absent: Vec::new(),
        usual: UsualPlants::default(),
        usual_reading: UsualReading::default(),
        load_output: None,
        sampling: sampling.clone(),
        control_limit: ControlLimit::OfDrive,
        noise_rms: 1e-6,
        reading_step: 0.0,
        holding_v: 0.0,
        demand_step: 1e-3,
        margins: RequiredMargins::default(),
        may_stiffen_modes: true,
        position_gain: None,
        asked_rad_s: None,
        heave: None,
        pitch: None,
    };
    let found = first_design(&given).unwrap();
    let gain = found.specification.position_gain.unwrap();
    assert!(gain > 0.1 * found.bandwidth.bandwidth_rad_s && gain < 0.4 * found.bandwidth.bandwidth_rad_s);
    let sampled = discretise(&design(&given.plant, &found.specification).unwrap(), &sampling).unwrap();
    let whole = margins(&sampled.loop_gain).unwrap();
    assert!(whole.closed_loop_stable && whole.gain_margin_db() >= 6.0 - 1e-3, "{whole:?}");
    assert!(whole.ms.value <= 1.7 * 1.001, "{whole:?}");
    let asked = first_design(&Circumstances { position_gain: Some(2.0), ..given }).unwrap();
    assert_eq!(asked.specification.position_gain, Some(2.0));
}
