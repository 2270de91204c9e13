//! The zeros of a system by eliminations whose ranks are decided entry by entry.
//!
//! A coupling counts as zero only if it cancelled to rounding error of the numbers it was summed from, so that time constants and
//! gains many decades apart do not blur the ranks, as they blur singular values.

use crate::components::components;
use crate::error::OperationContext;
use crate::root_order::sort_roots;
use crate::scaling::balance;
use crate::tracked_matrix::{Pivot, TrackedMatrix, eliminate, solve_pivots};
use crate::{C64, Error, Mat, StateSpace};
use counterpoise_linalg as linalg;

/// The matrices of a system that remember what their entries were summed from.
struct TrackedSystem {
    A: TrackedMatrix,
    B: TrackedMatrix,
    C: TrackedMatrix,
    D: TrackedMatrix,
}

/// Zeros, and whether they rest on sums that count as zero although they are more than rounding.
pub(crate) struct EntrywiseZeros {
    /// The finite invariant zeros, sorted by real, then imaginary part.
    pub(crate) zeros: Vec<C64>,
    /// `true` if no such sum was met.
    pub(crate) are_clear: bool,
}

/// Returns the finite invariant zeros. A sum below the share `cancelled` of its terms counts as zero.
///
/// # Errors
/// Returns [`Error::Matrix`] if a decomposition fails.
pub(crate) fn entrywise_zeros(g: &StateSpace, cancelled: f64) -> Result<EntrywiseZeros, Error> {
    let whole = [&g.A, &g.B, &g.C, &g.D].map(|M| TrackedMatrix::with_share(M.clone(), cancelled));
    let [A, B, C, D] = whole;
    let rows = TrackedSystem { A, B, C, D }.compress()?;
    let square = rows.dual().compress()?.dual();
    let TrackedSystem { A, B, C, D } = &square;
    let are_clear = ![A, B, C, D].into_iter().any(|M| M.lost_more_than_rounding);
    Ok(EntrywiseZeros { zeros: square.eigenvalues(g)?, are_clear })
}

impl TrackedSystem {
    /// Returns the system with inputs and outputs exchanged.
    fn dual(&self) -> Self {
        Self { A: self.A.t(), B: self.C.t(), C: self.B.t(), D: self.D.t() }
    }

    /// Returns the system without the states and outputs that hide the zeros: its direct path has full row
    /// rank.
    fn compress(mut self) -> Result<Self, Error> {
        loop {
            let mut hidden: Vec<usize> = (0..self.C.value.nrows()).collect();
            let mut inputs: Vec<usize> = (0..self.B.value.ncols()).collect();
            eliminate(&mut self.D, &mut [&mut self.C], &mut hidden, &mut inputs);
            if hidden.is_empty() {
                return Ok(self);
            }
            let direct: Vec<usize> = (0..self.C.value.nrows()).filter(|i| !hidden.contains(i)).collect();
            let mut states: Vec<usize> = (0..self.A.value.nrows()).collect();
            let pivots = eliminate(&mut self.C, &mut [], &mut hidden, &mut states);
            self = self.without(&direct, &pivots)?;
            if pivots.is_empty() {
                return Ok(self);
            }
        }
    }

    /// Returns the outputs `direct` and the states that the pivots, in rows of outputs and columns of states, do not determine, x_p = -X x. The
    /// equations of the states that are gone become outputs.
    fn without(self, direct: &[usize], pivots: &[Pivot]) -> Result<Self, Error> {
        let gone: Vec<usize> = pivots.iter().map(|pivot| pivot.column).collect();
        let kept: Vec<usize> = (0..self.A.value.nrows()).filter(|j| !gone.contains(j)).collect();
        let inputs: Vec<usize> = (0..self.B.value.ncols()).collect();
        let outputs: Vec<usize> = (0..self.C.value.nrows()).collect();
        let X = solve_pivots(&self.C.value, pivots, &self.C.value.select(&outputs, &kept))
            .with_operation("zeros")?;
        let rows = |M: &TrackedMatrix, rows: &[usize]| {
            M.select(rows, &kept).minus_product(&M.select(rows, &gone), &X)
        };
        let (A, lost) = (rows(&self.A, &kept), rows(&self.A, &gone));
        let (B, driven) = (self.B.select(&kept, &inputs), self.B.select(&gone, &inputs));
        // x_p + X x vanishes, and so does its derivative.
        let (seen, reached) = (lost.plus_product(&X, &A), driven.plus_product(&X, &B));
        let C = rows(&self.C, direct).vstack(&seen);
        let D = self.D.select(direct, &inputs).vstack(&reached);
        Ok(Self { A, B, C, D })
    }

    /// Returns the eigenvalues of `A - B D^-1 C` for an invertible `D`, group by group of states.
    fn eigenvalues(mut self, g: &StateSpace) -> Result<Vec<C64>, Error> {
        let mut outputs: Vec<usize> = (0..self.C.value.nrows()).collect();
        let mut inputs: Vec<usize> = (0..self.B.value.ncols()).collect();
        let pivots = eliminate(&mut self.D, &mut [&mut self.C], &mut outputs, &mut inputs);
        let K = solve_pivots(&self.D.value, &pivots, &self.C.value).with_operation("zeros")?;
        let driving: Vec<usize> = pivots.iter().map(|pivot| pivot.column).collect();
        let states: Vec<usize> = (0..self.A.value.nrows()).collect();
        let A = self.A.minus_product(&self.B.select(&states, &driving), &K).value;
        let n = A.nrows();
        let alone = StateSpace::new(A, Mat::zeros(n, 0), Mat::zeros(0, n), Mat::zeros(0, 0), g.timebase)?;
        let A = balance(&alone).0.A;
        let mut zeros = Vec::with_capacity(n);
        for group in components(&A) {
            zeros.extend(linalg::eigenvalues(&A.select(&group, &group)).with_operation("zeros")?);
        }
        sort_roots(&mut zeros);
        Ok(zeros)
    }
}
