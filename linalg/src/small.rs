//! Systems of at most a few unknowns, solved with complete pivoting and never refused.

use crate::mat::Mat;
use crate::tolerance::EPS;

/// Solves `A x = b` in place by Gaussian elimination with complete pivoting; a pivot below `eps` times the largest
/// entry is replaced by that bound, so that the answer is finite (the caller checks what it is worth). Returns whether
/// every pivot was its own.
pub(crate) fn solve_complete(A: &mut Mat, b: &mut [f64]) -> bool {
    let n = b.len();
    let floor = (EPS * A.norm_max()).max(f64::MIN_POSITIVE / EPS);
    let mut order: Vec<usize> = (0..n).collect();
    let mut honest = true;
    for k in 0..n {
        pivot(A, b, &mut order, k);
        if A[(k, k)].abs() < floor {
            A[(k, k)] = floor;
            honest = false;
        }
        for i in k + 1..n {
            let factor = A[(i, k)] / A[(k, k)];
            for j in k + 1..n {
                A[(i, j)] -= factor * A[(k, j)];
            }
            b[i] -= factor * b[k];
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| A[(k, j)] * x[j]).sum();
        x[k] = (b[k] - sum) / A[(k, k)];
    }
    (0..n).for_each(|k| b[order[k]] = x[k]);
    honest
}

fn pivot(A: &mut Mat, b: &mut [f64], order: &mut [usize], k: usize) {
    let n = b.len();
    let (mut row, mut col) = (k, k);
    for j in k..n {
        for i in k..n {
            if A[(i, j)].abs() > A[(row, col)].abs() {
                (row, col) = (i, j);
            }
        }
    }
    for j in 0..n {
        let swapped = A[(k, j)];
        A[(k, j)] = A[(row, j)];
        A[(row, j)] = swapped;
    }
    for i in 0..n {
        let swapped = A[(i, k)];
        A[(i, k)] = A[(i, col)];
        A[(i, col)] = swapped;
    }
    b.swap(k, row);
    order.swap(k, col);
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
