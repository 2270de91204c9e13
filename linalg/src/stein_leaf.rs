//! Discrete Lyapunov (Stein) equations of a few dozen unknowns a side, in Schur form, block by block and without copies.
//!
//! The blocks are those of [`crate::lyapunov_leaf`]: in scaled coordinates the four unknowns that two complex pairs couple split into
//! two complex numbers, one multiplied by `1 - l m` and one by `1 - l conj(m)`; no pivots are looked for.

use crate::kernel::vectorised;
use crate::lyapunov_leaf::{Block, Rotation, diagonal, solve_apart, solve_together};
use crate::mat::Mat;

vectorised! {
    /// `T X S' - X + Q = 0` in place of `Q`; `T` and `S` quasi-triangular in standard form.
    pub(crate) fn solve<'a>(T: &'a Mat, S: &'a Mat, X: &'a mut Mat) -> () {
        let (rows, columns) = (diagonal(T), diagonal(S));
        let m = T.nrows();
        for right in columns.iter().rev() {
            let moved = known_columns(S, X, right);
            take_moved(T, &rows, X, right, &moved, m);
            climb(T, X, &rows, right);
        }
    }
}

vectorised! {
    /// `T X T' - X + Q = 0` for symmetric `Q`, of which the upper blocks are read; the whole of `X` is returned.
    pub(crate) fn solve_symmetric<'a>(T: &'a Mat, X: &'a mut Mat) -> () {
        let all = diagonal(T);
        for (index, right) in all.iter().enumerate().rev() {
            let mut moved = known_columns(T, X, right);
            add_rows_below(X, right, &mut moved);
            take_moved(T, &all, X, right, &moved, right.end());
            climb(T, X, &all[..=index], right);
            for column in right.range() {
                (0..right.end()).for_each(|i| X[(column, i)] = X[(i, column)]);
            }
        }
    }
}

/// The block column `X S'` of `right` as far as the columns to the right of it, which are known, make it.
#[inline(always)]
fn known_columns(S: &Mat, X: &Mat, right: &Block) -> [Vec<f64>; 2] {
    let mut sums = [vec![0.0; X.nrows()], vec![0.0; X.nrows()]];
    for (sum, column) in sums.iter_mut().zip(right.range()) {
        for k in right.end()..S.ncols() {
            let factor = S[(column, k)];
            if factor != 0.0 {
                sum.iter_mut().zip(X.column(k)).for_each(|(s, &x)| *s += factor * x);
            }
        }
    }
    sums
}

/// Adds what the rows of the block column below its diagonal block, known by symmetry, make of `X S'`.
#[inline(always)]
fn add_rows_below(X: &Mat, right: &Block, sums: &mut [Vec<f64>; 2]) {
    let [a, b, c, d] = right.entries;
    let j = right.at;
    for i in right.end()..X.nrows() {
        if right.size == 1 {
            sums[0][i] += X[(i, j)] * a;
        } else {
            let (x, y) = (X[(i, j)], X[(i, j + 1)]);
            sums[0][i] += x * a + y * b;
            sums[1][i] += x * c + y * d;
        }
    }
}

/// Adds `T` times `moved` to the first `height` rows of the block column of `right`.
#[inline(always)]
fn take_moved(T: &Mat, rows: &[Block], X: &mut Mat, right: &Block, moved: &[Vec<f64>; 2], height: usize) {
    for (moved, column) in moved.iter().zip(right.range()) {
        let target = &mut X.column_mut(column)[..height];
        for block in rows {
            for k in block.range().filter(|&k| moved[k] != 0.0) {
                let reached = block.end().min(height);
                let factor = moved[k];
                target[..reached].iter_mut().zip(T.column(k)).for_each(|(t, &a)| *t += factor * a);
            }
        }
    }
}

/// The block column of `right`, from its lowest row block upwards.
#[inline(always)]
fn climb(T: &Mat, X: &mut Mat, rows: &[Block], right: &Block) {
    let [a, b, c, d] = right.entries;
    for left in rows.iter().rev() {
        solve_block(X, left, right);
        for l in left.range() {
            // Row l of X times the transposed block.
            let (x, y) = (X[(l, right.at)], if right.size == 2 { X[(l, right.at + 1)] } else { 0.0 });
            let factors = if right.size == 2 { [x * a + y * b, x * c + y * d] } else { [x * a, 0.0] };
            for (factor, column) in factors.into_iter().zip(right.range()) {
                let above = &mut X.column_mut(column)[..left.at];
                above.iter_mut().zip(T.column(l)).for_each(|(t, &a)| *t += factor * a);
            }
        }
    }
}

