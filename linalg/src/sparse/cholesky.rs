//! The Cholesky factors of a sparse symmetric positive definite matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::error::Error;
use crate::mat::Mat;

use super::matrix::Sparse;

/// The factors `P A P' = L L'` of a sparse symmetric positive definite matrix, supernodal, ordered by approximate minimum
/// degree.
#[derive(Debug)]
pub struct SparseCholesky {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
}

impl SparseCholesky {
    /// Factorises a matrix, of which the lower half is read.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::NotPositiveDefinite`], or [`Error::TooLarge`] if the factors do not fit into memory.
    pub fn of(A: &Sparse) -> Result<Self, Error> {
        let n = A.nrows();
        if n != A.ncols() {
            return Err(Error::NotSquare { what: "A", rows: n, cols: A.ncols() });
        }
        let (starts, indices, values) = A.parts();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, starts, None, indices);
        let too_large = |_| Error::TooLarge { what: "the Cholesky factors of a sparse matrix", rows: n };
        let (order, params) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, order, params).map_err(too_large)?;
        let mut out = Vec::new();
        let too_large = Error::TooLarge { what: "the Cholesky factors of a sparse matrix", rows: n };
        if out.try_reserve_exact(symbolic.len_val()).is_err() {
            return Err(too_large);
        }
        out.resize(symbolic.len_val(), 0.0);
        let need = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::Spec::default());
        let mut buffer = MemBuffer::try_new(need).map_err(|_| too_large)?;
        let matrix = SparseColMatRef::new(pattern, values);
        let stack = MemStack::new(&mut buffer);
        let none = LltRegularization::default();
        symbolic
            .factorize_numeric_llt(
                &mut out,
                matrix,
                Side::Lower,
                none,
                Par::Seq,
                stack,
                faer::Spec::default(),
            )
            .map_err(|_| Error::NotPositiveDefinite { what: "the sparse matrix" })?;
        Ok(Self { symbolic, values: out })
    }

    /// Number of entries of the factor as it is stored.
    pub fn entry_count(&self) -> usize {
        self.values.len()
    }

    /// The solution `X` of `A X = B`.
    pub fn solve(&self, B: &Mat) -> Mat {
        let mut X = B.clone();
        let (n, columns) = X.shape();
        if n == 0 || columns == 0 {
            return X;
        }
        let mut buffer = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq));
        let factor = LltRef::new(&self.symbolic, &self.values);
        let target = MatMut::from_column_major_slice_mut(X.as_mut_slice(), n, columns);
        factor.solve_in_place_with_conj(Conj::No, target, Par::Seq, MemStack::new(&mut buffer));
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
