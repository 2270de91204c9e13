//! Lyapunov equations of a few dozen unknowns a side, in Schur form, block by block and without copies.
//!
//! Two complex pairs couple four unknowns. A standardised block is a rotation in a scaled coordinate, and in the scaled
//! coordinates the four split into two pairs, each with an orthogonal solution; no pivots are looked for.

use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::schur::{DiagonalBlock, blocks};
use crate::small_systems::solve_complete;
use crate::tolerance::ROUND;

vectorised! {
    /// `T X + X S' = C` in place of `C`; `T` and `S` quasi-triangular in standard form.
    pub(crate) fn solve<'a>(T: &'a Mat, S: &'a Mat, X: &'a mut Mat) -> () {
        let (rows, columns) = (diagonal(T), diagonal(S));
        let m = T.nrows();
        for right in columns.iter().rev() {
            for column in right.range() {
                take_columns(S, X, right.end(), column, m);
            }
            solve_block_column(T, X, &rows, right);
        }
    }
}

vectorised! {
    /// `T X + X T' = C` for symmetric `C`, of which the upper blocks are read; the whole of `X` is returned.
    pub(crate) fn solve_symmetric<'a>(T: &'a Mat, X: &'a mut Mat) -> () {
        let all = diagonal(T);
        for (index, right) in all.iter().enumerate().rev() {
            for column in right.range() {
                take_columns(T, X, right.end(), column, right.end());
                take_rows_below(T, X, right.end(), column);
            }
            solve_block_column(T, X, &all[..=index], right);
            for column in right.range() {
                (0..right.end()).for_each(|i| X[(column, i)] = X[(i, column)]);
            }
        }
    }
}

/// The columns from `end` on, which are known, taken out of the first `height` rows of `column`.
#[inline(always)]
fn take_columns(S: &Mat, X: &mut Mat, end: usize, column: usize, height: usize) {
    let (ld, n) = X.shape();
    let (before, known) = X.as_mut_slice().split_at_mut(end * ld);
    let target = &mut before[column * ld..column * ld + height];
    for (k, source) in (end..n).zip(known.chunks_exact(ld)) {
        let factor = S[(column, k)];
        if factor != 0.0 {
            target.iter_mut().zip(source).for_each(|(t, &x)| *t -= factor * x);
        }
    }
}

/// The rows of `column` from `end` on, known by symmetry, taken out of those above.
#[inline(always)]
fn take_rows_below(T: &Mat, X: &mut Mat, end: usize, column: usize) {
    let (above, known) = X.column_mut(column).split_at_mut(end);
    for (l, &factor) in (end..T.nrows()).zip(known.iter()) {
        if factor != 0.0 {
            above.iter_mut().zip(T.column(l)).for_each(|(t, &a)| *t -= factor * a);
        }
    }
}

/// The block column of `right`, from its lowest row block upwards.
#[inline(always)]
pub(crate) fn solve_block_column(T: &Mat, X: &mut Mat, rows: &[Block], right: &Block) {
    for left in rows.iter().rev() {
        solve_block(X, left, right);
        for column in right.range() {
            let (above, found) = X.column_mut(column).split_at_mut(left.at);
            for (l, &factor) in left.range().zip(found.iter()) {
                above.iter_mut().zip(T.column(l)).for_each(|(t, &a)| *t -= factor * a);
            }
        }
    }
}

/// A diagonal block `D (a I + rate [0 1; -1 0]) D^-1` with `D = diag(1, scale)`; a real eigenvalue has no rate.
pub(crate) struct Block {
    pub(crate) at: usize,
    pub(crate) size: usize,
    /// Row by row.
    pub(crate) entries: [f64; 4],
    pub(crate) rate: f64,
    pub(crate) scale: f64,
}

impl Block {
    /// A real eigenvalue that stands at the first column.
    pub(crate) fn real(eigenvalue: f64) -> Self {
        Self { at: 0, size: 1, entries: [eigenvalue, 0.0, 0.0, 0.0], rate: 0.0, scale: 1.0 }
    }

    /// The complex pair `[a b; c a]`, `b c < 0`.
    pub(crate) fn pair(at: usize, [a, b, c]: [f64; 3]) -> Self {
        let rate = (b.abs().sqrt() * c.abs().sqrt()).copysign(b);
        Self { at, size: 2, entries: [a, b, c, a], rate, scale: c.abs().sqrt() / b.abs().sqrt() }
    }

    pub(crate) fn end(&self) -> usize {
        self.at + self.size
    }

    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.at..self.end()
    }

    /// Returns whether the scaled coordinate is good: a block far from a rotation is left to elimination.
    pub(crate) fn is_round(&self) -> bool {
        (1.0 / ROUND..ROUND).contains(&self.scale)
    }
}

pub(crate) fn diagonal(T: &Mat) -> Vec<Block> {
    let block = |DiagonalBlock { start: k, size }| {
        if size == 1 {
            return Block { at: k, ..Block::real(T[(k, k)]) };
        }
        // The lower diagonal entry as it stands: equal to the upper one up to rounding.
        let block = Block::pair(k, [T[(k, k)], T[(k, k + 1)], T[(k + 1, k)]]);
        let [a, b, c, _] = block.entries;
        Block { entries: [a, b, c, T[(k + 1, k + 1)]], ..block }
    };
    blocks(T).into_iter().map(block).collect()
}

/// The matrix `[s t; -t s]`: a scaled rotation.
pub(crate) struct Rotation {
    pub(crate) s: f64,
    pub(crate) t: f64,
}

