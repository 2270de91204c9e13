//! The resolvent of a real Schur form: a quarter of the operations of a factorisation at each point.

use super::Schur;
use crate::mat::{C64, CMat};

impl Schur {
    /// Returns `(s I - T)^-1`, quasi-triangular as `T` is; that of the matrix itself is `U (s I - T)^-1 U'`. Cost about n^3 / 3 products of a
    /// real and a complex number.
    ///
    /// Returns `None` if `s` is an eigenvalue to the last bit, or so near that the inverse overflows.
    pub fn resolvent(&self, s: C64) -> Option<CMat> {
        let n = self.T.nrows();
        let blocks = self.inverted_blocks(s)?;
        let mut inverse = CMat::zeros(n, n);
        for (last, block) in blocks.iter().enumerate() {
            for j in block.top..block.top + block.size {
                let column = inverse.column_mut(j);
                column[j] = C64::new(1.0, 0.0);
                blocks[..=last].iter().rev().for_each(|block| self.eliminate(block, column));
            }
        }
        inverse.is_finite().then_some(inverse)
    }

    /// Solves for the unknowns of a block and takes their share from the rows above it.
    fn eliminate(&self, block: &BlockInverse, x: &mut [C64]) {
        let (above, own) = x.split_at_mut(block.top);
        if block.size == 1 {
            own[0] *= block.entries[0];
            let known = own[0];
            above.iter_mut().zip(self.T.column(block.top)).for_each(|(x, t)| *x += known * *t);
            return;
        }
        let [a, b, c, d] = block.entries;
        let [x0, x1] = [a * own[0] + b * own[1], c * own[0] + d * own[1]];
        (own[0], own[1]) = (x0, x1);
        let columns = self.T.column(block.top).iter().zip(self.T.column(block.top + 1));
        above.iter_mut().zip(columns).for_each(|(x, (t0, t1))| *x += x0 * *t0 + x1 * *t1);
    }

    /// The blocks of `s I - T` on the diagonal, each inverted.
    fn inverted_blocks(&self, s: C64) -> Option<Vec<BlockInverse>> {
        let (T, n) = (&self.T, self.T.nrows());
        let zero = C64::new(0.0, 0.0);
        let mut blocks = Vec::with_capacity(n);
        let mut top = 0;
        while top < n {
            let is_pair = top + 1 < n && T[(top + 1, top)] != 0.0;
            let first = s - T[(top, top)];
            let (size, entries) = if is_pair {
                let second = s - T[(top + 1, top + 1)];
                let [upper, lower] = [T[(top, top + 1)], T[(top + 1, top)]];
                let determinant = first * second - upper * lower;
                (2, [second, upper.into(), lower.into(), first].map(|entry| entry / determinant))
            } else {
                (1, [first.inv(), zero, zero, zero])
            };
            if !entries.iter().all(|entry| entry.is_finite()) {
                return None;
            }
            blocks.push(BlockInverse { top, size, entries });
            top += size;
        }
        Some(blocks)
    }
}

/// The inverse of a block on the diagonal, by rows; of a single entry the first.
struct BlockInverse {
    top: usize,
    size: usize,
    entries: [C64; 4],
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::dense::csolve;
    use crate::mat::Mat;
    use crate::schur::schur;

    #[test]
    fn it_is_the_inverse_that_a_factorisation_gives() {
        for n in [0, 1, 2, 3, 8, 25] {
            let A = Mat::from_fn(n, n, |i, j| ((7 * i + 3 * j + i * j) % 11) as f64 - 5.0);
            let form = schur(&A).unwrap();
            for s in [C64::new(0.0, 3.0), C64::new(-0.4, 0.1), C64::new(80.0, -7.0)] {
                let U = form.U.to_complex();
                let found = &(&U * &form.resolvent(s).unwrap()) * &U.t();
                let shifted = CMat::eye(n).scale(s) - A.to_complex();
                let expected = csolve(&shifted, &CMat::eye(n)).unwrap();
                assert!((&found - &expected).norm_fro() <= 1e-12 * expected.norm_fro(), "{n} {s}");
            }
        }
    }

    #[test]
    fn an_eigenvalue_has_none() {
        let form = schur(&Mat::from_rows(&[[0.0, 2.0], [-2.0, 0.0]])).unwrap();
        assert_eq!(form.resolvent(C64::new(0.0, 2.0)), None);
        assert_eq!(schur(&Mat::diag(&[3.0, 1.0])).unwrap().resolvent(C64::new(1.0, 0.0)), None);
    }
}
