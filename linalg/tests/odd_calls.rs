//! Odd calls never panic: sizes of zero, shapes that do not fit, entries that are not finite, huge and tiny numbers.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::common;
use crate::odd::{Call, assert_none_panics, judge, panicking};

use common::RandomGenerator;
use counterpoise_linalg::*;

/// A matrix of odd shape with odd entries.
fn odd_matrix(random: &mut RandomGenerator, usual: (usize, usize)) -> Mat {
    let mut size = |n: usize| match (random.uniform() * 12.0) as usize {
        0 => 0,
        1 => 1,
        2 => n + 1,
        _ => n,
    };
    let (rows, cols) = (size(usual.0), size(usual.1));
    let kind = (random.uniform() * 10.0) as usize;
    Mat::from_fn(rows, cols, |i, j| {
        let plain = random.normal();
        match kind {
            0 => 0.0,
            1 if i == j => f64::NAN,
            2 if i + 1 == j => f64::INFINITY,
            3 => plain * 1e300,
            4 => plain * 1e-300,
            5 => plain.round(),
            6 => plain * 10f64.powf(12.0 * random.uniform() - 6.0),
            _ => plain,
        }
    })
}

fn square(random: &mut RandomGenerator, n: usize) -> Mat {
    odd_matrix(random, (n, n))
}

/// A square matrix that is symmetric more often than not.
fn mostly_symmetric_matrix(random: &mut RandomGenerator, n: usize) -> Mat {
    let M = square(random, n);
    if M.is_square() && random.uniform() < 0.9 { &M + &M.t() } else { M }
}

/// The arguments that the routines are called with.
struct Data {
    A: Mat,
    B: Mat,
    C: Mat,
    Q: Mat,
    R: Mat,
    S: Mat,
}

impl Data {
    fn of(seed: u64) -> Self {
        let mut random = RandomGenerator::new(seed);
        let n = (random.uniform() * 5.0) as usize;
        let m = (random.uniform() * 3.0) as usize;
        Self {
            A: square(&mut random, n),
            B: odd_matrix(&mut random, (n, m)),
            C: square(&mut random, n),
            Q: mostly_symmetric_matrix(&mut random, n),
            R: mostly_symmetric_matrix(&mut random, m),
            S: odd_matrix(&mut random, (n, m)),
        }
    }

