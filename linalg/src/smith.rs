//! Lyapunov equations of stable matrices with 32 digits, by squaring.
//!
//! The powers of the matrix (of its Cayley transform in continuous time) tend to zero if and only if it is stable, so that
//! the solution proves stability. Source: Smith, SIAM J. Appl. Math. 16 (1968).

use crate::long_matrix::LongMatrix;
use crate::mat::C64;
use crate::schur::eigenvalues;
use crate::sylvester::Kind;
use crate::tolerance::{PRECISE_POWER, PRECISE_SQUARINGS, VANISHED_MODULUS};

/// `E` with `F'E + E F + P = 0` or `F'E F - E + P = 0` for each `P`; `None` if `F` is not stable.
pub(crate) fn lyapunov<const K: usize>(
    F: &LongMatrix,
    right: [LongMatrix; K],
    kind: Kind,
) -> Option<[LongMatrix; K]> {
    if kind == Kind::Discrete {
        return smith(F.clone(), right);
    }
    let n = F.high.nrows();
    let size = F.high.norm_fro().max(f64::MIN_POSITIVE);
    let gamma = power_of_two(eigenvalues(&F.high).map_or(size, |values| mean_modulus(&values, size)));
    let inverse = F.difference(&LongMatrix::identity(n, gamma)).solve(&LongMatrix::identity(n, 1.0))?;
    let turned = LongMatrix::identity(n, 1.0).plus(&inverse.scale(2.0 * gamma));
    let moved = right.map(|P| inverse.t().times(&P.times(&inverse)).scale(2.0 * gamma));
    smith(turned, moved)
}

/// The sum of `(F^k)' P F^k` over all k, by squaring; `None` if the powers do not tend to zero.
fn smith<const K: usize>(mut F: LongMatrix, mut sums: [LongMatrix; K]) -> Option<[LongMatrix; K]> {
    for _ in 0..PRECISE_SQUARINGS {
        let transposed = F.t();
        sums = sums.map(|X| X.plus(&transposed.times(&X.times(&F))));
        let size = F.high.norm_fro();
        if size < PRECISE_POWER {
            return Some(sums);
        }
        if !size.is_finite() {
            return None;
        }
        F = F.times(&F);
    }
    None
}

/// The geometric mean of the smallest and the largest modulus, those below 1e-12 of `size` left out.
pub(crate) fn mean_modulus(values: &[C64], size: f64) -> f64 {
    let moduli = values.iter().map(|l| l.norm()).filter(|&l| l > VANISHED_MODULUS * size);
    let (low, high) =
        moduli.fold((size, VANISHED_MODULUS * size), |(low, high), l| (l.min(low), l.max(high)));
    (low * high).sqrt()
}

pub(crate) fn power_of_two(value: f64) -> f64 {
    crate::decomposition::power_of_two(value.max(f64::MIN_POSITIVE))
}
