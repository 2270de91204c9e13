//! Exchange of two neighbouring diagonal blocks of a real Schur form.
//!
//! Source: Bai and Demmel, On swapping diagonal blocks in real Schur form, Lin. Alg. Appl. 186 (1993).

use super::block::{Rotation, pair, standardise};
use crate::error::Error;
use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::tolerance::SWAP;

/// Exchanges the block of size `first` at row `k` with the block of size `second` that follows it.
///
/// # Errors
/// [`Error::SwapRejected`] if the blocks' eigenvalues are so close that the exchange would spoil the form; nothing
/// is changed then.
pub(super) fn swap(T: &mut Mat, U: &mut Mat, k: usize, first: usize, second: usize) -> Result<(), Error> {
    if first == 1 && second == 1 {
        swap_single(T, U, k);
        return Ok(());
    }
    let size = first + second;
    let local = T.block(k, k, size, size);
    let Q = exchange_basis(&local, first);
    let turned = Q.t() * &local * &Q;
    let left_over = turned.block(second, 0, first, second).norm_max();
    if left_over > SWAP * local.norm_max() {
        return Err(swap_error(&local, first, left_over));
    }
    exchange(T, U, &Q, k, second);
    Ok(())
}

vectorised! {
    /// Applies the orthogonal `Q` to the block at `k` and brings both blocks to standard form.
    fn exchange<'a>(T: &'a mut Mat, U: &'a mut Mat, Q: &'a Mat, k: usize, second: usize) -> () {
        let size = Q.nrows();
        rotate_rows(T, Q, k);
        rotate_columns(T, Q, k, k + size);
        let rows = U.nrows();
        rotate_columns(U, Q, k, rows);
        for j in 0..second {
            T.column_mut(k + j)[k + second..k + size].fill(0.0);
        }
        if second == 2 {
            standardise(T, U, k);
        }
        if size == second + 2 {
            standardise(T, U, k + second);
        }
    }
}

vectorised! {
    fn swap_single<'a>(T: &'a mut Mat, U: &'a mut Mat, k: usize) -> () {
        let (upper, lower) = (T[(k, k)], T[(k + 1, k + 1)]);
        let turn = Rotation::zeroing(T[(k, k + 1)], lower - upper);
        turn.apply_left(T, k, k);
        turn.apply_right(T, k, k + 2);
        let rows = U.nrows();
        turn.apply_right(U, k, rows);
        T[(k, k)] = lower;
        T[(k + 1, k + 1)] = upper;
        T[(k + 1, k)] = 0.0;
    }
}

/// An orthogonal matrix whose leading columns span the invariant subspace of the second block: with
/// `T11 X - X T22 = T12` it is `[-X; I]`.
fn exchange_basis(local: &Mat, first: usize) -> Mat {
    let size = local.nrows();
    let second = size - first;
    let (mut system, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
    for j in 0..second {
        for i in 0..first {
            let row = j * first + i;
            right[row] = local[(i, first + j)];
            for l in 0..first {
                system[row][j * first + l] += local[(i, l)];
            }
            for l in 0..second {
                system[row][l * first + i] -= local[(first + l, first + j)];
            }
        }
    }
    crate::small_systems::solve_complete(&mut system, &mut right, first * second);
    let mut basis = Mat::zeros(size, second);
    for j in 0..second {
        for i in 0..first {
            basis[(i, j)] = -right[j * first + i];
        }
        basis[(first + j, j)] = 1.0;
    }
    crate::small_systems::full_q(basis)
}

#[inline(always)]
fn rotate_rows(T: &mut Mat, Q: &Mat, k: usize) {
    let (ld, size) = (T.nrows(), Q.nrows());
    for column in T.as_mut_slice()[k * ld..].chunks_exact_mut(ld) {
        let mut old = [0.0; 4];
        old[..size].copy_from_slice(&column[k..k + size]);
        for j in 0..size {
            column[k + j] = (0..size).map(|i| Q[(i, j)] * old[i]).sum();
        }
    }
}

#[inline(always)]
fn rotate_columns(T: &mut Mat, Q: &Mat, k: usize, rows: usize) {
    let size = Q.nrows();
    let old = T.block(0, k, rows, size);
    for j in 0..size {
        let target = &mut T.column_mut(k + j)[..rows];
        target.fill(0.0);
        for i in 0..size {
            let factor = Q[(i, j)];
            target.iter_mut().zip(old.column(i)).for_each(|(t, &o)| *t += factor * o);
        }
    }
}

fn swap_error(local: &Mat, first: usize, left_over: f64) -> Error {
    let eigenvalue = |k: usize, size: usize| {
        if size == 1 {
            return crate::mat::C64::new(local[(k, k)], 0.0);
        }
        pair(local[(k, k)], local[(k, k + 1)], local[(k + 1, k)], local[(k + 1, k + 1)])[0]
    };
    Error::SwapRejected {
        first: eigenvalue(0, first),
        second: eigenvalue(first, local.nrows() - first),
        error: left_over / local.norm_max(),
    }
}
