//! Balancing by powers of two: exact, and often worth ten digits.

use crate::error::{Error, check_square};
use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::tolerance::{BALANCE_GAIN, BALANCE_SWEEPS, EPS, WIDE_BALANCE};

/// A balanced matrix `A = D^-1 A0 D` with `D = diag(scale)`, every entry of `scale` a power of two.
#[derive(Debug, Clone)]
pub struct BalancedMatrix {
    /// The matrix with rows and columns of similar size.
    pub A: Mat,
    /// The diagonal of `D`.
    pub scale: Vec<f64>,
}

/// The entries off the diagonal that count as couplings of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Couplings {
    /// All of them: units may differ by any factor.
    All,
    /// Those that exceed the rounding of the state's own rate. Below it may be what a computation left where 0 belongs, and balancing
    /// would make it as large as the rest of the matrix.
    AboveRounding,
    /// All of them, but a row or a column counts as no smaller than the state's own rate, so that none is made smaller than that.
    BesideOwnRate,
}

impl Couplings {
    /// What the diagonal entry adds to the sums of squares of its row and column.
    fn own_share(self, entry: f64) -> f64 {
        if self == Self::BesideOwnRate { entry * entry } else { 0.0 }
    }
}

/// Scales the state of `A` so that row i and column i have similar 2-norms for every i. A row or a column that is below 1e-8 of its diagonal
/// entry is left as it is: the eigenvalues of a matrix with rounding errors in place of zeros are better without.
///
/// Source: Parlett and Reinsch, Numer. Math. 13 (1969); the 2-norm as in James, Langou and Lowery (2014), which does
/// not spoil a matrix that is good already. No rounding: the factors are powers of two.
///
/// # Errors
/// Not square, or entries that are not finite.
pub fn balance(A: &Mat) -> Result<BalancedMatrix, Error> {
    balance_by(A, Couplings::AboveRounding)
}

/// The same with every coupling, however small beside the diagonal: for equations whose data are in units over many decades.
///
/// # Errors
/// As [`balance`].
pub(crate) fn balance_all(A: &Mat) -> Result<BalancedMatrix, Error> {
    balance_by(A, Couplings::All)
}

/// The same with every coupling, but no row or column is made smaller than its diagonal entry: for a matrix in which rounding errors stand in place
/// of zeros, as a rotation leaves them. Source: James, Langou and Lowery (2014).
pub(crate) fn balance_beside_own_rates(A: &Mat) -> Result<BalancedMatrix, Error> {
    balance_by(A, Couplings::BesideOwnRate)
}

impl BalancedMatrix {
    /// Returns whether the units of the states were so far apart that scaling them may have magnified rounding errors in place of zeros.
    pub(crate) fn is_wide(&self) -> bool {
        let (low, high) =
            self.scale.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &d| (low.min(d), high.max(d)));
        high > WIDE_BALANCE * low
    }
}

fn balance_by(A: &Mat, couplings: Couplings) -> Result<BalancedMatrix, Error> {
    check_square("A", A)?;
    let mut A = A.clone();
    let mut scale = vec![1.0; A.nrows()];
    for _ in 0..BALANCE_SWEEPS {
        let (columns, rows) = squares(&A);
        let own = |i: usize| couplings.own_share(A[(i, i)]);
        let is_candidate = |i: &usize| factor(columns[*i] + own(*i), rows[*i] + own(*i)).is_some();
        let candidates: Vec<usize> = (0..A.nrows()).filter(is_candidate).collect();
        let candidates = candidates.into_iter();
        let changed = candidates.filter(|&i| rescale_state(&mut A, &mut scale, i, couplings)).count();
        if changed == 0 {
            break;
        }
    }
    Ok(BalancedMatrix { A, scale })
}

vectorised! {
    /// For every state the sums of the squares of its column and of its row, off the diagonal.
    pub(crate) fn squares<'a>(A: &'a Mat) -> (Vec<f64>, Vec<f64>) {
        let n = A.nrows();
        let (mut columns, mut rows) = (vec![0.0; n], vec![0.0; n]);
        for j in 0..n {
            // Without the diagonal entry: taken out of the sum afterwards, it would take much smaller ones with it.
            let (above, below) = (&A.column(j)[..j], &A.column(j)[j + 1..]);
            columns[j] = sum_of_squares(above) + sum_of_squares(below);
            let (upper, lower) = rows.split_at_mut(j);
            upper.iter_mut().zip(above).for_each(|(r, e)| *r += e * e);
            lower[1..].iter_mut().zip(below).for_each(|(r, e)| *r += e * e);
        }
        (columns, rows)
    }
}

#[inline(always)]
fn sum_of_squares(entries: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let chunks = entries.chunks_exact(8);
    let rest: f64 = chunks.remainder().iter().map(|e| e * e).sum();
    chunks.for_each(|chunk| sums.iter_mut().zip(chunk).for_each(|(s, e)| *s += e * e));
    sums.iter().sum::<f64>() + rest
}

/// The sum of the squares of a row of a matrix, off the diagonal.
pub(crate) fn squares_of_row(A: &Mat, i: usize) -> f64 {
    let of = |columns: std::ops::Range<usize>| columns.map(|j| A[(i, j)] * A[(i, j)]).sum::<f64>();
    of(0..i) + of(i + 1..A.ncols())
}

/// The same of a column.
pub(crate) fn squares_of_column(A: &Mat, j: usize) -> f64 {
    let of = |entries: &[f64]| entries.iter().map(|e| e * e).sum::<f64>();
    of(&A.column(j)[..j]) + of(&A.column(j)[j + 1..])
}

/// Scales state `i` of the present matrix, where that still pays. Returns whether it did.
fn rescale_state(A: &mut Mat, scale: &mut [f64], i: usize, couplings: Couplings) -> bool {
    let (column, row) = (squares_of_column(A, i), squares_of_row(A, i));
    let rounding = if couplings == Couplings::AboveRounding { EPS * A[(i, i)] * A[(i, i)] } else { 0.0 };
    if column.min(row) <= rounding {
        return false;
    }
    let own = couplings.own_share(A[(i, i)]);
    let Some(factor) = factor(column + own, row + own) else { return false };
    scale_state(A, i, factor);
    scale[i] *= factor;
    true
}

/// The power of two for a state with these sums of squares, where it lowers the norm enough.
fn factor(column: f64, row: f64) -> Option<f64> {
    if column <= 0.0 || row <= 0.0 {
        return None;
    }
    let factor = crate::decomposition::power_of_two((row / column).sqrt().sqrt());
    let gain = column * factor * factor + row / factor / factor < BALANCE_GAIN * (column + row);
    (factor != 1.0 && gain).then_some(factor)
}

fn scale_state(A: &mut Mat, i: usize, factor: f64) {
    A.column_mut(i).iter_mut().for_each(|e| *e *= factor);
    let n = A.nrows();
    A.as_mut_slice()[i..].iter_mut().step_by(n).for_each(|e| *e /= factor);
}
