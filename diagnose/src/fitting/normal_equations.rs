//! The normal equations of a fit: curvature, gradient and its scatter, and the damped step.

use counterpoise_linalg::{Mat, solve};

use crate::recording::series::dot;
use crate::simulator_access::StartShift;
use crate::tolerance::STRETCHES_TOGETHER;
use crate::tolerance::fitting::LEAST_CURVATURE;

/// Curvature and gradient of the cost, and the gradient's scatter.
pub(crate) struct LinearisedCost {
    pub normal: Mat,
    pub gradient: Vec<f64>,
    pub scatter: Mat,
    /// For each parameter, the shift of the initial states that would do the same, recording by recording.
    pub absorbed: Vec<Vec<StartShift>>,
    /// The shift of the initial states that would remove the residual.
    pub alone: Vec<StartShift>,
}

impl LinearisedCost {
    /// Returns the initial states after a step of the parameters: each removes what that step leaves.
    pub fn moved_starts(&self, shifts: &[StartShift], step: &[f64], share: f64) -> Vec<StartShift> {
        let one = |(r, shift): (usize, &StartShift)| {
            let Some(alone) = self.alone.get(r) else { return *shift };
            std::array::from_fn(|k| {
                let taken: f64 = self.absorbed.iter().zip(step).map(|(a, s)| a[r][k] * s).sum();
                shift[k] - share * (alone[k] - taken)
            })
        };
        shifts.iter().enumerate().map(one).collect()
    }
}

/// Returns the step of Levenberg and Marquardt at a damping; `None` if it is not finite.
pub(crate) fn damped_step(normal: &Mat, gradient: &[f64], damping: f64) -> Option<Vec<f64>> {
    if gradient.is_empty() {
        return Some(Vec::new());
    }
    let largest = normal.diagonal().into_iter().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let mut damped = normal.clone();
    for i in 0..gradient.len() {
        damped[(i, i)] += damping * normal[(i, i)].max(LEAST_CURVATURE * largest);
    }
    let step = solve(&damped, &Mat::col(gradient)).ok()?;
    step.is_finite().then(|| step.as_slice().to_vec())
}

/// Returns the sums of slope times residual, stretch by stretch.
pub(crate) fn stretch_sums(slope: &[f64], residual: &[f64], places: &[usize]) -> Vec<f64> {
    let mut sums = vec![0.0; places.iter().max().map_or(0, |last| last + 1)];
    for ((j, r), &place) in slope.iter().zip(residual).zip(places) {
        sums[place] += j * r;
    }
    sums
}

/// Returns the sum of the products of two series over all lags up to [`STRETCHES_TOGETHER`], with Bartlett's weights (Newey and
/// West 1987): never negative for a series with itself.
pub(crate) fn long_run(a: &[f64], b: &[f64]) -> f64 {
    let lagged = |lag: usize| dot(a.get(lag..).unwrap_or(&[]), b) + dot(a, b.get(lag..).unwrap_or(&[]));
    let weight = |lag: usize| 1.0 - lag as f64 / (STRETCHES_TOGETHER + 1) as f64;
    dot(a, b) + (1..=STRETCHES_TOGETHER).map(|lag| weight(lag) * lagged(lag)).sum::<f64>()
}
