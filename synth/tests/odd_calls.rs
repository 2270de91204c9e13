//! Odd plants, weights and numbers never make a synthesis panic: without states, inputs or outputs, of any scale, of shapes that do not
//! fit, with indices beyond the plant and with entries that are not finite.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;
use crate::odd::{Call, assert_none_panics, judge, next_uniform, odd_matrix, odd_number, panicking, size};
use counterpoise_linalg::sparse::VectorEntry;

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_synth::*;

fn system(state: &mut u64) -> StateSpace {
    let (n, m, p) = (size(state, 5.0), size(state, 5.0), size(state, 5.0));
    let timebase =
        if size(state, 6.0) > 0 { Timebase::Continuous } else { Timebase::Discrete { period_s: 0.1 } };
    let (A, B) = (odd_matrix(state, n, n), odd_matrix(state, n, m));
    let D = if size(state, 2.0) == 0 { odd_matrix(state, p, m) } else { Mat::zeros(p, m) };
    let mut g = StateSpace::new(A, B, odd_matrix(state, p, n), D, timebase).unwrap();
    // The matrices are public: a caller may write what the constructor refuses.
    if n * m > 0 && next_uniform(state) < 0.1 {
        g.B[(n - 1, 0)] = if next_uniform(state) < 0.5 { f64::NAN } else { f64::INFINITY };
    }
    g
}

fn weight(state: &mut u64) -> Weight {
    let (x, y, z) = (odd_number(state), odd_number(state), odd_number(state));
    match size(state, 6.0) {
        0 => Weight::Constant { gain: x },
        1 => Weight::Integral { gain: x, time_s: y },
        2 => Weight::Lag { gain: x, time_s: y },
        3 => Weight::Quadratic { gain: x, second_s2: y, first_s: z },
        4 => Weight::Lead { gain: x, time_s: y },
        _ => Weight::ZeroPoleGain { zeros: vec![C64::new(x, 0.0)], poles: vec![C64::new(y, z)], gain: 1.0 },
    }
}

/// The reference rig, or an odd plant in its place.
fn plant(state: &mut u64, rig: &DesignPlant) -> DesignPlant {
    let base = if size(state, 2.0) == 0 {
        rig.clone()
    } else {
        let g = system(state);
        let (control, rate) = (size(state, 4.0), size(state, 4.0));
        DesignPlant::ideal(g, control, rate)
    };
    let sensor = if size(state, 4.0) == 0 { Some(system(state)) } else { None };
    let pade_order = size(state, 4.0);
    let heave = vec![size(state, 9.0)];
    match size(state, 4.0) {
        0 => DesignPlant { delay_s: odd_number(state), pade_order, ..base },
        1 => DesignPlant { heave, hub_sensor: sensor, ..base },
        2 => DesignPlant { control: size(state, 9.0), rate: size(state, 9.0), ..base },
        _ => base,
    }
}

fn specification(state: &mut u64) -> Specification {
    let mut made = common::weights();
    let number = odd_number(state);
    match size(state, 8.0) {
        0 => made.feedback.error = weight(state),
        1 => made.feedback.control = weight(state),
        2 => made.feedback.measurement_noise = number,
        3 => made.feedback.loop_recovery = number,
        4 => made.feedback.combination = vec![VectorEntry::new(size(state, 9.0), number)],
        5 => made.heave.as_mut().unwrap().generator = weight(state),
        6 => made.pitch.as_mut().unwrap().error = weight(state),
        _ => made.feedback.disturbances = vec![VectorEntry::new(size(state, 9.0), number)],
    }
    made.assembly = [Assembly::SimpleAdd, Assembly::Grimble, Assembly::Joint][size(state, 3.0)];
    made
}

/// Synthesis from matrices.
fn from_matrices(seed: u64) -> Vec<&'static str> {
    let mut state = seed;
    let (g, h) = (system(&mut state), system(&mut state));
    let (controls, measurements) = (size(&mut state, 4.0), size(&mut state, 4.0));
    let generalised = GeneralisedPlant::new(g.clone(), controls, measurements).ok();
    let (x, y) = (odd_number(&mut state), odd_number(&mut state));
    let square = |S: &Mat| S * &S.t();
    let (Q, R) = (square(&g.A), square(&h.D));
    let w = weight(&mut state);
    let table = [[x, y], [1.0, x], [2.0, 3.0], [5.0, 1.0]].map(TablePoint::from);
    let calls: Vec<Call> = vec![
        ("h2syn", Box::new(|| judge(generalised.as_ref().map(h2syn)))),
        ("hinfsyn", Box::new(|| judge(generalised.as_ref().map(|plant| hinfsyn(plant, 1e-3))))),
        ("hinfsyn of any tolerance", Box::new(|| judge(generalised.as_ref().map(|plant| hinfsyn(plant, x))))),
        ("lqr", Box::new(|| judge(lqr(&g, &Q, &R, Some(&g.B))))),
        ("kalman", Box::new(|| judge(kalman(&g, &Q, &R)))),
        ("observer_controller", Box::new(|| judge(observer_controller(&g, &h.C, &h.B)))),
        ("lqg_ltr", Box::new(|| judge(lqg_ltr(&g, &h, x, y)))),
        ("Rational", Box::new(|| judge(w.rational().realise()))),
        ("Weight", Box::new(|| drop((w.realise(), w.realise_inverse(), w.magnitude(x), w.shape())))),
        ("fit_table", Box::new(|| judge(fit_table(&table, controls)))),
        ("of no table", Box::new(|| judge(fit_table(&[], measurements)))),
        (
            "of_blocks",
            Box::new(|| {
                judge(
                    generalised
                        .clone()
                        .map(|plant| plant.of_blocks(vec![StateOrigin::new("plant", controls)])),
                )
            }),
        ),
    ];
    panicking(&calls)
}

/// Designs from plants and weights.
fn from_plants(seed: u64, rig: &DesignPlant) -> Vec<&'static str> {
    let mut state = seed;
    let (plant, weights) = (plant(&mut state, rig), specification(&mut state));
    let sampling = Sampling::new(odd_number(&mut state), odd_number(&mut state));
    let calls: Vec<Call> = vec![
        // Its answer is a list of refusals, which quote the numbers that they refuse.
        ("preflight", Box::new(|| drop(preflight(&plant, &weights)))),
        ("feedback", Box::new(|| judge(design_feedback(&plant, &weights.feedback, weights.reference)))),
        (
            "feedforward",
            Box::new(|| {
                judge(
                    weights.heave.as_ref().map(|w| design_feedforward(&plant, w, DisturbanceChannel::Heave)),
                )
            }),
        ),
        ("design", Box::new(|| judge(design(&plant, &weights).map(|made| discretise(&made, &sampling))))),
        ("sampled_plant", Box::new(|| judge(sampled_plant(&plant, &sampling)))),
    ];
    panicking(&calls)
}

#[test]
fn no_odd_synthesis_panics() {
    let rig = common::rig();
    assert_none_panics(1200, &from_matrices);
    assert_none_panics(250, &|seed| from_plants(seed, &rig));
}
