//! A sampled plant with the exact cost of one period: what a discrete regulator and its proof are computed from.

use counterpoise_linalg as linalg;
use counterpoise_linalg::{Mat, Riccati, dare, dlyap, eigenvalues};
use counterpoise_lti::StateSpace;

use crate::Error;
use crate::cause::DesignEquation;
use crate::certificate::riccati;
use crate::finding::Part;

/// Dynamics under held inputs and the cost that a period adds
///
/// ```text
///     x+ = A x + B q        cost of a period = [x; q]' weight [x; q]
/// ```
#[derive(Debug, Clone)]
pub(crate) struct Stage {
    /// n x n.
    pub A: Mat,
    /// n x m.
    pub B: Mat,
    /// On \[x; q\], symmetric.
    pub weight: Mat,
}

/// States that are put behind those of a stage, and what then makes its inputs
///
/// ```text
///     s+ = from_state x + own s + from_input v        q = by_state x + by_own s + by_input v
/// ```
pub(crate) struct Extension {
    pub from_state: Mat,
    pub own: Mat,
    pub from_input: Mat,
    pub by_state: Mat,
    pub by_own: Mat,
    pub by_input: Mat,
}

/// White noise of a sampled problem: what one period leaves in the state, and that of a reading.
pub(crate) struct SampledNoise {
    /// Covariance on the first states, k x k.
    pub process: Mat,
    /// The reading's row on the same states, 1 x k.
    pub reading: Mat,
    /// Variance of a reading.
    pub measurement: f64,
    /// Cost of a period that no control can avoid.
    pub unavoidable: f64,
}

/// The estimate of the state after a reading: x = x_before + gain (reading - expected).
pub(crate) struct Estimate {
    /// k x 1.
    pub gain: Mat,
    /// Variance of reading - expected.
    pub innovation: f64,
    /// Covariance of what is not known, after the reading; `None` if it has no bound.
    pub unknown: Option<Mat>,
}

impl Stage {
    /// Returns n.
    pub fn order(&self) -> usize {
        self.A.nrows()
    }

    /// Returns the stage with further states: \[x; s\], input v.
    pub fn extend(&self, more: &Extension) -> Self {
        let (n, k, m) = (self.order(), more.own.nrows(), more.by_input.ncols());
        let closed = &self.A + &(&self.B * &more.by_state);
        let A = Mat::from_blocks(&[&[&closed, &(&self.B * &more.by_own)], &[&more.from_state, &more.own]]);
        let B = (&self.B * &more.by_input).vstack(&more.from_input);
        let seen = Mat::from_blocks(&[
            &[&Mat::eye(n), &Mat::zeros(n, k), &Mat::zeros(n, m)],
            &[&more.by_state, &more.by_own, &more.by_input],
        ]);
        let weight = (&seen.t() * &(&self.weight * &seen)).symmetric_part();
        Self { A, B, weight }
    }

    /// Returns the stage behind a filter of its one input.
    pub fn filter_input(&self, filter: &StateSpace) -> Self {
        let (n, k) = (self.order(), filter.order());
        self.extend(&Extension {
            from_state: Mat::zeros(k, n),
            own: filter.A.clone(),
            from_input: filter.B.clone(),
            by_state: Mat::zeros(1, n),
            by_own: filter.C.clone(),
            by_input: filter.D.clone(),
        })
    }

    /// Returns the stage with a controller around it: q = v + K (row x).
    pub fn close_loop(&self, K: &StateSpace, row: &Mat) -> Self {
        self.extend(&Extension {
            from_state: &K.B * row,
            own: K.A.clone(),
            from_input: Mat::zeros(K.order(), 1),
            by_state: &K.D * row,
            by_own: K.C.clone(),
            by_input: Mat::eye(1),
        })
    }

    /// Returns the stage whose one input costs `price` times its square besides.
    pub fn with_price(mut self, price: f64) -> Self {
        let last = self.order();
        self.weight[(last, last)] += price;
        self
    }

    /// Returns the part of the stage on some of its states, which the others do not act on or are left out with.
    pub fn select_states(&self, states: &[usize]) -> Self {
        let inputs: Vec<usize> = (0..self.B.ncols()).collect();
        let all: Vec<usize> = states.iter().copied().chain(inputs.iter().map(|i| self.order() + i)).collect();
        Self {
            A: self.A.select(states, states),
            B: self.B.select(states, &inputs),
            weight: self.weight.select(&all, &all),
        }
    }

