//! Odd systems never make a routine panic: without states, inputs or outputs, of any scale, with singular or improper parts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::odd::{Call, assert_none_panics, odd, odd_number, panicking, uniform};

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::*;

fn system(state: &mut u64) -> StateSpace {
    let mut size = |most: f64| (uniform(state) * most) as usize;
    let (n, m, p) = (size(5.0), size(3.0), size(3.0));
    let timebase = if size(2.0) == 0 { Timebase::Continuous } else { Timebase::Discrete { period_s: 0.1 } };
    let (A, B) = (odd(state, n, n), odd(state, n, m));
    let (C, D) = (odd(state, p, n), odd(state, p, m));
    let mut system = StateSpace::new(A, B, C, D, timebase).unwrap();
    // The matrices are public: a caller may write what the constructor refuses.
    if n * m > 0 && uniform(state) < 0.1 {
        system.A[(0, n - 1)] = if uniform(state) < 0.5 { f64::NAN } else { f64::INFINITY };
    }
    system
}

/// Delays, margins of several loops, placement, sampled costs and named blocks, with odd arguments.
fn further<'a>(g: &'a StateSpace, h: &'a StateSpace, E: &'a Mat, x: f64, y: f64) -> Vec<Call<'a>> {
    let wanted = vec![C64::new(x, y), C64::new(x, -y), C64::new(-1.0, 0.0)];
    let roots = wanted.clone();
    let cost = move || Cost { Q: E, R: &h.D, S: &g.B };
    vec![
        ("c2d_delayed", Box::new(move || drop(c2d_delayed(g, x, y)))),
        (
            "c2d of any period",
            Box::new(move || drop(c2d(g, x, Discretisation::Tustin { prewarp_rad_s: Some(y) }))),
        ),
        ("margins_with_delay", Box::new(move || drop(margins_with_delay(g, x.clamp(-1.0, 0.03))))),
        ("multiloop_margins", Box::new(move || drop(multiloop_margins(g)))),
        ("place", Box::new(move || drop(place(&g.A, &g.B, &wanted)))),
        ("pade", Box::new(move || drop(pade(x, 3)))),
        ("delay_samples", Box::new(move || drop(delay_samples(3, x)))),
        ("sampled_cost", Box::new(move || drop(sampled_cost(&g.A, &g.B, cost(), x)))),
        ("response_at", Box::new(move || drop(response_at(g, x)))),
        ("frequency_response", Box::new(move || drop(frequency_response(g, &[x, y])))),
        ("frequency_response of no rates", Box::new(move || drop(frequency_response(g, &[])))),
        ("linfnorm of any tolerance", Box::new(move || drop(linfnorm(g, x)))),
        ("ctrb_gramian", Box::new(move || drop(ctrb_gramian(g)))),
        ("obsv_gramian", Box::new(move || drop(obsv_gramian(g)))),
        ("ctrb_factor", Box::new(move || drop(ctrb_factor(g)))),
        ("obsv_factor", Box::new(move || drop(obsv_factor(g)))),
        (
            "Zpk",
            Box::new(move || {
                drop(
                    Zpk { zeros: vec![], poles: roots.clone(), gain: y, timebase: g.timebase }
                        .to_state_space(),
                )
            }),
        ),
        (
            "TransferFunction",
            Box::new(move || {
                drop(TransferFunction::new(&[x, y], &[y, x, 1.0], g.timebase).map(|t| t.to_state_space()))
            }),
        ),
        (
            "Named",
            Box::new(move || {
                drop(
                    Named::new(g.clone(), &["u"], &["y"]).map(|block| connect(&[block], &["u", "r"], &["y"])),
                )
            }),
        ),
        ("lsim", Box::new(move || drop(lsim(g, &h.B, Some(&[x]))))),
        ("step of any time", Box::new(move || drop(step(g, x, 0)))),
        ("scale_io", Box::new(move || drop(g.scale_io(&[x], &[y])))),
        (
            "Descriptor",
            Box::new(move || drop(Descriptor::new(h.A.clone(), g.clone()).map(|d| d.to_state_space()))),
        ),
    ]
}

/// Calls every routine; the names of those that panic.
fn call_all(seed: u64) -> Vec<&'static str> {
    let mut state = seed;
    let (g, h) = (system(&mut state), system(&mut state));
    let E = odd(&mut state, g.order(), g.order());
    let (x, y) = (odd_number(&mut state), odd_number(&mut state));
    let mut calls: Vec<Call> = vec![
        ("poles", Box::new(|| drop(poles(&g)))),
        ("zeros", Box::new(|| drop(zeros(&g)))),
        ("is_stable", Box::new(|| drop(is_stable(&g)))),
        ("poles_on_boundary", Box::new(|| drop(poles_on_boundary(&g)))),
        ("h2norm", Box::new(|| drop(h2norm(&g)))),
        ("linfnorm", Box::new(|| drop(linfnorm(&g, 1e-8)))),
        ("linfnorm_bounds", Box::new(|| drop(linfnorm_bounds(&g, 1e-8)))),
        ("hinfnorm", Box::new(|| drop(hinfnorm(&g, 1e-8)))),
        ("hankel_values", Box::new(|| drop(hankel_values(&g)))),
        ("hankelnorm", Box::new(|| drop(hankelnorm(&g)))),
        ("gramian_factors", Box::new(|| drop(gramian_factors(&g)))),
        ("margins", Box::new(|| drop(margins(&g)))),
        ("dcgain", Box::new(|| drop(dcgain(&g)))),
        ("sigma", Box::new(|| drop(sigma(&g, &[0.0, 1.0, 1e9])))),
        ("Zpk::of", Box::new(|| drop(Zpk::of(&g)))),
        ("TransferFunction::of", Box::new(|| drop(TransferFunction::of(&g)))),
        ("series", Box::new(|| drop(series(&g, &h)))),
        ("parallel", Box::new(|| drop(parallel(&g, &h)))),
        ("feedback", Box::new(|| drop(feedback(&g, &h)))),
        ("append", Box::new(|| drop(append(&g, &h)))),
        ("lft", Box::new(|| drop(lft(&g, &h)))),
        ("inverse", Box::new(|| drop(inverse(&g)))),
        ("c2d", Box::new(|| drop(c2d(&g, 0.1, Discretisation::ZeroOrderHold)))),
        ("c2d by the triangle hold", Box::new(|| drop(c2d(&g, 0.1, Discretisation::FirstOrderHold)))),
        ("c2d by Tustin", Box::new(|| drop(c2d(&g, 0.1, Discretisation::Tustin { prewarp_rad_s: None })))),
        ("c2d by matching", Box::new(|| drop(c2d(&g, 0.1, Discretisation::Matched)))),
        ("d2c_tustin", Box::new(|| drop(d2c_tustin(&g, None)))),
        ("step", Box::new(|| drop(step(&g, 1.0, 10)))),
        ("impulse", Box::new(|| drop(impulse(&g, 1.0, 10)))),
        ("lsim", Box::new(|| drop(lsim(&g, &Mat::zeros(5, g.inputs()), None)))),
        ("reduce_index", Box::new(|| drop(Descriptor::new(E.clone(), g.clone()).unwrap().reduce_index()))),
        ("balance", Box::new(|| drop(scaling::balance(&g)))),
    ];
    // The slow ones (responses of thousands of points) every third time.
    if seed.is_multiple_of(3) {
        calls.extend(further(&g, &h, &E, x, y));
    }
    panicking(&calls)
}

#[test]
fn no_odd_system_panics() {
    assert_none_panics(900, &call_all);
}
