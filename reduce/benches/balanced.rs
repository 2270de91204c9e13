//! Balanced truncation over the order of the system.
#![allow(missing_docs, non_snake_case, clippy::expect_used)]

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_reduce::{BalancedSystem, Method, Order, balred};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

/// Returns modes of falling size and damping 0.01, states mixed by a fixed rotation of neighbours.
fn structure(modes: usize) -> StateSpace {
    let n = 2 * modes;
    let mut A = Mat::zeros(n, n);
    let (mut B, mut C) = (Mat::zeros(n, 1), Mat::zeros(1, n));
    for k in 0..modes {
        let rate = 10.0 * (k + 1) as f64;
        (A[(2 * k, 2 * k + 1)], A[(2 * k + 1, 2 * k)], A[(2 * k + 1, 2 * k + 1)]) =
            (rate, -rate, -0.02 * rate);
        (B[(2 * k + 1, 0)], C[(0, 2 * k)]) = (1.0, 1.0 / (k + 1) as f64);
        if k > 0 {
            A[(2 * k + 1, 2 * k - 1)] = -0.01 * rate;
        }
    }
    StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).expect("shapes fit")
}

fn bench_balanced(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("balanced");
    group.sample_size(10);
    for n in [20, 50, 100, 200, 400] {
        let g = structure(n / 2);
        group.bench_with_input(BenchmarkId::new("truncation", n), &g, |bench, g| {
            bench.iter(|| BalancedSystem::of(black_box(g)).and_then(|b| b.reduce(n / 5, Method::SquareRoot)));
        });
        if n <= 100 {
            group.bench_with_input(BenchmarkId::new("with its error measured", n), &g, |bench, g| {
                bench.iter(|| balred(black_box(g), Order::States(n / 5), Method::SquareRoot));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, bench_balanced);
criterion_main!(benches);
