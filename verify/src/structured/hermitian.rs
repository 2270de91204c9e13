//! Cholesky's factorisation of small Hermitian matrices: the test whether one is positive definite, and its inverse.

use counterpoise_linalg::{C64, CMat};

/// A lower triangular L with F = L L*.
#[derive(Debug, Clone, PartialEq)]
pub struct HermitianFactor {
    L: CMat,
}

impl HermitianFactor {
    /// Returns the factor of a Hermitian matrix, of which the lower triangle is read; `None` if it is not positive definite. n^3
    /// / 3 multiplications.
    pub fn of(F: &CMat) -> Option<Self> {
        let n = F.nrows();
        let mut L = CMat::zeros(n, n);
        for j in 0..n {
            let square = F[(j, j)].re - (0..j).map(|k| L[(j, k)].norm_sqr()).sum::<f64>();
            if !(square > 0.0 && square.is_finite()) {
                return None;
            }
            let pivot = square.sqrt();
            L[(j, j)] = C64::new(pivot, 0.0);
            for i in j + 1..n {
                let inner: C64 = (0..j).map(|k| L[(i, k)] * L[(j, k)].conj()).sum();
                L[(i, j)] = (F[(i, j)] - inner) / pivot;
            }
        }
        Some(Self { L })
    }

    /// Returns log det F.
    pub fn log_det(&self) -> f64 {
        (0..self.L.nrows()).map(|k| 2.0 * self.L[(k, k)].re.ln()).sum()
    }

    /// Returns inv(F).
    pub fn inverse(&self) -> CMat {
        let n = self.L.nrows();
        let mut X = CMat::eye(n);
        for column in 0..n {
            self.solve_in_place(X.column_mut(column));
        }
        X
    }

    /// Puts inv(F) b in the place of b.
    pub fn solve_in_place(&self, b: &mut [C64]) {
        let (L, n) = (&self.L, b.len());
        for i in 0..n {
            let inner: C64 = (0..i).map(|k| L[(i, k)] * b[k]).sum();
            b[i] = (b[i] - inner) / L[(i, i)].re;
        }
        for i in (0..n).rev() {
            let inner: C64 = (i + 1..n).map(|k| L[(k, i)].conj() * b[k]).sum();
            b[i] = (b[i] - inner) / L[(i, i)].re;
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_inverse_and_the_determinant_are_those_of_the_matrix() {
        let c = C64::new;
        let F = CMat::from_rows(&[[c(2.0, 0.0), c(0.5, -1.0)], [c(0.5, 1.0), c(3.0, 0.0)]]);
        let factor = HermitianFactor::of(&F).unwrap();
        assert!((factor.log_det() - (6.0_f64 - 1.25).ln()).abs() < 1e-14);
        assert!((&(&F * &factor.inverse()) - &CMat::eye(2)).norm_max() < 1e-14);
        assert!(HermitianFactor::of(&F.scale(c(-1.0, 0.0))).is_none());
    }
}
