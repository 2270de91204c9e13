//! Systems of at most four unknowns, solved with complete pivoting and never refused.

use crate::mat::Mat;
use crate::tolerance::EPS;

/// Solves the leading `n` rows and columns of `A x = b` in place by Gaussian elimination with complete pivoting; a pivot
/// below `eps` times the largest entry is replaced by that bound, so that the answer is finite (the caller checks what it
/// is worth).
#[inline(always)]
pub(crate) fn solve_complete(A: &mut [[f64; 4]; 4], b: &mut [f64; 4], n: usize) {
    let largest = A[..n].iter().flat_map(|row| &row[..n]).fold(0.0_f64, |m, e| m.max(e.abs()));
    let floor = (EPS * largest).max(f64::MIN_POSITIVE / EPS);
    let mut order = [0, 1, 2, 3];
    for k in 0..n {
        pivot(A, b, &mut order, k, n);
        if A[k][k].abs() < floor {
            A[k][k] = floor;
        }
        for i in k + 1..n {
            let factor = A[i][k] / A[k][k];
            for j in k + 1..n {
                A[i][j] -= factor * A[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    let mut x = [0.0; 4];
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| A[k][j] * x[j]).sum();
        x[k] = (b[k] - sum) / A[k][k];
    }
    (0..n).for_each(|k| b[order[k]] = x[k]);
}

/// Brings the largest entry of the trailing block to (k, k).
#[inline(always)]
fn pivot(A: &mut [[f64; 4]; 4], b: &mut [f64; 4], order: &mut [usize; 4], k: usize, n: usize) {
    let (mut row, mut col) = (k, k);
    for i in k..n {
        for j in k..n {
            if A[i][j].abs() > A[row][col].abs() {
                (row, col) = (i, j);
            }
        }
    }
    A.swap(k, row);
    b.swap(k, row);
    order.swap(k, col);
    A.iter_mut().for_each(|line| line.swap(k, col));
}

/// The full orthogonal factor of a small tall matrix, by Householder reflections.
pub(crate) fn full_q(mut A: Mat) -> Mat {
    let (m, n) = A.shape();
    let mut Q = Mat::eye(m);
    for k in 0..n.min(m - 1) {
        let norm = (k..m).map(|i| A[(i, k)] * A[(i, k)]).sum::<f64>().sqrt();
        if norm == 0.0 {
            continue;
        }
        let mut v = vec![0.0; m];
        v[k..].copy_from_slice(&A.column(k)[k..]);
        v[k] += norm.copysign(v[k]);
        let size: f64 = v.iter().map(|e| e * e).sum();
        for j in k..n {
            let factor = 2.0 * crate::dense::dot(&v, A.column(j)) / size;
            A.column_mut(j).iter_mut().zip(&v).for_each(|(a, &e)| *a -= factor * e);
        }
        for i in 0..m {
            let factor = 2.0 * (0..m).map(|j| Q[(i, j)] * v[j]).sum::<f64>() / size;
            (0..m).for_each(|j| Q[(i, j)] -= factor * v[j]);
        }
    }
    Q
}
