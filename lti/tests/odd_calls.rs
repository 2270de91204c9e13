//! Odd systems never make a routine panic: without states, inputs or outputs, of any scale, with singular or improper parts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use std::panic::{AssertUnwindSafe, catch_unwind};

use counterpoise_lti::*;

/// A small generator (SplitMix64): uniform in [0, 1).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

fn odd(state: &mut u64, rows: usize, cols: usize) -> Mat {
    let kind = (uniform(state) * 8.0) as usize;
    Mat::from_fn(rows, cols, |_, _| {
        let plain = 2.0 * uniform(state) - 1.0;
        match kind {
            0 => 0.0,
            1 => plain * 1e300,
            2 => plain * 1e-300,
            3 => (4.0 * plain).round(),
            4 => plain * 10f64.powf(12.0 * uniform(state) - 6.0),
            _ => plain,
        }
    })
}

fn system(state: &mut u64) -> StateSpace {
    let mut size = |most: f64| (uniform(state) * most) as usize;
    let (n, m, p) = (size(5.0), size(3.0), size(3.0));
    let timebase = if size(2.0) == 0 { Timebase::Continuous } else { Timebase::Discrete { period_s: 0.1 } };
    let (A, B) = (odd(state, n, n), odd(state, n, m));
    let (C, D) = (odd(state, p, n), odd(state, p, m));
    StateSpace::new(A, B, C, D, timebase).unwrap()
}

/// Calls every routine; the name of the one that panics.
fn call_all(seed: u64) -> Option<&'static str> {
    let mut state = seed;
    let (g, h) = (system(&mut state), system(&mut state));
    let E = odd(&mut state, g.order(), g.order());
    type Call<'a> = (&'static str, Box<dyn Fn() + 'a>);
    let calls: Vec<Call> = vec![
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
    let panics = |call: &dyn Fn()| catch_unwind(AssertUnwindSafe(call)).is_err();
    calls.iter().find(|(_, call)| panics(call)).map(|(name, _)| *name)
}

#[test]
fn no_odd_system_panics() {
    std::panic::set_hook(Box::new(|_| ()));
    let found: Vec<(u64, &str)> =
        (0..1500).filter_map(|seed| call_all(seed).map(|name| (seed, name))).collect();
    let _ = std::panic::take_hook();
    assert!(found.is_empty(), "{} panics: {:?}", found.len(), &found[..found.len().min(20)]);
}
