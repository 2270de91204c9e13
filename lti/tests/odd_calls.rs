//! Odd systems never make a routine panic: without states, inputs or outputs, of any scale, with singular or improper parts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::odd::{Call, assert_none_panics, judge, next_uniform, odd_matrix, odd_number, panicking};

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::*;

fn system(state: &mut u64) -> StateSpace {
    let mut size = |most: f64| (next_uniform(state) * most) as usize;
    let (n, m, p) = (size(5.0), size(3.0), size(3.0));
    let timebase = if size(2.0) == 0 { Timebase::Continuous } else { Timebase::Discrete { period_s: 0.1 } };
    let (A, B) = (odd_matrix(state, n, n), odd_matrix(state, n, m));
    let (C, D) = (odd_matrix(state, p, n), odd_matrix(state, p, m));
    let mut system = StateSpace::new(A, B, C, D, timebase).unwrap();
    // The matrices are public: a caller may write what the constructor refuses.
    if n * m > 0 && next_uniform(state) < 0.1 {
        system.A[(0, n - 1)] = if next_uniform(state) < 0.5 { f64::NAN } else { f64::INFINITY };
    }
    system
}

/// Delays, margins of several loops, placement, sampled costs and named blocks, with odd arguments.
fn further_calls<'a>(g: &'a StateSpace, h: &'a StateSpace, E: &'a Mat, x: f64, y: f64) -> Vec<Call<'a>> {
    let wanted = vec![C64::new(x, y), C64::new(x, -y), C64::new(-1.0, 0.0)];
    let roots = wanted.clone();
    let cost = move || QuadraticCost { Q: E, R: &h.D, S: &g.B };
    vec![
        ("c2d_delayed", Box::new(move || judge(c2d_delayed(g, x, y)))),
        (
            "c2d of any period",
            Box::new(move || judge(c2d(g, x, Discretisation::Tustin { prewarp_rad_s: Some(y) }))),
        ),
        ("margins_with_delay", Box::new(move || judge(margins_with_delay(g, x.clamp(-1.0, 0.03))))),
        ("multiloop_margins", Box::new(move || judge(multiloop_margins(g)))),
        ("place", Box::new(move || judge(place(&g.A, &g.B, &wanted)))),
        ("pade", Box::new(move || judge(pade(x, 3)))),
        ("delay_samples", Box::new(move || judge(delay_samples(3, x)))),
        ("sampled_cost", Box::new(move || judge(sampled_cost(&g.A, &g.B, cost(), x)))),
        ("response_at", Box::new(move || judge(response_at(g, x)))),
        ("frequency_response", Box::new(move || judge(frequency_response(g, &[x, y])))),
        ("frequency_response of no rates", Box::new(move || judge(frequency_response(g, &[])))),
        ("linfnorm of any tolerance", Box::new(move || judge(linfnorm(g, x)))),
        ("ctrb_gramian", Box::new(move || judge(ctrb_gramian(g)))),
        ("obsv_gramian", Box::new(move || judge(obsv_gramian(g)))),
        ("ctrb_factor", Box::new(move || judge(ctrb_factor(g)))),
        ("obsv_factor", Box::new(move || judge(obsv_factor(g)))),
        (
            "Zpk",
            Box::new(move || {
                judge(
                    Zpk { zeros: vec![], poles: roots.clone(), gain: y, timebase: g.timebase }
                        .to_state_space(),
                )
            }),
        ),
        (
            "TransferFunction",
            Box::new(move || {
                judge(TransferFunction::new(&[x, y], &[y, x, 1.0], g.timebase).map(|t| t.to_state_space()))
            }),
        ),
        (
            "Named",
            Box::new(move || {
                judge(
                    NamedSystem::new(g.clone(), &["u"], &["y"])
                        .map(|block| connect(&[block], &["u", "r"], &["y"])),
                )
            }),
        ),
        ("lsim", Box::new(move || judge(lsim(g, &h.B, Some(&[x]))))),
        ("step of any time", Box::new(move || judge(step(g, x, 0)))),
        ("scale_io", Box::new(move || judge(g.scale_io(&[x], &[y])))),
        (
            "Descriptor",
            Box::new(move || judge(Descriptor::new(h.A.clone(), g.clone()).map(|d| d.to_state_space()))),
        ),
    ]
}

