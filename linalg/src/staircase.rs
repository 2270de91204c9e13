//! The states of a system that the inputs reach and the outputs see, by staircases of similarity transformations in 32 digits.
//!
//! A staircase in doubles divides rounding errors by every coupling that it has passed: after a few small ones, what is left of a part out of reach
//! looks like a coupling. Source: P. Van Dooren, The generalized eigenstructure problem in linear system theory, IEEE Trans. Automat. Control 26
//! (1981); here each step takes the singular vectors of doubles as they are and eliminates what they leave.

use crate::decomposition::svd;
use crate::error::{Error, check_shape, check_square};
use crate::long_matrix::LongMatrix;
use crate::mat::Mat;

/// The part of a system that is reached and seen, and the numbers that it rests on.
#[derive(Clone, Debug)]
pub struct MinimalPart {
    /// Dynamics matrix, r x r.
    pub A: Mat,
    /// Input matrix, r x m.
    pub B: Mat,
    /// Output matrix, p x r.
    pub C: Mat,
    /// Number of states that the inputs reach.
    pub reached: usize,
    /// The smallest singular value that counts as a coupling, relative to the norm of its matrix; 1 if there is none.
    pub smallest_kept: f64,
    /// The largest singular value that counts as zero, likewise; 0 if there is none.
    pub largest_dropped: f64,
}

/// Returns the part of `x' = A x + B u`, `y = C x` that is reached and seen; `A` n x n, `B` n x m, `C` p x n, the entries taken as exact.
///
/// A coupling counts if its singular value exceeds `tolerance` times the norm of the matrix that it comes from (`A`, `B` or `C`, Frobenius). The
/// states of the part are not orthogonal combinations of the given ones to the last digit. Cost: some 100 n^4 operations of doubles.
///
/// # Errors
/// Returns an error if shapes do not fit, an entry is not finite, or the iteration for singular values fails.
pub fn minimal_part(A: &Mat, B: &Mat, C: &Mat, tolerance: f64) -> Result<MinimalPart, Error> {
    check_square("A", A)?;
    check_shape("B", B, A.nrows(), B.ncols())?;
    check_shape("C", C, C.nrows(), A.nrows())?;
    let size = |M: &Mat| M.norm_fro().max(f64::MIN_POSITIVE);
    let mut staircase = Staircase {
        A: A.into(),
        B: B.into(),
        C: C.into(),
        tolerance,
        smallest_kept: 1.0,
        largest_dropped: 0.0,
    };
    staircase.keep_reached(size(A), size(B))?;
    let reached = staircase.A.high.nrows();
    staircase.transpose();
    staircase.keep_reached(size(A), size(C))?;
    staircase.transpose();
    Ok(MinimalPart {
        A: staircase.A.round(),
        B: staircase.B.round(),
        C: staircase.C.round(),
        reached,
        smallest_kept: staircase.smallest_kept,
        largest_dropped: staircase.largest_dropped,
    })
}

/// A system on its way to staircase form.
struct Staircase {
    A: LongMatrix,
    B: LongMatrix,
    C: LongMatrix,
    tolerance: f64,
    smallest_kept: f64,
    largest_dropped: f64,
}

impl Staircase {
    /// Takes the dual system.
    fn transpose(&mut self) {
        self.A = self.A.t();
        (self.B, self.C) = (self.C.t(), self.B.t());
    }

    /// Keeps the states that the inputs reach: each stair holds those that the one before it drives. The sizes are norms of the whole `A` and `B`.
    fn keep_reached(&mut self, A_size: f64, B_size: f64) -> Result<(), Error> {
        let n = self.A.high.nrows();
        let (mut done, mut driving, mut size) = (0, self.B.clone(), B_size);
        while done < n && driving.high.ncols() > 0 {
            let Some(stair) = self.stair(&driving, size)? else { break };
            let (T, inverse) = (embed_in_identity(&stair.T, n), embed_in_identity(&stair.inverse, n));
            self.A = inverse.times(&self.A.times(&T));
            self.B = inverse.times(&self.B);
            self.C = self.C.times(&T);
            let next = done + stair.rank;
            driving = self.A.block(next, done, n - next, stair.rank);
            (done, size) = (next, A_size);
        }
        self.A = self.A.block(0, 0, done, done);
        self.B = self.B.block(0, 0, done, self.B.high.ncols());
        self.C = self.C.block(0, 0, self.C.high.nrows(), done);
        Ok(())
    }

