//! The design in sampled time: costs that are kept, the continuous design as its limit, and what it is good for.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{rig, weights};
use counterpoise_lti::{StateSpace, response_at};
use counterpoise_synth::*;

/// The rig without design delay: hold and whole samples are the sampled problem's own.
fn design_rig(specification: &Specification) -> Design {
    let plant = DesignPlant { pade_order: 0, ..rig() };
    design(&plant, specification).unwrap()
}

fn sampling(period_s: f64, delay_samples: usize, method: SamplingMethod) -> Sampling {
    Sampling { method, delay_samples, ..Sampling::new(period_s, 10.0) }
}

fn discretise_with(design: &Design, sampling: &Sampling) -> SampledLoop {
    discretise(design, sampling).unwrap()
}

/// Of the assembled loop of sampled plant and controller, inter-sample cost included; several weights, delays and periods.
#[test]
fn the_sampled_loop_costs_what_the_equations_predict() {
    for (name, specification) in variants() {
        let design = design_rig(&specification);
        for (period_s, delay) in [(1e-3, 0), (1e-3, 1), (1e-3, 2), (5e-3, 0), (2e-2, 1)] {
            let made = discretise_with(&design, &sampling(period_s, delay, SamplingMethod::SampledData));
            assert_eq!(made.certified.len(), 3);
            for part in &made.certified {
                let difference = part.cost.relative_difference();
                assert!(difference.is_some_and(|d| d < 1e-8), "{name} {period_s} {delay} {part:?}");
                assert!(part.regulator.relative_residual < 1e-9, "{part:?}");
                assert!(part.filter.as_ref().is_some_and(|f| f.relative_residual < 1e-9), "{part:?}");
            }
        }
    }
}

fn variants() -> Vec<(&'static str, Specification)> {
    let base = weights();
    let mut lag = base.clone();
    lag.feedback.error = Weight::Lag { gain: 300.0, time_s: 0.5 };
    lag.reference = Reference::WeightOnly;
    let mut level = base.clone();
    level.feedback.error = Weight::Constant { gain: 60.0 };
    let mut grimble = base.clone();
    grimble.assembly = Assembly::Grimble;
    let mut closed = base.clone();
    closed.heave.as_mut().unwrap().basis = FeedforwardBasis::ClosedLoop;
    closed.pitch.as_mut().unwrap().error = Weight::Lag { gain: 300.0, time_s: 0.1 };
    vec![("integral", base), ("lag", lag), ("constant", level), ("grimble", grimble), ("closed", closed)]
}

/// Relative distance of the three sampled parts from the continuous ones at 20 rad/s.
fn distances(design: &Design, made: &SampledLoop) -> [f64; 3] {
    let (rate, linear) = (20.0, made.controller.linear(0.0).unwrap());
    let continuous = |system: StateSpace, input: usize| response_at(&system, rate).unwrap()[(0, input)];
    let forward = |channel| continuous(design.feedforward_controller(channel).unwrap(), 0);
    let wanted = [
        (continuous(design.feedback_controller(), 1), 1),
        (forward(DisturbanceChannel::Heave), 3),
        (forward(DisturbanceChannel::Pitch), 2),
    ];
    wanted.map(|(wanted, reading)| {
        let found = response_at(&linear.select(&[0], &[reading]), rate).unwrap()[(0, 0)];
        (found - wanted).norm() / wanted.norm()
    })
}

/// As the period falls the hold's half sample is what is left of the controllers' difference: order 1. The feedforwards know
/// the motion ahead by its spectrum, and lose of the order of the period's square.
#[test]
fn the_design_tends_to_the_continuous_one() {
    let design = design_rig(&weights());
    let costs =
        [design.feedback.cost, design.heave.as_ref().unwrap().cost, design.pitch.as_ref().unwrap().cost];
    let at = |period_s: f64| {
        let made = discretise_with(&design, &sampling(period_s, 0, SamplingMethod::SampledData));
        let lost = std::array::from_fn(|i| {
            let (found, limit): (f64, f64) =
                (made.certified[i].cost.achieved.unwrap(), costs[i].achieved.unwrap());
            found / limit - 1.0
        });
        (distances(&design, &made), lost)
    };
    let periods = [1e-3, 5e-4, 2.5e-4];
    let found: Vec<([f64; 3], [f64; 3])> = periods.iter().map(|&period_s| at(period_s)).collect();
    for pair in found.windows(2) {
        for part in 0..3 {
            let order = (pair[0].0[part] / pair[1].0[part]).log2();
            assert!((order - 1.0).abs() < 0.1, "part {part}: order {order} of {found:?}");
        }
        for part in 1..3 {
            let order = (pair[0].1[part] / pair[1].1[part]).log2();
            assert!((order - 2.0).abs() < 0.1, "part {part}: order {order} of {found:?}");
        }
    }
    assert!(found[0].0.iter().all(|distance| *distance < 0.011), "{found:?}");
    assert!(found[0].1[0].abs() < 0.006 && found[2].1[0].abs() < 0.002, "{found:?}");
}

fn feedback_alone(period_s: f64) -> Design {
    let specification = Specification { heave: None, pitch: None, ..weights() };
    let plant = DesignPlant { delay_s: period_s, ..rig() };
    design(&plant, &specification).unwrap()
}

/// At 1 kHz conversion and sampled problem agree; at 100 Hz the converted controller does not hold the loop, at 33 Hz still
/// less, and the sampled design keeps its margins.
#[test]
fn at_a_coarse_period_the_design_holds_where_conversion_does_not() {
    let of = |period_s: f64, method: SamplingMethod| {
        let design = feedback_alone(period_s);
        let sampling = sampling(period_s, 0, method);
        let solved = discretise(&design, &sampling).ok();
        solved.map(|made| sampled_loop_figures(&design.plant, &made, &sampling, [1.26, 12.6]).unwrap())
    };
    let fine = [SamplingMethod::TUSTIN, SamplingMethod::SampledData].map(|method| of(1e-3, method).unwrap());
    println!("{fine:?}");
    assert!((fine[0].gain_margin_db - fine[1].gain_margin_db).abs() < 1.5, "{fine:?}");
    assert!((fine[0].phase_margin_deg - fine[1].phase_margin_deg).abs() < 2.0, "{fine:?}");
    assert!((fine[0].rejection / fine[1].rejection - 1.0).abs() < 0.03, "{fine:?}");
    for period_s in [1e-2, 2e-2, 3e-2] {
        assert!(of(period_s, SamplingMethod::TUSTIN).is_none(), "{period_s}");
        let held = of(period_s, SamplingMethod::SampledData).unwrap();
        assert!(held.gain_margin_db > 9.0 && held.phase_margin_deg > 45.0, "{period_s}: {held:?}");
    }
}

/// A feedback of another method has no sampled problem: it is converted.
#[test]
fn a_feedback_from_elsewhere_is_converted() {
    let mut design = feedback_alone(1e-3);
    design.substitute = Some(design.feedback_controller());
    let made = |method| discretise_with(&design, &sampling(1e-3, 0, method));
    assert_eq!(made(SamplingMethod::SampledData).controller, made(SamplingMethod::TUSTIN).controller);
}