/// Calls every routine; the names of those that panic.
fn call_all(seed: u64) -> Vec<&'static str> {
    let mut state = seed;
    let (g, h) = (system(&mut state), system(&mut state));
    let E = odd_matrix(&mut state, g.order(), g.order());
    let (x, y) = (odd_number(&mut state), odd_number(&mut state));
    let mut calls: Vec<Call> = vec![
        ("poles", Box::new(|| judge(poles(&g)))),
        ("zeros", Box::new(|| judge(zeros(&g)))),
        ("is_stable", Box::new(|| judge(is_stable(&g)))),
        ("poles_on_boundary", Box::new(|| judge(poles_on_boundary(&g)))),
        ("h2norm", Box::new(|| judge(h2norm(&g)))),
        ("linfnorm", Box::new(|| judge(linfnorm(&g, 1e-8)))),
        ("linfnorm_bounds", Box::new(|| judge(linfnorm_bounds(&g, 1e-8)))),
        ("hinfnorm", Box::new(|| judge(hinfnorm(&g, 1e-8)))),
        ("hankel_values", Box::new(|| judge(hankel_values(&g)))),
        ("hankelnorm", Box::new(|| judge(hankelnorm(&g)))),
        ("gramian_factors", Box::new(|| judge(gramian_factors(&g)))),
        ("margins", Box::new(|| judge(margins(&g)))),
        ("dcgain", Box::new(|| judge(dcgain(&g)))),
        ("sigma", Box::new(|| judge(sigma(&g, &[0.0, 1.0, 1e9])))),
        ("Zpk::of", Box::new(|| judge(Zpk::of(&g)))),
        ("TransferFunction::of", Box::new(|| judge(TransferFunction::of(&g)))),
        ("series", Box::new(|| judge(series(&g, &h)))),
        ("parallel", Box::new(|| judge(parallel(&g, &h)))),
        ("feedback", Box::new(|| judge(feedback(&g, &h)))),
        ("append", Box::new(|| judge(append(&g, &h)))),
        ("lft", Box::new(|| judge(lft(&g, &h)))),
        ("inverse", Box::new(|| judge(inverse(&g)))),
        ("c2d", Box::new(|| judge(c2d(&g, 0.1, Discretisation::ZeroOrderHold)))),
        ("c2d by the triangle hold", Box::new(|| judge(c2d(&g, 0.1, Discretisation::FirstOrderHold)))),
        ("c2d by Tustin", Box::new(|| judge(c2d(&g, 0.1, Discretisation::Tustin { prewarp_rad_s: None })))),
        ("c2d by matching", Box::new(|| judge(c2d(&g, 0.1, Discretisation::Matched)))),
        ("d2c_tustin", Box::new(|| judge(d2c_tustin(&g, None)))),
        ("step", Box::new(|| judge(step(&g, 1.0, 10)))),
        ("impulse", Box::new(|| judge(impulse(&g, 1.0, 10)))),
        ("lsim", Box::new(|| judge(lsim(&g, &Mat::zeros(5, g.inputs()), None)))),
        ("reduce_index", Box::new(|| judge(Descriptor::new(E.clone(), g.clone()).unwrap().reduce_index()))),
        ("balance", Box::new(|| drop(scaling::balance(&g)))),
    ];
    // The slow ones (responses of thousands of points) every third time.
    if seed.is_multiple_of(3) {
        calls.extend(further_calls(&g, &h, &E, x, y));
    }
    panicking(&calls)
}

#[test]
fn no_odd_system_panics() {
    assert_none_panics(900, &call_all);
}
