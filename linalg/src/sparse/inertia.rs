//! The number of eigenvalues of a sparse symmetric pencil lie below a limit: the check that no mode was missed.
//!
//! By Sylvester's law of inertia `K - limit M` has as many negative eigenvalues as the diagonal of its factors `L D L'` has negative
//! entries. Source: Parlett, The Symmetric Eigenvalue Problem (SIAM 1998), section 3.3.

use std::ops::ControlFlow;

use super::analysis::Analysis;
use super::matrix::{Entry, Sparse};
use super::modes::ProgressObserver;
use super::numeric::{FactorRequest, Term, factorise};
use crate::error::Error;
use crate::tolerance::PIVOT_GROWTH;

/// Counts the eigenvalues of `K x = l M x` below a limit, for symmetric `K` and a symmetric positive semidefinite `M`, both
/// halves stored; also with some unknowns held, from the same factors.
#[derive(Debug)]
pub struct ModeCounter<'a> {
    K: &'a Sparse,
    M: &'a Sparse,
    held: Vec<usize>,
    analysis: Analysis,
}

impl<'a> ModeCounter<'a> {
    /// Analyses the pattern of the pencil, in which the unknowns of `held` may be held.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::NotSymmetric`], [`Error::Shape`] or [`Error::TooLarge`].
    pub fn of(K: &'a Sparse, M: &'a Sparse, held: &[usize]) -> Result<Self, Error> {
        if K.nrows() != K.ncols() || M.shape() != K.shape() {
            return Err(Error::NotSquare {
                what: "the stiffness of a pencil",
                rows: K.nrows(),
                cols: K.ncols(),
            });
        }
        K.check_symmetric("the stiffness of a pencil")?;
        M.check_symmetric("the mass of a pencil")?;
        let extra: Vec<Entry> = M.entries().map(|e| Entry { value: 0.0, ..e }).collect();
        let analysis = Analysis::of(&K.plus(&extra)?, held)?;
        Ok(Self { K, M, held: held.to_vec(), analysis })
    }

    /// Returns how many eigenvalues lie below `limit` if all unknowns of `held` are held, all but the first, all but the first two, and so on;
    /// the last count is that of the whole pencil.
    ///
    /// The factorisation does not pivot. If a pivot is so small that the count cannot be trusted, that is an error, and a limit a
    /// little beside it gives another matrix.
    ///
    /// # Errors
    /// [`Error::TooLarge`], [`Error::Singular`] for such a pivot, or [`Error::Cancelled`].
    pub fn count_below(&self, limit: f64, watch: &mut ProgressObserver) -> Result<Vec<usize>, Error> {
        let terms = [Term { factor: 1.0, matrix: self.K }, Term { factor: -limit, matrix: self.M }];
        let stage = "counting the modes";
        let pivots = factorise(&self.analysis, &terms, FactorRequest::Pivots, stage, watch)?.pivots;
        let of_row = |row: usize| pivots[self.analysis.place[row] as usize];
        let diagonal = |row: usize| self.K.at(row, row) - limit * self.M.at(row, row);
        let growth = (0..pivots.len()).map(|row| of_row(row).abs() / diagonal(row).abs());
        let largest = growth.fold(0.0, f64::max);
        if largest > PIVOT_GROWTH {
            return Err(Error::Singular { what: "the shifted stiffness", rcond: 1.0 / largest });
        }
        let of_held = self.held.iter().map(|&row| usize::from(of_row(row) < 0.0));
        let mut count = pivots.iter().filter(|pivot| **pivot < 0.0).count() - of_held.clone().sum::<usize>();
        let mut counts = vec![count];
        for more in of_held {
            count += more;
            counts.push(count);
        }
        Ok(counts)
    }
}

/// Returns how many eigenvalues of `K x = l M x` lie below `limit`; see [`ModeCounter`].
///
/// # Errors
/// As for [`ModeCounter::of`] and [`ModeCounter::count_below`].
pub fn count_below(K: &Sparse, M: &Sparse, limit: f64) -> Result<usize, Error> {
    let counts = ModeCounter::of(K, M, &[])?.count_below(limit, &mut |_| ControlFlow::Continue(()))?;
    Ok(counts.last().copied().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::decomposition::sym_eigen;
    use crate::mat::Mat;

    /// A band matrix with entries of a seed, symmetric, and its dense form.
    fn band(n: usize, seed: u64) -> Sparse {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut list = Vec::new();
        for i in 0..n {
            list.push(Entry { row: i, col: i, value: 4.0 + random() });
            for j in [i + 1, i + 2, i + n / 3 + 1].into_iter().filter(|&j| j < n) {
                let value = 2.0 * random();
                list.extend([Entry { row: i, col: j, value }, Entry { row: j, col: i, value }]);
            }
        }
        Sparse::from_entries(n, n, &list).unwrap()
    }

    #[test]
    fn the_count_is_that_of_the_dense_eigenvalues() {
        for (n, seed) in [(1, 1), (2, 2), (30, 3), (200, 4), (400, 5)] {
            let K = band(n, seed);
            let M = Sparse::from_dense(&Mat::eye(n));
            let (values, _) = sym_eigen(&K.to_dense()).unwrap();
            for limit in [-1.0, 2.5, 3.7, 4.1, 5.0, 9.0] {
                let expected = values.iter().filter(|value| **value < limit).count();
                assert_eq!(count_below(&K, &M, limit).unwrap(), expected, "n = {n}, {limit}");
            }
        }
    }

    #[test]
    fn one_factorisation_counts_with_unknowns_held() {
        for seed in [1, 2, 3] {
            let (K, M) = (band(90, seed), Sparse::from_dense(&Mat::eye(90)));
            let held = [17, 60];
            let counter = ModeCounter::of(&K, &M, &held).unwrap();
            for limit in [2.5, 3.7, 4.1, 5.0] {
                let counts = counter.count_below(limit, &mut |_| ControlFlow::Continue(())).unwrap();
                for (k, &count) in counts.iter().enumerate() {
                    let kept: Vec<usize> = (0..90).filter(|row| !held[k..].contains(row)).collect();
                    let (values, _) = sym_eigen(&K.select(&kept).to_dense()).unwrap();
                    assert_eq!(
                        count,
                        values.iter().filter(|value| **value < limit).count(),
                        "{seed} {limit} {k}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_matrix_that_is_singular_at_the_limit_is_an_error() {
        let K = Sparse::from_dense(&Mat::diag(&[1.0, 2.0, 3.0]));
        let M = Sparse::from_dense(&Mat::eye(3));
        assert!(matches!(count_below(&K, &M, 2.0), Err(Error::Singular { .. })));
        assert_eq!(count_below(&K, &M, 2.5).unwrap(), 2);
    }
}
