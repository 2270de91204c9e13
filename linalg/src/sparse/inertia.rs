//! How many eigenvalues of a sparse symmetric pencil lie below a limit: the check that no mode was missed.
//!
//! By Sylvester's law of inertia `K - limit M` has as many negative eigenvalues as the diagonal of its factors `L D L'` has negative
//! entries. Source: Parlett, The Symmetric Eigenvalue Problem (SIAM 1998), section 3.3.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::simplicial::SimplicialLdltRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};

use crate::error::Error;
use crate::tolerance::PIVOT_GROWTH;

use super::matrix::{Entry, Sparse};

/// Returns how many eigenvalues of `K x = l M x` lie below `limit`, for symmetric `K` and a symmetric positive semidefinite `M`.
///
/// The factorisation does not pivot. If a pivot is so small that the count cannot be trusted, that is an error, and a limit a little
/// beside it gives another matrix.
///
/// # Errors
/// [`Error::NotSquare`], [`Error::TooLarge`], or [`Error::Singular`] for such a pivot.
pub fn count_below(K: &Sparse, M: &Sparse, limit: f64) -> Result<usize, Error> {
    let n = K.nrows();
    if n != K.ncols() || M.shape() != K.shape() {
        return Err(Error::NotSquare { what: "the stiffness of a pencil", rows: n, cols: K.ncols() });
    }
    let moved: Vec<Entry> = M.entries().map(|e| Entry { value: -limit * e.value, ..e }).collect();
    let shifted = K.plus(&moved)?;
    drop(moved);
    let diagonal = shifted.diagonal();
    let (pivots, order) = pivots(&shifted)?;
    let growth = |(pivot, &row): (&f64, &usize)| pivot.abs() / diagonal[row].abs();
    let largest = pivots.iter().zip(&order).map(growth).fold(0.0, f64::max);
    if largest > PIVOT_GROWTH || pivots.iter().any(|pivot| !pivot.is_finite()) {
        return Err(Error::Singular { what: "the shifted stiffness", rcond: 1.0 / largest });
    }
    Ok(pivots.iter().filter(|pivot| **pivot < 0.0).count())
}

/// The diagonal of `D` in `P A P' = L D L'`, and the row of `A` that each belongs to.
fn pivots(A: &Sparse) -> Result<(Vec<f64>, Vec<usize>), Error> {
    let n = A.nrows();
    let (starts, indices, values) = A.parts();
    let pattern = SymbolicSparseColMatRef::new_checked(n, n, starts, None, indices);
    let too_large = || Error::TooLarge { what: "the factors of a sparse matrix", rows: n };
    let (order, params) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
    let symbolic =
        factorize_symbolic_cholesky(pattern, Side::Lower, order, params).map_err(|_| too_large())?;
    let mut factor = Vec::new();
    factor.try_reserve_exact(symbolic.len_val()).map_err(|_| too_large())?;
    factor.resize(symbolic.len_val(), 0.0);
    let need = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, faer::Spec::default());
    let mut buffer = MemBuffer::try_new(need).map_err(|_| too_large())?;
    let matrix = SparseColMatRef::new(pattern, values);
    let (stack, none) = (MemStack::new(&mut buffer), LdltRegularization::default());
    symbolic
        .factorize_numeric_ldlt(
            &mut factor,
            matrix,
            Side::Lower,
            none,
            Par::Seq,
            stack,
            faer::Spec::default(),
        )
        .map_err(|_| Error::Singular { what: "the shifted stiffness", rcond: 0.0 })?;
    let rows = match symbolic.perm() {
        Some(order) => order.arrays().0.iter().map(|&row| row as usize).collect(),
        None => (0..n).collect(),
    };
    Ok((diagonal_of(&symbolic, &factor), rows))
}

fn diagonal_of(symbolic: &SymbolicCholesky<u32>, factor: &[f64]) -> Vec<f64> {
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(inner) => {
            let values = SimplicialLdltRef::new(inner, factor).values();
            inner.col_ptr()[..inner.ncols()].iter().map(|&first| values[first as usize]).collect()
        }
        SymbolicCholeskyRaw::Supernodal(inner) => {
            let factors = SupernodalLdltRef::new(inner, factor);
            let of_block = |block: usize| {
                let entries = factors.supernode(block).val();
                (0..entries.ncols()).map(|j| entries[(j, j)]).collect::<Vec<f64>>()
            };
            (0..inner.n_supernodes()).flat_map(of_block).collect()
        }
    }
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
    fn a_matrix_that_is_singular_at_the_limit_is_an_error() {
        let K = Sparse::from_dense(&Mat::diag(&[1.0, 2.0, 3.0]));
        let M = Sparse::from_dense(&Mat::eye(3));
        assert!(matches!(count_below(&K, &M, 2.0), Err(Error::Singular { .. })));
        assert_eq!(count_below(&K, &M, 2.5).unwrap(), 2);
    }
}
