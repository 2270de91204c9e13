//! A whole H2 problem in sampled time: dynamics, cost and noise.

use crate::discretise::{QuadraticCost, SampledCost, sampled_cost};
use crate::error::OperationContext;
use crate::{Error, Mat};
use counterpoise_linalg as linalg;

/// White noise on the state and on the measurement of a continuous plant `x' = A x + B u + w`, `y = C x + v`.
#[derive(Debug, Clone, Copy)]
pub struct Noise<'a> {
    /// Intensity of `w`, n x n, symmetric: `B1 B1'` of a generalised plant.
    pub process: &'a Mat,
    /// Intensity of `v`, p x p, symmetric: `D21 D21'` of a generalised plant.
    pub measurement: &'a Mat,
}

/// The sampled counterpart of a continuous H2 problem.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledProblem {
    /// Dynamics under a held input, and the cost of one period.
    pub cost: SampledCost,
    /// Covariance that the process noise of one period leaves in the state, n x n.
    pub process: Mat,
    /// Covariance of a measurement that is averaged over the period, p x p: intensity over period.
    pub measurement: Mat,
    /// Cost of one period that no control can avoid: noise that enters is only seen at the next sample.
    pub unavoidable: f64,
}

/// Returns the exact sampled problem of a continuous one whose input is held over each period (Van Loan, IEEE TAC 23
/// (1978) 395)
///
/// ```text
///     x' = A x + B u + w,  y = C x + v,   w and v white;   cost: mean of [x; u]' [Q S; S' R] [x; u]
///     x+ = Ad x + Bd u + wd,  cov(wd) = integral of exp(A t) W exp(A't) over T,   cov(vd) = V / T
///     mean cost = (E [x; u]' [Qd Sd; Sd' Rd] [x; u] + unavoidable) / T
/// ```
///
/// # Errors
/// [`Error::Shape`], [`Error::Period`], [`Error::Matrix`].
pub fn sampled_problem(
    A: &Mat,
    B: &Mat,
    cost: QuadraticCost,
    noise: Noise,
    period_s: f64,
) -> Result<SampledProblem, Error> {
    let n = A.nrows();
    if noise.process.shape() != (n, n) {
        return Err(Error::Shape { what: "W", found: noise.process.shape(), expected: (n, n) });
    }
    let (Q, sampled) = (cost.Q, sampled_cost(A, B, cost, period_s)?);
    let (_, process) = linalg::van_loan_noise(A, noise.process, period_s).with_operation("sampled noise")?;
    let accumulated = linalg::van_loan_accumulated(A, Q, period_s).with_operation("sampled noise")?;
    Ok(SampledProblem {
        cost: sampled,
        process,
        measurement: noise.measurement.scale(1.0 / period_s),
        unavoidable: (noise.process * &accumulated).trace(),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Discretisation, StateSpace, Timebase, c2d};

    /// Returns a mass on a spring, driven at its velocity by noise.
    fn plant() -> (Mat, Mat, Mat) {
        let A = Mat::from_rows(&[&[0.0, 1.0, 0.0], &[-400.0, -0.8, 30.0], &[0.0, 0.0, -25.0]]);
        let W = Mat::from_rows(&[&[0.0, 0.0, 0.0], &[0.0, 9.0, 0.5], &[0.0, 0.5, 4.0]]);
        (A, Mat::col(&[0.0, 0.0, 25.0]), W)
    }

    /// Stationary covariance of `x+ = A x + w`.
    fn stationary_covariance(A: &Mat, W: &Mat) -> Mat {
        linalg::dlyap(A, W).unwrap()
    }

    #[test]
    fn the_cost_of_a_sampled_loop_is_that_of_its_dense_simulation() {
        let ((A, B, W), T) = (plant(), 0.05);
        let (Q, R, S) = (Mat::diag(&[50.0, 0.2, 1.0]), Mat::eye(1).scale(0.3), Mat::col(&[0.1, 0.0, 0.2]));
        let V = Mat::eye(1).scale(1e-4);
        let cost = QuadraticCost { Q: &Q, R: &R, S: &S };
        let noise = Noise { process: &W, measurement: &V };
        let exact = sampled_problem(&A, &B, cost, noise, T).unwrap();
        let d = &exact.cost;
        let answer = linalg::dare(&d.A, &d.B, &d.Q, &d.R, Some(&d.S)).unwrap().solution().unwrap();
        let closed = &d.A - &(&d.B * &answer.F);
        let X = stationary_covariance(&closed, &exact.process);
        // [x; u] = [I; -F] x at the samples.
        let stacked = Mat::eye(3).vstack(&-&answer.F);
        let weight = Mat::from_blocks(&[&[&d.Q, &d.S], &[&d.S.t(), &d.R]]);
        let predicted = ((&weight * &(&stacked * &X * stacked.t())).trace() + exact.unavoidable) / T;
        let simulated = dense(
            &A,
            &B,
            &Mat::from_blocks(&[&[&Q, &S], &[&S.t(), &R]]),
            &W,
            &(&stacked * &X * stacked.t()),
            T,
        );
        assert!((predicted / simulated - 1.0).abs() < 1e-6, "{predicted} {simulated}");
        // The optimal cost from the equation: tr(X_dare W_d).
        let optimal = ((&answer.X * &exact.process).trace() + exact.unavoidable) / T;
        assert!((predicted / optimal - 1.0).abs() < 1e-10, "{predicted} {optimal}");
        assert!((exact.measurement[(0, 0)] - 1e-4 / T).abs() < 1e-18);
    }

    /// Returns the mean of the continuous cost over a period, by Simpson's rule on the covariance of [x; u]
    /// in 800 steps.
    fn dense(A: &Mat, B: &Mat, weight: &Mat, W: &Mat, start: &Mat, T: f64) -> f64 {
        let (n, steps) = (A.nrows(), 800);
        let h = T / f64::from(steps);
        let g = StateSpace::new(A.clone(), B.clone(), Mat::eye(n), Mat::zeros(n, 1), Timebase::Continuous)
            .unwrap();
        let fine = c2d(&g, h, Discretisation::ZeroOrderHold).unwrap();
        let step = Mat::from_blocks(&[&[&fine.A, &fine.B], &[&Mat::zeros(1, n), &Mat::eye(1)]]);
        // Noise of one fine step by Simpson's rule as well, so that Van Loan's formula is not its own judge.
        let half = c2d(&g, 0.5 * h, Discretisation::ZeroOrderHold).unwrap().A;
        let spread = |F: &Mat| F * W * F.t();
        let noise = (W + &spread(&half).scale(4.0) + spread(&fine.A)).scale(h / 6.0);
        let (mut X, mut sum) = (start.clone(), 0.0);
        for k in 0..=steps {
            let share = if k == 0 || k == steps { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
            sum += share * (weight * &X).trace();
            X = &step * &X * step.t();
            X.set_block(0, 0, &(X.block(0, 0, n, n) + &noise));
        }
        sum / (3.0 * f64::from(steps))
    }

    #[test]
    fn shapes_that_do_not_fit_are_refused() {
        let (A, B, W) = plant();
        let (Q, R, S) = (Mat::eye(3), Mat::eye(1), Mat::zeros(3, 1));
        let noise = Noise { process: &W.block(0, 0, 2, 2), measurement: &Mat::eye(1) };
        let found = sampled_problem(&A, &B, QuadraticCost { Q: &Q, R: &R, S: &S }, noise, 0.1);
        assert!(matches!(found, Err(Error::Shape { what: "W", .. })));
    }
}
