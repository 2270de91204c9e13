//! The lowest modes of a large structure `K x = w^2 M x`.
//!
//! Method: block Lanczos iteration on `K^-1 M` with complete reorthogonalisation in the inner product of `M` (Ericsson and Ruhe,
//! Math. Comp. 35 (1980) 1251; Grimes, Lewis and Simon, SIAM J. Matrix Anal. 15 (1994) 228). Rigid motions are known and are kept
//! out, so that `K` need not be regular: the caller's solver answers for loads that are in equilibrium.

use std::ops::ControlFlow;

use crate::decomposition::sym_eigen;
use crate::dense::transpose_times;
use crate::error::Error;
use crate::mat::Mat;
use crate::tolerance::{COUNTING_GAP, LANCZOS_BLOCK, LANCZOS_BLOCKS, LANCZOS_DEPENDENT};

use super::matrix::Sparse;

/// Progress of a long computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageProgress {
    /// Name of the stage.
    pub stage: &'static str,
    /// Parts that are done.
    pub done: usize,
    /// Parts in all.
    pub of: usize,
}

/// Called after each part of a long computation; [`ControlFlow::Break`] ends it with [`Error::Cancelled`].
pub type ProgressObserver<'a> = dyn FnMut(StageProgress) -> ControlFlow<()> + 'a;

/// Number and accuracy of the modes that are computed.
#[derive(Debug, Clone, Copy)]
pub struct ModeRequest<'a> {
    /// Name of the computation, for the progress.
    pub stage: &'static str,
    /// Number of modes.
    pub count: usize,
    /// Largest norm of the residual of `K^-1 M x = w^-2 x`, relative to `w^-2`, in the norm of `M`.
    pub tolerance: f64,
    /// The rigid motions, `R' M R = I`, n x r; r may be 0.
    pub rigid: &'a Mat,
}

/// The lowest modes that are not rigid.
#[derive(Debug, Clone, PartialEq)]
pub struct LowestModes {
    /// `w^2`, rising.
    pub squares: Vec<f64>,
    /// The shapes, `X' M X = I`.
    pub shapes: Mat,
    /// The residual of each mode, as in [`ModeRequest::tolerance`]: the relative error of `w^2` is at most about its square.
    pub residuals: Vec<f64>,
    /// Solutions with `K` that it took.
    pub solutions: usize,
}

/// A gap between two modes, squares of their rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Square of the last mode below.
    pub low: f64,
    /// Square of the first mode above.
    pub high: f64,
}

/// Returns the highest gap in which the modes of every one of the sets can be counted; `None` if no two modes are apart.
pub fn highest_cut(sets: &[&LowestModes]) -> Option<Cut> {
    let largest = sets.iter().filter_map(|set| set.squares.last()).copied().fold(f64::INFINITY, f64::min);
    let mut all: Vec<f64> = sets.iter().flat_map(|set| &set.squares).copied().collect();
    all.sort_by(f64::total_cmp);
    let cuts = all.windows(2).map(|pair| Cut { low: pair[0], high: pair[1] }).rev();
    cuts.filter(|cut| cut.high <= largest).find(|cut| cut.high > (1.0 + COUNTING_GAP) * cut.low)
}

impl LowestModes {
    /// Returns how many modes lie below a limit, the square of a rate.
    pub fn count_below(&self, limit: f64) -> usize {
        self.squares.iter().filter(|square| **square < limit).count()
    }

    /// Returns these modes and others, by frequency, the lowest `count` of them.
    pub fn merge(&self, other: &Self, count: usize) -> Self {
        let all: Vec<f64> = self.squares.iter().chain(&other.squares).copied().collect();
        let residuals: Vec<f64> = self.residuals.iter().chain(&other.residuals).copied().collect();
        let shapes = self.shapes.hstack(&other.shapes);
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| all[a].total_cmp(&all[b]));
        order.truncate(count);
        let rows: Vec<usize> = (0..shapes.nrows()).collect();
        Self {
            squares: order.iter().map(|&k| all[k]).collect(),
            shapes: shapes.select(&rows, &order),
            residuals: order.iter().map(|&k| residuals[k]).collect(),
            solutions: self.solutions + other.solutions,
        }
    }
}