impl Rotation {
    /// The solution p, q of `s p + t q = P`, `s q - t p = Q`.
    #[inline(always)]
    pub(crate) fn solve(&self, P: f64, Q: f64) -> (f64, f64) {
        // Divided by the larger first: the squares of large rates stay in range.
        let size = self.s.abs().max(self.t.abs());
        let (c, d) = (self.s / size, self.t / size);
        let whole = (c * c + d * d) * size;
        ((c * P - d * Q) / whole, (c * Q + d * P) / whole)
    }
}

#[inline(always)]
fn solve_block(X: &mut Mat, left: &Block, right: &Block) {
    let (i, j, s) = (left.at, right.at, left.entries[0] + right.entries[0]);
    match (left.size, right.size) {
        (1, 1) => X[(i, j)] /= s,
        (2, 1) => {
            let (p, q) = Rotation { s, t: left.rate }.solve(X[(i, j)], X[(i + 1, j)] / left.scale);
            (X[(i, j)], X[(i + 1, j)]) = (p, q * left.scale);
        }
        (1, 2) => {
            let (p, q) = Rotation { s, t: right.rate }.solve(X[(i, j)], X[(i, j + 1)] / right.scale);
            (X[(i, j)], X[(i, j + 1)]) = (p, q * right.scale);
        }
        _ if left.is_round() && right.is_round() => rotate(X, left, right),
        _ => eliminate(X, left, right),
    }
}

/// Two pairs: the sum and the difference of the rates drive them apart.
#[inline(always)]
fn rotate(X: &mut Mat, left: &Block, right: &Block) {
    let s = left.entries[0] + right.entries[0];
    solve_apart(
        X,
        left,
        right,
        [Rotation { s, t: right.rate - left.rate }, Rotation { s, t: right.rate + left.rate }],
    );
}

/// Two pairs in scaled coordinates, in which the four unknowns split into two complex numbers, each with its rotation.
#[inline(always)]
pub(crate) fn solve_apart(X: &mut Mat, left: &Block, right: &Block, [first, second]: [Rotation; 2]) {
    let (i, j) = (left.at, right.at);
    let (g, h) = (left.scale, right.scale);
    let (e11, e21) = (X[(i, j)], X[(i + 1, j)] / g);
    let (e12, e22) = (X[(i, j + 1)] / h, X[(i + 1, j + 1)] / (g * h));
    let (p, q) = first.solve(e11 + e22, e12 - e21);
    let (u, v) = second.solve(e11 - e22, e12 + e21);
    X[(i, j)] = 0.5 * (p + u);
    X[(i + 1, j)] = 0.5 * (v - q) * g;
    X[(i, j + 1)] = 0.5 * (q + v) * h;
    X[(i + 1, j + 1)] = 0.5 * (p - u) * (g * h);
}

/// The four equations as they stand, with complete pivoting.
fn eliminate(X: &mut Mat, left: &Block, right: &Block) {
    let [a, b, c, d] = left.entries;
    let [e, f, g, h] = right.entries;
    let system = [[a + e, b, f, 0.0], [c, d + e, 0.0, f], [g, 0.0, a + h, b], [0.0, g, c, d + h]];
    solve_together(X, left, right, system);
}

/// The four unknowns that two blocks couple, column by column, from their equations.
pub(crate) fn solve_together(X: &mut Mat, left: &Block, right: &Block, mut system: [[f64; 4]; 4]) {
    let (i, j) = (left.at, right.at);
    let mut x = [X[(i, j)], X[(i + 1, j)], X[(i, j + 1)], X[(i + 1, j + 1)]];
    solve_complete(&mut system, &mut x, 4);
    [X[(i, j)], X[(i + 1, j)], X[(i, j + 1)], X[(i + 1, j + 1)]] = x;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quasi-triangular with real eigenvalues, round blocks and slender ones.
    fn form(n: usize, shift: f64) -> Mat {
        let mut T =
            Mat::from_fn(n, n, |i, j| if i < j { ((3 * i + 5 * j) % 7) as f64 / 7.0 - 0.4 } else { 0.0 });
        for k in 0..n {
            T[(k, k)] = -shift - (k / 3) as f64;
        }
        for k in (1..n - 1).step_by(3) {
            T[(k + 1, k + 1)] = T[(k, k)];
            let scale = [1.0, 3.0, 200.0][k % 3];
            (T[(k, k + 1)], T[(k + 1, k)]) = (2.0 * scale, -2.0 / scale);
        }
        T
    }

    #[test]
    fn both_solvers_pass_their_definition() {
        for (m, n) in [(7, 10), (10, 7), (3, 22), (31, 31)] {
            let (T, S) = (form(m, 0.3), form(n, 0.1));
            let C = Mat::from_fn(m, n, |i, j| ((i + 2 * j) % 5) as f64 - 2.0);
            let mut X = C.clone();
            solve(&T, &S, &mut X);
            let size = (T.norm_fro() + S.norm_fro()) * X.norm_fro();
            assert!((&T * &X + &X * S.t() - &C).norm_fro() < 1e-14 * size, "{m} {n}");
            let C = Mat::from_fn(n, n, |i, j| ((i + j) % 5) as f64 - 2.0);
            let mut X = C.clone();
            solve_symmetric(&S, &mut X);
            assert!((&S * &X + &X * S.t() - &C).norm_fro() < 2e-14 * S.norm_fro() * X.norm_fro(), "{n}");
            assert_eq!(X, X.t());
        }
    }
}
