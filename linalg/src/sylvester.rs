//! Sylvester equations, continuous and discrete: Schur forms (Bartels and Stewart), solved by recursive blocks.
//!
//! Sources: Bartels and Stewart, Comm. ACM 15 (1972); Jonsson and Kagstrom, ACM TOMS 28 (2002) for the recursion.

use crate::error::{Error, check_range, check_shape, check_square};
use crate::kernel::vectorised;
use crate::mat::{C64, Mat};
use crate::schur::{DiagonalBlock, Schur, blocks, schur};
use crate::tolerance::EPS;

/// The equation, of two.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// `A X + X B = C`
    Continuous,
    /// `A X B - X = C`
    Discrete,
}

impl Kind {
    /// Returns what is left between two eigenvalues: zero if they make the equation singular.
    pub(crate) fn gap(self, first: C64, second: C64) -> f64 {
        match self {
            Self::Continuous => (first + second).norm(),
            Self::Discrete => (first * second - 1.0).norm(),
        }
    }
}

/// Solves `A X + X B = C`; `A` m x m, `B` n x n, `C` and `X` m x n.
///
/// A unique solution exists if and only if no eigenvalue of `A` is the negative of one of `B`.
/// Method: real Schur forms of both, back substitution by recursive blocks. Cost 25 (m^3 + n^3) + mn(m + n).
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::CommonEigenvalue`].
pub fn sylvester(A: &Mat, B: &Mat, C: &Mat) -> Result<Mat, Error> {
    solve_by_schur(A, B, C, Kind::Continuous)
}

/// Solves `A X B - X + C = 0`; `A` m x m, `B` n x n, `C` and `X` m x n.
///
/// A unique solution exists if and only if no product of an eigenvalue of `A` and one of `B` is 1. Method and errors as
/// for [`sylvester`].
///
/// # Errors
/// Wrong shapes, entries that are not finite, or [`Error::CommonEigenvalue`].
pub fn dsylvester(A: &Mat, B: &Mat, C: &Mat) -> Result<Mat, Error> {
    solve_by_schur(A, B, &-C, Kind::Discrete)
}

fn solve_by_schur(A: &Mat, B: &Mat, C: &Mat, kind: Kind) -> Result<Mat, Error> {
    check_square("A", A)?;
    check_square("B", B)?;
    check_shape("C", C, A.nrows(), B.nrows())?;
    solve_with_forms(&schur(A)?, &schur(B)?, C, kind)
}

/// The equation for matrices whose Schur forms are known.
fn solve_with_forms(left: &Schur, right: &Schur, C: &Mat, kind: Kind) -> Result<Mat, Error> {
    check_spectra(&left.eigenvalues(), &right.eigenvalues(), kind)?;
    let mut inner = left.U.t() * C * &right.U;
    solve_triangular(&left.T, &right.T, &mut inner, kind);
    check_range("the solution of the Sylvester equation", &left.U * &inner * right.U.t())
}

/// Refuses a pair of eigenvalues that makes the equation singular to working precision.
pub(crate) fn check_spectra(ours: &[C64], theirs: &[C64], kind: Kind) -> Result<(), Error> {
    for &first in ours {
        for &second in theirs {
            let (gap, scale, equation) = match kind {
                Kind::Continuous => (first + second, first.l1_norm() + second.l1_norm(), "A X + X B = C"),
                Kind::Discrete => (first * second - 1.0, 1.0, "A X B - X + C = 0"),
            };
            let separation = gap.l1_norm();
            if separation <= EPS * scale {
                return Err(Error::CommonEigenvalue { equation, first, second, separation });
            }
        }
    }
    Ok(())
}

/// Blocks up to this size are solved entry by entry.
const BASE: usize = 16;

/// Solves `A X + X B = C` or `A X B - X = C` in place of `C`, for quasi-triangular `A` and `B` with separated spectra.
pub(crate) fn solve_triangular(A: &Mat, B: &Mat, C: &mut Mat, kind: Kind) {
    let (m, n) = C.shape();
    if m <= BASE && n <= BASE {
        return base(A, B, C, kind);
    }
    if m >= n {
        split_rows(A, B, C, kind, splitting_row(A));
    } else {
        split_columns(A, B, C, kind, splitting_row(B));
    }
}

/// A row near the middle that does not cut a 2 x 2 block.
pub(crate) fn splitting_row(T: &Mat) -> usize {
    let half = T.nrows() / 2;
    if T[(half, half - 1)] != 0.0 { half + 1 } else { half }
}

fn split_rows(A: &Mat, B: &Mat, C: &mut Mat, kind: Kind, k: usize) {
    let (m, n) = C.shape();
    let mut lower = C.block(k, 0, m - k, n);
    solve_triangular(&A.block(k, k, m - k, m - k), B, &mut lower, kind);
    let mut upper = C.block(0, 0, k, n);
    let coupled = A.block(0, k, k, m - k) * &lower;
    upper -= &if kind == Kind::Continuous { coupled } else { coupled * B };
    solve_triangular(&A.block(0, 0, k, k), B, &mut upper, kind);
    C.set_block(0, 0, &upper);
    C.set_block(k, 0, &lower);
}

fn split_columns(A: &Mat, B: &Mat, C: &mut Mat, kind: Kind, k: usize) {
    let (m, n) = C.shape();
    let mut left = C.block(0, 0, m, k);
    solve_triangular(A, &B.block(0, 0, k, k), &mut left, kind);
    let mut right = C.block(0, k, m, n - k);
    let coupled = &left * B.block(0, k, k, n - k);
    right -= &if kind == Kind::Continuous { coupled } else { A * &coupled };
    solve_triangular(A, &B.block(k, k, n - k, n - k), &mut right, kind);
    C.set_block(0, 0, &left);
    C.set_block(0, k, &right);
}

vectorised! {
    /// Column block by column block from the left, row block by row block from below.
    fn base<'a>(A: &'a Mat, B: &'a Mat, C: &'a mut Mat, kind: Kind) -> () {
        let rows = blocks(A);
        for right in blocks(B) {
            let (j, width) = (right.start, right.size);
            let known = right_hand_side(A, B, C, j, width, kind);
            (0..width).for_each(|l| C.column_mut(j + l).copy_from_slice(known.column(l)));
            for &left in rows.iter().rev() {
                solve_block(A, B, C, left, right, kind);
                eliminate(A, B, C, left, right, kind);
            }
        }
    }
}

/// Columns `j..j + width` of `C` less what the columns already solved contribute.
#[inline(always)]
fn right_hand_side(A: &Mat, B: &Mat, C: &Mat, j: usize, width: usize, kind: Kind) -> Mat {
    let m = C.nrows();
    let mut sum = Mat::zeros(m, width);
    for l in 0..width {
        for k in 0..j {
            let factor = B[(k, j + l)];
            sum.column_mut(l).iter_mut().zip(C.column(k)).for_each(|(s, &x)| *s += factor * x);
        }
    }
    if kind == Kind::Discrete {
        sum = upper_times(A, &sum);
    }
    for l in 0..width {
        let target = sum.column_mut(l);
        target.iter_mut().zip(C.column(j + l)).for_each(|(s, &c)| *s = c - *s);
    }
    sum
}

#[inline(always)]
fn upper_times(A: &Mat, X: &Mat) -> Mat {
    let mut out = Mat::zeros(X.nrows(), X.ncols());
    for j in 0..X.ncols() {
        for k in 0..A.ncols() {
            let factor = X[(k, j)];
            out.column_mut(j).iter_mut().zip(A.column(k)).for_each(|(o, &a)| *o += factor * a);
        }
    }
    out
}

/// The block of the rows of `left` and the columns of `right` by a system of one, two or four unknowns.
#[inline(always)]
fn solve_block(A: &Mat, B: &Mat, C: &mut Mat, left: DiagonalBlock, right: DiagonalBlock, kind: Kind) {
    let (DiagonalBlock { start: i, size: height }, DiagonalBlock { start: j, size: width }) = (left, right);
    if height == 1 && width == 1 {
        let pivot =
            if kind == Kind::Continuous { A[(i, i)] + B[(j, j)] } else { A[(i, i)] * B[(j, j)] - 1.0 };
        C[(i, j)] /= pivot;
        return;
    }
    let unknowns = height * width;
    let mut x = [0.0; 4];
    for q in 0..width {
        (0..height).for_each(|p| x[q * height + p] = C[(i + p, j + q)]);
    }
    let mut system = kronecker_system(A, B, left, right, kind);
    crate::small_systems::solve_complete(&mut system, &mut x, unknowns);
    (0..unknowns).for_each(|row| C[(i + row % height, j + row / height)] = x[row]);
}

/// The matrix of the unknowns of one block, which are counted column by column.
#[inline(always)]
fn kronecker_system(
    A: &Mat,
    B: &Mat,
    left: DiagonalBlock,
    right: DiagonalBlock,
    kind: Kind,
) -> [[f64; 4]; 4] {
    let (DiagonalBlock { start: i, size: height }, DiagonalBlock { start: j, size: width }) = (left, right);
    let mut system = [[0.0; 4]; 4];
    for q in 0..width {
        for p in 0..height {
            let row = q * height + p;
            if kind == Kind::Continuous {
                (0..height).for_each(|l| system[row][q * height + l] += A[(i + p, i + l)]);
                (0..width).for_each(|l| system[row][l * height + p] += B[(j + l, j + q)]);
                continue;
            }
            for l in 0..width {
                (0..height).for_each(|k| system[row][l * height + k] = A[(i + p, i + k)] * B[(j + l, j + q)]);
            }
            system[row][row] -= 1.0;
        }
    }
    system
}

/// Takes the block just solved out of the rows above it.
#[inline(always)]
fn eliminate(A: &Mat, B: &Mat, C: &mut Mat, left: DiagonalBlock, right: DiagonalBlock, kind: Kind) {
    let (DiagonalBlock { start: i, size: height }, DiagonalBlock { start: j, size: width }) = (left, right);
    for l in 0..width {
        for k in 0..height {
            let factor = match kind {
                Kind::Continuous => C[(i + k, j + l)],
                Kind::Discrete => (0..width).map(|p| C[(i + k, j + p)] * B[(j + p, j + l)]).sum(),
            };
            let target = &mut C.column_mut(j + l)[..i];
            target.iter_mut().zip(&A.column(i + k)[..i]).for_each(|(t, &a)| *t -= factor * a);
        }
    }
}

/// Returns a lower bound of the separation of two spectra: `min |a + b|` (continuous) or `min |a b - 1|` (discrete) over the
/// eigenvalues. The true separation, the smallest singular value of the equation, is at most this.
pub fn eigenvalue_separation(first: &[C64], second: &[C64]) -> f64 {
    first.iter().flat_map(|a| second.iter().map(move |b| (a + b).norm())).fold(f64::INFINITY, f64::min)
}