/// `X - left X right' = C` in place of `C`.
#[inline(always)]
fn solve_block(X: &mut Mat, left: &Block, right: &Block) {
    let (i, j) = (left.at, right.at);
    let s = 1.0 - left.entries[0] * right.entries[0];
    match (left.size, right.size) {
        (1, 1) => X[(i, j)] /= s,
        (2, 1) => {
            let t = -left.rate * right.entries[0];
            let (p, q) = Rotation { s, t }.solve(X[(i, j)], X[(i + 1, j)] / left.scale);
            (X[(i, j)], X[(i + 1, j)]) = (p, q * left.scale);
        }
        (1, 2) => {
            let t = -left.entries[0] * right.rate;
            let (p, q) = Rotation { s, t }.solve(X[(i, j)], X[(i, j + 1)] / right.scale);
            (X[(i, j)], X[(i, j + 1)]) = (p, q * right.scale);
        }
        _ if left.is_round() && right.is_round() => rotate(X, left, right),
        _ => eliminate(X, left, right),
    }
}

/// Two pairs: the product of one eigenvalue with the other, and with its conjugate.
#[inline(always)]
fn rotate(X: &mut Mat, left: &Block, right: &Block) {
    let ((a, w), (b, v)) = ((left.entries[0], left.rate), (right.entries[0], right.rate));
    let apart = [
        Rotation { s: 1.0 - a * b - w * v, t: w * b - a * v },
        Rotation { s: 1.0 - a * b + w * v, t: -(w * b + a * v) },
    ];
    solve_apart(X, left, right, apart);
}

/// The four equations as they stand, with complete pivoting.
fn eliminate(X: &mut Mat, left: &Block, right: &Block) {
    let [a, b, c, d] = left.entries;
    let [e, f, g, h] = right.entries;
    let system = [
        [1.0 - a * e, -b * e, -a * f, -b * f],
        [-c * e, 1.0 - d * e, -c * f, -d * f],
        [-a * g, -b * g, 1.0 - a * h, -b * h],
        [-c * g, -d * g, -c * h, 1.0 - d * h],
    ];
    solve_together(X, left, right, system);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quasi-triangular with real eigenvalues, round blocks and slender ones, all inside the unit circle.
    fn form(n: usize, shift: f64) -> Mat {
        let mut T =
            Mat::from_fn(n, n, |i, j| if i < j { ((3 * i + 5 * j) % 7) as f64 / 35.0 - 0.08 } else { 0.0 });
        for k in 0..n {
            T[(k, k)] = shift - 0.9 * ((k / 3) % 5) as f64 / 4.0;
        }
        for k in (1..n - 1).step_by(3) {
            T[(k + 1, k + 1)] = T[(k, k)];
            let scale = [1.0, 3.0, 200.0][k % 3];
            (T[(k, k + 1)], T[(k + 1, k)]) = (0.4 * scale, -0.4 / scale);
        }
        T
    }

    #[test]
    fn both_solvers_pass_their_definition() {
        for (m, n) in [(7, 10), (10, 7), (3, 22), (31, 31), (1, 1), (2, 5)] {
            let (T, S) = (form(m, 0.5), form(n, 0.4));
            let C = Mat::from_fn(m, n, |i, j| ((i + 2 * j) % 5) as f64 - 2.0);
            let mut X = C.clone();
            solve(&T, &S, &mut X);
            let size = (T.norm_fro() * S.norm_fro() + 1.0) * X.norm_fro();
            assert!((&T * &X * S.t() - &X + &C).norm_fro() < 1e-14 * size, "{m} {n}");
            let C = Mat::from_fn(n, n, |i, j| ((i + j) % 5) as f64 - 2.0);
            let mut X = C.clone();
            solve_symmetric(&S, &mut X);
            let size = (S.norm_fro() * S.norm_fro() + 1.0) * X.norm_fro();
            assert!((&S * &X * S.t() - &X + &C).norm_fro() < 2e-14 * size, "{n}");
            assert_eq!(X, X.t());
        }
    }
}
