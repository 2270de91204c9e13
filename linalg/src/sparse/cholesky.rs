//! The factors of a sparse symmetric positive definite matrix, and of a sum of matrices at complex frequencies.

use std::ops::ControlFlow;

use super::analysis::Analysis;
use super::matrix::Sparse;
use super::modes::ProgressObserver;
use super::numeric::{FactorRequest, Factors, Term, factorise};
use crate::error::Error;
use crate::mat::Mat;

/// The factors `P A P' = L D L'` of a sparse symmetric positive definite matrix, by blocks, in the order of [`Analysis`].
#[derive(Debug)]
pub struct SparseCholesky {
    analysis: Analysis,
    factors: Factors<f64>,
}

impl SparseCholesky {
    /// Factorises a symmetric matrix, both halves of which are stored.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::NotSymmetric`], [`Error::NotPositiveDefinite`], or [`Error::TooLarge`] if the factors do not fit into memory.
    pub fn of(A: &Sparse) -> Result<Self, Error> {
        Self::with_progress(A, Analysis::of(A, &[])?, "factorising a matrix", &mut |_| {
            ControlFlow::Continue(())
        })
    }

    /// Does the same with an analysis of the pattern, tells `watch` the percentage that is done, and stops if it asks to.
    ///
    /// # Errors
    /// As for [`SparseCholesky::of`], and [`Error::Cancelled`].
    pub fn with_progress(
        A: &Sparse,
        analysis: Analysis,
        stage: &'static str,
        watch: &mut ProgressObserver,
    ) -> Result<Self, Error> {
        A.check_symmetric("the sparse matrix")?;
        let terms = [Term { factor: 1.0, matrix: A }];
        let factors = factorise(&analysis, &terms, FactorRequest::PositiveFactors, stage, watch)?;
        Ok(Self { analysis, factors })
    }

    /// Returns the number of entries of the factor as it is stored.
    pub fn entry_count(&self) -> usize {
        self.analysis.entry_count()
    }

    /// Returns the solution `X` of `A X = B`.
    pub fn solve(&self, B: &Mat) -> Mat {
        let mut X = B.clone();
        let columns = X.ncols();
        if !X.as_slice().is_empty() {
            self.factors.solve(&self.analysis, X.as_mut_slice(), columns);
        }
        X
    }
}
#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sparse::Entry;

    #[test]
    fn the_solution_satisfies_its_equation() {
        for n in [1, 2, 40, 700] {
            let mut list: Vec<Entry> =
                (0..n).map(|i| Entry { row: i, col: i, value: 4.0 + i as f64 }).collect();
            for i in 1..n {
                for j in [i - 1, i / 2, i / 3] {
                    list.extend([
                        Entry { row: i, col: j, value: -0.3 },
                        Entry { row: j, col: i, value: -0.3 },
                    ]);
                }
            }
            let A = Sparse::from_entries(n, n, &list).unwrap();
            let B = Mat::from_fn(n, 3, |i, j| (i * 7 + j) as f64 % 5.0 - 2.0);
            let X = SparseCholesky::of(&A).unwrap().solve(&B);
            assert!((A.times(&X) - &B).norm_max() < 1e-12, "{n}");
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let A = Sparse::from_dense(&Mat::diag(&[1.0, -2.0, 3.0]));
        assert!(matches!(SparseCholesky::of(&A), Err(Error::NotPositiveDefinite { .. })));
    }
}