/// Returns the lowest flexible modes of a structure with mass matrix `M`, n x n, symmetric and positive semidefinite.
///
/// `solve` returns `K^-1 F` for loads `F`, n x b, that are in equilibrium with respect to the rigid motions; what its answer
/// contains of rigid motions is removed here. Fewer modes than wanted come back if there are no more. A mode that is repeated more
/// than [`LANCZOS_BLOCK`] times may be reported fewer times: [`count_below`](super::count_below) tells.
///
/// # Errors
/// [`Error::Cancelled`], [`Error::NoConvergence`], or what `solve` returns.
pub fn lowest_modes(
    solve: &dyn Fn(&Mat) -> Result<Mat, Error>,
    M: &Sparse,
    wanted: &ModeRequest,
    watch: &mut ProgressObserver,
) -> Result<LowestModes, Error> {
    let mut lanczos = Lanczos {
        solve,
        M,
        rigid: wanted.rigid,
        carried: M.times(wanted.rigid),
        basis: Mat::zeros(M.nrows(), 0),
        projected: Mat::zeros(0, 0),
        solutions: 0,
    };
    let mut block = lanczos.first_block()?;
    let limit = LANCZOS_BLOCKS + 2 * wanted.count;
    for _ in 0..limit {
        let coupling = lanczos.extend(&mut block)?;
        let found = lanczos.ritz(&coupling, wanted)?;
        let done = found.residuals.iter().take_while(|r| **r <= wanted.tolerance).count();
        if watch(StageProgress { stage: wanted.stage, done, of: wanted.count }).is_break() {
            return Err(Error::Cancelled { what: wanted.stage });
        }
        if done == wanted.count || block.ncols() == 0 {
            return Ok(found);
        }
    }
    Err(Error::NoConvergence { what: "the Lanczos iteration", limit })
}

struct Lanczos<'a> {
    solve: &'a dyn Fn(&Mat) -> Result<Mat, Error>,
    M: &'a Sparse,
    rigid: &'a Mat,
    /// M R.
    carried: Mat,
    /// V, with V' M V = I.
    basis: Mat,
    /// V' M K^-1 M V.
    projected: Mat,
    solutions: usize,
}

