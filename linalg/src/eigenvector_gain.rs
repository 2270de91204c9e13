//! The state feedback that belongs to chosen eigenvectors, with 32 digits on the way.

use crate::decomposition::csvd;
use crate::dense::unit_power;
use crate::error::{Error, check_shape, check_square};
use crate::long_matrix::LongMatrix;
use crate::mat::{C64, CMat, Mat};

/// A system `x' = A x + B u` with wanted eigenvalues of `A - B F` and approximations of their eigenvectors.
#[derive(Clone, Copy, Debug)]
pub struct EigenvectorChoice<'a> {
    /// n x n.
    pub A: &'a Mat,
    /// n x m.
    pub B: &'a Mat,
    /// Independent directions of the inputs, m x r: the feedback is one of `V' u`, and `B V` has full rank.
    pub V: &'a Mat,
    /// n eigenvalues, a complex one directly before its conjugate.
    pub eigenvalues: &'a [C64],
    /// Column k approximates the eigenvector of eigenvalue k, n x n.
    pub vectors: &'a CMat,
}

/// Returns the feedback `F`, m x n, for which `A - B F` has the wanted eigenvalues, each with the eigenvector nearest to the given one that it
/// may have; `None` if the vectors are not independent.
///
/// An eigenvector `x` and the control `g = F x` solve `(A - l I) x = B g`. They are computed in 32 digits, as the null vector of `[A - l I, -B]`
/// nearest to the given one, and `F = G X^-1` as well, so that the condition of the eigenvectors takes none of its digits. Cost: n systems of
/// 2 (n + r) equations in 32 digits.
///
/// # Errors
/// Wrong shapes, and those of [`csvd`].
pub fn eigenvector_gain(choice: EigenvectorChoice) -> Result<Option<Mat>, Error> {
    let EigenvectorChoice { A, B, V, eigenvalues, vectors } = choice;
    check_square("A", A)?;
    let n = A.nrows();
    check_shape("B", B, n, B.ncols())?;
    check_shape("V", V, B.ncols(), V.ncols())?;
    let units = state_units(vectors);
    let back: Vec<f64> = units.iter().map(|d| 1.0 / d).collect();
    let A = &Mat::from_fn(n, n, |i, j| back[i] * A[(i, j)] * units[j]);
    let vectors = CMat::from_fn(n, vectors.ncols(), |i, j| vectors[(i, j)] * back[i]);
    let driven =
        LongMatrix::from(&Mat::from_fn(n, B.ncols(), |i, j| back[i] * B[(i, j)])).times(&LongMatrix::from(V));
    let (mut X, mut G) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for (k, &eigenvalue) in eigenvalues.iter().enumerate().filter(|(_, l)| l.im >= 0.0) {
        let Some(pair) = null_vector(A, &driven, eigenvalue, vectors.column(k))? else { return Ok(None) };
        for part in if eigenvalue.im > 0.0 { vec![pair.re, pair.im] } else { vec![pair.re] } {
            X.push(part.block(0, 0, n, 1));
            G.push(part.block(n, 0, V.ncols(), 1));
        }
    }
    let joined = |columns: Vec<LongMatrix>| columns.into_iter().reduce(|all, next| all.hstack(&next));
    let (Some(X), Some(G)) = (joined(X), joined(G)) else { return Ok(Some(Mat::zeros(B.ncols(), 0))) };
    check_shape("eigenvectors", &X.high, n, n)?;
    let ones = vec![1.0; B.ncols()];
    Ok(X.t().solve(&G.t()).map(|F| LongMatrix::from(V).times(&F.t()).rescale(&ones, &back).round()))
}

/// Units of the states, powers of two, in which each has the size one in some eigenvector: the entries of `A` are then of the eigenvalues' size.
fn state_units(vectors: &CMat) -> Vec<f64> {
    let largest = |i: usize| (0..vectors.ncols()).map(|j| vectors[(i, j)].norm()).fold(0.0, f64::max);
    (0..vectors.nrows()).map(|i| 1.0 / unit_power(largest(i))).collect()
}

/// The real and the imaginary part of a vector.
struct LongVector {
    re: LongMatrix,
    im: LongMatrix,
}

