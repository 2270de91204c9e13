//! The exponential of a matrix on the way to a longer interval, and what squaring it again and again must not lose.
//!
//! Beside a fast state a slow one hardly changes over an interval that was halved many times: its diagonal entry is one to all digits, and every squaring
//! doubles what rounding has taken from the change. So the diagonal is kept as the change, too, and each squaring makes a rounding error of the change
//! itself. Source: A. Al-Mohy and N. Higham, SIAM J. Matrix Anal. 31 (2009), compute the diagonal of triangular matrices anew for the same reason; this
//! needs no triangle.

use crate::kernel::vectorised;
use crate::mat::Mat;
use crate::tolerance::{FEW_SQUARINGS, SMALL_CHANGE};

/// An exponential that is squared.
pub(crate) struct Transition {
    /// The exponential.
    pub(crate) Phi: Mat,
    /// The diagonal of the exponential less the identity; `None` if so few squarings follow that the exponential itself will do.
    pub(crate) change: Option<Vec<f64>>,
}

impl Transition {
    /// Returns an exponential that is known to the rounding of its entries.
    pub(crate) fn of_rounded(Phi: Mat) -> Self {
        Self { Phi, change: None }
    }

    /// Returns the exponential that differs from the identity by `change`.
    pub(crate) fn of_change(change: Mat) -> Self {
        let diagonal = change.diagonal();
        Self { Phi: change + Mat::eye(diagonal.len()), change: Some(diagonal) }
    }

    /// Returns the exponential without its change if `squarings`, all that follow, are few.
    pub(crate) fn prepare_squarings(self, squarings: i32) -> Self {
        Self { change: self.change.filter(|_| has_many(squarings)), ..self }
    }

    /// Returns the exponential of twice the matrix.
    pub(crate) fn square(&self) -> Self {
        let mut Phi = &self.Phi * &self.Phi;
        let change = self.change.as_ref().map(|change| {
            let returns = returns(&self.Phi, &self.Phi.t());
            let entries = change.iter().zip(&returns).enumerate();
            let next = entries.map(|(i, (&e, returns))| {
                // Of a state that has all but decayed the exponential itself has the digits.
                if e < -SMALL_CHANGE {
                    return Phi[(i, i)] - 1.0;
                }
                let next = e * (2.0 + e) + returns;
                Phi[(i, i)] = 1.0 + next;
                next
            });
            next.collect()
        });
        Self { Phi, change }
    }

    /// Returns the exponential for states in other units: `D Phi D^-1`.
    pub(crate) fn scale_states(mut self, d: &[f64]) -> Self {
        let n = d.len();
        self.Phi = Mat::from_fn(n, n, |i, j| self.Phi[(i, j)] * d[i] / d[j]);
        self
    }

    /// Returns the diagonal block of the states from `first` on.
    pub(crate) fn last_block(&self, first: usize) -> Self {
        let n = self.Phi.nrows() - first;
        let change = self.change.as_ref().map(|change| change[first..].to_vec());
        Self { Phi: self.Phi.block(first, first, n, n), change }
    }
}

/// Returns whether so many squarings would magnify the rounding of an exponential.
pub(crate) fn has_many(squarings: i32) -> bool {
    squarings > FEW_SQUARINGS
}

vectorised! {
    /// The diagonal of the square of a matrix without its diagonal, from the matrix and its transpose.
    fn returns<'a>(M: &'a Mat, transpose: &'a Mat) -> Vec<f64> {
        let n = M.nrows();
        let mut sums = vec![0.0; n];
        for k in 0..n {
            let (column, row) = (M.column(k), transpose.column(k));
            for range in [0..k, k + 1..n] {
                let entries = column[range.clone()].iter().zip(&row[range.clone()]);
                sums[range].iter_mut().zip(entries).for_each(|(sum, (a, b))| *sum += a * b);
            }
        }
        sums
    }
}
