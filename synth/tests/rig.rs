//! The default design of the reference rig: what its weights give, on the sampled loop that runs.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{rig, thesis_weights, weights};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{Discretisation, StateSpace, c2d, margins, response::response_at};
use counterpoise_synth::{
    Design, DesignPlant, DisturbanceChannel, SampledLoop, Sampling, Specification, design, discretise,
    preflight,
};

const PERIOD_S: f64 = 1e-3;

fn design_rig(specification: &Specification) -> Design {
    design(&rig(), specification).unwrap()
}

fn discretise_design(design: &Design) -> SampledLoop {
    let sampling = Sampling { out_of_balance_kg_m: 151.67, ..Sampling::new(PERIOD_S, 10.0) };
    discretise(design, &sampling).unwrap()
}

/// True hub rate after a unit step of the demand, sample by sample.
fn step(sampled: &SampledLoop, samples: usize) -> Vec<f64> {
    let undelayed = DesignPlant { pade_order: 0, ..rig() };
    let seen = undelayed.measured_plant().unwrap().select(&[0, 1], &[0]);
    let P = c2d(&seen, PERIOD_S, Discretisation::ZeroOrderHold).unwrap();
    let K = sampled.controller.linear(0.0).unwrap().select(&[0], &[0, 1]);
    let (mut x, mut q) = (Mat::zeros(P.order(), 1), Mat::zeros(K.order(), 1));
    let mut rates = Vec::new();
    for _ in 0..samples {
        let y = &P.C * &x;
        let readings = Mat::col(&[1.0, y[(0, 0)]]);
        let u = &(&K.C * &q) + &(&K.D * &readings);
        q = &(&K.A * &q) + &(&K.B * &readings);
        x = &(&P.A * &x) + &(&P.B * &u);
        rates.push(y[(1, 0)]);
    }
    rates
}

/// |G_d + G T| / |G_d| at a frequency, T sampled, behind its sensor and the hold.
fn residual(design: &Design, channel: DisturbanceChannel, rate: f64) -> f64 {
    let plant = rig();
    let T = design.feedforward_controller(channel).unwrap();
    let T = c2d(&T, PERIOD_S, Discretisation::Tustin { prewarp_rad_s: None }).unwrap();
    let at = |system: &StateSpace| response_at(system, rate).unwrap();
    let hold = C64::new(0.0, -0.5 * rate * PERIOD_S).exp();
    let T = at(&T)[(0, 0)] * at(plant.sensor(channel).unwrap())[(0, 0)] * hold;
    let G = at(&plant.system);
    let disturbance = G[(0, plant.columns(channel)[0])];
    ((disturbance + G[(0, 0)] * T) / disturbance).norm()
}

#[test]
fn nothing_stands_in_the_way_of_the_default_weights() {
    assert_eq!(preflight(&rig(), &weights()).unwrap(), vec![]);
    assert_eq!(rig().measured_plant().unwrap().order(), 11);
}

#[test]
fn the_sampled_loop_keeps_the_margins_that_are_asked_for() {
    for specification in [weights(), thesis_weights()] {
        let sampled = discretise_design(&design_rig(&specification));
        let margins = margins(&sampled.loop_gain).unwrap();
        assert!(margins.closed_loop_stable);
        let phase = margins.phase_margin().unwrap().deg;
        assert!(margins.gain_margin_db() >= 12.0, "{} dB", margins.gain_margin_db());
        assert!(phase >= 60.0, "{phase} deg");
        assert!(margins.ms.value <= 1.5, "{}", margins.ms.value);
    }
}

#[test]
fn a_step_overshoots_less_than_thirteen_percent_and_leaves_no_error() {
    for specification in [weights(), thesis_weights()] {
        // The beam rings on at the hub-locked mode, 0.5 % damped, and the hub hardly shows it: wait until it has gone.
        let rates = step(&discretise_design(&design_rig(&specification)), 20_000);
        let peak = rates.iter().copied().fold(0.0, f64::max);
        assert!(peak > 1.05 && peak <= 1.13, "{peak}");
        assert!((rates[19_999] - 1.0).abs() < 1e-6, "{}", rates[19_999]);
    }
}

#[test]
fn predicted_and_achieved_costs_agree_and_residuals_are_small() {
    for specification in [weights(), thesis_weights()] {
        let design = design_rig(&specification);
        assert!(design.worst_cost_difference().unwrap() < 1e-6, "{:?}", design.worst_cost_difference());
        let parts = [design.heave.as_ref().unwrap(), design.pitch.as_ref().unwrap()];
        for part in parts {
            let filter = part.filter.as_ref().unwrap().relative_residual;
            let worst = part.regulator.relative_residual.max(filter).max(part.sylvester_residual);
            assert!(worst < 1e-10, "{worst}");
        }
        assert!(
            design.feedback.regulator.relative_residual.max(design.feedback.filter.relative_residual) < 1e-10
        );
    }
}

#[test]
fn the_feedforwards_leave_little_where_vehicles_move() {
    let design = design_rig(&weights());
    for (channel, limits) in
        [(DisturbanceChannel::Heave, [0.01, 0.01, 0.05]), (DisturbanceChannel::Pitch, [0.03, 0.03, 0.10])]
    {
        for (hz, limit) in [0.3, 1.0, 3.0].into_iter().zip(limits) {
            let left = residual(&design, channel, std::f64::consts::TAU * hz);
            assert!(left < limit, "{channel:?} at {hz} Hz: {left}");
        }
    }
}

/// M / (k_a N K_t): out-of-balance over the stalled drive's torque a volt, plus what the drive's back EMF and drag take.
#[test]
fn steady_heave_takes_the_volts_that_hold_the_out_of_balance() {
    let design = design_rig(&weights());
    let stalled = 30.0 / (0.8 + 30.0 * 0.3067) * 200.0 * 0.86;
    let perfect = 151.67 / stalled;
    let found = design.heave.unwrap().dc_gain;
    assert!((found / perfect - 1.0).abs() < 0.01, "{found} and {perfect}");
}

#[test]
fn heave_scales_with_the_out_of_balance_in_the_controller_that_runs() {
    let sampled = discretise_design(&design_rig(&weights()));
    let at = |out_of_balance: f64| {
        let linear = sampled.controller.linear(out_of_balance).unwrap();
        let response = response_at(&linear, 5.0).unwrap();
        (response[(0, 3)], response[(0, 2)], response[(0, 1)])
    };
    let (full, half) = (at(151.67), at(0.5 * 151.67));
    assert!((full.0 * 0.5 - half.0).norm() < 1e-12 * full.0.norm());
    assert_eq!((full.1, full.2), (half.1, half.2));
}