/// Returns the null vector of `[A - l I, -B]` whose part in the null space is that of the given eigenvector with its control.
fn null_vector(A: &Mat, B: &LongMatrix, l: C64, x: &[C64]) -> Result<Option<LongVector>, Error> {
    let (n, r) = B.high.shape();
    let size = n + r;
    let upper = CMat::from_fn(size, size, |i, j| match (i < n, j < n) {
        (true, true) => C64::new(A[(i, j)], 0.0) - if i == j { l } else { C64::ZERO },
        (true, false) => C64::new(-B.high[(i, j - n)], 0.0),
        _ => C64::ZERO,
    });
    // The last right singular vectors span the null space: the rows that fix which of its vectors is meant.
    let basis = csvd(&upper)?.V.block(0, n, size, r);
    let share = coordinates(&basis, x);
    let part = |M: &CMat, of: fn(&C64) -> f64| Mat::from_fn(M.nrows(), M.ncols(), |i, j| of(&M[(i, j)]));
    let (rows, wanted) = (basis.h(), CMat::from_fn(r, 1, |i, _| share[i]));
    let equations = LongMatrix::from(A).difference(&LongMatrix::identity(n, l.re)).hstack(&B.scale(-1.0));
    let turned = Mat::from_fn(n, size, |i, j| if i == j { -l.im } else { 0.0 });
    let stack = |top: &LongMatrix, below: &Mat| top.t().hstack(&LongMatrix::from(&below.t())).t();
    let Re = stack(&equations, &part(&rows, |z| z.re));
    let Im = stack(&LongMatrix::from(&turned), &part(&rows, |z| z.im));
    let right = |of: fn(&C64) -> f64| Mat::zeros(n, 1).vstack(&part(&wanted, of));
    let M = Re.hstack(&Im.scale(-1.0)).t().hstack(&Im.hstack(&Re).t()).t();
    let right = right(|z| z.re).vstack(&right(|z| z.im));
    let rows = row_units(&M.high);
    let right = Mat::from_fn(2 * size, 1, |i, _| rows[i] * right[(i, 0)]);
    let solved = M.rescale(&rows, &vec![1.0; 2 * size]).solve(&LongMatrix::from(&right));
    Ok(solved.map(|z| LongVector { re: z.block(0, 0, size, 1), im: z.block(size, 0, size, 1) }))
}

/// Powers of two that bring the largest entry of each row to size one, so that the pivots are chosen among equals.
fn row_units(M: &Mat) -> Vec<f64> {
    let largest = |i: usize| (0..M.ncols()).map(|j| M[(i, j)].abs()).fold(0.0, f64::max);
    (0..M.nrows()).map(|i| unit_power(largest(i))).collect()
}

/// Returns the coordinates of the null vector whose upper part is nearest to `x`: the least squares solution with the upper rows of the basis.
fn coordinates(basis: &CMat, x: &[C64]) -> Vec<C64> {
    let (n, r) = (x.len(), basis.ncols());
    let upper = basis.block(0, 0, n, r);
    let target = CMat::from_fn(n, 1, |i, _| x[i]);
    let normal = &upper.h() * &upper;
    let right = &upper.h() * &target;
    crate::dense::csolve(&normal, &right).map_or_else(|_| right.column(0).to_vec(), |c| c.column(0).to_vec())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_feedback_keeps_its_digits_if_the_eigenvectors_nearly_depend_on_each_other() {
        // A chain of integrators: the gains are the coefficients of (s + 1) (s + 2) ... (s + 8), and the eigenvectors (1, s, s^2, ...) have
        // the condition 1e9.
        let n = 8;
        let A = Mat::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
        let B = Mat::from_fn(n, 1, |i, _| if i + 1 == n { 1.0 } else { 0.0 });
        let eigenvalues: Vec<C64> = (1..=n).map(|k| C64::new(-(k as f64), 0.0)).collect();
        let vectors = CMat::from_fn(n, n, |i, j| eigenvalues[j].powi(i as i32));
        let V = Mat::eye(1);
        let choice = EigenvectorChoice { A: &A, B: &B, V: &V, eigenvalues: &eigenvalues, vectors: &vectors };
        let F = eigenvector_gain(choice).unwrap().unwrap();
        let expected = [40320.0, 109584.0, 118124.0, 67284.0, 22449.0, 4536.0, 546.0, 36.0];
        assert_eq!(F, Mat::row(&expected));
    }
}
