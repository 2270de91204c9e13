//! Frequency response, zero-order hold and margins over the order of the system.
#![allow(missing_docs, non_snake_case, clippy::expect_used)]

use counterpoise_linalg::Mat;
use counterpoise_lti::{Discretisation, StateSpace, Timebase, c2d, frequency_response, margins};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

/// Returns a dense stable system of order n with one input and one output, the same in every run.
fn system(n: usize) -> StateSpace {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
    };
    let size = (n as f64).sqrt();
    let A = Mat::from_fn(n, n, |i, j| next() / size - if i == j { 1.0 } else { 0.0 });
    let (B, C) = (Mat::from_fn(n, 1, |_, _| next()), Mat::from_fn(1, n, |_, _| next()));
    StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).expect("shapes fit")
}

fn systems(criterion: &mut Criterion) {
    let rates: Vec<f64> = (0..1000).map(|k| 10.0_f64.powf(-2.0 + 0.004 * f64::from(k))).collect();
    let mut group = criterion.benchmark_group("systems");
    group.sample_size(10);
    for n in [20, 50, 100, 200, 400] {
        let g = system(n);
        group.bench_with_input(BenchmarkId::new("1000 responses", n), &g, |bench, g| {
            bench.iter(|| frequency_response(black_box(g), &rates));
        });
        group.bench_with_input(BenchmarkId::new("zero-order hold", n), &g, |bench, g| {
            bench.iter(|| c2d(black_box(g), 0.05, Discretisation::ZeroOrderHold));
        });
        if n <= 100 {
            group.bench_with_input(BenchmarkId::new("margins", n), &g, |bench, g| {
                bench.iter(|| margins(black_box(g)))
            });
        }
    }
    group.finish();
}

criterion_group!(benches, systems);
criterion_main!(benches);
