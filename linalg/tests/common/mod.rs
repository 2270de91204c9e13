//! Random matrices from a seed, the measures of error and the solved equations that the suites share.
#![allow(dead_code, non_snake_case)]

use counterpoise_linalg::{Error, Mat, Outcome, Riccati, care, care_g, dare};

/// A small portable generator (SplitMix64).
pub struct RandomGenerator(u64);

impl RandomGenerator {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1))
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Standard normal (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    pub fn matrix(&mut self, rows: usize, cols: usize) -> Mat {
        Mat::from_fn(rows, cols, |_, _| self.normal())
    }

    /// A matrix whose eigenvalues all have real parts below `-margin`.
    pub fn stable(&mut self, n: usize, margin: f64) -> Mat {
        let A = self.matrix(n, n).scale(1.0 / (n as f64).sqrt());
        let most =
            counterpoise_linalg::eigenvalues(&A).unwrap().iter().map(|l| l.re).fold(f64::MIN, f64::max);
        &A - &Mat::eye(n).scale(most + margin)
    }
}

/// `norm(A - B) / norm(B)`.
pub fn difference(A: &Mat, B: &Mat) -> f64 {
    (A - B).norm_fro() / B.norm_fro().max(f64::MIN_POSITIVE)
}

/// The solution of `care` without a cross term.
pub fn solve_care(A: &Mat, B: &Mat, Q: &Mat, R: &Mat) -> Riccati {
    solution(care(A, B, Q, R, None))
}

/// The solution of `care_g`.
pub fn solved_g(A: &Mat, G: &Mat, Q: &Mat) -> Riccati {
    solution(care_g(A, G, Q))
}

/// The solution of `dare` without a cross term.
pub fn solved_discrete(A: &Mat, B: &Mat, Q: &Mat, R: &Mat) -> Riccati {
    solution(dare(A, B, Q, R, None))
}

fn solution(outcome: Result<Outcome<Riccati>, Error>) -> Riccati {
    outcome.unwrap().into_result().unwrap_or_else(|why| panic!("{why}"))
}

/// The error that rounding the data alone explains.
pub fn within_data(solution: &Riccati, exact: &Mat, what: &str) {
    let error = difference(&solution.X, exact);
    let data = f64::EPSILON * solution.certificate.condition;
    assert!(error <= data.max(4e-15), "{what}: error {error:.1e}, data explain {data:.1e}");
}
