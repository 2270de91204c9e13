//! Delays: a rational approximation in continuous time, exact in whole samples.

use crate::error::OperationContext;
use crate::tolerance::MOST_DELAY_STATES;
use crate::{Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// Returns the Padé approximation \[n/n\] of exp(-s delay): all-pass, unit gain, phase right up to about n
/// radians.
///
/// From the continued fraction tanh p = 1/(1/p + 1/(3/p + 1/(5/p + ...))), p = s delay/2, of which the approximation
/// is (1 - tanh p)/(1 + tanh p) cut after n terms. The ladder gives A = (2/delay) D M^-1 D, D = diag(sqrt(1, 3, 5, ...)), M a
/// skew tridiagonal of ones but for one loss: no polynomial is expanded, so any order may be asked for.
///
/// # Errors
/// [`Error::Range`] for a delay that is negative or not finite, or an order above [`MOST_DELAY_STATES`]. A delay of zero and order zero
/// give the gain 1.
pub fn pade(delay_s: f64, order: usize) -> Result<StateSpace, Error> {
    needs_few("order of the Pade approximation", order)?;
    if !(delay_s >= 0.0 && delay_s.is_finite()) {
        return Err(Error::Range { what: "delay_s", value: delay_s, allowed: "finite and not negative" });
    }
    if delay_s == 0.0 || order == 0 {
        return StateSpace::gain(Mat::eye(1), Timebase::Continuous);
    }
    let inverse = linalg::inverse(&ladder(order)).with_operation("Pade approximation")?;
    let roots: Vec<f64> = (0..order).map(|k| ((2 * k + 1) as f64).sqrt()).collect();
    let root = Mat::diag(&roots);
    let first = Mat::eye(order).block(0, 0, order, 1);
    let A = (&root * &(&inverse * &root)).scale(2.0 / delay_s);
    let size = 2.0 / delay_s.sqrt();
    let B = (&root * &(&inverse * &first)).scale(-size);
    let C = (&first.t() * &(&inverse * &root)).scale(-size);
    let D = Mat::eye(1).scale(1.0 + 2.0 * inverse[(0, 0)]);
    StateSpace::new(A, B, C, D, Timebase::Continuous)
}

fn needs_few(what: &'static str, states: usize) -> Result<(), Error> {
    if states <= MOST_DELAY_STATES {
        return Ok(());
    }
    Err(Error::Range { what, value: states as f64, allowed: "at most 4096" })
}

/// Ones below, minus ones above the diagonal, and the loss at the driven end.
fn ladder(order: usize) -> Mat {
    Mat::from_fn(order, order, |i, j| match (i, j) {
        (0, 0) => -1.0,
        _ if i == j + 1 => 1.0,
        _ if j == i + 1 => -1.0,
        _ => 0.0,
    })
}

/// Returns z^-samples for one signal: a shift register.
///
/// # Errors
/// [`Error::Period`] if the period is not positive, [`Error::Range`] for more than [`MOST_DELAY_STATES`] samples.
pub fn delay_samples(samples: usize, period_s: f64) -> Result<StateSpace, Error> {
    needs_few("samples of delay", samples)?;
    let timebase = Timebase::Discrete { period_s };
    if samples == 0 {
        return StateSpace::gain(Mat::eye(1), timebase);
    }
    let A = Mat::from_fn(samples, samples, |i, j| if i == j + 1 { 1.0 } else { 0.0 });
    let unit = Mat::eye(samples);
    let (B, C) = (unit.block(0, 0, samples, 1), unit.block(samples - 1, 0, 1, samples));
    StateSpace::new(A, B, C, Mat::zeros(1, 1), timebase)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{C64, response_at};

    #[test]
    fn pade_is_all_pass_with_the_phase_of_the_delay() {
        for order in [1, 2, 3, 8, 15] {
            let g = pade(0.02, order).unwrap();
            let rate = 0.4 * order as f64 / 0.02;
            let value = response_at(&g, rate).unwrap()[(0, 0)];
            assert!((value.norm() - 1.0).abs() < 1e-12, "{order}: {value}");
            let error = (value - C64::from_polar(1.0, -rate * 0.02)).norm();
            assert!(error < 6e-3_f64.max(1e-12), "{order}: {error}");
        }
    }

    #[test]
    fn pade_of_order_two_is_the_textbook_quotient() {
        let (delay, s) = (0.5, C64::new(0.3, 2.0));
        let x = s * delay;
        let expected = (x * x - x * 6.0 + 12.0) / (x * x + x * 6.0 + 12.0);
        let g = crate::Response::of(&pade(delay, 2).unwrap()).unwrap();
        assert!((g.at_points(&[s]).unwrap()[0][(0, 0)] - expected).norm() < 1e-14);
    }

    #[test]
    fn whole_samples_are_delayed_exactly() {
        let value = response_at(&delay_samples(3, 0.1).unwrap(), 2.0).unwrap()[(0, 0)];
        assert!((value - C64::from_polar(1.0, -0.6)).norm() < 1e-15);
    }
}
