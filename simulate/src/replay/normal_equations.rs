//! Normal equations of the few unknowns of a start.

use crate::tolerance::INDISTINCT;
use nalgebra::{SMatrix, SVector};

/// J'J and -J'r.
pub(super) struct NormalEquations<const N: usize> {
    matrix: SMatrix<f64, N, N>,
    right: SVector<f64, N>,
}

impl<const N: usize> NormalEquations<N> {
    /// From the columns of J, as many as there are unknowns, and the residuals.
    pub(super) fn of(columns: &[Vec<f64>], residuals: &[f64]) -> Self {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        Self {
            right: SVector::from_fn(|i, _| -dot(&columns[i], residuals)),
            matrix: SMatrix::from_fn(|i, j| dot(&columns[i], &columns[j])),
        }
    }

    /// x = L^-T z of J'J = L L': with z = +-1 a step to where the cost has risen by one for every unknown; an unknown without effect
    /// does not move.
    pub(super) fn draw(&self, z: &[f64; N]) -> [f64; N] {
        let mut l = self.matrix;
        for j in 0..N {
            let own = l[(j, j)] - (0..j).map(|k| l[(j, k)] * l[(j, k)]).sum::<f64>();
            l[(j, j)] = if own > INDISTINCT * self.matrix[(j, j)] { own.sqrt() } else { 0.0 };
            for i in j + 1..N {
                let left = l[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
                l[(i, j)] = if l[(j, j)] > 0.0 { left / l[(j, j)] } else { 0.0 };
            }
        }
        let mut x = [0.0; N];
        for i in (0..N).rev() {
            let known: f64 = (i + 1..N).map(|k| l[(k, i)] * x[k]).sum();
            x[i] = if l[(i, i)] > 0.0 { (z[i] - known) / l[(i, i)] } else { 0.0 };
        }
        x
    }

    /// Returns the step with the diagonal raised by its own share `damping`; an unknown without effect does not move.
    pub(super) fn solve(&self, damping: f64) -> [f64; N] {
        let mut a = self.matrix;
        let mut b = self.right;
        for i in 0..N {
            a[(i, i)] = a[(i, i)] * (1.0 + damping) + f64::MIN_POSITIVE;
        }
        // Cholesky's method without roots; the matrix is positive by the line above
        for j in 0..N {
            for i in j + 1..N {
                let factor = a[(i, j)] / a[(j, j)];
                for k in j..N {
                    a[(i, k)] -= factor * a[(j, k)];
                }
                b[i] -= factor * b[j];
            }
        }
        for j in (0..N).rev() {
            let known: f64 = (j + 1..N).map(|k| a[(j, k)] * b[k]).sum();
            b[j] = (b[j] - known) / a[(j, j)];
        }
        b.map(|step| if step.is_finite() { step } else { 0.0 }).into()
    }
}

/// Returns the sum of the squares.
pub(super) fn squares(residuals: &[f64]) -> f64 {
    residuals.iter().map(|r| r * r).sum()
}
