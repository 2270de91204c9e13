//! Balancing by powers of two: exact, and often worth ten digits.

use crate::error::{Error, check_square};
use crate::mat::Mat;
use crate::tolerance::{BALANCE_GAIN, BALANCE_SWEEPS};

/// A balanced matrix `A = D^-1 A0 D` with `D = diag(scale)`, every entry of `scale` a power of two.
pub struct Balanced {
    /// The matrix with rows and columns of similar size.
    pub A: Mat,
    /// The diagonal of `D`.
    pub scale: Vec<f64>,
}

/// Scales the state of `A` so that row i and column i have similar 2-norms for every i.
///
/// Source: Parlett and Reinsch, Numer. Math. 13 (1969); the 2-norm as in James, Langou and Lowery (2014), which does
/// not spoil a matrix that is good already. No rounding: the factors are powers of two.
///
/// # Errors
/// Not square, or entries that are not finite.
pub fn balance(A: &Mat) -> Result<Balanced, Error> {
    check_square("A", A)?;
    let mut A = A.clone();
    let mut scale = vec![1.0; A.nrows()];
    for _ in 0..BALANCE_SWEEPS {
        let mut changed = false;
        for i in 0..A.nrows() {
            if let Some(factor) = factor(&A, i) {
                scale_state(&mut A, i, factor);
                scale[i] *= factor;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    Ok(Balanced { A, scale })
}

/// The power of two for state `i`, where it lowers the norm enough.
fn factor(A: &Mat, i: usize) -> Option<f64> {
    let n = A.nrows();
    let column = norm((0..n).filter(|&j| j != i).map(|j| A[(j, i)]));
    let row = norm((0..n).filter(|&j| j != i).map(|j| A[(i, j)]));
    if column == 0.0 || row == 0.0 {
        return None;
    }
    let factor = crate::decomposition::power_of_two((row / column).sqrt());
    let gain = (column * factor).hypot(row / factor) < BALANCE_GAIN * column.hypot(row);
    (factor != 1.0 && gain).then_some(factor)
}

fn norm(entries: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = entries.clone().fold(0.0_f64, |a, b| a.max(b.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    largest * entries.map(|e| (e / largest).powi(2)).sum::<f64>().sqrt()
}

fn scale_state(A: &mut Mat, i: usize, factor: f64) {
    A.column_mut(i).iter_mut().for_each(|e| *e *= factor);
    for j in 0..A.ncols() {
        A[(i, j)] /= factor;
    }
}