    /// Returns Q, R and S of the cost x'Qx + q'Rq + 2 x'Sq.
    pub fn costs(&self) -> (Mat, Mat, Mat) {
        let (n, m) = self.B.shape();
        (self.weight.block(0, 0, n, n), self.weight.block(n, n, m, m), self.weight.block(0, n, n, m))
    }

    /// Returns the state feedback q = -F x that makes the mean cost smallest.
    pub fn regulator(&self, part: Part) -> Result<Riccati, Error> {
        let (Q, R, S) = self.costs();
        let solved = dare(&self.A, &self.B, &Q, &R, Some(&S))?;
        riccati(DesignEquation::SampledRegulator, part, solved)
    }

    /// Returns the mean cost of a period that the equations predict: under q = -F x of what is known, which innovations drive
    /// through `gain`, and of what is not known; `None` if that has no bound.
    pub fn predict_cost(
        &self,
        F: &Mat,
        estimate: &Estimate,
        noise: &SampledNoise,
    ) -> Result<Option<f64>, Error> {
        let n = self.order();
        let Some(unknown) = &estimate.unknown else { return Ok(None) };
        let driven = &estimate.gain * &estimate.gain.t().scale(estimate.innovation);
        let Some(known) = stationary_covariance(&(&self.A - &(&self.B * F)), &driven)? else {
            return Ok(None);
        };
        let acting = Mat::eye(n).vstack(&-F);
        let of_known = (&self.weight * &(&acting * &(&known * &acting.t()))).trace();
        let u = unknown.nrows();
        let of_unknown = (&self.weight.block(0, 0, u, u) * unknown).trace();
        Ok(Some(of_known + of_unknown + noise.unavoidable))
    }

    /// Returns the mean cost of a period of the assembled loop: a controller from the reading to (q, v), v costing `price` times
    /// its square; `None` if the loop is not stable.
    pub fn closed_loop_cost(
        &self,
        controller: &StateSpace,
        noise: &SampledNoise,
        price: f64,
    ) -> Result<Option<f64>, Error> {
        let (n, k, m) = (self.order(), controller.order(), self.B.ncols());
        let (by_own, direct) = (controller.C.block(0, 0, m, k), controller.D.block(0, 0, m, 1));
        let A = Mat::from_blocks(&[
            &[&(&self.A + &(&self.B * &(&direct * &noise.reading))), &(&self.B * &by_own)],
            &[&(&controller.B * &noise.reading), &controller.A],
        ]);
        let sensed = (&self.B * &direct).vstack(&controller.B);
        let W =
            &noise.process.block_diag(&Mat::zeros(k, k)) + &(&sensed * &sensed.t().scale(noise.measurement));
        let Some(state) = stationary_covariance(&A, &W.symmetric_part())? else { return Ok(None) };
        // [x; q; v] on [x; controller], and on the reading's noise.
        let own = Mat::eye(n).hstack(&Mat::zeros(n, k));
        let rows = own.vstack(&(&controller.D * &noise.reading).hstack(&controller.C));
        let noisy = Mat::zeros(n, 1).vstack(&controller.D);
        let spread = &(&rows * &(&state * &rows.t())) + &(&noisy * &noisy.t().scale(noise.measurement));
        let weight = self.weight.block_diag(&Mat::eye(1).scale(price));
        Ok(Some((&weight * &spread).trace() + noise.unavoidable))
    }
}

/// Covariance of x+ = A x + w with covariance W of w; `None` if it has no bound.
pub(crate) fn stationary_covariance(A: &Mat, W: &Mat) -> Result<Option<Mat>, Error> {
    if eigenvalues(A)?.iter().any(|pole| pole.norm() >= 1.0) {
        return Ok(None);
    }
    Ok(Some(dlyap(A, W)?))
}

/// Covariance before a reading of the states that the reading tells of, from their filter's equation.
pub(crate) fn filter(A: &Mat, noise: &SampledNoise, part: Part) -> Result<Riccati, Error> {
    let V = Mat::eye(1).scale(noise.measurement);
    let solved: linalg::Outcome<Riccati> = dare(&A.t(), &noise.reading.t(), &noise.process, &V, None)?;
    riccati(DesignEquation::SampledFilter, part, solved)
}

/// Y - Y C' (C Y C' + V)^-1 C Y, the gain Y C' (C Y C' + V)^-1 and C Y C' + V.
pub(crate) fn update_by_reading(Y: &Mat, reading: &Mat, measurement: f64) -> (Mat, Mat, f64) {
    let seen = Y * &reading.t();
    let innovation = (reading * &seen)[(0, 0)] + measurement;
    let gain = seen.scale(1.0 / innovation);
    ((Y - &(&gain * &seen.t())).symmetric_part(), gain, innovation)
}
