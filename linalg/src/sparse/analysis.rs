//! The structure of the factors of a sparse symmetric matrix, before they are computed.

use faer::Side;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};

use super::dissection::{Graph, minimum_degree, nested_dissection};
use super::matrix::Sparse;
use crate::error::Error;

/// Fewer unknowns are ordered by minimum degree alone, which is quicker than what a better order saves.
const SMALL: usize = 2000;

/// The order of elimination and the pattern of the factors. Columns with like patterns form blocks.
#[derive(Debug)]
pub struct Analysis {
    /// The unknown that is eliminated as the k-th.
    pub(super) order: Vec<u32>,
    /// The place of each unknown in the order of elimination.
    pub(super) place: Vec<u32>,
    /// The first column of each block, and the end of the last.
    firsts: Vec<usize>,
    /// The rows below the columns of each block, rising.
    rows: Vec<u32>,
    /// The start of the rows of each block.
    starts: Vec<usize>,
    /// The block of each column.
    pub(super) block: Vec<u32>,
}

impl Analysis {
    /// Analyses the pattern of a symmetric matrix; a place of either half counts for both. The unknowns of `last` are eliminated last, in their order.
    ///
    /// Of nested dissection and approximate minimum degree the order that needs less work is taken.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::Shape`] for a row that is not there, or [`Error::TooLarge`] if the pattern does not fit into memory.
    pub fn of(A: &Sparse, last: &[usize]) -> Result<Self, Error> {
        let n = A.nrows();
        if n != A.ncols() {
            return Err(Error::NotSquare { what: "A", rows: n, cols: A.ncols() });
        }
        if let Some(&row) = last.iter().find(|&&row| row >= n) {
            let what = "the unknowns that are eliminated last";
            return Err(Error::Shape { what, rows: row + 1, cols: 1, needed_rows: n, needed_cols: 1 });
        }
        let A = &A.with_symmetric_pattern()?;
        let graph = Graph::of(A);
        let by_degree = Self::in_order(A, minimum_degree(&graph)?, last)?;
        if n < SMALL {
            return Ok(by_degree);
        }
        let by_parts = Self::in_order(A, nested_dissection(&graph)?, last)?;
        Ok(if by_parts.operations() < by_degree.operations() { by_parts } else { by_degree })
    }

    fn in_order(A: &Sparse, order: Vec<u32>, last: &[usize]) -> Result<Self, Error> {
        let n = A.nrows();
        let too_large = |_| Error::TooLarge { what: "the factors of a sparse matrix", rows: n };
        let mut order: Vec<u32> = order.into_iter().filter(|&v| !last.contains(&(v as usize))).collect();
        order.extend(last.iter().map(|&row| row as u32));
        let order = postorder(A, &order);
        let place = inverse(&order);
        let (starts, indices, _) = A.parts();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, starts, None, indices);
        let order_ref = faer::perm::PermRef::new_checked(&order, &place, n);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Custom(order_ref), params)
                .map_err(too_large)?;
        Ok(Self::of_blocks(&symbolic, order, place))
    }

    fn of_blocks(symbolic: &SymbolicCholesky<u32>, order: Vec<u32>, place: Vec<u32>) -> Self {
        let n = order.len();
        let (mut firsts, mut rows, mut starts, mut block) = (vec![], vec![], vec![0], Vec::with_capacity(n));
        match symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(inner) => {
                for s in 0..inner.n_supernodes() {
                    let node = inner.supernode(s);
                    firsts.push(node.start());
                    rows.extend_from_slice(node.pattern());
                    starts.push(rows.len());
                }
            }
            SymbolicCholeskyRaw::Simplicial(inner) => {
                for j in 0..n {
                    let column = inner.col_ptr()[j] as usize..inner.col_ptr()[j + 1] as usize;
                    firsts.push(j);
                    rows.extend(inner.row_idx()[column].iter().filter(|&&i| i as usize > j));
                    starts.push(rows.len());
                }
            }
        }
        firsts.push(n);
        firsts.windows(2).enumerate().for_each(|(s, w)| block.extend((w[0]..w[1]).map(|_| s as u32)));
        Self { order, place, firsts, rows, starts, block }
    }

    /// Returns the number of unknowns.
    pub fn size(&self) -> usize {
        self.order.len()
    }

    /// Number of blocks.
    pub(super) fn blocks(&self) -> usize {
        self.firsts.len() - 1
    }

    /// The columns of a block.
    pub(super) fn columns(&self, block: usize) -> std::ops::Range<usize> {
        self.firsts[block]..self.firsts[block + 1]
    }

    /// The rows below the columns of a block, rising.
    pub(super) fn rows(&self, block: usize) -> &[u32] {
        &self.rows[self.starts[block]..self.starts[block + 1]]
    }

    /// Rows and columns of the panel that holds a block's part of the factor.
    pub(super) fn panel(&self, block: usize) -> Panel {
        let cols = self.columns(block).len();
        Panel { rows: cols + self.rows(block).len(), cols }
    }

    /// Returns the number of entries of the factor as it is stored.
    pub fn entry_count(&self) -> usize {
        (0..self.blocks()).map(|s| self.panel(s).entries()).sum()
    }

    /// Returns the number of multiplications and additions of the factorisation, about.
    pub fn operations(&self) -> f64 {
        (0..self.blocks()).map(|s| self.panel(s).operations()).sum()
    }
}

/// The size of a block's part of the factor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    pub(super) rows: usize,
    pub(super) cols: usize,
}

impl Panel {
    pub(super) fn entries(self) -> usize {
        self.rows * self.cols
    }

    /// The sum of the squares of the lengths of its columns.
    pub(super) fn operations(self) -> f64 {
        let cube = |k: usize| (k as f64).powi(3) / 3.0;
        cube(self.rows) - cube(self.rows - self.cols)
    }
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &v)| place[v as usize] = k as u32);
    place
}

/// The same elimination with each unknown directly behind those that it depends on, so that blocks are wide.
///
/// Source: Liu, SIAM J. Matrix Anal. 11 (1990) 134.
fn postorder(A: &Sparse, order: &[u32]) -> Vec<u32> {
    let n = order.len();
    let parent = elimination_tree(A, order);
    let (mut first_child, mut next_child) = (vec![u32::MAX; n], vec![u32::MAX; n]);
    for v in (0..n).rev().filter(|&v| parent[v] != u32::MAX) {
        next_child[v] = std::mem::replace(&mut first_child[parent[v] as usize], v as u32);
    }
    let mut out = Vec::with_capacity(n);
    for root in (0..n).filter(|&v| parent[v] == u32::MAX) {
        let mut stack = vec![root as u32];
        while let Some(&v) = stack.last() {
            match first_child[v as usize] {
                u32::MAX => {
                    out.push(order[v as usize]);
                    stack.pop();
                }
                child => {
                    first_child[v as usize] = next_child[child as usize];
                    stack.push(child);
                }
            }
        }
    }
    out
}

/// The column that each column of the factor is needed by first; `u32::MAX` for none.
fn elimination_tree(A: &Sparse, order: &[u32]) -> Vec<u32> {
    let place = inverse(order);
    let n = order.len();
    let (mut parent, mut ancestor) = (vec![u32::MAX; n], vec![u32::MAX; n]);
    for column in 0..n {
        for (i, _) in A.column(order[column] as usize) {
            let mut row = place[i] as usize;
            while row < column {
                let up = std::mem::replace(&mut ancestor[row], column as u32);
                if up == u32::MAX {
                    parent[row] = column as u32;
                    break;
                }
                row = up as usize;
            }
        }
    }
    parent
}
