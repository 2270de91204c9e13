//! The ordered real Schur form `A = U T U'`.

mod block;
mod francis;
mod resolvent;
mod swap;

use crate::decomposition::{hessenberg, hessenberg_values};
use crate::error::{Error, check_square};
use crate::heap::keep_freed_blocks;
use crate::mat::{C64, Mat};

/// A real Schur form `A = U T U'`: `U` orthogonal, `T` upper triangular but for standardised 2 x 2 blocks (equal diagonal
/// entries, off-diagonal entries of opposite sign) that carry the complex pairs.
#[derive(Clone, Debug)]
pub struct Schur {
    /// Quasi-triangular.
    pub T: Mat,
    /// Orthogonal.
    pub U: Mat,
}

/// Returns the real Schur form of a square matrix.
///
/// Method: Householder Hessenberg form, then Francis' implicit double shift with the deflation test of Ahues and
/// Tisseur. Cost about 25 n^3 operations. The form is backward stable: `norm(A - U T U') <= p(n) eps norm(A)`.
///
/// # Errors
/// Not square, entries that are not finite, or more than forty iterations an eigenvalue.
pub fn schur(A: &Mat) -> Result<Schur, Error> {
    check_square("A", A)?;
    keep_freed_blocks(A.nrows());
    match independent_groups(A) {
        groups if groups.len() > 1 => group_by_group(A, &groups),
        _ => connected_form(A),
    }
}

/// The form of each group of states that has nothing to do with the others: a modal model costs next to nothing.
fn group_by_group(A: &Mat, groups: &[Vec<usize>]) -> Result<Schur, Error> {
    let n = A.nrows();
    let (mut T, mut U) = (Mat::zeros(n, n), Mat::zeros(n, n));
    let mut top = 0;
    for group in groups {
        let form = connected_form(&A.select(group, group))?;
        T.set_block(top, top, &form.T);
        for j in 0..group.len() {
            group.iter().enumerate().for_each(|(i, &state)| U[(state, top + j)] = form.U[(i, j)]);
        }
        top += group.len();
    }
    Ok(Schur { T, U })
}

/// The groups of states in which a matrix is block diagonal, one group where every state reaches every other.
fn independent_groups(A: &Mat) -> Vec<Vec<usize>> {
    let n = A.nrows();
    let mut label: Vec<usize> = (0..n).collect();
    let mut count = n;
    for j in 0..n {
        for i in 0..n {
            if count > 1 && A[(i, j)] != 0.0 && label[i] != label[j] {
                let (kept, gone) = (label[i].min(label[j]), label[i].max(label[j]));
                label.iter_mut().filter(|l| **l == gone).for_each(|l| *l = kept);
                count -= 1;
            }
        }
        if count <= 1 {
            return vec![(0..n).collect()];
        }
    }
    let mut groups = vec![Vec::new(); n];
    label.iter().enumerate().for_each(|(state, &l)| groups[l].push(state));
    groups.retain(|group| !group.is_empty());
    groups
}

/// The form of a matrix that is not taken apart.
fn connected_form(A: &Mat) -> Result<Schur, Error> {
    let (mut T, mut U) = hessenberg(A)?;
    if A.nrows() > 0 {
        francis::francis(&mut T, &mut U, 0, A.nrows() - 1)?;
    }
    clear_below(&mut T);
    Ok(Schur { T, U })
}

/// Returns the eigenvalues of a square matrix, sorted by real part and then by imaginary part.
///
/// Method: the diagonal blocks of the real Schur form of the balanced matrix, to the last bit, at two fifths of its cost.
///
/// # Errors
/// As for [`schur`].
pub fn eigenvalues(A: &Mat) -> Result<Vec<C64>, Error> {
    check_square("A", A)?;
    keep_freed_blocks(A.nrows());
    let balanced = crate::balance::balance(A)?.A;
    let mut values = Vec::with_capacity(A.nrows());
    for group in independent_groups(&balanced) {
        let mut H = hessenberg_values(&balanced.select(&group, &group))?;
        if !group.is_empty() {
            francis::francis_values(&mut H)?;
        }
        values.extend(diagonal(&H));
    }
    values.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    Ok(values)
}

/// The eigenvalues of the diagonal blocks of a quasi-triangular matrix, from the top.
fn diagonal(T: &Mat) -> Vec<C64> {
    let mut values = Vec::with_capacity(T.nrows());
    for DiagonalBlock { start: k, size } in blocks(T) {
        if size == 1 {
            values.push(C64::new(T[(k, k)], 0.0));
        } else {
            values.extend(block::pair(T[(k, k)], T[(k, k + 1)], T[(k + 1, k)], T[(k + 1, k + 1)]));
        }
    }
    values
}

fn clear_below(T: &mut Mat) {
    for j in 0..T.ncols() {
        let from = (j + 2).min(T.nrows());
        T.column_mut(j)[from..].fill(0.0);
    }
}

impl Schur {
    /// Returns the eigenvalues in the order of the diagonal; of a complex pair the one with positive imaginary part comes first.
    pub fn eigenvalues(&self) -> Vec<C64> {
        diagonal(&self.T)
    }

    /// Moves the eigenvalues that `wanted` selects to the top left, in their present order, and returns how many they
    /// are; the leading columns of `U` then span their invariant subspace. Of a complex pair, `wanted` is asked about
    /// the eigenvalue with positive imaginary part.
    ///
    /// # Errors
    /// [`Error::SwapRejected`] if two eigenvalues are too close to change places; the form stays valid, with the
    /// order reached so far.
    pub fn reorder(&mut self, wanted: impl Fn(C64) -> bool) -> Result<usize, Error> {
        let mut done = 0;
        for DiagonalBlock { start: k, size } in blocks(&self.T) {
            if !wanted(self.eigenvalue_at(k, size)) {
                continue;
            }
            self.move_up(k, size, done)?;
            done += size;
        }
        Ok(done)
    }

    fn eigenvalue_at(&self, k: usize, size: usize) -> C64 {
        let T = &self.T;
        if size == 1 {
            return C64::new(T[(k, k)], 0.0);
        }
        block::pair(T[(k, k)], T[(k, k + 1)], T[(k + 1, k)], T[(k + 1, k + 1)])[0]
    }

    /// Moves the block at row `from` up to row `to`, block by block.
    fn move_up(&mut self, from: usize, size: usize, to: usize) -> Result<(), Error> {
        let mut at = from;
        while at > to {
            let above = if at >= 2 && self.T[(at - 1, at - 2)] != 0.0 { 2 } else { 1 };
            swap::swap(&mut self.T, &mut self.U, at - above, above, size)?;
            at -= above;
        }
        Ok(())
    }
}

/// A block on the diagonal of a quasi-triangular matrix.
#[derive(Clone, Copy)]
pub(crate) struct DiagonalBlock {
    /// First row.
    pub(crate) start: usize,
    /// One for a real eigenvalue, two for a complex pair.
    pub(crate) size: usize,
}

/// The diagonal blocks, from the top.
pub(crate) fn blocks(T: &Mat) -> Vec<DiagonalBlock> {
    let n = T.nrows();
    let mut list = Vec::with_capacity(n);
    let mut k = 0;
    while k < n {
        let size = if k + 1 < n && T[(k + 1, k)] != 0.0 { 2 } else { 1 };
        list.push(DiagonalBlock { start: k, size });
        k += size;
    }
    list
}
