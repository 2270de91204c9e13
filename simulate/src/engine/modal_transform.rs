//! Coordinates in which the linear core falls apart: a small block and pairs.
//!
//! The modes of a structure meet each other through the hub only; in the coordinates of the core's own eigenvectors they
//! do not meet at all, and a step costs each mode the same few operations, however many there are. Eigenvectors of
//! poles that coincide are worthless (a rigid body's double zero, an amplifier's double pole): everything but the
//! oscillating pairs stays together in one block.

use crate::tolerance::{
    FEWEST_MODAL_STATES, LARGEST_HEAD, MODAL_ROUNDING, MODAL_ROUNDING_OF_RATES, OSCILLATES, SKEWEST,
};
use counterpoise_linalg::{C64, Mat, balance, inverse, schur, solve};

/// x = V z, z = W x, W A V = blocks: one of `head` states, then pairs.
pub(crate) struct ModalTransform {
    pub V: Mat,
    pub W: Mat,
    pub blocks: Vec<Mat>,
}

/// Returns the coordinates of a matrix; `None` if it is small, or does not fall apart well.
pub(crate) fn modal(A: &Mat) -> Option<ModalTransform> {
    let n = A.nrows();
    if n < FEWEST_MODAL_STATES {
        return None;
    }
    let balanced = balance(A).ok()?;
    let mut form = schur(&balanced.A).ok()?;
    let together = |pole: C64| pole.im.abs() <= OSCILLATES * pole.norm();
    let head = form.reorder(together).ok()?;
    if head > LARGEST_HEAD || head == 0 {
        return None;
    }
    let skew = decoupling(&form.T, head)?;
    let scale = Mat::diag(&balanced.scale);
    let V = &(&scale * &form.U) * &skew;
    let firsts: Vec<usize> = std::iter::once(0).chain((head..n).step_by(2)).collect();
    let size = |first: usize| if first == 0 { head } else { 2 };
    let blocks = firsts.iter().map(|&k| form.T.block(k, k, size(k), size(k))).collect();
    let W = inverse(&V).ok()?;
    let modal = ModalTransform { V, W, blocks }.refine_coordinates(A)?.refine_coordinates(A)?;
    modal.holds(A, &balanced.scale).then_some(modal)
}

impl ModalTransform {
    /// Returns the coordinates after a step of Newton's method on W A V = blocks. The form that they come from is right to the
    /// rounding of the fastest mode; the rows of slow states, which hold only small numbers, then are as well.
    fn refine_coordinates(self, A: &Mat) -> Option<Self> {
        let n = A.nrows();
        let found = &self.W * &(A * &self.V);
        let mut X = Mat::zeros(n, n);
        let (mut i, mut blocks) = (0, Vec::with_capacity(self.blocks.len()));
        for left in &self.blocks {
            let mut j = 0;
            for right in &self.blocks {
                if i != j {
                    let wrong = found.block(i, j, left.nrows(), right.nrows());
                    X.set_block(i, j, &coupling(left, right, &wrong.scale(-1.0))?);
                }
                j += right.nrows();
            }
            blocks.push(found.block(i, i, left.nrows(), left.nrows()));
            i += left.nrows();
        }
        let V = &self.V + &(&self.V * &X);
        let W = inverse(&V).ok()?;
        Some(Self { V, W, blocks })
    }

    /// Returns whether V blocks W is A, row by row in balanced units.
    fn holds(&self, A: &Mat, scale: &[f64]) -> bool {
        let n = A.nrows();
        let mut apart = Mat::zeros(n, n);
        let mut first = 0;
        for block in &self.blocks {
            apart.set_block(first, first, block);
            first += block.nrows();
        }
        let rebuilt = &(&self.V * &apart) * &self.W;
        (0..n).all(|i| {
            let largest = |entry: &dyn Fn(usize) -> f64| {
                (0..n).map(|j| entry(j).abs() * scale[j] / scale[i]).fold(0.0, f64::max)
            };
            let wrong = largest(&|j| rebuilt[(i, j)] - A[(i, j)]);
            let size = largest(&|j| A[(i, j)]);
            wrong <= if size > 1.0 { MODAL_ROUNDING * size } else { MODAL_ROUNDING_OF_RATES }
        })
    }
}

/// Returns the unit upper triangular S with S^-1 T S of blocks only: block by block, T11 X - X T22 = -T12.
fn decoupling(T: &Mat, head: usize) -> Option<Mat> {
    let n = T.nrows();
    let mut S = Mat::eye(n);
    let mut first = 0;
    while first < n {
        let size = if first == 0 { head } else { 2 };
        let rest = first + size;
        if rest < n {
            let X = couplings(T, first, size)?;
            // the columns of the rest take their share of this block's
            let taken = &S.block(0, first, n, size) * &X;
            S.set_block(0, rest, &(&S.block(0, rest, n, n - rest) + &taken));
        }
        first = rest;
    }
    Some(S)
}

/// X with T11 X - X T22 = -T12 for the block at `first`, pair of columns by pair.
fn couplings(T: &Mat, first: usize, size: usize) -> Option<Mat> {
    let (n, rest) = (T.nrows(), first + size);
    let own = T.block(first, first, size, size);
    let mut X = Mat::zeros(size, n - rest);
    for k in (rest..n).step_by(2) {
        let before = &X.block(0, 0, size, k - rest) * &T.block(rest, k, k - rest, 2);
        let right = &before - &T.block(first, k, size, 2);
        X.set_block(0, k - rest, &coupling(&own, &T.block(k, k, 2, 2), &right)?);
    }
    Some(X)
}

/// X with L X - X R = C.
fn coupling(L: &Mat, R: &Mat, C: &Mat) -> Option<Mat> {
    let (rows, columns) = C.shape();
    // column by column: (I x L - R' x I) vec X = vec C
    let kronecker = Mat::from_fn(rows * columns, rows * columns, |i, j| {
        let (row, column) = (i % rows, j % rows);
        let same = if i / rows == j / rows { L[(row, column)] } else { 0.0 };
        same - if row == column { R[(j / rows, i / rows)] } else { 0.0 }
    });
    let solved = solve(&kronecker, &Mat::col(C.as_slice())).ok()?;
    let good = solved.norm_max() < SKEWEST;
    good.then(|| Mat::from_column_major(rows, columns, solved.as_slice().to_vec()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn modes_that_meet_at_one_point_fall_apart() {
        // four states with a double zero, then damped oscillators, all pushed by one torque
        let n = 20;
        let A = Mat::from_fn(n, n, |i, j| {
            let k = i / 2;
            let own = match (i, j) {
                (0, 1) => 1.0,
                (2, 2) | (3, 3) => -1e3,
                _ if i < 4 => 0.0,
                _ if i % 2 == 0 => f64::from(u8::from(j == i + 1)),
                _ if j + 1 == i => -(300.0 * k as f64).powi(2),
                _ if j == i => -6.0 * k as f64,
                _ => 0.0,
            };
            let rate = if j >= 5 && j % 2 == 1 { 1.0 } else { 0.0 };
            let pushed = if i >= 5 && i % 2 == 1 { 1.0 } else { 0.0 };
            own - pushed * (5.0 * rate + if j == 2 { 1.0 } else { 0.0 })
        });
        let modal = modal(&A).unwrap();
        assert_eq!(modal.blocks[0].nrows(), 4);
        assert!(modal.blocks[1..].iter().all(|block| block.nrows() == 2));
        assert!((&(&modal.V * &modal.W) - &Mat::eye(n)).norm_max() < 1e-9);
    }
}