    /// The matrix equations and spectra.
    fn equations(&self) -> Vec<Call<'_>> {
        let Self { A, B, C, Q, R, S } = self;
        vec![
            ("care", Box::new(|| judge(care(A, B, Q, R, None)))),
            ("care with a cross term", Box::new(|| judge(care(A, B, Q, R, Some(S))))),
            ("dare", Box::new(|| judge(dare(A, B, Q, R, None)))),
            ("dare with a cross term", Box::new(|| judge(dare(A, B, Q, R, Some(S))))),
            ("care_g", Box::new(|| judge(care_g(A, C, Q)))),
            ("lyap", Box::new(|| judge(lyap(A, Q)))),
            ("dlyap", Box::new(|| judge(dlyap(A, C)))),
            ("lyap_separation", Box::new(|| judge(lyap_separation(A)))),
            ("dlyap_separation", Box::new(|| judge(dlyap_separation(A)))),
            ("lyap_factor", Box::new(|| judge(lyap_factor(A, B)))),
            ("dlyap_factor", Box::new(|| judge(dlyap_factor(A, B)))),
            ("lyap_factors", Box::new(|| judge(lyap_factors(A, B, C)))),
            ("dlyap_factors", Box::new(|| judge(dlyap_factors(A, B, C)))),
            ("sylvester", Box::new(|| judge(sylvester(A, C, Q)))),
            ("dsylvester", Box::new(|| judge(dsylvester(A, R, B)))),
            ("gsylvester", Box::new(|| judge(gsylvester(A, C, Q, A, C)))),
            ("eigenvalues", Box::new(|| judge(eigenvalues(A)))),
            ("schur", Box::new(|| judge(schur(A).map(|form| form.condition(1))))),
            ("balance", Box::new(|| judge(balance(A)))),
            ("boundary_eigenvalues", Box::new(|| judge(boundary_eigenvalues(A, Boundary::UnitCircle)))),
            ("is_clear_of_boundary", Box::new(|| judge(is_clear_of_boundary(A, Boundary::ImaginaryAxis)))),
        ]
    }

    /// The equations with a matrix E, roots of pencils, and what takes lists.
    fn generalised_calls(&self) -> Vec<Call<'_>> {
        let Self { A, B, C, Q, R, S } = self;
        let weights = |S| CostWeights { Q, R, S };
        let scales = C.diagonal();
        let starts: Vec<C64> = scales.iter().map(|&re| C64::new(re, 1.0)).collect();
        let other: Vec<C64> = starts.iter().skip(1).copied().collect();
        vec![
            ("glyap", Box::new(|| judge(glyap(A, C, Q)))),
            ("gdlyap", Box::new(|| judge(gdlyap(A, C, Q)))),
            ("gcare", Box::new(move || judge(gcare(A, C, B, &weights(None))))),
            ("gdare", Box::new(move || judge(gdare(A, C, B, &weights(Some(S)))))),
            ("pencil_roots", Box::new(move || judge(pencil_roots(A, &scales, &starts)))),
            (
                "eigenvalue_separation",
                Box::new(move || assert!(!eigenvalue_separation(&other, &[]).is_nan())),
            ),
            ("transpose_times", Box::new(|| drop(transpose_times(A, B)))),
            ("rank_tolerance", Box::new(|| judge(rank(B, rank_tolerance(B))))),
            ("sparse", Box::new(|| judge(sparse_calls(A, Q)))),
        ]
    }

    /// The exponentials, linear systems and decompositions.
    fn decompositions(&self) -> Vec<Call<'_>> {
        let Self { A, B, C, Q, .. } = self;
        vec![
            ("expm", Box::new(|| judge(expm(A)))),
            ("expm_integral", Box::new(|| judge(expm_integral(A, B, 0.1)))),
            ("van_loan_cost", Box::new(|| judge(van_loan_cost(A, Q, 0.1)))),
            ("van_loan_noise", Box::new(|| judge(van_loan_noise(A, Q, 0.1)))),
            ("van_loan_accumulated", Box::new(|| judge(van_loan_accumulated(A, Q, 0.1)))),
            ("solve", Box::new(|| judge(solve(A, B)))),
            ("csolve", Box::new(|| judge(csolve(&A.to_complex(), &B.to_complex())))),
            ("inverse", Box::new(|| judge(inverse(A)))),
            ("cholesky", Box::new(|| judge(cholesky(Q)))),
            ("qr", Box::new(|| judge(qr(B)))),
            ("qr_r", Box::new(|| judge(qr_r(B)))),
            ("qr_full_q", Box::new(|| judge(qr_full_q(B)))),
            ("lstsq", Box::new(|| judge(lstsq(B, A)))),
            ("pinv", Box::new(|| judge(pinv(B)))),
            ("cdet", Box::new(|| judge(cdet(&A.to_complex())))),
            ("svd", Box::new(|| judge(svd(B)))),
            ("singular_values", Box::new(|| judge(singular_values(B)))),
            ("csingular_values", Box::new(|| judge(csingular_values(&B.to_complex())))),
            ("csvd", Box::new(|| judge(csvd(&B.to_complex())))),
            ("sym_eigen", Box::new(|| judge(sym_eigen(Q)))),
            ("sym_eigenvalues", Box::new(|| judge(sym_eigenvalues(Q)))),
            ("sym_gen_eigen", Box::new(|| judge(sym_gen_eigen(Q, C)))),
            ("hessenberg", Box::new(|| judge(hessenberg(A)))),
            ("gen_eigenvalues", Box::new(|| judge(gen_eigenvalues(A, C)))),
            ("rank", Box::new(|| judge(rank(B, 1e-12)))),
            ("cond", Box::new(|| judge(cond(B)))),
            ("rcond_one", Box::new(|| judge(solve(A, A).map(|_| rcond_one(A))))),
        ]
    }
}

/// Factors and modes of a sparse matrix with the entries of a dense one.
fn sparse_calls(A: &Mat, Q: &Mat) -> Result<(), Error> {
    let (K, M) = (Sparse::from_dense(Q), Sparse::from_dense(A));
    judge(SparseCholesky::of(&K));
    judge(SparseCholesky::of(&M));
    let entry = sparse::Entry { row: A.nrows(), col: 0, value: 1.0 };
    judge(Sparse::from_entries(A.nrows(), A.ncols(), &[entry]));
    sparse::count_below(&K, &M, 1.0).map(|_| ())
}

/// Calls every routine; the names of those that panic.
fn call_all(seed: u64) -> Vec<&'static str> {
    let data = Data::of(seed);
    let calls = data.equations().into_iter().chain(data.generalised_calls()).chain(data.decompositions());
    panicking(&calls.collect::<Vec<Call>>())
}

#[test]
fn no_odd_call_panics() {
    assert_none_panics(2000, &call_all);
}