impl Lanczos<'_> {
    /// An orthonormal block of shapes under loads without a pattern.
    fn first_block(&mut self) -> Result<Mat, Error> {
        let n = self.M.nrows();
        let mut state = 0x9E37_79B9_7F4A_7C15_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let start = Mat::from_fn(n, LANCZOS_BLOCK.min(n), |_, _| random());
        let block = self.apply(&start)?;
        Ok(self.orthonormal(&block)?.0)
    }

    /// `K^-1 M X` without rigid motions.
    fn apply(&mut self, X: &Mat) -> Result<Mat, Error> {
        let mut loads = self.M.times(X);
        if self.rigid.ncols() > 0 {
            loads -= &(&self.carried * &transpose_times(self.rigid, &loads)?);
        }
        let moved = (self.solve)(&loads)?;
        self.solutions += X.ncols();
        self.without_rigid(moved)
    }

    fn without_rigid(&self, mut X: Mat) -> Result<Mat, Error> {
        if self.rigid.ncols() > 0 {
            X -= &(self.rigid * &transpose_times(&self.carried, &X)?);
        }
        Ok(X)
    }

    /// Takes the block into the basis, replaces it by the next one and returns the coupling of the two.
    fn extend(&mut self, block: &mut Mat) -> Result<Mat, Error> {
        let old = self.basis.ncols();
        self.basis = self.basis.hstack(block);
        let mut next = self.apply(block)?;
        let first = transpose_times(&self.basis, &self.M.times(&next))?;
        next -= &(&self.basis * &first);
        for _ in 0..2 {
            let rest = transpose_times(&self.basis, &self.M.times(&next))?;
            next -= &(&self.basis * &rest);
            next = self.without_rigid(next)?;
        }
        let size = self.basis.ncols();
        let mut projected = Mat::zeros(size, size);
        projected.set_block(0, 0, &self.projected);
        projected.set_block(0, old, &first);
        projected.set_block(old, 0, &first.t());
        let own = first.block(old, 0, size - old, size - old).symmetric_part();
        projected.set_block(old, old, &own);
        self.projected = projected;
        let (vectors, coupling) = self.orthonormal(&next)?;
        *block = vectors;
        Ok(coupling)
    }

    /// Q and C with X = Q C and Q' M Q = I, by Gram and Schmidt's process, twice; columns that depend on others are left out of Q.
    fn orthonormal(&self, X: &Mat) -> Result<(Mat, Mat), Error> {
        let (n, columns) = X.shape();
        let sizes = (0..columns).map(|j| self.length(&X.block(0, j, n, 1)));
        let least = LANCZOS_DEPENDENT * sizes.fold(self.projected.norm_max(), f64::max);
        let (mut Q, mut C) = (Mat::zeros(n, 0), Mat::zeros(columns, columns));
        for j in 0..columns {
            let mut x = X.block(0, j, n, 1);
            for _ in 0..2 {
                let share = transpose_times(&Q, &self.M.times(&x))?;
                x -= &(&Q * &share);
                (0..Q.ncols()).for_each(|q| C[(q, j)] += share[(q, 0)]);
                x -= &(&self.basis * &transpose_times(&self.basis, &self.M.times(&x))?);
            }
            let length = self.length(&x);
            if length > least {
                C[(Q.ncols(), j)] = length;
                Q = Q.hstack(&x.scale(1.0 / length));
            }
        }
        let C = C.block(0, 0, Q.ncols(), columns);
        Ok((Q, C))
    }

    /// The norm of a shape in the inner product of M.
    fn length(&self, x: &Mat) -> f64 {
        (x.t() * self.M.times(x))[(0, 0)].max(0.0).sqrt()
    }

    /// The approximations in the basis, and how well each satisfies its equation.
    fn ritz(&self, coupling: &Mat, wanted: &ModeRequest) -> Result<LowestModes, Error> {
        let (values, S) = sym_eigen(&self.projected)?;
        let size = values.len();
        let last = coupling.ncols();
        let mut modes: Vec<usize> = (0..size).rev().filter(|&k| values[k] > 0.0).collect();
        modes.truncate(wanted.count);
        let residual = |&k: &usize| {
            let end = S.block(size - last, k, last, 1);
            (coupling * &end).norm_fro() / values[k]
        };
        let residuals: Vec<f64> = modes.iter().map(residual).collect();
        let converged = residuals.iter().all(|r| *r <= wanted.tolerance) || coupling.nrows() == 0;
        let all: Vec<usize> = (0..size).collect();
        let shapes = if converged { &self.basis * &S.select(&all, &modes) } else { Mat::zeros(0, 0) };
        let squares = modes.iter().map(|&k| 1.0 / values[k]).collect();
        Ok(LowestModes { squares, shapes, residuals, solutions: self.solutions })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sparse::{Entry, SparseCholesky};

    /// A grid of points that moves across its plane, held on its border; unit masses.
    fn membrane(side: usize) -> Sparse {
        let n = side * side;
        let mut list = Vec::new();
        for i in 0..n {
            list.push(Entry { row: i, col: i, value: 4.0 });
            let neighbours = [(i % side + 1 < side).then_some(i + 1), (i + side < n).then_some(i + side)];
            for j in neighbours.into_iter().flatten() {
                list.extend([Entry { row: i, col: j, value: -1.0 }, Entry { row: j, col: i, value: -1.0 }]);
            }
        }
        Sparse::from_entries(n, n, &list).unwrap()
    }

    #[test]
    fn double_modes_of_a_membrane_are_found_twice() {
        let side = 30;
        let K = membrane(side);
        let M = Sparse::from_dense(&Mat::eye(side * side));
        let factor = SparseCholesky::of(&K).unwrap();
        let rigid = Mat::zeros(side * side, 0);
        let wanted = ModeRequest { stage: "modes", count: 8, tolerance: 1e-9, rigid: &rigid };
        let found =
            lowest_modes(&|F| Ok(factor.solve(F)), &M, &wanted, &mut |_| ControlFlow::Continue(())).unwrap();
        let part = |k: usize| 2.0 - 2.0 * (k as f64 * std::f64::consts::PI / (side + 1) as f64).cos();
        let mut exact: Vec<f64> = (1..6).flat_map(|i| (1..6).map(move |j| part(i) + part(j))).collect();
        exact.sort_by(f64::total_cmp);
        for (square, exact) in found.squares.iter().zip(&exact) {
            assert!((square / exact - 1.0).abs() < 1e-12, "{square} {exact}");
        }
        let gram = found.shapes.t() * &found.shapes;
        assert!((gram - Mat::eye(8)).norm_max() < 1e-12);
    }

    #[test]
    fn a_computation_can_be_cancelled() {
        let K = membrane(10);
        let M = Sparse::from_dense(&Mat::eye(100));
        let factor = SparseCholesky::of(&K).unwrap();
        let rigid = Mat::zeros(100, 0);
        let wanted = ModeRequest { stage: "modes", count: 8, tolerance: 1e-9, rigid: &rigid };
        let answer = lowest_modes(&|F| Ok(factor.solve(F)), &M, &wanted, &mut |_| ControlFlow::Break(()));
        assert_eq!(answer, Err(Error::Cancelled { what: "modes" }));
    }
}
