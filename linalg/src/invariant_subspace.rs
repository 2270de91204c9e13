//! The conditioning of a part of a spectrum and of its invariant subspace.

use crate::error::Error;
use crate::mat::Mat;
use crate::schur::Schur;
use crate::sylvester::sylvester;

/// Condition of an invariant subspace (Bai, Demmel and McKenney, ACM TOMS 19, 1993).
#[derive(Clone, Copy, Debug)]
pub struct Subspace {
    /// Norm of the spectral projector (an upper bound): a change of `A` by `e` moves the mean of the part's eigenvalues by
    /// at most about `projector * e`.
    pub projector: f64,
    /// Separation of the two parts, estimated: the same change turns the subspace by about `2 e / separation`.
    pub separation: f64,
}

impl Schur {
    /// Returns how well the leading `count` eigenvalues and their invariant subspace are determined: see [`Subspace`]. `count`
    /// must not cut a complex pair.
    ///
    /// # Errors
    /// [`Error::CommonEigenvalue`] if the two parts share an eigenvalue, and a `count` that cuts a pair or exceeds the
    /// order ([`Error::Shape`]).
    pub fn condition(&self, count: usize) -> Result<Subspace, Error> {
        let n = self.T.nrows();
        let cut = count > n || (count > 0 && count < n && self.T[(count, count - 1)] != 0.0);
        if cut {
            return Err(Error::Shape {
                what: "the leading block",
                rows: count,
                cols: count,
                needed_rows: n,
                needed_cols: n,
            });
        }
        let (first, second) =
            (self.T.block(0, 0, count, count), self.T.block(count, count, n - count, n - count));
        let coupling = sylvester(&first, &-&second, &self.T.block(0, count, count, n - count))?;
        let projector = coupling.norm_fro().hypot(1.0);
        Ok(Subspace { projector, separation: separation(&first, &second)? })
    }
}

/// Steps of the power iteration that estimates a separation.
const POWER_STEPS: usize = 5;

/// The smallest singular value of `X -> T1 X - X T2`, by power iteration on the inverse of the operator and its adjoint.
fn separation(first: &Mat, second: &Mat) -> Result<f64, Error> {
    let (m, n) = (first.nrows(), second.nrows());
    if m == 0 || n == 0 {
        return Ok(f64::INFINITY);
    }
    // No start is orthogonal to everything; this one has no symmetry that a structured matrix could share.
    let mut X = Mat::from_fn(m, n, |i, j| 1.0 + 0.37 * ((3 * i + 5 * j) % 7) as f64);
    let (transposed, other) = (first.t(), -second.t());
    let mut gain = 0.0;
    for _ in 0..POWER_STEPS {
        X = X.scale(1.0 / X.norm_fro());
        let forward = sylvester(first, &-second, &X)?;
        gain = forward.norm_fro();
        X = sylvester(&transposed, &other, &forward)?;
    }
    if gain.is_finite() { Ok(1.0 / gain) } else { Err(Error::OutOfRange { what: "the separation" }) }
}
