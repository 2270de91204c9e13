//! Integrals over a sampling interval: the cost of a held input, and the covariance that white noise leaves.

use crate::error::{Error, check_shape, check_square};
use crate::expm::{check_exponential, transition};
use crate::mat::Mat;
use crate::tolerance::MOST_HALVINGS;

/// Returns the sampled cost: `Phi = exp(A h)` and `W = integral of exp(A' s) Q exp(A s) ds from 0 to h`, `Q` symmetric.
///
/// Source: Van Loan, IEEE Trans. Automat. Control 23 (1978). With `A = [A0 B0; 0 0]` this gives the exact sampled
/// weights of a zero-order-hold design, cross terms included.
///
/// If `A h` is large, the exponential of the block matrix grows with the unstable `-A'`; the interval is then halved
/// until it is harmless and `W(2h) = W(h) + Phi(h)' W(h) Phi(h)` doubles it again, with the digits of slow states kept as in [`crate::expm()`].
///
/// # Errors
/// Wrong shapes, entries that are not finite.
pub fn van_loan_cost(A: &Mat, Q: &Mat, h: f64) -> Result<(Mat, Mat), Error> {
    check_square("A", A)?;
    check_shape("Q", Q, A.nrows(), A.ncols())?;
    let n = A.nrows();
    let halvings = count_halvings(A, h)?;
    let step = h * (-halvings as f64).exp2();
    let mut big = Mat::zeros(2 * n, 2 * n);
    big.set_block(0, 0, &A.t().scale(-step));
    big.set_block(0, n, &Q.scale(step));
    big.set_block(n, n, &A.scale(step));
    let parts = transition(&big, halvings)?;
    let mut power = parts.last_block(n);
    let mut W = (power.Phi.t() * parts.Phi.block(0, n, n, n)).symmetric_part();
    for _ in 0..halvings {
        let Phi = &power.Phi;
        W = (&W + &(Phi.t() * &W * Phi)).symmetric_part();
        power = power.square();
    }
    Ok((check_exponential(power.Phi)?, check_exponential(W)?))
}

/// Returns the sampled noise: `Phi = exp(A h)` and `W = integral of exp(A s) Q exp(A' s) ds from 0 to h`, `Q` symmetric: the
/// covariance that white noise of intensity `Q` leaves after one period.
///
/// # Errors
/// As for [`van_loan_cost`].
pub fn van_loan_noise(A: &Mat, Q: &Mat, h: f64) -> Result<(Mat, Mat), Error> {
    let (Phi, W) = van_loan_cost(&A.t(), Q, h)?;
    Ok((Phi.t(), W))
}

/// Returns the accumulated cost: `P = integral of W(t) dt from 0 to h` with the `W(t)` of [`van_loan_cost`], `Q` symmetric. White
/// noise of intensity `V` that enters during a period costs `tr(V P)` before the next sample can answer it.
///
/// Source: Van Loan 1978, the next block of the same exponential; halved and doubled as there, by
/// `P(2h) = P(h) + h W(h) + Phi(h)' P(h) Phi(h)`.
///
/// # Errors
/// As for [`van_loan_cost`].
pub fn van_loan_accumulated(A: &Mat, Q: &Mat, h: f64) -> Result<Mat, Error> {
    check_square("A", A)?;
    check_shape("Q", Q, A.nrows(), A.ncols())?;
    let n = A.nrows();
    let halvings = count_halvings(A, h)?;
    let mut step = h * (-halvings as f64).exp2();
    let mut big = Mat::zeros(3 * n, 3 * n);
    big.set_block(0, 0, &A.t().scale(-step));
    big.set_block(0, n, &Mat::eye(n).scale(step));
    big.set_block(n, n, &A.t().scale(-step));
    big.set_block(n, 2 * n, &Q.scale(step));
    big.set_block(2 * n, 2 * n, &A.scale(step));
    let parts = transition(&big, halvings)?;
    let mut power = parts.last_block(2 * n);
    let mut W = (power.Phi.t() * parts.Phi.block(n, 2 * n, n, n)).symmetric_part();
    let mut P = (power.Phi.t() * parts.Phi.block(0, 2 * n, n, n)).symmetric_part();
    for _ in 0..halvings {
        let Phi = &power.Phi;
        P = (&P + &W.scale(step) + Phi.t() * &P * Phi).symmetric_part();
        W = (&W + &(Phi.t() * &W * Phi)).symmetric_part();
        power = power.square();
        step *= 2.0;
    }
    check_exponential(P)
}

/// Returns how often the interval is halved until the matrix changes little over it.
fn count_halvings(A: &Mat, h: f64) -> Result<i32, Error> {
    let change = A.norm_one() * h;
    if !change.is_finite() {
        return Err(Error::OutOfRange { what: "the matrix of an exponential" });
    }
    Ok(change.log2().ceil().clamp(0.0, MOST_HALVINGS) as i32)
}
