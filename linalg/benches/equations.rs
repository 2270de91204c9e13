//! The equations at the sizes of this tool: `cargo bench -p counterpoise-linalg`.
#![allow(missing_docs, non_snake_case, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::RandomGenerator;
use counterpoise_linalg::{Mat, care, dare, expm, lyap, lyap_factor, schur};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

const SIZES: [usize; 4] = [10, 20, 50, 100];

/// Times `run` on a stable system (A, B) of every size.
fn at_sizes(criterion: &mut Criterion, name: &str, run: impl Fn(&Mat, &Mat)) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(20);
    for n in SIZES {
        let mut random = RandomGenerator::new(n as u64);
        let (A, B) = (random.stable(n, 0.2), random.matrix(n, 2));
        group.bench_with_input(BenchmarkId::from_parameter(n), &n, |bencher, _| bencher.iter(|| run(&A, &B)));
    }
    group.finish();
}

fn equations(criterion: &mut Criterion) {
    let weights = |A: &Mat| (Mat::eye(A.nrows()), Mat::eye(2));
    at_sizes(criterion, "schur", |A, _| drop(schur(A).unwrap()));
    at_sizes(criterion, "lyap", |A, B| drop(lyap(A, &(B * B.t()).symmetric_part()).unwrap()));
    at_sizes(criterion, "lyap_factor", |A, B| drop(lyap_factor(A, B).unwrap()));
    at_sizes(criterion, "expm", |A, _| drop(expm(A).unwrap()));
    at_sizes(criterion, "care", |A, B| {
        let (Q, R) = weights(A);
        drop(care(A, B, &Q, &R, None).unwrap());
    });
    at_sizes(criterion, "dare", |A, B| {
        // The continuous system sampled: as it stands it would have dozens of poles far outside the unit circle.
        let (Q, R) = weights(A);
        let sampled = expm(&A.scale(0.1)).unwrap();
        drop(dare(&sampled, B, &Q, &R, None).unwrap());
    });
}

criterion_group!(benches, equations);
criterion_main!(benches);