    /// Returns the transformation after which the first states alone are driven; `None` if nothing is driven.
    fn stair(&mut self, driving: &LongMatrix, size: f64) -> Result<Option<Stair>, Error> {
        let (rows, cols) = driving.high.shape();
        // A square matrix, so that all left singular vectors are computed.
        let padded = driving.round().hstack(&Mat::zeros(rows, rows.saturating_sub(cols)));
        let parts = svd(&padded.scale(1.0 / size))?;
        let values = &parts.s[..rows.min(cols)];
        let rank = values.iter().filter(|&&value| value > self.tolerance).count();
        self.smallest_kept = values[..rank].iter().copied().fold(self.smallest_kept, f64::min);
        self.largest_dropped = values[rank..].iter().copied().fold(self.largest_dropped, f64::max);
        if rank == 0 {
            return Ok(None);
        }
        let singular = Error::Singular { what: "a matrix of singular vectors", rcond: 0.0 };
        let (U, V) = (LongMatrix::from(&parts.U), LongMatrix::from(&parts.V.block(0, 0, cols, rank)));
        let inverse = U.solve(&LongMatrix::identity(rows, 1.0)).ok_or(singular.clone())?;
        let image = inverse.times(&driving.times(&V));
        let (top, bottom) = (image.block(0, 0, rank, rank), image.block(rank, 0, rows - rank, rank));
        // What the rounded singular vectors leave below is a multiple of what stands above.
        let multiple = top.t().solve(&bottom.t()).ok_or(singular)?.t();
        let lower = |sign: f64| {
            let mut L = LongMatrix::identity(rows, 1.0);
            L.set_block(rank, 0, &multiple.scale(sign));
            L
        };
        Ok(Some(Stair { T: U.times(&lower(1.0)), inverse: lower(-1.0).times(&inverse), rank }))
    }
}

/// A change of coordinates `x = T z` of the last states, after which the first `rank` of them alone are driven.
struct Stair {
    T: LongMatrix,
    inverse: LongMatrix,
    rank: usize,
}

/// Returns the identity of size `n` with a matrix in the place of its last rows and columns.
fn embed_in_identity(T: &LongMatrix, n: usize) -> LongMatrix {
    let first = n - T.high.nrows();
    let mut whole = LongMatrix::identity(n, 1.0);
    whole.set_block(first, first, T);
    whole
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_part_out_of_sight_behind_small_couplings_is_no_coupling() {
        // Five of the eight states are reached and two of them are seen, in rotated whole numbers. In doubles the second staircase is left with
        // 2e-10 in the place of a zero.
        let A = Mat::from_rows(&[
            &[178.0, 197.0, 118.0, 11.0, 19.0, -51.0, -13.0, 56.0],
            &[-213.0, -238.0, -140.0, -3.0, -16.0, 64.0, 18.0, -60.0],
            &[94.0, 110.0, 70.0, -17.0, 5.0, -37.0, -15.0, 19.0],
            &[151.0, 158.0, 95.0, 2.0, 16.0, -40.0, -11.0, 46.0],
            &[20.0, 19.0, 8.0, 13.0, -1.0, 0.0, 3.0, 11.0],
            &[-82.0, -82.0, -42.0, -15.0, -5.0, 11.0, 3.0, -29.0],
            &[-121.0, -119.0, -59.0, -24.0, -14.0, 24.0, -7.0, -43.0],
            &[-170.0, -178.0, -114.0, -13.0, -27.0, 43.0, 13.0, -61.0],
        ]);
        let B = Mat::col(&[3.5, -1.0, -0.5, 0.5, 3.0, 4.0, -4.0, -5.0]);
        let C = Mat::row(&[9.0, 9.0, 5.5, -4.5, -1.0, -3.5, -1.5, 0.5]);
        let part = minimal_part(&A, &B, &C, 1e-11).unwrap();
        assert_eq!((part.reached, part.A.nrows()), (5, 2));
        assert!(part.largest_dropped < 1e-20 && part.smallest_kept > 1e-4, "{part:?}");
        // The Markov parameters are those of the system.
        let (mut x, mut z) = (B, part.B.clone());
        for _ in 0..6 {
            let (given, found) = ((&C * &x)[(0, 0)], (&part.C * &z)[(0, 0)]);
            assert!((found - given).abs() < 1e-10 * given.abs().max(1.0), "{found} {given}");
            (x, z) = (&A * &x, &part.A * &z);
        }
    }
}
