//! A structure with sparse matrices, and its stiffness with the hub clamped.

use counterpoise_linalg as linalg;
use counterpoise_linalg::{
    Mat, Sparse, SparseCholesky,
    sparse::{Analysis, ProgressObserver, StageProgress},
};

use super::fe::{FeModel, NodeRows};
use crate::Error;

/// A structure with sparse matrices; the fields mean what those of [`FeModel`] do.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseStructure {
    /// Mass matrix, n x n, symmetric.
    pub M: Sparse,
    /// Stiffness matrix, n x n, symmetric.
    pub K: Sparse,
    /// Damping matrix, n x n, if one was given.
    pub C: Option<Sparse>,
    /// The unknowns of the rigid upward translation by 1 m.
    pub heave: Vec<f64>,
    /// The unknowns of the rigid nose-up rotation by 1 rad about the pivot.
    pub pitch: Vec<f64>,
    /// The unknowns at the hub.
    pub hub: NodeRows,
    /// The unknowns at the tip.
    pub tip: NodeRows,
    /// Distance of the tip from the pivot, m.
    pub tip_arm_m: f64,
    /// The unknowns of all nodes that have a deflection and a rotation, by their position.
    pub nodes: Vec<NodeRows>,
}

impl SparseStructure {
    /// Returns the same structure with dense matrices.
    pub fn dense(&self) -> FeModel {
        FeModel {
            M: self.M.to_dense(),
            K: self.K.to_dense(),
            C: self.C.as_ref().map(Sparse::to_dense),
            heave: self.heave.clone(),
            pitch: self.pitch.clone(),
            hub: Some(self.hub),
            tip: self.tip,
            tip_arm_m: self.tip_arm_m,
            truncation: None,
        }
    }

    /// heave and pitch as columns.
    pub(super) fn rigid_motions(&self) -> Mat {
        Mat::col(&self.heave).hstack(&Mat::col(&self.pitch))
    }
}

/// The stiffness with the hub clamped, factorised.
pub(super) struct ClampedStiffness {
    factor: SparseCholesky,
    free: Vec<usize>,
    size: usize,
}

impl ClampedStiffness {
    pub(super) fn of(structure: &SparseStructure, watch: &mut ProgressObserver) -> Result<Self, Error> {
        let (size, hub) = (structure.heave.len(), structure.hub);
        let free: Vec<usize> = (0..size).filter(|&i| i != hub.deflection && i != hub.rotation).collect();
        let stage = "factorising the stiffness matrix";
        if watch(StageProgress { stage, done: 0, of: 100 }).is_break() {
            return Err(linalg::Error::Cancelled { what: stage }.into());
        }
        let K = structure.K.select(&free);
        let factor =
            SparseCholesky::with_progress(&K, Analysis::of(&K, &[])?, stage, watch).map_err(|error| {
                match error {
                    linalg::Error::NotPositiveDefinite { .. } => {
                        Error::MovesFreely { support: "the structure clamped at its hub" }
                    }
                    other => other.into(),
                }
            })?;
        Ok(Self { factor, free, size })
    }

    /// The displacements under the given loads, zero at the hub.
    pub(super) fn solve(&self, loads: &Mat) -> Mat {
        self.extend_rows(&self.factor.solve(&self.inner(loads)))
    }

    /// The unknowns that are free.
    pub(super) fn free_unknowns(&self) -> &[usize] {
        &self.free
    }

    /// The rows of the free unknowns.
    pub(super) fn inner(&self, whole: &Mat) -> Mat {
        Mat::from_fn(self.free.len(), whole.ncols(), |i, j| whole[(self.free[i], j)])
    }

    /// The rows of the free unknowns among all, zero at the hub.
    pub(super) fn extend_rows(&self, inner: &Mat) -> Mat {
        let mut out = Mat::zeros(self.size, inner.ncols());
        for j in 0..inner.ncols() {
            let column = out.column_mut(j);
            self.free.iter().zip(inner.column(j)).for_each(|(&i, &x)| column[i] = x);
        }
        out
    }
}

/// The columns made orthonormal in the inner product of M, twice; those that keep less than a share
/// of their length are left out.
pub(super) fn orthonormal(M: &Sparse, X: &Mat, least: f64) -> Result<Mat, Error> {
    let n = X.nrows();
    let mut out = Mat::zeros(n, 0);
    for j in 0..X.ncols() {
        let mut x = X.block(0, j, n, 1);
        let before = (x.t() * M.times(&x))[(0, 0)].sqrt();
        for _ in 0..2 {
            x -= &(&out * &linalg::transpose_times(&out, &M.times(&x))?);
        }
        let length = (x.t() * M.times(&x))[(0, 0)].max(0.0).sqrt();
        if length > least * before {
            out = out.hstack(&x.scale(1.0 / length));
        }
    }
    Ok(out)
}
